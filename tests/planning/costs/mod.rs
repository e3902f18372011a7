//! Costs of plans, their ends, and the shortest run of a system.

mod lqr;
mod norms;
mod references;
mod shortest_runs;
mod soft_limits;
mod terminal_sets;
mod windows;
