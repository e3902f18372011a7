//! What the tests and benches of this crate use of the solving tower. No part of the public
//! interface: it may change in any release.

pub mod conformance {
    pub use crate::conformance::answer::{Case, Truth};
    pub use crate::conformance::programs::answers;
}

pub mod hybrid {
    pub use crate::hybrid::exponential::exponential;
}

pub mod model {
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
        Compressed, Domain, Implications, Literal, Propagator, Reduced, Reduction, probe,
        probe_implications, project, reduce, tighten_big_ms, tighten_by_disjunctions,
        tighten_coefficients,
    };

    pub mod root {
        pub use crate::presolve::root::{Presolve, Presolved, Rule, presolve};
    }
}

pub mod program {
    pub use crate::program::Program;
}

pub mod relaxation {
    pub use crate::relaxation::{
        Claim, ClarabelRelaxation, Effort, InteriorPoint, Ladder, Relaxation, RelaxationResult,
        WarmState, lower_bound, polish, proves_infeasible, reduced_costs,
    };
}

pub mod search {
    pub use crate::search::{Accept, ColumnGuidance, Found, Task, search};

    pub mod cuts {
        pub use crate::search::cuts::{Cut, implied_bound_cuts, mixed_integer_rounding_cuts};
    }
}

pub mod simulate {
    pub use crate::hybrid::simulate::continuous::{advance, penetration_bound, speed_bound};
}

pub mod sum {
    pub use crate::sum::Sum;
}
