//! MPS files.
