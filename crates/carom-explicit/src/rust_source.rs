//! A table as a constant in Rust.

use carom_embedded::{LookupLeaf, LookupProgram, LookupTable};
use carom_model::Error;

use crate::arrays::LookupArrays;
use crate::source_text::{SourceNumber, check_name, list, said};

impl LookupArrays<f32> {
    /// The table as a `const` in Rust, in the types of the crate `carom-embedded`, with worst-case
    /// operations and bytes in front. The same text for the same table.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Unsupported`](carom_model::ErrorKind::Unsupported) for a name that is none.
    pub fn rust_source(&self, name: &str) -> Result<String, Error> {
        source(self, name)
    }
}

impl LookupArrays<f64> {
    /// As for 32 bits.
    ///
    /// # Errors
    ///
    /// As for 32 bits.
    pub fn rust_source(&self, name: &str) -> Result<String, Error> {
        source(self, name)
    }
}

fn number<T: SourceNumber>(value: T) -> String {
    let [name, _] = T::TYPES;
    match value.is_infinite() {
        true => format!("{name}::INFINITY"),
        false => format!("{value:?}"),
    }
}

fn code(code: u32) -> String {
    match code & LookupTable::<f64>::LEAF {
        0 => code.to_string(),
        leaf => format!("LEAF + {}", code ^ leaf),
    }
}

fn source<T: SourceNumber>(arrays: &LookupArrays<T>, name: &str) -> Result<String, Error> {
    check_name(name)?;
    let [number_type, _] = T::TYPES;
    let mut text = String::new();
    for line in said(arrays, arrays.bytes()) {
        text += &format!("/// {line}.\n///\n");
    }
    text.truncate(text.len() - 4);
    text += &format!(
        "#[rustfmt::skip]\n#[allow(clippy::all, dead_code)]\npub const {name}: carom_embedded::LookupTable<{number_type}> = {{\n"
    );
    let program = if arrays.programs.is_empty() { "" } else { "LookupProgram, " };
    text += &format!("use carom_embedded::{{LookupLeaf, LookupNode, {program}LookupTable}};\n");
    text += "const LEAF: u32 = LookupTable::<f32>::LEAF;\n";
    text += "const fn n(i: u8, j: u8, first: u32, second: u32) -> LookupNode {\n    \
             LookupNode { edge: [i, j], next: [first, second] }\n}\n";
    text += &format!(
        "const fn p(law: u32, loss: {number_type}) -> LookupLeaf<{number_type}> {{\n    \
         LookupLeaf::Plan {{ law, loss }}\n}}\n"
    );
    text += &format!(
        "const fn s(program: u32, loss: {number_type}) -> LookupLeaf<{number_type}> {{\n    \
         LookupLeaf::Solve {{ program, loss }}\n}}\nLookupTable {{\n"
    );
    let mut array = |field: &str, entries: String| {
        text += &format!("{field}: &[{entries}\n],\n");
    };
    array("lower", list(arrays.lower.iter().copied(), number));
    array("upper", list(arrays.upper.iter().copied(), number));
    array("scale", list(arrays.scale.iter().copied(), number));
    array("roots", list(arrays.roots.iter().copied(), code));
    let nodes = list(&arrays.nodes, |node| {
        let ([i, j], [first, second]) = (node.edge, node.next.map(code));
        format!("n({i}, {j}, {first}, {second})")
    });
    array("nodes", nodes);
    let leaves = list(&arrays.leaves, |leaf| match *leaf {
        LookupLeaf::Plan { law, loss } => format!("p({law}, {})", number(loss)),
        LookupLeaf::Solve { program, loss } => format!("s({program}, {})", number(loss)),
        LookupLeaf::NoPlan => "LookupLeaf::NoPlan".to_owned(),
        LookupLeaf::Open => "LookupLeaf::Open".to_owned(),
    });
    array("leaves", leaves);
    array("laws", list(&arrays.laws, u32::to_string));
    array("values", list(arrays.values.iter().copied(), number));
    let programs = list(&arrays.programs, |program| {
        let LookupProgram { rows, first, exchanges, negative, positive } = program;
        format!(
            "LookupProgram {{ rows: {rows}, first: {first}, exchanges: {exchanges}, \
             negative: {}, positive: {} }}",
            number(*negative),
            number(*positive)
        )
    });
    array("programs", programs);
    array("numbers", list(arrays.numbers.iter().copied(), number));
    text += &format!("inputs: {},\ndepth: {},\n}}\n}};\n", arrays.inputs, arrays.depth);
    text += &format!("const _: () = assert!({name}.is_sound());\n");
    Ok(text)
}
