//! Reach sets: the states that can be reached from a start, and those from which a goal can still
//! be reached, computed before anything is solved.
//!
//! A planning program describes a dynamical system, but a solver sees only rows. The states that
//! can be reached in t steps and those from which the goal can be reached in the remaining τ - t
//! steps must intersect at every t, or no plan has τ steps. If the intersection is small, most of
//! the plan's binaries are decided.
//!
//! | task | item |
//! | --- | --- |
//! | describe the system | [`HybridSystem`], [`Transition`], [`Halfspace`] |
//! | sets of states | [`ReachSets`], [`ReachSet`], [`SetOptions`] |
//! | the sets of one horizon | [`Tube`] |
//! | tighten a program | [`Tube::tighten`], [`HorizonVariables`], [`TighteningReport`] |
//! | why there is no plan | [`ReachSets::explain`], [`ReachExplanation`] |
//! | a picture, with a plan | [`Tube::to_svg`], [`ReachSet::outline`] |
//!
//! [`shortest_horizon`](super::shortest_horizon()) uses all of this for a
//! [`HorizonModel`](super::HorizonModel) that offers its
//! [`reach_sets`](super::HorizonModel::reach_sets), and
//! [`collision_tolerant`](crate::collision_tolerant) does by default.
//!
//! # A program of your own
//!
//! ```
//! use carom::hybrid::{LinearSystem, Mat};
//! use carom::hybrid::reach::*;
//! use carom::interval::Interval;
//! use carom::prelude::*;
//!
//! // A heater that is on or off: T⁺ = 0.9 T + 0.1 T_out, plus 3 K if it is on.
//! let (outside, steps) = (5.0, 8);
//! let mut model = Model::new("heater");
//! let temperature = model.continuous_family("T", steps + 1, 0.0, 40.0)?;
//! let on = model.binary_family("on", steps)?;
//! for t in 0..steps {
//!     let cooled = 0.9 * temperature[t] + 0.1 * outside;
//!     model.add(("heat", t), temperature[t + 1].equals(cooled + 3.0 * on[t]))?;
//! }
//! model.fix(temperature[0], 10.0)?;
//! model.set_bounds(temperature[steps], 22.5, 40.0)?;
//!
//! // The same as a hybrid system: two modes, of which the second is an event.
//! let mode = |gain: f64| {
//!     let (a, b) = (Mat::from_fn(1, 1, |_, _| 0.9), Mat::zeros(1, 0));
//!     LinearSystem::new(a, b, vec![0.1 * outside + gain])
//! };
//! let system = HybridSystem::new()
//!     .with_state("T", Interval::new(0.0, 40.0))
//!     .with_transition(Transition::new("off", mode(0.0)?))
//!     .with_transition(Transition::event("on", mode(3.0)?));
//! let options = SetOptions::default().with_events(steps);
//! let (start, goal) = ([Interval::point(10.0)], [Interval::new(22.5, 40.0)]);
//! let mut sets = ReachSets::new(&system, &start, &goal, options)?;
//!
//! // This fixes binaries and tightens bounds.
//! let variables = HorizonVariables::new([temperature]).with_transition(1, on);
//! let report = sets.tube(steps)?.tighten(&mut model, &variables)?;
//! assert_eq!(report.to_string(), "8 steps: 6 binaries fixed, 2 open, 8 bounds tightened, 1 rows added");
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Accuracy
//!
//! * States that no flow, reset, guard or limit links are in separate blocks, so each axis of a
//!   decoupled vehicle is as accurate as if it were alone. Inputs do not link states: two blocks
//!   choose a common input separately, which can only enlarge the sets.
//! * A block of two states has **exact convex polygons**. If a polygon has more than
//!   [`SetOptions::vertices`] vertices, short edges are merged outward.
//! * Other blocks have limits along **template directions**: the axes, the normals of their limits
//!   and guards, the diagonals if there are at most four states, and those of
//!   [`SetOptions::directions`]. A block of one state is exact.
//! * States with the same number of events share one convex set, their hull. States with
//!   [`SetOptions::events`] events or more share another, so any number of events is covered.
//!
//! # Rounding and margin
//!
//! Every operation rounds outward: polygons have a margin to which each operation adds its possible
//! rounding error, and template limits include theirs. In addition, starts, goals, limits, guards
//! and input ranges are enlarged by [`SetOptions::margin`], so that the sets also contain plans
//! that are feasible only within the solver's tolerances.
//!
//! # Cost
//!
//! With V vertices, a step of one layer and one transition takes O(V) time (O(V log V) with hulls
//! of several parts), and a sweep over τ steps is linear in τ. Combinations for templates are found
//! once per system, in time that grows with the cube of the number of directions.

mod compiled;
mod explain;
mod picture;
mod polygon;
mod rounding;
mod set;
mod sets;
mod shape;
mod step;
mod system;
mod template;
mod tighten;
mod tube;

pub use explain::{Finding, Obstacle, ReachExplanation};
pub use set::ReachSet;
pub use sets::{ReachSets, SetOptions};
pub use system::{Halfspace, HybridSystem, Transition};
pub use tighten::{Change, HorizonVariables, Quantity, Reason, TighteningReport};
pub use tube::Tube;
