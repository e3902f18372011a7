//! How to call a program, and how to read its answer.

use std::fmt;
use std::path::PathBuf;

use web_time::Duration;

use crate::solution::Termination;
use crate::solver::Options;

/// The files that a program reads and writes. They are in a private folder that is removed
/// afterwards.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Files {
    /// The model, free MPS in the columns of fixed MPS: rows `r0`, `r1`, ..., columns `c0`, `c1`,
    /// ..., a minimisation without a constant.
    pub model: PathBuf,
    /// The solution, written by the program.
    pub solution: PathBuf,
    /// The settings, written before the program starts, for programs that read them from a file.
    pub settings: PathBuf,
}

/// The claim of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolverClaim {
    /// The values are optimal within the gap that was asked for.
    Optimal,
    /// There is no feasible point.
    Infeasible,
    /// The program is unbounded or infeasible. The program is run again without the objective to
    /// tell which.
    Unbounded,
    /// It stopped at a limit.
    Limit(Termination),
    /// Anything else.
    Unknown,
}

/// The answer of a program, about the minimisation in its file.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ExternalAnswer {
    /// The claim.
    pub claim: SolverClaim,
    /// Values by column name; columns that are not listed are 0.
    pub values: Option<Vec<(String, f64)>>,
    /// The objective at the values.
    pub objective: Option<f64>,
    /// The lower bound, if the program reports one.
    pub bound: Option<f64>,
    /// Number of nodes, if the program reports it.
    pub nodes: Option<u64>,
}

impl ExternalAnswer {
    /// An answer that consists only of a claim.
    pub fn new(claim: SolverClaim) -> Self {
        ExternalAnswer { claim, values: None, objective: None, bound: None, nodes: None }
    }
}

/// The command line of a program and the format of its answer. Implement this to support another
/// program.
pub trait Dialect: fmt::Debug + Send {
    /// The usual name of the program.
    fn program(&self) -> &str;

    /// Whether it takes convex quadratic objectives (`QUADOBJ`) together with integers.
    fn takes_quadratic(&self) -> bool {
        false
    }

    /// Whether it takes convex quadratic rows and second-order cones (`QCMATRIX`) together with
    /// integers.
    fn takes_cones(&self) -> bool {
        false
    }

    /// The command-line arguments.
    fn arguments(&self, files: &Files, options: &Options, time: Option<Duration>) -> Vec<String>;

    /// The text of the settings file; `None` if the program needs none.
    fn settings(&self, options: &Options, time: Option<Duration>) -> Option<String> {
        let _ = (options, time);
        None
    }

    /// Reads the answer from the solution file, if there is one, and from the output of the
    /// program.
    ///
    /// # Errors
    ///
    /// A description of what could not be read.
    fn read(&self, solution: Option<&str>, printed: &str) -> Result<ExternalAnswer, String>;
}
