//! A table as C99, with a look-up that does what `carom-embedded` does, operation by operation.

use carom_embedded::{LookupLeaf, LookupTable};
use carom_model::Error;

use crate::arrays::LookupArrays;
use crate::source_text::{SourceNumber, check_name, list, said};

impl LookupArrays<f32> {
    /// The table as a header and a source in C99, with worst-case operations and bytes in front.
    /// There are no calls of a library, no recursion and no loops without a bound.
    ///
    /// Names begin with `name`; the header declares `name_evaluate`. Its answers are those of
    /// [`evaluate`](carom_embedded::LookupTable::evaluate), bit for bit, where the compiler keeps
    /// to IEEE 754 and fuses no products with sums (`-ffp-contract=off`).
    ///
    /// Returns the texts of `name.h` and `name.c`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`](carom_model::ErrorKind::Unsupported) for a name that is none.
    pub fn c_source(&self, name: &str) -> Result<[String; 2], Error> {
        source(self, name)
    }
}

impl LookupArrays<f64> {
    /// As for 32 bits.
    ///
    /// # Errors
    ///
    /// As for 32 bits.
    pub fn c_source(&self, name: &str) -> Result<[String; 2], Error> {
        source(self, name)
    }
}

fn number<T: SourceNumber>(value: T) -> String {
    match value.is_infinite() {
        true => format!("1.0{0} / 0.0{0}", T::SUFFIX),
        false => format!("{value:?}{}", T::SUFFIX),
    }
}

/// The laws of leaves that have none.
const NO_PLAN: u32 = u32::MAX;
const OPEN: u32 = u32::MAX - 1;

fn header<T: SourceNumber>(arrays: &LookupArrays<T>, name: &str, bytes: usize) -> String {
    let (upper, [_, number]) = (name.to_ascii_uppercase(), T::TYPES);
    let (states, inputs) = (arrays.lower.len(), arrays.inputs);
    let mut text = "/*\n".to_owned();
    said(arrays, bytes).iter().for_each(|line| text += &format!(" * {line}.\n"));
    text += &format!(
        " */
#ifndef {upper}_H
#define {upper}_H

#ifdef __cplusplus
extern \"C\" {{
#endif

#define {upper}_STATES {states}
#define {upper}_INPUTS {inputs}

enum {name}_answer {{
    /* The inputs are those of a plan that keeps every row. */
    {upper}_PLAN,
    /* It is proved that there is no plan from this state. */
    {upper}_NO_PLAN,
    /* The build of the table has ended before this part of the set was decided. */
    {upper}_OPEN,
    /* The state is not in the set of the table, or is no number. */
    {upper}_OUTSIDE
}};

/*
 * Looks up the inputs of a state. Inputs and loss are written if the answer is {upper}_PLAN. The
 * loss is the most that the plan costs above the least cost, and infinite if nothing is proved.
 */
enum {name}_answer {name}_evaluate(
    const {number} state[{upper}_STATES], {number} inputs[{upper}_INPUTS], {number} *loss);

#ifdef __cplusplus
}}
#endif

#endif
"
    );
    text
}

fn source<T: SourceNumber>(arrays: &LookupArrays<T>, name: &str) -> Result<[String; 2], Error> {
    check_name(name)?;
    let (upper, [_, number_type], suffix) = (name.to_ascii_uppercase(), T::TYPES, T::SUFFIX);
    let law = |leaf: &LookupLeaf<T>| match leaf {
        LookupLeaf::Plan { law, .. } => *law,
        LookupLeaf::NoPlan => NO_PLAN,
        LookupLeaf::Open => OPEN,
    };
    let loss = |leaf: &LookupLeaf<T>| match leaf {
        LookupLeaf::Plan { loss, .. } => number(*loss),
        _ => number(T::ZERO),
    };
    let whole = |value: &u32| format!("{value}U");
    let code = |value: u32| format!("{value}U");
    let mut bytes = 0;
    let mut text = format!("#include \"{name}.h\"\n\n#include <stdint.h>\n\n");
    text += "#ifdef __clang__\n#pragma STDC FP_CONTRACT OFF\n#endif\n\n";
    let mut array = |kind: &str, size: usize, name: &str, count: usize, entries: String| {
        bytes += size * count;
        // An empty array is none in C.
        let entries = if count == 0 { "\n    0,".to_owned() } else { entries };
        text += &format!("static const {kind} {name}[{}] = {{{entries}\n}};\n\n", count.max(1));
    };
    let (n, real) = (arrays.lower.len(), size_of::<T>());
    array(number_type, real, "lower", n, list(arrays.lower.iter().copied(), number));
    array(number_type, real, "upper", n, list(arrays.upper.iter().copied(), number));
    array(number_type, real, "scale", n, list(arrays.scale.iter().copied(), number));
    array("uint32_t", 4, "roots", arrays.roots.len(), list(arrays.roots.iter().copied(), code));
    let (nodes, leaves) = (&arrays.nodes, &arrays.leaves);
    let edges = list(nodes.iter().flat_map(|node| node.edge), |k| k.to_string());
    array("uint8_t", 1, "edges", 2 * nodes.len(), edges);
    let halves = list(nodes.iter().flat_map(|node| node.next), code);
    array("uint32_t", 4, "halves", 2 * nodes.len(), halves);
    array("uint32_t", 4, "leaf_law", leaves.len(), list(leaves.iter().map(law), code));
    array(number_type, real, "leaf_loss", leaves.len(), list(leaves, loss));
    let (laws, values) = (&arrays.laws, &arrays.values);
    array("uint32_t", 4, "laws", laws.len(), list(laws, whole));
    array(number_type, real, "values", values.len(), list(values.iter().copied(), number));
    let leaf = LookupTable::<T>::LEAF;
    let (depth, share) = (arrays.depth, T::share(1));
    text += &format!(
        "enum {name}_answer {name}_evaluate(
    const {number_type} state[{upper}_STATES], {number_type} inputs[{upper}_INPUTS], {number_type} *loss)
{{
    uint32_t sorted[{upper}_STATES];
    uint32_t axes[{upper}_STATES];
    uint32_t weights[{upper}_STATES + 1];
    uint32_t order = 0U;
    uint32_t before = {units}U;
    uint32_t at;
    uint32_t law;
    int a;
    int k;
    int m;
    for (a = 0; a < {upper}_STATES; a++) {{
        if (!(lower[a] <= state[a] && state[a] <= upper[a])) {{
            return {upper}_OUTSIDE;
        }}
    }}
    /* Coordinates in whole units, the largest first. */
    for (a = 0; a < {upper}_STATES; a++) {{
        const {number_type} scaled = (state[a] - lower[a]) * scale[a];
        uint32_t moving = (uint32_t)(scaled + 0.5{suffix});
        uint32_t axis = (uint32_t)a;
        if (moving > {units}U) {{
            moving = {units}U;
        }}
        for (k = 0; k < a; k++) {{
            if (sorted[k] < moving) {{
                const uint32_t other = sorted[k];
                const uint32_t other_axis = axes[k];
                sorted[k] = moving;
                axes[k] = axis;
                moving = other;
                axis = other_axis;
            }}
        }}
        sorted[a] = moving;
        axes[a] = axis;
    }}
    /* The weights of the corners of the simplex, and its number. */
    for (k = 0; k < {upper}_STATES; k++) {{
        uint32_t earlier = 0U;
        weights[k] = before - sorted[k];
        before = sorted[k];
        for (a = k; a < {upper}_STATES; a++) {{
            if (axes[a] < axes[k]) {{
                earlier++;
            }}
        }}
        order = order * (uint32_t)({upper}_STATES - k) + earlier;
    }}
    weights[{upper}_STATES] = before;
    at = roots[order];
    /* At most {depth} halves. */
    while (at < {leaf}U) {{
        const uint32_t i = edges[2U * at];
        const uint32_t j = edges[2U * at + 1U];
        if (weights[i] >= weights[j]) {{
            weights[i] -= weights[j];
            weights[j] *= 2U;
            at = halves[2U * at];
        }} else {{
            weights[j] -= weights[i];
            weights[i] *= 2U;
            at = halves[2U * at + 1U];
        }}
    }}
    at -= {leaf}U;
    law = leaf_law[at];
    if (law == {NO_PLAN}U) {{
        return {upper}_NO_PLAN;
    }}
    if (law == {OPEN}U) {{
        return {upper}_OPEN;
    }}
    for (m = 0; m < {upper}_INPUTS; m++) {{
        inputs[m] = 0.0{suffix};
    }}
    for (k = 0; k <= {upper}_STATES; k++) {{
        const {number_type} share = ({number_type})weights[k] * {share}{suffix};
        const uint32_t first = laws[law * {corners}U + (uint32_t)k] * {inputs}U;
        for (m = 0; m < {upper}_INPUTS; m++) {{
            inputs[m] = inputs[m] + share * values[first + (uint32_t)m];
        }}
    }}
    *loss = leaf_loss[at];
    return {upper}_PLAN;
}}
",
        units = T::UNITS,
        share = format_args!("{share:?}"),
        corners = n + 1,
        inputs = arrays.inputs,
    );
    Ok([header(arrays, name, bytes), text])
}
