//! Small programs that are meant to hurt, and their exact answers; for tests and an example.

// Each of these uses a part of this module.
#![allow(dead_code)]

pub(crate) mod big_m;
pub(crate) mod complementarity;
pub(crate) mod cones;
mod dense;
mod dyadic;
pub(crate) mod families;
pub(crate) mod generator;
mod open_integers;
pub(crate) mod oracle;
