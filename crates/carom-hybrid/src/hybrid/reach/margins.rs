//! By how much accepted plans may miss what a system states, and still lie in its sets.
//!
//! A plan may miss inputs and resets by a tolerance at each step. A flow that grows multiplies what
//! sets allow for that, until they hold everything. But a plan is also near to the run of its
//! inputs from its start (`simulate/open_run.rs`), so the sets of a system that grows are those of
//! such runs: their starts, inputs and resets are exact, and conditions and bounds are widened
//! once, by how far a plan may be from its run.

use crate::hybrid::linear::LinearSystem;
use crate::hybrid::step::AffineForm;
use crate::hybrid::system::HybridSystem;
use crate::interval::Interval;
use crate::tolerance::{MAX_STEPS, allowed_drift, margin_scale};

/// The largest magnitude of an eigenvalue of a flow from which a system grows.
const LEAST_EIGENVALUE: f64 = 1.01;

/// The margins of the sets of a system.
#[derive(Debug, Clone)]
pub(super) struct Margins {
    /// Of a condition with magnitudes up to 1000.
    margin: f64,
    /// By how much a plan may differ from its run, by state, where sets are those of runs.
    drift: Option<Vec<f64>>,
}

impl Margins {
    pub(super) fn new(system: &HybridSystem, margin: f64) -> Self {
        let drift = |(_, domain): &(String, Interval)| {
            allowed_drift(domain.upper - domain.lower, domain.magnitude(), MAX_STEPS)
        };
        let is_bounded = system.states.iter().all(|(_, domain)| domain.is_bounded());
        let of_runs = margin > 0.0 && is_bounded && grows(system);
        Margins { margin, drift: of_runs.then(|| system.states.iter().map(drift).collect()) }
    }

    /// Of an input or a reset at each step, for magnitudes up to 1000.
    pub(super) fn of_step(&self) -> f64 {
        if self.drift.is_some() { 0.0 } else { self.margin }
    }

    /// Of a given input, which the range of the system does not keep.
    pub(super) fn of_given(&self) -> f64 {
        self.margin
    }

    fn drift_of(&self, state: usize) -> f64 {
        self.drift.as_ref().map_or(0.0, |drift| drift[state])
    }

    /// Of a condition `states . x + inputs . u <= limit` with terms up to a magnitude.
    pub(super) fn of_condition(
        &self,
        states: &[f64],
        inputs: &[f64],
        largest: f64,
        limit: f64,
    ) -> f64 {
        let own = self.margin * margin_scale(largest, limit);
        let Some(drift) = &self.drift else { return own };
        let of_states: f64 = states.iter().zip(drift).map(|(n, d)| n.abs() * d).sum();
        let of_inputs: f64 = inputs.iter().map(|m| m.abs() * own).sum();
        own + of_states + of_inputs
    }

    /// Of a limit of a state.
    pub(super) fn of_state(&self, state: usize, size: f64, limit: f64) -> f64 {
        self.margin * margin_scale(size, limit) + self.drift_of(state)
    }

    /// Of the first sample of runs, by state; conditions on several states keep theirs.
    pub(super) fn of_start(&self, range: Interval) -> f64 {
        self.of_step() * margin_scale(range.magnitude(), 0.0)
    }

    /// By how much the states of plans may be outside a box around sets.
    pub(super) fn widened(&self, ranges: &[Interval]) -> Vec<Interval> {
        let wide = |(state, range): (usize, &Interval)| {
            let by = self.drift_of(state);
            Interval::new((range.lower - by).next_down(), (range.upper + by).next_up())
        };
        match self.drift {
            None => ranges.to_vec(),
            Some(_) => ranges.iter().enumerate().map(wide).collect(),
        }
    }

    /// Of the predictions of a flow.
    pub(super) fn after(&self, flow: &[AffineForm]) -> Margins {
        let Some(drift) = &self.drift else { return self.clone() };
        let widest = |row: &AffineForm| {
            let mut by = drift.clone();
            by.resize(row.factors.len(), self.margin);
            row.factors.iter().zip(by).map(|(a, by)| a.abs() * by).sum()
        };
        Margins { margin: self.margin, drift: Some(flow.iter().map(widest).collect()) }
    }
}

/// Whether some flow grows at each step.
fn grows(system: &HybridSystem) -> bool {
    let flows = system.transitions().map(|transition| &transition.flow);
    let mut known: Option<&LinearSystem> = None;
    flows.chain(&system.flow).any(|flow| {
        let is_new = known.is_none_or(|known| known.a() != flow.a());
        known = Some(flow);
        is_new
            && flow.a().faer().eigenvalues().is_ok_and(|values| {
                values.iter().any(|value| value.re.hypot(value.im) > LEAST_EIGENVALUE)
            })
    })
}
