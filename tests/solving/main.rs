//! Whole solves: answers against enumeration and known optima, limits, seeds, explanations.

#[path = "../common/mod.rs"]
mod common;
#[path = "../instances/mod.rs"]
mod instances;
#[path = "../torture/mod.rs"]
mod torture;

mod benchmark_programs;
mod borderline;
mod branching_rules;
mod concave_binaries;
mod cones;
mod conformance;
mod convexity;
mod dense_quadratics;
mod dependent_rows;
mod endless_cones;
mod equation_chains;
mod explain;
mod far_optima;
mod far_starts;
mod fixed_charges;
mod free_shifts;
mod gaps;
mod implied_bounds;
mod invariance;
mod kept_facets;
mod large_coefficients;
mod lazy_constraints;
mod limits;
mod moving_walls;
mod multipliers;
mod node_cuts;
mod nonlinear;
mod notes;
mod open_integers;
mod open_semicontinuous;
mod oracle;
mod prepared;
mod proofs;
mod relaxed_integers;
mod search;
mod service_systems;
mod stop_token;
mod thin_cones;
mod torture_programs;
mod tour;
mod trust;
mod units;
mod whole_nodes;
mod without_objective;
