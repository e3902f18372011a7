//! Linear steps, contact laws as text and as implications, the shortest horizon.

use carom_hybrid::internals::HasParts;
use std::cell::RefCell;
use std::time::Duration;

use crate::common::config;
use crate::rows::wall::reflecting;
use carom::collision_tolerant::{ContactLaw, Endpoint, Scenario, Wall};
use carom::hybrid::{
    HorizonEvent, HorizonModel, HorizonRefutation, HorizonVerdict, HybridRun, HybridSystem,
    LinearSystem, Matrix, Monotonicity, Restitution, ShortestOptions, ShortestStatus,
    shortest_horizon,
};
use carom::interval::Interval;
use carom::prelude::*;
use carom::solution::{Outcome, Point};
use carom_hybrid::internals::SystemVariables;
use proptest::prelude::*;

// -- linear systems -----------------------------------------------------------------------------

fn matrix<const R: usize, const C: usize>(rows: [[f64; C]; R]) -> Matrix {
    Matrix::from_fn(R, C, |i, j| rows[i][j])
}

fn assert_close(found: &Matrix, wanted: &Matrix, allowed: f64) {
    for i in 0..wanted.nrows() {
        for j in 0..wanted.ncols() {
            let (a, b) = (found[(i, j)], wanted[(i, j)]);
            assert!((a - b).abs() <= allowed, "entry ({i}, {j}): {a} instead of {b}");
        }
    }
}

#[test]
fn zero_order_hold_of_a_mass_is_the_double_integrator() {
    let (a, b) = (matrix([[0.0, 1.0], [0.0, 0.0]]), matrix([[0.0], [1.0]]));
    for dt in [0.005, 0.05, 1.0, 7.0] {
        let held = LinearSystem::zero_order_hold(&a, &b, [0.0, 0.0], dt).unwrap();
        let exact = LinearSystem::double_integrator(dt).unwrap();
        assert_close(held.a(), exact.a(), 1e-14 * dt.max(1.0));
        assert_close(held.b(), exact.b(), 1e-14 * (dt * dt).max(1.0));
    }
}

#[test]
fn zero_order_hold_of_an_oscillator_rotates() {
    // x'' = -ω² x + u.
    let omega = 3.0_f64;
    let (a, b) = (matrix([[0.0, 1.0], [-omega * omega, 0.0]]), matrix([[0.0], [1.0]]));
    for dt in [0.01, 0.4, 2.5] {
        let held = LinearSystem::zero_order_hold(&a, &b, [0.0, 0.0], dt).unwrap();
        let (sin, cos) = (omega * dt).sin_cos();
        assert_close(held.a(), &matrix([[cos, sin / omega], [-omega * sin, cos]]), 5e-14);
        assert_close(held.b(), &matrix([[(1.0 - cos) / omega.powi(2)], [sin / omega]]), 5e-14);
    }
}

#[test]
fn zero_order_hold_of_an_unstable_pole_grows() {
    for (pole, drift) in [(2.0_f64, 0.5), (-4.0, 1.0), (9.0, 0.0)] {
        let (a, b) = (matrix([[pole]]), matrix([[3.0]]));
        let held = LinearSystem::zero_order_hold(&a, &b, [drift], 0.7).unwrap();
        let growth = (0.7 * pole).exp();
        let integral = (0.7 * pole).exp_m1() / pole;
        let allowed = 1e-14 * growth.max(1.0);
        assert_close(held.a(), &matrix([[growth]]), 4.0 * allowed);
        assert_close(held.b(), &matrix([[3.0 * integral]]), 4.0 * allowed);
        assert!((held.c()[0] - drift * integral).abs() <= 4.0 * allowed);
    }
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/hybrid.txt"))]

    /// Two holds of h are one hold of 2h, when the input stays the same.
    #[test]
    fn zero_order_holds_compose(
        entries in prop::collection::vec(-3.0..3.0_f64, 9),
        inputs in prop::collection::vec(-3.0..3.0_f64, 3),
        offset in prop::collection::vec(-3.0..3.0_f64, 3),
        state in prop::collection::vec(-1.0..1.0_f64, 3),
        dt in 0.01..0.6_f64,
    ) {
        let a = Matrix::from_fn(3, 3, |i, j| entries[3 * i + j]);
        let b = Matrix::from_fn(3, 1, |i, _| inputs[i]);
        let once = LinearSystem::zero_order_hold(&a, &b, offset.clone(), dt).unwrap();
        let twice = LinearSystem::zero_order_hold(&a, &b, offset.clone(), 2.0 * dt).unwrap();
        let half_way = once.step(&state, &[0.7]).unwrap();
        let there = once.step(&half_way, &[0.7]).unwrap();
        for (left, right) in there.iter().zip(twice.step(&state, &[0.7]).unwrap()) {
            prop_assert!((left - right).abs() <= 1e-11 * (1.0 + right.abs()));
        }
    }
}

#[test]
fn predictions_as_expressions_are_steps_in_numbers() {
    let system = LinearSystem::new(
        matrix([[1.0, 0.5], [-2.0, 3.0]]),
        matrix([[0.25], [4.0]]),
        vec![7.0, -1.0],
    )
    .unwrap();
    let mut model = Model::new("m");
    let x = model.continuous_family("x", 2, -9.0, 9.0).unwrap();
    let u = model.continuous("u", -9.0, 9.0).unwrap();
    let predicted = system.predict(x.as_slice(), &[u]).unwrap();
    let point = Point::new(&model, vec![1.5, -2.0, 0.5]).unwrap();
    let values: Vec<f64> = predicted.iter().map(|e| point.value(e).unwrap()).collect();
    assert_eq!(values, system.step(&[1.5, -2.0], &[0.5]).unwrap());
}

#[test]
fn linear_systems_refuse_bad_shapes_and_numbers() {
    let square = Matrix::identity(2);
    let text = |result: Result<LinearSystem, Error>| result.unwrap_err().to_string();
    assert_eq!(
        text(LinearSystem::new(Matrix::zeros(2, 3), Matrix::zeros(2, 1), vec![0.0; 2])),
        "the state matrix A has shape 2x3; expected square, at least 1x1"
    );
    assert_eq!(
        text(LinearSystem::new(square.clone(), Matrix::zeros(3, 1), vec![0.0; 2])),
        "the input matrix B has shape 3x1; expected 2 rows"
    );
    assert_eq!(
        text(LinearSystem::new(square.clone(), Matrix::zeros(2, 1), vec![0.0])),
        "the length of the constant part c is 1; it must be 2"
    );
    assert_eq!(
        text(LinearSystem::new(square.clone(), Matrix::zeros(2, 1), vec![0.0, f64::NAN])),
        "an entry of `the linear system` is NaN; give a finite number"
    );
    assert_eq!(
        text(LinearSystem::double_integrator(f64::NAN)),
        "the time step (s) is NaN; it must be finite and positive"
    );
    let fast = Matrix::from_fn(1, 1, |_, _| 1e3);
    assert_eq!(
        text(LinearSystem::zero_order_hold(&fast, Matrix::zeros(1, 0), [0.0], 10.0)),
        "the time step of the zero-order hold is 10; it must be short enough for the discrete \
         system to stay finite"
    );
    let vehicle = LinearSystem::double_integrator(1.0).unwrap();
    assert_eq!(
        vehicle.step(&[1.0], &[0.0]).unwrap_err().to_string(),
        "the length of the state is 1; it must be 2"
    );
}

#[test]
fn horizons_out_of_range_are_refused_before_anything_is_built() {
    let still = |time_step: f64| {
        let mut system = HybridSystem::new(time_step);
        system.state("x", 0.0, 1.0).unwrap();
        system.mode("stay").unwrap().next::<Affine>([]).unwrap();
        system
    };
    for (steps, shown) in [(0, "0"), (1_000_000, "1000000")] {
        assert_eq!(
            still(0.1).program(steps).unwrap_err().to_string(),
            format!("the number of steps is {shown}; it must be from 1 to 100000")
        );
    }
    for time_step in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        let error = still(time_step).program(5).unwrap_err();
        assert!(error.to_string().starts_with("the time step (s) is"), "{error}");
    }
}

// -- contact laws -------------------------------------------------------------------------------

/// One step of a double integrator beside a wall: x, v, a and the contact.
struct OneStep {
    model: Model,
    program: SystemVariables,
}

fn one_step(wall: Wall, restitution: f64, law: ContactLaw, time_step: f64) -> OneStep {
    if law == ContactLaw::Literal {
        let rest = Endpoint::at_rest(wall.at_gap(1.0));
        let scenario = Scenario::new(rest, rest, wall, -3.0..=3.0, 30.0, time_step).with_law(law);
        let [low, high] = [-20.0, 50.0].map(|gap| wall.at_gap(gap));
        let scenario = scenario.with_domain(low.min(high)..=low.max(high));
        let scenario = scenario.with_restitution(restitution).unwrap();
        return OneStep::new(&scenario.hybrid_system().unwrap());
    }
    let [flight, hit] = reflecting(wall, restitution, time_step, None);
    let at = wall.position();
    let (low, high) = match wall.normal() > 0.0 {
        true => (at - 20.0, at + 50.0),
        false => (at - 50.0, at + 20.0),
    };
    let system = HybridSystem::new(time_step)
        .with_state("x", Interval::new(low, high))
        .with_state("v", Interval::new(-30.0, 30.0))
        .with_input("a", Interval::new(-3.0, 3.0))
        .with_transition(flight)
        .with_transition(hit);
    OneStep::new(&system)
}

fn statements(model: &Model) -> String {
    let text = model.to_string();
    let (_, rest) = text.split_once("subject to\n").unwrap();
    rest.split_once("where\n").unwrap().0.to_owned()
}

#[test]
fn the_reflecting_law_reads_like_the_law() {
    let step = one_step(Wall::above(1.0).unwrap(), 0.5, ContactLaw::Reflecting, 2.0);
    assert_eq!(
        statements(&step.model),
        "  dynamics_x[0]: -x[0] + x[1] - 2 v[0] - 2 a[0] - change_x[0] = 0
  dynamics_v[0]: -v[0] + v[1] - 2 a[0] - 1.5 impact_speed[0] = 0
  impact_x_always[0]: -1.5 x[0] - 3 v[0] - 3 a[0] - change_x[0] <= -1.5
  flight_x[0]: impact[0] = 0 implies change_x[0] <= 0
  flight_impact_speed[0]: impact[0] = 0 implies impact_speed[0] <= 0
  impact_x[0]: impact[0] = 1 implies 0.5 x[0] + x[1] + v[0] + a[0] <= 1.5
  impact_impact_speed[0]: impact[0] = 1 implies 0.5 v[0] + v[1] + a[0] = 0
"
    );
}

#[test]
fn the_reflecting_law_faces_either_way() {
    let step = one_step(Wall::below(3.0).unwrap(), 0.0, ContactLaw::Reflecting, 2.0);
    assert_eq!(
        statements(&step.model),
        "  dynamics_x[0]: -x[0] + x[1] - 2 v[0] - 2 a[0] - change_x[0] = 0
  dynamics_v[0]: -v[0] + v[1] - 2 a[0] + impact_speed[0] = 0
  impact_x_always[0]: x[0] + 2 v[0] + 2 a[0] + change_x[0] <= 3
  flight_x[0]: impact[0] = 0 implies change_x[0] >= 0
  flight_impact_speed[0]: impact[0] = 0 implies impact_speed[0] <= 0
  impact_x[0]: impact[0] = 1 implies x[1] >= 3
  impact_impact_speed[0]: impact[0] = 1 implies v[1] = 0
"
    );
}

#[test]
fn the_literal_law_reads_like_the_paper() {
    let step = one_step(Wall::above(1.0).unwrap(), 0.5, ContactLaw::Literal, 2.0);
    assert_eq!(
        statements(&step.model),
        "  dynamics_vehicle_x[0]: -vehicle_x[0] + vehicle_x[1] - 2 vehicle_vx[0] - 2 vehicle_ax[0] = 0
  dynamics_vehicle_vx[0]: -vehicle_vx[0] + vehicle_vx[1] - 2 vehicle_ax[0] = 0
  contact_1.5_vehicle_vx_+_2_vehicle_ax_=_0[0]: 1.5 vehicle_vx[0] + 2 vehicle_ax[0] + 39 contact[0] <= 39
  contact_1.5_vehicle_vx_+_2_vehicle_ax_=_0_2[0]: -1.5 vehicle_vx[0] - 2 vehicle_ax[0] + 45 contact[0] <= 45
  flight_vehicle_x_>=_1[0]: contact[0] = 0 implies -vehicle_x[0] <= -1
  flight_most_vehicle_ax[0]: contact[0] = 0 implies vehicle_ax[0] <= 3
  flight_least_vehicle_ax[0]: contact[0] = 0 implies -vehicle_ax[0] <= 3
  contact_vehicle_x_<=_1[0]: contact[0] = 1 implies vehicle_x[0] <= 1
"
    );
}

impl OneStep {
    fn new(system: &HybridSystem) -> Self {
        let mut model = Model::new("step");
        let program = system.write(&mut model, "", 1).unwrap();
        OneStep { model, program }
    }

    /// Whether the model allows a step; the auxiliary variables take their only values.
    fn allows(&self, x: f64, v: f64, a: f64, next_x: f64, next_v: f64, hits: bool) -> bool {
        let system = self.program.system();
        let taken = system.parts().choices[0].transitions[usize::from(hits)].name.clone();
        let mut run = HybridRun::default();
        let samples = [vec![x, next_x], vec![v, next_v]];
        let names = system.parts().states.iter().map(|(name, _)| name.clone());
        run.states = names.zip(samples).collect();
        run.inputs = vec![(system.parts().inputs[0].0.clone(), vec![a])];
        run.transitions = vec![("mode".into(), vec![taken])];
        let mut values = vec![f64::NAN; self.model.variable_count()];
        for (variable, value) in self.program.values(&run).unwrap() {
            values[variable.index()] = value;
        }
        let point = Point::new(&self.model, values).unwrap();
        Verification::of(&self.model, &point, 1e-7).holds()
    }
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/hybrid.txt"))]

    /// The statements of the reflecting law allow exactly what the law says, on both sides of a
    /// wall anywhere.
    #[test]
    fn the_reflecting_law_means_the_law(
        above in any::<bool>(),
        at in -5.0..5.0_f64,
        e in 0.0..=1.0_f64,
        gap in 0.0..4.0_f64,
        v in -8.0..8.0_f64,
        a in -3.0..3.0_f64,
        miss in prop_oneof![Just(0.0), -1.0..-1e-3_f64, 1e-3..1.0_f64],
    ) {
        let wall = if above { Wall::above(at) } else { Wall::below(at) }.unwrap();
        let step = one_step(wall, e, ContactLaw::Reflecting, 0.5);
        let x = wall.at_gap(gap);
        let (p, w) = (x + 0.5 * v + 0.125 * a, v + 0.5 * a);
        let (depth, rate) = (wall.gap(p), wall.rate(w));
        prop_assume!(depth.abs() > 1e-3 && rate.abs() > 1e-3);
        let hits = depth < 0.0;

        // Flight.
        prop_assert_eq!(step.allows(x, v, a, p, w, false), !hits);
        // Contact: only behind the wall, and only on the way in.
        let (mirrored, rebound) = (wall.at_gap(-e * depth), -e * w);
        prop_assert_eq!(step.allows(x, v, a, mirrored, rebound, true), hits && rate < 0.0);
        // Nothing near it.
        if miss != 0.0 {
            prop_assert!(!step.allows(x, v, a, p + miss, w, false));
            prop_assert!(!step.allows(x, v, a, p, w + miss, false));
            prop_assert!(!step.allows(x, v, a, mirrored + miss, rebound, true));
            prop_assert!(!step.allows(x, v, a, mirrored, rebound + miss, true));
        }
    }

    /// The same for the literal law.
    #[test]
    fn the_literal_law_means_the_paper(
        above in any::<bool>(),
        at in -5.0..5.0_f64,
        e in 0.0..=1.0_f64,
        gap in -3.0..3.0_f64,
        v in -8.0..8.0_f64,
        a in -6.0..6.0_f64,
    ) {
        prop_assume!(gap.abs() > 1e-3 && (a.abs() - 3.0).abs() > 1e-3);
        let wall = if above { Wall::above(at) } else { Wall::below(at) }.unwrap();
        let step = one_step(wall, e, ContactLaw::Literal, 0.5);
        let x = wall.at_gap(gap);
        let next = |a: f64| (x + 0.5 * v + 0.125 * a, v + 0.5 * a);
        let (free_x, free_v) = next(a);
        prop_assert_eq!(step.allows(x, v, a, free_x, free_v, false), gap > 0.0 && a.abs() < 3.0);
        let forced = -(1.0 + e) * v / 0.5;
        let (next_x, next_v) = next(forced);
        prop_assert!((next_v + e * v).abs() < 1e-12);
        prop_assert_eq!(step.allows(x, v, forced, next_x, next_v, true), gap < 0.0);
    }
}

#[test]
fn restitution_outside_its_range_is_refused() {
    for value in [-0.1, 1.1, f64::NAN] {
        let text = Restitution::new(value).unwrap_err().to_string();
        assert_eq!(text, format!("the restitution is {value}; it must be within [0, 1]"));
    }
    assert_eq!(
        Wall::above(f64::INFINITY).unwrap_err().to_string(),
        "the position of `wall` is inf; give a finite number"
    );
}

// -- shortest horizon ---------------------------------------------------------------------------

/// Programs whose feasibility is told to a scripted solver by their names.
struct Scripted {
    monotonicity: Monotonicity,
    lower_hint: usize,
}

impl Scripted {
    fn free() -> Self {
        Scripted { monotonicity: Monotonicity::Monotone("test".into()), lower_hint: 1 }
    }

    fn not_free() -> Self {
        Scripted { monotonicity: Monotonicity::NotMonotone("test".into()), ..Scripted::free() }
    }
}

impl HorizonModel for Scripted {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        let mut model = Model::new(steps.to_string());
        model.continuous("x", 0.0, 1.0)?;
        Ok(model)
    }

    fn monotonicity(&self) -> Monotonicity {
        self.monotonicity.clone()
    }

    fn lower_hint(&self) -> usize {
        self.lower_hint
    }
}

/// A solver that answers by a script and keeps a list of what it was asked.
struct Script<F> {
    options: Options,
    answer: F,
    asked: RefCell<Vec<usize>>,
}

impl<F: Fn(usize) -> Termination> Script<F> {
    fn new(answer: F) -> Self {
        Script { options: Options::default(), answer, asked: RefCell::default() }
    }
}

impl<F: Fn(usize) -> Termination> Solver for Script<F> {
    fn name(&self) -> &str {
        "script"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    fn solve_with(&mut self, model: &Model, _: &mut Control<'_>) -> Result<Solution, Error> {
        let steps: usize = model.name().parse().unwrap();
        self.asked.borrow_mut().push(steps);
        let termination = (self.answer)(steps);
        let values = (termination == Termination::Optimal).then(|| vec![0.5]);
        let mut statistics = Statistics::default();
        statistics.nodes = 2;
        statistics.relaxations = u64::from(steps % 2 == 1);
        Solution::new(model, Outcome::new(termination, values, 0.0, statistics), 1e-6)
    }
}

fn from(threshold: usize) -> impl Fn(usize) -> Termination {
    move |steps| if steps >= threshold { Termination::Optimal } else { Termination::Infeasible }
}

#[test]
fn bisection_finds_every_threshold_with_its_neighbour_refuted() {
    for threshold in 1..=40 {
        for (lower_hint, upper_hint) in
            [(1, None), (7, None), (50, None), (1, Some(40)), (20, Some(25)), (90, Some(5))]
        {
            let builder = Scripted { lower_hint, ..Scripted::free() };
            let mut solver = Script::new(from(threshold));
            let mut options = ShortestOptions::default().with_max_steps(100);
            options.upper_hint = upper_hint;
            let found = shortest_horizon(&builder, &options, &mut solver).unwrap();
            assert_eq!(found.status, ShortestStatus::Found);
            assert_eq!(found.steps, Some(threshold));
            assert_eq!(found.refuted_steps, (threshold > 1).then_some(threshold - 1));
            let asked = solver.asked.borrow();
            assert!(asked.contains(&threshold));
            assert!(threshold == 1 || asked.contains(&(threshold - 1)), "not assumed");
            assert!(asked.len() <= 20, "{asked:?}");
            let distinct: std::collections::BTreeSet<_> = asked.iter().collect();
            assert_eq!(distinct.len(), asked.len(), "nothing is solved twice: {asked:?}");
            assert_eq!(found.nodes(), 2 * asked.len() as u64);
        }
    }
}

#[test]
fn without_free_waiting_every_smaller_horizon_is_refuted() {
    // Feasible at 6 and from 11 on: bisection could not tell.
    let feasible = |steps| steps == 6 || steps >= 11;
    let answer = move |steps| {
        if feasible(steps) { Termination::Optimal } else { Termination::Infeasible }
    };
    let mut solver = Script::new(answer);
    let found =
        shortest_horizon(&Scripted::not_free(), &ShortestOptions::default(), &mut solver).unwrap();
    assert_eq!((found.steps, found.refuted_steps), (Some(6), Some(5)));
    assert_eq!(*solver.asked.borrow(), [1, 2, 3, 4, 5, 6]);
    let refutations: Vec<_> = found.refutations().map(|a| (a.steps, a.verdict)).collect();
    assert_eq!(refutations[0], (1, HorizonVerdict::Refuted(HorizonRefutation::Relaxation)));
    assert_eq!(refutations[1], (2, HorizonVerdict::Refuted(HorizonRefutation::Propagation)));
}

#[test]
fn an_undecided_horizon_is_neither_feasible_nor_refuted() {
    for builder in [Scripted::free(), Scripted::not_free()] {
        let answer = |steps| match steps {
            0..=8 => Termination::Infeasible,
            9 | 10 => Termination::Stalled,
            _ => Termination::Optimal,
        };
        let mut solver = Script::new(answer);
        let found = shortest_horizon(&builder, &ShortestOptions::default(), &mut solver).unwrap();
        assert_eq!(found.status, ShortestStatus::Stopped(Termination::Stalled));
        assert_eq!((found.steps, found.refuted_steps), (Some(11), Some(8)));
    }
}

#[test]
fn a_search_that_learns_nothing_gives_up() {
    for builder in [Scripted::free(), Scripted::not_free()] {
        let mut solver = Script::new(|_| Termination::NodeLimit);
        let found = shortest_horizon(&builder, &ShortestOptions::default(), &mut solver).unwrap();
        assert_eq!(found.status, ShortestStatus::Stopped(Termination::NodeLimit));
        assert_eq!((found.steps, found.refuted_steps), (None, None));
        // Looks at 1, 2, 3, 5, 9, 17 and 20 steps, and eight searches.
        assert_eq!(solver.asked.borrow().len(), 7 + 8);
    }
}

#[test]
fn no_horizon_up_to_the_limit_is_an_answer() {
    for builder in [Scripted::free(), Scripted::not_free()] {
        let mut solver = Script::new(from(1000));
        let options = ShortestOptions::default().with_max_steps(37);
        let found = shortest_horizon(&builder, &options, &mut solver).unwrap();
        assert_eq!(found.status, ShortestStatus::NoneWithin { max_steps: 37 });
        assert_eq!((found.steps, found.refuted_steps), (None, Some(37)));
        let text = "no feasible horizon up to 37 steps of the time-stepped law";
        assert_eq!(found.status.to_string(), text);
    }
}

#[test]
fn limits_and_interrupts_stop_a_search_with_what_it_knows() {
    let interrupt = Interrupt::new();
    let (mut decided, trigger) = (0, interrupt.clone());
    let progress = move |event: &HorizonEvent| {
        if let HorizonEvent::Decided(_) = event {
            decided += 1;
            if decided == 4 {
                trigger.trigger();
            }
        }
    };
    let options = ShortestOptions::default().with_interrupt(&interrupt).with_progress(progress);
    let mut solver = Script::new(from(20));
    let found = shortest_horizon(&Scripted::free(), &options, &mut solver).unwrap();
    assert_eq!(found.status, ShortestStatus::Stopped(Termination::Interrupted));
    assert_eq!(solver.asked.borrow().len(), 4);
    assert!(found.refuted_steps.is_some() && found.steps.is_none());

    let options = ShortestOptions::default().with_time_limit(Duration::ZERO);
    let found = shortest_horizon(&Scripted::free(), &options, &mut solver).unwrap();
    assert_eq!(found.status, ShortestStatus::Stopped(Termination::TimeLimit));
    assert_eq!(solver.options().time_limit, None);

    for max_steps in [0, 1_000_000] {
        let options = ShortestOptions::default().with_max_steps(max_steps);
        let error = shortest_horizon(&Scripted::free(), &options, &mut solver).unwrap_err();
        assert_eq!(
            error.to_string(),
            format!("the largest number of steps is {max_steps}; it must be from 1 to 100000")
        );
    }
}
