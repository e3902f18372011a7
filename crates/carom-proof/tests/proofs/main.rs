//! Each rule accepted and each way of breaking it rejected, by hand and at random.

mod bytes;
mod commands;
mod compare;
mod contexts;
mod convexity;
mod enumeration;
mod exact;
mod format;
mod functions;
mod linear;
mod log;
mod moves;
mod products;
mod rounding;
mod soundness;
