//! Elementary functions of one variable: values, derivatives, ranges, curvature, and lines below
//! and above them, all with proved errors.
//!
//! * `function.rs` names the functions, and evaluates them and their derivatives.
//! * `range.rs`: the values over an interval; `inverse.rs`: the arguments of an interval of values.
//! * `curvature.rs`: where a function is convex and where it is concave.
//! * `line.rs`: the line below or above a function that is tight at a point.
//! * `smooth.rs`: functions that users add.
//!
//! The standard library promises no accuracy for its functions; those that it is built on err by
//! less than one unit in the last place. `VALUE_ROUNDING` allows for four.

mod curvature;
mod function;
mod inverse;
mod line;
mod range;
mod series;
mod smooth;

pub use function::Elementary;
pub use line::SupportLine;
pub use series::IntervalSeries;
pub use smooth::{OwnFunction, SmoothFunction};
