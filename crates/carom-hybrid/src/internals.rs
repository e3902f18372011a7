//! Parts that tests and the other crates of the workspace use beside the public interface. They may
//! change in any release.

pub use crate::hybrid::rows::SystemVariables;
pub use crate::hybrid::scene::samples::{Samples, advance_line, replay_line};
pub use crate::hybrid::system::{Choice, Halfspace, Transition};

use crate::hybrid::reach::{Change, TighteningReport};
use crate::hybrid::{HybridSystem, Matrix, Region, Schedule};
use crate::interval::Interval;

pub fn exponential(matrix: &Matrix) -> Matrix {
    crate::hybrid::exponential::exponential(matrix.faer()).into()
}

/// The contents of a system, a region or a report, for tests.
pub trait HasParts {
    type Parts<'a>
    where
        Self: 'a;
    type PartsMut<'a>
    where
        Self: 'a;

    fn parts(&self) -> Self::Parts<'_>;
    fn parts_mut(&mut self) -> Self::PartsMut<'_>;
}

macro_rules! parts {
    ($of:ty: $shared:ident, $mutable:ident { $($field:ident: $type:ty),* }) => {
        #[derive(Debug)]
        pub struct $shared<'a> { $(pub $field: &'a $type),* }
        #[derive(Debug)]
        pub struct $mutable<'a> { $(pub $field: &'a mut $type),* }
        impl HasParts for $of {
            type Parts<'a> = $shared<'a>;
            type PartsMut<'a> = $mutable<'a>;

            fn parts(&self) -> $shared<'_> {
                $shared { $($field: &self.$field),* }
            }

            fn parts_mut(&mut self) -> $mutable<'_> {
                $mutable { $($field: &mut self.$field),* }
            }
        }
    };
}

parts!(HybridSystem: SystemParts, SystemPartsMut {
    states: Vec<(String, Interval)>,
    inputs: Vec<(String, Schedule<Interval>)>,
    limits: Vec<Halfspace>,
    choices: Vec<Choice>,
    most_events: Option<usize>
});
parts!(Region: RegionParts, RegionPartsMut { modes: Vec<(String, String)> });
parts!(TighteningReport: ReportParts, ReportPartsMut {
    fixed: Vec<Change>,
    tightened: Vec<Change>
});
