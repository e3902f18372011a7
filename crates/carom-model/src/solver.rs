//! The trait [`Solver`] and what all backends share: options, progress events, interrupts, and the
//! [certificate](certify) of points from elsewhere.
//!
//! ```
//! use carom::prelude::*;
//! use std::time::Duration;
//!
//! let mut model = Model::new("m");
//! let x = model.integer("x", 0.0, 10.0)?;
//! model.add("odd", (2.0 * x).within(3.0, 9.0))?;
//! model.maximize(x)?;
//!
//! let options = Options::default().with_time_limit(Duration::from_secs(5));
//! let mut solver = BranchAndBound::new(options);
//! let solution = solver.solve(&model)?;
//! assert!(solution.is_optimal());
//! assert_eq!(solution.value(x)?, 4.0);
//! # Ok::<(), carom::Error>(())
//! ```

mod certificate;
pub(crate) mod control;
mod heuristics;
mod log;
mod log_columns;
mod mip_start;
mod options;
pub(crate) mod prepared;
mod progress;
mod relaxation_method;
mod rules;
pub(crate) mod stop_token;
mod tree_exchange;

pub use certificate::{Certificate, certify};
#[doc(alias = "callback")]
pub use control::Control;
pub use control::Interrupt;
pub use heuristics::Heuristics;
pub use log::Log;
#[doc(alias("warm start", "initial solution", "hint"))]
pub use mip_start::MipStart;
pub use options::{Options, PoolMode};
pub use prepared::Prepared;
pub use progress::{Event, Incumbent, ProgramSize, Progress};
pub use relaxation_method::RelaxationMethod;
pub use rules::BranchingRule;
#[doc(alias = "cancel")]
pub use stop_token::StopToken;
pub use tree_exchange::{Elsewhere, OpenNode, PartState, TreeExchange, TreePart};

use crate::error::Error;
use crate::model::Model;
use crate::solution::Solution;

/// A backend that solves models to proved optimality.
///
/// # Contract
///
/// * [`Termination::Optimal`](crate::solution::Termination::Optimal) is claimed only if bound and
///   point meet the gap of the options. Infeasibility and bounds are proved.
/// * A limit or an interrupt returns the best verified point so far with a valid bound.
/// * Infeasible, unbounded and limits are statuses of the solution; an [`Error`] means misuse or
///   breakdown.
/// * Lazy constraints of the control are used, or [refused](Control::refuse_lazy_constraints).
/// * The model is only borrowed, and a solver can be used again after any outcome.
pub trait Solver {
    /// A short name, for reports.
    fn name(&self) -> &str;

    /// The options in force.
    fn options(&self) -> &Options;

    /// The options, for changes.
    fn options_mut(&mut self) -> &mut Options;

    /// Solves a model under the given control.
    ///
    /// # Errors
    ///
    /// Errors of lowering
    /// ([`ErrorKind::UnboundedIndicator`](crate::error::ErrorKind::UnboundedIndicator),
    /// [`ErrorKind::UnboundedFunction`](crate::error::ErrorKind::UnboundedFunction),
    /// [`ErrorKind::UnsafeBigM`](crate::error::ErrorKind::UnsafeBigM)), of options
    /// ([`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange)) and of the backend
    /// ([`ErrorKind::Backend`](crate::error::ErrorKind::Backend)).
    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error>;

    /// Solves a model without progress events and without an interrupt.
    ///
    /// # Errors
    ///
    /// As for [`solve_with`](Solver::solve_with).
    fn solve(&mut self, model: &Model) -> Result<Solution, Error> {
        self.solve_with(model, &mut Control::default())
    }

    /// Prepares a model for many solves with other values of its parameters.
    ///
    /// By default nothing is prepared, and every solve begins from nothing.
    ///
    /// # Errors
    ///
    /// Errors of lowering, as for [`solve_with`](Solver::solve_with).
    fn prepare<'a>(&'a mut self, model: &Model) -> Result<Box<dyn Prepared + 'a>, Error> {
        Ok(prepared::prepared_afresh(self, model))
    }
}
