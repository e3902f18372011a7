//! From the plane of two quantities to pixels, and its axes.

use std::fmt::Write;

use super::marks::{escaped, px};

/// The room that a label takes along the horizontal and the vertical axis, in pixels.
const ROOM: [f64; 2] = [80.0, 45.0];

/// The visible part of a plane, and where it is in the picture.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
    /// The left and the upper edge, in pixels.
    pub(super) corner: [f64; 2],
    /// Width and height, in pixels.
    pub(super) size: [f64; 2],
    /// Which axes are logarithmic.
    pub(super) is_logarithmic: [bool; 2],
}

impl Frame {
    /// A point in pixels. Points far outside are moved nearer, as renderers have limits.
    pub(super) fn pixel(&self, point: [f64; 2]) -> [f64; 2] {
        let share = |axis: usize| {
            let value = |x: f64| if self.is_logarithmic[axis] { x.log10() } else { x };
            let [low, high, x] = [self.low[axis], self.high[axis], point[axis]].map(value);
            ((x - low) / (high - low)).clamp(-9.0, 10.0)
        };
        [self.corner[0] + share(0) * self.size[0], self.corner[1] + (1.0 - share(1)) * self.size[1]]
    }

    /// Pixels per unit along an axis that is not logarithmic.
    pub(super) fn scale(&self, axis: usize) -> f64 {
        self.size[axis] / (self.high[axis] - self.low[axis])
    }

    /// Whether a point in pixels is inside.
    pub(super) fn holds(&self, [x, y]: [f64; 2]) -> bool {
        let ([left, top], [width, height]) = (self.corner, self.size);
        (left - 0.5..=left + width + 0.5).contains(&x)
            && (top - 0.5..=top + height + 0.5).contains(&y)
    }

    /// Faint lines at the ticks of the axes that have labels, and the frame.
    pub(super) fn grid(&self, svg: &mut String, labels: [&str; 2]) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        let mut lines = String::new();
        for (axis, _) in labels.into_iter().enumerate().filter(|(_, label)| !label.is_empty()) {
            for tick in self.ticks(axis) {
                let mut at = self.low;
                at[axis] = tick;
                let [x, y] = self.pixel(at).map(px);
                // Writing into a string cannot fail, here and below.
                let _ = match axis {
                    0 => write!(lines, "M{x} {y}v{}", px(-height)),
                    _ => write!(lines, "M{x} {y}h{}", px(width)),
                };
            }
        }
        let _ = writeln!(
            svg,
            "<g class=\"m\" stroke=\"currentColor\" fill=\"none\"><path d=\"{lines}\" \
             stroke-opacity=\".18\"/><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></g>",
            px(left),
            px(top),
            px(width),
            px(height)
        );
    }

    /// Numbers at ticks, and labels.
    pub(super) fn axes(&self, svg: &mut String, labels: [&str; 2]) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        for (axis, label) in labels.into_iter().enumerate().filter(|(_, label)| !label.is_empty()) {
            let anchor = if axis == 0 { "middle" } else { "end" };
            let _ = writeln!(svg, "<g class=\"m\" font-size=\"12\" text-anchor=\"{anchor}\">");
            for tick in self.ticks(axis) {
                let mut at = self.low;
                at[axis] = tick;
                let [x, y] = self.pixel(at);
                let [x, y] = if axis == 0 { [x, y + 16.0] } else { [x - 6.0, y + 4.0] }.map(px);
                let _ = write!(svg, "<text x=\"{x}\" y=\"{y}\">{}</text>", plain(tick));
            }
            let label = escaped(label);
            let _ = match axis {
                0 => writeln!(
                    svg,
                    "</g>\n<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{label}</text>",
                    px(left + 0.5 * width),
                    px(top + height + 34.0)
                ),
                _ => writeln!(
                    svg,
                    "</g>\n<text transform=\"translate({} {}) rotate(-90)\" \
                     text-anchor=\"middle\">{label}</text>",
                    px(left - 46.0),
                    px(top + 0.5 * height)
                ),
            };
        }
    }

    /// Round numbers along an axis.
    fn ticks(&self, axis: usize) -> Vec<f64> {
        let (low, high) = (self.low[axis], self.high[axis]);
        if self.is_logarithmic[axis] {
            let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
            let all = decades.flat_map(|k| [1.0, 2.0, 5.0].map(|f| f * 10.0_f64.powi(k)));
            return all.filter(|tick| (low..=high).contains(tick)).collect();
        }
        let step = spacing(high - low, (self.size[axis] / ROOM[axis]).max(2.0));
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let count = if last >= first { (last - first).min(99.0) as usize } else { return vec![] };
        (0..=count).map(|k| (first + k as f64) * step).collect()
    }
}

/// A round distance between at most about `count` marks.
pub(crate) fn spacing(extent: f64, count: f64) -> f64 {
    let rough = extent / count;
    let power = 10.0_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    steps.into_iter().find(|step| *step >= rough).unwrap_or(rough)
}

/// A number with at most six digits after the point, without trailing zeros.
pub(crate) fn plain(value: f64) -> String {
    let text = format!("{value:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
