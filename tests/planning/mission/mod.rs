//! Missions in signal temporal logic.

mod choices;
mod functions;
mod random;
mod scenarios;
mod sketch;
mod statements;
mod systems;
