//! Charts of points over an axis.

use std::fmt::Write;

use super::frame::Frame;
use super::marks::{begin, circle, escaped, legend, path, polygon};
use crate::interval::Interval;

/// The room around a frame: left, right, above and below, in pixels.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 20.0;
const ABOVE: f64 = 14.0;
const BELOW: f64 = 48.0;

/// The height of a title, in pixels.
const TITLE: f64 = 30.0;

/// How points are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
enum SeriesKind {
    /// With a width in pixels.
    Line(f64),
    /// With a radius in pixels.
    Dots(f64),
    /// With an opacity.
    Area(f64),
}

#[derive(Debug, Clone, PartialEq)]
struct Series {
    kind: SeriesKind,
    name: String,
    colour: String,
    points: Vec<[f64; 2]>,
}

/// A chart with lines, areas and dots, in SVG. Points are drawn to a hundredth of a pixel, and the
/// legend is below everything.
///
/// ```
/// use carom::picture::{COLOURS, Chart};
///
/// let fall = (0..=20).map(|k| 0.1 * f64::from(k)).map(|t| [t, 4.905 * t * t]);
/// let mut chart = Chart::new("time (s)", "fallen (m)");
/// chart.line("from rest", COLOURS[0], fall);
/// let svg = Chart::to_svg(&[chart], "A stone");
/// assert!(svg.starts_with("<svg") && svg.contains("from rest"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    labels: [String; 2],
    size: [f64; 2],
    ranges: [Option<Interval>; 2],
    is_logarithmic: bool,
    series: Vec<Series>,
}

impl Chart {
    /// An empty chart.
    ///
    /// # Arguments
    ///
    /// * `x`, `y`: what is along the axes, with units. An axis without a label has no ticks.
    pub fn new(x: impl Into<String>, y: impl Into<String>) -> Chart {
        Chart {
            labels: [x.into(), y.into()],
            size: [720.0, 240.0],
            ranges: [None, None],
            is_logarithmic: false,
            series: Vec::new(),
        }
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

    /// Makes both axes logarithmic. All coordinates must be positive.
    #[must_use]
    pub fn with_logarithms(mut self) -> Chart {
        self.is_logarithmic = true;
        self
    }

    /// Draws a line through points, in the units of the axes. Names that are not empty stand in the
    /// legend, each once; colours are those of SVG.
    pub fn line(
        &mut self,
        name: impl Into<String>,
        colour: &str,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        self.add(SeriesKind::Line(1.8), name.into(), colour, points);
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

    /// Fills a polygon, as for [`line`](Chart::line). Areas are below lines and dots.
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

    fn add(
        &mut self,
        kind: SeriesKind,
        name: String,
        colour: &str,
        points: impl IntoIterator<Item = [f64; 2]>,
    ) {
        // What is not finite cannot be drawn.
        let points = points.into_iter().filter(|p| p.iter().all(|x| x.is_finite())).collect();
        self.series.push(Series { kind, name, colour: escaped(colour), points });
    }

    /// The picture of charts, one below the other, with a title and one legend.
    pub fn to_svg(charts: &[Chart], title: &str) -> String {
        let width = LEFT + RIGHT + charts.iter().map(|c| c.size[0]).fold(0.0, f64::max);
        let mut body = String::new();
        if !title.is_empty() {
            let _ = writeln!(
                body,
                "<text x=\"{:.2}\" y=\"24\" text-anchor=\"middle\" font-size=\"17\">{}</text>",
                0.5 * width,
                escaped(title)
            );
        }
        let mut top = if title.is_empty() { 0.0 } else { TITLE };
        for (number, chart) in charts.iter().enumerate() {
            let frame = chart.frame([LEFT, top + ABOVE]);
            chart.draw(&mut body, &frame, number);
            let [x, _] = &chart.labels;
            top += ABOVE + chart.size[1] + if x.is_empty() { 0.0 } else { BELOW };
        }
        let entries = entries(charts);
        if !entries.is_empty() {
            top += legend(&mut body, &entries, [LEFT, top + ABOVE], width - LEFT - RIGHT);
        }
        format!("{}{body}</g>\n</svg>\n", begin(width, top + ABOVE))
    }

    /// The visible part of the plane.
    fn frame(&self, corner: [f64; 2]) -> Frame {
        let range = |axis: usize| {
            if let Some(range) = self.ranges[axis].filter(|range| range.lower < range.upper) {
                return (range.lower, range.upper);
            }
            let values = || self.series.iter().flat_map(|s| &s.points).map(|point| point[axis]);
            let low = values().fold(f64::INFINITY, f64::min);
            let high = values().fold(f64::NEG_INFINITY, f64::max);
            if low > high {
                return (1.0, 2.0);
            }
            if self.is_logarithmic {
                return (0.8 * low.max(1e-12), 1.25 * high.max(1e-12));
            }
            let room = (0.05 * (high - low)).max(1e-9 * (1.0 + low.abs()));
            // Time begins at the frame.
            (
                if axis == 0 { low } else { low - room },
                high + if axis == 0 { 0.3 } else { 1.0 } * room,
            )
        };
        let ((x, u), (y, v)) = (range(0), range(1));
        Frame {
            low: [x, y],
            high: [u, v],
            corner,
            size: self.size,
            is_logarithmic: self.is_logarithmic,
        }
    }

    fn draw(&self, svg: &mut String, frame: &Frame, number: usize) {
        let [x, y] = frame.corner;
        let [width, height] = frame.size;
        let _ = writeln!(
            svg,
            "<clipPath id=\"frame{number}\"><rect x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" \
             height=\"{height:.2}\"/></clipPath>\n<g clip-path=\"url(#frame{number})\">"
        );
        let is_area = |series: &&Series| matches!(series.kind, SeriesKind::Area(_));
        let others = || self.series.iter().filter(|series| !is_area(series));
        for series in self.series.iter().filter(is_area).chain(others()) {
            let points: Vec<[f64; 2]> = series.points.iter().map(|p| frame.pixel(*p)).collect();
            let colour = &series.colour;
            match series.kind {
                SeriesKind::Area(opacity) => {
                    // Neighbours show no seam.
                    let outline = match opacity < 1.0 {
                        true => format!(" stroke=\"{colour}\""),
                        false => " shape-rendering=\"crispEdges\"".to_owned(),
                    };
                    let _ = writeln!(
                        svg,
                        "<polygon points=\"{}\" fill=\"{colour}\" fill-opacity=\"{opacity}\"\
                         {outline}/>",
                        polygon(&points)
                    );
                }
                SeriesKind::Line(width) => {
                    let _ = writeln!(
                        svg,
                        "<path d=\"{}\" fill=\"none\" stroke=\"{colour}\" \
                         stroke-width=\"{width}\"/>",
                        path(&points)
                    );
                }
                SeriesKind::Dots(radius) => {
                    for point in points {
                        circle(svg, point, radius, &format!("fill=\"{colour}\""));
                    }
                }
            }
        }
        svg.push_str("</g>\n");
        let [x, y] = &self.labels;
        frame.axes(svg, [x, y]);
    }
}

/// The entries of the legend: each name once.
fn entries(charts: &[Chart]) -> Vec<(String, String)> {
    let mut entries: Vec<(String, String)> = Vec::new();
    for series in charts.iter().flat_map(|chart| &chart.series) {
        if series.name.is_empty() || entries.iter().any(|(_, name)| *name == series.name) {
            continue;
        }
        let colour = &series.colour;
        let mark = match series.kind {
            SeriesKind::Line(width) => {
                format!("<line x2=\"26\" stroke=\"{colour}\" stroke-width=\"{width}\"/>")
            }
            SeriesKind::Dots(radius) => {
                format!("<circle cx=\"13\" r=\"{radius}\" fill=\"{colour}\"/>")
            }
            SeriesKind::Area(opacity) => format!(
                "<rect y=\"-6\" width=\"26\" height=\"12\" fill=\"{colour}\" \
                 fill-opacity=\"{opacity}\" stroke=\"{}\"/>",
                if opacity < 1.0 { colour } else { "#888888" }
            ),
        };
        entries.push((mark, series.name.clone()));
    }
    entries
}
