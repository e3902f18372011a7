//! Asking back: why a model has no solution, what would have to give, what a point violates.

mod elastic;
mod groups;
mod implied_bounds;
mod limits;
mod random;
mod violations;
mod wall;
