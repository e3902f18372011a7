//! Models as MPS files, the common language of solvers.
//!
//! [`read()`] takes free and fixed MPS. [`write()`] makes free MPS that leads back to the same
//! model: names, order, kinds, limits and coefficients, every number to the last bit. Where names
//! have at most 8 characters and numbers at most 12, the text is fixed MPS as well.
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
//! A line that begins with `*` is a comment. A line that begins with any other character than
//! white space names a section; data lines are indented and split at white space. Text after
//! `ENDATA` is ignored; a file without `ENDATA` is refused, because it may have been cut off.
//! Section names, kinds and keywords may be in any case of letters. Numbers may have an exponent marked with `E`
//! or `D`. Magnitudes from 1e20 on, and the words `inf` and `infinity`, are infinite.
//!
//! Names with blanks are possible in fixed MPS only, where columns 2-3, 5-12, 15-22, 25-36, 40-47
//! and 50-61 hold the fields. A file with such names is read when its lines keep to these columns;
//! the names get an underscore for each blank, because names of a model have none.
//!
//! # Sections
//!
//! | section | meaning |
//! | --- | --- |
//! | `NAME` | the rest of the line is the model's name |
//! | `OBJNAME` | the name of the `N` row that is the objective, on the same line or the next |
//! | `OBJSENSE` | `MAX` or `MIN` (or `MAXIMIZE`, `MINIMIZE`), on the same line or the next; without it, minimise |
//! | `ROWS` | `N` (the first one is the objective, further ones are ignored), `L`, `G`, `E` |
//! | `COLUMNS` | column, then pairs of row and value; the entries of a column stand together; markers `'INTORG'` and `'INTEND'` enclose integer columns |
//! | `RHS` | set name (may be left out), then pairs of row and value; the objective's entry is *minus* its constant |
//! | `RANGES` | as `RHS`; an `L` row with value R becomes `[rhs - abs(R), rhs]`, a `G` row `[rhs, rhs + abs(R)]`, an `E` row `[rhs, rhs + R]` for `R >= 0` and `[rhs + R, rhs]` for `R < 0` |
//! | `BOUNDS` | kind, set name (may be left out), column and value; see below |
//! | `QUADOBJ` | two columns and an entry of Q in `1/2 x'Qx`; each pair once, from either triangle |
//! | `QSECTION` | the same; the objective's name may follow on the line of the section name |
//! | `QMATRIX` | the same with both triangles |
//! | `INDICATORS` | `IF row column 0` or `IF row column 1`: the row holds when the binary has that value |
//!
//! A row may be without entries, and a column with only a zero entry is kept. A row whose
//! right-hand side is infinite in the harmless direction says nothing and is ignored like a
//! further `N` row. A second set of right-hand sides, ranges or bounds is an error, as is anything
//! given twice. Special ordered sets, quadratic rows (`QCMATRIX`), lazy rows, functions and several
//! objectives are refused with a word on what to do instead.
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
//! Where a bound is not given:
//!
//! * A continuous column lies within `[0, inf)`.
//! * An integer column between markers that no entry of `BOUNDS` mentions lies within `[0, 1]`.
//!   One entry of any kind cancels this, and the other bound is then 0 or `inf`. Most solvers
//!   read such columns this way, some take `[0, inf)`.
//! * A negative upper bound makes a lower bound that is not given `-inf` (some solvers leave it at
//!   0, and the column is empty); an upper bound of 0 leaves it at 0. `MI` leaves the upper bound
//!   at `inf`.
//!
//! [`write()`] leaves nothing to these defaults but `[0, inf)` for a continuous column.
//!
//! An integer column whose bounds lie within `[0, 1]` becomes a
//! [binary](crate::model::VariableKind::Binary), because most files say binaries in this way. Only
//! where bounds are given as `LI` and `UI`, and the column is not the condition of an indicator, it
//! stays an integer.
//!
//! # Two-sided rows
//!
//! MPS gives one limit and the distance to the other, and in binary arithmetic the other limit
//! often cannot be hit exactly. Here the sum of right-hand side and range is formed on the
//! decimals of the file and rounded once, and `write` writes the decimal difference of the two
//! limits: `-1.2 <= x <= 1.1` has right-hand side `1.1` and range `2.3`. Readers that round in
//! between are off by one unit in the last place at most.
//!
//! # What MPS cannot hold
//!
//! A user's [big-M](crate::model::BigM) of an indicator is not written; the implication is. White
//! space around the model's name is lost.

mod bounds;
mod build;
mod decimal;
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
/// [`ErrorKind::Parse`] with the line and column of whatever is damaged, unknown, given twice or
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
/// [`ErrorKind::InvalidName`] when the model's name contains a line break or another control
/// character; [`ErrorKind::NotInFile`] for logic, compound conditions, disjunctions and functions,
/// which the lowered model has no more.
///
/// # Complexity
///
/// Linear in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
