//! A step of a hybrid system: what the encoder, simulators, reach sets, tubes, terminal sets and
//! diagnosis read of its statement.
//!
//! | part | file |
//! | --- | --- |
//! | affine forms of states and inputs | `step/affine_form.rs` |
//! | the conditions of transitions and of the system | `step/condition.rs` |
//! | next states, outputs and guards of a transition | `step/dynamics.rs` |
//! | joint transitions | `step/cartesian_product.rs` |

mod affine_form;
mod cartesian_product;
mod condition;
mod dynamics;

pub(crate) use affine_form::{AffineForm, combine};
pub(crate) use cartesian_product::CartesianProduct;
pub(crate) use condition::{ConditionMaps, ConditionSet, Moment, StepCondition};
pub(crate) use dynamics::{Dynamics, dynamics, flow, output_names, sum};
