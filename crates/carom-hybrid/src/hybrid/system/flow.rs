//! Flows stated by rates or by next values.

use super::HybridSystem;
use super::flow_rows::{FlowKind, FlowRows};
use super::handles::{Meaning, State};
use crate::error::{Error, ErrorKind};
use crate::hybrid::linear::LinearSystem;
use crate::model::{Affine, Nonlinear};

impl HybridSystem {
    /// The rows of a flow. States that are not named have the rows of the common flow, or stay.
    pub(super) fn flow_rows<E: Into<Nonlinear>>(
        &mut self,
        kind: FlowKind,
        rows: impl IntoIterator<Item = (State, E)>,
        place: &str,
    ) -> Result<FlowRows, Error> {
        let rows = rows
            .into_iter()
            .map(|(state, row)| Ok((state, self.with_series_as_inputs(&row.into(), place)?)));
        let rows = rows.collect::<Result<Vec<(State, Nonlinear)>, Error>>()?;
        let mut flow = self.unnamed_rows(kind, place)?;
        let mut named = vec![false; self.states.len()];
        for (state, row) in rows {
            let Meaning::State(i) = *self.meaning(state.into(), place)? else {
                return Err(self.misplaced(state.into(), place, "name a state"));
            };
            if std::mem::replace(&mut named[i], true) {
                return Err(Error::duplicate_name(&self.states[i].0, "row of the flow"));
            }
            let _visited = row.try_map(&mut |own: &Affine| {
                let all = self.plain_coefficients(own, place)?;
                if all.uses_predictions() {
                    let name = format!("the row of `{}`", self.states[i].0);
                    let help = "a flow starts from states and inputs, not from predictions";
                    return Err(ErrorKind::Misplaced { name, place: place.to_owned(), help }.into());
                }
                Ok(own.clone())
            })?;
            flow.rows[i] = row;
        }
        Ok(flow)
    }

    /// The rows of a flow that names no state.
    fn unnamed_rows(&self, kind: FlowKind, place: &str) -> Result<FlowRows, Error> {
        super::check::at_least_one("states", self.states.len())?;
        match &self.common {
            Some(common) if common.kind != kind => {
                let name = "a flow of another kind than the common one".to_owned();
                let help = "state both by `rates` or both by `next`";
                Err(ErrorKind::Misplaced { name, place: place.to_owned(), help }.into())
            }
            Some(common) => Ok(common.clone()),
            None => {
                let row = |i: usize| match kind {
                    FlowKind::Rates => Nonlinear::zero(),
                    FlowKind::NextValues => {
                        self.handles.find_state(i).map_or(Nonlinear::zero(), Nonlinear::from)
                    }
                };
                Ok(FlowRows { kind, rows: (0..self.states.len()).map(row).collect() })
            }
        }
    }

    /// The flow over a step; with linear rates, the exact one for inputs that are held (zero-order
    /// hold).
    pub(super) fn flow_of(&mut self, flow: &FlowRows) -> Result<LinearSystem, Error> {
        let affine: Option<Vec<Affine>> =
            flow.rows.iter().map(|row| row.as_affine().cloned()).collect();
        let Some(affine) = affine else {
            return match flow.kind {
                FlowKind::Rates => self.discretized(&flow.rows),
                FlowKind::NextValues => self.flow_of_functions(&flow.rows, false, |own| {
                    let start = own.start.clone();
                    own.at(&start)
                }),
            };
        };
        self.linear(flow.kind, &affine)
    }

    /// The same for affine rows.
    fn linear(&self, kind: FlowKind, rows: &[Affine]) -> Result<LinearSystem, Error> {
        let (n, m) = (self.states.len(), self.inputs.len());
        let rows = rows.iter().map(|row| self.plain_coefficients(row, "a flow"));
        let rows = rows.collect::<Result<Vec<_>, Error>>()?;
        let a = faer::Mat::from_fn(n, n, |i, j| rows[i].states[j]);
        let b = faer::Mat::from_fn(n, m, |i, j| rows[i].inputs[j]);
        let c = rows.iter().map(|row| row.constant.get(0).copied().unwrap_or(0.0));
        let c: Vec<f64> = c.collect();
        match kind {
            FlowKind::NextValues => LinearSystem::new(a, b, c),
            FlowKind::Rates => LinearSystem::zero_order_hold(a, b, c, self.time_step),
        }
    }

    /// The flow of the transition that stays in a mode, if it is stated.
    pub(super) fn stated_flow(&self, choice: usize, mode: &str) -> Option<LinearSystem> {
        let transitions = self.choices[choice].transitions.iter().enumerate();
        let stays = |modes: &Option<(String, String)>| {
            modes.as_ref().is_some_and(|(from, to)| from == mode && to == mode)
        };
        let mut found = transitions
            .filter(|(j, own)| stays(&own.modes) && !self.unstated.contains(&(choice, *j)));
        found.next().map(|(_, own)| own.flow.clone())
    }

    /// Sets the flow of a transition, and of the switches that take theirs from it.
    pub(super) fn set_flow(&mut self, choice: usize, number: usize, flow: LinearSystem) {
        let own = &mut self.choices[choice].transitions[number];
        own.flow = flow.clone();
        let stays = own.modes.clone().filter(|(from, to)| from == to);
        self.unstated.retain(|unstated| *unstated != (choice, number));
        let Some((mode, _)) = stays else { return };
        let transitions = &mut self.choices[choice].transitions;
        self.unstated.retain(|&(other, j)| {
            let enters = |modes: &(String, String)| modes.1 == mode;
            let follows = other == choice && transitions[j].modes.as_ref().is_some_and(enters);
            if follows {
                transitions[j].flow = flow.clone();
            }
            !follows
        });
    }

    /// A flow that leaves the state as it is.
    pub(super) fn idle(&self) -> Result<LinearSystem, Error> {
        let n = self.states.len();
        super::check::at_least_one("states", n)?;
        let b = faer::Mat::zeros(n, self.inputs.len());
        LinearSystem::new(faer::Mat::identity(n, n), b, vec![0.0; n])
    }
}
