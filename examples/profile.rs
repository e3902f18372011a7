//! Draws a performance profile: the share of programs that a solver solves within a factor of the
//! best time (E. D. Dolan, J. J. Moré, 2002).
//!
//! `cargo run --release --example profile -- FACTORS.csv PICTURE.svg`
//!
//! FACTORS.csv has a line `solver,factor` for each solver and program after its heading, as
//! `benches/compare.py --profile FACTORS.csv` writes it; the factor of what was not solved is
//! empty.

use carom::interval::Interval;
use carom::picture::{COLOURS, Chart};

const USAGE: &str = "usage: profile FACTORS.csv PICTURE.svg";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [factors, picture] = &arguments[..] else { return Err(USAGE.into()) };
    let text = std::fs::read_to_string(factors).map_err(|error| format!("{factors}: {error}"))?;
    let mut solvers: Vec<(&str, Vec<f64>)> = Vec::new();
    for line in text.lines().skip(1) {
        let wrong = || format!("`{line}` is not `solver,factor`");
        let (name, factor) = line.split_once(',').ok_or_else(wrong)?;
        let factor: f64 = match factor {
            "" => f64::INFINITY,
            factor => factor.parse().map_err(|_| wrong())?,
        };
        match solvers.iter_mut().find(|solver| solver.0 == name) {
            Some((_, factors)) => factors.push(factor),
            None => solvers.push((name, vec![factor])),
        }
    }
    let programs = solvers.iter().map(|(_, factors)| factors.len()).max().unwrap_or(0);
    let known = || solvers.iter().flat_map(|(_, factors)| factors).filter(|f| f.is_finite());
    let most = 1.3 * known().fold(1.0, |most: f64, factor| most.max(*factor));
    let mut chart = Chart::new("factor of the best time", "share of the programs solved (%)")
        .with_size(720.0, 400.0)
        .with_horizontal_logarithm()
        .with_ranges(Interval::new(0.97, most), Interval::new(0.0, 104.0));
    for (k, (name, factors)) in solvers.iter_mut().enumerate() {
        factors.sort_by(f64::total_cmp);
        let (mut points, mut share) = (vec![[1.0, 0.0]], 0.0);
        for (count, &factor) in factors.iter().take_while(|factor| factor.is_finite()).enumerate() {
            points.push([factor, share]);
            share = 100.0 * (count + 1) as f64 / programs as f64;
            points.push([factor, share]);
        }
        points.push([most, share]);
        chart.line(*name, COLOURS[k % COLOURS.len()], points);
    }
    let title = format!(
        "How many programs are solved within a factor of the best time\n{programs} programs that all \
         of these solvers can read; higher and further to the left is better."
    );
    std::fs::write(picture, Chart::to_svg(&[chart], &title))?;
    Ok(())
}
