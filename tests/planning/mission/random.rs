//! Random missions on systems without continuous inputs, compared with all sequences of modes.

use carom::hybrid::Mission;
use carom::prelude::*;
use proptest::prelude::{Just, Strategy, any, prop_oneof};
use proptest::{prop_assert, prop_assert_eq, proptest};

/// A mission before it has a system: its predicates compare the position with a number.
#[derive(Debug, Clone)]
enum Sketch {
    AtLeast(f64),
    Within(f64, f64),
    Resting,
    Not(Box<Sketch>),
    And(Box<Sketch>, Box<Sketch>),
    Or(Box<Sketch>, Box<Sketch>),
    Always(usize, usize, Box<Sketch>),
    Eventually(usize, usize, Box<Sketch>),
    Until(usize, usize, Box<Sketch>, Box<Sketch>),
    Release(usize, usize, Box<Sketch>, Box<Sketch>),
}

fn sketches() -> impl Strategy<Value = Sketch> {
    // Thresholds between the positions that there are.
    let threshold = || (-4_i32..=4).prop_map(|k| f64::from(k) + 0.25);
    let leaf = prop_oneof![
        threshold().prop_map(Sketch::AtLeast),
        (threshold(), 1_u8..4).prop_map(|(a, b)| Sketch::Within(a, a + f64::from(b))),
        Just(Sketch::Resting),
    ];
    leaf.prop_recursive(3, 12, 2, |inner| {
        let one = || inner.clone().prop_map(Box::new);
        let window = || (0_usize..4, 0_usize..4).prop_map(|(a, b)| (a, a + b));
        prop_oneof![
            one().prop_map(Sketch::Not),
            (one(), one()).prop_map(|(a, b)| Sketch::And(a, b)),
            (one(), one()).prop_map(|(a, b)| Sketch::Or(a, b)),
            (window(), one()).prop_map(|((i, j), a)| Sketch::Always(i, j, a)),
            (window(), one()).prop_map(|((i, j), a)| Sketch::Eventually(i, j, a)),
            (window(), one(), one()).prop_map(|((i, j), a, b)| Sketch::Until(i, j, a, b)),
            (window(), one(), one()).prop_map(|((i, j), a, b)| Sketch::Release(i, j, a, b)),
        ]
    })
}

impl Sketch {
    fn mission(&self, x: State, rest: Variable) -> Mission {
        let of = |inner: &Sketch| inner.mission(x, rest);
        match self {
            Sketch::AtLeast(a) => Mission::holds(format!("from {a}"), [x.ge(*a)]),
            Sketch::Within(a, b) => Mission::holds(format!("{a} to {b}"), [x.within(*a, *b)]),
            Sketch::Resting => Mission::holds("resting", [rest.equals(1.0)]),
            Sketch::Not(a) => !of(a),
            Sketch::And(a, b) => of(a) & of(b),
            Sketch::Or(a, b) => of(a) | of(b),
            Sketch::Always(i, j, a) => of(a).always(*i..=*j),
            Sketch::Eventually(i, j, a) => of(a).eventually(*i..=*j),
            Sketch::Until(i, j, a, b) => of(a).until(*i..=*j, of(b)),
            Sketch::Release(i, j, a, b) => of(a).release(*i..=*j, of(b)),
        }
    }

    /// The robustness by the definition, a sample at a time; what is beyond the end is not true.
    fn robustness(&self, run: &[(f64, Option<bool>)], k: usize, positive: bool) -> f64 {
        let never = f64::NEG_INFINITY;
        let Some(&(x, rest)) = run.get(k) else { return never };
        let signed = |value: f64| if positive { value } else { -value };
        let truth = |is: bool| if is { f64::INFINITY } else { f64::NEG_INFINITY };
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |values: &[f64]| values.iter().copied().fold(never, f64::max);
        let pick = |all: bool, values: &[f64]| if all { least(values) } else { most(values) };
        let at = |of: &Sketch, k: usize| of.robustness(run, k, positive);
        match self {
            Sketch::AtLeast(a) => signed(x - a),
            Sketch::Within(a, b) => signed((x - a).min(b - x)),
            Sketch::Resting => rest.map_or(never, |rest| signed(truth(rest))),
            Sketch::Not(a) => a.robustness(run, k, !positive),
            Sketch::And(a, b) => pick(positive, &[at(a, k), at(b, k)]),
            Sketch::Or(a, b) => pick(!positive, &[at(a, k), at(b, k)]),
            Sketch::Always(i, j, a) | Sketch::Eventually(i, j, a) => {
                let values: Vec<f64> = (k + i..=k + j).map(|t| at(a, t)).collect();
                pick(matches!(self, Sketch::Always(..)) == positive, &values)
            }
            Sketch::Until(i, j, a, b) | Sketch::Release(i, j, a, b) => {
                let is_until = matches!(self, Sketch::Until(..)) == positive;
                let values = (k + i..=k + j).map(|t| {
                    let before: Vec<f64> = (k..t).map(|s| at(a, s)).collect();
                    pick(is_until, &[at(b, t), pick(is_until, &before)])
                });
                pick(!is_until, &values.collect::<Vec<f64>>())
            }
        }
    }
}

/// A cart that goes a step to the left, rests, or goes two steps to the right.
fn cart() -> Result<(HybridSystem, State, Variable), Error> {
    let mut cart = HybridSystem::new(1.0);
    let x = cart.state("x", -20.0, 30.0)?;
    cart.mode("left")?.next([x.is(x - 1.0)])?;
    cart.mode("rest")?.next([x.is(x)])?;
    cart.mode("right")?.next([x.is(x + 2.0)])?;
    let rest = cart.transition_named("mode", "rest")?;
    Ok((cart, x, rest))
}

/// The samples of a sequence of moves: the position, and whether the step that begins there is a rest.
fn run(start: f64, moves: &[usize]) -> Vec<(f64, Option<bool>)> {
    let mut x = start;
    let mut run = Vec::new();
    for &chosen in moves {
        run.push((x, Some(chosen == 1)));
        x += [-1.0, 0.0, 2.0][chosen];
    }
    run.push((x, None));
    run
}

fn moves(steps: usize) -> impl Iterator<Item = Vec<usize>> {
    (0..3_usize.pow(steps as u32))
        .map(move |code| (0..steps).map(|k| code / 3_usize.pow(k as u32) % 3).collect())
}

proptest! {
    #![proptest_config(proptest::test_runner::Config::with_cases(60))]

    #[test]
    fn optimum_and_status_are_those_of_all_sequences(
        sketch in sketches(), steps in 2_usize..6, start in -3_i32..=3,
    ) {
        let start = f64::from(start);
        let (cart, x, rest) = cart().unwrap();
        let mission = sketch.mission(x, rest);
        let best = moves(steps)
            .map(|moves| sketch.robustness(&run(start, &moves), 0, true))
            .fold(f64::NEG_INFINITY, f64::max);
        let solver = &mut BranchAndBound::default();

        let mut program = cart.program(steps).unwrap();
        program.start([x.equals(start)]).unwrap();
        let plan = match program.require_mission("mission", &mission) {
            Ok(()) => solver.solve(program.model()).unwrap(),
            Err(error) => {
                prop_assert!(error.to_string().contains("late enough"), "{error}");
                prop_assert_eq!(best, f64::NEG_INFINITY);
                return Ok(());
            }
        };
        prop_assert_eq!(plan.is_infeasible(), best < 0.0, "{} is {}", mission, best);
        if !plan.is_infeasible() {
            let plan = program.plan(&plan).unwrap();
            prop_assert!(plan.robustness(&mission).unwrap() >= 0.0);
            // With its negation there is no plan.
            match program.require_mission("negation", &!&mission) {
                Ok(()) => prop_assert!(solver.solve(program.model()).unwrap().is_infeasible()),
                Err(error) => prop_assert!(error.to_string().contains("late enough"), "{error}"),
            }
        }

        let mut program = cart.program(steps).unwrap();
        program.start([x.equals(start)]).unwrap();
        let margin = program.mission_margin("margin", &mission, -50.0).unwrap();
        program.maximize(margin).unwrap();
        let solution = solver.solve(program.model()).unwrap();
        match best {
            f64::INFINITY => prop_assert!(!solution.is_infeasible()),
            f64::NEG_INFINITY => prop_assert!(solution.is_infeasible()),
            best => {
                let found = solution.objective().unwrap();
                prop_assert!((found - best).abs() < 1e-5, "{mission}: {found}, not {best}");
            }
        }
    }

    #[test]
    fn rows_have_the_robustness_of_the_evaluator_at_each_sequence(
        sketch in sketches(), choices in proptest::collection::vec(0_usize..3, 12), start in -3_i32..=3,
        steps in 4_usize..=12, with_rest in any::<bool>(),
    ) {
        let moves = &choices[..steps];
        let start = f64::from(start);
        let (cart, x, rest) = cart().unwrap();
        let mission = sketch.mission(x, rest);
        let expected = sketch.robustness(&run(start, moves), 0, true);
        let mut program = cart.program(steps).unwrap();
        program.start([x.equals(start)]).unwrap();
        for (k, chosen) in moves.iter().enumerate() {
            let taken = cart.transition_named("mode", ["left", "rest", "right"][*chosen]).unwrap();
            if with_rest || *chosen != 1 {
                let row = program.at(Affine::from(taken).equals(1.0), k).unwrap();
                program.add(("moves", k), row).unwrap();
            } else {
                let row = program.at(Affine::from(rest).ge(1.0), k).unwrap();
                program.add(("moves", k), row).unwrap();
            }
        }
        let Ok(margin) = program.mission_margin("margin", &mission, -50.0) else {
            prop_assert_eq!(expected, f64::NEG_INFINITY);
            return Ok(());
        };
        program.maximize(margin).unwrap();
        let solution = BranchAndBound::default().solve(program.model()).unwrap();
        match expected {
            f64::INFINITY => prop_assert!(!solution.is_infeasible()),
            f64::NEG_INFINITY => prop_assert!(solution.is_infeasible()),
            expected => {
                let plan = program.plan(&solution).unwrap();
                let found = solution.objective().unwrap();
                prop_assert!((found - expected).abs() < 1e-5, "{mission}: {found}, not {expected}");
                prop_assert!((plan.robustness(&mission).unwrap() - expected).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_text_that_is_read_says_the_same(sketch in sketches()) {
        let (_, x, rest) = cart().unwrap();
        let mission = sketch.mission(x, rest);
        let read = Mission::parse(&mission.to_string(), [mission.clone()]).unwrap();
        prop_assert_eq!(read.to_string(), mission.to_string());
        for moves in moves(4).step_by(7) {
            let run = run(0.0, &moves);
            let value = |handle: Variable, k: usize| match handle == Variable::from(x) {
                true => run.get(k).map(|sample| sample.0),
                false => run.get(k).and_then(|sample| sample.1).map(|rest| f64::from(u8::from(rest))),
            };
            let both = [&mission, &read].map(|one| one.robustness(run.len(), 1.0, value).unwrap());
            prop_assert_eq!(both[0], both[1]);
        }
    }
}
