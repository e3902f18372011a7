//! Prepared programs: the same answers as solves from nothing, for any values of the parameters.

use std::time::Duration;

use carom::ErrorKind;
use carom::model::norm;
use carom::prelude::*;
use carom::solver::MipStart;
use proptest::prelude::*;

/// A point mass among modes, whose start, target and wall are parameters.
fn horizon(
    steps: usize,
    gains: [f64; 2],
    weights: [f64; 3],
) -> Result<(Model, Vec<Variable>), Error> {
    let mut model = Model::new("horizon");
    let x = model.continuous_family("x", steps + 1, -4.0, 4.0)?;
    let u = model.continuous_family("u", steps, -1.0, 1.0)?;
    let on = model.binary_family("on", steps)?;
    let count = model.integer("count", 0.0, steps as f64)?;
    let start = model.parameter("start", 0.0, -3.0, 3.0)?;
    let target = model.parameter("target", 1.0, -5.0, 5.0)?;
    let wall = model.parameter("wall", 3.0, -1.0, 4.0)?;
    model.add("start", (x[0] - start).equals(0.0))?;
    for t in 0..steps {
        let free = x[t + 1] - x[t] - gains[0] * u[t];
        let pushed = x[t + 1] - gains[1] * x[t] - u[t];
        model.add(("free", t), on[t].off().implies(free.equals(0.0)))?;
        model.add(("pushed", t), on[t].on().implies(pushed.equals(0.0)))?;
        model.add(("behind", t), on[t].on().implies(x[t].ge(wall - 1.0)))?;
        model.add(("before", t), on[t].off().implies(x[t].le(wall)))?;
    }
    model.add("count", (on.iter().sum::<Affine>() - count).equals(0.0))?;
    model.add("reach", (x[steps] - wall).le(1.5))?;
    let miss = (0..=steps).map(|t| (x[t] - target).square()).sum::<Quadratic>();
    let effort = u.iter().map(|u| u.square()).sum::<Quadratic>();
    model.minimize(weights[0] * miss + weights[1] * effort + weights[2] * count)?;
    Ok((model, vec![start, target, wall]))
}

/// Status and objective of two solutions agree within the gaps.
fn agree(cold: &Solution, warm: &Solution) {
    assert_eq!(cold.termination(), warm.termination());
    if let (Some(a), Some(b)) = (cold.objective(), warm.objective()) {
        assert!((a - b).abs() <= 3e-6 * a.abs().max(1.0), "{a} from nothing, {b} prepared");
    }
    if warm.point().is_some() {
        assert!(warm.verification().is_some_and(|v| v.holds()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    /// A limit may end a solve anywhere; what it returns holds, and its bound is one.
    #[test]
    fn solves_that_are_cut_short_are_right(
        steps in 2..6_usize,
        weights in [0.0..2.0, 0.1..1.0, -0.5..0.5],
        start in -3.0..3.0_f64,
        limits in prop::collection::vec(0..3000_u64, 6),
    ) {
        let (mut model, parameters) = horizon(steps, [1.0, 0.9], weights).unwrap();
        let (mut cold, mut solver) = (BranchAndBound::default(), BranchAndBound::default());
        let mut prepared = solver.prepare(&model).unwrap();
        for (k, limit) in limits.into_iter().enumerate() {
            let value = f64::min(start + 0.1 * k as f64, 3.0);
            let values = [(parameters[0], value)];
            model.set_parameter(parameters[0], value).unwrap();
            let best = cold.solve(&model).unwrap();
            let time = (k % 2 == 1).then(|| std::time::Duration::from_micros(limit));
            prepared.options_mut().time_limit = time;
            let short = prepared.solve(&values, &mut Control::default()).unwrap();
            if let (Some(best), Some(value)) = (best.objective(), short.objective()) {
                let slack = 3e-6 * best.abs().max(1.0);
                assert!(value >= best - slack && short.bound() <= best + slack);
                assert!(short.verification().is_some_and(|v| v.holds()));
            } else {
                assert!(short.point().is_none() && best.objective().is_some() || !best.is_optimal());
            }
            assert!(time.is_some() || short.termination() == best.termination());
        }
    }

    #[test]
    fn prepared_solves_equal_cold_ones(
        steps in 2..6_usize,
        gains in [0.3..1.5, 0.3..1.0],
        weights in [0.0..2.0, 0.1..1.0, -0.5..0.5],
        values in prop::collection::vec(([-3.0..3.0, -5.0..5.0, -1.0..4.0], any::<[bool; 2]>()), 5),
    ) {
        let (mut model, parameters) = horizon(steps, gains, weights).unwrap();
        let mut cold = BranchAndBound::default();
        let mut solver = BranchAndBound::default();
        let mut prepared = solver.prepare(&model).unwrap();
        let (mut guess, mut passed) = (MipStart::new(), 0);
        for (value, [seeded, shifted]) in values {
            let values: Vec<(Variable, f64)> = parameters.iter().copied().zip(value).collect();
            for &(parameter, value) in &values {
                model.set_parameter(parameter, value).unwrap();
            }
            let mut control = Control::default().with_steps_passed(passed);
            if seeded {
                control = control.with_start(&guess);
            }
            let warm = prepared.solve(&values, &mut control).unwrap();
            let one = cold.solve(&model).unwrap();
            agree(&one, &warm);
            if let Some(least) = one.objective() {
                let most = least + 3e-6 * least.abs().max(1.0);
                prop_assert!(warm.bound() <= most, "{} is no bound of {least}", warm.bound());
            }
            let integers = model.variables().filter(|v| v.kind().is_integral()).map(|v| v.id());
            guess = MipStart::of(&warm, integers);
            passed = usize::from(shifted);
        }
    }
}

#[test]
fn a_value_outside_its_range_is_refused_and_changes_nothing() {
    let (model, parameters) = horizon(3, [1.0, 0.9], [1.0, 0.1, 0.0]).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let before = prepared.solve(&[], &mut Control::default()).unwrap();
    let bad = [(parameters[0], 1.0), (parameters[1], 5.5)];
    let error = prepared.solve(&bad, &mut Control::default()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }));
    assert!(error.to_string().contains("`target`"));
    let x0 = model.variable_by_name(("x", 0)).unwrap();
    let error = prepared.solve(&[(x0, 1.0)], &mut Control::default()).unwrap_err();
    assert!(matches!(error.kind(), ErrorKind::NotParameter { .. }));
    let after = prepared.solve(&[], &mut Control::default()).unwrap();
    agree(&before, &after);
}

#[test]
fn options_change_between_solves_and_pools_are_complete() {
    let (model, parameters) = horizon(4, [1.0, 0.9], [1.0, 0.1, 0.1]).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let at = [(parameters[0], 2.0), (parameters[2], 2.5)];
    let plain = prepared.solve(&at, &mut Control::default()).unwrap();
    prepared.options_mut().pool = 3;
    let pooled = prepared.solve(&at, &mut Control::default()).unwrap();
    agree(&plain, &pooled);
    prepared.options_mut().pool = 1;
    prepared.options_mut().parts_mut().reductions = false;
    agree(&plain, &prepared.solve(&at, &mut Control::default()).unwrap());
    prepared.options_mut().node_limit = Some(0);
    let stopped = prepared.solve(&at, &mut Control::default()).unwrap();
    assert_eq!(stopped.termination(), carom::solution::Termination::NodeLimit);
    prepared.options_mut().relative_gap = -1.0;
    assert!(prepared.solve(&at, &mut Control::default()).is_err());
}

/// Small steps of the state, as in a closed loop: the last point is a good start.
#[test]
fn the_shifted_point_costs_one_relaxation_at_most() {
    let (mut model, parameters) = horizon(8, [1.0, 0.9], [1.0, 0.3, 0.05]).unwrap();
    let (mut cold, mut solver) = (BranchAndBound::default(), BranchAndBound::default());
    let mut prepared = solver.prepare(&model).unwrap();
    let (mut state, mut more) = (3.0, 0);
    for _ in 0..8 {
        model.set_parameter(parameters[0], state).unwrap();
        let one = cold.solve(&model).unwrap();
        let mut control = Control::default().with_steps_passed(1);
        let warm = prepared.solve(&[(parameters[0], state)], &mut control).unwrap();
        agree(&one, &warm);
        // Where it is not the answer, its leaf is relaxed in vain.
        let [own, afresh] = [&warm, &one].map(|solution| solution.statistics().relaxations);
        assert!(own <= afresh + 1, "{own} {afresh}");
        more += own.saturating_sub(afresh);
        state = warm.value(model.variable_by_name(("x", 1)).unwrap()).unwrap().clamp(-3.0, 3.0);
    }
    assert!(more <= 2, "{more} of 8");
}

/// Any other backend can be asked as well.
#[test]
fn a_solver_that_prepares_nothing_solves_afresh() {
    struct Plain(BranchAndBound);
    impl Solver for Plain {
        fn name(&self) -> &str {
            "plain"
        }
        fn options(&self) -> &Options {
            self.0.options()
        }
        fn options_mut(&mut self) -> &mut Options {
            self.0.options_mut()
        }
        fn solve_with(
            &mut self,
            model: &Model,
            control: &mut Control<'_>,
        ) -> Result<Solution, Error> {
            self.0.solve_with(model, control)
        }
    }
    let (model, parameters) = horizon(3, [1.0, 0.9], [1.0, 0.1, 0.0]).unwrap();
    let (mut plain, mut own) = (Plain(BranchAndBound::default()), BranchAndBound::default());
    let solver: &mut dyn Solver = &mut plain;
    let mut afresh = solver.prepare(&model).unwrap();
    let mut prepared = own.prepare(&model).unwrap();
    for start in [-2.0, 0.5, 3.0] {
        let at = [(parameters[0], start)];
        let one = afresh.solve(&at, &mut Control::default()).unwrap();
        agree(&one, &prepared.solve(&at, &mut Control::default()).unwrap());
        assert_eq!(afresh.model().variable_ref(parameters[0]).unwrap().bounds().lower, start);
    }
}

/// No value of the parameter has a point.
#[test]
fn what_is_infeasible_for_all_values_is_infeasible_in_each_solve() {
    let mut model = Model::new("m");
    let z = model.binary_family("z", 2).unwrap();
    let p = model.parameter("p", 3.0, 2.5, 4.0).unwrap();
    model.add("sum", (z[0] + z[1] - p).ge(0.0)).unwrap();
    model.minimize(z[0] + z[1]).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    for value in [2.5, 4.0] {
        let solution = prepared.solve(&[(p, value)], &mut Control::default()).unwrap();
        assert_eq!(solution.termination(), carom::solution::Termination::Infeasible);
    }
}

/// The least cost over all assignments of the binaries, each a convex program.
fn enumerated(model: &Model) -> Option<f64> {
    let binaries: Vec<Variable> = model
        .variables()
        .filter(|v| v.kind().is_integral() && v.bounds().upper == 1.0)
        .map(|v| v.id())
        .collect();
    let values = (0..1_u32 << binaries.len()).filter_map(|bits| {
        let mut fixed = model.clone();
        for (k, &z) in binaries.iter().enumerate() {
            fixed.fix(z, f64::from(bits >> k & 1)).unwrap();
        }
        BranchAndBound::default().solve(&fixed).unwrap().objective()
    });
    values.reduce(f64::min)
}

/// Nodes closed by multipliers of the solve before: the bound stays one, whatever the parameters
/// are now and whether the horizon has moved.
#[test]
fn bounds_with_proofs_of_earlier_solves_are_bounds() {
    let (mut model, parameters) = horizon(6, [1.0, 0.7], [1.0, 0.2, 0.05]).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let (mut proved, mut seed) = (0, 7_u64);
    let mut draw = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (seed >> 33) as f64 / (1_u64 << 31) as f64
    };
    let mut at = [2.0, 0.5, 2.5];
    for step in 0..40 {
        for (value, [least, most]) in at.iter_mut().zip([[-3.0, 3.0], [-5.0, 5.0], [-1.0, 4.0]]) {
            let far = if step % 10 == 9 { 2.0 } else { 0.2 };
            *value = f64::clamp(*value + far * (draw() - 0.5), least, most);
        }
        let values: Vec<(Variable, f64)> = parameters.iter().copied().zip(at).collect();
        values.iter().for_each(|&(p, value)| model.set_parameter(p, value).unwrap());
        let mut control = Control::default().with_steps_passed(step % 2);
        let found = prepared.solve(&values, &mut control).unwrap();
        proved += found.statistics().closed_by_proofs;
        match enumerated(&model) {
            Some(best) => {
                let slack = 2e-6 * best.abs().max(1.0);
                assert!(found.is_optimal(), "step {step}: {}", found.termination());
                assert!(found.bound() <= best + slack, "step {step}: {} {best}", found.bound());
                assert!((found.objective().unwrap() - best).abs() <= slack, "step {step}");
            }
            None => assert_eq!(found.termination(), carom::solution::Termination::Infeasible),
        }
    }
    assert!(proved > 0);
}

/// Without time for a relaxation, the multipliers of the last root prove a bound.
#[test]
fn a_solve_without_time_has_the_bound_of_the_last_root() {
    let (mut model, parameters) = horizon(6, [1.0, 0.7], [1.0, 0.2, 0.05]).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let ats = [[2.0, 0.5, 2.5], [1.9, 0.45, 2.45], [1.8, 0.4, 2.4], [1.7, 0.4, 2.3]];
    for (k, at) in ats.into_iter().enumerate() {
        let values: Vec<(Variable, f64)> = parameters.iter().copied().zip(at).collect();
        values.iter().for_each(|&(p, value)| model.set_parameter(p, value).unwrap());
        let best = enumerated(&model).unwrap();
        // The first root is relaxed for its cuts.
        if k > 1 {
            prepared.options_mut().time_limit = Some(Duration::ZERO);
            let stopped = prepared.solve(&values, &mut Control::default()).unwrap();
            let bound = stopped.bound();
            assert!(bound.is_finite() && bound <= best + 1e-6 * best.abs().max(1.0), "{bound}");
            prepared.options_mut().time_limit = None;
        }
        let found = prepared.solve(&values, &mut Control::default()).unwrap();
        assert!(found.is_optimal());
    }
}

/// A program of two halves that share no row is searched in blocks, prepared or not.
#[test]
fn a_prepared_program_in_blocks_is_solved_in_blocks() {
    let mut model = Model::new("halves");
    let mut cost = Quadratic::zero();
    let mut parameters = Vec::new();
    for half in ["left", "right"] {
        let x = model.continuous_family(&format!("x_{half}"), 4, -4.0, 4.0).unwrap();
        let z = model.binary_family(&format!("z_{half}"), 3).unwrap();
        let p = model.parameter(format!("p_{half}").as_str(), 1.0, -2.0, 2.0).unwrap();
        model.add(format!("start_{half}").as_str(), (x[0] - p).equals(0.0)).unwrap();
        for t in 0..3 {
            let row = x[t + 1] - 0.9 * x[t] + 1.3 * z[t];
            model.add((format!("move_{half}"), t), row.equals(0.2)).unwrap();
        }
        cost += x.iter().map(|x| x.square()).sum::<Quadratic>();
        parameters.push(p);
    }
    model.minimize(cost).unwrap();
    let (mut cold, mut solver) = (BranchAndBound::default(), BranchAndBound::default());
    let mut prepared = solver.prepare(&model).unwrap();
    for values in [[1.0, -1.0], [1.9, 0.3], [-0.4, 2.0]] {
        let at: Vec<(Variable, f64)> = parameters.iter().copied().zip(values).collect();
        at.iter().for_each(|&(p, value)| model.set_parameter(p, value).unwrap());
        let one = cold.solve(&model).unwrap();
        let mut control = Control::default().with_steps_passed(1);
        let two = prepared.solve(&at, &mut control).unwrap();
        agree(&one, &two);
        assert_eq!(one.statistics().blocks, two.statistics().blocks);
    }
}

/// An interrupt and a limit leave the next solve what it needs.
#[test]
fn a_solve_that_was_stopped_does_not_spoil_the_next() {
    let (mut model, parameters) = horizon(7, [1.0, 0.8], [1.0, 0.2, 0.05]).unwrap();
    let (mut cold, mut solver) = (BranchAndBound::default(), BranchAndBound::default());
    let mut prepared = solver.prepare(&model).unwrap();
    let interrupt = Interrupt::new();
    for (k, start) in [2.0, 1.8, 1.5, 1.7, -1.0, 2.9].into_iter().enumerate() {
        model.set_parameter(parameters[0], start).unwrap();
        let at = [(parameters[0], start)];
        match k % 3 {
            1 => {
                prepared.options_mut().time_limit = Some(std::time::Duration::ZERO);
                let stopped = prepared.solve(&at, &mut Control::default()).unwrap();
                assert!(stopped.termination().is_limit() || stopped.is_optimal());
                prepared.options_mut().time_limit = None;
            }
            2 => {
                interrupt.trigger();
                let mut control = Control::default().with_interrupt(&interrupt);
                let stopped = prepared.solve(&at, &mut control).unwrap();
                assert!(stopped.termination().is_limit() || stopped.is_optimal());
            }
            _ => {}
        }
        let mut control = Control::default().with_steps_passed(1);
        let warm = prepared.solve(&at, &mut control).unwrap();
        agree(&cold.solve(&model).unwrap(), &warm);
    }
}

/// Columns of cones have no names, and are there for all values of the parameters.
#[test]
fn norms_have_parameters() {
    let mut model = Model::new("reach");
    let on = model.binary_family("on", 3).unwrap();
    let x = model.continuous_family("x", 3, -4.0, 4.0).unwrap();
    let far = model.continuous("far", 0.0, 20.0).unwrap();
    let target = model.parameter("target", 1.0, -5.0, 5.0).unwrap();
    for k in 0..3 {
        model.add(("most", k), x[k].le(4.0 * on[k])).unwrap();
        model.add(("least", k), x[k].ge(-4.0 * on[k])).unwrap();
    }
    let miss = norm((0..3).map(|k| x[k] - (k as f64 - 1.0) * target));
    model.add("miss", miss.le(far)).unwrap();
    model.add("length", norm(x.iter()).le(3.0)).unwrap();
    model.minimize(far + 0.5 * on.iter().sum::<Affine>()).unwrap();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let mut cold = BranchAndBound::default();
    for value in [1.0, -2.0, 0.0, 4.5, 4.6] {
        model.set_parameter(target, value).unwrap();
        let warm = prepared.solve(&[(target, value)], &mut Control::default()).unwrap();
        agree(&cold.solve(&model).unwrap(), &warm);
        // The nearest point with none, one or both of the outer entries.
        let size = f64::abs(value);
        let diagonal = std::f64::consts::SQRT_2 * size;
        let one = size.hypot(f64::max(size - 3.0, 0.0)) + 0.5;
        let both = f64::max(diagonal - 3.0, 0.0) + 1.0;
        let best = diagonal.min(one).min(both);
        let found = warm.objective().unwrap();
        assert!((found - best).abs() < 1e-5, "{found} instead of {best} for {value}");
    }
}

/// The cuts of cones hold for all values of the parameters: only the first solve needs the conic
/// program of the root.
#[test]
fn cuts_of_cones_are_kept() {
    let mut model = Model::new("hover");
    let on = model.binary_family("on", 4).unwrap();
    let thrust = model.continuous_family("thrust", 8, -2.0, 2.0).unwrap();
    let wind = model.parameter("wind", 1.0, -2.0, 2.0).unwrap();
    for k in 0..4 {
        let pair = [thrust[2 * k], thrust[2 * k + 1]];
        model.add(("most", k), norm(pair).le(1.5 * on[k])).unwrap();
    }
    let sum = |at: usize| (0..4).map(|k| thrust[2 * k + at]).sum::<Affine>();
    let miss = model.norm("miss", [sum(0) - 1.5 * wind, sum(1) - 0.5 - 0.25 * wind]).unwrap();
    model.minimize(2.0 * miss + 0.3 * on.iter().sum::<Affine>() + 0.1 * thrust[0]).unwrap();
    let options = Options::default().with_deterministic(true);
    let (mut solver, mut cold) = (BranchAndBound::new(options), BranchAndBound::default());
    let mut prepared = solver.prepare(&model).unwrap();
    let mut conic = Vec::new();
    for value in [1.0, 1.0, 1.01, 0.98, 1.5, -1.0] {
        let warm = prepared.solve(&[(wind, value)], &mut Control::default()).unwrap();
        model.set_parameter(wind, value).unwrap();
        agree(&cold.solve(&model).unwrap(), &warm);
        conic.push(warm.statistics().relaxation_counts.clarabel);
    }
    // Leaves are solved as conic programs in any case.
    assert!(conic[1].max(conic[2]) < conic[0], "{conic:?}");
}
