//! Regions of states: starts and goals.

use std::ops::RangeInclusive;

use super::HybridSystem;
use super::check::{check_halfspace, check_norm, too_large};
use super::halfspace::Halfspace;
use super::norm_limit::NormLimit;
use super::state_row::StateRow;
use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::interval::Interval;
use crate::model::{Affine, ConicRow, Constraint, Model, Row};
use crate::tolerance::INFINITE;

/// A region of states, for a start or a goal: a box, cut by half-spaces, in given modes. Made by
/// [`HybridSystem::region`].
///
/// ```
/// use carom::prelude::*;
///
/// let mut car = HybridSystem::new(0.1); // s
/// let x = car.state("x", 0.0, 9.0)?; // m
/// let v = car.state("v", -2.0, 2.0)?; // m/s
/// // Up to 1 m, and slower than the distance in metres.
/// let goal = car.region([x.le(1.0), v.le(x)])?;
/// assert!(goal.contains(&[0.5, 0.4], 0.0)? && !goal.contains(&[0.5, 0.6], 0.0)?);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Region {
    /// One interval per state, in the state's unit. An infinite end means that the state's domain
    /// is the only limit.
    pub ranges: Vec<Interval>,
    /// Half-spaces of the states, the same at every step.
    pub(crate) halfspaces: Vec<Halfspace>,
    /// Discs of the states, the same at every step.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) norms: Vec<NormLimit>,
    /// Nonlinear rows of the states.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) nonlinear: Vec<StateRow>,
    /// Choices and modes. A choice that is named several times may be in any of those modes; a
    /// choice that is not named may be in any mode.
    pub(crate) modes: Vec<(String, String)>,
}

impl From<Vec<Interval>> for Region {
    fn from(ranges: Vec<Interval>) -> Self {
        let (halfspaces, norms, nonlinear) = (Vec::new(), Vec::new(), Vec::new());
        Region { ranges, halfspaces, norms, nonlinear, modes: Vec::new() }
    }
}

impl From<&[Interval]> for Region {
    fn from(ranges: &[Interval]) -> Self {
        ranges.to_vec().into()
    }
}

impl<const N: usize> From<[Interval; N]> for Region {
    fn from(ranges: [Interval; N]) -> Self {
        ranges.to_vec().into()
    }
}

impl<const N: usize> From<&[Interval; N]> for Region {
    fn from(ranges: &[Interval; N]) -> Self {
        ranges.to_vec().into()
    }
}

/// One state, as [`Region::point`].
impl<const N: usize> From<[f64; N]> for Region {
    fn from(state: [f64; N]) -> Self {
        Region::point(state)
    }
}

impl<const N: usize> From<[RangeInclusive<f64>; N]> for Region {
    fn from(ranges: [RangeInclusive<f64>; N]) -> Self {
        ranges.map(Interval::from).into()
    }
}

impl From<&Vec<Interval>> for Region {
    fn from(ranges: &Vec<Interval>) -> Self {
        ranges.clone().into()
    }
}

impl From<&Region> for Region {
    fn from(region: &Region) -> Self {
        region.clone()
    }
}

/// The error for a value outside the domain of its state.
pub(crate) fn outside_domain(what: &str, name: &str, value: f64, domain: Interval) -> Error {
    let range = format!("within its domain, {} to {}", domain.lower, domain.upper);
    let (what, limits) = (format!("{what} of `{name}`"), domain.lower..=domain.upper);
    Error::out_of_range_in_words(what, value, limits, range)
}

impl Region {
    /// One state, with one value per state, in any mode.
    pub fn point(state: impl AsRef<[f64]>) -> Self {
        state.as_ref().iter().map(|&x| Interval::point(x)).collect::<Vec<_>>().into()
    }

    /// Cuts the region with a half-space of the states.
    #[doc(hidden)]
    #[must_use]
    pub fn with_halfspace(mut self, halfspace: Halfspace) -> Self {
        self.halfspaces.push(halfspace);
        self
    }

    /// Allows a mode of a choice, by their names. Without this, every mode of a choice is allowed.
    #[must_use]
    pub fn with_mode(mut self, choice: impl Into<String>, mode: impl Into<String>) -> Self {
        self.modes.push((choice.into(), mode.into()));
        self
    }

    /// Whether a choice may be in a mode.
    pub fn allows(&self, choice: &str, mode: &str) -> bool {
        let mut named = self.modes.iter().filter(|(name, _)| name == choice).peekable();
        named.peek().is_none() || named.any(|(_, allowed)| allowed == mode)
    }

    /// Whether a state lies in the region, up to `tolerance` in each range, half-space and disc.
    /// Modes are not looked at.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`].
    pub fn contains(&self, state: &[f64], tolerance: f64) -> Result<bool, Error> {
        check_length("the state", state.len(), self.ranges.len())?;
        let inside = self
            .ranges
            .iter()
            .zip(state)
            .all(|(range, &x)| range.lower - tolerance <= x && x <= range.upper + tolerance);
        let excess = |h: &Halfspace| {
            let value: f64 = h.normal.iter().zip(state).map(|(n, x)| n * x).sum();
            value - h.limit_at(0)
        };
        let in_disc = |disc: &NormLimit| disc.slack(state, 0) >= -tolerance;
        Ok(inside
            && self.halfspaces.iter().all(|h| excess(h) <= tolerance)
            && self.norms.iter().all(in_disc)
            && self.nonlinear.iter().all(|row| row.slack(state) >= -tolerance))
    }

    /// Adds rows to a model of your own that keep a sample in the region: `name[0]`, `name[1]`,
    /// ..., and `name_disc[0]`, ... and `name_nonlinear[0]`, ... for its discs and nonlinear rows,
    /// which are not returned. Modes are left to the
    /// caller.
    ///
    /// # Arguments
    ///
    /// * `states`: the sample's variables or expressions, in the system's order.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`]; [`ErrorKind::OutOfRange`] for a half-space of another length, or
    /// whose normal is 0; the errors of [`Model::add`].
    pub fn add<X>(
        &self,
        model: &mut Model,
        name: &str,
        states: &[X],
    ) -> Result<Vec<Constraint>, Error>
    where
        for<'a> Affine: From<&'a X>,
    {
        let (rows, discs) = (self.rows(states)?, self.discs(states)?);
        let states: Vec<Affine> = states.iter().map(Affine::from).collect();
        model.all_or_nothing(|model| {
            for (k, disc) in discs.into_iter().enumerate() {
                model.add((format!("{name}_disc"), k), disc)?;
            }
            for (k, row) in self.nonlinear.iter().enumerate() {
                model.add((format!("{name}_nonlinear"), k), row.over(&states))?;
            }
            rows.into_iter().enumerate().map(|(k, row)| model.add((name, k), row)).collect()
        })
    }

    /// The conic rows that state that a sample is in the region's discs.
    pub(crate) fn discs<X>(&self, states: &[X]) -> Result<Vec<ConicRow>, Error>
    where
        for<'a> Affine: From<&'a X>,
    {
        check_length("the sample's states", states.len(), self.ranges.len())?;
        let disc = |disc: &NormLimit| {
            check_norm(disc, states.len(), 0)?;
            Ok(disc.row(0, |factors, constant| {
                let terms = factors.iter().zip(states).filter(|(n, _)| **n != 0.0);
                let sum: Affine = terms.map(|(n, state)| *n * Affine::from(state)).sum();
                sum + constant
            }))
        };
        self.norms.iter().map(disc).collect()
    }

    /// The rows that state that a sample is in the region, without modes and discs.
    pub(crate) fn rows<X>(&self, states: &[X]) -> Result<Vec<Row>, Error>
    where
        for<'a> Affine: From<&'a X>,
    {
        check_length("the sample's states", states.len(), self.ranges.len())?;
        let mut rows = Vec::new();
        for (state, range) in states.iter().zip(&self.ranges) {
            let state = Affine::from(state);
            if range.lower == range.upper {
                rows.push(state.equals(range.lower));
            } else if range.lower.is_finite() || range.upper.is_finite() {
                rows.push(state.within(range.lower, range.upper));
            }
        }
        for halfspace in &self.halfspaces {
            check_cut(halfspace, states.len())?;
            let terms = halfspace.normal.iter().zip(states).filter(|(n, _)| **n != 0.0);
            let sum: Affine = terms.map(|(n, state)| *n * Affine::from(state)).sum();
            rows.push(sum.le(halfspace.limit_at(0)));
        }
        Ok(rows)
    }

    /// Refuses regions that do not fit a system. The error names `what`, the start or the goal.
    pub(crate) fn check(&self, system: &HybridSystem, what: &'static str) -> Result<(), Error> {
        check_length(what, self.ranges.len(), system.states.len())?;
        for ((name, _), range) in system.states.iter().zip(&self.ranges) {
            for (end, value) in [("the lower limit", range.lower), ("the upper limit", range.upper)]
            {
                if value.is_nan() {
                    check_finite(name, end, [value])?;
                }
                if value.is_finite() && value.abs() >= INFINITE {
                    let what = format!("a limit of `{name}`");
                    return Err(too_large(what, value));
                }
            }
            let Interval { lower, upper } = *range;
            if lower > upper || lower == f64::INFINITY || upper == f64::NEG_INFINITY {
                return Err(ErrorKind::CrossedBounds { name: name.into(), lower, upper }.into());
            }
        }
        for halfspace in &self.halfspaces {
            check_cut(halfspace, system.states.len())?;
            if !halfspace.limit.is_constant() {
                let what = format!("the number of limits of `{}` in {what}", halfspace.name);
                let count = halfspace.limit.values().count() as f64;
                return Err(Error::out_of_range_with(
                    what,
                    count,
                    1.0..=1.0,
                    ", the same at every step",
                ));
            }
        }
        for disc in &self.norms {
            check_norm(disc, system.states.len(), 0)?;
            if disc.settles() > 0 {
                let what = format!("the number of values of `{}` in {what}", disc.name);
                let count = (disc.settles() + 1) as f64;
                return Err(Error::out_of_range_with(
                    what,
                    count,
                    1.0..=1.0,
                    ", the same at every step",
                ));
            }
        }
        for (choice, mode) in &self.modes {
            let found = system.choices.iter().find(|c| c.name == *choice);
            let Some(found) = found else {
                return Err(Error::unknown_name(choice, "choice of the system"));
            };
            if !found.modes().contains(&mode.as_str()) {
                return Err(Error::unknown_name(mode, "mode of the choice"));
            }
        }
        Ok(())
    }
}

/// The half-space of a region has a normal with an entry per state, not all of them 0.
pub(crate) fn check_cut(halfspace: &Halfspace, states: usize) -> Result<(), Error> {
    check_halfspace(halfspace, states, 0)?;
    if halfspace.normal.iter().all(|n| *n == 0.0) {
        let what =
            format!("the largest entry of the normal of the half-space `{}`", halfspace.name);
        let range = "another number than 0; give a direction";
        return Err(Error::out_of_range_in_words(what, 0.0, .., range));
    }
    Ok(())
}
