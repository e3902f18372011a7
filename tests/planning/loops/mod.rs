//! Controllers in loops: while time passes, and while budgets are missed.

mod budgets;
mod finite_inputs;
mod integer_horizon;
mod modes;
mod moving;
mod soft_boxes;
mod soft_scenes;
mod whole_moves;
