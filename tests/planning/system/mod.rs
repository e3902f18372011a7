//! Hybrid systems, stated once: simulation, certificates, flaws, constructors, texts.

mod certify;
mod constructors;
mod flaws;
mod literature;
mod random;
#[cfg(feature = "serde")]
mod serde;
mod simulate;
mod text;
