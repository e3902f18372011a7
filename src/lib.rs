//! Planning with dynamics that switch: describe the system, get back a trajectory and a proof that
//! none is better.
//!
//! `carom` (a billiards shot that uses the cushion) is for planners of motion with modes and
//! contacts: a wall is hit, a mode is entered, a budget of damage is spent. It has
//!
//! * a [modelling language](model): variables, affine rows, convex quadratic objectives, *indicators*
//!   ("if this holds, so does that row") with automatic big-Ms, logic over binaries, disjunctions,
//!   products, absolute values, extrema and piecewise-affine functions (see the [guide]);
//! * a trait [`Solver`](solver::Solver) and an implementation, [`BranchAndBound`]. The crate's own
//!   interior-point method solves most relaxations and Clarabel those that it gives up on; what
//!   either claims is checked before it counts;
//! * [hybrid systems](hybrid): linear dynamics, walls, contact laws, damage states, simulators,
//!   [reach sets](hybrid::reach), and the search for the shortest horizon;
//! * [explanations](explain) of infeasible models in terms of their own statements;
//! * the planner of one paper, [`collision_tolerant`], built from these public parts: a vehicle that
//!   may *choose* to hit a wall, under a damage limit, because that is faster.
//!
//! # A plan in ten lines
//!
//! A vehicle drives from 10 m to 0.3 m, in front of a wall at 0 m, as fast as it can. Braking in
//! time takes 52 steps of 0.05 s. Braking against the wall takes 47, and 46 are proved to be too
//! few.
//!
//! ```
//! use carom::collision_tolerant::{PlanningOptions, Scenario, compare};
//! use carom::prelude::*;
//!
//! let scenario = Scenario::paper().with_time_step(0.05);
//! let mut solver = BranchAndBound::default();
//! let plans = compare(&scenario, &PlanningOptions::default(), &mut solver)?;
//! assert_eq!(plans.free.steps, Some(52));
//! assert_eq!((plans.tolerant.steps, plans.tolerant.refuted_steps), (Some(47), Some(46)));
//! let plan = plans.tolerant.plan.expect("there is one");
//! assert_eq!(plan.trajectory.impacts.len(), 1);
//! assert!(plan.certificate.discrete.max_position_error < 1e-6);
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # A model of your own
//!
//! Expressions are plain values with operators; comparisons are the methods `le`, `ge`, `equals`
//! and `within`. To keep a vehicle out of a region, use two indicators on one binary per step:
//!
//! ```
//! use carom::prelude::*;
//!
//! let steps = 12;
//! let mut model = Model::new("detour");
//! let x = model.continuous_family("x", steps + 1, 0.0, 10.0)?;
//! let y = model.continuous_family("y", steps + 1, 0.0, 4.0)?;
//! let beside = model.binary_family("beside", steps + 1)?;
//! model.fix(x[0], 0.0)?;
//! model.fix(y[0], 0.0)?;
//! model.add("goal", x[steps].ge(8.0))?;
//! for t in 0..steps {
//!     model.add(("advance", t), (x[t + 1] - x[t]).within(0.0, 1.0))?;
//!     model.add(("sidestep", t), (y[t + 1] - y[t]).within(-1.0, 1.0))?;
//!     // Either beside the obstacle, at y >= 2, or still in front of it, at x <= 3.
//!     model.add(("side", t), beside[t].on().implies(y[t].ge(2.0)))?;
//!     model.add(("front", t), beside[t].off().implies(x[t].le(3.0)))?;
//! }
//! model.minimize(y.iter().map(|y| y.square()).sum::<Quadratic>())?;
//!
//! let solution = BranchAndBound::default().solve(&model)?;
//! assert!(solution.is_optimal());
//! // Four samples at 2 m, one at 1 m on the way up, and one at 1 m on the way down.
//! assert!(solution.objective().is_some_and(|cost| (cost - 18.0).abs() < 1e-4));
//! assert!(solution.verification().is_some_and(|v| v.holds()));
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Logic and functions
//!
//! Write logic with operators on binaries, and use any formula as the condition of a row. A
//! function is a variable that equals the function's value, whichever way the rest of the model
//! pushes it.
//!
//! ```
//! use carom::prelude::*;
//!
//! let mut model = Model::new("landing");
//! let hit = model.binary_family("hit", 4)?;
//! let (armed, near) = (model.binary("armed")?, model.binary("near")?);
//! let x = model.continuous("x", -5.0, 10.0)?;
//! let u = model.continuous("u", -2.0, 2.0)?;
//! model.add("two_hits", at_most(2, &hit))?;
//! model.add("armed_first", Logic::any(&hit).implies(armed))?;
//! model.add("some_hit", hit[0].xor(hit[1]) | (hit[2] & !hit[3]))?;
//! model.add("slow", (armed & !near).implies(u.le(0.5)))?;
//! model.add("near", near.on().reify(x.le(1.0), 0.01))?; // near exactly when x <= 1
//! let effort = model.absolute("effort", u - 0.1 * x)?;
//! let thrust = model.product("thrust", armed, u + 2.0)?;
//! model.add("push", thrust.ge(1.0))?;
//! model.minimize(effort - x)?;
//!
//! let solution = BranchAndBound::default().solve(&model)?;
//! assert!(solution.objective().is_some_and(|cost| (cost + 9.5).abs() < 1e-6));
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Big-M you can trust
//!
//! You never write an M. Each one is computed from the current bounds of the row's variables, for
//! each row and side, and rounded outward. A missing bound is an error that names the variable. A
//! report says where each M comes from. After solving, indicators are checked as implications.
//!
//! ```
//! use carom::prelude::*;
//! use carom::reformulate;
//!
//! let mut model = Model::new("m");
//! let speed = model.continuous("speed", 0.0, f64::INFINITY)?;
//! let near = model.binary("near")?;
//! model.add("slow_near", near.on().implies(speed.le(1.0)))?;
//! let error = reformulate::lower(&model).unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "indicator `slow_near` needs a big-M for its upper side, but `speed` has no upper bound; \
//!      give `speed` a finite one"
//! );
//!
//! model.set_bounds(speed, 0.0, 15.0)?;
//! let lowered = reformulate::lower(&model)?;
//! assert_eq!(
//!     lowered.report().to_string(),
//!     "slow_near upper: M = 14 from bounds (largest share: speed)\n"
//! );
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Disjunctions
//!
//! A disjunction lists sets of rows, one of which must hold. Choose between the big-M, multi-M and
//! convex-hull formulations, and compare what each costs:
//!
//! ```
//! use carom::model::{Method, Reformulation};
//! use carom::prelude::*;
//! use carom::reformulate;
//!
//! let mut model = Model::new("landing");
//! let x = model.continuous("x", 0.0, 20.0)?;
//! let y = model.continuous("y", 0.0, 20.0)?;
//! let (north, south) = ([x.le(2.0), y.ge(18.0)], [x.within(8.0, 9.0), y.le(1.0)]);
//! let site = model.add("site", either(north).or(south).or([x.ge(15.0), y.ge(15.0)]))?;
//! model.minimize((x - 2.0).square() + (y - 8.0).square())?;
//! model.set_reformulation(Reformulation::default().with_method(Method::Hull));
//! let mut solver = BranchAndBound::default();
//! let solution = solver.solve(&model)?;
//! assert_eq!(solution.point().map(|point| point.selected(&site)), Some(Ok(Some(1))));
//! let table = reformulate::compare_methods(&model, &mut solver)?;
//! assert!(table.entries()[2].root_bound > table.entries()[0].root_bound);
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Statuses and limits
//!
//! Why the solver stopped ([`Termination`](solution::Termination)) and what it found
//! ([`PrimalStatus`](solution::PrimalStatus)) are separate. Infeasible, unbounded and stopped by a
//! limit are statuses. An [`Error`] means misuse or breakdown, and says what to do. A search that
//! hits a limit returns its best verified point and a valid bound:
//!
//! ```
//! use carom::prelude::*;
//!
//! let mut model = Model::new("knapsack");
//! let weights = [23.0, 31.0, 29.0, 44.0, 53.0, 38.0, 63.0, 85.0, 89.0, 82.0];
//! let take = model.binary_family("take", weights.len())?;
//! let load: Affine = take.iter().zip(weights).map(|(t, w)| w * t).sum();
//! model.add("capacity", load.le(165.0))?;
//! model.maximize(&load)?;
//!
//! let options = Options::default().with_node_limit(1);
//! let solution = BranchAndBound::new(options).solve(&model)?;
//! assert!(solution.bound() >= 165.0 - 1e-6);
//! assert!(solution.objective().is_none_or(|value| value <= 165.0));
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Reach sets
//!
//! The states that can be reached from the start, and those from which the goal can still be
//! reached, tell a lot about a planning program before it is solved: they fix most binaries,
//! tighten bounds, and often prove infeasibility. [`hybrid::reach`] computes them for hybrid
//! systems with few coupled states. [`collision_tolerant`] uses them by default, and says why there
//! is no plan:
//!
//! ```
//! use carom::collision_tolerant::{Scenario, explain};
//!
//! let careful = Scenario::paper().with_time_step(0.05).collision_free();
//! let reason = explain(&careful, 51)?.expect("51 steps are too few");
//! assert_eq!(
//!     reason.to_string(),
//!     "no plan has 51 steps: at the end, without an event, where x is 0.3, v can only be between \
//!      -11.12874 and -0.26529, and 0 is needed. It might be possible with twice the range of a"
//! );
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Why is it infeasible?
//!
//! [`explain::infeasibility`] names families of statements that contradict each other, such that
//! leaving out any one of them resolves the contradiction, and the steps that matter.
//! [`explain::relaxation`] says which statements would have to give and by how much, and
//! [`explain::violations`] lists what a given point violates.
//!
//! ```
//! use carom::explain::{ExplainOptions, infeasibility};
//! use carom::prelude::*;
//!
//! let mut model = Model::new("battery");
//! let charge = model.continuous_family("charge", 21, 0.0, 100.0)?;
//! for t in 0..20 {
//!     let sun = if t < 12 { 5.0 } else { 0.0 };
//!     model.add(("balance", t), (charge[t + 1] - charge[t]).le(sun - 1.0))?;
//!     model.add(("capacity", t), charge[t].le(9.0))?;
//!     model.add(("reserve", t + 1), charge[t + 1].ge(2.0))?;
//! }
//! model.set_background("balance")?;
//! let why = infeasibility(&model, &mut BranchAndBound::default(), &ExplainOptions::default())?;
//! assert!(why.is_irreducible());
//! assert!(why.to_string().starts_with(
//!     "these cannot hold together: capacity at step 12; reserve at step 20 "
//! ));
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! # Modules
//!
//! | ground | modelling | solving |
//! | --- | --- | --- |
//! | [`error`], [`tolerance`], [`interval`] | [`hybrid`] | [`reformulate`] |
//! | [`model`] | [`collision_tolerant`] | [`branch_and_bound`] |
//! | [`solution`] | | [`explain`] |
//! | [`solver`], [`conformance`] | | `external`, `highs` |
//!
//! Modelling and solving never import each other: planners see a solver only through its trait.
//!
//! # Features
//!
//! All features are off by default.
//!
//! * `serde`: serialises models, options, solutions and plans.
//! * `tracing`: emits spans and events of each solve for subscribers of the `tracing` crate.
//! * `highs`: adds `carom::highs::HighsSolver`, a second backend for mixed-integer linear programs. It
//!   compiles C++ for some minutes and needs cmake, a C++ compiler and libclang. It has no effect on
//!   WebAssembly.
//!
//! Without `highs`, the crate needs no C or C++ toolchain and no system library, and builds for
//! `wasm32-unknown-unknown`.

pub mod branch_and_bound;
pub mod collision_tolerant;
pub mod conformance;
pub mod error;
pub mod explain;
#[cfg(not(target_family = "wasm"))]
pub mod external;
pub mod guide;
#[cfg(all(feature = "highs", not(target_family = "wasm")))]
pub mod highs;
pub mod hybrid;
#[doc(hidden)]
pub mod internals;
pub mod interval;
pub mod model;
pub mod prelude;
mod presolve;
mod program;
pub mod reformulate;
mod relaxation;
mod search;
mod setters;
pub mod solution;
pub mod solver;
mod sum;
pub mod tolerance;
#[cfg(feature = "serde")]
mod wire;

pub use branch_and_bound::BranchAndBound;
pub use error::{Error, ErrorKind};
