//! Pictures as SVG text. All are written by [`Chart`]: lines, areas, discs and dots in a frame,
//! with labels where the curves are, in colours that follow the page from light to dark.
//!
//! `chart` says what is drawn, `draw` draws it: in a `frame` with axes, by the `marks`, with
//! `labels` where there is room, with what `motion` moves, in the colours of the `theme`.

mod chart;
mod draw;
mod frame;
mod labels;
mod marks;
mod motion;
mod theme;

pub use chart::Chart;
pub(crate) use draw::to_svg;
pub(crate) use frame::{plain, spacing};
pub(crate) use motion::{Mover, Outline, Stopwatch};
pub(crate) use theme::{AVOIDED, SOLID};

/// Colours that colour-blind readers tell apart (M. Okabe and K. Ito, 2008), and grey. On dark
/// pages pictures have lighter ones in their places.
pub const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"];
