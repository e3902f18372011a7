//! The purposes that relaxations are solved for, and the attempts that each is worth.

/// The purpose that a relaxation is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// The root, where it may turn out that the objective falls without limit.
    Root,
    /// A node below.
    Node,
    /// A child on trial, or a step of a dive: a rough answer will do. Its bound is a proved one
    /// like any other, if not the best.
    Trial,
    /// A round of cuts of cones at a node, which the dual simplex method solves, or nothing: the
    /// program with its cones is then the better one to solve.
    Round,
    /// A leaf, whose point may become the answer: digits cost an iteration or two.
    Leaf,
    /// A point to cut off.
    Separation,
    /// A bound on an expression.
    Bound,
    /// A direction in which the objective may fall without limit.
    Direction,
    /// Multipliers for the user.
    Multipliers,
}

/// The place of a method in the cascade.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stage {
    /// The method that starts from the parent's state, where one suits the program.
    Warm,
    /// The method that starts from nothing, is quick, and gives up early.
    Cold,
    /// The method that is slower and gives up late.
    Fallback,
}

/// One solve of a program by one method.
#[derive(Debug, Clone, Copy)]
pub(super) struct MethodAttempt {
    pub(super) stage: Stage,
    /// The largest number of iterations: a program that is infeasible by rounding only keeps an
    /// interior-point method busy without a verdict. The simplex method ends by itself.
    pub(super) iterations: u32,
    /// The tolerance on gap and residuals, relative.
    pub(super) tolerance: f64,
    /// The steps of iterative refinement in each linear solve.
    pub(super) refinements: u32,
}

const fn attempt(stage: Stage, iterations: u32, tolerance: f64, refinements: u32) -> MethodAttempt {
    MethodAttempt { stage, iterations, tolerance, refinements }
}

/// The attempt at a vertex of a linear program whose bound is doubtful.
pub(super) const VERTEX: MethodAttempt = attempt(Stage::Warm, u32::MAX, 1e-14, 1);

/// The exchanges after which a trial is content with the bound that it has.
const TRIAL_EXCHANGES: u32 = 200;

/// The attempts of a purpose, in their order.
pub(super) const fn attempts(purpose: Purpose) -> &'static [MethodAttempt] {
    use Stage::{Cold, Fallback, Warm};
    match purpose {
        Purpose::Trial => {
            const { &[attempt(Warm, TRIAL_EXCHANGES, 1e-9, 1), attempt(Cold, 30, 1e-5, 1)] }
        }
        Purpose::Round => const { &[attempt(Warm, 500, 1e-9, 1)] },
        Purpose::Root | Purpose::Node => {
            const {
                &[
                    attempt(Warm, u32::MAX, 1e-9, 1),
                    attempt(Cold, 60, 1e-8, 1),
                    attempt(Fallback, 60, 1e-8, 1),
                    attempt(Fallback, 200, 1e-9, 10),
                ]
            }
        }
        // Other rows may multiply the amount by which a vertex misses its bounds.
        Purpose::Leaf => {
            const {
                &[
                    attempt(Warm, u32::MAX, 1e-14, 1),
                    attempt(Cold, 60, 1e-11, 1),
                    attempt(Fallback, 60, 1e-8, 1),
                    attempt(Fallback, 200, 1e-9, 10),
                    attempt(Fallback, 200, 1e-11, 10),
                ]
            }
        }
        Purpose::Separation => {
            const {
                &[
                    attempt(Warm, u32::MAX, 1e-9, 1),
                    attempt(Cold, 60, 1e-8, 1),
                    attempt(Fallback, 60, 1e-8, 1),
                ]
            }
        }
        Purpose::Bound => const { &[attempt(Fallback, 100, 1e-9, 2)] },
        Purpose::Direction => const { &[attempt(Fallback, 200, 1e-9, 10)] },
        Purpose::Multipliers => {
            const { &[attempt(Cold, 200, 1e-11, 1), attempt(Fallback, 200, 1e-11, 10)] }
        }
    }
}
