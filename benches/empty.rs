//! A package needs a library or a program; this one has only benchmarks.
