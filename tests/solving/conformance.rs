//! Any backend keeps the contract of [`Solver`].
//!
//! The public [`conformance`] suite is run for branch and bound with one and with two threads, and,
//! without what it does not offer, for a second implementation, written here with nothing but the
//! public interface, which shows that backends can live outside the crate. Backends that are wrong
//! on purpose show that the suite finds what it should. What the crate's own search promises
//! beyond the suite is checked here too.

use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use carom::ErrorKind;
use carom::conformance::{Capability, Suite};
use carom::prelude::*;
use carom::solution::{Outcome, Point};
use carom_conformance::internals::{Case, answers};

const INF: f64 = f64::INFINITY;

/// Slack of a bound, relative and absolute: "never beyond the optimum" up to rounding.
const ROUNDING: f64 = 1e-9;

/// The optimum of a program, and the values there.
type Truth = (f64, Vec<(Variable, f64)>);

fn model(name: &str) -> Model {
    Model::new(name)
}

// -- what every solution must satisfy -----------------------------------------------------------

/// A point is verified, a bound is never beyond the optimum, the figures fit together.
fn assert_sound(model: &Model, solution: &Solution, optimum: f64) {
    let (name, sign) = (model.name(), model.sense().sign());
    let allowed = ROUNDING * if optimum.is_finite() { optimum.abs().max(1.0) } else { 0.0 };
    assert!(
        sign * solution.bound() <= sign * optimum + allowed,
        "{name}: bound {} beyond the optimum {optimum}",
        solution.bound()
    );
    let Some(point) = solution.point() else {
        assert_eq!(solution.primal_status(), PrimalStatus::None, "{name}");
        assert_eq!(solution.objective(), None, "{name}");
        assert_eq!(solution.gap(), INF, "{name}");
        let ended = solution.termination();
        assert_ne!(ended, Termination::Optimal, "{name}: optimal without a point");
        let error = solution.value(Affine::zero()).unwrap_err().to_string();
        assert_eq!(
            error,
            format!("there is no value to read: the solve ended without a point (`{ended}`)")
        );
        return;
    };
    assert_eq!(solution.primal_status(), PrimalStatus::Feasible, "{name}");
    assert_eq!(point.as_slice().len(), model.variable_count(), "{name}");
    assert!(solution.verification().is_some_and(|v| v.holds()), "{name}: not verified");
    let again = Verification::of(model, point, 1e-6);
    assert!(again.holds(), "{name}: {:?}", again.violations());
    let objective = solution.objective().expect("a point has an objective");
    assert_eq!(objective, point.value(model.objective()).unwrap(), "{name}");
    // The point may use the feasibility tolerance, so it may be a little better than the optimum.
    let slack = 1e-5 * optimum.abs().max(1.0);
    assert!(sign * objective >= sign * optimum - slack, "{name}: {objective}, optimum {optimum}");
    let gap = (sign * (objective - solution.bound())).max(0.0);
    assert_eq!(solution.gap(), gap, "{name}");
}

fn assert_answer(options: &Options, model: &Model, solution: &Solution, answer: &Truth) {
    let (name, (optimum, values)) = (model.name(), answer);
    assert_eq!(solution.termination(), Termination::Optimal, "{name}");
    assert!(solution.is_optimal() && !solution.is_infeasible(), "{name}");
    assert_sound(model, solution, *optimum);
    let objective = solution.objective().unwrap();
    let allowed = 1e-6 * optimum.abs().max(1.0);
    assert!((objective - optimum).abs() <= allowed, "{name}: {objective}, not {optimum}");
    let gap = options.absolute_gap.max(options.relative_gap * objective.abs());
    assert!(solution.gap() <= gap, "{name}: gap {}", solution.gap());
    for &(variable, wanted) in values {
        let value = solution.value(variable).unwrap();
        assert!((value - wanted).abs() <= 1e-5, "{name}: {value}, not {wanted}");
    }
}

// -- programs -----------------------------------------------------------------------------------

/// Values 8, 9, 5, 13, weights 4, 5, 3, 7, capacity 10: the last two, 18. The relaxation has 19.14.
fn knapsack() -> (Model, Truth) {
    let mut m = model("knapsack");
    let x = m.binary_family("x", 4).unwrap();
    let sum = |a: [f64; 4]| a.iter().zip(&x).map(|(&a, x)| a * x).sum::<Affine>();
    m.add("capacity", sum([4.0, 5.0, 3.0, 7.0]).le(10.0)).unwrap();
    m.maximize(sum([8.0, 9.0, 5.0, 13.0])).unwrap();
    let answer = (18.0, x.iter().zip([0.0, 0.0, 1.0, 1.0]).collect());
    (m, answer)
}

/// Two rows over 31 binaries whose sum has even coefficients, but for `odd`, and an odd right side,
/// so `odd` is 1; but refuting 0 takes an enumeration, for neither row shows the parity of the sum.
fn parity() -> (Model, f64) {
    let mut m = model("parity");
    let odd = m.binary("odd").unwrap();
    let x = m.binary_family("x", 31).unwrap();
    let (mut first, mut second) = (Affine::from(odd), Affine::default());
    let (mut one, mut two) = (1.0, 0.0);
    for k in 0..31u32 {
        let a = f64::from(3 + k * 7 % 11);
        let b = a + f64::from(2 + 2 * (k * 5 % 7));
        first += a * x[k as usize];
        second += b * x[k as usize];
        // Every other binary on, and `odd`: a point.
        (one, two) = if k % 2 == 0 { (one + a, two + b) } else { (one, two) };
    }
    m.add("first", first.equals(one)).unwrap();
    m.add("second", second.equals(two)).unwrap();
    m.minimize(odd).unwrap();
    (m, 1.0)
}

// -- the suite ----------------------------------------------------------------------------------

/// What the crate's own search keeps beyond the public suite: limits are met where the program is
/// long, an interrupt is heard, messages are word for word.
fn check_own(solver: &mut dyn Solver) {
    check_limits(solver);
    check_interrupts(solver);
    check_events(solver);
    check_options(solver);
}

/// The solver is as good as new.
fn assert_usable(solver: &mut dyn Solver, interrupt: &Interrupt) {
    let (model, answer) = knapsack();
    let mut control = Control::default().with_interrupt(interrupt);
    let solution = solver.solve_with(&model, &mut control).unwrap();
    assert_answer(solver.options(), &model, &solution, &answer);
}

fn check_limits(solver: &mut dyn Solver) {
    let (long, optimum) = parity();
    let original = solver.options().clone();
    let threads = original.threads as u64;
    for limit in [0, 1, 2, 20] {
        *solver.options_mut() = original.clone().with_node_limit(limit);
        let solution = solver.solve(&long).unwrap();
        assert_eq!(solution.termination(), Termination::NodeLimit, "limit {limit}");
        assert!(solution.termination().is_limit());
        // Workers that are busy when the limit is reached may finish their nodes.
        assert!(solution.statistics().nodes < limit + threads, "limit {limit}");
        assert_sound(&long, &solution, optimum);
        // A small program may be finished within the limit; nothing else may be claimed.
        let (small, answer) = knapsack();
        let solution = solver.solve(&small).unwrap();
        assert_sound(&small, &solution, 18.0);
        match solution.termination() {
            Termination::Optimal => assert_answer(&original, &small, &solution, &answer),
            ended => assert_eq!(ended, Termination::NodeLimit),
        }
        *solver.options_mut() = original.clone();
        assert_usable(solver, &Interrupt::new());
    }
    *solver.options_mut() = original.clone().with_time_limit(Duration::ZERO);
    for (model, optimum) in [(&long, optimum), (&knapsack().0, 18.0)] {
        let solution = solver.solve(model).unwrap();
        assert_eq!(solution.termination(), Termination::TimeLimit);
        assert_sound(model, &solution, optimum);
    }
    *solver.options_mut() = original;
    assert_usable(solver, &Interrupt::new());
}

fn check_interrupts(solver: &mut dyn Solver) {
    let (long, optimum) = parity();
    let original = solver.options().clone();
    // A guard: an interrupt that is not heard fails the test instead of hanging it.
    *solver.options_mut() = original.clone().with_time_limit(Duration::from_secs(60));
    let interrupt = Interrupt::new();
    let interrupted = |solution: &Solution| {
        assert_eq!(solution.termination(), Termination::Interrupted);
        assert!(solution.termination().is_limit());
        assert_sound(&long, solution, optimum);
    };

    // Before the start.
    interrupt.trigger();
    let mut control = Control::default().with_interrupt(&interrupt);
    interrupted(&solver.solve_with(&long, &mut control).unwrap());
    assert!(interrupt.is_triggered(), "it stays triggered until it is reset");
    interrupt.reset();
    assert_usable(solver, &interrupt);

    // From another thread, while the search is busy.
    let (begun, wait) = mpsc::channel();
    let solution = thread::scope(|scope| {
        let other = interrupt.clone();
        scope.spawn(move || {
            if wait.recv().is_ok() {
                other.trigger();
            }
        });
        let mut callback = move |_: &Event| {
            let _ = begun.send(());
        };
        let mut control =
            Control::default().with_progress(&mut callback).with_interrupt(&interrupt);
        solver.solve_with(&long, &mut control)
    });
    interrupted(&solution.unwrap());
    interrupt.reset();
    assert_usable(solver, &interrupt);

    // From within the callback, at the first event and at the first incumbent.
    for wait_for_incumbent in [false, true] {
        let mut callback = |event: &Event| {
            if !wait_for_incumbent || matches!(event, Event::Incumbent(_)) {
                interrupt.trigger();
            }
        };
        let mut control =
            Control::default().with_progress(&mut callback).with_interrupt(&interrupt);
        let solution = solver.solve_with(&long, &mut control).unwrap();
        interrupted(&solution);
        if wait_for_incumbent {
            assert!(solution.objective().is_some_and(|objective| objective == 1.0));
        }
        interrupt.reset();
        assert_usable(solver, &interrupt);
    }
    *solver.options_mut() = original;
}

fn check_events(solver: &mut dyn Solver) {
    let (model, answer) = knapsack();
    // Often, because with several threads it is a matter of luck who finds what.
    for _ in 0..50 {
        let mut events = Vec::new();
        let mut callback = |event: &Event| events.push(event.clone());
        let mut control = Control::default().with_progress(&mut callback);
        let solution = solver.solve_with(&model, &mut control).unwrap();
        assert_answer(solver.options(), &model, &solution, &answer);

        let roots = events.iter().filter(|event| matches!(event, Event::Root(_))).count();
        assert_eq!(roots, 1, "{events:?}");
        let incumbents: Vec<f64> = events
            .iter()
            .filter(|event| matches!(event, Event::Incumbent(_)))
            .map(|event| event.progress().incumbent.expect("an incumbent"))
            .collect();
        assert!(incumbents.windows(2).all(|pair| pair[0] < pair[1]), "{incumbents:?}");
        assert_eq!(incumbents.last().copied(), solution.objective(), "the last one is returned");
        for event in &events {
            let progress = event.progress();
            assert!(progress.bound >= 18.0 - 18.0 * ROUNDING, "{event:?}");
            assert!(progress.incumbent.is_none_or(|value| value <= 18.0 + 1e-5), "{event:?}");
            assert!(progress.nodes <= solution.statistics().nodes, "{event:?}");
        }
        let nodes: Vec<u64> = events.iter().map(|event| event.progress().nodes).collect();
        assert!(nodes.is_sorted(), "{nodes:?}");
        // Those of presolve and of the relaxed root come before any node.
        let early = |event: &&Event| matches!(event, Event::Presolved(..) | Event::Relaxed(_));
        let early = events.iter().take_while(early).count();
        assert!(nodes[early..].first().is_some_and(|&nodes| nodes >= 1), "{nodes:?}");
    }
}

fn check_options(solver: &mut dyn Solver) {
    let (model, _) = knapsack();
    let original = solver.options().clone();
    type Change = fn(&mut Options);
    let sign = "must be finite and not negative";
    let feasible = "must be within [0.000000001, 0.001]";
    let integral = "must be within [0.000000001, 0.01]";
    let threads = "must be within [1, 256]";
    let refused: [(Change, &str, &str); 14] = [
        (|o| o.relative_gap = -1.0, "`relative_gap` is -1", sign),
        (|o| o.relative_gap = INF, "`relative_gap` is inf", sign),
        (|o| o.relative_gap = f64::NAN, "`relative_gap` is NaN", sign),
        (|o| o.absolute_gap = -0.5, "`absolute_gap` is -0.5", sign),
        (|o| o.absolute_gap = f64::NAN, "`absolute_gap` is NaN", sign),
        (|o| o.feasibility = 0.0, "`feasibility` is 0", feasible),
        (|o| o.feasibility = 0.1, "`feasibility` is 0.1", feasible),
        (|o| o.feasibility = f64::NAN, "`feasibility` is NaN", feasible),
        (|o| o.integrality = 0.0, "`integrality` is 0", integral),
        (|o| o.integrality = 0.5, "`integrality` is 0.5", integral),
        (|o| o.integrality = -INF, "`integrality` is -inf", integral),
        (|o| o.integrality = f64::NAN, "`integrality` is NaN", integral),
        (|o| o.threads = 0, "`threads` is 0", threads),
        (|o| o.threads = 257, "`threads` is 257", threads),
    ];
    for (change, is, must) in refused {
        change(solver.options_mut());
        let error = solver.solve(&model).expect_err(is);
        assert!(matches!(error.kind(), ErrorKind::OutOfRange { .. }), "{error:?}");
        assert_eq!(error.to_string(), format!("option {is}; it {must}"));
        *solver.options_mut() = original.clone();
        assert_usable(solver, &Interrupt::new());
    }
    // The ends of the ranges are allowed, and a wide gap is a reason to stop, not to lie.
    for (gap, tolerance) in [(0.0, 1e-9), (1e6, 1e-3)] {
        let options = original.clone().with_relative_gap(gap).with_absolute_gap(gap);
        *solver.options_mut() = options.clone();
        solver.options_mut().feasibility = tolerance;
        assert_eq!(solver.options().feasibility, tolerance);
        let solution = solver.solve(&model).unwrap();
        assert_eq!(solution.termination(), Termination::Optimal, "gap {gap}");
        assert_sound(&model, &solution, 18.0);
        assert!(solution.gap() <= gap * solution.objective().unwrap().max(1.0));
    }
    *solver.options_mut() = original;
}

#[test]
fn branch_and_bound_with_one_thread() {
    let mut solver = BranchAndBound::default();
    let report = Suite::default().run(&mut solver);
    report.assert_passed();
    assert!(report.cases().len() > 100);
    check_own(&mut solver);
}

#[test]
fn branch_and_bound_with_two_threads() {
    let mut solver = BranchAndBound::new(Options::default().with_threads(2));
    Suite::default().run(&mut solver).assert_passed();
    check_own(&mut solver);
}

/// Found by another thread than the caller's, an incumbent is reported all the same.
#[test]
fn events_of_many_threads() {
    check_events(&mut BranchAndBound::new(Options::default().with_threads(8)));
}

// -- a backend from outside ---------------------------------------------------------------------

/// Tries every assignment of a pure binary linear program.
#[derive(Default)]
struct Enumeration {
    options: Options,
}

impl Solver for Enumeration {
    fn name(&self) -> &str {
        "enumeration"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        let start = std::time::Instant::now();
        self.options.check()?;
        control.refuse_lazy_constraints(self.name())?;
        let linear = model.objective().products().is_empty();
        if !linear || model.variables().any(|v| v.kind() != VariableKind::Binary) {
            return Err(ErrorKind::Unsupported {
                solver: self.name().into(),
                what: "programs that are not linear and purely binary".into(),
                help: "use another solver".into(),
            }
            .into());
        }
        let (sign, free) = (model.sense().sign(), model.variable_count() as u32);
        let range = model.range(model.objective().affine())?;
        let open = if sign > 0.0 { range.lower } else { range.upper };
        let mut best: Option<(f64, Vec<f64>)> = None;
        let mut statistics = Statistics::default();
        let mut termination = None;
        for assignment in 0..1_u64 << free {
            let (limits, nodes) = (&self.options, statistics.nodes);
            termination = if control.interrupt().is_triggered() {
                Some(Termination::Interrupted)
            } else if limits.time_limit.is_some_and(|limit| start.elapsed() >= limit) {
                Some(Termination::TimeLimit)
            } else {
                limits.node_limit.filter(|&limit| nodes >= limit).map(|_| Termination::NodeLimit)
            };
            if termination.is_some() {
                break;
            }
            statistics.nodes += 1;
            let values: Vec<f64> =
                (0..free).map(|j| f64::from(u8::from(assignment >> j & 1 == 1))).collect();
            let point = Point::new(model, values.clone())?;
            let objective = point.value(model.objective())?;
            let better = best.as_ref().is_none_or(|(least, _)| sign * objective < sign * least);
            let found = better && Verification::of(model, &point, self.options.feasibility).holds();
            if found {
                best = Some((objective, values));
                statistics.incumbents += 1;
            }
            let incumbent = best.as_ref().map(|(objective, _)| *objective);
            let progress =
                |bound| Progress::new(statistics.nodes, 0, 0, incumbent, bound, start.elapsed());
            if statistics.nodes == 1 {
                control.report(&Event::Root(progress(open)));
            }
            if found {
                control.report(&Event::Incumbent(progress(open)));
            }
        }
        statistics.time = start.elapsed();
        let (termination, bound) = match (termination, &best) {
            (Some(limit), _) => (limit, open),
            (None, Some((objective, _))) => (Termination::Optimal, *objective),
            (None, None) => (Termination::Infeasible, sign * INF),
        };
        let values = best.map(|(_, values)| values);
        Solution::new(
            model,
            Outcome::new(termination, values, bound, statistics),
            self.options.feasibility,
        )
    }
}

/// What [`Enumeration`] is not made for.
const BEYOND_ENUMERATION: [Capability; 6] = [
    Capability::Continuous,
    Capability::Integers,
    Capability::Quadratic,
    Capability::Cones,
    Capability::Functions,
    Capability::Unbounded,
];

#[test]
fn a_backend_from_outside() {
    let mut solver = Enumeration::default();
    let report = Suite::default().without(BEYOND_ENUMERATION).run(&mut solver);
    report.assert_passed();
    let text = report.to_string();
    assert!(text.starts_with("enumeration: "), "{text}");
    assert!(text.contains("\nskipped: cases that need continuous variables\n"), "{text}");
    check_own(&mut solver);
    let mut mixed = model("mixed");
    mixed.continuous("x", 0.0, 1.0).unwrap();
    assert_eq!(
        solver.solve(&mixed).unwrap_err().to_string(),
        "enumeration does not take programs that are not linear and purely binary; use another \
         solver"
    );
}

#[test]
fn backends_agree_and_can_be_exchanged() {
    let mut solvers: Vec<Box<dyn Solver>> =
        vec![Box::new(BranchAndBound::default()), Box::new(Enumeration::default())];
    let cases = answers().unwrap();
    let binary = |case: &&Case| !case.needs.iter().any(|need| BEYOND_ENUMERATION.contains(need));
    assert!(cases.iter().filter(binary).count() >= 8);
    for case in cases.iter().filter(binary) {
        let answers: Vec<(Termination, Option<f64>)> = solvers
            .iter_mut()
            .map(|solver| solver.solve(&case.model).unwrap())
            .map(|solution| (solution.termination(), solution.objective()))
            .collect();
        assert_eq!(answers[0], answers[1], "{}", case.name);
    }
}

// -- a backend that is wrong --------------------------------------------------------------------

/// Reports what it is told to.
struct Parrot {
    options: Options,
    outcome: Outcome,
}

impl Solver for Parrot {
    fn name(&self) -> &str {
        "parrot"
    }

    fn options(&self) -> &Options {
        &self.options
    }

    fn options_mut(&mut self) -> &mut Options {
        &mut self.options
    }

    fn solve_with(&mut self, model: &Model, _: &mut Control<'_>) -> Result<Solution, Error> {
        Solution::new(model, self.outcome.clone(), self.options.feasibility)
    }
}

/// What becomes of a claim about a model.
fn claim(
    model: &Model,
    termination: Termination,
    values: Option<&[f64]>,
) -> Result<Solution, Error> {
    let values = values.map(<[f64]>::to_vec);
    let outcome = Outcome::new(termination, values, 1.0, Statistics::default());
    Parrot { options: Options::default(), outcome }.solve(model)
}

/// Solves properly and then spoils something.
struct Spoiled {
    inner: BranchAndBound,
    spoil: fn(&mut Outcome),
}

impl Solver for Spoiled {
    fn name(&self) -> &str {
        "spoiled"
    }

    fn options(&self) -> &Options {
        self.inner.options()
    }

    fn options_mut(&mut self) -> &mut Options {
        self.inner.options_mut()
    }

    fn solve_with(&mut self, model: &Model, control: &mut Control<'_>) -> Result<Solution, Error> {
        let solution = self.inner.solve_with(model, control)?;
        let mut outcome = Outcome::new(
            solution.termination(),
            solution.point().map(|point| point.as_slice().to_vec()),
            solution.bound(),
            *solution.statistics(),
        );
        (self.spoil)(&mut outcome);
        Solution::new(model, outcome, self.options().feasibility)
    }
}

/// Each way of being wrong is found, and said in words.
#[test]
fn the_suite_finds_what_is_wrong() {
    let inner = BranchAndBound::default;
    type Spoil = fn(&mut Outcome);
    let wrong: [(Spoil, &str, &str); 6] = [
        // A bound beyond the optimum of a maximisation.
        (|o| o.bound -= 0.5 * o.bound.abs(), "knapsack", "is beyond the optimum 18"),
        (|o| o.bound = f64::NAN, "knapsack", "is beyond the optimum 18"),
        (
            |o| o.termination = Termination::Infeasible,
            "linear",
            "it ended with `infeasible` instead of `optimal`",
        ),
        (|o| o.values = None, "linear", "it ended with `stalled` instead of `optimal`"),
        (
            |o| {
                if o.termination == Termination::Infeasible {
                    o.termination = Termination::Unbounded;
                }
            },
            "infeasible for integers only",
            "it ended with `unbounded` instead of `infeasible`",
        ),
        (
            |o| {
                if o.termination.is_limit() {
                    panic!("limits are not for me");
                }
            },
            "no time at all",
            "the backend panicked: limits are not for me",
        ),
    ];
    for (spoil, name, complaint) in wrong {
        let report = Suite::default().run(&mut Spoiled { inner: inner(), spoil });
        assert!(!report.passed());
        let (_, complaints) = report.failures().find(|(case, _)| *case == name).expect(name);
        assert!(complaints.iter().any(|text| text.contains(complaint)), "{complaints:?}");
        assert!(report.to_string().contains(&format!("failed: {name}\n  ")), "{report}");
    }
    // Nothing was run is not passed.
    let idle = Suite::default().without([Capability::Continuous]);
    assert!(idle.run(&mut inner()).passed());
}

#[test]
fn no_backend_can_vouch_for_itself() {
    use carom::solution::ViolationKind::{Bound, Implication, Integrality, Row};
    let mut m = model("claims");
    let x = m.continuous("x", 0.0, 10.0).unwrap();
    let z = m.binary("z").unwrap();
    m.add("row", (x + z).le(8.0)).unwrap();
    m.add("on", z.on().implies(x.ge(5.0))).unwrap();
    m.add("off", z.off().implies(x.le(3.0))).unwrap();
    m.maximize(x).unwrap();

    let right = claim(&m, Termination::Optimal, Some(&[7.0, 1.0])).unwrap();
    assert!(right.is_optimal());
    assert_eq!((right.objective(), right.value(x).unwrap()), (Some(7.0), 7.0));
    // The tolerance is 1e-6, on either side.
    assert!(claim(&m, Termination::Optimal, Some(&[7.0 + 0.9e-6, 1.0])).unwrap().is_optimal());

    // A binary that is nearly whole is made so, and then the point is checked.
    let rounded = claim(&m, Termination::Optimal, Some(&[1.0, 1e-8])).unwrap();
    assert_eq!((rounded.value(z), rounded.rounding()), (Ok(0.0), 1e-8));

    let wrong: [(&[f64], &[_]); 7] = [
        (&[7.0 + 1.1e-6, 1.0], &[(Row, "row")]),
        (&[-1.0, 0.0], &[(Bound, "x")]),
        (&[f64::NAN, 0.0], &[(Bound, "x"), (Row, "row"), (Implication, "off")]),
        (&[1.0, 1e-5], &[(Integrality, "z")]),
        (&[4.0, 0.0], &[(Implication, "off")]),
        (&[4.0, 1.0], &[(Implication, "on")]),
        (&[9.0, 2.0], &[(Bound, "z"), (Row, "row"), (Implication, "off")]),
    ];
    for (values, violated) in wrong {
        for (told, kept) in [
            (Termination::Optimal, Termination::Stalled),
            (Termination::TimeLimit, Termination::TimeLimit),
            (Termination::NodeLimit, Termination::NodeLimit),
            (Termination::Interrupted, Termination::Interrupted),
            (Termination::Stalled, Termination::Stalled),
        ] {
            let solution = claim(&m, told, Some(values)).unwrap();
            assert_eq!(solution.termination(), kept, "{values:?}");
            assert!(!solution.is_optimal() && solution.point().is_none(), "{values:?}");
            assert_eq!((solution.objective(), solution.gap()), (None, INF), "{values:?}");
            assert!(matches!(solution.value(x).unwrap_err().kind(), ErrorKind::NoPoint { .. }));
            let verification = solution.verification().expect("it says why the point was dropped");
            assert!(!verification.holds());
            let found: Vec<_> =
                verification.violations().iter().map(|v| (v.kind, v.name.as_str())).collect();
            assert_eq!(found, violated, "{values:?}");
        }
    }

    // Optimal without a point is no claim at all.
    let nothing = claim(&m, Termination::Optimal, None).unwrap();
    assert_eq!(nothing.termination(), Termination::Stalled);
    assert_eq!(nothing.bound(), 1.0);
    assert_eq!(
        claim(&m, Termination::Optimal, Some(&[1.0])).unwrap_err().to_string(),
        "the length of the point is 1; it must be 2"
    );
}
