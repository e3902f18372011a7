#![doc = include_str!("../docs/modelling.md")]

// Its code is compiled as that of all other pages.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub mod readme {}
#[cfg(doctest)]
#[doc = include_str!("../docs/landing.md")]
pub mod landing {}

#[doc = include_str!("../docs/tutorial.md")]
pub mod tutorial {}

#[doc = include_str!("../docs/hybrid_system.md")]
pub mod hybrid_system {}

#[doc = include_str!("../docs/scenes.md")]
pub mod scenes {}

#[doc = "[`Mission`]: crate::hybrid::Mission"]
#[doc = "[`Mission::robustness`]: crate::hybrid::Mission::robustness"]
#[doc = "[`MISSION_SEPARATION`]: crate::tolerance::MISSION_SEPARATION"]
#[doc = "[`mission_conflict`]: crate::hybrid::HybridProgram::mission_conflict"]
#[doc = include_str!("../docs/missions.md")]
pub mod missions {}

// The pages are also read as files. Of two definitions of a link, the first one counts, so that
// these take the place of the links to files at the ends of the pages.
#[doc = "[weak]: crate::guide::weak_statements"]
#[doc = include_str!("../docs/my_search_does_not_finish.md")]
pub mod my_search_does_not_finish {}

#[doc = include_str!("../docs/weak_statements.md")]
pub mod weak_statements {}

#[doc = include_str!("../docs/nonlinear.md")]
pub mod nonlinear {}

#[doc = include_str!("../docs/help.md")]
pub mod help {}

#[doc = include_str!("../docs/a_file_and_a_solver.md")]
pub mod a_file_and_a_solver {}

#[doc = include_str!("../docs/cluster.md")]
pub mod cluster {}

#[doc = "[proof]: crate::guide::proofs"]
#[doc = "[program]: crate::guide::a_file_and_a_solver"]
#[doc = "[tutorial]: crate::guide::tutorial"]
#[doc = include_str!("../docs/python.md")]
pub mod python {}

#[doc = "[`HybridSystem`]: crate::hybrid::HybridSystem"]
#[doc = include_str!("../docs/reach_sets.md")]
pub mod reach_sets {}

#[doc = "[reach sets]: crate::guide::reach_sets"]
#[doc = include_str!("../docs/formulation.md")]
pub mod formulation {}

#[doc = "[benchmarks]: crate::guide::benchmarks"]
#[doc = "[modelling guide]: crate::guide"]
#[doc = include_str!("../docs/proofs.md")]
pub mod proofs {}

#[doc = include_str!("../docs/robust_plans.md")]
pub mod robust_plans {}

#[doc = "[robust]: crate::guide::robust_plans"]
#[doc = include_str!("../docs/explicit_control.md")]
pub mod explicit_control {}

#[doc = "[benchmarks]: crate::guide::benchmarks"]
#[doc = "[robust]: crate::guide::robust_plans"]
#[doc = "[on a cluster]: crate::guide::cluster"]
#[doc = "[nonlinear functions]: crate::guide::nonlinear"]
#[doc = "[tutorial]: crate::guide::tutorial"]
#[doc = include_str!("../docs/gallery.md")]
pub mod gallery {}

#[doc = "[chips]: crate::guide::explicit_control"]
#[doc = "[decisions]: crate::guide::decisions"]
#[doc = include_str!("../docs/benchmarks.md")]
pub mod benchmarks {}

#[doc = "[benchmarks]: crate::guide::benchmarks"]
#[doc = include_str!("../docs/decisions.md")]
pub mod decisions {}
