//! Missions in signal temporal logic.

mod random;
mod scenarios;
mod sketch;
mod statements;
mod systems;
