//! Series in flows: each becomes an input that has one value in each step, because flows are linear
//! in states and inputs, and all that knows inputs then knows it.

use super::HybridSystem;
use super::handles::Meaning;
use super::schedule::Schedule;
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;
use crate::model::{Affine, Nonlinear, Variable};

impl HybridSystem {
    /// The row with an input in the place of each series that varies.
    pub(super) fn with_series_as_inputs(
        &mut self,
        row: &Nonlinear,
        place: &str,
    ) -> Result<Nonlinear, Error> {
        row.try_map(&mut |own: &Affine| self.with_series_as_input(own, place))
    }

    fn with_series_as_input(&mut self, row: &Affine, place: &str) -> Result<Affine, Error> {
        let mut changed = Affine::constant(row.offset());
        for (variable, factor) in row.terms() {
            let input = match self.meaning(variable, place)?.clone() {
                Meaning::Series(name, values) if !values.is_constant() => {
                    self.series_input(name, &values)
                }
                _ => variable,
            };
            changed.add_term(factor, input);
        }
        Ok(changed)
    }

    /// The input of a series, which is declared if there is none.
    fn series_input(&mut self, name: String, values: &Schedule<f64>) -> Variable {
        let known = self.inputs.iter().position(|(own, _)| *own == name);
        let number = known.unwrap_or_else(|| {
            self.add_idle_input();
            let points: Vec<Interval> = values.values().map(|v| Interval::point(*v)).collect();
            self.inputs.push((name, points.into()));
            self.inputs.len() - 1
        });
        self.handles.of(Meaning::Input(number))
    }

    /// Gives all that is stated of inputs a coefficient 0 of one more.
    pub(super) fn add_idle_input(&mut self) {
        let with_inputs = self.states.len() + self.inputs.len();
        let has_inputs = !self.inputs.is_empty();
        let widen = |factors: &mut Vec<f64>| {
            if has_inputs && factors.len() == with_inputs {
                factors.push(0.0);
            }
        };
        let transitions = self.choices.iter_mut().flat_map(|choice| &mut choice.transitions);
        for transition in transitions {
            widen_flow(&mut transition.flow);
            transition.guards.iter_mut().for_each(|guard| widen(&mut guard.normal));
            let norms = transition.norms.iter_mut();
            norms.flat_map(|norm| norm.parts_mut()).for_each(|part| widen(&mut part.factors));
            let outputs = transition.outputs.iter_mut().filter(|output| output.is_at_start);
            outputs.for_each(|output| widen(&mut output.factors));
        }
        self.flow.iter_mut().for_each(widen_flow);
        self.functions.add_idle_input();
        self.limits.iter_mut().for_each(|limit| widen(&mut limit.normal));
        let norms = self.norms.iter_mut().flat_map(|norm| norm.parts_mut());
        norms.for_each(|part| widen(&mut part.factors));
    }
}

fn widen_flow(flow: &mut LinearSystem) {
    *flow = flow.with_idle_input();
}
