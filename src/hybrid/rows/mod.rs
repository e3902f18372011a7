//! A hybrid system as rows of a model.
//!
//! | part | file |
//! | --- | --- |
//! | what is written, and in which order | `rows/write.rs` |
//! | handles by name and step | `rows/program.rs` |
//! | runs that are read back | `rows/run.rs` |
//! | extreme points near a run | `rows/extreme.rs` |
//! | transitions as affine functions | `rows/map.rs` |
//! | what transitions change about the next state | `rows/change.rs` |
//! | which rows hold in every transition, which are left out | `rows/switch.rs` |
//! | bounds of linear functions without a solver | `rows/bound.rs` |
//! | the statements of a step | `rows/statements.rs` |
//! | modes with memory, dwell times | `rows/modes.rs` |
//! | names | `rows/names.rs` |

mod bound;
mod change;
mod extreme;
mod map;
mod modes;
mod names;
mod program;
mod run;
mod statements;
mod switch;
mod write;

pub use program::HybridProgram;
pub use run::HybridRun;

use super::horizon::Horizon;
use super::system::HybridSystem;
use crate::error::Error;
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::model::{Method, Model};
use crate::setters::setters;

/// How a hybrid system is written as rows.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RowOptions {
    /// How the choices among transitions become rows. By default, two transitions are a pair of
    /// implications, and three or more a disjunction, which the model's
    /// [`Reformulation`](crate::model::Reformulation) lowers.
    pub method: Option<Method>,
}

impl RowOptions {
    setters! {
        /// Lowers every choice by one method.
        with_method(method: Method) => method = Some(method);
    }
}

impl HybridSystem {
    /// Adds the system over a horizon to a model: variables and statements, none of which fix the
    /// beginning or the end.
    ///
    /// A part that all transitions of a choice share is stated once. Only what they change about the next
    /// state is switched, by variables whose bounds come from guards and domains. A [tube](
    /// super::reach::Tube::tighten) makes the bounds narrower.
    ///
    /// Statements that describe the system are [background](Model::set_background); ranges of
    /// inputs and half-spaces that [could be dropped](super::Halfspace::limit) are not.
    ///
    /// # Arguments
    ///
    /// * `prefix`: the beginning of every name, as in `cab_x[3]`; empty for plain names. Blanks in
    ///   names become underscores.
    ///
    /// ```
    /// use carom::hybrid::{Horizon, HybridSystem, LinearSystem, Transition};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// // A cart with a weak and a strong drive.
    /// let drive = |a: f64| LinearSystem::new([[1.0]], [[a]], [0.0]);
    /// let system = HybridSystem::new()
    ///     .with_state("x", Interval::new(-9.0, 9.0))
    ///     .with_input("u", Interval::new(-1.0, 1.0))
    ///     .with_transition(Transition::new("weak", drive(1.0)?))
    ///     .with_transition(Transition::new("strong", drive(3.0)?));
    ///
    /// let mut model = Model::new("m");
    /// let cart = system.write(&mut model, "cart", &Horizon::new(2, 0.1)?)?;
    /// let x = cart.state("x")?.clone();
    /// model.fix(x[0], 0.0)?;
    /// model.fix(x[2], 4.0)?;
    /// let strong = cart.taken("mode", "strong", 0)?.expect("one of two transitions");
    /// model.add("late", strong.variable().off())?;
    ///
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// let run = cart.read(&solution)?;
    /// assert_eq!(run.transitions("mode")?, ["weak", "strong"]);
    /// assert!((run.state("x")?[1] - 1.0).abs() < 1e-6);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::check`]; [`ErrorKind::DuplicateName`] if a name is taken;
    /// [`ErrorKind::CrossedBounds`] if an input has no value that any transition allows. The model
    /// then stays as it was.
    pub fn write(
        &self,
        model: &mut Model,
        prefix: &str,
        horizon: &Horizon,
    ) -> Result<HybridProgram, Error> {
        self.write_with(model, prefix, horizon, &RowOptions::default())
    }

    /// As [`write`](HybridSystem::write), with options.
    ///
    /// # Errors
    ///
    /// Those of [`write`](HybridSystem::write).
    pub fn write_with(
        &self,
        model: &mut Model,
        prefix: &str,
        horizon: &Horizon,
        options: &RowOptions,
    ) -> Result<HybridProgram, Error> {
        self.check()?;
        write::write(self, model, prefix, horizon, options)
    }
}
