//! The parts of a picture: lines, areas, dots, legends. Coordinates are exact to a hundredth of a
//! pixel.

use std::fmt::Write;

/// How far a line may be from the points that it stands for, in pixels.
const LINE_ERROR: f64 = 0.02;

/// The height of a line of text, and about the width of a letter, in pixels.
const LINE: f64 = 18.0;
const LETTER: f64 = 7.6;

/// The beginning of a picture; it ends with `</g>\n</svg>\n`.
pub(crate) fn begin(width: f64, height: f64) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
         viewBox=\"0 0 {width:.2} {height:.2}\">\n<rect width=\"100%\" height=\"100%\" \
         fill=\"white\"/>\n<g font-family=\"sans-serif\" font-size=\"13\">\n"
    )
}

/// Text that means nothing in SVG.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The data of a path along points, in pixels, without points that change nothing visible.
pub(crate) fn path(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for (k, [x, y]) in thinned(points).into_iter().enumerate() {
        let _ = write!(text, "{}{x:.2} {y:.2}", if k == 0 { "M" } else { "L" });
    }
    text
}

/// The corners of a polygon, in pixels.
pub(crate) fn polygon(points: &[[f64; 2]]) -> String {
    let corners: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
    corners.join(" ")
}

/// A dot.
pub(crate) fn circle(svg: &mut String, [x, y]: [f64; 2], radius: f64, style: &str) {
    let _ = writeln!(svg, "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" {style}/>");
}

/// Entries of a legend, each a mark 26 pixels wide and a name, in as many lines as they need. A mark
/// is given by the text that draws it at the origin, in the middle of its left side. Returns the
/// height.
pub(crate) fn legend(
    svg: &mut String,
    entries: &[(String, String)],
    [left, top]: [f64; 2],
    width: f64,
) -> f64 {
    let (mut x, mut y) = (left, top);
    for (mark, name) in entries {
        let own = 34.0 + LETTER * name.chars().count() as f64 + 16.0;
        if x > left && x + own > left + width {
            (x, y) = (left, y + LINE);
        }
        let indent = if mark.is_empty() { 0.0 } else { 34.0 };
        let _ = writeln!(
            svg,
            "<g transform=\"translate({x:.2} {y:.2})\">{mark}<text x=\"{indent}\" y=\"4.5\">{}\
             </text></g>",
            escaped(name)
        );
        x += own;
    }
    y + LINE - top
}

/// Drops points that are nearer than `LINE_ERROR` to the line through the others (D. H. Douglas and
/// T. K. Peucker, 1973).
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let Some(last) = points.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; points.len()];
    (kept[0], kept[last]) = (true, true);
    let mut waiting = vec![(0, last)];
    while let Some((a, b)) = waiting.pop() {
        let far = (a + 1..b).map(|k| (distance(points[k], points[a], points[b]), k));
        let Some((most, k)) = far.max_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
        if most > LINE_ERROR {
            kept[k] = true;
            waiting.extend([(a, k), (k, b)]);
        }
    }
    points.iter().zip(kept).filter(|(_, kept)| *kept).map(|(point, _)| *point).collect()
}

/// From a point to the line between two others.
fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, own) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = along[0] * along[0] + along[1] * along[1];
    let share = if length > 0.0 {
        ((own[0] * along[0] + own[1] * along[1]) / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (own[0] - share * along[0]).hypot(own[1] - share * along[1])
}
