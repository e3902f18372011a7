//! Scenes: bodies among obstacles, in one to three axes.

mod moving;
mod numbers;
mod paper;
mod pictures;
mod plane;
mod properties;
mod random;
mod refusals;
mod rules;
mod steps;
