//! Explanations: why a model has no solution, what would have to give, what a point violates.
//!
//! | question | answer |
//! | --- | --- |
//! | Which of my statements contradict each other? | [`infeasibility`] |
//! | Which would have to give, and by how much? | [`relaxation`] |
//! | What is wrong with this point? | [`violations`] |
//!
//! All answers are about statements of the model, by name and step, never about rows of its
//! reformulation.
//!
//! # How to write a model that can be explained
//!
//! * A variable's bounds are its *domain*: the values that it can have at all. All big-Ms come from
//!   domains, so domains are hard and never questioned. A limit that may be questioned is a
//!   *statement*: give `a` the widest range that makes sense and add `a.within(-6.0, 6.0)` under a
//!   name. For the same reason, write start and goal as rows and do not use
//!   [`Model::fix`](crate::model::Model::fix).
//! * Statements with a step, [`add(("damage_limit", t), ...)`](crate::model::Model::add), form a
//!   family. An explanation finds families first and steps second.
//! * Statements that describe the system are *background*, and so are functions, because they define
//!   variables. The builders of [`hybrid`](crate::hybrid) declare their dynamics, contact laws and
//!   damage states as background. Declare other statements with
//!   [`Model::set_background`](crate::model::Model::set_background), or for one explanation with
//!   [`ExplainOptions::with_background`].
//!
//! A cart must cover 8 m in ten steps of 1 s, faster than its limits allow:
//!
//! ```
//! use carom::explain::{ElasticOptions, ExplainOptions, infeasibility, relaxation};
//! use carom::hybrid::LinearSystem;
//! use carom::prelude::*;
//!
//! let steps = 10;
//! let cart = LinearSystem::double_integrator(1.0)?;
//! let mut model = Model::new("cart");
//! let x = model.continuous_family("x", steps + 1, -50.0, 50.0)?;
//! let v = model.continuous_family("v", steps + 1, -10.0, 10.0)?;
//! let a = model.continuous_family("a", steps, -10.0, 10.0)?;
//! model.add("start_position", x[0].equals(0.0))?;
//! model.add("start_at_rest", v[0].equals(0.0))?;
//! model.add("goal", x[steps].ge(8.0))?;
//! for t in 0..steps {
//!     cart.add_dynamics(&mut model, &["x", "v"], t, &[x[t], v[t]], &[a[t]], &[x[t + 1], v[t + 1]])?;
//!     model.add(("speed", t + 1), v[t + 1].within(-2.0, 2.0))?;
//!     model.add(("acceleration", t), a[t].within(-0.1, 0.1))?;
//! }
//! let mut solver = BranchAndBound::default();
//! let why = infeasibility(&model, &mut solver, &ExplainOptions::default())?;
//! assert!(why.is_irreducible() && why.solves() <= 20);
//! let names: Vec<_> = why.groups().iter().map(|group| group.name()).collect();
//! assert_eq!(names, ["start_position", "start_at_rest", "goal", "acceleration"]);
//!
//! // Five metres are possible. What if only the goal may give?
//! let options = ElasticOptions::default()
//!     .with_background(["start_position", "start_at_rest", "speed", "acceleration"]);
//! let relaxed = relaxation(&model, &mut solver, &options)?;
//! assert_eq!(relaxed.stretches()[0].name.to_string(), "goal");
//! assert!((relaxed.stretches()[0].amount - 3.0).abs() < 1e-5);
//! # Ok::<(), carom::Error>(())
//! ```
//!
//! [`collision_tolerant`](crate::collision_tolerant) writes limits as domains, because that is faster;
//! [`PlanningProgram::explainable`](crate::collision_tolerant::PlanningProgram::explainable) writes
//! the same program with limits as statements.

mod domains;
mod elastic;
mod explanation;
mod groups;
mod infeasibility;
mod narrow;
mod options;
mod oracle;
mod relaxation;
mod violations;

pub use explanation::{Explanation, ExplanationStatus, Group};
pub use infeasibility::infeasibility;
pub use options::ExplainOptions;
pub use relaxation::{ElasticOptions, Relaxed, Stretch, relaxation};
pub use violations::violations;
