//! Missions in signal temporal logic.

mod random;
mod scenarios;
mod statements;
