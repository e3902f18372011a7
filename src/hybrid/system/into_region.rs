//! Regions as users state them.

use super::{HybridSystem, Region};
use crate::error::Error;
use crate::model::Row;

/// A region as a user states it: rows of a system's handles, or a [`Region`].
#[derive(Debug, Clone)]
#[doc(hidden)]
pub enum StatedRegion {
    Rows(Vec<Row>),
    Region(Region),
}

/// A statement of where a run must be: rows such as `[x.equals(0.0), v.within(-1.0, 1.0)]`, or a
/// [`Region`].
pub trait IntoRegion {
    #[doc(hidden)]
    fn stated(self) -> StatedRegion;
}

impl<const N: usize> IntoRegion for [Row; N] {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self.into())
    }
}

impl IntoRegion for Vec<Row> {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self)
    }
}

/// Regions, and lists with one range per state.
impl<R> IntoRegion for R
where
    Region: From<R>,
{
    fn stated(self) -> StatedRegion {
        StatedRegion::Region(self.into())
    }
}

impl StatedRegion {
    /// The region of a system.
    pub(crate) fn of(&self, system: &HybridSystem) -> Result<Region, Error> {
        match self {
            StatedRegion::Rows(rows) => system.region(rows.iter().cloned()),
            StatedRegion::Region(region) => Ok(region.clone()),
        }
    }
}
