#![doc = include_str!("../../docs/modules/model.md")]

mod affine;
mod background;
mod by_step;
pub mod cbf;
mod checks;
mod conic;
mod convexity;
mod disjunction;
mod display;
mod family_shape;
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
mod semicontinuous;
mod sense;
#[cfg(feature = "serde")]
mod serialized;
mod sos;
mod statement;
mod statements;
mod store;
mod stored;
pub(crate) mod subset;
mod text;
mod variable;
mod variables;

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

pub(crate) use affine::merge;
pub(crate) use conic::{StandardCone, StoredConic};
pub(crate) use convexity::WRITE_SQUARES;
pub(crate) use ids::ModelTag;
pub(crate) use logic::Formula;
pub(crate) use name::is_name;
pub(crate) use operators::{products, scaling, sums};
pub(crate) use row::comparisons;
pub(crate) use stored::{StoredRow, StoredTerm};
pub(crate) use subset::{AnyStatement, statements, subset};
#[cfg(not(target_family = "wasm"))]
pub(crate) use text::quadratic_rows::with_quadratic_rows;
