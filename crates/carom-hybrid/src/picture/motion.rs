//! The moving part of a picture. It is shown only where it is played: still pictures show the same
//! without it.

use std::fmt::Write;

use super::frame::{Frame, plain};
use super::marks::{escaped, kept, px};
use super::theme::paint;

/// How far from its place something that moves may be seen, in pixels.
const PLACE_ERROR: f64 = 0.25;

/// The length of a tick of the clock, in s.
const TICK: f64 = 0.1;

/// The width of the clock, and the height of its line, in pixels.
pub(super) const CLOCK: [f64; 2] = [84.0, 26.0];

/// The shape of something that moves, around its place.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Outline {
    /// With a radius in pixels.
    Dot(f64),
    /// With a radius in the units of the axes.
    Disc(f64),
    /// In the units of the axes.
    Polygon(Vec<[f64; 2]>),
    /// A vertical line through the whole frame.
    Hand,
}

/// Something that moves.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Mover {
    pub(crate) colour: String,
    pub(crate) outline: Outline,
    /// From 0 to 1.
    pub(crate) opacity: f64,
    /// Where it is, at times in s that grow from 0 on; it stays where it ends.
    pub(crate) places: Vec<(f64, [f64; 2])>,
    /// After how long everything begins again, in s.
    pub(crate) period: f64,
}

/// A clock that stands still at the end.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Stopwatch {
    /// In s.
    pub(crate) end: f64,
    /// After how long everything begins again, in s.
    pub(crate) period: f64,
}

/// The part of the picture that is there only where it is played, and not for those who ask for
/// less motion.
fn live(svg: &mut String, body: &str) {
    let _ = writeln!(
        svg,
        "<g class=\"live\" visibility=\"hidden\"><set attributeName=\"visibility\" to=\"visible\"/>\
         {body}</g>"
    );
}

/// A share of the period, as a time of an animation.
fn share(time: f64, period: f64) -> String {
    let text = format!("{:.4}", (time / period).clamp(0.0, 1.0));
    let text = text.trim_end_matches('0').trim_end_matches('.');
    text.strip_prefix('0').filter(|rest| !rest.is_empty()).unwrap_or(text).to_owned()
}

impl Mover {
    pub(super) fn draw(&self, svg: &mut String, frame: &Frame) {
        let points: Vec<[f64; 2]> = self.places.iter().map(|(_, at)| frame.pixel(*at)).collect();
        let time = |k: usize| self.places[k].0;
        // Away from where it would be on the straight way between two others at the same time.
        let away = |k: usize, a: usize, b: usize| {
            let part =
                if time(b) > time(a) { (time(k) - time(a)) / (time(b) - time(a)) } else { 0.0 };
            let at = |i: usize| points[a][i] + part * (points[b][i] - points[a][i]);
            (points[k][0] - at(0)).hypot(points[k][1] - at(1))
        };
        let numbers = kept(points.len(), PLACE_ERROR, away);
        let Some(&last) = numbers.last() else { return };
        let (mut values, mut times) = (Vec::new(), Vec::new());
        for k in numbers {
            values.push(points[k]);
            times.push(share(time(k), self.period));
        }
        if time(last) < self.period {
            values.push(points[last]);
            times.push("1".to_owned());
        }
        let values: Vec<String> =
            values.iter().map(|[x, y]| format!("{} {}", px(*x), px(*y))).collect();
        let shape = match &self.outline {
            Outline::Dot(radius) => format!("<circle r=\"{radius}\"/>"),
            Outline::Disc(radius) => {
                let [x, y] = [0, 1].map(|axis| px(radius * frame.scale(axis)));
                format!("<ellipse rx=\"{x}\" ry=\"{y}\"/>")
            }
            Outline::Polygon(corners) => {
                let corners: Vec<String> = corners
                    .iter()
                    .map(|[x, y]| format!("{},{}", px(x * frame.scale(0)), px(-y * frame.scale(1))))
                    .collect();
                format!("<polygon points=\"{}\"/>", corners.join(" "))
            }
            Outline::Hand => {
                format!("<rect x=\"-1\" width=\"2\" height=\"{}\"/>", px(frame.size[1]))
            }
        };
        let mut body = String::new();
        let _ = write!(
            body,
            "<g {} fill=\"currentColor\" fill-opacity=\"{}\" stroke=\"currentColor\">{shape}\
             <animateTransform attributeName=\"transform\" type=\"translate\" dur=\"{}s\" \
             repeatCount=\"indefinite\" keyTimes=\"{}\" values=\"{}\"/></g>",
            paint(&self.colour),
            self.opacity,
            plain(self.period),
            times.join(";"),
            values.join(";")
        );
        live(svg, &body);
    }
}

impl Stopwatch {
    /// Draws it to the left of a point.
    pub(super) fn draw(&self, svg: &mut String, [right, top]: [f64; 2]) {
        let [width, line] = CLOCK;
        let count = (self.end / TICK + 1e-9).floor() as usize;
        let mut body = String::new();
        let _ = write!(
            body,
            "<svg x=\"{}\" y=\"{}\" width=\"{width}\" height=\"{line}\"><text font-size=\"20\" \
             text-anchor=\"end\">",
            px(right - width),
            px(top)
        );
        let (mut values, mut times) = (Vec::new(), Vec::new());
        for k in 0..=count {
            let shown = escaped(&format!("{:.1} s", TICK * k as f64));
            let down = if k == 0 { 20.0 } else { line };
            let _ = write!(body, "<tspan x=\"{width}\" dy=\"{down}\">{shown}</tspan>");
            values.push(format!("0 {}", px(-line * k as f64)));
            times.push(share(TICK * k as f64, self.period));
        }
        let _ = write!(
            body,
            "<animateTransform attributeName=\"transform\" type=\"translate\" calcMode=\"discrete\" \
             dur=\"{}s\" repeatCount=\"indefinite\" keyTimes=\"{}\" values=\"{}\"/></text></svg>",
            plain(self.period),
            times.join(";"),
            values.join(";")
        );
        live(svg, &body);
    }
}
