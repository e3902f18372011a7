//! Regions as users state them.

use super::system_row::SystemRow;
use super::{HybridSystem, Region};
use crate::error::Error;
use crate::model::{ConicRow, NonlinearRow, Row};

/// A region as a user states it: rows of a system's handles, or a [`Region`].
#[derive(Debug, Clone)]
#[doc(hidden)]
pub enum StatedRegion {
    Rows(Vec<SystemRow>),
    Region(Region),
}

/// A statement of where a run must be: rows such as `[x.equals(0.0), v.within(-1.0, 1.0)]`, a disc
/// such as `norm([x - 4.0, y - 1.0]).le(0.5)`, nonlinear rows, rows and discs as a pair of lists,
/// or a [`Region`].
///
/// ```
/// use carom::model::norm;
/// use carom::prelude::*;
///
/// let mut puck = HybridSystem::new(1.0); // s
/// let x = puck.state("x", -9.0, 9.0)?; // m
/// let y = puck.state("y", -9.0, 9.0)?; // m
/// let [u, w] = [puck.input("u", -1.0, 1.0)?, puck.input("w", -1.0, 1.0)?]; // m/s
/// puck.mode("slide")?.next([x.is(x + u), y.is(y + w)])?;
/// let mut program = puck.program(4)?;
/// program.start([x.equals(0.0), y.equals(0.0)])?;
/// program.require("ring", norm([x - 2.0, y - 2.0]).le(0.5), When::OnceIn(1..=3))?;
/// program.goal(([x.ge(1.0)], [norm([x, y]).le(2.0)]))?;
/// program.maximize(program.end(y)?)?;
/// let plan = program.solve(&mut BranchAndBound::default())?;
/// assert!((plan.value(y, 4)? - 3.0_f64.sqrt()).abs() < 1e-4);
/// # Ok::<(), carom::Error>(())
/// ```
pub trait IntoRegion {
    #[doc(hidden)]
    fn stated(self) -> StatedRegion;
}

impl<const N: usize> IntoRegion for [Row; N] {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self.map(SystemRow::from).into())
    }
}

impl IntoRegion for Vec<Row> {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self.into_iter().map(SystemRow::from).collect())
    }
}

impl IntoRegion for ConicRow {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(vec![self.into()])
    }
}

impl<const N: usize> IntoRegion for [ConicRow; N] {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self.map(SystemRow::from).into())
    }
}

impl IntoRegion for NonlinearRow {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(vec![self.into()])
    }
}

impl<const N: usize> IntoRegion for [NonlinearRow; N] {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self.map(SystemRow::from).into())
    }
}

impl IntoRegion for Vec<SystemRow> {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self)
    }
}

impl<const N: usize> IntoRegion for [SystemRow; N] {
    fn stated(self) -> StatedRegion {
        StatedRegion::Rows(self.into())
    }
}

/// Rows and discs.
impl<R, C> IntoRegion for (R, C)
where
    R: Into<Vec<Row>>,
    C: Into<Vec<ConicRow>>,
{
    fn stated(self) -> StatedRegion {
        let (rows, discs) = (self.0.into(), self.1.into());
        let discs = discs.into_iter().map(SystemRow::from);
        StatedRegion::Rows(rows.into_iter().map(SystemRow::from).chain(discs).collect())
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
