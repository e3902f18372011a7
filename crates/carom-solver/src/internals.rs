//! Parts that tests and the other crates of the workspace use beside the public interface. They may
//! change in any release.

pub mod branch_and_bound {
    use crate::error::Error;
    use crate::model::Model;
    use crate::program::Program;
    use crate::search::{SearchResult, SolveTask};

    /// A model that has only rows, with an objective that is convex.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex) if there is none.
    pub fn convex_model(model: &Model) -> Result<Model, Error> {
        crate::branch_and_bound::convex_model(model)
    }

    /// A program with other squares of binaries, which has the same objective where these are
    /// whole; `None` if there is nothing to change.
    pub fn with_raised_squares(program: &Program) -> Option<Program> {
        crate::branch_and_bound::with_raised_squares(program)
    }

    /// Tightens, cuts and searches the program of a task.
    pub fn search_tightened(task: SolveTask<'_>) -> SearchResult {
        crate::branch_and_bound::search_tightened(task)
    }
}

pub mod presolve {
    pub use crate::presolve::{
        Compressed, Domain, ImplicationGraph, Propagator, Reduced, Worklist, probe,
        probe_implications, project, reduce, tighten_big_ms, tighten_by_disjunctions,
        tighten_coefficients, tighten_conditional_cones, tighten_switched_cones,
    };

    pub mod root {
        pub use crate::presolve::root::{
            Presolve, PresolveRule, Presolved, ProgramBlock, blocks, presolve,
        };
    }
}

pub mod program {
    pub use crate::program::{Cone, ConeRole, ConeShape, Program};
}

pub mod relaxation {
    pub use crate::relaxation::{
        ActiveSet, CascadePool, ClarabelRelaxation, DualSimplex, Effort, Extended, InteriorPoint,
        MethodCascade, Prover, Record, Relaxation, RelaxationClaim, RelaxationResult, WarmState,
        loosened, polish,
    };
}

pub mod proof {
    pub use crate::branch_and_bound::proof::write_proof_of;
}

pub mod search {
    pub use crate::search::{
        Contradiction, PointJudge, SearchResult, SolveTask, Start, StartPoint, search,
        search_unstrengthened,
    };

    pub mod best_points {
        pub use crate::search::{Accepted, BestPoints};
    }

    pub mod branching {
        pub use crate::search::{FixingCredit, growth_rate};
    }

    pub mod cuts {
        pub use crate::search::cuts::{
            Cut, CutSide, MOST_ROWS, WholeForm, cut_set_cuts, facet_cuts, gomory_cuts,
            mixed_integer_rounding_cuts, polymatroid_cuts,
        };
    }

    pub mod heuristics {
        pub use crate::search::{Allowance, Frontier, Kinks};
    }

    pub mod indifferent_binaries {
        pub use crate::search::{groups, round_groups, shift_to_integers, ungrouped_binaries};
    }

    pub mod node {
        pub use crate::search::{Decision, Node, NodeQueue, Path, StepCount};
    }

    pub mod node_probing {
        pub use crate::search::NodeProbing;
    }

    pub mod perspective {
        pub use crate::search::{Switched, squares_as_cones, switched_squares, with_slopes};
    }

    pub mod pseudocosts {
        pub use crate::search::{LEAST_GAIN, Pseudocosts};
    }
}
