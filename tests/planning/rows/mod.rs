//! Hybrid systems as rows: the paper's wall, random systems, names.

mod names;
mod properties;
mod shapes;
mod supports;
mod systems;
pub(crate) mod wall;
