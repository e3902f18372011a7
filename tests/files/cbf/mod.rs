//! CBF files: what each section means, what damaged files say, cones, and round trips.

mod cones;
mod damaged;
mod random;
mod sections;
mod written;

use carom::model::{Warning, cbf};
use carom::prelude::*;

fn read(text: &str) -> Model {
    let read = cbf::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(read.warnings, [], "{text}");
    read.model
}

fn warned(text: &str) -> (Vec<String>, Model) {
    let read = cbf::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    (read.warnings.iter().map(Warning::to_string).collect(), read.model)
}

fn error(text: &str) -> String {
    match cbf::read(text) {
        Ok(read) => panic!("was read:\n{}", read.model),
        Err(error) => error.to_string(),
    }
}

/// A file of sections that minimises; each line of the sections stands between semicolons.
fn file(sections: &str) -> String {
    let lines: Vec<&str> = sections.split(';').map(str::trim).collect();
    format!("VER\n1\nOBJSENSE\nMIN\n{}\n", lines.join("\n"))
}

/// The optimum of a file; `None` if nothing satisfies it.
fn optimum(text: &str) -> Option<f64> {
    let solution = BranchAndBound::default().solve(&read(text)).unwrap();
    assert!(solution.is_optimal() || solution.is_infeasible(), "{solution:?}\n{text}");
    solution.objective()
}
