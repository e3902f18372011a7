//! Plans are runs from their starts: beside exact rational runs of their own inputs.

use carom::hybrid::{
    HybridPlan, HybridProgram, HybridRun, HybridSystem, LinearSystem, RecedingHorizon, RunError,
    ShortestOptions, ShortestStatus, State,
};
use carom::prelude::*;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};
use proptest::prelude::*;

use crate::common::config;

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("finite")
}

/// `x⁺ = A x + B u + c`, within `±wide` of 0 by state.
#[derive(Debug, Clone)]
struct Plant {
    a: Vec<Vec<f64>>,
    b: Vec<Vec<f64>>,
    c: Vec<f64>,
    wide: f64,
    /// The range of each input is `±push`.
    push: f64,
}

struct Stated {
    system: HybridSystem,
    states: Vec<State>,
    inputs: Vec<Input>,
}

impl Plant {
    fn stated(&self) -> Stated {
        let mut system = HybridSystem::new(1.0);
        let states: Vec<State> = (0..self.a.len())
            .map(|i| system.state(&format!("x{i}"), -self.wide, self.wide).unwrap())
            .collect();
        let inputs: Vec<Input> = (0..self.b[0].len())
            .map(|u| system.input(&format!("u{u}"), -self.push, self.push).unwrap())
            .collect();
        let next = (0..states.len()).map(|i| {
            let own = states.iter().zip(&self.a[i]).map(|(x, a)| *a * *x);
            let pushes = inputs.iter().zip(&self.b[i]).map(|(u, b)| *b * *u);
            let sum = own.chain(pushes).fold(Affine::constant(self.c[i]), |sum, term| sum + term);
            states[i].is(sum)
        });
        let next: Vec<_> = next.collect();
        system.mode("go").unwrap().next(next).unwrap();
        Stated { system, states, inputs }
    }

    /// The run of inputs from a start, by sample and state.
    fn run(&self, start: &[f64], inputs: &[Vec<f64>]) -> Vec<Vec<BigRational>> {
        let mut run = vec![start.iter().map(|x| exact(*x)).collect::<Vec<_>>()];
        for input in inputs {
            let last = run.last().expect("the start");
            let next = (0..start.len()).map(|i| {
                let own = self.a[i].iter().zip(last).map(|(a, x)| exact(*a) * x);
                let pushes = self.b[i].iter().zip(input).map(|(b, u)| exact(*b) * exact(*u));
                own.chain(pushes).fold(exact(self.c[i]), |sum, term| sum + term)
            });
            let next = next.collect();
            run.push(next);
        }
        run
    }

    /// The bound that the documentation states.
    fn allowed(&self, value: f64, steps: usize) -> f64 {
        let step = 1e-6 * (value.abs() * 1e-3).max(1.0);
        (steps as f64 * step).min(1e-5 * 2.0 * self.wide).max(step)
    }

    /// The largest difference of a plan from the exact run of its inputs, relative to the bound.
    fn drift(&self, stated: &Stated, start: &[f64], plan: &HybridPlan) -> f64 {
        let steps = plan.steps();
        let columns: Vec<Vec<f64>> =
            stated.inputs.iter().map(|u| plan.values(*u).unwrap()).collect();
        let inputs: Vec<Vec<f64>> =
            (0..steps).map(|t| columns.iter().map(|column| column[t]).collect()).collect();
        let run = self.run(start, &inputs);
        let mut most = 0.0_f64;
        for (i, x) in stated.states.iter().enumerate() {
            let values = plan.values(*x).unwrap();
            assert_eq!(values, plan.run.state(&format!("x{i}")).unwrap(), "one plan, one run");
            for (value, sample) in values.iter().zip(&run) {
                let apart = (exact(*value) - &sample[i]).abs().to_f64().unwrap();
                most = most.max(apart / self.allowed(*value, steps));
            }
        }
        most
    }
}

/// From a start to `x0 >= level` or `x0 <= level`.
#[derive(Debug, Clone)]
struct Task {
    plant: Plant,
    start: Vec<f64>,
    level: f64,
    steps: usize,
    is_priced: bool,
}

fn quarter(most: i32) -> impl Strategy<Value = f64> {
    (-4 * most..=4 * most).prop_map(|k| f64::from(k) / 4.0)
}

fn task() -> impl Strategy<Value = Task> {
    let shape = (1..=3_usize, 0..=2_usize, prop::sample::select(vec![1.0, 8.0, 100.0, 4096.0]));
    let plant = shape.prop_flat_map(|(n, m, wide)| {
        let diagonal = prop::collection::vec(quarter(10), n);
        let others = prop::collection::vec(prop::collection::vec(quarter(1), n), n);
        let is_full = any::<bool>();
        let b = prop::collection::vec(prop::collection::vec(quarter(1), m), n);
        let at = prop::collection::vec(quarter(1), n);
        let push = prop::sample::select(vec![0.25, 1.0, 10.0]);
        (diagonal, others, is_full, b, at, push).prop_map(
            move |(diagonal, others, is_full, b, at, push)| {
                let mut a = others;
                for i in 0..n {
                    for j in 0..n {
                        match i.cmp(&j) {
                            std::cmp::Ordering::Equal => a[i][i] = diagonal[i],
                            std::cmp::Ordering::Greater if !is_full => a[i][j] = 0.0,
                            _ => {}
                        }
                    }
                }
                // At rest at `at`.
                let c = (0..n).map(|i| {
                    at[i] * wide / 4.0 - (0..n).map(|j| a[i][j] * at[j] * wide / 4.0).sum::<f64>()
                });
                let c = c.collect();
                let rest: Vec<f64> = at.iter().map(|at| at * wide / 4.0).collect();
                (Plant { a, b, c, wide, push: push * wide / 8.0 }, rest)
            },
        )
    });
    let off = prop::sample::select(vec![0.0, 0.0, 1.0, 1e-3, 1e-7]);
    let level = prop::sample::select(vec![0.5, -0.5, 0.1, 0.9]);
    (plant, off, level, 1..=40_usize, any::<bool>()).prop_map(
        |((plant, rest), off, level, steps, is_priced)| {
            let wide = plant.wide;
            let start = rest.iter().map(|x| x + off * wide / 16.0).collect();
            Task { plant, start, level: level * wide, steps, is_priced }
        },
    )
}

impl Task {
    fn program(&self, stated: &Stated) -> HybridProgram {
        let mut program = stated.system.program(self.steps).unwrap();
        let start = stated.states.iter().zip(&self.start).map(|(x, at)| x.equals(*at));
        program.start(start.collect::<Vec<_>>()).unwrap();
        program.goal([self.goal(stated)]).unwrap();
        if self.is_priced && !stated.inputs.is_empty() {
            let effort: Quadratic =
                stated.inputs.iter().map(|u| u.square()).fold(Quadratic::default(), |a, b| a + b);
            program.minimize(program.sum(effort).unwrap()).unwrap();
        }
        program
    }

    fn goal(&self, stated: &Stated) -> Row {
        match self.level > 0.0 {
            true => stated.states[0].ge(self.level),
            false => stated.states[0].le(self.level),
        }
    }

    /// By how much the only run of a plant without inputs keeps the domains up to a sample and is
    /// at the goal there.
    fn slack(&self, run: &[Vec<BigRational>], sample: usize) -> BigRational {
        let wide = exact(self.plant.wide);
        let inside = run[..=sample].iter().flatten().map(|x| &wide - x.abs());
        let at = &run[sample][0];
        let goal = match self.level > 0.0 {
            true => at - exact(self.level),
            false => exact(self.level) - at,
        };
        inside.fold(goal, |least, slack| if slack < least { slack } else { least })
    }
}

proptest! {
    #![proptest_config(config(120, "tests/regressions/runs.txt"))]

    #[test]
    fn plans_are_exact_runs(task in task()) {
        let stated = task.plant.stated();
        let found = task.program(&stated).solve(&mut BranchAndBound::default());
        if let Ok(plan) = &found {
            let drift = task.plant.drift(&stated, &task.start, plan);
            prop_assert!(drift <= 1.0 + 1e-9, "{drift} times the bound, {}", plan.solution.termination());
            prop_assert!(plan.certificate.drift <= task.plant.allowed(task.plant.wide, task.steps));
        }
        if stated.inputs.is_empty() {
            let run = task.plant.run(&task.start, &vec![Vec::new(); task.steps]);
            let slack = task.slack(&run, task.steps);
            let margin = exact(1e-4 * task.plant.wide);
            // Between them, tolerances decide.
            if slack > BigRational::zero() {
                prop_assert!(found.is_ok(), "{}", found.unwrap_err());
            }
            if slack < -margin {
                prop_assert!(found.is_err());
            }
        }
    }

    #[test]
    fn searches_find_exact_runs(task in task()) {
        let stated = task.plant.stated();
        let start: Vec<Row> =
            stated.states.iter().zip(&task.start).map(|(x, at)| x.equals(*at)).collect();
        let options = ShortestOptions::default().with_max_steps(task.steps);
        let mut solver = BranchAndBound::default();
        let found = stated.system.shortest_with(start, [task.goal(&stated)], &options, &mut solver);
        let found = found.unwrap();
        if let Some(plan) = &found.plan {
            let drift = task.plant.drift(&stated, &task.start, plan);
            prop_assert!(drift <= 1.0 + 1e-9, "{drift} times the bound");
        }
        for (steps, drift) in &found.drifts {
            prop_assert!(matches!(drift, RunError::Drift { .. }), "{steps}: {drift}");
            prop_assert!(Some(*steps) != found.steps);
        }
        if stated.inputs.is_empty() {
            let run = task.plant.run(&task.start, &vec![Vec::new(); task.steps]);
            let margin = exact(1e-4 * task.plant.wide);
            let slacks: Vec<BigRational> =
                (1..=task.steps).map(|sample| task.slack(&run, sample)).collect();
            let first = slacks.iter().position(|slack| *slack > BigRational::zero());
            if let Some(steps) = found.steps {
                prop_assert!(slacks[steps - 1] >= -margin, "not a run: {steps} steps");
            }
            if let Some(first) = first {
                let refuted = found.refuted_steps.unwrap_or(0);
                prop_assert!(refuted <= first, "{} steps are refuted", refuted);
                prop_assert!(found.steps.is_none_or(|steps| steps <= first + 1));
            }
        }
    }
}

/// An inverted pendulum, angle (rad) and rate (rad/s), with a torque (rad/s²) if `push` is not 0.
fn pendulum(dt: f64, push: f64) -> Plant {
    let flow =
        LinearSystem::zero_order_hold([[0.0, 1.0], [9.81, 0.0]], [[0.0], [1.0]], [0.0; 2], dt);
    let flow = flow.unwrap();
    let inputs = usize::from(push != 0.0);
    let b = (0..2).map(|i| flow.b().to_rows()[i][..inputs].to_vec()).collect();
    Plant { a: flow.a().to_rows(), b, c: vec![0.0; 2], wide: 9.0, push }
}

#[test]
fn a_pendulum_at_rest_stays_there() {
    for dt in [0.1, 0.2, 0.5] {
        let mut system = HybridSystem::new(dt);
        let angle = system.state("angle", -1.5, 1.5).unwrap(); // rad
        let rate = system.state("rate", -9.0, 9.0).unwrap(); // rad/s
        system.mode("swing").unwrap().rates([angle.is(rate), rate.is(9.81 * angle)]).unwrap();
        let (start, goal) = ([angle.equals(0.0), rate.equals(0.0)], [angle.ge(1.0)]);
        let mut solver = BranchAndBound::default();
        let options = ShortestOptions::default();
        let found =
            system.shortest_with(start.clone(), goal.clone(), &options, &mut solver).unwrap();
        assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 10_000 }, "{found}");
        assert!(found.plan.is_none() && found.solves() == 0);
        // Sets or not, no plan.
        let options = ShortestOptions::default().with_reach_sets(false).with_max_steps(60);
        let found = system.shortest_with(start.clone(), goal, &options, &mut solver).unwrap();
        assert!(found.plan.is_none(), "{found}");
        for steps in [23, 40, 60] {
            let mut program = system.program(steps).unwrap();
            program.start(start.clone()).unwrap();
            program.goal([angle.ge(1.0)]).unwrap();
            assert!(program.solve(&mut solver).is_err());
        }
    }
}

#[test]
fn ten_times_nothing_is_nothing() {
    let plant = Plant { a: vec![vec![10.0]], b: vec![vec![]], c: vec![0.0], wide: 10.0, push: 0.0 };
    let Stated { system, states, .. } = plant.stated();
    let mut solver = BranchAndBound::default();
    let found = system.shortest([states[0].equals(0.0)], [states[0].ge(1.0)], &mut solver).unwrap();
    assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 10_000 });
    // From something it does get there, in the right number of steps.
    for (from, steps) in [(1e-3, 3), (2e-5, 5), (2e-7, 7), (3e-9, 9)] {
        let (start, goal) = ([states[0].equals(from)], [states[0].ge(1.0)]);
        assert_eq!(system.shortest(start, goal, &mut solver).unwrap().steps, Some(steps), "{from}");
    }
    for steps in [1, 7, 11, 20, 40, 60] {
        let mut program = system.program(steps).unwrap();
        program.start([states[0].equals(0.0)]).unwrap();
        program.goal([states[0].ge(1.0)]).unwrap();
        assert!(program.solve(&mut solver).is_err(), "{steps}");
    }
}

#[test]
fn a_pendulum_is_caught() {
    for (dt, steps) in [(0.1, 60), (0.2, 40)] {
        let plant = pendulum(dt, 3.0);
        let stated = plant.stated();
        let (angle, rate, torque) = (stated.states[0], stated.states[1], stated.inputs[0]);
        let rest = [angle.equals(0.0), rate.equals(0.0)];
        let mut program = stated.system.program(steps).unwrap();
        program.start([angle.equals(0.1), rate.equals(0.0)]).unwrap();
        program.goal(rest).unwrap();
        for is_quadratic in [true, false] {
            let effort = match is_quadratic {
                true => program.sum(torque.square()).unwrap(),
                false => program.sum_abs("effort", torque).unwrap().into(),
            };
            program.minimize(effort).unwrap();
            let plan = program.solve(&mut BranchAndBound::default()).unwrap();
            assert!(plant.drift(&stated, &[0.1, 0.0], &plan) <= 1.0);
            assert!(plan.solution.is_optimal());
            let torques = plan.values(torque).unwrap();
            let cost: f64 =
                torques.iter().map(|u| if is_quadratic { u * u } else { u.abs() }).sum();
            assert!((cost - plan.solution.objective().unwrap()).abs() <= 1e-6 * (1.0 + cost));
            assert!(plan.values(angle).unwrap()[steps].abs() <= 2e-6);
        }
    }
}

/// Over 60 steps no plan in floats is the run of its inputs by itself: a rounding grows by 10^60.
#[test]
fn inputs_are_corrected_step_by_step() {
    let plant =
        Plant { a: vec![vec![10.0]], b: vec![vec![1.0]], c: vec![0.0], wide: 5.0, push: 9.0 };
    let stated = plant.stated();
    let (x, u) = (stated.states[0], stated.inputs[0]);
    for steps in [10, 30, 60] {
        let mut program = stated.system.program(steps).unwrap();
        program.start([x.equals(0.1)]).unwrap();
        program.goal([x.equals(0.5)]).unwrap();
        program.minimize(program.sum(u.square()).unwrap()).unwrap();
        let plan = program.solve(&mut BranchAndBound::default()).unwrap();
        assert!(plant.drift(&stated, &[0.1], &plan) <= 1.0);
        assert!((plan.values(x).unwrap()[steps] - 0.5).abs() <= 1e-6);
        // Enough is 0.99 at once: then x is 0.01, 0.001, ... as long as that pays.
        assert!((plan.solution.objective().unwrap() - 0.99).abs() < 1e-4);
    }
}

/// A stored run that lives on what each step may miss.
#[test]
fn a_run_that_lives_on_violations_is_refused() {
    let plant = Plant { a: vec![vec![10.0]], b: vec![vec![]], c: vec![0.0], wide: 10.0, push: 0.0 };
    let Stated { system, .. } = plant.stated();
    let mut run: HybridRun = system.simulate(&[0.0], &vec![[]; 9]).unwrap().to_run();
    for (sample, value) in run.states[0].1.iter_mut().enumerate().skip(3) {
        *value = 1e-7 * 10.0_f64.powi(sample as i32 - 3);
    }
    run.states[0].1.truncate(10);
    let error = system.certify(&run).unwrap_err();
    let text = "the run is not certified: the plan lives on violations within the tolerance: 1e-7 at step 2 \
                grows to 1.00e-1 (state `x0` at sample 9), more than 9e-6; leave its inputs room to correct \
                that, or shorten the horizon";
    assert_eq!(error.to_string(), text);
}

#[test]
fn controllers_hand_out_runs() {
    let plant = pendulum(0.1, 3.0);
    let stated = plant.stated();
    let (angle, rate, torque) = (stated.states[0], stated.states[1], stated.inputs[0]);
    let mut program = stated.system.program(40).unwrap();
    program.goal([angle.equals(0.0), rate.equals(0.0)]).unwrap();
    let cost = program.sum(angle.square() + 0.1 * torque.square()).unwrap();
    program.minimize(cost).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    for start in [[0.1, 0.0], [0.0, 0.0], [-0.05, 0.2]] {
        let next = controller.step(&start).unwrap();
        let run = plant.run(&start, &next.inputs);
        for (sample, states) in run.iter().zip(&next.states) {
            for (x, value) in sample.iter().zip(states) {
                let apart = (exact(*value) - x).abs().to_f64().unwrap();
                assert!(apart <= plant.allowed(*value, 40), "{apart}");
            }
        }
    }
}

#[test]
fn a_controller_without_an_input_has_no_plan() {
    let plant = Plant { a: vec![vec![10.0]], b: vec![vec![]], c: vec![0.0], wide: 10.0, push: 0.0 };
    let Stated { system, states, .. } = plant.stated();
    let mut program = system.program(20).unwrap();
    program.goal([states[0].ge(1.0)]).unwrap();
    let mut solver = BranchAndBound::default();
    let mut controller = RecedingHorizon::new(program, &mut solver).unwrap();
    let next = controller.step(&[0.0]).unwrap();
    assert!(next.states.is_empty() && next.reason.is_some());
}

#[test]
fn plans_of_scenes_have_their_solution() {
    let body = Body::new("b", [0.0..=4.0, 0.0..=3.0], 1.0, 1.0)
        .with_start([0.5, 0.5, 0.0, 0.0])
        .with_goal([3.0, 1.0, 0.0, 0.0]);
    let mut program = Scene::new(0.5).with_body(body).program(12).unwrap();
    let fuel = program.fuel().unwrap();
    program.minimize(fuel).unwrap();
    let plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!(plan.solution.is_optimal() && plan.solution.gap() <= 1e-6);
    let used = plan.bodies[0].acceleration.iter().flatten().map(|a| a.abs()).sum::<f64>();
    assert!((plan.solution.objective().unwrap() - used).abs() < 1e-5);
}

/// Each step of the stored plan misses less than a tolerance; all together they carry the body
/// away.
#[test]
fn a_stored_plan_of_a_scene_is_followed_from_its_start() {
    let body = Body::new("b", [0.0..=1000.0], 10.0, 1.0).with_start([100.0, 0.0]);
    let scene = Scene::new(1.0).with_body(body);
    let mut program = scene.program(60).unwrap();
    let fuel = program.fuel().unwrap();
    program.minimize(fuel).unwrap();
    let mut plan = program.solve(&mut BranchAndBound::default()).unwrap();
    assert!(scene.replay(&plan).is_ok());
    let path = &mut plan.bodies[0];
    for t in 1..=60 {
        path.velocity[t][0] = 9e-7 * t as f64;
        path.position[t][0] = path.position[t - 1][0] + path.velocity[t - 1][0];
    }
    let error = scene.replay(&plan).unwrap_err().to_string();
    assert!(error.contains("the inputs lead elsewhere from the first sample alone"), "{error}");
}
