//! Tables whose devices solve programs, against solves of single states.

use carom::explicit::{
    ExplicitProgram, ExplicitTable, LookupAnswer, LookupArrays, LookupLeaf, LookupProgram,
    LookupTable,
};
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
        let is_curved = program.squares[0] > 0.0;
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
                // Where a program is solved, nothing is lost beside the integers.
                if is_curved && programs_solved(&double) == double.view().leaves.len() {
                    let mut fixed = built.model.clone();
                    for (&v, b) in built.outputs.iter().zip(&plan).skip(program.columns) {
                        fixed.fix(v, b.round()).unwrap();
                    }
                    let own = BranchAndBound::default().solve(&fixed).unwrap();
                    let own = own.objective().unwrap();
                    prop_assert!(cost <= own + 1e-3, "{cost} {own}");
                }
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

/// The damaged slices of a table.
struct Slices {
    leaves: Vec<LookupLeaf<f32>>,
    programs: Vec<LookupProgram<f32>>,
    numbers: Vec<f32>,
}

#[test]
fn damaged_programs_end() {
    let mut runner = TestRunner::deterministic();
    let (mut tables, mut unsound) = (0, 0);
    while tables < 5 {
        let program = programs().new_tree(&mut runner).unwrap().current();
        let single = table(&program).single_solving();
        let view = single.view();
        if !view.programs.iter().any(|own| own.exchanges > 0) {
            continue;
        }
        tables += 1;
        for k in 0..400_usize {
            let mut own = Slices {
                leaves: view.leaves.to_vec(),
                programs: view.programs.to_vec(),
                numbers: view.numbers.to_vec(),
            };
            let strange = [f32::NAN, f32::INFINITY, 0.0, -1e30, 1e-30, -1.0];
            let place = 7919 * k + 13;
            let number = place % own.numbers.len();
            let which = place % own.programs.len();
            match k % 8 {
                0..3 => own.numbers[number] = strange[k % strange.len()],
                3 => own.programs[which].rows = [u32::MAX, 0, 7, 4096][k / 8 % 4],
                4 => own.programs[which].first = [u32::MAX, 1, 50][k / 8 % 3],
                5 => own.programs[which].exchanges = [0, 1, 1000][k / 8 % 3],
                6 => own.programs[which].negative = strange[k % strange.len()],
                _ => own.numbers.truncate(number),
            }
            let (leaves, programs, numbers) =
                (&own.leaves[..], &own.programs[..], &own.numbers[..]);
            let damaged = LookupTable { leaves, programs, numbers, ..view };
            unsound += usize::from(!damaged.is_sound());
            for _ in 0..20 {
                let state = prop::collection::vec(-1.0..=1.0_f32, program.axes);
                let state = state.new_tree(&mut runner).unwrap().current();
                let (mut inputs, mut work) = (vec![0.0; single.inputs()], vec![0.0; single.work()]);
                let answer = damaged.solve(&state, &mut inputs, &mut work);
                // Whatever the numbers are, an answer has none that is not finite.
                assert!(!answer.has_inputs() || inputs.iter().all(|x| x.is_finite()), "{answer:?}");
            }
        }
    }
    assert!(unsound > 200, "{unsound}");
}

#[test]
fn work_space_is_wanted() {
    let mut runner = TestRunner::deterministic();
    loop {
        let program = programs().new_tree(&mut runner).unwrap().current();
        let double = table(&program).double_solving();
        if double.work() == 0 {
            continue;
        }
        let wanted = double.work();
        let states = prop::collection::vec(-1.0..=1.0_f64, program.axes);
        for _ in 0..50 {
            let state = states.new_tree(&mut runner).unwrap().current();
            let mut inputs = vec![0.0; double.inputs()];
            let (mut enough, mut less) = (vec![0.0; wanted + 3], vec![0.0; wanted - 1]);
            let answer = double.view().solve(&state, &mut inputs, &mut enough);
            assert_ne!(answer, LookupAnswer::Damaged);
            let other = double.view().solve(&state, &mut inputs, &mut less);
            assert!(other == answer || other == LookupAnswer::Damaged);
            let wrong = double.view().solve(&state, &mut [], &mut enough);
            assert!(!wrong.has_inputs());
            let fallback = vec![7.5; double.inputs()];
            let other = double.view().solve_or(&state, &fallback, &mut inputs, &mut less);
            assert!(other.has_inputs() || inputs == fallback);
        }
        return;
    }
}

/// x moves to 0 by two pushes of at most 1 in sum; the same is said twice, in other units.
pub(crate) fn pushes() -> (Model, Variable, Variable) {
    let mut model = Model::new("pushes");
    let x = model.parameter("x", 0.0, -3.0, 3.0).unwrap();
    let up = model.binary("up").unwrap();
    let [u, v, sum, rest] =
        ["u", "v", "sum", "rest"].map(|name| model.continuous(name, -9.0, 9.0).unwrap());
    model.add("sum", sum.equals(u + v)).unwrap();
    model.add("again", (300.0 * sum).equals(300.0 * u + 300.0 * v)).unwrap();
    model.add("tenths", (0.1 * sum - 0.1 * u).equals(0.1 * v)).unwrap();
    model.add("most", (20.0 * sum).le(20.0 * up)).unwrap();
    model.add("least", (20.0 * sum).ge(20.0 * up - 20.0)).unwrap();
    model.add("rest", rest.equals(x + sum)).unwrap();
    model.minimize(rest.square() + 0.1 * (u - v).square() + 0.01 * v.square()).unwrap();
    (model, x, sum)
}

#[test]
fn equations_are_eliminated() {
    let (model, x, sum) = pushes();
    let table = ExplicitProgram::new(&model, [x], [sum]).unwrap().build();
    let double = table.double_solving();
    assert_eq!(programs_solved(&double), double.view().leaves.len());
    assert!(double.view().programs.iter().all(|own| own.rows <= 2));
    assert!(double.row_rounding() < 1e-6);
    for k in 0..=60 {
        let x = f64::from(k) / 10.0 - 3.0;
        let (answer, inputs) = solve(&double, &[x]);
        assert!(answer.has_inputs());
        // With u = v at no cost, all but a little of x is pushed away.
        assert!((inputs[0] + x.clamp(-1.0, 1.0)).abs() < 0.02, "{x} {inputs:?}");
    }
}
