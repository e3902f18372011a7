//! Models as LP files, a text format that people can read.
//!
//! [`read()`] accepts the dialects of CPLEX, Gurobi, HiGHS and SCIP, except for constructs that a
//! model cannot hold. [`write()`] writes what these solvers read. Reading a written file gives the
//! same model: names, order, kinds, limits and coefficients, every number to the last bit.
//!
//! ```
//! use carom::model::lp;
//! use carom::prelude::*;
//!
//! let mut model = Model::new("walk");
//! let x = model.continuous_family("x", 2, 0.0, 10.0)?;
//! let hit = model.binary("hit")?;
//! model.add("reach", (x[0] + 2.0 * x[1]).within(1.5, 4.0))?;
//! model.add("stop", hit.on().implies(x[1].le(0.5)))?;
//! model.minimize(x[0].square() - 3.0 * x[1] - hit)?;
//!
//! let text = lp::write(&model)?;
//! assert_eq!(
//!     text,
//!     "\\ Problem name: walk\n\
//!      Minimize\n \
//!       obj: 0 x{0} - 3 x{1} - hit + [ 2 x{0} ^2 ] / 2\n\
//!      Subject To\n \
//!       reach%ge: x{0} + 2 x{1} >= 1.5\n \
//!       reach%le: x{0} + 2 x{1} <= 4\n \
//!       stop: hit = 1 -> x{1} <= 0.5\n\
//!      Bounds\n \
//!       0 <= x{0} <= 10\n \
//!       0 <= x{1} <= 10\n\
//!      Binary\n \
//!       hit\n\
//!      End\n"
//! );
//! assert_eq!(lp::read(&text)?.to_string(), model.to_string());
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Reading
//!
//! | section | spellings | contents |
//! | --- | --- | --- |
//! | objective | `Minimize`, `Minimise`, `Minimum`, `Min`, `Maximize`, ... | maybe a label; linear terms, constants, and products as `[ 2 x ^2 + 4 x * y ] / 2`, with or without the `/ 2` |
//! | rows | `Subject To`, `Such That`, `st`, `s.t.`, `st.` | maybe a label; `x + 2 y <= 4`, also `<`, `=<`, `>=`, `>`, `=>`, `=`; `1 <= x + y <= 4`; `z = 1 -> x <= 4`, `z = 0 -> x <= 4` |
//! | bounds | `Bounds`, `Bound` | `1 <= x <= 2`, `x <= 2`, `x >= 1`, `1 <= x`, `x = 3`, `x free`; `inf` and `infinity` with a sign |
//! | integers | `General`, `Generals`, `Gen`, `Integer`, `Integers`, `Int` | names |
//! | binaries | `Binary`, `Binaries`, `Bin` | names |
//! | end | `End` | none; text after it is ignored, and a file without it is refused, because it may be truncated |
//!
//! Case does not matter in keywords. Line breaks have no meaning, except that a row without a label
//! begins on a new line. A backslash makes the rest of its line a comment. A comment
//! `\ Problem name: ...` before the objective names the model. Sections after the objective can
//! come in any order and can be repeated.
//!
//! Terms of the same variable are added up. Constants on the left of a row are moved to the right.
//! A row without a label is named after its position, `c1`, `c2`, ... Magnitudes from 1e20 on are
//! infinite; a row without a finite limit is left out.
//!
//! Variables are in the order of their first appearance in the file. Bounds that are not given are
//! 0 and infinity (1 for a binary). A negative upper bound does not change this, so it needs an
//! explicit lower bound. As in [MPS files](super::mps), a bound given twice with different values
//! is an error, and an integer variable within `[0, 1]` that is the condition of an indicator is a
//! binary.
//!
//! Semi-continuous variables, special ordered sets, lazy constraints and cuts, functions, several
//! objectives, quadratic rows and `<->` are errors that say what to do instead. Such sections are
//! skipped if they are empty.
//!
//! # Names
//!
//! The format reserves some characters, and readers differ in others. Names are encoded as follows,
//! and decoded when read:
//!
//! * the step of a family is in braces: `x[3]` is written `x{3}`;
//! * `+ - * / ^ : < > = \ [ ]` anywhere, digits and `. , ( )` at the beginning, and the first letter
//!   of a keyword are written as a percent sign and two hexadecimal digits: `a-b` as `a%2Db`, `free` as
//!   `%66ree`;
//! * so are `%` and `{`, if the name would otherwise be decoded.
//!
//! All other names are written unchanged. A name that [`write()`] would not produce, such as `x[3]`
//! or `100%`, is read unchanged.
//!
//! # Writing
//!
//! A row with two limits is written as two rows, `name%ge` and `name%le`, because neither HiGHS nor
//! SCIP reads both in one. Reading joins such a pair. Columns that would otherwise appear in
//! another order, or not at all, are listed in the objective with coefficient 0.
//!
//! # What LP files cannot hold
//!
//! A user's [big-M](crate::model::BigM) is not written; the implication is. White space around the
//! model's name is lost.

mod bounds;
mod build;
mod expression;
mod lexer;
pub(crate) mod names;
mod read;
mod rows;
mod section;
mod write;

use super::store::Model;
use crate::error::Error;

/// Reads a model from the text of an LP file.
///
/// # Errors
///
/// [`ErrorKind::Parse`](crate::ErrorKind::Parse) with the line and column of anything damaged,
/// unknown or contradictory; [`ErrorKind::NotConvex`](crate::ErrorKind::NotConvex) for a quadratic
/// objective that is not convex in its direction.
///
/// # Complexity
///
/// Linear in the length of the text (but for sorting the terms of each row), and the convexity
/// check of a quadratic objective.
pub fn read(text: &str) -> Result<Model, Error> {
    build::model(&read::File::scan(text)?)
}

/// Writes a model as an LP file.
///
/// # Errors
///
/// [`ErrorKind::InvalidName`](crate::ErrorKind::InvalidName) when the model's name contains a line
/// break or another control character; [`ErrorKind::NotInFile`](crate::ErrorKind::NotInFile) for
/// logic, compound conditions, disjunctions and functions, which the lowered model has no more.
///
/// # Complexity
///
/// Linear in the size of the model.
pub fn write(model: &Model) -> Result<String, Error> {
    write::text(model)
}
