//! Random hybrid systems, and runs through them in plain numbers.

use carom::hybrid::{HybridSystem, LinearSystem, Matrix};
use carom::interval::Interval;
use carom_hybrid::internals::{Halfspace, Transition};
use proptest::prelude::*;

/// A transition in plain numbers.
#[derive(Debug, Clone)]
pub(crate) struct Mode {
    pub(crate) a: Vec<Vec<f64>>,
    pub(crate) b: Vec<Vec<f64>>,
    pub(crate) c: Vec<f64>,
    pub(crate) guards: Vec<(Vec<f64>, f64)>,
    pub(crate) prediction_guards: Vec<(Vec<f64>, f64)>,
    pub(crate) reset: Option<(Vec<Vec<f64>>, Vec<f64>)>,
    pub(crate) is_event: bool,
}

/// A system in plain numbers: states within [-DOMAIN, DOMAIN], inputs within [-1, 1].
#[derive(Debug, Clone)]
pub(crate) struct System {
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    pub(crate) modes: Vec<Mode>,
}

pub(crate) const DOMAIN: f64 = 20.0;

/// One step of a run.
#[derive(Debug, Clone)]
pub(crate) struct Step {
    pub(crate) mode: usize,
    pub(crate) prediction: Vec<f64>,
    pub(crate) next: Vec<f64>,
}

fn times(matrix: &[Vec<f64>], z: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(z).map(|(a, b)| a * b).sum()).collect()
}

fn keeps(guards: &[(Vec<f64>, f64)], z: &[f64]) -> bool {
    guards.iter().all(|(n, limit)| n.iter().zip(z).map(|(a, b)| a * b).sum::<f64>() <= *limit)
}

impl Mode {
    /// The step from a state, if this mode allows it.
    pub(crate) fn step(&self, number: usize, state: &[f64], input: &[f64]) -> Option<Step> {
        let flown = times(&self.a, state);
        let pushed = times(&self.b, input);
        let sum = flown.iter().zip(&pushed).zip(&self.c).map(|((x, u), c)| x + u + c);
        let prediction: Vec<f64> = sum.collect();
        let next = match &self.reset {
            Some((matrix, offset)) => {
                times(matrix, &prediction).iter().zip(offset).map(|(x, r)| x + r).collect()
            }
            None => prediction.clone(),
        };
        let inside = next.iter().all(|x: &f64| x.abs() <= DOMAIN);
        let allowed =
            keeps(&self.guards, state) && keeps(&self.prediction_guards, &prediction) && inside;
        allowed.then_some(Step { mode: number, prediction, next })
    }
}

impl System {
    pub(crate) fn hybrid(&self) -> HybridSystem {
        let mut system = HybridSystem::new(1.0);
        for i in 0..self.states {
            system = system.with_state(format!("s{i}"), Interval::new(-DOMAIN, DOMAIN));
        }
        for j in 0..self.inputs {
            system = system.with_input(format!("u{j}"), Interval::new(-1.0, 1.0));
        }
        let matrix =
            |rows: &[Vec<f64>], columns| Matrix::from_fn(rows.len(), columns, |i, j| rows[i][j]);
        for (m, mode) in self.modes.iter().enumerate() {
            let (a, b) = (matrix(&mode.a, self.states), matrix(&mode.b, self.inputs));
            let flow = LinearSystem::new(a, b, mode.c.clone()).unwrap();
            let mut transition = match mode.is_event {
                true => Transition::event(format!("event {m}"), flow),
                false => Transition::new(format!("mode {m}"), flow),
            };
            for (normal, limit) in &mode.guards {
                transition = transition.with_guard(Halfspace::new("guard", normal.clone(), *limit));
            }
            for (normal, limit) in &mode.prediction_guards {
                let guard = Halfspace::new("prediction", normal.clone(), *limit);
                transition = transition.with_prediction_guard(guard);
            }
            if let Some((rows, offset)) = &mode.reset {
                transition = transition.with_reset(matrix(rows, self.states), offset.clone());
            }
            system = system.with_transition(transition);
        }
        system
    }

    /// A run from a state: for each step, two choices decide on the mode and the inputs.
    pub(crate) fn run(&self, start: &[f64], choices: &[(u8, Vec<f64>)]) -> Vec<Step> {
        let mut state = start.to_vec();
        let mut run = Vec::new();
        for (mode, input) in choices {
            let count = self.modes.len();
            let order = (0..count).map(|k| (k + usize::from(*mode)) % count);
            let step = order
                .into_iter()
                .find_map(|m| self.modes[m].step(m, &state, &input[..self.inputs]));
            let Some(step) = step else { break };
            state.clone_from(&step.next);
            run.push(step);
        }
        run
    }
}

/// Entries of flows: often 0 (so that blocks come apart), 1 or small.
fn entry() -> impl Strategy<Value = f64> {
    prop_oneof![3 => Just(0.0), 1 => Just(1.0), 3 => -1.2..1.2_f64]
}

fn matrix(rows: usize, columns: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(entry(), columns), rows)
}

fn guards(states: usize) -> impl Strategy<Value = Vec<(Vec<f64>, f64)>> {
    let guard = (prop::collection::vec(entry(), states), -1.0..6.0_f64);
    prop::collection::vec(guard, 0..2)
}

fn mode(states: usize, inputs: usize) -> impl Strategy<Value = Mode> {
    let vector = prop::collection::vec(-0.5..0.5_f64, states);
    let reset = prop::option::of((matrix(states, states), vector.clone()));
    (
        matrix(states, states),
        matrix(states, inputs),
        vector,
        guards(states),
        guards(states),
        reset,
        any::<bool>(),
    )
        .prop_map(|(a, b, c, guards, prediction_guards, reset, is_event)| Mode {
            a,
            b,
            c,
            guards,
            prediction_guards,
            reset,
            is_event,
        })
}

/// Systems of one to four states, one or two inputs and one to three modes.
pub(crate) fn system() -> impl Strategy<Value = System> {
    (1..=4_usize, 1..=2_usize).prop_flat_map(|(states, inputs)| {
        prop::collection::vec(mode(states, inputs), 1..=3).prop_map(move |modes| System {
            states,
            inputs,
            modes,
        })
    })
}

/// Inputs, at their limits half of the time.
pub(crate) fn choices(steps: usize) -> impl Strategy<Value = Vec<(u8, Vec<f64>)>> {
    let input = prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0_f64, -1.0..1.0_f64];
    let step = (any::<u8>(), prop::collection::vec(input, 2));
    prop::collection::vec(step, 1..=steps)
}
