//! Why a program has no robust form, and why a plan is not certified.

use thiserror::Error;

use super::condition::Condition;

/// A program or a plan that does not hold for every disturbance.
///
/// It is an [`ErrorKind::Robust`](super::ErrorKind::Robust).
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RobustError {
    /// A program of several systems.
    #[error(
        "the program has {count} systems, and a tube is around the run of one; state them as one \
         system, or make the program before the others join"
    )]
    SeveralSystems {
        /// How many there are.
        count: usize,
    },
    /// A feedback of a system of another size.
    #[error(
        "the feedback is for {found} states, but the system of the program has {expected}; make it \
         from that system"
    )]
    OtherSystem {
        /// The states of the feedback.
        found: usize,
        /// The states of the program's system.
        expected: usize,
    },
    /// A feedback that corrects an input that takes some values only.
    #[error(
        "the feedback corrects the input `{input}`, which takes some values only and cannot be corrected; give \
         it a gain with zeros in the row of this input, as `Feedback::regulator` does"
    )]
    FiniteInput {
        /// The input.
        input: String,
    },
    /// Two modes whose guards meet in one value: a run would have to end a step exactly there.
    #[error(
        "no tube goes from `{from}` to `{to}`, because disturbed runs do not all end a step where `{leaves}` \
         and `{enters}` meet; use `guard` in place of `invariant`, so that a step may cross it, or let \
         the two overlap by more than the tube is wide"
    )]
    NoCrossing {
        /// The transition of the step before.
        from: String,
        /// The transition of the step after it.
        to: String,
        /// The guard of `from` at the end of its step.
        leaves: String,
        /// The guard of `to` at the start of its step.
        enters: String,
    },
    /// A statement that holds at one value alone, where disturbed runs differ.
    #[error(
        "`{statement}` requires one value, but disturbed runs differ there by {width:.3e} or more; \
         give it a range, such as `x.within(lower, upper)`"
    )]
    OneValue {
        /// The statement.
        statement: String,
        /// The least width of the tube there, in the statement's unit.
        width: f64,
    },
    /// A statement that cannot be tightened.
    #[error("`{statement}` cannot be tightened by a tube, because it is {kind}; {help}")]
    Statement {
        /// The statement.
        statement: String,
        /// The statement, in words.
        kind: &'static str,
        /// The way out.
        help: &'static str,
    },
    /// A run that some disturbance leads beyond a condition of the system.
    #[error(
        "the plan is not robust: in step {step}, {condition} is violated by up to {violation:.3e} for \
         some disturbance within the ranges"
    )]
    Condition {
        /// The step, or the sample for a condition on a sample.
        step: usize,
        /// The condition.
        condition: Condition,
        /// By how much, in its unit.
        violation: f64,
    },
    /// A run that some disturbance leads beyond a statement of the program.
    #[error(
        "the plan is not robust: `{statement}` is violated by up to {violation:.3e} for some \
         disturbance within the ranges"
    )]
    Violated {
        /// The statement.
        statement: String,
        /// By how much, in its unit.
        violation: f64,
    },
}
