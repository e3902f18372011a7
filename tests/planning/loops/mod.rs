//! Controllers in loops: while time passes, and while budgets are missed.

mod budgets;
mod moving;
mod soft_boxes;
mod soft_scenes;
