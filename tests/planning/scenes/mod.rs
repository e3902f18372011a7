//! Scenes: bodies among obstacles, in one to three axes.

mod balls;
mod broken;
mod corners;
mod edges;
mod extreme;
mod first_impacts_of_steps;
mod forces;
mod handles;
mod limits;
mod moving;
mod paper;
mod pictures;
mod plane;
mod properties;
mod random;
mod refusals;
mod rest;
mod rules;
mod seeded_numbers;
mod sets_keep_the_optimum;
mod spin;
