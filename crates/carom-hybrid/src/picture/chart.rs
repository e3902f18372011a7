//! Charts: what is drawn over two axes.

use super::draw;
use super::motion::Mover;
use crate::interval::Interval;

/// How points are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum SeriesKind {
    /// With a width in pixels.
    Line(f64),
    /// With a radius in pixels.
    Dots(f64),
    /// With an opacity.
    Area(f64),
    /// With a radius along the axes, in their units, and an opacity.
    Discs(f64, f64),
    /// From one corner to the opposite one, two points each.
    Rectangles,
    /// From the first to the second point.
    Arrow,
    /// Where something begins.
    Start,
    /// Where something should end.
    Goal,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Series {
    pub(super) kind: SeriesKind,
    pub(super) name: String,
    pub(super) colour: String,
    pub(super) points: Vec<[f64; 2]>,
}

/// A label beside a point.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ChartLabel {
    pub(super) text: String,
    pub(super) colour: String,
    pub(super) at: [f64; 2],
    pub(super) is_needed: bool,
}

/// A chart with lines, areas, discs, dots and arrows, in SVG. Points are drawn to a hundredth of a
/// pixel. Names are beside the curves where there is room, and in a legend below otherwise. The
/// picture is light on light pages and dark on dark ones.
///
/// Colours are those of SVG. Those of [`COLOURS`](super::COLOURS), [`SOLID`](super::SOLID),
/// [`AVOIDED`](super::AVOIDED), `black` and `white` are others on dark pages. Names that are not
/// empty are shown once.
///
/// ```
/// use carom::picture::{COLOURS, Chart};
///
/// let fall = (0..=20).map(|k| 0.1 * f64::from(k)).map(|t| [t, 4.905 * t * t]);
/// let mut chart = Chart::new("time (s)", "fallen (m)");
/// chart.line("from rest", COLOURS[0], fall);
/// chart.label("19.6 m", COLOURS[0], [2.0, 19.62]);
/// let svg = Chart::to_svg(&[chart], "A stone");
/// assert!(svg.starts_with("<svg") && svg.contains("from rest"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    pub(super) heading: String,
    pub(super) labels: [String; 2],
    pub(super) size: [f64; 2],
    pub(super) ranges: [Option<Interval>; 2],
    pub(super) is_logarithmic: [bool; 2],
    pub(super) is_equal: bool,
    pub(super) series: Vec<Series>,
    pub(super) notes: Vec<ChartLabel>,
    pub(super) movers: Vec<Mover>,
}

impl Chart {
    /// An empty chart.
    ///
    /// # Arguments
    ///
    /// * `x`, `y`: what is along the axes, with units. An axis without a label has no ticks.
    pub fn new(x: impl Into<String>, y: impl Into<String>) -> Chart {
        Chart {
            heading: String::new(),
            labels: [x.into(), y.into()],
            size: [720.0, 240.0],
            ranges: [None, None],
            is_logarithmic: [false; 2],
            is_equal: false,
            series: Vec::new(),
            notes: Vec::new(),
            movers: Vec::new(),
        }
    }

    /// Sets a line above the plane, for what one of several charts shows.
    #[must_use]
    pub fn with_heading(mut self, heading: impl Into<String>) -> Chart {
        self.heading = heading.into();
        self
    }

    /// Sets what is along the axes, with units.
    #[must_use]
    pub fn with_labels(mut self, x: impl Into<String>, y: impl Into<String>) -> Chart {
        self.labels = [x.into(), y.into()];
        self
    }

    /// Sets width and height of the plane, in pixels; by default 720 and 240.
    #[must_use]
    pub fn with_size(mut self, width: f64, height: f64) -> Chart {
        self.size = [width, height];
        self
    }

    /// Sets what is visible along both axes, in their units; by default all points.
    #[must_use]
    pub fn with_ranges(mut self, x: Interval, y: Interval) -> Chart {
        self.ranges = [Some(x), Some(y)];
        self
    }

    /// Sets what is visible along the horizontal axis, in its unit; by default all points.
    #[must_use]
    pub fn with_horizontal_range(mut self, x: Interval) -> Chart {
        self.ranges[0] = Some(x);
        self
    }

    /// Draws a unit as long along both axes, as for places. The plane then is as large as fits into
    /// its size.
    #[must_use]
    pub fn with_equal_axes(mut self) -> Chart {
        self.is_equal = true;
        self
    }

    /// Makes both axes logarithmic. All coordinates must be positive.
    #[must_use]
    pub fn with_logarithms(mut self) -> Chart {
        self.is_logarithmic = [true; 2];
        self
    }

    /// Makes the horizontal axis logarithmic. All coordinates along it must be positive.
    #[must_use]
    pub fn with_horizontal_logarithm(mut self) -> Chart {
        self.is_logarithmic[0] = true;
        self
    }

    /// Draws a line through points, in the units of the axes.
    pub fn line(
        &mut self,
        name: impl Into<String>,
        colour: &str,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        self.add(SeriesKind::Line(1.8), name.into(), colour, points);
    }

    /// Draws a line of another width, in pixels, as for [`line`](Chart::line).
    pub fn line_of_width(
        &mut self,
        width: f64,
        name: impl Into<String>,
        colour: &str,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        self.add(SeriesKind::Line(width), name.into(), colour, points);
    }

    /// Draws dots, as for [`line`](Chart::line).
    ///
    /// # Arguments
    ///
    /// * `radius`: in pixels.
    pub fn dots(
        &mut self,
        name: impl Into<String>,
        colour: &str,
        radius: f64,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        self.add(SeriesKind::Dots(radius), name.into(), colour, points);
    }

    /// Fills a polygon, as for [`line`](Chart::line). Areas are below everything else.
    ///
    /// # Arguments
    ///
    /// * `opacity`: from 0 to 1; an area below 1 has an outline.
    pub fn area(
        &mut self,
        name: impl Into<String>,
        colour: &str,
        opacity: f64,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        self.add(SeriesKind::Area(opacity), name.into(), colour, points);
    }

    /// Fills discs around points, as for [`area`](Chart::area).
    ///
    /// # Arguments
    ///
    /// * `radius`: in the units of the axes.
    pub fn discs(
        &mut self,
        name: impl Into<String>,
        colour: &str,
        opacity: f64,
        radius: f64,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        self.add(SeriesKind::Discs(radius, opacity), name.into(), colour, points);
    }

    /// Fills rectangles between opposite corners. They are one shape, which is small where there
    /// are many, as in maps.
    pub fn rectangles(&mut self, colour: &str, corners: impl IntoIterator<Item = [[f64; 2]; 2]>) {
        self.add(SeriesKind::Rectangles, String::new(), colour, corners.into_iter().flatten());
    }

    /// Draws an arrow between two points, in the units of the axes.
    pub fn arrow(&mut self, colour: &str, from: [f64; 2], to: [f64; 2]) {
        self.add(SeriesKind::Arrow, String::new(), colour, [from, to]);
    }

    /// Marks where something starts, with a label.
    pub fn start(&mut self, text: impl Into<String>, colour: &str, at: [f64; 2]) {
        self.add(SeriesKind::Start, String::new(), colour, [at]);
        self.label(text, colour, at);
    }

    /// Marks where something should end, with a label.
    pub fn goal(&mut self, text: impl Into<String>, colour: &str, at: [f64; 2]) {
        self.add(SeriesKind::Goal, String::new(), colour, [at]);
        self.label(text, colour, at);
    }

    /// Writes a label beside a point, where least is covered.
    pub fn label(&mut self, text: impl Into<String>, colour: &str, at: [f64; 2]) {
        self.note(text.into(), colour, at, true);
    }

    /// Writes a label beside a point if there is room for it.
    pub fn label_if_room(&mut self, text: impl Into<String>, colour: &str, at: [f64; 2]) {
        self.note(text.into(), colour, at, false);
    }

    /// Lets something move. The picture has to show the same without it.
    pub(crate) fn animate(&mut self, mover: Mover) {
        self.movers.push(mover);
    }

    fn note(&mut self, text: String, colour: &str, at: [f64; 2], is_needed: bool) {
        if at.iter().all(|x| x.is_finite()) && !text.is_empty() {
            self.notes.push(ChartLabel { text, colour: colour.to_owned(), at, is_needed });
        }
    }

    fn add(
        &mut self,
        kind: SeriesKind,
        name: String,
        colour: &str,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        // What is not finite cannot be drawn.
        let points = points.into_iter().filter(|p| p.iter().all(|x| x.is_finite())).collect();
        self.series.push(Series { kind, name, colour: colour.to_owned(), points });
    }

    /// The picture of charts, one below the other, with a title. Further lines of the title are
    /// smaller.
    pub fn to_svg(charts: &[Chart], title: &str) -> String {
        draw::to_svg(charts, title, "", None)
    }
}
