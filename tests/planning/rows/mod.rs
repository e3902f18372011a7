//! Hybrid systems as rows: the paper's wall, random systems, names.

mod wall;
