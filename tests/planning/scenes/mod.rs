//! Scenes: bodies among obstacles, in one to three axes.

mod balls;
mod broken;
mod corners;
mod edges;
mod extreme;
mod handles;
mod limits;
mod moving;
mod numbers;
mod paper;
mod pictures;
mod plane;
mod properties;
mod random;
mod refusals;
mod rest;
mod rules;
mod sets;
mod spin;
mod steps;
