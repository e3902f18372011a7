//! Tables whose devices solve programs, against solves of single states.

use carom::explicit::{ExplicitProgram, ExplicitTable, LookupAnswer, LookupArrays, LookupLeaf};
use carom::prelude::*;
use proptest::prelude::*;
use proptest::strategy::ValueTree;
use proptest::test_runner::TestRunner;

use crate::programs::{Program, programs};

fn table(program: &Program) -> ExplicitTable {
    let built = program.build();
    let explicit = ExplicitProgram::new(&built.model, built.axes, built.outputs).unwrap();
    let finest = if program.axes == 3 { 0.5 } else { 1.0 / 16.0 };
    let explicit = explicit.with_loss(0.1, 0.01).unwrap().with_finest(finest).unwrap();
    explicit.with_cell_limit(400).build()
}

/// The answer in 64 bits.
fn solve(arrays: &LookupArrays<f64>, state: &[f64]) -> (LookupAnswer<f64>, Vec<f64>) {
    let (mut inputs, mut work) = (vec![0.0; arrays.inputs()], vec![f64::NAN; arrays.work()]);
    let answer = arrays.view().solve(state, &mut inputs, &mut work);
    (answer, inputs)
}

/// The answer in 32 bits.
fn solve_single(arrays: &LookupArrays<f32>, state: &[f64]) -> (LookupAnswer<f32>, Vec<f64>) {
    let state: Vec<f32> = state.iter().map(|&x| x as f32).collect();
    let (mut inputs, mut work) = (vec![0.0; arrays.inputs()], vec![f32::NAN; arrays.work()]);
    let answer = arrays.view().solve(&state, &mut inputs, &mut work);
    (answer, inputs.into_iter().map(f64::from).collect())
}

fn programs_solved<T>(arrays: &LookupArrays<T>) -> usize {
    let leaves = arrays.view().leaves;
    leaves.iter().filter(|leaf| matches!(leaf, LookupLeaf::Solve { .. })).count()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn programs_keep_rows_and_lose_little(
        program in programs(),
        states in prop::collection::vec(prop::collection::vec(-1.0..=1.0_f64, 3), 12),
    ) {
        let table = table(&program);
        let (double, single) = (table.double_solving(), table.single_solving());
        prop_assert!(double.view().is_sound() && single.view().is_sound());
        prop_assert!(double.bytes() <= table.double().bytes());
        let mut built = program.build();
        for state in states {
            let state = &state[..program.axes];
            built.axes.iter().zip(state).for_each(|(&v, &t)| built.model.set_parameter(v, t).unwrap());
            let solution = BranchAndBound::default().solve(&built.model).unwrap();
            let (explicit, _) = table.evaluate(state);
            let (answer, plan) = solve(&double, state);
            prop_assert_eq!(explicit.has_inputs(), answer.has_inputs(), "{:?} {:?}", explicit, answer);
            let (narrow, narrow_plan) = solve_single(&single, state);
            let mut plans = Vec::new();
            if let LookupAnswer::Plan { loss } = answer {
                plans.push((loss, plan, double.row_rounding()));
            }
            if let LookupAnswer::Plan { loss } = narrow {
                // Rows have at most seven coefficients of at most two.
                let off = single.row_rounding() + 14.0 * single.input_rounding();
                let moved = 14.0 * single.state_rounding().iter().sum::<f64>();
                plans.push((f64::from(loss), narrow_plan, off + moved));
            }
            for (loss, plan, off) in plans {
                let (cost, missed) = program.judge(&plan, state);
                prop_assert!(missed <= off + 1e-9, "{missed} {off} {plan:?}");
                for b in &plan[program.columns..] {
                    prop_assert!((b - b.round()).abs() <= 1e-6);
                }
                let best = solution.objective().unwrap();
                prop_assert!(cost <= best + loss + 1e-4, "{cost} {best} {loss}");
            }
            match answer {
                LookupAnswer::NoPlan => prop_assert!(solution.is_infeasible()),
                LookupAnswer::Outside | LookupAnswer::Damaged => prop_assert!(false, "{answer:?}"),
                _ => {}
            }
        }
    }
}

#[test]
fn many_tables_solve_programs_in_fewer_bytes() {
    let mut runner = TestRunner::deterministic();
    let (mut solving, mut bytes, mut before, mut exchanges) = (0, 0, 0, 0);
    for _ in 0..30 {
        let program = programs().new_tree(&mut runner).unwrap().current();
        let table = table(&program);
        let single = table.single_solving();
        solving += usize::from(programs_solved(&single) > 0);
        exchanges += single.view().programs.iter().map(|own| own.exchanges).max().unwrap_or(0);
        (bytes, before) = (bytes + single.bytes(), before + table.single().bytes());
    }
    println!("{solving} tables, {bytes} of {before} bytes, {exchanges} exchanges");
    assert!(solving > 5 && exchanges > 5 && bytes < before);
}
