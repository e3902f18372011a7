//! Random hybrid systems, stated through the crate's own types, and random runs through them.

use carom::hybrid::{HybridSystem, LinearSystem, Matrix, SimulationOptions};
use carom::interval::Interval;
use carom_hybrid::internals::HasParts;
use carom_hybrid::internals::{Choice, Halfspace, Transition};
use proptest::prelude::*;

/// A transition in numbers: matrices row by row for the largest sizes.
#[derive(Debug, Clone)]
pub(crate) struct Raw {
    a: Vec<f64>,
    b: Vec<f64>,
    c: Vec<f64>,
    guard: Option<(Vec<f64>, f64, bool)>,
    after: Option<(Vec<f64>, f64)>,
    reset: Option<(Vec<f64>, Vec<f64>)>,
    range: Option<(f64, f64)>,
    modes: (usize, usize),
    is_event: bool,
}

/// Transitions, whether they have memory, and a dwell time.
type RawChoice = (Vec<Raw>, bool, Option<(usize, usize)>);

/// A system in numbers.
#[derive(Debug, Clone)]
pub(crate) struct RawSystem {
    states: usize,
    inputs: usize,
    choices: Vec<RawChoice>,
    most_events: Option<usize>,
    limit: Option<(Vec<f64>, Vec<f64>)>,
}

/// A run: the start, and for each step the inputs and a wish for each choice.
pub(crate) type Wishes = (Vec<f64>, Vec<(Vec<f64>, Vec<usize>)>);

fn factor() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(0.0), 1 => Just(1.0), 2 => -1.0..1.0_f64]
}

fn raw() -> impl Strategy<Value = Raw> {
    let list = |count| prop::collection::vec(factor(), count);
    let small = |count| prop::collection::vec(-0.5..0.5_f64, count);
    (
        (list(9), list(6), small(3)),
        prop::option::of((list(5), 0.0..4.0_f64, any::<bool>())),
        prop::option::of((list(3), 0.0..4.0_f64)),
        prop::option::of((list(9), small(3))),
        prop::option::of((-2.0..0.0_f64, 0.0..2.0_f64)),
        (0..2_usize, 0..2_usize),
        any::<bool>(),
    )
        .prop_map(|((a, b, c), guard, after, reset, range, modes, is_event)| Raw {
            a,
            b,
            c,
            guard,
            after,
            reset,
            range,
            modes,
            is_event,
        })
}

/// Systems of one to three states, one or two inputs, one or two choices with and without memory.
pub(crate) fn system() -> impl Strategy<Value = RawSystem> {
    let dwell = prop::option::of((1..3_usize, 0..3_usize));
    let choice = (prop::collection::vec(raw(), 1..=4), any::<bool>(), dwell);
    let limit = prop::option::of((
        prop::collection::vec(factor(), 3),
        prop::collection::vec(3.0..9.0_f64, 1..3),
    ));
    (
        1..=3_usize,
        1..=2_usize,
        prop::collection::vec(choice, 1..=2),
        prop::option::of(0..4_usize),
        limit,
    )
        .prop_map(|(states, inputs, choices, most_events, limit)| RawSystem {
            states,
            inputs,
            choices,
            most_events,
            limit,
        })
}

pub(crate) fn wishes() -> impl Strategy<Value = Wishes> {
    let input = prop_oneof![Just(-1.0), Just(1.0), -1.0..1.0_f64, -1.0..1.0_f64];
    let step = (prop::collection::vec(input, 2), prop::collection::vec(0..4_usize, 2));
    (prop::collection::vec(-2.0..2.0_f64, 3), prop::collection::vec(step, 1..8))
}

fn matrix(rows: usize, columns: usize, entries: &[f64]) -> Matrix {
    Matrix::from_fn(rows, columns, |i, j| entries[(i * 3 + j) % entries.len()])
}

impl RawSystem {
    pub(crate) fn hybrid(&self) -> HybridSystem {
        let (n, m) = (self.states, self.inputs);
        let mut system = HybridSystem::new(0.5);
        for i in 0..n {
            system = system.with_state(format!("s{i}"), Interval::new(-10.0, 10.0));
        }
        for j in 0..m {
            system = system.with_input(format!("u{j}"), Interval::new(-1.0, 1.0));
        }
        if let Some((normal, limits)) = &self.limit {
            system = system.with_limit(Halfspace::new("limit", &normal[..n], limits.clone()));
        }
        if let Some(most) = self.most_events {
            system = system.with_most_events(most);
        }
        let common = &self.choices[0].0[0];
        let flow = |raw: &Raw| {
            LinearSystem::new(matrix(n, n, &raw.a), matrix(n, m, &raw.b), &raw.c[..n]).unwrap()
        };
        system = system.with_flow(flow(common));
        for (k, (transitions, has_memory, dwell)) in self.choices.iter().enumerate() {
            let mut choice = Choice::new(format!("choice {k}"));
            for (t, raw) in transitions.iter().enumerate() {
                let transition = raw.transition(&format!("t{t}"), flow(raw), n, m, *has_memory);
                choice = choice.with_transition(transition);
            }
            let mode = choice.modes().first().map(|mode| (*mode).to_owned());
            if let (Some(mode), Some((least, more))) = (mode, dwell) {
                let most = (*more < 2).then_some(least + more + 1);
                choice = choice.with_dwell(mode, *least, most);
            }
            system = system.with_choice(choice);
        }
        system
    }

    /// The first entries of a start and of inputs, as many as the system has.
    pub(crate) fn cut(&self, (start, steps): &Wishes) -> (Vec<f64>, Vec<Vec<f64>>) {
        let inputs = steps.iter().map(|(input, _)| input[..self.inputs].to_vec());
        (start[..self.states].to_vec(), inputs.collect())
    }
}

impl Raw {
    fn transition(
        &self,
        name: &str,
        flow: LinearSystem,
        n: usize,
        m: usize,
        has_memory: bool,
    ) -> Transition {
        let mut transition = match self.is_event {
            true => Transition::event(name, flow),
            false => Transition::new(name, flow),
        };
        if let Some((normal, limit, is_joint)) = &self.guard {
            let normal = &normal[..if *is_joint { n + m } else { n }];
            transition = transition.with_guard(Halfspace::new("guard", normal, *limit));
        }
        if let Some((normal, limit)) = &self.after {
            let guard = Halfspace::new("after", &normal[..n], *limit);
            transition = transition.with_prediction_guard(guard);
            transition = transition.with_output("out", &normal[..n], 0.5);
        }
        if let Some((rows, offset)) = &self.reset {
            transition = transition.with_reset(matrix(n, n, rows), &offset[..n]);
        }
        if let Some((low, high)) = self.range {
            transition = transition.with_input_range("u0", Interval::new(low, high));
        }
        if has_memory {
            let name = |mode: usize| ["a", "b"][mode];
            transition = transition.between(name(self.modes.0), name(self.modes.1));
        }
        transition
    }
}

/// Options that take a step's wishes where they are possible, found by trying.
pub(crate) fn follow_wishes(
    system: &HybridSystem,
    start: &[f64],
    inputs: &[Vec<f64>],
    wishes: &Wishes,
) -> SimulationOptions {
    let mut plan: Vec<Vec<String>> = Vec::new();
    let first = SimulationOptions::default().with_first_possible(true);
    let options = |plan: &[Vec<String>]| first.clone().with_transitions(plan.to_vec());
    for (t, (_, wish)) in wishes.1.iter().enumerate() {
        let names = system
            .parts()
            .choices
            .iter()
            .zip(wish)
            .map(|(choice, &k)| choice.transitions[k % choice.transitions.len()].name.clone());
        plan.push(names.collect());
        let run = system.simulate_with(start, &inputs[..=t], &options(&plan)).unwrap();
        if !run.is_complete() {
            plan.pop();
            let run = system.simulate_with(start, &inputs[..=t], &options(&plan)).unwrap();
            match run.taken().last() {
                Some(taken) if run.is_complete() => plan.push(taken.clone()),
                _ => break,
            }
        }
    }
    options(&plan)
}
