//! Random systems: runs satisfy the rows, integer points replay, and every method has the optimum
//! of an enumeration over transitions.

use carom::hybrid::HybridRun;
use carom::model::Method;
use carom::prelude::*;
use carom::solution::{Point, Verification};
use carom_hybrid::internals::SystemVariables;
use proptest::prelude::*;

use super::systems::{DOMAIN, Plain, PlainRun, by_step, plain, wishes};
use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/rows.txt";

pub(super) fn written(
    plain: &Plain,
    steps: usize,
    method: Option<Method>,
) -> (Model, SystemVariables) {
    let mut model = Model::new("random");
    let program = plain.hybrid().write_by(&mut model, "", steps, method).unwrap();
    (model, program)
}

/// A run in the crate's types.
fn named(plain: &Plain, run: &PlainRun) -> HybridRun {
    let mut named = HybridRun::default();
    for i in 0..plain.states {
        named.states.push((format!("s{i}"), run.states.iter().map(|x| x[i]).collect()));
    }
    for j in 0..plain.inputs {
        named.inputs.push((format!("u{j}"), run.inputs.iter().map(|u| u[j]).collect()));
    }
    for c in 0..plain.choices.len() {
        let taken = run.taken.iter().map(|taken| format!("way {}", taken[c])).collect();
        named.transitions.push((format!("choice {c}"), taken));
    }
    named
}

/// The run of a solution in plain numbers.
fn plain_run(plain: &Plain, run: &HybridRun) -> PlainRun {
    let steps = run.inputs[0].1.len();
    let at = |series: &[(String, Vec<f64>)], t: usize| series.iter().map(|(_, v)| v[t]).collect();
    let number = |name: &String| name.trim_start_matches("way ").parse::<usize>().unwrap();
    PlainRun {
        states: (0..=steps).map(|t| at(&run.states, t)).collect(),
        inputs: (0..steps).map(|t| at(&run.inputs, t)).collect(),
        taken: (0..steps)
            .map(|t| run.transitions.iter().map(|(_, names)| number(&names[t])).collect())
            .collect(),
        output: match plain.choices.iter().any(|c| c.ways.iter().any(|w| w.output.is_some())) {
            true => run.output("out").unwrap().to_vec(),
            false => Vec::new(),
        },
    }
}

/// Minimises a linear cost of the last state, all inputs and all transitions.
pub(super) fn set_cost(model: &mut Model, program: &SystemVariables, cost: &[f64]) -> Affine {
    let steps = program.horizon().steps();
    let mut total = Affine::zero();
    for (k, family) in program.states().iter().enumerate() {
        total.add_term(cost[k], family[steps]);
    }
    for (k, family) in program.inputs().iter().enumerate() {
        for t in 0..steps {
            total.add_term(cost[4 + k] / (1 + t) as f64, family[t]);
        }
    }
    model.minimize(total.clone()).unwrap();
    total
}

fn dot(factors: &[f64], of: &[Affine]) -> Affine {
    factors.iter().zip(of).map(|(a, e)| *a * e).sum()
}

/// A cost of the last state and of the inputs.
fn total_cost(x: &[Family], u: &[Family], cost: &[f64]) -> Affine {
    let mut total = Affine::zero();
    for (k, family) in x.iter().enumerate() {
        total.add_term(cost[k], family[family.len() - 1]);
    }
    for (k, family) in u.iter().enumerate() {
        for (t, input) in family.iter().enumerate() {
            total.add_term(cost[4 + k] / (1 + t) as f64, input);
        }
    }
    total
}

/// The least cost of a sequence of transitions, as a linear program of its own.
fn least_cost(plain: &Plain, taken: &[Vec<usize>], cost: &[f64]) -> Option<f64> {
    let steps = taken.len();
    let mut model = Model::new("sequence");
    let x: Vec<_> = (0..plain.states)
        .map(|i| model.continuous_family(&format!("x{i}"), steps + 1, -DOMAIN, DOMAIN).unwrap())
        .collect();
    let u: Vec<_> = (0..plain.inputs)
        .map(|j| model.continuous_family(&format!("u{j}"), steps, -2.0, 2.0).unwrap())
        .collect();
    let mut number = 0;
    let mut demand = |model: &mut Model, sum: Affine, equal: bool| {
        number += 1;
        if sum.terms().is_empty() {
            return if equal { sum.offset().abs() <= 1e-9 } else { sum.offset() <= 1e-9 };
        }
        let row = if equal { sum.equals(0.0) } else { sum.le(0.0) };
        model.add(("row", number), row).unwrap();
        true
    };
    for t in 0..=steps {
        let state: Vec<Affine> = x.iter().map(|family| family[t].into()).collect();
        for (normal, limits) in &plain.limits {
            let limit = *by_step(limits, t);
            if limit.is_finite() && !demand(&mut model, dot(normal, &state) - limit, false) {
                return None;
            }
        }
        if t == steps {
            continue;
        }
        let input: Vec<Affine> = u.iter().map(|family| family[t].into()).collect();
        let z = [&state[..], &input].concat();
        let ways: Vec<_> =
            taken[t].iter().enumerate().map(|(c, &j)| &plain.choices[c].ways[j]).collect();
        let fly = |a: &[Vec<f64>], b: &[Vec<f64>], c: &[f64]| -> Vec<Affine> {
            (0..plain.states).map(|i| dot(&a[i], &state) + dot(&b[i], &input) + c[i]).collect()
        };
        let common = fly(&plain.flow.0, &plain.flow.1, &plain.flow.2);
        let mut next =
            if ways.len() > 1 { common.clone() } else { vec![Affine::zero(); plain.states] };
        let mut possible = true;
        for way in &ways {
            let predicted = fly(&way.a, &way.b, &way.c);
            for (normal, limits) in &way.guards {
                let limit = *by_step(limits, t);
                if limit.is_finite() {
                    possible &= demand(&mut model, dot(normal, &z) - limit, false);
                }
            }
            for (normal, limits) in &way.prediction_guards {
                let limit = *by_step(limits, t);
                if limit.is_finite() {
                    possible &= demand(&mut model, dot(normal, &predicted) - limit, false);
                }
            }
            for i in 0..plain.states {
                let own = match &way.reset {
                    None => predicted[i].clone(),
                    Some((rows, offsets)) => dot(&rows[i], &predicted) + by_step(offsets, t)[i],
                };
                next[i] += if ways.len() > 1 { own - &common[i] } else { own };
            }
        }
        for (low, high) in plain.ranges(&taken[t]) {
            possible &= demand(&mut model, &input[0] - high, false);
            possible &= demand(&mut model, low - &input[0], false);
        }
        for (input, sign) in input.iter().skip(1).flat_map(|input| [(input, 1.0), (input, -1.0)]) {
            possible &= demand(&mut model, sign * input - 1.0, false);
        }
        for (i, next) in next.into_iter().enumerate() {
            possible &= demand(&mut model, x[i][t + 1] - next, true);
        }
        if !possible {
            return None;
        }
    }
    model.minimize(total_cost(&x, &u, cost)).unwrap();
    let solution = BranchAndBound::default().solve(&model).unwrap();
    assert!(solution.is_optimal() || solution.is_infeasible(), "{solution:?}");
    solution.objective()
}

/// The least cost over all sequences of transitions.
pub(super) fn enumerated(plain: &Plain, steps: usize, cost: &[f64]) -> Option<f64> {
    let mut sequences: Vec<Vec<Vec<usize>>> = vec![Vec::new()];
    for _ in 0..steps {
        let combinations = plain.combinations();
        let with = |before: &Vec<Vec<usize>>| -> Vec<Vec<Vec<usize>>> {
            combinations
                .iter()
                .map(|taken| [&before[..], std::slice::from_ref(taken)].concat())
                .collect()
        };
        sequences = sequences.iter().flat_map(with).collect();
    }
    sequences.retain(|taken| plain.remembers(taken));
    sequences.iter().filter_map(|taken| least_cost(plain, taken, cost)).reduce(f64::min)
}

proptest! {
    #![proptest_config(config(48, REGRESSIONS))]

    #[test]
    fn runs_satisfy_the_rows(
        plain in plain(5),
        start in prop::collection::vec(-3.0..3.0_f64, 4),
        wishes in wishes(5),
    ) {
        let run = plain.run(&start[..plain.states], &wishes);
        prop_assume!(!run.taken.is_empty() && plain.outside(&run.states[0], 0) <= 0.0);
        for method in [None, Some(Method::Hull)] {
            let (model, program) = written(&plain, run.taken.len(), method);
            let values = program.values(&named(&plain, &run)).unwrap();
            let mut point = vec![f64::NAN; model.variable_count()];
            values.iter().for_each(|(variable, value)| point[variable.index()] = *value);
            let point = Point::new(&model, point).unwrap();
            let verification = Verification::of(&model, &point, 1e-9);
            prop_assert!(verification.holds(), "{:?}\n{model}", verification.violations());
            let read = program.read_point(&point).unwrap();
            prop_assert_eq!(&read.states, &named(&plain, &run).states);
            prop_assert_eq!(&read.transitions, &named(&plain, &run).transitions);
            for (t, value) in plain_run(&plain, &read).output.iter().enumerate() {
                prop_assert!((value - run.output[t]).abs() <= 1e-9);
            }
        }
    }
}

proptest! {
    #![proptest_config(config(12, REGRESSIONS))]

    #[test]
    fn integer_points_replay(
        plain in plain(5),
        cost in prop::collection::vec(-1.0..1.0_f64, 6),
        steps in 1..=4_usize,
    ) {
        let (mut model, program) = written(&plain, steps, None);
        set_cost(&mut model, &program, &cost);
        let solution = BranchAndBound::default().solve(&model).unwrap();
        prop_assert!(solution.is_optimal() || solution.is_infeasible(), "{solution:?}\n{model}");
        prop_assume!(solution.is_optimal());
        let read = program.read(&solution).unwrap();
        let certificate = plain.hybrid().certify(&read);
        prop_assert!(certificate.is_ok(), "{certificate:?}");
        let run = plain_run(&plain, &read);
        prop_assert!(plain.remembers(&run.taken));
        for (t, taken) in run.taken.iter().enumerate() {
            let (x, u) = (&run.states[t], &run.inputs[t]);
            let next = plain.next(taken, x, u, t);
            for (own, replayed) in run.states[t + 1].iter().zip(&next) {
                prop_assert!((own - replayed).abs() <= 1e-6, "step {t}: {own} {replayed}");
            }
            let violation = plain.violation(taken, x, u, t);
            prop_assert!(violation <= 2e-6, "step {t}: {violation}\n{model}");
            if let Some(output) = run.output.get(t) {
                let ways = taken.iter().enumerate().map(|(c, &j)| &plain.choices[c].ways[j]);
                let expected: f64 = ways.map(|way| way.output(x, u)).sum();
                prop_assert!((output - expected).abs() <= 1e-5);
            }
        }
    }

    #[test]
    fn every_method_has_the_optimum_of_an_enumeration(
        plain in plain(3),
        cost in prop::collection::vec(-1.0..1.0_f64, 6),
    ) {
        let expected = enumerated(&plain, 2, &cost);
        for method in [None, Some(Method::BigM), Some(Method::MultiM), Some(Method::Hull)] {
            let (mut model, program) = written(&plain, 2, method);
            set_cost(&mut model, &program, &cost);
            let solution = BranchAndBound::default().solve(&model).unwrap();
            let found = solution.objective();
            match (expected, found) {
                (None, None) => prop_assert!(solution.is_infeasible()),
                (Some(expected), Some(found)) => {
                    prop_assert!(solution.is_optimal());
                    prop_assert!((expected - found).abs() <= 1e-5, "{method:?}: {expected} {found}");
                }
                _ => prop_assert!(false, "{method:?}: {expected:?} {found:?}\n{model}"),
            }
        }
    }
}

/// Three transitions, one of which has its next state from a reset and its input from a guard: the
/// guard must stay, although the change of the state in it is the same as in the others.
#[test]
fn a_guard_from_which_a_change_follows_is_stated() -> Result<(), Error> {
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", -4.0, 4.0)?;
    let u = system.input("u", -1.0, 1.0)?;
    system.mode("hold")?.next([x.is(x + u)])?.guard(u.equals(0.0))?.reset([x.is(0.0)])?;
    for (name, value) in [("slow", 0.5), ("fast", 1.0)] {
        system.mode(name)?.next([x.is(u)])?.guard(u.equals(value))?;
    }
    let hold = system.transition_named("mode", "hold")?;
    let mut program = system.program(2)?;
    program.start([x.equals(0.0)])?;
    program.add("held", program.at(Affine::from(hold).equals(1.0), 1)?)?;
    program.maximize(program.end(x)?)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    assert_eq!((plan.value(x, 2)?, plan.value(u, 1)?), (0.0, 0.0));
    Ok(())
}
