//! A map of when hitting the wall pays: the shortest horizons with and without collisions, with
//! proofs, for every pair of a destination and a restitution. The other data are the paper's.
//!
//! `cargo run --release --example map [-- OPTIONS]`; `--help` lists the options.

#[macro_use]
#[path = "../../crates/carom-cli/src/output.rs"]
mod output;
#[path = "../../crates/carom-cli/src/interrupts.rs"]
mod interrupts;

mod grid;
mod picture;

use std::error::Error;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Instant;

use carom::prelude::Interrupt;
use grid::Map;
use interrupts::{INTERRUPTED, Signals};

const USAGE: &str = "usage: map [--csv] [--out FOLDER] [--size N] [--time-step S] [--file FILE] [--shard I/N]; \
                     `map --help` lists the options";

const HELP: &str = "\
A map of when hitting the wall pays: the shortest horizons with and without collisions, with proofs,
for every pair of a destination and a restitution. The other data are the paper's.

usage: map [--csv] [--out FOLDER] [--size N] [--time-step S] [--file FILE] [--shard I/N]

  --csv            print the rows of a CSV file on standard output and nothing else
  --out FOLDER     where the picture `map.svg` goes; `plots` by default, and no picture by default
                   with --shard
  --size N         N destinations times N restitutions, from 2 to 500, 50 by default
  --time-step S    length of a step in s, 0.01 by default
  --file FILE      append each cell to this file of JSON lines, and go on where it ends
  --shard I/N      search only the I-th of N shares of the cells; join the files to draw the whole map
  --help           print this

Ctrl-C ends the searches; the picture and the rows then have the cells that are proved. With a file,
the next run searches what is missing. A second Ctrl-C ends the program at once.

exit status: 0 if all searches came to their end, 1 after an error, 2 if the arguments are wrong, 3 if
Ctrl-C ended them";

/// The allowed sizes of a map: smaller ones show nothing, larger ones take hours.
const SIZES: std::ops::RangeInclusive<usize> = 2..=500;

/// The exit status for wrong arguments.
const WRONG_ARGUMENTS: u8 = 2;

/// What is asked for.
struct Arguments {
    csv: bool,
    folder: Option<PathBuf>,
    size: usize,
    time_step: f64,
    file: Option<PathBuf>,
    shard: Option<String>,
}

fn main() -> ExitCode {
    let arguments = match arguments() {
        Ok(Some(arguments)) => arguments,
        Ok(None) => {
            println!("{HELP}");
            return ExitCode::SUCCESS;
        }
        Err(error) => {
            eprintln!("map: {error}\n{USAGE}");
            return WRONG_ARGUMENTS.into();
        }
    };
    match run(arguments) {
        Ok(status) => status,
        Err(error) => {
            eprintln!("map: {error}");
            ExitCode::FAILURE
        }
    }
}

/// Reads the arguments; `None` if help is asked for.
fn arguments() -> Result<Option<Arguments>, String> {
    let (mut csv, mut folder, mut size, mut time_step) = (false, None, 50, 0.01);
    let (mut file, mut shard) = (None, None);
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut value = || words.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--help" | "-h" => return Ok(None),
            "--csv" => csv = true,
            "--out" => folder = Some(PathBuf::from(value()?)),
            "--size" => size = number(&word, &value()?)?,
            "--time-step" => time_step = number(&word, &value()?)?,
            "--file" => file = Some(PathBuf::from(value()?)),
            "--shard" => shard = Some(value()?),
            _ => return Err(format!("unexpected `{word}`")),
        }
    }
    if !SIZES.contains(&size) {
        return Err(format!("--size is from {} to {}", SIZES.start(), SIZES.end()));
    }
    // A part of a map is no picture.
    if folder.is_none() && shard.is_none() {
        folder = Some("plots".into());
    }
    Ok(Some(Arguments { csv, folder, size, time_step, file, shard }))
}

fn run(arguments: Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let Arguments { csv, folder, size, time_step, file, shard } = arguments;
    // Problems with the folder show before the work, not after it.
    if let Some(folder) = &folder {
        std::fs::create_dir_all(folder)
            .map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    let interrupt = Interrupt::new();
    let signals = Signals::catch(&interrupt)?;
    let start = Instant::now();
    let map = Map::solve((size, time_step), (file, shard.as_deref()), &interrupt)?;
    let seconds = start.elapsed().as_secs_f64();
    let path = folder.map(|folder| folder.join("map.svg"));
    let drawn = path.as_ref().map_or(Ok(()), |path| {
        picture::draw(&map, path).map_err(|error| format!("{}: {error}", path.display()))
    });
    // What is proved is told before what has failed.
    if csv {
        print!("{}", rows(&map));
    } else {
        if signals.came() {
            print!("interrupted: ");
        }
        print!("{}", summary(&map, seconds));
        if let (Some(path), Ok(())) = (&path, &drawn) {
            println!("wrote {}", path.display());
        }
    }
    drawn?;
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
    let known = all - map.missing();
    let mut text = match map.missing() {
        0 => String::new(),
        _ => format!("{}.\n", map.results),
    };
    text += &format!(
        "Destinations from {} to {} m, restitutions from 0 to 1, steps of {} s: hitting the wall \
         pays in {hit} of {known} cells ({:.1} %).\n",
        map.goals[0],
        map.goals[map.goals.len() - 1],
        map.time_step,
        100.0 * hit as f64 / known.max(1) as f64,
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
    text += &match map.unproved() - map.missing() {
        0 => {
            if known == all {
                "Every cell is proved".into()
            } else {
                "Every known cell is proved".into()
            }
        }
        unproved => format!("{unproved} of {known} cells are NOT proved"),
    };
    if map.results.half_lines() > 0 {
        let half = map.results.half_lines();
        let lines = if half == 1 { "line was" } else { "lines were" };
        text += &format!("; {half} half {lines} written again");
    }
    let effort = &map.effort;
    text += &format!(
        "; reach sets alone refuted {} of {} horizons. {} took {seconds:.1} s, {:.1} ms \
         each and {:.1} ms at most.\n",
        effort.by_sets,
        effort.refuted,
        if effort.searches == 1 {
            "1 search".into()
        } else {
            format!("{} searches", effort.searches)
        },
        1e3 * effort.seconds / effort.searches.max(1) as f64,
        1e3 * effort.longest,
    );
    text
}
