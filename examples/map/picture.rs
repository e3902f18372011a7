//! The map as a picture.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use carom::interval::Interval;
use carom::picture::{COLOURS, Chart};

use super::grid::Map;

/// The colours of no saving and of the largest one, and two between them.
const RAMP: [[u8; 3]; 4] = [[255, 237, 160], [254, 178, 76], [227, 60, 40], [100, 0, 50]];
const UNPROVED: &str = "#787878";
const MISSING: &str = "#b8cfe8";

/// Number of colours of the colour bar.
const BANDS: usize = 60;

/// Writes the picture.
pub(crate) fn draw(map: &Map, path: &Path) -> Result<(), Box<dyn Error>> {
    let title = "Time saved by hitting the wall, every cell proved";
    let partly = "Time saved by hitting the wall, grey cells not proved";
    let missing = "Time saved by hitting the wall, blue cells missing, grey ones not proved";
    let title = match (map.missing(), map.unproved()) {
        (0, 0) => title,
        (0, _) => partly,
        _ => missing,
    };
    let most = map.cells.iter().map(|cell| cell.saving()).fold(0.0, f64::max).max(1e-9);
    std::fs::write(path, Chart::to_svg(&[cells(map, most), bar(most)], title))?;
    Ok(())
}

fn cells(map: &Map, most: f64) -> Chart {
    let (x, y) = (edges(&map.goals), edges(&map.restitutions));
    let (columns, rows) = (map.goals.len(), map.restitutions.len());
    let mut chart =
        Chart::new("destination, distance from the wall (m)", "coefficient of restitution e")
            .with_size(680.0, 520.0)
            .with_ranges(Interval::new(x[0], x[columns]), Interval::new(y[0], y[rows]));
    let colour = |k: usize| {
        let cell = &map.cells[k];
        match (cell.is_proved(), cell.hits()) {
            (false, _) if cell.is_missing => Some(MISSING.to_owned()),
            (false, _) => Some(UNPROVED.to_owned()),
            (true, true) => Some(ramp(cell.saving() / most)),
            (true, false) => None,
        }
    };
    // Cells of a colour are one shape, and neighbours in a row one rectangle.
    let mut shapes: BTreeMap<String, Vec<[[f64; 2]; 2]>> = BTreeMap::new();
    for row in 0..rows {
        let mut column = 0;
        while column < columns {
            let here = colour(row * columns + column);
            let same = |&next: &usize| colour(row * columns + next) == here;
            let end = column + (column..columns).take_while(same).count();
            if let Some(fill) = here {
                shapes.entry(fill).or_default().push([[x[column], y[row]], [x[end], y[row + 1]]]);
            }
            column = end;
        }
    }
    for (fill, cells) in shapes {
        chart.rectangles(&fill, cells);
    }
    // The border between hit and no hit.
    let hits = |row: usize, column: usize| map.cells[row * columns + column].hits();
    for row in 0..rows {
        for column in 0..columns {
            if column + 1 < columns && hits(row, column) != hits(row, column + 1) {
                chart.line("", "black", [[x[column + 1], y[row]], [x[column + 1], y[row + 1]]]);
            }
            if row + 1 < rows && hits(row, column) != hits(row + 1, column) {
                chart.line("", "black", [[x[column], y[row + 1]], [x[column + 1], y[row + 1]]]);
            }
        }
    }
    let beside = [x[columns] - 0.03 * (x[columns] - x[0]), y[rows] - 0.1 * (y[rows] - y[0])];
    chart.label("hitting the wall does not pay", COLOURS[6], beside);
    chart
}

/// The colour bar.
fn bar(most: f64) -> Chart {
    let mut bar = Chart::new("time saved (% of the time without collisions)", "")
        .with_size(680.0, 16.0)
        .with_ranges(Interval::new(0.0, most), Interval::new(0.0, 1.0));
    let at = |k: usize| most * k as f64 / BANDS as f64;
    for k in 0..BANDS {
        let fill = ramp((k as f64 + 0.5) / BANDS as f64);
        bar.rectangles(&fill, [[[at(k), 0.0], [at(k + 1), 1.0]]]);
    }
    bar
}

/// The colour of a share of the largest saving.
fn ramp(share: f64) -> String {
    let band = (share.clamp(0.0, 1.0) * BANDS as f64).round() / BANDS as f64;
    let at = band * (RAMP.len() - 1) as f64;
    let k = (at as usize).min(RAMP.len() - 2);
    let mix = |i: usize| {
        let [a, b] = [k, k + 1].map(|k| f64::from(RAMP[k][i]));
        (a + (at - k as f64) * (b - a)) as u8
    };
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

/// The edges of cells around evenly spaced centres: one more than there are centres.
fn edges(centres: &[f64]) -> Vec<f64> {
    let (first, last) = (centres[0], centres[centres.len() - 1]);
    let half = 0.5 * (last - first) / (centres.len() - 1) as f64;
    let at = |k: usize| first - half + 2.0 * half * k as f64;
    (0..=centres.len()).map(at).collect()
}
