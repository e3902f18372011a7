//! Costs in the three norms against plain sums and hand-written epigraphs.

use carom::ErrorKind;
use carom::hybrid::{HybridProgram, HybridSystem, LinearSystem, Matrix, State};
use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;

/// Two states and two inputs.
struct Plant {
    system: HybridSystem,
    flow: LinearSystem,
    states: [State; 2],
    inputs: [Input; 2],
}

fn plant(entries: &[f64]) -> Plant {
    let a = Matrix::from_fn(2, 2, |i, j| entries[2 * i + j]);
    let b = Matrix::from_fn(2, 2, |i, j| entries[4 + 2 * i + j]);
    let flow = LinearSystem::new(a, b, [0.1, -0.2]).unwrap();
    let mut system = HybridSystem::new(1.0);
    let states = ["x", "v"].map(|name| system.state(name, -40.0, 40.0).unwrap());
    let inputs = ["a", "b"].map(|name| system.input(name, -1.0, 1.0).unwrap());
    system.mode("go").unwrap().flow(flow.clone()).unwrap();
    Plant { system, flow, states, inputs }
}

impl Plant {
    fn program(&self, steps: usize, start: &[f64]) -> HybridProgram {
        let mut program = self.system.program(steps).unwrap();
        let at = |(state, value): (&State, &f64)| state.equals(*value);
        program.start(self.states.iter().zip(start).map(at).collect::<Vec<_>>()).unwrap();
        program
    }
}

fn solved(model: &Model) -> Solution {
    let solution = BranchAndBound::default().solve(model).unwrap();
    assert!(solution.is_optimal(), "{}", solution.termination());
    solution
}

/// `W e` for the 2 x 2 matrix of four numbers.
fn times(weight: &[f64], e: [f64; 2]) -> [f64; 2] {
    [weight[0] * e[0] + weight[1] * e[1], weight[2] * e[0] + weight[3] * e[1]]
}

/// The same for expressions.
fn weighted(weight: &[f64], e: &[Affine; 2]) -> [Affine; 2] {
    [0, 1].map(|i| weight[2 * i] * &e[0] + weight[2 * i + 1] * &e[1])
}

/// How `W e` is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Norm {
    Squares,
    Sum,
    Largest,
}

impl Norm {
    /// Over the steps.
    fn sum(self, program: &mut HybridProgram, name: &str, rows: [Affine; 2]) -> Quadratic {
        let [first, second] = rows.clone();
        match self {
            Norm::Squares => program.sum(first.square() + second.square()).unwrap(),
            Norm::Sum => {
                let first = program.sum_abs(&format!("{name}0"), first).unwrap();
                (first + program.sum_abs(&format!("{name}1"), second).unwrap()).into()
            }
            Norm::Largest => program.sum_largest(name, rows).unwrap().into(),
        }
    }

    /// At the last sample.
    fn end(self, program: &mut HybridProgram, name: &str, rows: [Affine; 2]) -> Quadratic {
        let [first, second] = rows.map(|row| program.end(row).unwrap());
        if self == Norm::Squares {
            return first.square() + second.square();
        }
        let model = program.model_mut();
        match self {
            Norm::Largest => {
                let sides = [first.clone(), -first, second.clone(), -second];
                Affine::from(model.maximum(name, sides).unwrap()).into()
            }
            _ => {
                let sides = [first, second].into_iter().enumerate();
                sides.map(|(k, side)| model.absolute((name, k), side).unwrap()).sum::<Affine>()
            }
            .into(),
        }
    }
}

proptest! {
    #![proptest_config(config(30, "tests/regressions/costs.txt"))]

    /// With all inputs fixed, the cost is a plain sum over the run.
    #[test]
    fn the_cost_of_a_run_is_the_plain_sum(
        norm in 0..3_usize,
        entries in prop::collection::vec(-0.9..0.9_f64, 8),
        inputs in prop::collection::vec(-1.0..1.0_f64, 8),
        weights in prop::collection::vec(-2.0..2.0_f64, 12),
        references in prop::collection::vec(-1.0..1.0_f64, 8),
        start in prop::collection::vec(-3.0..3.0_f64, 2),
        has_end in any::<bool>(),
    ) {
        let norm = [Norm::Squares, Norm::Sum, Norm::Largest][norm];
        let mut plant = plant(&entries);
        // The reference of the states changes once, that of the inputs is constant.
        let state_reference = [&references[..2], &references[2..4]];
        let mut series = |k: usize| {
            let values = state_reference.map(|values| values[k]).to_vec();
            plant.system.series(&format!("reference {k}"), values).unwrap()
        };
        let series = [series(0), series(1)];
        let mut program = plant.program(4, &start);
        for (k, input) in plant.inputs.iter().enumerate() {
            for t in 0..4 {
                let input = program.variable(*input, t).unwrap();
                program.model_mut().fix(input, inputs[2 * t + k]).unwrap();
            }
        }
        let [q, r, p] = [&weights[..4], &weights[4..8], &weights[8..]];
        let miss = [0, 1].map(|k| plant.states[k] - series[k]);
        let push = [0, 1].map(|k| plant.inputs[k] - references[4 + k]);
        let mut expression = norm.sum(&mut program, "cost_x", weighted(q, &miss));
        expression += norm.sum(&mut program, "cost_u", weighted(r, &push));
        if has_end {
            expression += norm.end(&mut program, "cost_end", weighted(p, &miss));
        }
        let size = |e: [f64; 2]| match norm {
            Norm::Squares => e[0] * e[0] + e[1] * e[1],
            Norm::Sum => e[0].abs() + e[1].abs(),
            Norm::Largest => e[0].abs().max(e[1].abs()),
        };
        let (mut x, mut sum) = (start.clone(), 0.0);
        for t in 0..=4 {
            let at = &state_reference[t.min(1)];
            let e = [x[0] - at[0], x[1] - at[1]];
            if t == 4 {
                sum += if has_end { size(times(p, e)) } else { 0.0 };
                break;
            }
            let u = &inputs[2 * t..2 * t + 2];
            sum += size(times(q, e));
            sum += size(times(r, [u[0] - references[4], u[1] - references[5]]));
            x = plant.flow.step(&x, u).unwrap();
        }
        program.minimize(expression.clone()).unwrap();
        let plan = program.solve(&mut BranchAndBound::default()).unwrap();
        let objective = plan.solution.objective().unwrap();
        prop_assert!((objective - sum).abs() <= 1e-5 * sum.max(1.0), "{objective} {sum}");
        if norm != Norm::Squares {
            // The variables have these values also where the cost is maximised.
            let affine = expression.affine().clone();
            program.maximize(affine).unwrap();
            let objective = solved(program.model()).objective().unwrap();
            prop_assert!((objective - sum).abs() <= 1e-5 * sum.max(1.0), "{objective} {sum}");
        }
    }

    /// The optimum is that of a program whose epigraphs are written by hand.
    #[test]
    fn optima_are_those_of_epigraphs_by_hand(
        largest in any::<bool>(),
        entries in prop::collection::vec(-0.9..0.9_f64, 8),
        weights in prop::collection::vec(-2.0..2.0_f64, 8),
        start in prop::collection::vec(-3.0..3.0_f64, 2),
    ) {
        let plant = plant(&entries);
        let mut by_library = plant.program(5, &start);
        let (q, r) = (&weights[..4], &weights[4..]);
        let norm = if largest { Norm::Largest } else { Norm::Sum };
        let states = weighted(q, &plant.states.map(Affine::from));
        let inputs = weighted(r, &plant.inputs.map(Affine::from));
        let mut cost = norm.sum(&mut by_library, "cost_x", states.clone());
        cost += norm.sum(&mut by_library, "cost_u", inputs);
        cost += norm.end(&mut by_library, "cost_end", states);
        by_library.minimize(cost).unwrap();
        let objective = solved(by_library.model()).objective().unwrap();
        prop_assert_eq!(solved(by_library.model()).statistics().nodes, 1);

        let mut by_hand = plant.program(5, &start);
        let of = |handle: Variable, count: usize| {
            (0..count).map(|t| by_hand.variable(handle, t).unwrap()).collect::<Family>()
        };
        let states = plant.states.map(|state| of(state.into(), 6));
        let inputs = plant.inputs.map(|input| of(input.into(), 5));
        let model = by_hand.model_mut();
        let mut sum = Affine::zero();
        for (name, weight, of, samples) in [("e", q, &states, 0..6), ("g", r, &inputs, 0..5)] {
            for t in samples {
                let most: Vec<Variable> = (0..2)
                    .map(|i| model.continuous((format!("{name}{i}"), t), 0.0, 1e3).unwrap())
                    .collect();
                for i in 0..2 {
                    let row = weight[2 * i] * of[0][t] + weight[2 * i + 1] * of[1][t];
                    let above = if largest { most[0] } else { most[i] };
                    model.add((format!("{name}{i}_up"), t), (row.clone() - above).le(0.0)).unwrap();
                    model.add((format!("{name}{i}_down"), t), (row + above).ge(0.0)).unwrap();
                }
                sum += if largest { most[0].into() } else { most[0] + most[1] };
            }
        }
        model.minimize(sum).unwrap();
        let expected = solved(model).objective().unwrap();
        prop_assert!((objective - expected).abs() <= 1e-5 * expected.max(1.0));
    }
}

#[test]
fn transitions_cost_what_is_said() {
    // Three steps of 1 cost nothing each, a step of 2 costs 5.
    let mut system = HybridSystem::new(1.0);
    let x = system.state("x", 0.0, 9.0).unwrap();
    let mut drive =
        |name: &str, by: f64| system.mode(name).unwrap().next([(x, x + by)]).unwrap().taken();
    let (slow, fast, _) = (drive("slow", 1.0), drive("fast", 2.0), drive("stop", 0.0));
    let mut program = system.program(3).unwrap();
    program.start([x.equals(0.0)]).unwrap();
    program.goal([x.equals(5.0)]).unwrap();
    program.minimize(program.sum(5.0 * fast + 0.25 * slow).unwrap()).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!((plan.solution.objective().unwrap() - 10.25).abs() < 1e-6);
    assert_eq!((plan.count(fast).unwrap(), plan.count(slow).unwrap()), (2, 1));
}

#[test]
fn costs_that_do_not_fit_are_refused_and_change_nothing() {
    let plant = plant(&[0.5; 8]);
    let ([x, v], [a, _]) = (plant.states, plant.inputs);
    let mut program = plant.program(2, &[0.0, 0.0]);
    let before = program.model().to_string();
    let mut other = HybridSystem::new(1.0);
    let foreign = other.state("y", 0.0, 1.0).unwrap();
    // The magnitudes of earlier steps are taken back when a later part fails.
    let foreign_text = "variable number 0 used in `an expression of a program` belongs to another \
                        model or system; use a handle only with the one that created it (or a clone \
                        of it), and take handles of a system at a sample with `at`";
    let error = program.sum(x.square() + foreign.square()).unwrap_err();
    assert_eq!(error.to_string(), foreign_text);
    let error = program.sum_abs("cost", x + foreign).unwrap_err();
    assert_eq!(error.to_string(), foreign_text);
    let error = program.sum_largest("cost", [x - v, foreign - v]).unwrap_err();
    assert_eq!(error.to_string(), foreign_text);
    let error = program.sum_abs("cost", x.predicted()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "`x'` cannot stand in an expression of a program; use the state at the next sample, or \
         state the prediction as an output"
    );
    let error = program.end(a.square()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the sample of `a` is 2; it must be below 2, the number of steps"
    );
    let error = program.at(x - v, 3).unwrap_err();
    assert_eq!(error.to_string(), "the sample of `x` is 3; it must be at most 2, the last sample");
    // A handle that is not taken at a sample is no variable of the model.
    let error = program.add("row", x.le(1.0)).unwrap_err();
    assert!(
        error.to_string().contains("take handles of a system at a sample with `at`"),
        "{error}"
    );
    let error = program.minimize(x.square()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::ForeignHandle { .. }), "{error}");
    let error = program.sum_abs("cost", f64::NAN * x).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }), "{error}");
    let error = program.sum_largest("cost", Vec::<Affine>::new()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error}");
    assert_eq!(program.model().to_string(), before);

    program.sum_largest("cost", [x - v, x + a]).unwrap();
    let before = program.model().to_string();
    let error = program.sum_abs("cost", x).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::DuplicateName { .. }));
    assert_eq!(program.model().to_string(), before);
    program.sum_abs("other", x).unwrap();

    // A quadratic cost that is not convex is refused by the model.
    let concave = program.sum(x.square() - v.square()).unwrap();
    let error = program.minimize(concave).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotConvex { .. }));
    let unknown = program.sum(f64::NAN * x.square()).unwrap();
    let error = program.minimize(unknown).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotFinite { .. }));
}
