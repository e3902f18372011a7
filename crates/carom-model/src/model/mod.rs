#![doc = include_str!("../../docs/model.md")]

pub(crate) mod affine;
mod background;
mod by_step;
pub mod cbf;
mod checks;
pub(crate) mod conic;
pub(crate) mod convexity;
mod disjunction;
mod display;
mod family_shape;
mod function;
mod functions;
pub(crate) mod ids;
mod indicator;
mod literal;
pub(crate) mod logic;
pub mod lp;
pub mod mps;
pub(crate) mod name;
pub(crate) mod name_table;
pub mod nl;
mod nonlinear;
mod objective;
mod operators;
mod parameter;
mod piecewise;
pub mod qplib;
mod quadratic;
mod reformulation;
mod refs;
mod row;
mod semicontinuous;
mod sense;
#[cfg(feature = "serde")]
mod serialized;
mod sos;
pub(crate) mod statement;
mod statements;
mod store;
pub(crate) mod stored;
pub(crate) mod subset;
pub(crate) mod text;
mod transaction;
mod variable;
mod variables;

pub use crate::elementary::{Elementary, OwnFunction, SmoothFunction};
pub use affine::Affine;
#[doc(alias("SOCP", "second-order cone"))]
pub use conic::norm;
pub use conic::{ConicRef, ConicRow, Norm, NormSum, NormSumRow};
#[doc(alias("disjunctive programming", "GDP"))]
pub use disjunction::either;
pub use disjunction::{Either, Selected, Term};
pub use family_shape::FamilyShape;
pub use function::Function;
pub use ids::{
    ConicConstraint, Constraint, Disjunction, Indicator, LogicalConstraint, SpecialOrderedSet,
    Variable,
};
pub use indicator::{Consequent, Implication, Implications, Reification, Reified};
pub use literal::Literal;
pub use logic::{Logic, at_least, at_most, exactly};
pub use name::Name;
pub use nonlinear::{Nonlinear, NonlinearRow};
#[doc(alias("piecewise linear", "PWL"))]
pub use piecewise::PiecewiseAffine;
pub use quadratic::Quadratic;
pub use reformulation::{BigM, Method, Reformulation};
pub use refs::{
    ConstraintRef, DisjunctionRef, FunctionRef, IndicatorRef, LogicalConstraintRef,
    SpecialOrderedSetRef, TermRef, VariableRef,
};
pub use row::Row;
pub use sense::Sense;
pub use sos::{Sos, sos1, sos2};
pub use statement::Statement;
#[doc(alias("MIP", "MILP", "MIQP", "problem"))]
pub use store::Model;
pub use text::read::{Read, Warning};
pub use variable::{Family, VariableKind};

pub(crate) use conic::StoredConic;
pub(crate) use ids::ModelTag;
