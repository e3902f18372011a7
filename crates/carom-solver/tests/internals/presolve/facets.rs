//! Facets of unions keep every point of a system with modes, and give the hull of one step.

use carom::prelude::*;
use carom_solver::internals::presolve::Domain;
use carom_solver::internals::program::Program;
use carom_solver::internals::search::cuts::{Cut, facet_cuts};
use proptest::prelude::*;

use crate::common::config;
use crate::common::mode_steps::{ModeSteps, Numbers};

/// What a point may violate a facet by through rounding.
const SLACK: f64 = 1e-7;

/// Walks of a system that are tried.
const WALKS: usize = 400;

fn facets(program: &Program, x: &[f64]) -> Vec<Cut> {
    facet_cuts(program, &Domain::new(program), x, &Options::default())
}

proptest! {
    #![proptest_config(config(120, "tests/regressions/facets.txt"))]

    /// Whatever the relaxed point is, no walk violates a facet.
    #[test]
    fn facets_keep_every_walk(seed in any::<u64>(), horizon in 1..=6_usize) {
        let numbers = &mut Numbers(seed);
        let system = ModeSteps::random(numbers, horizon);
        let program = Program::assemble(&system.model(false).unwrap()).unwrap();
        let part = |j: usize, share: f64| {
            program.lower[j] + share * (program.upper[j] - program.lower[j])
        };
        let anywhere: Vec<f64> =
            (0..program.column_count()).map(|j| part(j, 0.1 * numbers.within(0, 10))).collect();
        let walks: Vec<Vec<f64>> = (0..WALKS).filter_map(|_| system.walk(numbers)).collect();
        // Near to the mean of two walks, which relaxations like.
        let mut nearby = anywhere.clone();
        if let [one, .., other] = &walks[..] {
            let pairs = one.iter().zip(other).zip(&anywhere);
            nearby = pairs.map(|((a, b), far)| 0.45 * (a + b) + 0.1 * far).collect();
        }
        for x in [anywhere, nearby] {
            for cut in facets(&program, &x) {
                prop_assert!(cut.room(&x) < 0.0, "the relaxed point is not cut off");
                for walk in &walks {
                    prop_assert!(cut.room(walk) >= -SLACK, "{cut:?} cuts off {walk:?}");
                }
            }
        }
    }
}

/// The relaxation of one step with all its facets has the optimum of the step.
#[test]
fn facets_of_a_step_are_its_hull() -> Result<(), Error> {
    let numbers = &mut Numbers(3);
    let (mut lifted, mut solved) = (0, 0);
    for case in 0..40 {
        let system = ModeSteps::random(numbers, 1);
        let whole = system.model(false)?;
        let optimum = BranchAndBound::new(Options::default()).solve(&whole)?;
        let Some(optimum) = optimum.objective() else { continue };
        let program = Program::assemble(&whole)?;
        let mut relaxed = system.model(true)?;
        let columns: Vec<Variable> = relaxed.variables().map(|v| v.id()).collect();
        let (mut first, mut last, mut cuts) = (None, 0.0, 0);
        for _ in 0..60 {
            let point = BranchAndBound::new(Options::default()).solve(&relaxed)?;
            last = point.objective().unwrap_or(f64::NAN);
            first.get_or_insert(last);
            let x: Vec<f64> =
                columns.iter().map(|&column| point.value(column)).collect::<Result<_, _>>()?;
            let found = facets(&program, &x);
            if found.is_empty() {
                break;
            }
            for cut in found {
                let sum: Affine = cut.terms.iter().map(|&(j, a)| a * columns[j]).sum();
                relaxed.add(format!("facet[{cuts}]"), sum.le(cut.limit))?;
                cuts += 1;
            }
        }
        let size = optimum.abs().max(1.0);
        assert!((last - optimum).abs() < 1e-4 * size, "{case}: {last} of {optimum}");
        solved += 1;
        lifted += u32::from(first.is_some_and(|first| first < optimum - 1e-3 * size));
    }
    assert!(solved > 20 && 3 * lifted > solved, "{lifted} of {solved} are lifted");
    Ok(())
}
