//! The map as a picture.

use std::error::Error;
use std::path::Path;

use plotters::coord::Shift;
use plotters::prelude::*;

use super::grid::Map;

/// The colours of no saving and of the largest one, and two between them.
const RAMP: [RGBColor; 4] =
    [RGBColor(255, 237, 160), RGBColor(254, 178, 76), RGBColor(227, 60, 40), RGBColor(100, 0, 50)];
const UNPROVED: RGBColor = RGBColor(120, 120, 120);
const TEXT: (&str, u32) = ("sans-serif", 15);

type Drawn = Result<(), Box<dyn Error>>;

/// Writes the picture.
pub(crate) fn draw(map: &Map, path: &Path) -> Drawn {
    let root = SVGBackend::new(path, (860, 640)).into_drawing_area();
    root.fill(&WHITE)?;
    let title = "Time saved by hitting the wall, every cell proved";
    let partly = "Time saved by hitting the wall, grey cells not proved";
    let title = if map.unproved() == 0 { title } else { partly };
    let area = root.titled(title, ("sans-serif", 22))?;
    let (left, right) = area.split_horizontally(720);
    let most = map.cells.iter().map(|cell| cell.saving()).fold(0.0, f64::max).max(1e-9);
    cells(map, most, &left)?;
    legend(most, &right)?;
    root.present()?;
    Ok(())
}

fn cells<DB: DrawingBackend>(map: &Map, most: f64, area: &DrawingArea<DB, Shift>) -> Drawn
where
    DB::ErrorType: 'static,
{
    let (x_edges, y_edges) = (edges(&map.goals), edges(&map.restitutions));
    let (columns, rows) = (map.goals.len(), map.restitutions.len());
    let mut chart = ChartBuilder::on(area)
        .margin(10)
        .x_label_area_size(44)
        .y_label_area_size(58)
        .build_cartesian_2d(x_edges[0]..x_edges[columns], y_edges[0]..y_edges[rows])?;
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc("destination, distance from the wall (m)")
        .y_desc("coefficient of restitution e")
        .label_style(TEXT)
        .draw()?;
    let colour = |k: usize| {
        let cell = &map.cells[k];
        match (cell.is_proved(), cell.hits()) {
            (false, _) => Some(UNPROVED),
            (true, true) => Some(ramp(cell.saving() / most)),
            (true, false) => None,
        }
    };
    for row in 0..rows {
        // Neighbours of the same colour are one rectangle, so that no seam is visible.
        let mut column = 0;
        while column < columns {
            let here = colour(row * columns + column);
            let same = |&next: &usize| colour(row * columns + next) == here;
            let end = column + (column..columns).take_while(same).count();
            if let Some(fill) = here {
                let corners = [(x_edges[column], y_edges[row]), (x_edges[end], y_edges[row + 1])];
                chart.draw_series([Rectangle::new(corners, fill.filled())])?;
            }
            column = end;
        }
    }
    // The border between hit and no hit.
    let hits = |row: usize, column: usize| map.cells[row * columns + column].hits();
    let line = |points: [(f64, f64); 2]| PathElement::new(points, BLACK.stroke_width(2));
    let (mut border, x, y) = (Vec::new(), &x_edges, &y_edges);
    for row in 0..rows {
        for column in 0..columns {
            if column + 1 < columns && hits(row, column) != hits(row, column + 1) {
                border.push(line([(x[column + 1], y[row]), (x[column + 1], y[row + 1])]));
            }
            if row + 1 < rows && hits(row, column) != hits(row + 1, column) {
                border.push(line([(x[column], y[row + 1]), (x[column + 1], y[row + 1])]));
            }
        }
    }
    chart.draw_series(border)?;
    Ok(())
}

/// The colour bar, and what white and grey mean.
fn legend<DB: DrawingBackend>(most: f64, area: &DrawingArea<DB, Shift>) -> Drawn
where
    DB::ErrorType: 'static,
{
    let (width, height) = area.dim_in_pixel();
    let (width, height) = (width as i32, height as i32);
    let bar = area.clone().shrink((0, 0), (width as u32, (height - 90) as u32));
    let mut chart = ChartBuilder::on(&bar)
        .margin_top(10)
        .margin_right(24)
        .y_label_area_size(62)
        .build_cartesian_2d(0.0..1.0, 0.0..most)?;
    const BANDS: usize = 60;
    let band = |k: usize| {
        let at = |k: usize| most * k as f64 / BANDS as f64;
        let fill = ramp((k as f64 + 0.5) / BANDS as f64).filled();
        Rectangle::new([(0.0, at(k)), (1.0, at(k + 1))], fill)
    };
    chart.draw_series((0..BANDS).map(band))?;
    chart
        .configure_mesh()
        .disable_mesh()
        .disable_x_axis()
        .y_desc("time saved (% of the time without collisions)")
        .y_label_formatter(&|value| format!("{value:.0}"))
        .label_style(TEXT)
        .draw()?;
    let top = height - 60;
    let corners = [(18, top), (38, top + 16)];
    area.draw(&Rectangle::new(corners, WHITE.filled()))?;
    area.draw(&Rectangle::new(corners, BLACK.stroke_width(1)))?;
    area.draw(&Text::new("no hit", (46, top + 1), TEXT.into_font()))?;
    Ok(())
}

/// The colour of a share of the largest saving.
fn ramp(share: f64) -> RGBColor {
    let at = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let k = (at as usize).min(RAMP.len() - 2);
    let mix = |a: u8, b: u8| (f64::from(a) + (at - k as f64) * (f64::from(b) - f64::from(a))) as u8;
    let (a, b) = (RAMP[k], RAMP[k + 1]);
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// The edges of cells around evenly spaced centres: one more than there are centres.
fn edges(centres: &[f64]) -> Vec<f64> {
    let (first, last) = (centres[0], centres[centres.len() - 1]);
    let half = 0.5 * (last - first) / (centres.len() - 1) as f64;
    let at = |k: usize| first - half + 2.0 * half * k as f64;
    (0..=centres.len()).map(at).collect()
}
