//! The modelling language.
//!
//! A [`Model`] owns variables with bounds, linear rows, [indicators](Implication),
//! [disjunctions](Either), [logic](Logic), [functions](Function) of other variables, and one
//! objective. Expressions are plain values ([`Affine`], [`Quadratic`]); handles ([`Variable`],
//! [`Constraint`], [`Indicator`], [`LogicalConstraint`]) are `Copy`. Using a handle with another
//! model is an error. Solving borrows the model, so bounds and limits may be changed afterwards and
//! the model solved again.
//!
//! ```
//! use carom::prelude::*;
//!
//! let mut model = Model::new("corner");
//! let x = model.continuous("x", 0.0, 10.0)?;
//! let right = model.binary("right")?;
//! model.add("if_right", right.on().implies(x.ge(4.0)))?;
//! model.add("if_left", right.off().implies(x.le(1.0)))?;
//! model.minimize((x - 3.0).square())?;
//!
//! let mut solver = BranchAndBound::default();
//! let solution = solver.solve(&model)?;
//! assert!((solution.value(x)? - 4.0).abs() < 1e-6);
//!
//! // The same model again, with one bound changed.
//! model.set_bounds(x, 0.0, 3.0)?;
//! assert!((solver.solve(&model)?.value(x)? - 1.0).abs() < 1e-6);
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Constructs
//!
//! The [guide](crate::guide) has the mathematics. Here `a`, `b` and `z` are binaries, `n` is an
//! integer, `e`, `e1`, ... are affine expressions, and the rows are those of
//! [`reformulate::lower`](crate::reformulate::lower):
//!
//! | meaning | code | lowered to |
//! | --- | --- | --- |
//! | `e <= 3`, `1 <= e <= 3`, `e = 3` | `e.le(3.0)`, `e.within(1.0, 3.0)`, `e.equals(3.0)` | one row |
//! | a and not b | `a & !b` | two rows |
//! | a or b, not both | `a.xor(b)` | one row |
//! | if a, then b or z | `a.implies(b \| z)` | one row |
//! | a exactly when b | `a.iff(b)` | one row |
//! | at most 2 of many | `at_most(2, &hits)` | one row |
//! | z exactly when a and b | `z.iff(a & b)` | three rows |
//! | if z, then `e <= 3` | `z.on().implies(e.le(3.0))` | one big-M row per side |
//! | if a and not b, then `e <= 3` | `(a & !b).implies(e.le(3.0))` | one big-M row per side |
//! | if z, then several rows | `z.on().implies_all([r1, r2])` | one big-M row per row and side |
//! | z exactly when `e <= 3` | `z.on().reify(e.le(3.0), 0.01)` | two big-M rows |
//! | z exactly when `e` is 3 | `z.on().reify(e.equals(3.0), 0.01)` | four big-M rows, a clause and one binary |
//! | this or that | `either([r1, r2]).or(r3)` | a row of selectors; big-M, multi-M or hull rows |
//! | `z e` | `model.product("w", z, e)?` | four rows, the convex hull |
//! | `n e` | `model.product("w", n, e)?` | a binary and four rows per bit of `n` |
//! | `\|e\|` | `model.absolute("w", e)?` | two rows; two more and one binary if needed |
//! | `max(e, 0)` | `model.positive_part("w", e)?` | the same |
//! | `max(e1, e2, e3)` | `model.maximum("w", [e1, e2, e3])?` | one row per expression; twice as many, and binaries, if needed |
//! | `f(e)`, `f` piecewise affine | `model.piecewise("w", e, &f)?` | one row per piece; two per piece, and binaries, if needed |
//!
//! Functions need binaries unless bounds decide the case or the rest of the model pushes the
//! variable only to its convex side: minimising `|e|` needs none, maximising it does.
//!
//! ```
//! use carom::prelude::*;
//! use carom::reformulate;
//!
//! let mut model = Model::new("effort");
//! let u = model.continuous_family("u", 10, -2.0, 2.0)?;
//! let efforts: Vec<Variable> =
//!     (0..10).map(|t| model.absolute(("effort", t), u[t])).collect::<Result<_, _>>()?;
//! let total: Affine = efforts.iter().sum();
//! let binaries = |model: &Model| -> Result<usize, Error> {
//!     Ok(reformulate::lower(model)?.model().variable_count() - model.variable_count())
//! };
//! model.minimize(&total)?;
//! assert_eq!(binaries(&model)?, 0);
//! model.maximize(&total)?;
//! assert_eq!(binaries(&model)?, 10);
//! # Ok::<(), carom::Error>(())
//! ```

mod affine;
mod background;
mod checks;
mod convexity;
mod disjunction;
mod display;
mod function;
mod functions;
mod ids;
mod indicator;
mod literal;
mod logic;
pub mod lp;
pub mod mps;
mod name;
pub(crate) mod name_table;
mod objective;
mod operators;
mod parameter;
mod piecewise;
mod quadratic;
mod reformulation;
mod refs;
mod row;
mod sense;
#[cfg(feature = "serde")]
mod serialized;
mod statement;
mod statements;
mod store;
mod stored;
pub(crate) mod subset;
mod text;
mod variable;
mod variables;

pub use affine::Affine;
pub use disjunction::{Either, Selected, Term, either};
pub use function::Function;
pub use ids::{Constraint, Disjunction, Indicator, LogicalConstraint, Variable};
pub use indicator::{Consequent, Implication, Implications, Reification, Reified};
pub use literal::Literal;
pub use logic::{Logic, at_least, at_most, exactly};
pub use name::Name;
pub use piecewise::PiecewiseAffine;
pub use quadratic::Quadratic;
pub use reformulation::{BigM, Method, Reformulation};
pub use refs::{
    ConstraintRef, DisjunctionRef, FunctionRef, IndicatorRef, LogicalConstraintRef, TermRef,
    VariableRef,
};
pub use row::Row;
pub use sense::Sense;
pub use statement::Statement;
pub use store::Model;
pub use variable::{Family, VariableKind};

pub(crate) use affine::merge;
pub(crate) use ids::ModelTag;
pub(crate) use logic::Formula;
pub(crate) use stored::{StoredRow, StoredTerm};
pub(crate) use subset::{AnyStatement, statements, subset};
