//! Systems in plain numbers, and random ones.

use proptest::prelude::*;

/// An affine function of states or predictions, inputs and two series.
#[derive(Debug, Clone)]
pub(super) struct Line {
    pub(super) states: Vec<f64>,
    pub(super) inputs: Vec<f64>,
    pub(super) series: [f64; 2],
    pub(super) constant: f64,
}

/// `lower <= line <= upper`, with one of the ends or both.
#[derive(Debug, Clone)]
pub(super) struct Compared {
    pub(super) line: Line,
    pub(super) kind: usize,
    pub(super) right: f64,
    pub(super) width: f64,
}

/// The rows of a flow or a reset that are stated, by state.
pub(super) type Rows = Vec<Option<Line>>;

#[derive(Debug, Clone)]
pub(super) struct Way {
    pub(super) flow: Option<Rows>,
    pub(super) guards: Vec<Compared>,
    pub(super) limit: Option<Compared>,
    pub(super) predicted: Option<Compared>,
    pub(super) reset: Option<Rows>,
    /// Whether it is of the start of the step.
    pub(super) output: Option<(bool, Line)>,
    pub(super) is_event: bool,
}

/// A system in plain numbers, all of them quarters.
#[derive(Debug, Clone)]
pub(super) struct Plain {
    pub(super) states: usize,
    /// Lower and upper ends by step.
    pub(super) inputs: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) series: [Vec<f64>; 2],
    pub(super) is_by_rates: bool,
    pub(super) common: Option<Rows>,
    pub(super) limits: Vec<(bool, Compared)>,
    /// By choice; four ways of a choice with memory stay and switch.
    pub(super) choices: Vec<Vec<Way>>,
    pub(super) has_memory: bool,
    pub(super) dwell: (usize, Option<usize>),
    pub(super) most_events: Option<usize>,
    pub(super) disturbance: Option<(usize, f64)>,
    pub(super) is_free: bool,
}

pub(super) const TIME_STEP: f64 = 0.5;
pub(super) const DOMAIN: f64 = 8.0;
/// The name of rows that have none.
pub(super) const UNNAMED: &str = "row";

fn quarter() -> impl Strategy<Value = f64> {
    (-8..=8_i32).prop_map(|k| f64::from(k) / 4.0)
}

/// Often 0.
fn factor() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(0.0), 3 => quarter()]
}

/// Without series.
fn flow_line(states: usize, inputs: usize) -> impl Strategy<Value = Line> {
    let factors = |n: usize| prop::collection::vec(factor(), n);
    (factors(states), factors(inputs), quarter()).prop_map(|(states, inputs, constant)| Line {
        states,
        inputs,
        series: [0.0; 2],
        constant,
    })
}

fn line(states: usize, inputs: usize) -> impl Strategy<Value = Line> {
    (flow_line(states, inputs), [factor(), factor()])
        .prop_map(|(line, series)| Line { series, ..line })
}

/// A row that is not empty.
fn compared(states: usize, inputs: usize) -> impl Strategy<Value = Compared> {
    (line(states, inputs), 0..4_usize, quarter(), 0..8_i32).prop_map(
        |(mut line, kind, right, width)| {
            if line.states.iter().chain(&line.inputs).all(|a| *a == 0.0) {
                line.states[0] = 1.0;
            }
            Compared { line, kind, right, width: f64::from(width) / 4.0 }
        },
    )
}

fn rows(line: impl Strategy<Value = Line>, states: usize) -> impl Strategy<Value = Rows> {
    prop::collection::vec(prop::option::of(line), states)
}

fn way(states: usize, inputs: usize) -> impl Strategy<Value = Way> {
    (
        prop::option::weighted(0.7, rows(flow_line(states, inputs), states)),
        prop::collection::vec(compared(states, inputs), 0..3),
        prop::option::of(compared(states, inputs)),
        prop::option::of(compared(states, 0)),
        prop::option::of(rows(line(states, 0), states)),
        prop::option::of((any::<bool>(), line(states, inputs))),
        any::<bool>(),
    )
        .prop_map(|(flow, guards, limit, predicted, reset, output, is_event)| Way {
            flow,
            guards,
            limit,
            predicted,
            reset,
            output,
            is_event,
        })
}

pub(super) fn plain() -> impl Strategy<Value = Plain> {
    let ends = || {
        let end = |sign: f64| {
            prop::collection::vec((0..=8_i32).prop_map(move |k| sign * f64::from(k) / 4.0), 1..4)
        };
        (end(-1.0), end(1.0))
    };
    let series = || prop::collection::vec(quarter(), 1..5);
    (1..=3_usize, 0..=2_usize).prop_flat_map(move |(n, m)| {
        let kinds = (any::<bool>(), prop::option::of(rows(flow_line(n, m), n)), any::<bool>());
        let numbers = (
            (1..3_usize, prop::option::of(3..5_usize)),
            prop::option::of(0..4_usize),
            prop::option::of((0..n, quarter())),
            any::<bool>(),
        );
        let limits = prop::collection::vec((any::<bool>(), compared(n, m)), 0..3);
        let choices = prop::collection::vec(prop::collection::vec(way(n, m), 1..5), 1..3);
        let inputs = prop::collection::vec(ends(), m);
        (kinds, numbers, limits, choices, inputs, [series(), series()]).prop_map(
            move |(kinds, numbers, limits, mut choices, inputs, series)| {
                let (is_by_rates, common, memory) = kinds;
                let (dwell, most_events, disturbance, is_free) = numbers;
                if common.is_none() {
                    choices.truncate(1);
                }
                // A guard on the prediction of what another choice may change is refused.
                let changes = |ways: &Vec<Way>| ways.iter().any(|way| way.flow.is_some());
                let changes: Vec<bool> = choices.iter().map(changes).collect();
                for (c, ways) in choices.iter_mut().enumerate() {
                    let mut others = changes.iter().enumerate().filter(|(k, _)| *k != c);
                    if others.any(|(_, changes)| *changes) {
                        ways.iter_mut().for_each(|way| way.predicted = None);
                    }
                }
                let has_memory = memory && choices[0].len() == 4;
                Plain {
                    states: n,
                    inputs,
                    series,
                    is_by_rates,
                    common,
                    limits,
                    choices,
                    has_memory,
                    dwell,
                    most_events,
                    disturbance,
                    is_free,
                }
            },
        )
    })
}
