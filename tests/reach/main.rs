//! Reach sets: what they contain, what they exclude, and what they say about programs.
mod exact;
mod runs;
mod systems;
