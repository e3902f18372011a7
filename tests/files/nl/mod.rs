//! NL files: what each segment means, expressions, what is refused and damaged, the binary form,
//! answers, and round trips.

mod binary;
mod damaged;
mod expressions;
mod random;
mod segments;
mod sol;

use carom::model::nl;
use carom::prelude::*;

/// The sizes of a file.
#[derive(Debug, Clone, Copy, Default)]
struct Sizes {
    variables: usize,
    rows: usize,
    objectives: usize,
    /// Nonlinear variables in constraints, objectives, both.
    nonlinear: [usize; 3],
    /// Binaries, integers, nonlinear integers in both, constraints, objectives.
    whole: [usize; 5],
    functions: usize,
    definitions: usize,
    /// Linear terms of constraints and objectives.
    nonzeros: [usize; 2],
}

impl Sizes {
    fn new(variables: usize, rows: usize, objectives: usize) -> Sizes {
        Sizes { variables, rows, objectives, ..Sizes::default() }
    }

    /// The ten lines of the header; `first` is the first one.
    fn header(&self, first: &str) -> String {
        let Sizes { variables: n, rows: m, objectives, functions, definitions, .. } = self;
        let words = |numbers: &[usize]| {
            numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
        };
        let (nonlinear, whole) = (words(&self.nonlinear), words(&self.whole));
        let nonzeros = words(&self.nonzeros);
        format!(
            "{first}\n {n} {m} {objectives} 0 0\t# sizes\n 0 0\n 0 0\n {nonlinear}\n 0 {functions} 1 0\n {whole}\n \
             {nonzeros}\n 0 0\n {definitions} 0 0 0 0\n"
        )
    }

    /// A file as text, whose segments' lines stand between semicolons.
    fn file(&self, segments: &str) -> String {
        let lines: Vec<&str> = segments.split(';').map(str::trim).collect();
        self.header("g3 1 1 0") + &lines.join("\n") + "\n"
    }
}

fn read(text: &str) -> Model {
    let read = nl::read(text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    assert_eq!(read.warnings, [], "{text}");
    read.model
}

fn error(text: &str) -> String {
    match nl::read(text) {
        Ok(read) => panic!("was read:\n{}", read.model),
        Err(error) => error.to_string(),
    }
}

/// The objective and the values of the optimum.
fn optimum(model: &Model) -> (f64, Vec<f64>) {
    let solution = BranchAndBound::default().solve(model).unwrap();
    assert!(solution.is_optimal(), "{solution:?}\n{model}");
    (solution.objective().unwrap(), solution.point().unwrap().as_slice().to_vec())
}
