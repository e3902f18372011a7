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

/// Colours that colour-blind readers tell apart (M. Okabe and K. Ito, 2008), and grey. On dark
/// pages pictures have lighter ones in their places.
pub const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#555555"];

/// Plans without a collision: blue, and others for further plans and bodies of a picture.
///
/// This and the next colours mean the same in all pictures. A horizon that is refuted has no
/// colour: its sets [`REACHED`] and [`TO_GO`] do not meet.
pub const WITHOUT_COLLISION: [&str; 3] = [COLOURS[0], COLOURS[5], COLOURS[2]];

/// Plans with a collision: orange, and others for further plans and bodies of a picture.
pub const WITH_COLLISION: [&str; 4] = [COLOURS[1], COLOURS[3], COLOURS[4], COLOURS[6]];

/// Where something should end: green.
pub const GOAL_COLOUR: &str = COLOURS[2];

/// Obstacles that bodies may hit: grey.
pub const SOLID: &str = "solid";

/// Obstacles and regions that are avoided: a lighter grey.
pub const AVOIDED: &str = "avoided";

/// Sets of states that are reached from the start: blue.
pub const REACHED: &str = COLOURS[0];

/// Sets of states from which the goal is reached: yellow.
pub const TO_GO: &str = COLOURS[4];
