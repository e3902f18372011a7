//! A map of when hitting the wall pays: the shortest horizons with and without collisions, with
//! proofs, for every pair of a destination and a restitution. The other data are the paper's.
//!
//! `cargo run --release --example map [-- --csv] [--out FOLDER] [--size N] [--time-step S]
//! [--file FILE] [--shard I/N]`
//!
//! * `--csv`: print the rows of a CSV file on standard output and nothing else
//! * `--out FOLDER`: where the picture `map.svg` goes, `plots` by default
//! * `--size N`: N destinations times N restitutions, 50 by default
//! * `--time-step S`: length of a step in s, 0.01 by default
//! * `--file FILE`: append each cell to this file of JSON lines, and go on where it ends
//! * `--shard I/N`: search only the I-th of N shares of the cells; join the files to draw the whole
//!   map
//!
//! Ctrl-C ends the searches; the picture and the rows then have the cells that are proved, and the
//! exit status is 3. A second Ctrl-C ends the program. With a file, the next run searches what is
//! missing.

#[path = "../../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

mod grid;
mod picture;

use std::error::Error;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use carom::prelude::Interrupt;
use grid::Map;
use interrupts::{INTERRUPTED, Signals};

const USAGE: &str = "usage: map [--csv] [--out FOLDER] [--size N] [--time-step S] [--file FILE] \
                     [--shard I/N]";

/// The allowed sizes of a map: smaller ones show nothing, larger ones take hours.
const SIZES: std::ops::RangeInclusive<usize> = 2..=500;

fn main() -> ExitCode {
    match run() {
        Ok(status) => status,
        Err(error) => {
            eprintln!("map: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<ExitCode, Box<dyn Error>> {
    let (mut csv, mut folder) = (false, PathBuf::from("plots"));
    let (mut size, mut time_step) = (50, 0.01);
    let (mut file, mut shard) = (None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value\n{USAGE}"));
        match word.as_str() {
            "--csv" => csv = true,
            "--out" => folder = value()?.into(),
            "--size" => size = number(&word, &value()?)?,
            "--time-step" => time_step = number(&word, &value()?)?,
            "--file" => file = Some(PathBuf::from(value()?)),
            "--shard" => shard = Some(value()?),
            _ => return Err(format!("unexpected `{word}`\n{USAGE}").into()),
        }
    }
    if !SIZES.contains(&size) {
        return Err(format!("--size is from {} to {}", SIZES.start(), SIZES.end()).into());
    }
    // Problems with the folder show before the work, not after it.
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;

    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let start = Instant::now();
    let map = Map::solve((size, time_step), (file, shard.as_deref()), &interrupt)?;
    let seconds = start.elapsed().as_secs_f64();
    let path = folder.join("map.svg");
    picture::draw(&map, &path).map_err(|error| format!("{}: {error}", path.display()))?;
    let text = if csv {
        rows(&map)
    } else {
        format!("{}wrote {}\n", summary(&map, seconds), path.display())
    };
    std::io::stdout().write_all(text.as_bytes())?;
    Ok(if signals.came() { INTERRUPTED.into() } else { ExitCode::SUCCESS })
}

fn number<T: FromStr>(option: &str, text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{option} cannot be `{text}`"))
}

/// The CSV file: one row per cell; unknown numbers are empty.
fn rows(map: &Map) -> String {
    let mut text = String::from("goal,restitution,steps_free,steps_tolerant,hit\n");
    let number = |steps: Option<usize>| steps.map_or(String::new(), |steps| steps.to_string());
    for cell in &map.cells {
        let (free, tolerant) = (number(cell.free), number(cell.tolerant));
        let hit = cell.hits();
        text += &format!("{},{},{free},{tolerant},{hit}\n", cell.goal, cell.restitution);
    }
    text
}

/// One paragraph.
fn summary(map: &Map, seconds: f64) -> String {
    let hit = map.cells.iter().filter(|cell| cell.hits()).count();
    let all = map.cells.len();
    let mut text = format!(
        "Destinations from {} to {} m, restitutions from 0 to 1, steps of {} s: hitting the wall \
         pays in {hit} of {all} cells ({:.1} %).\n",
        map.goals[0],
        map.goals[map.goals.len() - 1],
        map.time_step,
        100.0 * hit as f64 / all as f64,
    );
    let best = map.cells.iter().filter(|cell| cell.hits());
    if let Some(best) = best.max_by(|a, b| a.saving().total_cmp(&b.saving())) {
        let steps = |steps: Option<usize>| steps.unwrap_or(0);
        text += &format!(
            "It saves most at {:.3} m and e = {:.3}: {} steps instead of {}, {:.1} % of the time \
             without collisions.\n",
            best.goal,
            best.restitution,
            steps(best.tolerant),
            steps(best.free),
            best.saving(),
        );
    }
    text += &match (map.missing(), map.unproved()) {
        (0, 0) => "Every cell is proved".into(),
        (0, unproved) => format!("{unproved} of {all} cells are NOT proved"),
        _ => format!("{}", map.results),
    };
    if map.results.half_lines() > 0 {
        text += &format!("; {} half lines were written again", map.results.half_lines());
    }
    let effort = &map.effort;
    text += &format!(
        "; reach sets alone refuted {} of {} horizons. {} searches took {seconds:.1} s, {:.1} ms \
         each and {:.1} ms at most.\n",
        effort.by_sets,
        effort.refuted,
        effort.searches,
        1e3 * effort.seconds / effort.searches.max(1) as f64,
        1e3 * effort.longest,
    );
    text
}
