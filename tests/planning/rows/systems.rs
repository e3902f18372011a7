//! Random hybrid systems in plain numbers, and runs through them.

use carom::hybrid::{HybridSystem, LinearSystem, Matrix, Schedule};
use carom::interval::Interval;
use carom_hybrid::internals::{Choice, Halfspace, Transition};
use proptest::prelude::*;

/// States lie within [-DOMAIN, DOMAIN].
pub(crate) const DOMAIN: f64 = 8.0;

/// A matrix, row by row.
type Rows = Vec<Vec<f64>>;

/// A transition in plain numbers.
#[derive(Debug, Clone)]
pub(crate) struct Way {
    pub(crate) a: Vec<Vec<f64>>,
    pub(crate) b: Vec<Vec<f64>>,
    pub(crate) c: Vec<f64>,
    /// Normals of states and inputs, and limits by step.
    pub(crate) guards: Vec<(Vec<f64>, Vec<f64>)>,
    pub(crate) prediction_guards: Vec<(Vec<f64>, Vec<f64>)>,
    /// The matrix, and offsets by step.
    pub(crate) reset: Option<(Rows, Rows)>,
    /// The range of the first input, if it is another.
    pub(crate) range: Option<(f64, f64)>,
    pub(crate) output: Option<(Vec<f64>, f64)>,
    pub(crate) modes: (usize, usize),
    pub(crate) is_event: bool,
}

/// A choice in plain numbers.
#[derive(Debug, Clone)]
pub(crate) struct Ways {
    pub(crate) ways: Vec<Way>,
    pub(crate) memory: bool,
    /// The least and the most samples in mode 1.
    pub(crate) dwell: Option<(usize, Option<usize>)>,
}

/// A system in plain numbers, with inputs within [-1, 1].
#[derive(Debug, Clone)]
pub(crate) struct Plain {
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    /// A, B, c.
    pub(crate) flow: (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<f64>),
    pub(crate) choices: Vec<Ways>,
    /// At every sample.
    pub(crate) limits: Vec<(Vec<f64>, Vec<f64>)>,
    pub(crate) most_events: Option<usize>,
}

/// A run in plain numbers.
#[derive(Debug, Clone, Default)]
pub(crate) struct PlainRun {
    pub(crate) states: Vec<Vec<f64>>,
    pub(crate) inputs: Vec<Vec<f64>>,
    /// By step and choice.
    pub(crate) taken: Vec<Vec<usize>>,
    pub(crate) output: Vec<f64>,
}

pub(crate) fn times(matrix: &[Vec<f64>], z: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(z).map(|(a, b)| a * b).sum()).collect()
}

pub(crate) fn plus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}

pub(crate) fn by_step<T>(values: &[T], step: usize) -> &T {
    &values[step.min(values.len() - 1)]
}

fn fly(flow: (&[Vec<f64>], &[Vec<f64>], &[f64]), x: &[f64], u: &[f64]) -> Vec<f64> {
    plus(&plus(&times(flow.0, x), &times(flow.1, u)), flow.2)
}

/// The largest excess over some limits.
fn excess(guards: &[(Vec<f64>, Vec<f64>)], z: &[f64], step: usize) -> f64 {
    let of = |(normal, limits): &(Vec<f64>, Vec<f64>)| {
        normal.iter().zip(z).map(|(a, b)| a * b).sum::<f64>() - by_step(limits, step)
    };
    guards.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
}

impl Way {
    pub(crate) fn prediction(&self, x: &[f64], u: &[f64]) -> Vec<f64> {
        fly((&self.a, &self.b, &self.c), x, u)
    }

    /// Where the transition leads alone.
    pub(crate) fn next(&self, x: &[f64], u: &[f64], step: usize) -> Vec<f64> {
        let y = self.prediction(x, u);
        match &self.reset {
            None => y,
            Some((matrix, offsets)) => plus(&times(matrix, &y), by_step::<Vec<f64>>(offsets, step)),
        }
    }

    /// By how much the guards are violated at most.
    pub(crate) fn violation(&self, x: &[f64], u: &[f64], step: usize) -> f64 {
        let z = [x, u].concat();
        let predicted = excess(&self.prediction_guards, &self.prediction(x, u), step);
        excess(&self.guards, &z, step).max(predicted)
    }

    pub(crate) fn output(&self, x: &[f64], u: &[f64]) -> f64 {
        let y = self.prediction(x, u);
        self.output.as_ref().map_or(0.0, |(factors, constant)| {
            factors.iter().zip(&y).map(|(a, b)| a * b).sum::<f64>() + constant
        })
    }
}

impl Plain {
    /// The next state under one transition per choice.
    pub(crate) fn next(&self, taken: &[usize], x: &[f64], u: &[f64], step: usize) -> Vec<f64> {
        let next = |c: usize| self.choices[c].ways[taken[c]].next(x, u, step);
        if self.choices.len() == 1 {
            return next(0);
        }
        let (a, b, c) = &self.flow;
        let common = fly((a, b, c), x, u);
        let mut sum = common.clone();
        for c in 0..self.choices.len() {
            for (sum, (own, common)) in sum.iter_mut().zip(next(c).iter().zip(&common)) {
                *sum += own - common;
            }
        }
        sum
    }

    /// The ranges in which the first input must lie: those of the choices that set one, or the
    /// usual one if none does.
    pub(crate) fn ranges(&self, taken: &[usize]) -> Vec<(f64, f64)> {
        let sets = |choice: &&Ways| choice.ways.iter().any(|way| way.range.is_some());
        let none = !self.choices.iter().any(|choice| sets(&choice));
        let pairs = self.choices.iter().zip(taken).filter(|(choice, _)| none || sets(choice));
        pairs.map(|(choice, &j)| choice.ways[j].range.unwrap_or((-1.0, 1.0))).collect()
    }

    /// By how much a step violates guards, ranges of inputs, domains and limits at most.
    pub(crate) fn violation(&self, taken: &[usize], x: &[f64], u: &[f64], step: usize) -> f64 {
        let ways = || taken.iter().enumerate().map(|(c, &j)| &self.choices[c].ways[j]);
        let own = ways().map(|way| way.violation(x, u, step)).fold(f64::NEG_INFINITY, f64::max);
        let mut ranges = f64::NEG_INFINITY;
        for (low, high) in self.ranges(taken) {
            ranges = ranges.max(low - u[0]).max(u[0] - high);
        }
        ranges = u.iter().skip(1).fold(ranges, |most, u| most.max(u.abs() - 1.0));
        let next = self.next(taken, x, u, step);
        own.max(ranges).max(self.outside(x, step)).max(self.outside(&next, step + 1))
    }

    /// By how much a sample violates domains and limits at most.
    pub(crate) fn outside(&self, x: &[f64], sample: usize) -> f64 {
        let domain = x.iter().map(|x| x.abs() - DOMAIN).fold(f64::NEG_INFINITY, f64::max);
        domain.max(excess(&self.limits, x, sample))
    }

    /// Whether a sequence of transitions respects modes, dwell times and the number of events.
    pub(crate) fn remembers(&self, taken: &[Vec<usize>]) -> bool {
        let mut events = 0;
        for (c, choice) in self.choices.iter().enumerate() {
            let ways: Vec<&Way> = taken.iter().map(|step| &choice.ways[step[c]]).collect();
            events += ways.iter().filter(|way| way.is_event).count();
            if !choice.memory {
                continue;
            }
            if ways.windows(2).any(|pair| pair[0].modes.1 != pair[1].modes.0) {
                return false;
            }
            let Some((least, most)) = choice.dwell else { continue };
            let mut modes: Vec<usize> = ways.iter().map(|way| way.modes.0).collect();
            modes.extend(ways.last().map(|way| way.modes.1));
            // Stays in mode 1, as the first and the last sample.
            let mut begin = 0;
            while begin < modes.len() {
                let end = (begin..modes.len()).find(|&t| modes[t] != modes[begin]);
                let last = end.unwrap_or(modes.len());
                if modes[begin] == 1 {
                    let length = last - begin;
                    if most.is_some_and(|most| length > most) {
                        return false;
                    }
                    if begin > 0 && end.is_some() && length < least {
                        return false;
                    }
                }
                begin = last;
            }
        }
        self.most_events.is_none_or(|most| events <= most)
    }

    /// All combinations of one transition per choice.
    pub(crate) fn combinations(&self) -> Vec<Vec<usize>> {
        self.choices.iter().fold(vec![Vec::new()], |all, choice| {
            let with = |before: &Vec<usize>| -> Vec<Vec<usize>> {
                (0..choice.ways.len()).map(|j| [&before[..], &[j]].concat()).collect()
            };
            all.iter().flat_map(with).collect()
        })
    }

    /// A run from a state: for each step a preferred combination and inputs. It ends where no
    /// combination is possible.
    pub(crate) fn run(&self, start: &[f64], wishes: &[(u8, Vec<f64>)]) -> PlainRun {
        let mut run = PlainRun { states: vec![start.to_vec()], ..PlainRun::default() };
        let all = self.combinations();
        for (t, (wish, input)) in wishes.iter().enumerate() {
            let (x, u) = (run.states[t].clone(), &input[..self.inputs]);
            let order = (0..all.len()).map(|k| &all[(k + usize::from(*wish)) % all.len()]);
            let found = order.into_iter().find(|taken| {
                let sequence = [&run.taken[..], &[(*taken).clone()]].concat();
                self.violation(taken, &x, u, t) <= 0.0 && self.remembers(&sequence)
            });
            let Some(taken) = found else { break };
            run.states.push(self.next(taken, &x, u, t));
            run.inputs.push(u.to_vec());
            let outputs = taken.iter().enumerate();
            run.output.push(outputs.map(|(c, &j)| self.choices[c].ways[j].output(&x, u)).sum());
            run.taken.push(taken.clone());
        }
        run
    }

    /// The same system in the crate's types.
    pub(crate) fn hybrid(&self) -> HybridSystem {
        let flow = |a: &[Vec<f64>], b: &[Vec<f64>], c: &[f64]| {
            let (a, b) = (matrix(a, self.states), matrix(b, self.inputs));
            LinearSystem::new(a, b, c.to_vec()).unwrap()
        };
        let halfspace = |name: &str, (normal, limits): &(Vec<f64>, Vec<f64>)| {
            Halfspace::new(name, normal.clone(), Schedule::from(limits.clone()))
        };
        let mut system = HybridSystem::new(1.0);
        for i in 0..self.states {
            system = system.with_state(format!("s{i}"), Interval::new(-DOMAIN, DOMAIN));
        }
        for j in 0..self.inputs {
            system = system.with_input(format!("u{j}"), Interval::new(-1.0, 1.0));
        }
        for limit in &self.limits {
            system = system.with_limit(halfspace("the limit", limit));
        }
        if self.choices.len() > 1 {
            let (a, b, c) = &self.flow;
            system = system.with_flow(flow(a, b, c));
        }
        if let Some(most) = self.most_events {
            system = system.with_most_events(most);
        }
        for (k, ways) in self.choices.iter().enumerate() {
            let mut choice = Choice::new(format!("choice {k}"));
            for (j, way) in ways.ways.iter().enumerate() {
                let name = format!("way {j}");
                let flow = flow(&way.a, &way.b, &way.c);
                let mut transition = match way.is_event {
                    true => Transition::event(name, flow),
                    false => Transition::new(name, flow),
                };
                for guard in &way.guards {
                    transition = transition.with_guard(halfspace("start", guard));
                }
                for guard in &way.prediction_guards {
                    transition = transition.with_prediction_guard(halfspace("end", guard));
                }
                if let Some((rows, offsets)) = &way.reset {
                    let rows = matrix(rows, self.states);
                    transition = transition.with_reset_by_step(rows, offsets.clone());
                }
                if let Some((low, high)) = way.range {
                    transition = transition.with_input_range("u0", Interval::new(low, high));
                }
                if let Some((factors, constant)) = &way.output {
                    transition = transition.with_output("out", factors.clone(), *constant);
                }
                if ways.memory {
                    let (from, to) = way.modes;
                    transition = transition.between(format!("m{from}"), format!("m{to}"));
                }
                choice = choice.with_transition(transition);
            }
            if let Some((least, most)) = ways.dwell.filter(|_| choice.modes().contains(&"m1")) {
                choice = choice.with_dwell("m1", least, most);
            }
            system = system.with_choice(choice);
        }
        system
    }
}

fn matrix(rows: &[Vec<f64>], columns: usize) -> Matrix {
    Matrix::from_fn(rows.len(), columns, |i, j| rows[i][j])
}

/// Entries of matrices: often 0 or 1.
fn entry() -> impl Strategy<Value = f64> {
    prop_oneof![3 => Just(0.0), 1 => Just(1.0), 1 => Just(0.5), 3 => -1.2..1.2_f64]
}

fn entries(rows: usize, columns: usize) -> impl Strategy<Value = Vec<Vec<f64>>> {
    prop::collection::vec(prop::collection::vec(entry(), columns), rows)
}

/// Up to two half-spaces, half of them with limits by step, some infinite.
fn halfspaces(width: usize) -> impl Strategy<Value = Vec<(Vec<f64>, Vec<f64>)>> {
    let limit = prop_oneof![6 => -1.0..5.0_f64, 1 => Just(f64::INFINITY), 2 => Just(0.0)];
    let limits =
        prop_oneof![prop::collection::vec(limit.clone(), 1), prop::collection::vec(limit, 1..=3)];
    prop::collection::vec((prop::collection::vec(entry(), width), limits), 0..=2)
}

type Base = (Vec<Vec<f64>>, Vec<Vec<f64>>, Vec<f64>);

fn flow(states: usize, inputs: usize) -> impl Strategy<Value = Base> {
    let vector = prop::collection::vec(prop_oneof![Just(0.0), -0.5..0.5_f64], states);
    (entries(states, states), entries(states, inputs), vector)
}

/// A transition that shares much with a base, as in real systems.
fn way(base: Base, states: usize, inputs: usize) -> impl Strategy<Value = Way> {
    let row = (0..states, prop::collection::vec(entry(), states), -0.5..0.5_f64);
    let change = prop_oneof![
        Just(base.clone()).boxed(),
        flow(states, inputs).boxed(),
        row.prop_map(move |(i, row, constant)| {
            let mut own = base.clone();
            own.0[i] = row;
            own.2[i] = constant;
            own
        })
        .boxed(),
    ];
    let offsets = prop::collection::vec(prop::collection::vec(-0.5..0.5_f64, states), 1..=2);
    (
        change,
        halfspaces(states + inputs),
        halfspaces(states),
        prop::option::weighted(0.4, (entries(states, states), offsets)),
        prop::option::weighted(0.3, (-2.0..-0.2_f64, 0.2..2.0_f64)),
        prop::option::weighted(0.3, (prop::collection::vec(entry(), states), -0.5..0.5_f64)),
        ((0..=2_usize), (0..=2_usize)),
        any::<bool>(),
    )
        .prop_map(
            |((a, b, c), guards, prediction_guards, reset, range, output, modes, event)| Way {
                a,
                b,
                c,
                guards,
                prediction_guards,
                reset,
                range,
                output,
                modes,
                is_event: event,
            },
        )
}

fn ways(base: Base, sizes: (usize, usize), most: usize) -> impl Strategy<Value = Ways> {
    let list = prop::collection::vec(way(base, sizes.0, sizes.1), 1..=most);
    let dwell = prop::option::of((1..=3_usize, prop::option::of(0..=2_usize)));
    (list, any::<bool>(), dwell).prop_map(|(ways, memory, dwell)| {
        let dwell = dwell.filter(|_| memory);
        let dwell = dwell.map(|(least, most)| (least, most.map(|more| least + more)));
        // Systems without modes have no dwell times.
        let named = ways.iter().any(|way| way.modes.0 == 1 || way.modes.1 == 1);
        Ways { ways, memory, dwell: dwell.filter(|_| named) }
    })
}

/// Systems of one to four states, one or two inputs, one or two choices, and up to `most`
/// transitions per choice.
pub(crate) fn plain(most: usize) -> impl Strategy<Value = Plain> {
    (1..=4_usize, 1..=2_usize).prop_flat_map(move |(states, inputs)| {
        flow(states, inputs).prop_flat_map(move |base| {
            let sizes = (states, inputs);
            let one = ways(base.clone(), sizes, most).prop_map(|ways| vec![ways]);
            let two = (ways(base.clone(), sizes, 3), ways(base.clone(), sizes, 2));
            let choices = prop_oneof![2 => one, 1 => two.prop_map(|(a, b)| vec![a, b])];
            let limits = prop::option::weighted(0.3, halfspaces(states));
            let events = prop::option::weighted(0.3, 0..=2_usize);
            (choices, limits, events, Just(base)).prop_map(
                move |(choices, limits, events, flow)| {
                    let limits = limits.unwrap_or_default();
                    Plain { states, inputs, flow, choices, limits, most_events: events }
                },
            )
        })
    })
}

/// For each step a preferred combination and inputs, some of them beyond the usual range.
pub(crate) fn wishes(steps: usize) -> impl Strategy<Value = Vec<(u8, Vec<f64>)>> {
    let input = prop_oneof![Just(-1.0), Just(1.0), Just(0.0), -1.0..1.0_f64, -2.0..2.0_f64];
    let step = (any::<u8>(), prop::collection::vec(input, 2));
    prop::collection::vec(step, 1..=steps)
}
