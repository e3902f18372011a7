//! From the plane of two quantities to pixels, and its axes.

use std::fmt::Write;

/// The room that a label takes along the horizontal and the vertical axis, in pixels.
const ROOM: [f64; 2] = [80.0, 45.0];

/// The visible part of a plane, and where it is in the picture.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frame {
    pub(crate) low: [f64; 2],
    pub(crate) high: [f64; 2],
    /// The left and the upper edge, in pixels.
    pub(crate) corner: [f64; 2],
    /// Width and height, in pixels.
    pub(crate) size: [f64; 2],
    /// Whether both axes are logarithmic.
    pub(crate) is_logarithmic: bool,
}

impl Frame {
    /// A point in pixels. Points far outside are moved nearer, as renderers have limits.
    pub(crate) fn pixel(&self, point: [f64; 2]) -> [f64; 2] {
        let value = |x: f64| if self.is_logarithmic { x.log10() } else { x };
        let share = |axis: usize| {
            let [low, high, x] = [self.low[axis], self.high[axis], point[axis]].map(value);
            ((x - low) / (high - low)).clamp(-9.0, 10.0)
        };
        [self.corner[0] + share(0) * self.size[0], self.corner[1] + (1.0 - share(1)) * self.size[1]]
    }

    /// Pixels per unit along an axis that is not logarithmic.
    pub(crate) fn scale(&self, axis: usize) -> f64 {
        self.size[axis] / (self.high[axis] - self.low[axis])
    }

    /// Frame, ticks and labels; no ticks along an axis without a label.
    pub(crate) fn axes(&self, svg: &mut String, labels: [&str; 2]) {
        let [left, top] = self.corner;
        let [width, height] = self.size;
        let bottom = top + height;
        // Writing into a string cannot fail, here and below.
        let _ = writeln!(
            svg,
            "<rect x=\"{left:.2}\" y=\"{top:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" \
             fill=\"none\" stroke=\"#888888\"/>"
        );
        for (axis, label) in labels.into_iter().enumerate().filter(|(_, label)| !label.is_empty()) {
            for tick in self.ticks(axis) {
                let text = plain(tick);
                let mut at = self.low;
                at[axis] = tick;
                let [x, y] = self.pixel(at);
                let _ = match axis {
                    0 => writeln!(
                        svg,
                        "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{x:.2}\" y2=\"{:.2}\" \
                         stroke=\"#888888\"/><text x=\"{x:.2}\" y=\"{:.2}\" \
                         text-anchor=\"middle\">{text}</text>",
                        y + 4.0,
                        y + 18.0
                    ),
                    _ => writeln!(
                        svg,
                        "<line x1=\"{x:.2}\" y1=\"{y:.2}\" x2=\"{:.2}\" y2=\"{y:.2}\" \
                         stroke=\"#888888\"/><text x=\"{:.2}\" y=\"{:.2}\" \
                         text-anchor=\"end\">{text}</text>",
                        x - 4.0,
                        x - 7.0,
                        y + 4.0
                    ),
                };
            }
            let label = super::escaped(label);
            let _ = match axis {
                0 => writeln!(
                    svg,
                    "<text x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"middle\">{label}</text>",
                    left + 0.5 * width,
                    bottom + 36.0
                ),
                _ => writeln!(
                    svg,
                    "<text transform=\"translate({:.2} {:.2}) rotate(-90)\" \
                     text-anchor=\"middle\">{label}</text>",
                    left - 44.0,
                    top + 0.5 * height
                ),
            };
        }
    }

    /// Round numbers along an axis.
    fn ticks(&self, axis: usize) -> Vec<f64> {
        let (low, high) = (self.low[axis], self.high[axis]);
        if self.is_logarithmic {
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
