//! Scenes: bodies among obstacles, in one to three axes.

mod numbers;
mod paper;
mod plane;
mod properties;
mod refusals;
mod steps;
