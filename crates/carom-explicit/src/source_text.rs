//! The common parts of sources in Rust and C: lists of numbers, names, remarks.

use std::fmt::{Debug, Write};

use carom_embedded::LookupNumber;
use carom_model::{Error, ErrorKind};

use crate::arrays::LookupArrays;
use crate::operations::LookupOperations;

/// Columns of a line of numbers.
const SOURCE_LINE: usize = 96;

/// A number of a table, as text.
pub(crate) trait SourceNumber: LookupNumber + Debug {
    /// The names of the type in Rust and in C.
    const TYPES: [&'static str; 2];
    /// The end of a number in C.
    const SUFFIX: &'static str;
    fn is_infinite(self) -> bool;
}

impl SourceNumber for f32 {
    const TYPES: [&'static str; 2] = ["f32", "float"];
    const SUFFIX: &'static str = "F";
    fn is_infinite(self) -> bool {
        f32::is_infinite(self)
    }
}

impl SourceNumber for f64 {
    const TYPES: [&'static str; 2] = ["f64", "double"];
    const SUFFIX: &'static str = "";
    fn is_infinite(self) -> bool {
        f64::is_infinite(self)
    }
}

/// Entries with commas, in lines that are not too long.
pub(crate) fn list<T>(entries: impl IntoIterator<Item = T>, text: impl Fn(T) -> String) -> String {
    let mut all = String::new();
    let mut length = 0;
    for entry in entries {
        let entry = text(entry);
        let starts = length == 0 || length + entry.len() + 2 > SOURCE_LINE;
        all += if starts { "\n    " } else { " " };
        length = if starts { 4 } else { length + 1 } + entry.len() + 1;
        all += &entry;
        all.push(',');
    }
    all
}

/// Refuses what is no name in Rust and C.
pub(crate) fn check_name(name: &str) -> Result<(), Error> {
    let is_letter = |letter: char| letter == '_' || letter.is_ascii_alphanumeric();
    let begins = name.starts_with(|letter: char| letter == '_' || letter.is_ascii_alphabetic());
    if begins && name.chars().all(is_letter) {
        return Ok(());
    }
    Err(ErrorKind::Unsupported {
        solver: "the source of a table".to_owned(),
        what: format!("the name `{name}`"),
        help: "use letters, digits and `_`, and begin with no digit".to_owned(),
    }
    .into())
}

/// Lines that a source says of its table.
pub(crate) fn said<T>(arrays: &LookupArrays<T>, bytes: usize) -> Vec<String> {
    let mut lines = arrays.remarks.clone();
    lines.push(format!("{bytes} bytes of constants"));
    let LookupOperations { comparisons, products, divisions } = arrays.operations();
    let divided = match divisions {
        0 => String::new(),
        _ => format!(", {divisions} divisions"),
    };
    lines.push(format!(
        "at most {comparisons} comparisons, {products} multiplications and as many sums{divided}"
    ));
    if !arrays.programs.is_empty() {
        let exchanges = arrays.programs.iter().map(|program| program.exchanges).max();
        lines.push(format!(
            "{} programs, with at most {} exchanges, in {} numbers of work space",
            arrays.programs.len(),
            exchanges.unwrap_or(0),
            arrays.work()
        ));
        lines.push(format!(
            "by rounding in programs, rows are missed by at most {:.1e}, and the loss is larger by at \
             most {:.1e}",
            arrays.row_rounding, arrays.loss_rounding
        ));
    }
    let mut off = String::new();
    for (a, state) in arrays.state_rounding.iter().enumerate() {
        let _ = write!(off, "{}{state:.1e}", if a == 0 { "" } else { ", " });
    }
    lines.push(format!("a state is rounded by at most {off}"));
    lines.push(format!("an input is rounded by at most {:.1e}", arrays.input_rounding));
    lines
}
