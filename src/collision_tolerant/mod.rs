//! The planner of the paper, which may hit a wall if that is faster.
//!
//! M. L. Mote, J.-P. Afman, E. Feron, "A framework for collision-tolerant optimal trajectory
//! planning of autonomous vehicles", arXiv:1611.07608. A vehicle on a line must go from a start to
//! a goal near a wall; braking against the wall can be faster than braking in time.
//!
//! | task | item | built from |
//! | --- | --- | --- |
//! | describe the task | [`Scenario`] | |
//! | write the programs, (1)-(21) | [`Scenario::program`] | [`hybrid`](crate::hybrid) and [`model`](crate::model) |
//! | plan over a fixed horizon | [`Scenario::plan`] | any [`Solver`](crate::solver::Solver) |
//! | find the shortest plan, with a proof | [`Scenario::shortest`], [`Scenario::compare`] | [`shortest_horizon`](crate::hybrid::shortest_horizon()) |
//! | read the result | [`Plan`]: a [`Trajectory`] and its certificate | two replays |
//! | ask what can be reached, and why there is no plan | [`Scenario::reach_sets`] | [`reach`](crate::hybrid::reach) |
//! | ask which limits prevent a plan | [`Scenario::explainable_program`] | `explain` |
//! | find limits on damage | [`Scenario::damage_limit_range`] | |
//!
//! Every plan is replayed by two simulators that share no code with the programs' rows. A plan that
//! disagrees with the discrete replay is an error.
//!
//! ```
//! use carom::collision_tolerant::Scenario;
//! use carom::prelude::*;
//!
//! let scenario = Scenario::paper().with_time_step(0.05);
//! let mut solver = BranchAndBound::default();
//! let shortest = scenario.shortest(&mut solver)?;
//! let plan = shortest.plan.expect("there is one");
//! assert_eq!(plan.trajectory.impacts.len(), 1);
//! # Ok::<(), carom::Error>(())
//! ```

mod checks;
mod explainable;
mod law;
mod literal;
mod plan;
mod program;
mod scenario;
mod scene;
mod shortest;
mod trajectory;
mod wall;

pub use law::ContactLaw;
pub use plan::Plan;
pub use program::{Objective, PlanningProgram};
pub use scenario::{Endpoint, Scenario};
pub use shortest::PlanComparison;
pub use trajectory::{Impact, Trajectory};
pub use wall::Wall;
