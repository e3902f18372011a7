//! The names most programs need, listed one by one.
//!
//! ```
//! use carom::prelude::*;
//! ```

pub use crate::BranchAndBound;
pub use crate::error::Error;
pub use crate::graph_of_sets::GraphOfSets;
pub use crate::hybrid::scene::{Body, Scene, Shape, Solid, Surface};
pub use crate::hybrid::{
    ControlMove, Disturbance, Feedback, HybridPlan, HybridProgram, HybridSystem, Input,
    LinearSystem, Mission, MoveSource, RecedingHorizon, Region, Restitution, ShortestHorizon,
    ShortestOptions, SimulationOptions, State, When,
};
pub use crate::model::{
    Affine, ConicConstraint, ConicRow, Constraint, Either, Family, Implication, Indicator, Literal,
    Logic, LogicalConstraint, Model, Name, PiecewiseAffine, Quadratic, Row, Sense, Variable,
    VariableKind, at_least, at_most, either, exactly, norm,
};
pub use crate::solution::{PrimalStatus, Solution, Statistics, Termination, Verification};
pub use crate::solver::{Control, Event, Incumbent, Interrupt, Log, Options, Progress, Solver};
