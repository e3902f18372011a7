//! Presolve before the search: the same optimum, points that are restored, multipliers that are.

#[path = "../common/mod.rs"]
mod common;

mod cuts;
mod kkt;
mod programs;
mod rules;
