//! What cannot be stated.
