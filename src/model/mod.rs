//! The modelling language: what a program says, before anyone decides how to solve it.
//!
//! A [`Model`] owns variables with bounds, linear rows, [indicators](Implication),
//! [logic](Logic), [functions](Function) of other variables, and one objective. Expressions are plain values ([`Affine`], [`Quadratic`]); handles ([`Variable`],
//! [`Constraint`], [`Indicator`], [`LogicalConstraint`]) are `Copy` and are checked: a handle of another model is an
//! error, never a wrong answer. Solving borrows a model, so bounds and limits may be changed
//! afterwards and the model solved again.
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

mod affine;
mod convexity;
mod display;
mod function;
mod functions;
mod ids;
mod indicator;
mod logic;
pub mod mps;
mod name;
mod objective;
mod operators;
mod piecewise;
mod quadratic;
mod refs;
mod row;
mod statement;
mod statements;
mod store;
mod variable;
mod variables;

pub use affine::Affine;
pub use function::Function;
pub use ids::{Constraint, Indicator, LogicalConstraint, Variable};
pub use indicator::{BigM, Consequent, Implication, Implications, Literal, Reification, Reified};
pub use logic::{Logic, at_least, at_most, exactly};
pub use name::Name;
pub use objective::Sense;
pub use piecewise::PiecewiseAffine;
pub use quadratic::Quadratic;
pub use refs::{ConstraintRef, FunctionRef, IndicatorRef, LogicalConstraintRef, VariableRef};
pub use row::Row;
pub use statement::Statement;
pub use store::Model;
pub use variable::{Family, VariableKind};

pub(crate) use ids::ModelTag;
pub(crate) use logic::Formula;
pub(crate) use statement::StoredRow;
