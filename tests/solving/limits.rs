//! Limits and interrupts at random moments.
//!
//! Whenever a solve is stopped, its bound is valid against the known optimum, its point, if any, is
//! verified, and the same solver solves the next program as if nothing had happened. Moments are
//! random and so is what a computer does in a given time: what is asserted holds at every moment.
//! `PROPTEST_CASES=1000 cargo test --release --test solving limits` takes longer and sees more.

use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

use crate::common::config;
use crate::instances::suite::{Truth, suite};
use crate::instances::unit_commitment::unit_commitment;
use carom::prelude::*;
use proptest::prelude::*;

/// Programs that take from some milliseconds to some seconds.
fn programs() -> &'static [(&'static str, Model, Truth)] {
    static PROGRAMS: OnceLock<Vec<(&'static str, Model, Truth)>> = OnceLock::new();
    PROGRAMS.get_or_init(|| {
        let names = [
            "wall_dt02_",
            "wall_dt005_e5",
            "pendulum_20",
            "cartpole_10",
            "cartpole_20",
            "boxes_20",
            "puck_15",
        ];
        let mut programs = suite(&names.map(str::to_owned));
        programs.push(("parity", parity(), Truth::Optimum(1.0)));
        programs
    })
}

/// A program that no solve finishes: a relaxation sees no parity.
fn parity() -> Model {
    let mut model = Model::new("parity");
    let odd = model.binary("odd").unwrap();
    let x = model.binary_family("x", 31).unwrap();
    let sum: Affine = x.iter().sum();
    model.add("sum", (2.0 * sum + odd).equals(31.0)).unwrap();
    model.minimize(odd).unwrap();
    model
}

/// What stops a solve. A further limit of [`Options`] is one more arm here and in [`stopped`].
#[derive(Debug, Clone)]
enum Limit {
    /// Microseconds.
    Time(u64),
    Nodes(u64),
    /// Bytes of the tree.
    Memory(u64),
    /// An interrupt from another thread after so many microseconds.
    Interrupt(u64),
    /// An interrupt from within the callback, at so many events.
    Event(u32),
    /// A time limit and an interrupt, whichever comes first.
    Both(u64, u64),
}

fn limit() -> impl Strategy<Value = Limit> {
    // All orders of magnitude alike.
    let micros = || (0.0..5.7_f64).prop_map(|exponent| 10.0_f64.powf(exponent) as u64);
    prop_oneof![
        3 => micros().prop_map(Limit::Time),
        2 => (0..60_u64).prop_map(Limit::Nodes),
        1 => (2.0..5.5_f64).prop_map(|exponent| Limit::Memory(10.0_f64.powf(exponent) as u64)),
        3 => micros().prop_map(Limit::Interrupt),
        1 => (0..12_u32).prop_map(Limit::Event),
        1 => (micros(), micros()).prop_map(|(a, b)| Limit::Both(a, b)),
    ]
}

/// Solves until the limit, or at most for a while; the termination that the limit has.
fn stopped(
    solver: &mut BranchAndBound,
    model: &Model,
    limit: &Limit,
) -> (Solution, Vec<Termination>) {
    let interrupt = Interrupt::new();
    let options = solver.options_mut();
    options.time_limit = Some(Duration::from_secs(1));
    let mut kinds = vec![Termination::TimeLimit];
    let (mut delay, mut events) = (None, None);
    match *limit {
        Limit::Time(micros) => options.time_limit = Some(Duration::from_micros(micros)),
        Limit::Nodes(nodes) => {
            options.node_limit = Some(nodes);
            kinds.push(Termination::NodeLimit);
        }
        Limit::Memory(bytes) => {
            options.memory_limit = Some(bytes);
            kinds.push(Termination::MemoryLimit);
        }
        Limit::Interrupt(micros) => delay = Some(micros),
        Limit::Event(count) => events = Some(count),
        Limit::Both(time, micros) => {
            options.time_limit = Some(Duration::from_micros(time));
            delay = Some(micros);
        }
    }
    if delay.is_some() || events.is_some() {
        kinds.push(Termination::Interrupted);
    }
    let solution = thread::scope(|scope| {
        if let Some(micros) = delay {
            let other = interrupt.clone();
            scope.spawn(move || {
                thread::sleep(Duration::from_micros(micros));
                other.trigger();
            });
        }
        let (trigger, mut seen) = (interrupt.clone(), 0);
        let mut callback = |_: &Event| {
            if events.is_some_and(|count| seen >= count) {
                trigger.trigger();
            }
            seen += 1;
        };
        let mut control =
            Control::default().with_progress(&mut callback).with_interrupt(&interrupt);
        solver.solve_with(model, &mut control)
    });
    (solution.expect("a solvable model"), kinds)
}

/// What holds for every solution of a program with this answer.
fn sound(model: &Model, solution: &Solution, truth: Truth) -> Result<(), TestCaseError> {
    let bound = solution.bound();
    prop_assert!(!bound.is_nan());
    if let Some(point) = solution.point() {
        prop_assert!(solution.verification().is_some_and(|v| v.holds()));
        prop_assert!(Verification::of(model, point, 1e-6).holds());
        prop_assert_eq!(solution.objective(), point.value(model.objective()).ok());
    } else {
        prop_assert!(solution.objective().is_none() && solution.gap().is_infinite());
    }
    match truth {
        Truth::Infeasible => prop_assert!(solution.point().is_none()),
        Truth::Optimum(optimum) => {
            // The listed optima have eight digits, found within a gap of 1e-6.
            let slack = 2e-6 * optimum.abs().max(1.0);
            prop_assert!(bound <= optimum + slack, "bound {bound} beyond {optimum}");
            let objective = solution.objective().unwrap_or(f64::INFINITY);
            prop_assert!(objective >= optimum - slack, "{objective} below {optimum}");
        }
    }
    Ok(())
}

fn finished(model: &Model, solution: &Solution, truth: Truth) -> Result<(), TestCaseError> {
    sound(model, solution, truth)?;
    match truth {
        Truth::Infeasible => prop_assert_eq!(solution.termination(), Termination::Infeasible),
        Truth::Optimum(optimum) => {
            prop_assert_eq!(solution.termination(), Termination::Optimal);
            let objective = solution.objective().expect("a point");
            prop_assert!((objective - optimum).abs() <= 2e-6 * optimum.abs().max(1.0));
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(config(24, "tests/regressions/limits.txt"))]

    #[test]
    fn a_stopped_solve_is_sound_and_leaves_no_trace(
        which in 0..programs().len(),
        limits in prop::collection::vec(limit(), 1..3),
        threads in 1..=2_usize,
    ) {
        let (name, model, truth) = &programs()[which];
        let mut solver = BranchAndBound::new(Options::default().with_threads(threads));
        for limit in &limits {
            let (solution, kinds) = stopped(&mut solver, model, limit);
            let ended = solution.termination();
            if ended.is_limit() {
                prop_assert!(kinds.contains(&ended), "{name}, {limit:?}: {ended}");
                sound(model, &solution, *truth)?;
            } else {
                finished(model, &solution, *truth)?;
            }
            if let Limit::Nodes(nodes) = *limit {
                prop_assert!(solution.statistics().nodes < nodes.max(1) + threads as u64);
            }
            *solver.options_mut() = Options::default().with_threads(threads);
        }
        // The next program, the same as ever.
        let (_, small, truth) =
            programs().iter().find(|(name, ..)| *name == "cartpole_10").expect("it is there");
        finished(small, &solver.solve(small).expect("a solvable model"), *truth)?;
    }
}

/// Rows that tie all columns in one circle: presolve stops looking for free shifts.
#[test]
fn presolve_keeps_limits() {
    let n = 100_000;
    let mut model = Model::new("circle");
    let x = model.continuous_family("x", n, 0.0, f64::INFINITY).unwrap();
    for i in 0..n {
        model.add(("c", i), (x[i] + x[(7 * i + 1) % n]).ge((i % 3) as f64)).unwrap();
    }
    model.minimize((0..n).map(|i| ((i % 9 + 1) as f64) * x[i]).sum::<Affine>()).unwrap();
    let options = Options::default().with_time_limit(Duration::from_millis(500));
    let start = Instant::now();
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.point().is_none_or(|_| solution.verification().unwrap().holds()));
    // It was a minute.
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
}

/// A covering whose factors are nearly dense: one factorisation takes several times the limit.
fn covering(n: usize) -> Model {
    let mut model = Model::new("covering");
    let x = model.binary_family("x", n).unwrap();
    let mut state = 1_u64;
    for i in 0..n {
        let mut pick = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % n
        };
        let sum: Affine = (0..4).map(|_| Affine::from(x[pick()])).sum();
        model.add(("cover", i), sum.ge(1.0)).unwrap();
    }
    model.minimize((0..n).map(|i| ((i % 7 + 1) as f64) * x[i]).sum::<Affine>()).unwrap();
    model
}

#[test]
fn factorisations_keep_limits() {
    let model = covering(14_000);
    let options = Options::default().with_time_limit(Duration::from_secs(2));
    let start = Instant::now();
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::TimeLimit);
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
}

/// The bounds of columns prove something where there is no time for more.
#[test]
fn a_solve_that_is_stopped_before_its_root_has_a_bound() {
    let model = unit_commitment(24, 32).unwrap();
    let interrupt = Interrupt::new();
    let mut stop = |event: &Event| {
        if matches!(event, Event::Presolved(..)) {
            interrupt.trigger();
        }
    };
    let mut control = Control::default().with_progress(&mut stop).with_interrupt(&interrupt);
    let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    assert_eq!(solution.termination(), Termination::Interrupted);
    assert_eq!(solution.statistics().relaxations, 0);
    let bound = solution.bound();
    assert!(bound.is_finite() && bound <= 2_789_262.0, "{bound}");
}

/// Units of which none can be off together, nor on: cheap ends of all binaries contradict each
/// other, and a local search finds a point where no node may be solved.
#[test]
fn units_run_before_their_first_relaxation() {
    let model = unit_commitment(24, 64).unwrap();
    let limit = Duration::from_secs(8);
    let options = Options::default().with_time_limit(limit).with_node_limit(0).with_cuts(false);
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::NodeLimit);
    assert_eq!(solution.statistics().relaxations, 1, "the leaf");
    assert!(solution.verification().is_some_and(Verification::holds));
    // The optimum is 5,594,936.
    assert!(solution.objective().is_some_and(|cost| cost < 1.2 * 5_594_936.0));
}

/// Before a relaxation that may never end, a point is looked for, and callbacks hear of it.
#[test]
fn a_large_program_has_a_point_before_its_first_relaxation() {
    let model = covering(14_000);
    let mut seen = Vec::new();
    let mut note = |best: &Incumbent<'_>| {
        seen.push(best.objective);
        std::ops::ControlFlow::Continue(())
    };
    let mut control = Control::default().with_incumbent(&mut note);
    let options = Options::default().with_time_limit(Duration::from_secs(6));
    let solution = BranchAndBound::new(options).solve_with(&model, &mut control).unwrap();
    assert_eq!(solution.termination(), Termination::TimeLimit);
    assert!(solution.verification().unwrap().holds());
    let objective = solution.objective().unwrap();
    assert_eq!(seen.last(), Some(&objective));
    // All columns cost 4 on average, and a quarter of them is needed at the least.
    assert!(objective < 14_000.0 * 2.0, "{objective}");
    assert!(solution.bound() <= objective);
    // Without an objective it is the answer.
    let mut model = model;
    model.minimize(0.0).unwrap();
    let options = Options::default().with_time_limit(Duration::from_secs(6));
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert!(solution.is_optimal(), "{}", solution.termination());
    assert!(solution.verification().unwrap().holds());
    assert_eq!((solution.objective(), solution.bound()), (Some(0.0), 0.0));
}
