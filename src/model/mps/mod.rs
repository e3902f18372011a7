//! Models as MPS files, the format that every solver reads.
//!
//! [`read()`] accepts free and fixed MPS. [`write()`] makes free MPS. Reading a written file gives
//! the same model: names, order, kinds, limits and coefficients, every number to the last bit. If
//! names have at most 8 characters and numbers at most 12, the text is fixed MPS as well.
//!
//! ```
//! use carom::model::mps;
//! use carom::prelude::*;
//!
//! let mut model = Model::new("walk");
//! let x = model.continuous("x", 0.0, 10.0)?;
//! let hit = model.binary("hit")?;
//! model.add("reach", (x + 2.0 * hit).within(1.5, 4.0))?;
//! model.add("stop", hit.on().implies(x.le(0.5)))?;
//! model.minimize(x.square() - 3.0 * x)?;
//!
//! let text = mps::write(&model)?;
//! assert_eq!(mps::read(&text)?.to_string(), model.to_string());
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Lines
//!
//! A line that begins with `*` is a comment. A line that begins with any other character than white
//! space names a section; data lines are indented and split at white space. Text after `ENDATA` is
//! ignored; a file without `ENDATA` is refused, because it may be truncated. Case does not matter
//! in section names, kinds and keywords. Numbers may have an exponent marked with `E` or `D`.
//! Magnitudes from 1e20 on, and the words `inf` and `infinity`, are infinite.
//!
//! Names with blanks are possible in fixed MPS only, where columns 2-3, 5-12, 15-22, 25-36, 40-47
//! and 50-61 hold the fields. A file with such names is read if its lines keep to these columns.
//! Each blank becomes an underscore, because names in a model have no blanks.
//!
//! # Sections
//!
//! | section | meaning |
//! | --- | --- |
//! | `NAME` | the rest of the line is the model's name |
//! | `OBJNAME` | the name of the `N` row that is the objective, on the same line or the next |
//! | `OBJSENSE` | `MAX` or `MIN` (or `MAXIMIZE`, `MINIMIZE`), on the same line or the next; without it, minimise |
//! | `ROWS` | `N` (the first one is the objective, further ones are ignored), `L`, `G`, `E` |
//! | `COLUMNS` | column, then pairs of row and value; the entries of a column are together; markers `'INTORG'` and `'INTEND'` enclose integer columns |
//! | `RHS` | set name (may be left out), then pairs of row and value; the objective's entry is *minus* its constant |
//! | `RANGES` | as `RHS`; an `L` row with value R becomes `[rhs - abs(R), rhs]`, a `G` row `[rhs, rhs + abs(R)]`, an `E` row `[rhs, rhs + R]` for `R >= 0` and `[rhs + R, rhs]` for `R < 0` |
//! | `BOUNDS` | kind, set name (may be left out), column and value; see below |
//! | `QUADOBJ` | two columns and an entry of Q in `1/2 x'Qx`; each pair once, from either triangle |
//! | `QSECTION` | the same; the objective's name may follow on the line of the section name |
//! | `QMATRIX` | the same with both triangles |
//! | `INDICATORS` | `IF row column 0` or `IF row column 1`: the row holds when the binary has that value |
//!
//! Rows without entries and columns with only a zero entry are kept. A row that its infinite
//! right-hand side makes redundant is ignored, like a second `N` row. A second set of right-hand
//! sides, ranges or bounds is an error, as is anything given twice. Special ordered sets, quadratic
//! rows (`QCMATRIX`), lazy rows, functions and several objectives are errors that say what to do
//! instead.
//!
//! # Bounds
//!
//! | kind | effect |
//! | --- | --- |
//! | `LO`, `UP`, `FX` | lower, upper, both bounds |
//! | `FR`, `MI`, `PL` | both, the lower, the upper bound infinite |
//! | `BV` | integer within `[0, 1]` |
//! | `LI`, `UI` | lower, upper bound, and the column is integer |
//! | `SC`, `SI` | refused |
//!
//! Defaults of bounds:
//!
//! * A continuous column lies within `[0, inf)`.
//! * An integer column between markers that no entry of `BOUNDS` mentions lies within `[0, 1]`.
//!   One entry of any kind cancels this, and the other bound is then 0 or `inf`. Most solvers
//!   read such columns this way, some take `[0, inf)`.
//! * With a negative upper bound, a lower bound that is not given is `-inf` (some solvers leave it
//!   at 0, which makes the program infeasible). With an upper bound of 0 it is 0. `MI` leaves the
//!   upper bound at `inf`.
//!
//! [`write()`] relies only on the default `[0, inf)` of continuous columns.
//!
//! An integer column whose bounds lie within `[0, 1]` becomes a
//! [binary](crate::model::VariableKind::Binary), because most files write binaries in this way. It
//! stays an integer only if its bounds are given as `LI` and `UI` and it is not the condition of an
//! indicator.
//!
//! # Two-sided rows
//!
//! MPS gives one limit and the distance to the other, which in binary arithmetic often cannot
//! reproduce the other limit. `read` adds right-hand side and range in decimal and rounds once, and
//! `write` writes the decimal difference of the two limits: `-1.2 <= x <= 1.1` has right-hand side
//! `1.1` and range `2.3`. Readers that round in between are off by at most one unit in the last
//! place.
//!
//! # What MPS cannot hold
//!
//! A user's [big-M](crate::model::BigM) is not written; the implication is. White space around the
//! model's name is lost.

mod bounds;
mod build;
pub(crate) mod decimal;
mod fixed;
mod read;
mod section;
mod write;

use super::store::Model;
use crate::error::{Error, ErrorKind};

/// Reads a model from the text of an MPS file.
///
/// # Errors
///
/// [`ErrorKind::Parse`] with the line and column of anything damaged, unknown, given twice or
/// contradictory; [`ErrorKind::NotConvex`] for a quadratic objective that is not convex in its
/// direction.
///
/// # Complexity
///
/// Linear in the length of the text, but for the convexity check of a quadratic objective.
pub fn read(text: &str) -> Result<Model, Error> {
    let model = |text: &str| build::model(&read::File::scan(text)?);
    model(text).or_else(|error| match fixed::without_blanks(text) {
        Some(text) if matches!(error.kind(), ErrorKind::Parse { .. }) => model(&text),
        _ => Err(error),
    })
}

/// Writes a model as free MPS.
///
/// # Errors
///
/// [`ErrorKind::InvalidName`] if the model's name contains a line break or another control
/// character; [`ErrorKind::NotInFile`] for logic, compound conditions, disjunctions and functions,
/// which the lowered model no longer has.
///
/// # Complexity
///
/// Linear in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
