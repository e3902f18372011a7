//! Parts that tests and the other crates of the workspace use beside the public interface. They may
//! change in any release.

pub use crate::hybrid::rows::SystemVariables;
pub use crate::hybrid::scene::samples::{Samples, advance_line, replay_line};
pub use crate::hybrid::system::{Choice, Halfspace, Transition};

use crate::hybrid::Matrix;

pub fn exponential(matrix: &Matrix) -> Matrix {
    crate::hybrid::exponential::exponential(matrix.faer()).into()
}
