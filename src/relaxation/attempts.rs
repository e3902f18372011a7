//! The purposes that relaxations are solved for, and the attempts that each is worth.

/// The purpose that a relaxation is solved for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// The root, where it may turn out that the objective falls without limit.
    Root,
    /// A node below.
    Node,
    /// A child on trial, or a step of a dive: a rough answer will do. Its bound is a proved one like
    /// any other, if not the best.
    Trial,
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

/// The method that is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Who {
    /// The method that starts from the parent's state, where there is one for the program.
    Warm,
    /// The first method: quick, and gives up early.
    First,
    /// The last method: slower, and gives up late.
    Last,
}
pub(super) use Who::{First, Last, Warm};

/// An attempt: the method that is asked, the number of iterations, the tolerance, and the number of
/// refinements.
pub(super) type Attempt = (Who, u32, f64, u32);

/// The attempts of a purpose, in their order. Iterations are capped: a program infeasible by a hair
/// keeps an interior-point method busy without a verdict.
pub(super) fn attempts(purpose: Purpose) -> &'static [Attempt] {
    match purpose {
        Purpose::Trial => &[(Warm, 500, 1e-9, 1), (First, 30, 1e-5, 1)],
        Purpose::Root | Purpose::Node => &[
            (Warm, 2000, 1e-9, 1),
            (First, 60, 1e-8, 1),
            (Last, 60, 1e-8, 1),
            (Last, 200, 1e-9, 10),
        ],
        // Other rows may multiply what a corner misses of its bounds.
        Purpose::Leaf => &[
            (Warm, 2000, 1e-14, 1),
            (First, 60, 1e-11, 1),
            (Last, 60, 1e-8, 1),
            (Last, 200, 1e-9, 10),
            (Last, 200, 1e-11, 10),
        ],
        Purpose::Separation => &[(First, 60, 1e-8, 1), (Last, 60, 1e-8, 1)],
        Purpose::Bound => &[(Last, 100, 1e-9, 2)],
        Purpose::Direction => &[(Last, 200, 1e-9, 10)],
        Purpose::Multipliers => &[(First, 200, 1e-11, 1), (Last, 200, 1e-11, 10)],
    }
}
