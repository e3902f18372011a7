//! Hybrid systems with nonlinear rates, guards, limits and goals, beside formulas and simulators
//! that are written here.

mod claims;
mod fields;
mod loops;
mod methods;
mod statements;
mod tubes;
