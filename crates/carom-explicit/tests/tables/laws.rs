//! Laws, losses and refutations against solves of single states.

use carom::explicit::{ExplicitProgram, ExplicitTable, LookupAnswer};
use carom::prelude::*;
use proptest::prelude::*;

use crate::programs::{Built, Program, programs};

/// The program with its first binaries relaxed.
fn built(program: &Program, relaxed: usize) -> Built {
    let mut built = program.build();
    for &binary in built.outputs[program.columns..].iter().take(relaxed) {
        built.model.relax_integer(binary).unwrap();
    }
    built
}

fn table(program: &Program, relaxed: usize) -> ExplicitTable {
    let built = built(program, relaxed);
    let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
    let finest = if program.axes == 3 { 0.5 } else { 1.0 / 16.0 };
    let explicit = explicit.with_loss(0.1, 0.01).unwrap().with_finest(finest).unwrap();
    explicit.with_cell_limit(400).build()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn laws_keep_rows_and_lose_little(
        program in programs(),
        relaxed in 0..=1_usize,
        states in prop::collection::vec(prop::collection::vec(-1.0..=1.0_f64, 3), 12),
    ) {
        let table = table(&program, relaxed);
        prop_assert!(table.double().view().is_sound());
        let report = *table.report();
        let sum = report.proved + report.unproved + report.refuted + report.open;
        prop_assert!((sum - 1.0).abs() < 1e-9, "{report:?}");
        let mut built = built(&program, relaxed);
        for state in states {
            let state = &state[..program.axes];
            built.axes.iter().zip(state).for_each(|(&v, &t)| built.model.set_parameter(v, t).unwrap());
            let solution = BranchAndBound::default().solve(&built.model).unwrap();
            let (answer, plan) = table.evaluate(state);
            match answer {
                LookupAnswer::Plan { loss } => {
                    let (cost, missed) = program.judge(&plan, state);
                    prop_assert!(missed <= 1e-6, "{missed} {plan:?}");
                    for b in plan[program.columns..].iter().skip(relaxed) {
                        prop_assert!((b - b.round()).abs() <= 1e-9);
                    }
                    for x in &plan[..program.columns] {
                        prop_assert!(x.abs() <= 2.0 + 1e-9);
                    }
                    let best = solution.objective().unwrap();
                    prop_assert!(cost <= best + loss + 1e-6, "{cost} {best} {loss}");
                    prop_assert!(report.unproved > 0.0 || loss <= 0.1 + 0.01 * best.abs() + 1e-6);
                }
                LookupAnswer::NoPlan => prop_assert!(solution.is_infeasible()),
                LookupAnswer::Open => prop_assert!(report.open > 0.0),
                answer => prop_assert!(false, "{answer:?}"),
            }
        }
    }
}

#[test]
fn most_of_the_set_is_decided() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let (mut decided, mut count, mut refuted) = (0.0, 0.0, 0.0);
    for _ in 0..20 {
        let program = programs().new_tree(&mut runner).unwrap().current();
        let report = *table(&program, 0).report();
        println!("{} {report:?}", program.axes);
        decided += report.proved + report.refuted;
        refuted += report.refuted;
        count += 1.0;
    }
    println!("{decided} {refuted} of {count}");
    assert!(decided > 0.7 * count);
}
