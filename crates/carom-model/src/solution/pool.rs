//! The best points of a solve, with distinct integers.

use super::{Point, Verification};
use crate::error::Error;
use crate::model::Model;

/// The best points of a solve, best first. No two have the same values of all integer variables.
///
/// ```
/// use carom::prelude::*;
/// use carom::solver::PoolMode;
///
/// let mut model = Model::new("m");
/// let v = model.binary_family("v", 3)?;
/// model.add("two", (v[0] + v[1] + v[2]).equals(2.0))?;
/// model.minimize(v[0] + 2.0 * v[1] + 4.0 * v[2])?;
///
/// let options = Options::default().with_pool(2, PoolMode::Best);
/// let solution = BranchAndBound::new(options).solve(&model)?;
/// let objectives: Vec<f64> = solution.pool().iter().map(|point| point.objective()).collect();
/// assert_eq!(objectives, [3.0, 5.0]);
/// assert!(solution.pool().is_complete());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Pool {
    points: Vec<PoolPoint>,
    pub(super) complete: bool,
}

/// A point of a [`Pool`].
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PoolPoint {
    point: Point,
    objective: f64,
    verification: Verification,
}

impl PoolPoint {
    /// The point.
    pub fn point(&self) -> &Point {
        &self.point
    }

    /// Its objective, in the model's own sense.
    pub fn objective(&self) -> f64 {
        self.objective
    }

    /// Its check, made from the model.
    pub fn verification(&self) -> &Verification {
        &self.verification
    }
}

impl Pool {
    pub(super) fn of_best(
        point: Option<&Point>,
        objective: Option<f64>,
        verification: Option<&Verification>,
    ) -> Self {
        let mut pool = Pool::default();
        if let (Some(point), Some(objective), Some(verification)) = (point, objective, verification)
        {
            let (point, verification) = (point.clone(), verification.clone());
            pool.points.push(PoolPoint { point, objective, verification });
        }
        pool
    }

    /// Adds a point if it is feasible and better than any point with the same integers.
    pub(super) fn offer(
        &mut self,
        model: &Model,
        point: Point,
        feasibility: f64,
    ) -> Result<(), Error> {
        let verification = Verification::of(model, &point, feasibility);
        if !verification.holds() {
            return Ok(());
        }
        let objective = point.value(model.objective())?;
        let cost = |objective: f64| model.sense().sign() * objective;
        let key = |point: &Point| -> Vec<f64> {
            let integral = model.variables().zip(point.as_slice());
            let integral = integral.filter(|(variable, _)| variable.kind().is_integral());
            integral.map(|(_, value)| value.round()).collect()
        };
        let own = key(&point);
        if let Some(same) = self.points.iter().position(|p| key(&p.point) == own) {
            if cost(self.points[same].objective) <= cost(objective) {
                return Ok(());
            }
            self.points.remove(same);
        }
        let place = self.points.partition_point(|p| cost(p.objective) <= cost(objective));
        self.points.insert(place, PoolPoint { point, objective, verification });
        Ok(())
    }

    /// The points, best first.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = &PoolPoint> {
        self.points.iter()
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Whether the points are proved to be the best ones.
    ///
    /// If so, no other assignment of the integers has an objective better than that of the last
    /// point by more than the gap. If there are fewer points than requested, no others exist within
    /// the gap of the pool. Only [`PoolMode::Best`](crate::solver::PoolMode::Best) can prove this,
    /// and only if the search was not stopped.
    pub fn is_complete(&self) -> bool {
        self.complete
    }
}
