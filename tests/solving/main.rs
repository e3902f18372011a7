//! Whole solves: answers against enumeration and known optima, limits, seeds, explanations.

#[path = "../common/mod.rs"]
mod common;
#[path = "../instances/mod.rs"]
mod instances;
#[path = "../torture/mod.rs"]
mod torture;

mod benchmark_programs;
mod branching_rules;
mod conformance;
mod convexity;
mod explain;
mod free_shifts;
mod guidance;
mod invariance;
mod large_coefficients;
mod limits;
mod multipliers;
mod oracle;
mod prepared;
mod search;
mod stop_token;
mod torture_programs;
mod trust;
