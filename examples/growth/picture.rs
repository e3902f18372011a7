//! The picture: seconds over size for each family, and memory over columns.

use carom::picture::{COLOURS, Chart};

use crate::families::FAMILIES;
use crate::figures::Figure;

/// The solvers with their colours.
const SOLVERS: [(&str, &str); 2] = [("carom", COLOURS[0]), ("HiGHS", COLOURS[1])];

/// Draws what was measured. Dots are solves that came to their end; where a line goes on without
/// one, the solve was open at its limit.
pub(crate) fn picture(figures: &[Figure]) -> String {
    let mut charts = Vec::new();
    for family in &FAMILIES {
        let mut chart = Chart::new(family.size, "seconds")
            .with_heading(family.heading)
            .with_size(720.0, 180.0)
            .with_logarithms();
        for (solver, colour) in SOLVERS {
            let own = |figure: &&Figure| figure.family == family.name && figure.solver == solver;
            let place = |figure: &Figure| [figure.size as f64, figure.seconds.max(1e-4)];
            draw(&mut chart, figures.iter().filter(own), (solver, colour), place);
        }
        charts.push(chart);
    }
    let mut chart = Chart::new("columns of the program", "megabytes of the process")
        .with_heading("Memory of carom")
        .with_size(720.0, 180.0)
        .with_logarithms();
    for (family, colour) in FAMILIES.iter().zip(COLOURS) {
        let own = |figure: &&Figure| figure.family == family.name && figure.solver == "carom";
        let own = figures.iter().filter(own).filter(|figure| figure.megabytes.is_some());
        let place = |figure: &Figure| [figure.columns as f64, figure.megabytes.unwrap_or(f64::NAN)];
        draw(&mut chart, own, (family.name, colour), place);
    }
    charts.push(chart);
    let title = "How solves grow with their programs\none thread, a gap of 1e-6; a line that ends without a dot was open at its limit of time";
    Chart::to_svg(&charts, title)
}

/// Draws a line through figures, with dots at those that were solved.
fn draw<'f>(
    chart: &mut Chart,
    figures: impl Iterator<Item = &'f Figure>,
    (name, colour): (&str, &str),
    place: impl Fn(&Figure) -> [f64; 2],
) {
    let figures: Vec<&Figure> = figures.collect();
    if figures.is_empty() {
        return;
    }
    chart.line(name, colour, figures.iter().map(|figure| place(figure)));
    let solved = figures.iter().filter(|figure| figure.is_solved());
    chart.dots("", colour, 3.0, solved.map(|figure| place(figure)));
}
