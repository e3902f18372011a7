//! Where labels go: beside what they name, where nothing else is.

use std::fmt::Write;

use super::marks::{escaped, px};
use super::theme::paint;

/// The height of a label, and about the width of its letters, in pixels.
const LABEL_HEIGHT: f64 = 15.0;
const LABEL_LETTER: f64 = 7.0;

/// Around labels nothing is drawn so near, in pixels.
const PADDING: f64 = 2.0;

/// Curves are points so near to each other, in pixels.
const SPACING: f64 = 4.0;

/// How near a label is to what it names, and how far it may be, in pixels.
const GAPS: [f64; 5] = [6.0, 11.0, 20.0, 34.0, 60.0];

/// A label that is further away has a line to what it names, in pixels.
const UNTIED: f64 = 15.0;

/// Clearer than this is clear, in pixels.
const CLEAR: f64 = 24.0;

/// On which side of a point a label may be, the best first.
const DIRECTIONS: [[f64; 2]; 8] = [
    [1.0, 0.0],
    [0.0, -1.0],
    [0.7, -0.7],
    [0.7, 0.7],
    [-1.0, 0.0],
    [0.0, 1.0],
    [-0.7, -0.7],
    [-0.7, 0.7],
];

type Rectangle = [f64; 4]; // left, top, right, bottom

/// A label and the points that it may be beside, in pixels.
#[derive(Debug)]
pub(super) struct Label<'a> {
    pub(super) text: &'a str,
    pub(super) colour: &'a str,
    pub(super) anchors: Vec<[f64; 2]>,
    /// Whether it is drawn even where it covers something.
    pub(super) is_needed: bool,
    /// The curve that it names: it keeps away from all others.
    pub(super) own: Option<usize>,
}

/// Where a label may be.
#[derive(Debug)]
pub(super) struct LabelPlace {
    pub(super) cost: f64,
    own: Rectangle,
    at: [f64; 2],
    gap: f64,
}

/// The marks that are drawn in a frame already.
#[derive(Debug)]
pub(super) struct Room {
    bounds: Rectangle,
    /// Points of curves, and whose they are.
    ink: Vec<(usize, [f64; 2])>,
    labels: Vec<Rectangle>,
}

impl Room {
    pub(super) fn new([x, y]: [f64; 2], [width, height]: [f64; 2]) -> Room {
        Room { bounds: [x, y, x + width, y + height], ink: Vec::new(), labels: Vec::new() }
    }

    /// Keeps labels away from a curve.
    pub(super) fn draw(&mut self, own: usize, points: &[[f64; 2]]) {
        let [left, top, right, bottom] = self.bounds;
        let mut add = |[x, y]: [f64; 2]| {
            if (left..=right).contains(&x) && (top..=bottom).contains(&y) {
                self.ink.push((own, [x, y]));
            }
        };
        if let Some(first) = points.first() {
            add(*first);
        }
        for ends in points.windows(2) {
            let [from, to] = [ends[0], ends[1]];
            let pieces = ((to[0] - from[0]).hypot(to[1] - from[1]) / SPACING).ceil().min(2e3);
            for k in 1..=pieces as usize {
                let share = k as f64 / pieces;
                add([0, 1].map(|i| from[i] + share * (to[i] - from[i])));
            }
        }
    }

    /// The best place of a label; none if there is no room for one that need not be.
    pub(super) fn find(&self, label: &Label<'_>) -> Option<LabelPlace> {
        let width = LABEL_LETTER * label.text.chars().count() as f64 + 2.0;
        let half = [0.5 * width, 0.5 * LABEL_HEIGHT];
        let gaps = if label.own.is_some() { &GAPS[..2] } else { &GAPS };
        let last = label.anchors.len().saturating_sub(1).max(1) as f64;
        let mut best: Option<LabelPlace> = None;
        for (k, &at) in label.anchors.iter().enumerate() {
            let sides = || DIRECTIONS.iter().enumerate();
            for (gap, (s, side)) in gaps.iter().flat_map(|gap| sides().map(move |side| (gap, side)))
            {
                // Beside the point, or beyond its corner.
                let centre = [0, 1].map(|i| {
                    let away = side[i].abs() * gap + if side[i] == 0.0 { 0.0 } else { half[i] };
                    at[i] + away.copysign(side[i])
                });
                let ([x, y], [w, h]) = (self.inside(centre, half, *side), half);
                let own = [x - w, y - h, x + w, y + h];
                let (outside, covered, clear) = self.judge(&own, label.own);
                if !label.is_needed && (outside > 0.0 || covered > 0.0) {
                    continue;
                }
                // Curves are named where they are alone, and rather near their ends.
                let (alone, early) = match label.own {
                    Some(_) => (0.7, 4.0 * (1.0 - k as f64 / last)),
                    None => (0.15, 0.0),
                };
                // Towards the middle there is more room for others.
                let [left, top, right, bottom] = self.bounds;
                let middle = (x - 0.5 * (left + right)).hypot(y - 0.5 * (top + bottom));
                let cost = 30.0 * outside
                    + 12.0 * covered
                    + 0.4 * gap
                    + 0.3 * s as f64
                    + early
                    + 0.01 * middle
                    - alone * clear;
                if best.as_ref().is_none_or(|best| cost < best.cost) {
                    best = Some(LabelPlace { cost, own, at, gap: *gap });
                }
            }
        }
        best
    }

    /// The middle of a label above or below a point, or beside it, moved along the edge that it is
    /// over.
    fn inside(&self, centre: [f64; 2], half: [f64; 2], side: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|i| {
            let (low, high) = (self.bounds[i] + half[i] + 2.0, self.bounds[i + 2] - half[i] - 2.0);
            let is_free = side[i] == 0.0 && low < high;
            if is_free { centre[i].clamp(low, high) } else { centre[i] }
        })
    }

    /// Draws a label at a place.
    pub(super) fn write(&mut self, svg: &mut String, label: &Label<'_>, place: &LabelPlace) {
        let LabelPlace { own, at, gap, .. } = place;
        if *gap > UNTIED {
            let end = [own[0].max(at[0].min(own[2])), own[1].max(at[1].min(own[3]))];
            let _ = writeln!(
                svg,
                "<path {} d=\"M{} {}L{} {}\" stroke=\"currentColor\" stroke-opacity=\".6\"/>",
                paint(label.colour),
                px(at[0]),
                px(at[1]),
                px(end[0]),
                px(end[1])
            );
        }
        let _ = writeln!(
            svg,
            "<g {}><text class=\"h\" x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text></g>",
            paint(label.colour),
            px(0.5 * (own[0] + own[2])),
            px(own[3] - 4.0),
            escaped(label.text)
        );
        self.labels.push(*own);
    }

    /// How far a label is outside, how much it covers, and how far other curves are from it.
    fn judge(&self, own: &Rectangle, curve: Option<usize>) -> (f64, f64, f64) {
        let [left, top, right, bottom] = self.bounds;
        let outside =
            [left + 2.0 - own[0], top + 1.0 - own[1], own[2] - right + 2.0, own[3] - bottom + 1.0];
        let outside = outside.into_iter().map(|far| far.max(0.0)).sum();
        let (mut covered, mut clear) = (0.0, CLEAR);
        for (of, [x, y]) in &self.ink {
            let dx = (own[0] - x).max(x - own[2]).max(0.0);
            let dy = (own[1] - y).max(y - own[3]).max(0.0);
            let far = dx.hypot(dy);
            if far < PADDING {
                covered += 1.0;
            }
            if curve != Some(*of) {
                clear = clear.min(far);
            }
        }
        for other in &self.labels {
            let apart = own[0] > other[2] + 3.0
                || other[0] > own[2] + 3.0
                || own[1] > other[3]
                || other[1] > own[3];
            covered += if apart { 0.0 } else { 50.0 };
        }
        (outside, covered, clear)
    }
}
