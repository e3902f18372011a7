//! Costs of plans, and their ends.

mod lqr;
mod terminal_sets;
