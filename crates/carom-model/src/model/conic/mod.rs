//! Norms and convex quadratic rows: statements about lengths of vectors.
//!
//! * `norm` - the length of a vector, and its comparison
//! * `norm_sum` - sums of norms and a quadratic expression, in objectives and rows
//! * `stored_conic`, `conic_ref` - what a model stores, and how it is read
//! * `conic_row` - comparisons as statements of a model
//! * `conditional` - the same under a condition
//! * `quadratic_row` - comparisons of quadratic expressions
//! * `standard_cone` - a statement as one second-order cone over affine expressions
//! * `squares` - completion of squares
//! * `sheet` - the sign of the head of a cone

mod conditional;
mod conic_ref;
mod conic_row;
mod norm;
mod norm_sum;
mod quadratic_row;
mod sheet;
mod squares;
pub(crate) mod standard_cone;
pub(crate) mod stored_conic;

pub use conic_ref::ConicRef;
pub use conic_row::ConicRow;
pub use norm::{Norm, norm};
pub use norm_sum::{NormSum, NormSumRow};

pub(crate) use stored_conic::StoredConic;
