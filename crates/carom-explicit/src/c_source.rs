//! A table as C99, with a look-up that does what `carom-embedded` does, operation by operation.

use carom_embedded::{LookupLeaf, LookupProgram, LookupTable};
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

/// Added to the numbers of programs.
const SOLVE: u32 = 1 << 31;

fn header<T: SourceNumber>(arrays: &LookupArrays<T>, name: &str, bytes: usize) -> String {
    let (upper, [_, number]) = (name.to_ascii_uppercase(), T::TYPES);
    let (states, inputs) = (arrays.lower.len(), arrays.inputs);
    let damaged = match arrays.programs.is_empty() {
        true => String::new(),
        false => format!(
            ",\n    /* A program takes more exchanges than were proved: the table is not as it was \
             written. */\n    {upper}_DAMAGED"
        ),
    };
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
    {upper}_OUTSIDE{damaged}
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

/// The look-up in C, with words between `@` for what differs between tables.
const LOOK_UP: &str = include_str!("look_up_c.txt");

/// The solve of a program in C, the lines where coordinates are kept for it, and its call.
const SOLVE_PROGRAM: &str = include_str!("solve_program_c.txt");
const SOLVE_LINES: [(&str, &str); 3] = [
    ("kept", "    uint32_t coordinates[@upper@_STATES];\n"),
    ("keep", "        coordinates[a] = moving;\n"),
    (
        "solve",
        "    if (law >= @SOLVE@U) {
        if (!@name@_solve(law - @SOLVE@U, coordinates, inputs)) {
            return @upper@_DAMAGED;
        }
        *loss = leaf_loss[at];
        return @upper@_PLAN;
    }
",
    ),
];

fn look_up<T: SourceNumber>(arrays: &LookupArrays<T>, name: &str) -> String {
    let [_, number_type] = T::TYPES;
    let has_programs = !arrays.programs.is_empty();
    let rows = arrays.programs.iter().map(|program| program.rows as usize).max().unwrap_or(0);
    let words = [
        ("name", name.to_owned()),
        ("upper", name.to_ascii_uppercase()),
        ("number_type", number_type.to_owned()),
        ("suffix", T::SUFFIX.to_owned()),
        ("units", T::UNITS.to_string()),
        ("share", format!("{:?}", T::share(1))),
        ("leaf", LookupTable::<T>::LEAF.to_string()),
        ("depth", arrays.depth.to_string()),
        ("corners", (arrays.lower.len() + 1).to_string()),
        ("inputs", arrays.inputs.to_string()),
        ("NO_PLAN", NO_PLAN.to_string()),
        ("OPEN", OPEN.to_string()),
        ("SOLVE", SOLVE.to_string()),
        ("rows", rows.max(1).to_string()),
        ("matrix", (rows * (rows + arrays.inputs)).max(1).to_string()),
    ];
    let set =
        |text: String, (word, value): &(&str, String)| text.replace(&format!("@{word}@"), value);
    let mut text = if has_programs { SOLVE_PROGRAM.to_owned() } else { String::new() };
    text += LOOK_UP;
    for (word, lines) in SOLVE_LINES {
        text = text.replace(&format!("@{word}@\n"), if has_programs { lines } else { "" });
    }
    words.iter().fold(text, set)
}

fn source<T: SourceNumber>(arrays: &LookupArrays<T>, name: &str) -> Result<[String; 2], Error> {
    check_name(name)?;
    let [_, number_type] = T::TYPES;
    let law = |leaf: &LookupLeaf<T>| match leaf {
        LookupLeaf::Plan { law, .. } => *law,
        LookupLeaf::Solve { program, .. } => SOLVE + program,
        LookupLeaf::NoPlan => NO_PLAN,
        LookupLeaf::Open => OPEN,
    };
    let loss = |leaf: &LookupLeaf<T>| match leaf {
        LookupLeaf::Plan { loss, .. } | LookupLeaf::Solve { loss, .. } => number(*loss),
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
    let (programs, count) = (&arrays.programs, arrays.programs.len());
    if count > 0 {
        let whole = |of: fn(&LookupProgram<T>) -> u32| list(programs.iter().map(of), code);
        let real_numbers = |of: fn(&LookupProgram<T>) -> T| list(programs.iter().map(of), number);
        array("uint32_t", 4, "program_rows", count, whole(|program| program.rows));
        array("uint32_t", 4, "program_first", count, whole(|program| program.first));
        array("uint32_t", 4, "program_exchanges", count, whole(|program| program.exchanges));
        array(number_type, real, "program_negative", count, real_numbers(|own| own.negative));
        array(number_type, real, "program_positive", count, real_numbers(|own| own.positive));
        let numbers = list(arrays.numbers.iter().copied(), number);
        array(number_type, real, "numbers", arrays.numbers.len(), numbers);
    }
    text += &look_up(arrays, name);
    Ok([header(arrays, name, bytes), text])
}
