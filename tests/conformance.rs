//! Any backend keeps the contract of [`Solver`].
//!
//! [`check`] is a suite of small programs with answers worked out by hand: statuses, points,
//! objectives, bounds and gaps, limits and interrupts, progress events, refused options. A backend
//! passes it through the trait alone. It is run for branch and bound with one and with two
//! threads; its part for pure binary programs is run for a second implementation, written here
//! with nothing but the public interface, which shows that backends can live outside the crate.

use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use carom::prelude::*;
use carom::solution::{Outcome, Point};

const INF: f64 = f64::INFINITY;

/// Slack of a bound, relative and absolute: "never beyond the optimum" up to rounding.
const ROUNDING: f64 = 1e-9;

/// The answer of a program.
enum Answer {
    /// The optimum, and the values there where they are unique.
    Optimal(f64, Vec<(Variable, f64)>),
    Infeasible,
    Unbounded,
}
use Answer::{Infeasible, Optimal, Unbounded};

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
            format!(
                "there is no value to read: the solve ended with `{ended}` and without a point"
            )
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

fn solve_and_check(solver: &mut dyn Solver, model: &Model, answer: &Answer) {
    let solution = solver.solve(model).unwrap_or_else(|e| panic!("{}: {e}", model.name()));
    assert_answer(solver.options(), model, &solution, answer);
}

fn assert_answer(options: &Options, model: &Model, solution: &Solution, answer: &Answer) {
    let (name, worst) = (model.name(), model.sense().sign() * INF);
    let ended = solution.termination();
    match answer {
        Optimal(optimum, values) => {
            assert_eq!(ended, Termination::Optimal, "{name}");
            assert!(solution.is_optimal() && !solution.is_infeasible(), "{name}");
            assert_sound(model, solution, *optimum);
            let objective = solution.objective().unwrap();
            let allowed = 1e-6 * optimum.abs().max(1.0);
            assert!((objective - optimum).abs() <= allowed, "{name}: {objective}, not {optimum}");
            let gap = options.absolute_gap.max(options.relative_gap * objective.abs());
            assert!(solution.gap() <= gap, "{name}: gap {}", solution.gap());
            // With curvature c, a gap g leaves a distance of sqrt(g / c) to the optimal point.
            let quadratic = !model.objective().products().is_empty();
            let near = if quadratic { 1e-3 } else { 1e-5 };
            for &(variable, wanted) in values {
                let value = solution.value(variable).unwrap();
                assert!((value - wanted).abs() <= near, "{name}: {value}, not {wanted}");
            }
        }
        Infeasible => {
            assert_eq!(ended, Termination::Infeasible, "{name}");
            assert!(solution.is_infeasible() && !solution.is_optimal(), "{name}");
            assert!(solution.point().is_none(), "{name}");
            assert_eq!(solution.bound(), worst, "{name}");
            assert_sound(model, solution, worst);
        }
        Unbounded => {
            assert_eq!(ended, Termination::Unbounded, "{name}");
            assert!(!solution.is_infeasible() && !solution.is_optimal(), "{name}");
            assert_eq!(solution.bound(), -worst, "{name}");
            assert_sound(model, solution, -worst);
        }
    }
}

// -- programs over binaries ---------------------------------------------------------------------

/// Values 8, 9, 5, 13, weights 4, 5, 3, 7, capacity 10: the last two, 18. The relaxation has 19.14.
fn knapsack() -> (Model, Answer) {
    let mut m = model("knapsack");
    let x = m.binary_family("x", 4).unwrap();
    let sum = |a: [f64; 4]| a.iter().zip(&x).map(|(&a, x)| a * x).sum::<Affine>();
    m.add("capacity", sum([4.0, 5.0, 3.0, 7.0]).le(10.0)).unwrap();
    m.maximize(sum([8.0, 9.0, 5.0, 13.0])).unwrap();
    let answer = Optimal(18.0, x.iter().zip([0.0, 0.0, 1.0, 1.0]).collect());
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

fn binary_programs() -> Vec<(Model, Answer)> {
    let mut programs = vec![knapsack()];

    let mut m = model("binaries between whole numbers");
    let x = m.binary_family("x", 3).unwrap();
    let sum: Affine = x.iter().sum();
    m.add("sum", sum.within(1.2, 1.8)).unwrap();
    m.maximize(x[0]).unwrap();
    programs.push((m, Infeasible));

    programs.push((model("empty"), Optimal(0.0, vec![])));

    let mut m = model("empty, constant objective");
    m.maximize(3.5).unwrap();
    programs.push((m, Optimal(3.5, vec![])));

    let mut m = model("constant objective");
    let x = m.binary_family("x", 2).unwrap();
    m.add("one", (x[0] + x[1]).equals(1.0)).unwrap();
    m.minimize(-7.0).unwrap();
    programs.push((m, Optimal(-7.0, vec![])));

    let mut m = model("all fixed");
    let x = m.binary_family("x", 2).unwrap();
    m.fix(x[0], 1.0).unwrap();
    m.fix(x[1], 0.0).unwrap();
    m.add("sum", (x[0] + x[1]).le(1.0)).unwrap();
    m.maximize(2.0 * x[0] + 3.0 * x[1] + 0.5).unwrap();
    programs.push((m.clone(), Optimal(2.5, vec![(x[0], 1.0), (x[1], 0.0)])));
    m.add("both", (x[0] + x[1]).ge(2.0)).unwrap();
    programs.push((m, Infeasible));

    let mut m = model("equalities over binaries");
    let x = m.binary_family("x", 3).unwrap();
    m.add("two", (x[0] + x[1] + x[2]).equals(2.0)).unwrap();
    m.add("same", (x[0] - x[1]).equals(0.0)).unwrap();
    m.minimize(x[0] + 5.0 * x[2]).unwrap();
    programs.push((m, Optimal(1.0, x.iter().zip([1.0, 1.0, 0.0]).collect())));

    let mut m = model("binary without rows");
    let x = m.binary_family("x", 3).unwrap();
    m.add("cover", (x[0] + x[2]).ge(1.0)).unwrap();
    m.minimize(x[0] - x[1] + 2.0 * x[2]).unwrap();
    programs.push((m, Optimal(0.0, x.iter().zip([1.0, 1.0, 0.0]).collect())));

    // On forces both others up, off forces both down.
    for (cost, optimum, values) in
        [([3.0, -1.0, -1.0], 1.0, [1.0, 1.0, 1.0]), ([-3.0, 1.0, 1.0], 0.0, [0.0, 0.0, 0.0])]
    {
        let mut m = model("indicators over binaries");
        let x = m.binary_family("x", 3).unwrap();
        m.add("up", x[0].on().implies((x[1] + x[2]).ge(2.0))).unwrap();
        m.add("down", x[0].off().implies((x[1] + x[2]).le(0.0))).unwrap();
        m.maximize(cost.iter().zip(&x).map(|(&c, x)| c * x).sum::<Affine>()).unwrap();
        programs.push((m, Optimal(optimum, x.iter().zip(values).collect())));
    }
    programs
}

// -- programs with continuous and integer variables ---------------------------------------------

fn mixed_programs() -> Vec<(Model, Answer)> {
    let mut programs = Vec::new();

    let mut m = model("linear");
    let x = m.continuous("x", 0.0, 4.0).unwrap();
    let y = m.continuous("y", 0.0, 6.0).unwrap();
    m.add("row", (3.0 * x + 2.0 * y).le(18.0)).unwrap();
    m.maximize(3.0 * x + 5.0 * y).unwrap();
    programs.push((m, Optimal(36.0, vec![(x, 2.0), (y, 6.0)])));

    let mut m = model("integer");
    let x = m.integer("x", 0.0, INF).unwrap();
    let y = m.integer("y", 0.0, INF).unwrap();
    m.add("first", (6.0 * x + 4.0 * y).le(24.0)).unwrap();
    m.add("second", (x + 2.0 * y).le(6.0)).unwrap();
    m.maximize(5.0 * x + 4.0 * y).unwrap();
    programs.push((m, Optimal(20.0, vec![(x, 4.0), (y, 0.0)])));

    let mut m = model("mixed-integer quadratic");
    let x = m.integer("x", 0.0, 5.0).unwrap();
    let y = m.integer("y", 0.0, 5.0).unwrap();
    let z = m.continuous("z", 0.0, 0.5).unwrap();
    m.minimize((x + y - 3.4).square() + (x - 0.7).square() + (z - 1.0).square()).unwrap();
    programs.push((m, Optimal(0.5, vec![(x, 1.0), (y, 2.0), (z, 0.5)])));

    // Where off means left of 2 and on means right of 7, a target has its nearest end.
    for (target, far, value) in [(5.0, 1.0, 7.0), (4.0, 0.0, 2.0)] {
        let mut m = model("indicators");
        let x = m.continuous("x", 0.0, 10.0).unwrap();
        let z = m.binary("far").unwrap();
        m.add("right", z.on().implies(x.ge(7.0))).unwrap();
        m.add("left", z.off().implies(x.le(2.0))).unwrap();
        m.minimize((x - target).square()).unwrap();
        programs.push((m, Optimal(4.0, vec![(x, value), (z, far)])));
    }

    let mut m = model("infeasible rows and bounds");
    let x = m.continuous("x", 0.0, 2.0).unwrap();
    let y = m.continuous("y", 0.0, 2.0).unwrap();
    m.add("sum", (x + y).ge(5.0)).unwrap();
    m.maximize(x).unwrap();
    programs.push((m, Infeasible));

    let mut m = model("infeasible rows of free variables");
    let x = m.continuous("x", -INF, INF).unwrap();
    let y = m.continuous("y", -INF, INF).unwrap();
    m.add("above", (x - y).ge(1.0)).unwrap();
    m.add("below", (y - x).ge(0.0)).unwrap();
    m.minimize(x.square()).unwrap();
    programs.push((m, Infeasible));

    let mut m = model("infeasible for integers only");
    let x = m.integer("x", 0.0, 5.0).unwrap();
    let y = m.integer("y", 0.0, 5.0).unwrap();
    m.add("odd", (2.0 * x + 2.0 * y).equals(7.0)).unwrap();
    m.minimize(x + y).unwrap();
    programs.push((m, Infeasible));

    let mut m = model("infeasible although its objective falls without limit");
    let x = m.continuous("x", 0.0, INF).unwrap();
    let z = m.binary_family("z", 2).unwrap();
    m.add("between", (z[0] + z[1]).within(0.2, 0.8)).unwrap();
    m.minimize(-x).unwrap();
    programs.push((m, Infeasible));

    let mut m = model("unbounded linear");
    let x = m.continuous("x", 0.0, INF).unwrap();
    let y = m.continuous("y", 0.0, INF).unwrap();
    m.add("row", (x - y).le(1.0)).unwrap();
    m.minimize(-x).unwrap();
    programs.push((m, Unbounded));

    let mut m = model("unbounded with integers");
    let x = m.integer("x", 0.0, INF).unwrap();
    let y = m.continuous("y", -INF, INF).unwrap();
    let z = m.binary("z").unwrap();
    m.add("row", (x - y + z).le(2.0)).unwrap();
    m.maximize(x - z).unwrap();
    programs.push((m, Unbounded));

    let mut m = model("unbounded quadratic");
    let x = m.continuous("x", -INF, INF).unwrap();
    let y = m.continuous("y", -INF, INF).unwrap();
    m.minimize((x - y).square() - x).unwrap();
    programs.push((m, Unbounded));

    let mut m = model("constant objective of a mixed program");
    let x = m.continuous("x", 0.0, 1.0).unwrap();
    let k = m.integer("k", 0.0, 3.0).unwrap();
    m.add("row", (x + k).equals(2.5)).unwrap();
    m.maximize(7.0).unwrap();
    programs.push((m, Optimal(7.0, vec![(x, 0.5), (k, 2.0)])));

    let mut m = model("all fixed, mixed");
    let x = m.continuous("x", 0.25, 0.25).unwrap();
    let k = m.integer("k", -2.0, -2.0).unwrap();
    m.add("row", (x + k).within(-2.0, -1.0)).unwrap();
    m.minimize((x - k).square()).unwrap();
    programs.push((m.clone(), Optimal(5.0625, vec![(x, 0.25), (k, -2.0)])));
    m.fix(k, -1.5).unwrap();
    programs.push((m, Infeasible));

    for (lower, upper, least, most) in [(0.2, 2.7, 1.0, 2.0), (-2.7, -0.2, -2.0, -1.0)] {
        let mut m = model("integer with fractional bounds");
        let k = m.integer("k", lower, upper).unwrap();
        m.minimize(k).unwrap();
        programs.push((m.clone(), Optimal(least, vec![(k, least)])));
        m.maximize(k).unwrap();
        programs.push((m.clone(), Optimal(most, vec![(k, most)])));
        m.minimize(3.0 - k.square()).unwrap_err();
        m.minimize(k.square()).unwrap();
        let nearest = if lower > 0.0 { least } else { most };
        programs.push((m, Optimal(1.0, vec![(k, nearest)])));
    }

    let mut m = model("no whole number between the bounds");
    let k = m.integer("k", 0.2, 0.8).unwrap();
    m.maximize(k).unwrap();
    programs.push((m, Infeasible));

    let mut m = model("equalities");
    let x = m.continuous_family("x", 3, -INF, INF).unwrap();
    m.add("sum", (x[0] + x[1] + x[2]).equals(6.0)).unwrap();
    m.add("first", (x[0] - x[1]).equals(-1.0)).unwrap();
    m.add("second", (x[1] - x[2]).equals(-1.0)).unwrap();
    m.minimize(x[0]).unwrap();
    programs.push((m, Optimal(1.0, x.iter().zip([1.0, 2.0, 3.0]).collect())));

    let mut m = model("free variables");
    let x = m.continuous("x", -INF, INF).unwrap();
    let y = m.continuous("y", -INF, INF).unwrap();
    m.add("sum", (x + y).ge(4.0)).unwrap();
    m.add("difference", (x - y).le(2.0)).unwrap();
    m.minimize(2.0 * x + 3.0 * y).unwrap();
    programs.push((m, Optimal(9.0, vec![(x, 3.0), (y, 1.0)])));

    let mut m = model("variables without rows");
    let x = m.continuous("x", -INF, INF).unwrap();
    let z = m.continuous("z", -INF, INF).unwrap();
    let k = m.integer("k", 0.0, 4.0).unwrap();
    let idle = m.continuous("idle", -3.0, 8.0).unwrap();
    m.add("row", x.ge(1.0)).unwrap();
    m.minimize(x + (z + 1.0).square() - 2.0 * k).unwrap();
    programs.push((m.clone(), Optimal(-7.0, vec![(x, 1.0), (z, -1.0), (k, 4.0)])));
    m.minimize(x + idle).unwrap();
    programs.push((m, Optimal(-2.0, vec![(x, 1.0), (idle, -3.0)])));

    let mut m = model("unconstrained quadratic");
    let x = m.continuous("x", -INF, INF).unwrap();
    let y = m.continuous("y", -INF, INF).unwrap();
    m.minimize((x - 1.0).square() + (x + 2.0 * y).square() + 3.0).unwrap();
    programs.push((m.clone(), Optimal(3.0, vec![(x, 1.0), (y, -0.5)])));
    // A whole line of optima.
    m.minimize((x + y - 1.0).square()).unwrap();
    programs.push((m, Optimal(0.0, vec![])));

    let mut m = model("concave quadratic to maximise");
    let x = m.continuous("x", -1.0, 1.5).unwrap();
    let k = m.integer("k", 0.0, 5.0).unwrap();
    m.maximize(4.0 * k - k.square() - (x - 2.0).square()).unwrap();
    programs.push((m, Optimal(3.75, vec![(x, 1.5), (k, 2.0)])));

    programs
}

// -- the suite ----------------------------------------------------------------------------------

/// What any backend must pass.
fn check(solver: &mut dyn Solver) {
    check_binary(solver);
    for (model, answer) in mixed_programs() {
        solve_and_check(solver, &model, &answer);
    }
    // Once more in reverse: nothing is left over from one program to the next.
    for (model, answer) in mixed_programs().iter().rev() {
        solve_and_check(solver, model, answer);
    }
}

/// What a backend for pure binary linear programs must pass.
fn check_binary(solver: &mut dyn Solver) {
    assert!(!solver.name().is_empty());
    for (model, answer) in binary_programs() {
        solve_and_check(solver, &model, &answer);
    }
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
        assert!(nodes.first().is_some_and(|&nodes| nodes >= 1), "{nodes:?}");
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
        assert!(matches!(error, Error::OutOfRange { .. }), "{error:?}");
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
    check(&mut BranchAndBound::default());
}

#[test]
fn branch_and_bound_with_two_threads() {
    check(&mut BranchAndBound::new(Options::default().with_threads(2)));
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
        let linear = model.objective().products().is_empty();
        if !linear || model.variables().any(|v| v.kind() != VariableKind::Binary) {
            let message = "enumeration is for pure binary linear programs".into();
            return Err(Error::Backend { message });
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
            Outcome { termination, values, bound, statistics },
            self.options.feasibility,
        )
    }
}

#[test]
fn a_backend_from_outside() {
    let mut solver = Enumeration::default();
    check_binary(&mut solver);
    let (mixed, _) = mixed_programs().remove(0);
    assert_eq!(
        solver.solve(&mixed).unwrap_err().to_string(),
        "the solver broke its contract: enumeration is for pure binary linear programs"
    );
}

#[test]
fn backends_agree_and_can_be_exchanged() {
    let mut solvers: Vec<Box<dyn Solver>> =
        vec![Box::new(BranchAndBound::default()), Box::new(Enumeration::default())];
    for (model, _) in binary_programs() {
        let answers: Vec<(Termination, Option<f64>)> = solvers
            .iter_mut()
            .map(|solver| solver.solve(&model).unwrap())
            .map(|solution| (solution.termination(), solution.objective()))
            .collect();
        assert_eq!(answers[0], answers[1], "{}", model.name());
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
    let outcome = Outcome { termination, values, bound: 1.0, statistics: Statistics::default() };
    Parrot { options: Options::default(), outcome }.solve(model)
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
            assert!(matches!(solution.value(x), Err(Error::NoPoint { .. })));
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
        "the solver broke its contract: a point has 1 values for 2 variables"
    );
}
