//! Norms and convex quadratic rows: statements about lengths of vectors.
//!
//! * `norm` - the length of a vector, and its comparison
//! * `conic_row` - comparisons as statements of a model
//! * `standard_cone` - a statement as one second-order cone over affine expressions

mod conic_row;
mod norm;
mod standard_cone;

pub use conic_row::{ConicRef, ConicRow};
pub use norm::{Norm, norm};

pub(crate) use conic_row::StoredConic;
pub(crate) use standard_cone::StandardCone;
