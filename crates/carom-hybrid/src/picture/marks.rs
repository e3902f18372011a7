//! The marks of a picture, in pixels: paths, polygons, dots, arrows, legends. Coordinates are exact
//! to a hundredth of a pixel, and all marks are in the current colour.

use std::fmt::Write;

use super::theme::paint;

/// How far a line may be from the points that it stands for, in pixels.
const LINE_ERROR: f64 = 0.04;

/// The height of a line of text, and about the width of a letter, in pixels.
pub(super) const LINE: f64 = 18.0;
pub(super) const LETTER: f64 = 7.2;

/// The head of an arrow: its length and half its width, in pixels.
const HEAD: [f64; 2] = [9.0, 3.5];

/// Text that means nothing in SVG.
pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// A coordinate, to a hundredth of a pixel.
pub(super) fn px(value: f64) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The data of a path along points, without those that change nothing visible.
pub(super) fn path(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    for (k, [x, y]) in thinned(points).into_iter().enumerate() {
        // Writing into a string cannot fail, here and below.
        let _ = write!(text, "{}{} {}", if k == 0 { "M" } else { "L" }, px(x), px(y));
    }
    text
}

/// The corners of a polygon, without those that change nothing visible.
pub(super) fn polygon(points: &[[f64; 2]]) -> String {
    let closed: Vec<[f64; 2]> = points.iter().chain(points.first()).copied().collect();
    let mut points = thinned(&closed);
    points.pop();
    let corners: Vec<String> =
        points.iter().map(|[x, y]| format!("{},{}", px(*x), px(*y))).collect();
    corners.join(" ")
}

/// A dot.
pub(super) fn circle(svg: &mut String, [x, y]: [f64; 2], radius: f64, style: &str) {
    let _ = writeln!(svg, "<circle cx=\"{}\" cy=\"{}\" r=\"{radius}\" {style}/>", px(x), px(y));
}

/// Where something begins: a ring. And where it should end: a ring around a dot.
pub(super) fn ring(svg: &mut String, at: [f64; 2], is_goal: bool) {
    let style = "class=\"paper\" fill=\"#fff\" stroke=\"currentColor\" stroke-width=\"2\"";
    circle(svg, at, if is_goal { 7.0 } else { 5.0 }, style);
    if is_goal {
        circle(svg, at, 3.0, "fill=\"currentColor\"");
    }
}

/// An arrow.
pub(super) fn arrow(svg: &mut String, [x, y]: [f64; 2], [tx, ty]: [f64; 2]) {
    let length = (tx - x).hypot(ty - y);
    if length < 1e-9 {
        return;
    }
    let (dx, dy) = ((tx - x) / length, (ty - y) / length);
    let [long, half] = HEAD.map(|size| size.min(size * length / 12.0));
    let corner = |side: f64| [tx - long * dx - side * dy, ty - long * dy + side * dx];
    let head = polygon(&[[tx, ty], corner(half), corner(-half)]);
    let shaft = path(&[[x, y], [tx - 0.7 * long * dx, ty - 0.7 * long * dy]]);
    let _ = writeln!(
        svg,
        "<path d=\"{shaft}\" stroke=\"currentColor\" stroke-width=\"1.8\"/><polygon \
         points=\"{head}\" fill=\"currentColor\"/>"
    );
}

/// Entries of a legend, each a mark 26 pixels wide, a colour and a name, in as many lines as they
/// need. A mark is given by the text that draws it at the origin, in the middle of its left side.
/// Returns the height.
pub(super) fn legend(
    svg: &mut String,
    entries: &[(String, String, String)],
    [left, top]: [f64; 2],
    width: f64,
) -> f64 {
    let (mut x, mut y) = (left, top);
    for (mark, colour, name) in entries {
        let own = 34.0 + LETTER * name.chars().count() as f64 + 16.0;
        if x > left && x + own > left + width {
            (x, y) = (left, y + LINE);
        }
        let _ = writeln!(
            svg,
            "<g transform=\"translate({} {})\"><g {}>{mark}</g><text x=\"34\" y=\"4.5\">{}</text></g>",
            px(x),
            px(y),
            paint(colour),
            escaped(name)
        );
        x += own;
    }
    y + LINE - top
}

/// Drops points that are nearer than `LINE_ERROR` to the line through the others.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let far = |k: usize, a: usize, b: usize| distance(points[k], points[a], points[b]);
    kept(points.len(), LINE_ERROR, far).into_iter().map(|k| points[k]).collect()
}

/// The numbers of the points between which no other is further away than allowed (D. H. Douglas and
/// T. K. Peucker, 1973). `far` is how far one is from what is drawn between two others.
pub(super) fn kept(
    count: usize,
    allowed: f64,
    far: impl Fn(usize, usize, usize) -> f64,
) -> Vec<usize> {
    let Some(last) = count.checked_sub(1) else { return Vec::new() };
    let mut kept = vec![false; count];
    (kept[0], kept[last]) = (true, true);
    let mut waiting = vec![(0, last)];
    while let Some((a, b)) = waiting.pop() {
        let distances = (a + 1..b).map(|k| (far(k, a, b), k));
        let Some((most, k)) = distances.max_by(|x, y| x.0.total_cmp(&y.0)) else { continue };
        if most > allowed {
            kept[k] = true;
            waiting.extend([(a, k), (k, b)]);
        }
    }
    (0..count).filter(|k| kept[*k]).collect()
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
