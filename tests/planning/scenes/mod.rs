//! Scenes: bodies among obstacles, in one to three axes.

mod paper;
mod plane;
mod properties;
mod refusals;
