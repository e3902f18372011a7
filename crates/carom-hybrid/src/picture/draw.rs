//! Draws charts, one below the other.

use std::fmt::Write;

use super::chart::{Chart, ChartLabel, Series, SeriesKind};
use super::frame::Frame;
use super::labels::{Label, LabelPlace, Room};
use super::marks::{LETTER, LINE, arrow, circle, escaped, legend, path, polygon, px, ring};
use super::motion::{CLOCK, Stopwatch};
use super::theme::{MUTED, finish, paint};

/// The room around a frame: left, right, above and below, in pixels.
const LEFT: f64 = 66.0;
const RIGHT: f64 = 20.0;
const ABOVE: f64 = 14.0;
const BELOW: f64 = 46.0;

/// The size of letters of the title, and the width of one, in pixels.
const TITLE: [f64; 2] = [16.0, 9.0];

/// The number of places along a curve at which its name may be.
const PLACES: usize = 48;

/// The picture of charts, with a title, a text for those who do not see it, and a clock.
pub(crate) fn to_svg(
    charts: &[Chart],
    title: &str,
    about: &str,
    clock: Option<Stopwatch>,
) -> String {
    let frames: Vec<Frame> = charts.iter().map(Chart::frame).collect();
    let lines: Vec<&str> = title.lines().filter(|line| !line.is_empty()).collect();
    let clocked = if clock.is_some() { CLOCK[0] } else { 0.0 };
    let long = lines.iter().enumerate().map(|(k, line)| {
        let (letter, beside) = if k == 0 { (TITLE[1], clocked) } else { (0.9 * LETTER, 0.0) };
        letter * line.chars().count() as f64 + beside
    });
    let long = long.fold(0.0, f64::max);
    let wide = frames.iter().map(|frame| frame.size[0]).fold(long, f64::max);
    let mut body = String::new();
    let mut top = 6.0;
    for (k, line) in lines.iter().enumerate() {
        top += if k == 0 { 20.0 } else { LINE };
        let style = match k {
            0 => format!("font-size=\"{}\" font-weight=\"600\"", TITLE[0]),
            _ => paint(MUTED),
        };
        let _ =
            writeln!(body, "<text x=\"{LEFT}\" y=\"{}\" {style}>{}</text>", px(top), escaped(line));
    }
    if let Some(clock) = clock {
        clock.draw(&mut body, [LEFT + wide, 8.0]);
    }
    let (mut placed, mut rooms, mut texts) = (Vec::new(), Vec::new(), String::new());
    for (number, (chart, frame)) in charts.iter().zip(frames).enumerate() {
        if !chart.heading.is_empty() {
            top += ABOVE + LINE;
            let (y, text) = (px(top + 4.0), escaped(&chart.heading));
            let _ =
                writeln!(body, "<text x=\"{LEFT}\" y=\"{y}\" font-weight=\"600\">{text}</text>");
        }
        let frame = Frame { corner: [LEFT, top + ABOVE], ..frame };
        top += ABOVE + frame.size[1] + if chart.labels[0].is_empty() { 0.0 } else { BELOW };
        rooms.push(chart.draw(&mut body, &mut texts, &frame, number));
        placed.push(frame);
    }
    let entries = name(charts, &placed, &mut rooms, &mut texts);
    body.push_str(&texts);
    if !entries.is_empty() {
        top += legend(&mut body, &entries, [LEFT, top + ABOVE], wide);
    }
    let about = if about.is_empty() { described(charts) } else { about.to_owned() };
    finish([LEFT + wide + RIGHT, top + ABOVE], title, &about, &body)
}

/// The order in which marks are drawn, later ones over earlier ones.
fn described(charts: &[Chart]) -> String {
    let mut parts = Vec::new();
    for chart in charts {
        let [x, y] = &chart.labels;
        let mut names: Vec<&str> = Vec::new();
        let own = chart.series.iter().map(|series| &series.name);
        for name in own.chain(chart.notes.iter().map(|note| &note.text)) {
            if !name.is_empty() && !names.contains(&name.as_str()) && names.len() < 12 {
                names.push(name);
            }
        }
        let axes = [x, y].into_iter().filter(|label| !label.is_empty());
        let axes: Vec<&str> = axes.map(String::as_str).rev().collect();
        let names =
            if names.is_empty() { String::new() } else { format!(": {}", names.join(", ")) };
        let heading = match chart.heading.is_empty() {
            true => String::new(),
            false => format!("{}. ", chart.heading),
        };
        parts.push(format!("{heading}{}{names}.", axes.join(" over ")));
    }
    parts.join(" ")
}

/// Names curves where there is room; the others are entries of the legend.
fn name(
    charts: &[Chart],
    frames: &[Frame],
    rooms: &mut [Room],
    svg: &mut String,
) -> Vec<(String, String, String)> {
    let mut entries: Vec<(String, String, String)> = Vec::new();
    let mut known: Vec<&str> = Vec::new();
    for Series { name, colour, kind, .. } in charts.iter().flat_map(|chart| &chart.series) {
        if name.is_empty() || known.contains(&name.as_str()) {
            continue;
        }
        known.push(name);
        // Where it is most alone.
        let mut best: Option<(LabelPlace, usize, Label<'_>)> = None;
        for (number, (chart, frame)) in charts.iter().zip(frames).enumerate() {
            for (own, series) in chart.series.iter().enumerate() {
                let is_opaque = matches!(series.kind, SeriesKind::Area(opacity) if opacity > 0.9);
                if series.name != *name || is_opaque {
                    continue;
                }
                let anchors = series.anchors(frame);
                let label = Label { text: name, colour, anchors, is_needed: false, own: Some(own) };
                let place = rooms[number].find(&label);
                let place = place.filter(|p| best.as_ref().is_none_or(|b| p.cost < b.0.cost));
                best = place.map(|place| (place, number, label)).or(best);
            }
        }
        if let Some((place, number, label)) = &best {
            rooms[*number].write(svg, label, place);
        } else {
            entries.push((kind.mark(), colour.clone(), name.clone()));
        }
    }
    entries
}

impl SeriesKind {
    /// The mark in the legend.
    fn mark(self) -> String {
        match self {
            SeriesKind::Dots(radius) => {
                format!("<circle cx=\"13\" r=\"{radius}\" fill=\"currentColor\"/>")
            }
            SeriesKind::Area(opacity) | SeriesKind::Discs(_, opacity) => format!(
                "<rect y=\"-6\" width=\"26\" height=\"12\" fill=\"currentColor\" \
                 fill-opacity=\"{opacity}\" stroke=\"currentColor\"/>"
            ),
            _ => "<path d=\"M0 0h26\" stroke=\"currentColor\" stroke-width=\"2\"/>".to_owned(),
        }
    }
}

impl Series {
    /// Places at which the name may be.
    fn anchors(&self, frame: &Frame) -> Vec<[f64; 2]> {
        let points: Vec<[f64; 2]> = self.points.iter().map(|p| frame.pixel(*p)).collect();
        let line = matches!(self.kind, SeriesKind::Line(_) | SeriesKind::Area(_));
        if !line || points.len() < 2 {
            return points.into_iter().filter(|p| frame.holds(*p)).take(PLACES).collect();
        }
        let lengths = points.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1]));
        let lengths: Vec<f64> = lengths.collect();
        let step = lengths.iter().sum::<f64>() / PLACES as f64;
        let (mut anchors, mut left) = (Vec::new(), 0.0);
        for (ends, length) in points.windows(2).zip(lengths) {
            while step > 0.0 && left <= length && anchors.len() <= 2 * PLACES {
                let share = if length > 0.0 { left / length } else { 0.0 };
                anchors.push([0, 1].map(|i| ends[0][i] + share * (ends[1][i] - ends[0][i])));
                left += step;
            }
            left -= length;
        }
        anchors.extend(points.last());
        anchors.retain(|at| frame.holds(*at));
        anchors
    }
}

impl Chart {
    /// The visible part of the plane, at the origin.
    fn frame(&self) -> Frame {
        let range = |axis: usize| {
            if let Some(range) = self.ranges[axis].filter(|range| range.lower < range.upper) {
                return (range.lower, range.upper);
            }
            let reach = |s: &Series| if let SeriesKind::Discs(r, _) = s.kind { r } else { 0.0 };
            let values = self.series.iter().flat_map(|s| {
                s.points.iter().flat_map(move |p| [p[axis] - reach(s), p[axis] + reach(s)])
            });
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            values.for_each(|value| (low, high) = (low.min(value), high.max(value)));
            if low > high {
                return (1.0, 2.0);
            }
            if self.is_logarithmic[axis] {
                return (0.8 * low.max(1e-12), 1.25 * high.max(1e-12));
            }
            let room = (0.05 * (high - low)).max(1e-9 * (1.0 + low.abs()));
            // Time begins at the frame.
            let first = axis == 0 && !self.is_equal;
            (if first { low } else { low - room }, high + if first { 0.3 } else { 1.0 } * room)
        };
        let ((x, u), (y, v)) = (range(0), range(1));
        let scale = (self.size[0] / (u - x)).min(self.size[1] / (v - y));
        let size = if self.is_equal { [scale * (u - x), scale * (v - y)] } else { self.size };
        let is_logarithmic = self.is_logarithmic;
        Frame { low: [x, y], high: [u, v], corner: [0.0; 2], size, is_logarithmic }
    }

    /// Draws everything, and labels into a text of their own. Returns the room that is left.
    fn draw(&self, svg: &mut String, texts: &mut String, frame: &Frame, number: usize) -> Room {
        let ([x, y], [width, height]) = (frame.corner, frame.size);
        let labels = self.labels.each_ref().map(String::as_str);
        let _ = writeln!(
            svg,
            "<clipPath id=\"frame{number}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/>\
             </clipPath>",
            px(x),
            px(y),
            px(width),
            px(height)
        );
        frame.grid(svg, labels);
        let mut room = Room::new(frame.corner, frame.size);
        // Areas are below lines, lines below marks, which may reach out of the frame.
        let rank = |series: &Series| match series.kind {
            SeriesKind::Area(_) | SeriesKind::Discs(..) | SeriesKind::Rectangles => 0,
            SeriesKind::Line(_) => 1,
            _ => 2,
        };
        let _ = writeln!(svg, "<g clip-path=\"url(#frame{number})\">");
        for wanted in 0..3 {
            if wanted == 2 {
                svg.push_str("</g>\n");
            }
            let own = self.series.iter().enumerate();
            for (own, series) in own.filter(|(_, series)| rank(series) == wanted) {
                series.draw(svg, frame, &mut room, own);
            }
        }
        if !self.movers.is_empty() {
            let _ = writeln!(svg, "<g clip-path=\"url(#frame{number})\">");
            self.movers.iter().for_each(|mover| mover.draw(svg, frame));
            svg.push_str("</g>\n");
        }
        frame.axes(svg, labels);
        // What must be written has the first choice.
        let (needed, others): (Vec<&ChartLabel>, Vec<&ChartLabel>) =
            self.notes.iter().partition(|note| note.is_needed);
        for note in needed.into_iter().chain(others) {
            let (text, colour, is_needed) = (&note.text, &note.colour, note.is_needed);
            let anchors = vec![frame.pixel(note.at)];
            let label = Label { text, colour, anchors, is_needed, own: None };
            if let Some(place) = room.find(&label) {
                room.write(texts, &label, &place);
            }
        }
        room
    }
}

impl Series {
    fn draw(&self, svg: &mut String, frame: &Frame, room: &mut Room, own: usize) {
        let points: Vec<[f64; 2]> = self.points.iter().map(|p| frame.pixel(*p)).collect();
        let Some(first) = points.first().copied() else { return };
        let paint = paint(&self.colour);
        let outlined = |opacity: f64| match opacity < 1.0 {
            true => format!("fill-opacity=\"{opacity}\" stroke=\"currentColor\""),
            // Neighbours show no seam.
            false => "shape-rendering=\"crispEdges\"".to_owned(),
        };
        if !matches!(self.kind, SeriesKind::Area(_) | SeriesKind::Line(_)) {
            let _ = write!(svg, "<g {paint}>");
        }
        match self.kind {
            SeriesKind::Area(opacity) => {
                let _ = writeln!(
                    svg,
                    "<polygon {paint} points=\"{}\" fill=\"currentColor\" {}/>",
                    polygon(&points),
                    outlined(opacity)
                );
                if opacity < 1.0 {
                    room.draw(own, &[points.clone(), vec![first]].concat());
                }
                return;
            }
            SeriesKind::Line(width) => {
                let _ = writeln!(
                    svg,
                    "<path {paint} d=\"{}\" fill=\"none\" stroke=\"currentColor\" \
                     stroke-width=\"{width}\" stroke-linejoin=\"round\"/>",
                    path(&points)
                );
                room.draw(own, &points);
                return;
            }
            SeriesKind::Discs(radius, opacity) => {
                let [rx, ry] = [0, 1].map(|axis| radius * frame.scale(axis));
                for [x, y] in points {
                    let [cx, cy, a, b] = [x, y, rx, ry].map(px);
                    let style = outlined(opacity);
                    let _ = writeln!(
                        svg,
                        "<ellipse cx=\"{cx}\" cy=\"{cy}\" rx=\"{a}\" ry=\"{b}\" \
                         fill=\"currentColor\" {style}/>"
                    );
                    let turn = (0..=24).map(|k| f64::from(k) * std::f64::consts::TAU / 24.0);
                    let rim: Vec<[f64; 2]> =
                        turn.map(|a| [x + rx * a.cos(), y + ry * a.sin()]).collect();
                    room.draw(own, &rim);
                }
            }
            SeriesKind::Rectangles => {
                let mut outline = String::new();
                for corners in points.chunks_exact(2) {
                    let [x, y] = corners[0].map(px);
                    let [w, h] = [0, 1].map(|i| px(corners[1][i] - corners[0][i]));
                    let _ = write!(outline, "M{x} {y}h{w}v{h}H{x}z");
                }
                let style = outlined(1.0);
                let _ = writeln!(svg, "<path d=\"{outline}\" fill=\"currentColor\" {style}/>");
            }
            SeriesKind::Dots(radius) => {
                for point in points.into_iter().filter(|point| frame.holds(*point)) {
                    circle(svg, point, radius, "fill=\"currentColor\"");
                    room.draw(own, &[point]);
                }
            }
            SeriesKind::Arrow => {
                let last = points.last().copied().unwrap_or(first);
                arrow(svg, first, last);
                room.draw(own, &points);
            }
            SeriesKind::Start | SeriesKind::Goal => {
                ring(svg, first, self.kind == SeriesKind::Goal);
                room.draw(own, &[first]);
            }
        }
        svg.push_str("</g>\n");
    }
}
