//! How one program is called, and how its answer is read.

use std::fmt;
use std::path::PathBuf;

use web_time::Duration;

use crate::solution::Termination;
use crate::solver::Options;

/// Where a program finds the model and leaves its answer; all in a folder of its own that is
/// removed afterwards.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Files {
    /// The model, free MPS in the columns of fixed MPS: rows `r0`, `r1`, ..., columns `c0`, `c1`,
    /// ..., a minimisation without a constant.
    pub model: PathBuf,
    /// Where the solution is to be written.
    pub solution: PathBuf,
    /// For a program that reads its settings from a file: this one is written before it starts.
    pub settings: PathBuf,
}

/// What a program claims.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Claim {
    /// The values are optimal within the gap that was asked for.
    Optimal,
    /// There is no feasible point.
    Infeasible,
    /// The objective falls without limit, or there is no feasible point; asked again without the
    /// objective, to know which.
    Unbounded,
    /// It stopped at a limit.
    Limit(Termination),
    /// Anything else.
    Unknown,
}

/// The answer of a program, about the minimisation in its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// The claim.
    pub claim: Claim,
    /// Values by name of column; columns that are not mentioned are 0.
    pub values: Option<Vec<(String, f64)>>,
    /// The objective at the values.
    pub objective: Option<f64>,
    /// The lower bound, where the program says one.
    pub bound: Option<f64>,
    /// Nodes, where the program says so.
    pub nodes: Option<u64>,
}

impl Answer {
    /// An answer without anything but its claim.
    pub fn new(claim: Claim) -> Self {
        Answer { claim, values: None, objective: None, bound: None, nodes: None }
    }
}

/// A program's command line and the texts it answers with. Implement it for programs that are not
/// here; the command line, the settings and the reading of the answer are all there is to it.
pub trait Dialect: fmt::Debug + Send {
    /// The usual name of the program.
    fn program(&self) -> &str;

    /// Whether it takes convex quadratic objectives (`QUADOBJ`) together with integers.
    fn takes_quadratic(&self) -> bool {
        false
    }

    /// The arguments of the command line.
    fn arguments(&self, files: &Files, options: &Options, time: Option<Duration>) -> Vec<String>;

    /// The text of the settings file, for programs that take one.
    fn settings(&self, options: &Options, time: Option<Duration>) -> Option<String> {
        let _ = (options, time);
        None
    }

    /// Reads the answer from the solution file, if one was written, and from what was printed.
    ///
    /// # Errors
    ///
    /// What could not be read, in words.
    fn read(&self, solution: Option<&str>, printed: &str) -> Result<Answer, String>;
}
