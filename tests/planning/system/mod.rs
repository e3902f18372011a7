//! Hybrid systems, stated once: simulation, certificates, flaws, constructors, texts.

mod flaws;
mod simulate;
