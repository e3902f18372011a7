//! Parts that the other crates of the workspace use beside the public interface. They may change in
//! any release.

pub mod activity {
    pub use crate::activity::*;
}

pub mod elementary {
    pub use crate::elementary::{Elementary, IntervalSeries, SupportLine};
}

pub mod error {
    pub use crate::error::checks::{check_finite, check_length};
    pub use crate::error::range::FINITE_POSITIVE;
    pub use crate::error::*;
}

pub mod interval {
    pub use crate::interval::*;
    pub use crate::rounding::{add_down, add_up};
}

pub mod model {
    pub use crate::model::affine::merge;
    pub use crate::model::conic::standard_cone::StandardCone;
    pub use crate::model::conic::stored_conic::StoredConic;
    pub use crate::model::convexity::WRITE_SQUARES;
    pub use crate::model::ids::ModelTag;
    pub use crate::model::logic::normal::Formula;
    pub use crate::model::name::is_name;
    pub use crate::model::name_table::NameTable;
    pub use crate::model::statement::SealedStatement;
    pub use crate::model::stored::{StoredRow, StoredTerm};
    pub use crate::model::subset::{AnyStatement, statements, subset};
    pub use crate::model::text::quadratic_rows::with_quadratic_rows;
    pub use crate::model::*;
    pub use crate::{
        comparisons, functions, nonlinear_products, products, quotients, scaling, sums,
    };

    use crate::error::Error;

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

    pub mod lp_names {
        pub use crate::model::lp::names::{read, write};
    }

    pub use crate::model::mps::decimal::Decimal;
}

pub mod number {
    pub use crate::number::*;
}

pub mod random {
    pub use crate::random::SplitMix;
}

pub mod semidefinite {
    pub use crate::semidefinite::*;
}

pub mod setters {
    pub use crate::setters;
}

pub mod mutations {
    pub use crate::mutations::*;
}

pub mod solution {
    pub use crate::solution::*;
}

pub mod solver {
    pub use crate::solver::control::RowSource;
    pub use crate::solver::stop_token::uninterrupted;
    pub use crate::solver::*;
}

pub mod sum {
    pub use crate::sum::*;
}

pub mod tolerance {
    pub use crate::tolerance::derived::{
        SMALL_UNIT, allowed_drift, allowed_miss, finite_size, gap_scale, largest_magnitude,
        margin_scale, relative_gap,
    };
    pub use crate::tolerance::*;
}

pub mod union_find {
    pub use crate::union_find::UnionFind;
}

#[cfg(feature = "serde")]
pub mod serde_numbers {
    pub use crate::serde_numbers::*;
}
