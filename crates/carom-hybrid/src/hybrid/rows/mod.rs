//! A hybrid system as rows of a model.
//!
//! | part | file |
//! | --- | --- |
//! | what is written, and in which order | `rows/write.rs` |
//! | handles by name and step | `rows/program.rs` |
//! | runs that are read back | `rows/run.rs` |
//! | extreme points near a run | `rows/extreme.rs` |
//! | transitions as affine functions | `step`, beside this folder |
//! | what transitions change about the next state | `rows/change.rs` |
//! | which rows hold in every transition, which are left out | `rows/switch.rs` |
//! | rows with an M for each transition | `rows/support.rs` |
//! | bounds of linear functions without a solver | `rows/bound.rs` |
//! | the same by a simplex method | `rows/largest.rs` |
//! | the statements of a step | `rows/statements.rs` |
//! | inputs that take some values only | `rows/levels.rs` |
//! | rows that are constant | `rows/constant_rows.rs` |
//! | modes with memory, dwell times | `rows/modes.rs` |
//! | the memory with which a run begins | `rows/memory.rs` |
//! | names | `rows/names.rs` |

mod bound;
mod change;
mod constant_rows;
mod extreme;
mod functions;
mod largest;
mod levels;
mod memory;
mod modes;
mod names;
mod program;
mod run;
mod statements;
mod support;
mod switch;
mod write;

pub(crate) use extreme::push_outward;
pub(crate) use memory::MemoryRow;
#[doc(hidden)]
pub use program::SystemVariables;
pub use run::HybridRun;
pub(crate) use run::Named;
pub(in crate::hybrid) use write::expression;

use super::horizon::Horizon;
use super::system::{HybridSystem, Restated};
use crate::error::Error;
use crate::model::{Method, Model};

impl HybridSystem {
    /// Adds the system over a horizon to a model: variables and statements, none of which fix the
    /// beginning or the end. Names begin with `prefix`. By the default method, two transitions are
    /// a pair of implications, and three or more a disjunction. An error leaves the model as it
    /// was.
    #[doc(hidden)]
    pub fn write_by(
        &self,
        model: &mut Model,
        prefix: &str,
        steps: usize,
        method: Option<Method>,
    ) -> Result<SystemVariables, Error> {
        self.check()?;
        let restated = self.restated()?;
        self.write_restated(&restated, model, prefix, &Horizon::new(steps, self.time_step)?, method)
    }

    /// Adds the system in given coordinates.
    pub(crate) fn write_restated(
        &self,
        restated: &Restated,
        model: &mut Model,
        prefix: &str,
        horizon: &Horizon,
        method: Option<Method>,
    ) -> Result<SystemVariables, Error> {
        let coordinates = &restated.coordinates;
        let variables = write::write(restated, model, prefix, horizon, method)?;
        Ok(match coordinates.is_plain() {
            true => variables,
            false => variables.stated_as(self, coordinates),
        })
    }

    /// As [`write_by`](HybridSystem::write_by), by the default method.
    #[doc(hidden)]
    pub fn write(
        &self,
        model: &mut Model,
        prefix: &str,
        steps: usize,
    ) -> Result<SystemVariables, Error> {
        self.write_by(model, prefix, steps, None)
    }
}
