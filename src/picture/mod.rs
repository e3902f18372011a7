//! Pictures as SVG text: charts with lines, areas and dots, and the frame that plans and sets are
//! drawn in.

mod chart;
mod frame;
mod marks;

pub use chart::Chart;
pub(crate) use frame::{Frame, plain, spacing};
pub(crate) use marks::{begin, circle, escaped, legend, path, polygon};

/// Colours that colour-blind readers tell apart (M. Okabe and K. Ito, 2008), and grey.
pub const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"];
