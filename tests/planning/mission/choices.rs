//! Random missions on systems with a free input, compared with a linear program for each sequence
//! of modes and each choice of what makes the mission true.

use std::collections::BTreeSet;

use carom::prelude::*;
use proptest::{prop_assert, prop_assume, proptest};

use super::sketch::{Quantity, Sketch, SketchRow, sketches};
use super::systems::{Handles, Sample};
use crate::common::config;

const MOST_TERMS: usize = 40;
const LEAST: f64 = -90.0;

/// Half of a row at a sample: the quantity, whether it is the lower end, its double, and whether it
/// holds.
type Atom = (usize, u8, bool, i32, bool);
type Term = BTreeSet<Atom>;

fn code(of: Quantity) -> u8 {
    match of {
        Quantity::X | Quantity::Y => 1,
        Quantity::Both => 2,
        _ => 0,
    }
}

/// The terms of which one must hold; `None` if they are too many.
fn any(parts: impl IntoIterator<Item = Option<Vec<Term>>>) -> Option<Vec<Term>> {
    let mut all: Vec<Term> = Vec::new();
    for term in parts.into_iter().collect::<Option<Vec<_>>>()?.into_iter().flatten() {
        if !all.iter().any(|known| known.is_subset(&term)) {
            all.retain(|known| !term.is_subset(known));
            all.push(term);
        }
    }
    (all.len() <= MOST_TERMS).then_some(all)
}

fn all(parts: impl IntoIterator<Item = Option<Vec<Term>>>) -> Option<Vec<Term>> {
    parts.into_iter().try_fold(vec![Term::new()], |so_far, part| {
        let part = part?;
        let both = so_far.iter().flat_map(|a| part.iter().map(move |b| a | b));
        any(both.map(|term| Some(vec![term])))
    })
}

fn join(is_all: bool, parts: Vec<Option<Vec<Term>>>) -> Option<Vec<Term>> {
    if is_all { all(parts) } else { any(parts) }
}

fn leaf(rows: &[SketchRow], k: usize, run: &[Sample], positive: bool) -> Option<Vec<Term>> {
    let mut parts = Vec::new();
    for row in rows {
        if matches!(row.of, Quantity::Input) && k + 1 == run.len() {
            return Some(Vec::new());
        }
        for (is_lower, end) in [(true, row.lower), (false, row.upper)] {
            if end.is_finite() {
                let atom = (k, code(row.of), is_lower, (2.0 * end) as i32, positive);
                parts.push(Some(vec![Term::from([atom])]));
            }
        }
    }
    join(positive, parts)
}

/// What must hold for a mission, or its negation, at a sample.
fn terms(of: &Sketch, k: usize, run: &[Sample], positive: bool) -> Option<Vec<Term>> {
    if k >= run.len() {
        return Some(Vec::new());
    }
    let at = |of: &Sketch, k: usize| terms(of, k, run, positive);
    match of {
        Sketch::Rows(rows) => leaf(rows, k, run, positive),
        Sketch::Early(rows) => match rows.get(k) {
            Some(row) => leaf(&[*row], k, run, positive),
            None => Some(Vec::new()),
        },
        Sketch::Not(a) => terms(a, k, run, !positive),
        Sketch::All(of) => join(positive, of.iter().map(|part| at(part, k)).collect()),
        Sketch::Any(of) => join(!positive, of.iter().map(|part| at(part, k)).collect()),
        Sketch::Always(w, a) | Sketch::Eventually(w, a) => {
            let is_all = matches!(of, Sketch::Always(..)) == positive;
            let (samples, is_cut) = w.samples(k, run, &[a]);
            match is_all && is_cut {
                true => Some(Vec::new()),
                false => join(is_all, samples.map(|t| at(a, t)).collect()),
            }
        }
        Sketch::Until(w, a, b) | Sketch::Release(w, a, b) => {
            let is_until = matches!(of, Sketch::Until(..)) == positive;
            let (samples, is_cut) = w.samples(k, run, &[a, b]);
            let before = |t: usize| join(is_until, (k..t).map(|s| at(a, s)).collect());
            let mut parts: Vec<_> =
                samples.map(|t| join(is_until, vec![at(b, t), before(t)])).collect();
            if is_cut && !is_until {
                parts.push(before(run.len()));
            }
            join(!is_until, parts)
        }
    }
}

/// The greatest margin of a term where the pushes are known; `None` if no run has the least one.
fn margin(start: f64, pushes: &[f64], domain: f64, term: &Term) -> Option<f64> {
    let mut model = Model::new("term");
    let margin = model.continuous("margin", LEAST, 90.0).unwrap();
    let inputs = model.continuous_family("u", pushes.len(), -1.0, 1.0).unwrap();
    let mut x = vec![Affine::constant(start)];
    for (k, push) in pushes.iter().enumerate() {
        x.push(x[k].clone() + inputs[k] + *push);
        model.add(("domain", k), x[k + 1].within(-domain, domain)).unwrap();
    }
    for (number, &(k, code, is_lower, end, positive)) in term.iter().enumerate() {
        let value = match code {
            0 => Affine::from(inputs[k]),
            code => f64::from(code) * x[k].clone(),
        };
        let slack = (value - f64::from(end) / 2.0) * if is_lower == positive { 1.0 } else { -1.0 };
        model.add(("atom", number), (slack - margin).ge(0.0)).unwrap();
    }
    model.maximize(margin).unwrap();
    BranchAndBound::default().solve(&model).unwrap().objective()
}

fn greatest(start: f64, modes: &[f64], steps: usize, domain: f64, terms: &[Term]) -> Option<f64> {
    let sequences = (0..modes.len().pow(steps as u32)).map(|code| {
        let mode = |k: usize| modes[code / modes.len().pow(k as u32) % modes.len()];
        (0..steps).map(mode).collect::<Vec<f64>>()
    });
    let of = |pushes: Vec<f64>| terms.iter().filter_map(move |t| margin(start, &pushes, domain, t));
    sequences.flat_map(of).reduce(f64::max)
}

proptest! {
    #![proptest_config(config(60, "tests/regressions/mission.txt"))]

    #[test]
    fn margins_are_those_of_the_best_choice(
        sketch in sketches(false), start in -3_i32..=3, wanted in 1_usize..=12,
        modes in proptest::collection::vec(-2_i32..=2, 1..=2), is_tight in proptest::bool::ANY,
    ) {
        prop_assume!(!sketch.has_empty_window());
        let (start, domain) = (f64::from(start), if is_tight { 4.0 } else { 40.0 });
        let modes: Vec<f64> = modes.into_iter().map(f64::from).collect();
        let steps = if modes.len() == 1 { wanted } else { wanted.min(3) };
        let mut system = HybridSystem::new(0.5);
        let x = system.state("x", -domain, domain).unwrap();
        let input = system.input("u", -1.0, 1.0).unwrap();
        let mut taken = Vec::new();
        for (k, push) in modes.iter().enumerate() {
            let mode = system.mode(&format!("mode {k}")).unwrap().next([x.is(x + input + *push)]);
            taken.push(mode.unwrap().taken());
        }
        let handles = Handles { x, y: None, input, modes: taken.clone(), taken };
        let mission = sketch.mission(&handles, 0.5);

        let sample = |k: usize| {
            let input = (k < steps).then_some(0.0);
            Sample { x: 0.0, y: 0.0, input, taken: None, mode: None, modes: modes.len() }
        };
        let shape: Vec<Sample> = (0..=steps).map(sample).collect();
        let terms = terms(&sketch, 0, &shape, true);
        prop_assume!(terms.is_some());
        let terms = terms.unwrap();

        let mut program = system.program(steps).unwrap();
        program.start([x.equals(start)]).unwrap();
        let Ok(own) = program.mission_margin("margin", &mission, LEAST) else {
            prop_assert!(terms.is_empty(), "{mission} is late");
            return Ok(());
        };
        program.maximize(own).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        let best = greatest(start, &modes, steps, domain, &terms);
        prop_assert!(solution.is_infeasible() == best.is_none(), "{mission}: {best:?}");
        // A margin of 90 is that of a mission without a number.
        if let Some(best) = best.filter(|best| *best < 89.0) {
            let found = solution.objective().unwrap();
            prop_assert!((found - best).abs() < 1e-5, "{mission}: {found}, not {best}");
            let plan = program.plan(&solution).unwrap();
            prop_assert!(plan.robustness(&mission).unwrap() >= best - 1e-5);
        }
        // What is required is what has a margin of 0, but for negated rows that touch.
        let mut program = system.program(steps).unwrap();
        program.start([x.equals(start)]).unwrap();
        program.require_mission("mission", &mission).unwrap();
        let is_refuted = BranchAndBound::default().solve(program.model()).unwrap().is_infeasible();
        if best.is_none_or(|best| best.abs() > 1e-2) {
            prop_assert!(is_refuted == best.is_none_or(|best| best < 0.0), "{mission}: {best:?}");
        }
        if !is_refuted {
            let negation = !&mission;
            if program.require_mission("negation", &negation).is_ok() {
                prop_assert!(BranchAndBound::default().solve(program.model()).unwrap().is_infeasible());
            }
        }
    }
}
