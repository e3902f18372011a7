//! A conformance suite for implementations of [`Solver`].
//!
//! The suite checks the contract of [`Solver`] on small programs with known answers: statuses,
//! points, objectives, bounds and gaps, limits and interrupts, progress events, rejected options,
//! and that a solver can be reused after any outcome. It uses backends only through the trait. It
//! does not panic: a [`Report`] says in words what failed, and a test asserts that it
//! [passed](Report::assert_passed):
//!
//! ```
//! use carom::conformance::{Capability, Suite};
//! use carom::prelude::*;
//!
//! let mut solver = BranchAndBound::default(); // or a backend of your own
//! let suite = Suite::default().without([Capability::Functions]); // what it does not offer
//! suite.run(&mut solver).assert_passed();
//! ```

mod answer;
mod capability;
mod conduct;
mod conic;
mod hybrid;
mod interrupts;
mod judge;
mod linear;
mod mixed;
mod programs;
mod report;

pub use capability::Capability;
pub use report::{CaseOutcome, Report};

#[doc(hidden)]
pub mod internals {
    //! Parts of this crate that tests of the workspace use beside its public interface. They may
    //! change in any release.

    pub use crate::answer::{Case, Truth};
    pub use crate::programs::answers;
}

use std::panic::{AssertUnwindSafe, catch_unwind};

use web_time::Duration;

use carom_model::solver::{Options, Solver};

use judge::Complaints;
use programs::answers;

/// A guard: a backend that respects its time limit fails a case and does not hang.
const GUARD: Duration = Duration::from_secs(60);

/// The suite, for a backend that lacks some capabilities; by default it lacks none.
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Suite {
    lacking: Vec<Capability>,
}

/// A check other than a program with an answer: its name, what it needs, what it does.
type Conduct = (&'static str, &'static [Capability], fn(&mut dyn Solver, &mut Complaints));

/// The checks, in the order in which they run.
const CONDUCT: [Conduct; 14] = [
    ("it has a name and options that can be changed", &[], conduct::identity),
    ("options outside their ranges are refused", &[], conduct::refused_options),
    ("gaps at the ends of their ranges", &[], conduct::gaps),
    ("node limits", &[Capability::NodeLimit], conduct::node_limits),
    ("no time at all", &[Capability::TimeLimit], conduct::no_time),
    ("a short time", &[Capability::TimeLimit], conduct::short_time),
    ("an interrupt before the start", &[], interrupts::before),
    (
        "an interrupt from another thread",
        &[Capability::InterruptWhileRunning, Capability::TimeLimit],
        interrupts::from_another_thread,
    ),
    (
        "an interrupt from within the callback",
        &[Capability::InterruptWhileRunning, Capability::Events],
        interrupts::from_within,
    ),
    ("progress events", &[Capability::Events], conduct::events),
    ("lazy constraints are used or refused", &[], conduct::lazy_constraints),
    ("the model stays as it was", &[], conduct::model_unchanged),
    ("the same question twice", &[], conduct::twice),
    ("as good as new after any outcome", &[], conduct::as_good_as_new),
];

impl Suite {
    /// Leaves out the cases that need any of these capabilities.
    pub fn without(mut self, lacking: impl IntoIterator<Item = Capability>) -> Self {
        self.lacking.extend(lacking);
        self
    }

    /// Runs every case that the backend has the capabilities for, and restores its options after
    /// each.
    ///
    /// If the options have no time limit, the suite sets one minute. A backend that lacks time
    /// limits and does not end hangs the run.
    pub fn run(&self, solver: &mut dyn Solver) -> Report {
        let mut report = Report::new(solver.name());
        let original = solver.options().clone();
        match answers() {
            Ok(cases) => {
                // Again in reverse order, to see that no state is left from one program to the
                // next.
                for case in cases.iter().chain(cases.iter().rev()) {
                    let check = |solver: &mut dyn Solver, complaints: &mut Complaints| {
                        judge::solve(solver, case, complaints);
                    };
                    self.one(solver, &original, &case.name, &case.needs, check, &mut report);
                }
            }
            Err(error) => {
                report
                    .add("the programs of the suite", CaseOutcome::Failed(vec![error.to_string()]));
            }
        }
        for (name, needs, check) in CONDUCT {
            self.one(solver, &original, name, needs, check, &mut report);
        }
        report
    }

    fn one(
        &self,
        solver: &mut dyn Solver,
        original: &Options,
        name: &str,
        needs: &[Capability],
        check: impl FnOnce(&mut dyn Solver, &mut Complaints),
        report: &mut Report,
    ) {
        if let Some(&lacking) = needs.iter().find(|capability| self.lacking.contains(capability)) {
            report.add(name, CaseOutcome::Skipped(lacking));
            return;
        }
        let mut complaints = Complaints::default();
        let mut options = original.clone();
        if !self.lacking.contains(&Capability::TimeLimit) {
            options.time_limit = options.time_limit.or(Some(GUARD));
        }
        *solver.options_mut() = options;
        let checked = catch_unwind(AssertUnwindSafe(|| check(solver, &mut complaints)));
        if let Err(panic) = checked {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied());
            complaints.add(format!("the backend panicked: {}", text.unwrap_or("without a text")));
        }
        *solver.options_mut() = original.clone();
        report.add(name, complaints.outcome());
    }
}
