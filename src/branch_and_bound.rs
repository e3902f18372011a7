//! The default backend.

use crate::error::Error;
use crate::model::Model;
use crate::solution::Solution;
use crate::solver::{Control, Options, Solver};

/// Branch and bound.
#[derive(Debug, Clone, Default)]
pub struct BranchAndBound {
    options: Options,
}

impl BranchAndBound {
    /// With options.
    pub fn new(options: Options) -> Self {
        BranchAndBound { options }
    }
}

impl Solver for BranchAndBound {
    fn name(&self) -> &str {
        "carom"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    fn solve_with(&mut self, _: &Model, _: &mut Control<'_>) -> Result<Solution, Error> {
        Err(Error::Backend { message: "not built yet".into() })
    }
}
