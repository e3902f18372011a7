//! Models as LP files, the format of solvers that people can read.
//!
//! [`read()`] takes the dialects of CPLEX, Gurobi, HiGHS and SCIP as far as a model can hold what
//! they say. [`write()`] writes what these read, and leads back to the same model: names, order,
//! kinds, limits and coefficients, every number to the last bit.
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
//! # What is read
//!
//! | section | spellings | contents |
//! | --- | --- | --- |
//! | objective | `Minimize`, `Minimise`, `Minimum`, `Min`, `Maximize`, ... | maybe a label; linear terms, constants, and products as `[ 2 x ^2 + 4 x * y ] / 2`, with or without the `/ 2` |
//! | rows | `Subject To`, `Such That`, `st`, `s.t.`, `st.` | maybe a label; `x + 2 y <= 4`, also `<`, `=<`, `>=`, `>`, `=>`, `=`; `1 <= x + y <= 4`; `z = 1 -> x <= 4`, `z = 0 -> x <= 4` |
//! | bounds | `Bounds`, `Bound` | `1 <= x <= 2`, `x <= 2`, `x >= 1`, `1 <= x`, `x = 3`, `x free`; `inf` and `infinity` with a sign |
//! | integers | `General`, `Generals`, `Gen`, `Integer`, `Integers`, `Int` | names |
//! | binaries | `Binary`, `Binaries`, `Bin` | names |
//! | end | `End` | nothing; what follows is ignored, and a file without it is refused, because it may have been cut off |
//!
//! Keywords may be in any case of letters. Line breaks mean nothing, but that a row without label
//! begins on a new line, and that a backslash makes the rest of its line a comment. A comment
//! `\ Problem name: ...` before the objective names the model. Sections behind the objective may
//! come in any order and repeatedly.
//!
//! Terms of the same variable are added up. Constants on the left of a row are moved to the right.
//! A row without label is named after its position, `c1`, `c2`, ... Magnitudes from 1e20 on are
//! infinite; a row without a finite limit says nothing and is left out.
//!
//! Variables are in the order of their first appearance, wherever that is. Bounds are 0 and
//! infinity where none are given (1 for a binary). The upper bound being negative does not change
//! this, so that a lower bound must be given. As in [MPS files](super::mps), a bound given twice
//! with different values is an error, and an integer variable within `[0, 1]` that is the condition
//! of an indicator is a binary.
//!
//! Not read, with an error that says what to do instead: semi-continuous variables, special ordered
//! sets, lazy constraints and cuts, functions, several objectives, quadratic rows, `<->`. Such
//! sections are skipped where they are empty.
//!
//! # Names
//!
//! The format needs some characters itself, and readers differ in the others. These names are
//! written in other letters, which reading turns back:
//!
//! * the step of a family stands in braces: `x[3]` is written `x{3}`;
//! * `+ - * / ^ : < > = \ [ ]` anywhere, digits and `. , ( )` at the beginning, and the first letter
//!   of a keyword are written as a percent sign and two hexadecimal digits: `a-b` as `a%2Db`, `free` as
//!   `%66ree`;
//! * so are `%` and `{`, where the name would otherwise be taken for a written one.
//!
//! All other names are written as they are. A name in a file that [`write()`] would not write, such
//! as `x[3]` or `100%`, is taken as it stands.
//!
//! # What is written
//!
//! Two limits of one row are written as two rows, `name%ge` and `name%le`, because neither HiGHS nor
//! SCIP reads them in one; reading such a pair makes one row of it. Columns are listed in the
//! objective with the coefficient 0 where they would otherwise appear in another order, or not at
//! all.
//!
//! # What LP files cannot hold
//!
//! A user's [big-M](crate::model::BigM) of an indicator is not written; the implication is. White
//! space around the model's name is lost.

mod bounds;
mod build;
mod expression;
mod lexer;
mod names;
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
/// [`ErrorKind::Parse`](crate::ErrorKind::Parse) with the line and column of whatever is damaged,
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
