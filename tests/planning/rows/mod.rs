//! Hybrid systems as rows: the paper's wall, random systems, names.

mod names;
mod properties;
mod systems;
mod wall;
