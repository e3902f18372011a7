//! The parts of the solving tower that the tests and benches of this crate use. No part of the
//! public interface: it may change in any release.

pub mod branch_and_bound {
    use crate::search::{SearchResult, SolveTask};

    /// Tightens, cuts and searches the program of a task.
    pub fn search_tightened(task: SolveTask<'_>) -> SearchResult {
        crate::branch_and_bound::search_tightened(task)
    }
}

pub mod conformance {
    pub use crate::conformance::answer::{Case, Truth};
    pub use crate::conformance::programs::answers;
}

pub mod hybrid {
    use crate::hybrid::Matrix;

    pub fn exponential(matrix: &Matrix) -> Matrix {
        crate::hybrid::exponential::exponential(matrix.faer()).into()
    }

    pub use crate::hybrid::rows::SystemVariables;
    pub use crate::hybrid::system::{Choice, Halfspace, Transition};
}

pub mod model {
    use crate::error::Error;
    use crate::model::{Affine, ConicRow, Model, Name};

    /// The head and the tail of the cone that a row is in a model.
    pub fn standard_cone(
        model: &Model,
        row: ConicRow,
    ) -> Result<(Vec<Affine>, Vec<Affine>), Error> {
        let name = Name::from("row");
        let conic = row.checked(model, &name)?;
        let cone = model.standard_cone(&conic, &name)?;
        Ok((cone.head, cone.tail))
    }

    pub use crate::model::name_table::NameTable;
    pub use crate::model::subset::{AnyStatement, statements, subset};

    pub mod lp {
        pub use crate::model::lp::names::{read, write};
    }

    pub mod mps {
        pub use crate::model::mps::decimal::Decimal;
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
        ActiveSet, ClarabelRelaxation, DualSimplex, Effort, Extended, InteriorPoint, Ladder,
        LadderPool, Prover, Record, Relaxation, RelaxationClaim, RelaxationResult, WarmState,
        polish,
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
            Cut, MOST_ROWS, cut_set_cuts, mixed_integer_rounding_cuts, polymatroid_cuts,
        };
    }

    pub mod heuristics {
        pub use crate::search::{Allowance, Frontier};
    }

    pub mod indifferent_binaries {
        pub use crate::search::{groups, lone_binaries, settle_groups, settle_lone};
    }

    pub mod node {
        pub use crate::search::{Decision, Node, NodeQueue, Path, StepCount};
    }

    pub mod node_probing {
        pub use crate::search::NodeProbing;
    }

    pub mod perspective {
        pub use crate::search::{Switched, switched_squares, with_slopes};
    }

    pub mod pseudocosts {
        pub use crate::search::{LEAST_GAIN, Pseudocosts};
    }
}

pub mod semidefinite {
    pub use crate::semidefinite::{Direction, Product, negative_direction};
}

pub mod scene {
    pub use crate::hybrid::scene::samples::{Samples, advance_line, replay_line};
}

pub mod slips {
    pub use crate::slips::{Slip, with_slip};
}

pub mod sum {
    pub use crate::sum::Sum;
}
