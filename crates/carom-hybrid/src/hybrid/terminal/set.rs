//! The maximal admissible set of a mode under linear feedback.
//!
//! E. G. Gilbert and K. T. Tan, "Linear systems with state and control constraints: the theory and
//! application of maximal output admissible sets", IEEE Transactions on Automatic Control 36(9),
//! 1991: the limits must hold after 0, 1, 2, ... steps, and as soon as those of one more step are
//! implied by the earlier ones, so are all later ones. Each question is a linear program.

use faer::Mat;

use super::lqr::{Lqr, spectral_radius};
use super::polyhedron::Polyhedron;
use super::stay::{Stay, unit};
use crate::error::{Error, ErrorKind, TerminalError, check_length};
use crate::hybrid::step::AffineForm;
use crate::hybrid::system::{Halfspace, HybridSystem, Region, Restated};
use crate::interval::Interval;
use crate::setters::setters;
use crate::solver::Solver;

/// By how much limits are tightened, relative to the target's slack, so that rows that are implied
/// up to half of it can be dropped.
const SHRINK: f64 = 1e-6;

/// How far, relative to the state's domain, the equilibrium may drift in a step.
const STEADY_WITHIN: f64 = 1e-9;

/// Options of a [`TerminalSet`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TerminalOptions {
    /// The most steps whose limits are looked at before the set counts as not determined; default
    /// 1000.
    pub most_iterations: usize,
    /// By which fraction each step brings the set closer to the target, from 1e-6 to 0.5 (no unit);
    /// default 1e-4. It is the margin of the set's verification. If the feedback converges too
    /// slowly for it, a smaller one is taken.
    pub contraction: f64,
}

impl Default for TerminalOptions {
    fn default() -> Self {
        TerminalOptions { most_iterations: 1000, contraction: 1e-4 }
    }
}

impl TerminalOptions {
    setters! {
        /// Sets the most steps whose limits are looked at.
        with_most_iterations(most: usize) => most_iterations = most;
        /// Sets the margin of the set's verification, from 1e-6 to 0.5.
        with_contraction(contraction: f64) => contraction = contraction;
    }
}

/// A set of states from which a mode, under linear feedback, keeps all limits for ever.
///
/// It is the largest such set but for the margin [`TerminalOptions::contraction`], and it is
/// verified: over the finished set, a linear program per facet proves that the next state is in the
/// set, and one per limit, range and guard proves that it holds.
///
/// A plan that ends in the set can be continued for ever by [`feedback`](Self::feedback), if it
/// ends at a step from which on nothing in the system depends on the step. Disturbances are not
/// considered.
///
/// ```
/// use carom::hybrid::{LinearSystem, Lqr, TerminalOptions, TerminalSet};
/// use carom::prelude::*;
///
/// let line = LinearSystem::double_integrator(0.5)?;
/// let lqr = Lqr::new(&line, [[1.0, 0.0], [0.0, 1.0]], [[1.0]])?;
/// let mut system = HybridSystem::new(0.5); // s
/// let x = system.state("x", -5.0, 5.0)?; // m
/// let v = system.state("v", -2.0, 2.0)?; // m/s
/// let a = system.input("a", -1.0, 1.0)?; // m/s²
/// system.mode("drive")?.rates([x.is(v), v.is(a)])?;
/// let mut solver = BranchAndBound::default();
/// let (at, options) = ([2.0, 0.0], TerminalOptions::default());
/// let set = TerminalSet::new(&system, &["drive"], &lqr, &at, &options, &mut solver)?;
/// assert!(set.region.contains(&[2.5, 0.2], 0.0)? && !set.region.contains(&[4.9, 1.5], 0.0)?);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct TerminalSet {
    /// The set, in the mode that is kept: a goal for plans.
    pub region: Region,
    /// The equilibrium at the target: its state.
    pub state: Vec<f64>,
    /// The equilibrium's input.
    pub input: Vec<f64>,
    /// After how many steps limits no longer cut the set.
    pub iterations: usize,
    gain: Mat<f64>,
    /// By choice.
    transitions: Vec<String>,
}

/// A row `normal . e <= 1`, and the slack at the target that is its unit.
#[derive(Clone)]
struct Facet {
    name: String,
    normal: Vec<f64>,
    slack: f64,
}

impl TerminalSet {
    /// Builds and verifies the set.
    ///
    /// # Arguments
    ///
    /// * `transitions`: the transitions that are taken for ever, one per choice and in their order.
    /// * `lqr`: the feedback, such as that of the mode's flow.
    /// * `target`: the equilibrium's state, one entry per state.
    ///
    /// # Errors
    ///
    /// The errors of [`HybridSystem::check`];
    /// [`ErrorKind::Length`](crate::error::ErrorKind::Length) and
    /// [`ErrorKind::UnknownName`](crate::error::ErrorKind::UnknownName);
    /// [`ErrorKind::OutOfRange`](crate::error::ErrorKind::OutOfRange) for bad options; a
    /// [`TerminalError`] if there is no such set, if it is not determined within
    /// [`TerminalOptions::most_iterations`], or if its verification fails; errors of the solver.
    pub fn new(
        system: &HybridSystem,
        transitions: &[&str],
        lqr: &Lqr,
        target: &[f64],
        options: &TerminalOptions,
        solver: &mut dyn Solver,
    ) -> Result<Self, Error> {
        Stay::new(system, transitions)?;
        if let Some(input) = system.input_values.keys().next() {
            let solver = "a terminal set, whose feedback is linear,".to_owned();
            let what = format!("the input `{input}`, which takes some values only");
            let help =
                "make the set from a system in which it is an `input` with its range".to_owned();
            return Err(ErrorKind::Unsupported { solver, what, help }.into());
        }
        let Restated { system: own, coordinates } = &system.restated()?;
        let stay = Stay::new(own, transitions)?;
        let (n, m) = (system.states.len(), system.inputs.len());
        check_length("the target", target.len(), n)?;
        check_length("the rows of the gain", lqr.gain.nrows(), m)?;
        check_length("the columns of the gain", lqr.gain.ncols(), n)?;
        let contraction = options.contraction;
        if !(1e-6..=0.5).contains(&contraction) {
            let (what, words) = ("the contraction of a terminal set", "from 1e-6 to 0.5");
            return Err(Error::out_of_range_in_words(what, contraction, 1e-6..=0.5, words));
        }
        // From here on everything is in the coordinates of the domains.
        let (stated, system) = (target, own);
        let target = &coordinates.inward(stated)[..];
        let input = holding_input(system, &stay, target).map_err(|error| match error {
            Unheld::Moves { state, drift } => {
                let drift = drift * coordinates.state(state).scale;
                let state = system.states[state].0.clone();
                TerminalError::NoEquilibrium { state, drift }.into()
            }
            Unheld::Refused(error) => error,
        })?;
        let (of_state, of_input) =
            (|i: usize| coordinates.state(i).scale, |u: usize| coordinates.input(u).scale);
        let own_gain = Mat::from_fn(m, n, |u, i| lqr.gain[(u, i)] * of_state(i) / of_input(u));
        let gain = &own_gain;
        let closed = stay.map.a().faer() + stay.map.b().faer() * gain;
        let radius = spectral_radius(&closed);
        if radius >= 1.0 {
            return Err(TerminalError::NotStabilising { spectral_radius: radius }.into());
        }
        let rate = (1.0 - contraction).max(0.5 * (1.0 + radius));

        let units: Vec<f64> = system.states.iter().map(|(_, d)| unit(d)).collect();
        let ranges = around(system, target, &units)?;
        let base = base_facets(system, &stay, gain, target, &input, &units)?;
        // z⁺ = F z in units of the domains.
        let scaled = Mat::from_fn(n, n, |i, j| closed[(i, j)] * units[j] / units[i]);
        let grown = Growth { base: &base, ranges: &ranges, map: &scaled, rate };
        let (facets, iterations) = grown.run(options.most_iterations, solver)?;
        grown.verify(&facets, solver)?;

        let ranges = system.states.iter().zip(target).map(|((_, domain), &x)| Interval {
            lower: x + (1.0 - SHRINK) * (domain.lower - x),
            upper: x + (1.0 - SHRINK) * (domain.upper - x),
        });
        let mut region = Region::from(ranges.collect::<Vec<_>>());
        for facet in &facets {
            let normal = facet.normal.iter().zip(&units).map(|(a, unit)| facet.slack * a / unit);
            let normal: Vec<f64> = normal.collect();
            let at: f64 = normal.iter().zip(target).map(|(a, x)| a * x).sum();
            region = region.with_halfspace(Halfspace::new(&facet.name, normal, facet.slack + at));
        }
        for (choice, mode) in stay.modes {
            region = region.with_mode(choice, mode);
        }
        let region = coordinates.inverse().region(&region);
        let input = input.iter().enumerate().map(|(u, value)| coordinates.input(u).outward(*value));
        let (state, gain) = (stated.to_vec(), lqr.gain.faer().clone());
        let transitions = transitions.iter().map(|name| (*name).to_owned()).collect();
        Ok(TerminalSet { region, state, input: input.collect(), iterations, gain, transitions })
    }

    /// The transitions that are taken for ever, by choice.
    pub(crate) fn transitions(&self) -> &[String] {
        &self.transitions
    }

    /// The input that keeps a state of the set in it: `u_e + K (x - x_e)`.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::error::ErrorKind::Length).
    pub fn feedback(&self, state: &[f64]) -> Result<Vec<f64>, Error> {
        check_length("the state", state.len(), self.state.len())?;
        let error: Vec<f64> = state.iter().zip(&self.state).map(|(x, at)| x - at).collect();
        let input = self.input.iter().enumerate().map(|(i, input)| {
            input + error.iter().enumerate().map(|(j, e)| self.gain[(i, j)] * e).sum::<f64>()
        });
        Ok(input.collect())
    }
}

/// Why no input holds a target.
enum Unheld {
    /// This state moves by so much in a step.
    Moves {
        state: usize,
        drift: f64,
    },
    Refused(Error),
}

/// The input that holds the target, as near as possible to the middle of the ranges.
fn holding_input(system: &HybridSystem, stay: &Stay, target: &[f64]) -> Result<Vec<f64>, Unheld> {
    let middle: Vec<f64> = stay.ranges.iter().map(|r| 0.5 * (r.lower + r.upper)).collect();
    let input = stay.holding_input(target, &middle).map_err(Unheld::Refused)?;
    let (state, drift, relative) = stay.drift(system, target, &input).map_err(Unheld::Refused)?;
    if relative <= STEADY_WITHIN {
        return Ok(input);
    }
    Err(Unheld::Moves { state, drift })
}

/// The domains around the target, in their units.
fn around(
    system: &HybridSystem,
    target: &[f64],
    units: &[f64],
) -> Result<Vec<Interval>, TerminalError> {
    let named = system.states.iter().zip(target.iter().zip(units));
    let ranges = named.map(|((name, domain), (&x, &unit))| {
        let slack = (x - domain.lower).min(domain.upper - x);
        if slack.is_nan() || slack <= 0.0 {
            return Err(TerminalError::AtLimit { limit: name.clone(), slack });
        }
        let scale = (1.0 - SHRINK) / unit;
        Ok(Interval { lower: scale * (domain.lower - x), upper: scale * (domain.upper - x) })
    });
    ranges.collect()
}

/// Domains, limits, ranges and guards under the feedback, as rows of `z` with limit 1.
fn base_facets(
    system: &HybridSystem,
    stay: &Stay,
    gain: &Mat<f64>,
    target: &[f64],
    input: &[f64],
    units: &[f64],
) -> Result<Vec<Facet>, TerminalError> {
    let (n, m) = (target.len(), input.len());
    let single = |at: usize, sign: f64| -> Vec<f64> {
        (0..n + m).map(|i| if i == at { sign } else { 0.0 }).collect()
    };
    let mut limits = Vec::new();
    let domains = system.states.iter().map(|(name, domain)| ("domain", name, domain));
    let ranges = system.inputs.iter().zip(&stay.ranges).map(|((name, _), r)| ("range", name, r));
    for (i, (what, name, range)) in domains.chain(ranges).enumerate() {
        for (sign, limit) in [(1.0, range.upper), (-1.0, -range.lower)] {
            let form = AffineForm { factors: single(i, sign), constant: -limit };
            limits.push((format!("the {what} of {name}"), form));
        }
    }
    limits.extend_from_slice(&stay.limits);
    let mut facets = Vec::new();
    for (name, AffineForm { factors, constant }) in limits {
        let limit = -constant;
        let fed = |j: usize| (0..m).map(|i| factors[n + i] * gain[(i, j)]).sum::<f64>();
        let normal: Vec<f64> = (0..n).map(|j| units[j] * (factors[j] + fed(j))).collect();
        let at = factors.iter().zip(target.iter().chain(input));
        let slack = limit - at.map(|(a, x)| a * x).sum::<f64>();
        // A limit that no error changes only has to hold at the target.
        let moves = normal.iter().any(|a| a.abs() > 1e-12 * limit.abs().max(1.0));
        if slack.is_nan() || slack < 0.0 || (moves && slack == 0.0) {
            return Err(TerminalError::AtLimit { limit: name, slack });
        }
        if moves {
            let slack = (1.0 - SHRINK) * slack;
            let normal = normal.into_iter().map(|a| a / slack).collect();
            facets.push(Facet { name, normal, slack });
        }
    }
    Ok(facets)
}

/// The growth of the set's rows over the steps.
struct Growth<'a> {
    base: &'a [Facet],
    ranges: &'a [Interval],
    map: &'a Mat<f64>,
    /// The factor, below 1, by which each step shall bring the set closer to the target.
    rate: f64,
}

impl Growth<'_> {
    /// The rows of the set, without those that others imply, and the number of steps.
    fn run(
        &self,
        most_iterations: usize,
        solver: &mut dyn Solver,
    ) -> Result<(Vec<Facet>, usize), Error> {
        let mut set = Polyhedron::of_box(self.ranges)?;
        let mut facets: Vec<Facet> = Vec::new();
        let mut images = self.base.to_vec();
        let mut iterations = 0;
        loop {
            let mut grew = false;
            for image in &images {
                if set.largest(&image.normal, solver)? > 1.0 + 0.5 * SHRINK {
                    set.cut(&image.normal)?;
                    facets.push(image.clone());
                    grew = true;
                }
            }
            // The domains hold at step 0 without a row, so nothing may be added there although the
            // limits of step 1 do cut.
            if !grew && iterations > 0 {
                break;
            }
            if iterations == most_iterations {
                return Err(TerminalError::NotDetermined { iterations }.into());
            }
            iterations += 1;
            for (image, base) in images.iter_mut().zip(self.base) {
                image.normal = self.before(&image.normal, self.rate);
                image.name = format!("{} after {iterations} steps", base.name);
            }
        }
        // Later rows may imply earlier ones.
        let mut kept = Vec::new();
        for (k, facet) in facets.into_iter().enumerate() {
            if !set.drop_if_implied(k, &facet.normal, 0.25 * SHRINK, solver)? {
                kept.push(facet);
            }
        }
        Ok((kept, iterations))
    }

    /// The row of `z` that is `row` after a step, divided by `rate`.
    fn before(&self, row: &[f64], rate: f64) -> Vec<f64> {
        let n = row.len();
        (0..n).map(|j| (0..n).map(|i| row[i] * self.map[(i, j)]).sum::<f64>() / rate).collect()
    }

    /// Proves, over the set, that all limits hold and that the next state is in the set.
    fn verify(&self, facets: &[Facet], solver: &mut dyn Solver) -> Result<(), Error> {
        let mut set = Polyhedron::of_box(self.ranges)?;
        facets.iter().try_for_each(|facet| set.cut(&facet.normal))?;
        let mut prove = |name: &str, row: &[f64], allowed: f64| {
            let reached = set.largest(row, solver)?;
            if reached <= allowed {
                return Ok(());
            }
            Err(Error::from(TerminalError::NotVerified { limit: name.into(), reached, allowed }))
        };
        for facet in self.base {
            prove(&facet.name, &facet.normal, 1.0 + SHRINK)?;
        }
        // The equilibrium may drift by rounding, which is far less than this.
        let inside = 1.0 - 1e-7;
        for facet in facets {
            prove(&facet.name, &self.before(&facet.normal, 1.0), inside)?;
        }
        for (i, range) in self.ranges.iter().enumerate() {
            for end in [range.lower, range.upper] {
                let row: Vec<f64> =
                    (0..self.ranges.len()).map(|j| if i == j { 1.0 / end } else { 0.0 }).collect();
                prove("a domain", &self.before(&row, 1.0), inside)?;
            }
        }
        Ok(())
    }
}
