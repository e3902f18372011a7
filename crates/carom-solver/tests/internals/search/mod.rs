//! Parts of the tree search, one by one.

mod allowance;
mod best_points;
mod comparison;
mod first_cuts;
mod growth;
mod indifferent_binaries;
mod jump_value;
mod node;
mod node_probing;
mod perspective;
mod pseudocosts;
mod roll_out;
mod strong_fixing;
