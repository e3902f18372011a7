//! Products, absolute values, extrema and piecewise-affine functions: the lowered rows have
//! exactly the graph of the function as their feasible set; optima agree with evaluation on a
//! grid in both directions; no binary is spent where bounds or convexity decide.

use crate::common::config;
use crate::common::rows::extends;
use carom::ErrorKind;
use carom::model::{Function, PiecewiseAffine};
use carom::prelude::*;
use carom::reformulate::{self, BigMSource};
use carom::solution::{Point, Verification, ViolationKind};
use proptest::prelude::*;

const INF: f64 = f64::INFINITY;

fn solve(model: &Model) -> Solution {
    BranchAndBound::default().solve(model).unwrap()
}

/// The number of binaries and integers of the lowered model that the original has not.
fn extra_integers(model: &Model) -> usize {
    let lowered = reformulate::lower(model).unwrap();
    let extra = lowered.model().variables().skip(model.variable_count());
    extra.filter(|v| v.kind().is_integral()).count()
}

/// Keeps a variable from being relaxed to one side.
fn pin(model: &mut Model, variable: Variable) {
    model.add("pin", variable.within(-1e6, 1e6)).unwrap();
}

/// An affine expression `p x + q y + r` in halves over `x` and `y`.
#[derive(Debug, Clone, Copy)]
struct Line(i32, i32, i32);

impl Line {
    fn of(self, x: Variable, y: Variable) -> Affine {
        f64::from(self.0) * x + f64::from(self.1) * y + 0.5 * f64::from(self.2)
    }

    fn at(self, x: f64, y: f64) -> f64 {
        f64::from(self.0) * x + f64::from(self.1) * y + 0.5 * f64::from(self.2)
    }
}

fn line() -> impl Strategy<Value = Line> {
    (-2..=2_i32, -2..=2_i32, -4..=4_i32).prop_map(|(p, q, r)| Line(p, q, r))
}

/// What is tested, as data with a meaning of its own.
#[derive(Debug, Clone)]
enum Kind {
    Absolute(Line),
    Positive(Line),
    Maximum(Vec<Line>),
    Minimum(Vec<Line>),
    Binary(Line),
    Integer(Line, i32, i32),
    Piecewise(Line, Vec<(i32, i32)>),
}

fn kind() -> impl Strategy<Value = Kind> {
    let points = (-6..=0_i32, prop::collection::vec((1..=3_i32, -4..=4_i32), 2..=5));
    let points = points.prop_map(|(mut x, steps)| {
        let mut points = Vec::new();
        for (dx, y) in steps {
            points.push((x, y));
            x += dx;
        }
        points
    });
    prop_oneof![
        2 => line().prop_map(Kind::Absolute),
        1 => line().prop_map(Kind::Positive),
        2 => prop::collection::vec(line(), 1..=4).prop_map(Kind::Maximum),
        2 => prop::collection::vec(line(), 1..=4).prop_map(Kind::Minimum),
        2 => line().prop_map(Kind::Binary),
        2 => (line(), -2..=1_i32, 0..=4_i32).prop_map(|(l, p, w)| Kind::Integer(l, p, p + w)),
        3 => (line(), points).prop_map(|(line, points)| Kind::Piecewise(line, points)),
    ]
}

impl Kind {
    /// A model over `n` (a binary or integer), `x` in `[-1, 1]`, `y` in `[0, 1]` and `w`.
    fn model(&self) -> (Model, [Variable; 4]) {
        self.model_over(-1.0, 1.0)
    }

    /// The same over other bounds of `x`.
    fn model_over(&self, lower: f64, upper: f64) -> (Model, [Variable; 4]) {
        let mut model = Model::new("m");
        let n = match self {
            Kind::Integer(_, low, high) => {
                model.integer("n", f64::from(*low), f64::from(*high)).unwrap()
            }
            _ => model.binary("n").unwrap(),
        };
        let x = model.continuous("x", lower, upper).unwrap();
        let y = model.continuous("y", 0.0, 1.0).unwrap();
        let lines = |of: &[Line]| of.iter().map(|line| line.of(x, y)).collect::<Vec<_>>();
        let w = match self {
            Kind::Absolute(line) => model.absolute("w", line.of(x, y)),
            Kind::Positive(line) => model.positive_part("w", line.of(x, y)),
            Kind::Maximum(of) => model.maximum("w", lines(of)),
            Kind::Minimum(of) => model.minimum("w", lines(of)),
            Kind::Binary(line) => model.product("w", n, line.of(x, y)),
            Kind::Integer(line, ..) => model.product("w", n, line.of(x, y)),
            Kind::Piecewise(line, points) => model.piecewise("w", line.of(x, y), &graph(points)),
        };
        (model, [n, x, y, w.unwrap()])
    }

    fn value(&self, n: f64, x: f64, y: f64) -> Option<f64> {
        Some(match self {
            Kind::Absolute(line) => line.at(x, y).abs(),
            Kind::Positive(line) => line.at(x, y).max(0.0),
            Kind::Maximum(of) => of.iter().map(|line| line.at(x, y)).fold(-INF, f64::max),
            Kind::Minimum(of) => of.iter().map(|line| line.at(x, y)).fold(INF, f64::min),
            Kind::Binary(line) | Kind::Integer(line, ..) => n * line.at(x, y),
            Kind::Piecewise(line, points) => {
                let at = line.at(x, y);
                let mut pieces = points.windows(2);
                let piece =
                    pieces.find(|p| (f64::from(p[0].0)..=f64::from(p[1].0)).contains(&at))?;
                let slope = f64::from(piece[1].1 - piece[0].1) / f64::from(piece[1].0 - piece[0].0);
                f64::from(piece[0].1) + slope * (at - f64::from(piece[0].0))
            }
        })
    }

    fn integers(&self) -> std::ops::RangeInclusive<i32> {
        match self {
            Kind::Integer(_, low, high) => *low..=*high,
            _ => 0..=1,
        }
    }

    /// Points `(n, x, y)` with `x`, `y` in steps of a quarter.
    fn points(&self) -> Vec<[f64; 3]> {
        let mut points = Vec::new();
        for n in self.integers() {
            for x in -4..=4 {
                for y in 0..=4 {
                    points.push([f64::from(n), 0.25 * f64::from(x), 0.25 * f64::from(y)]);
                }
            }
        }
        points
    }
}

fn graph(points: &[(i32, i32)]) -> PiecewiseAffine {
    let points = points.iter().map(|&(x, y)| (f64::from(x), f64::from(y)));
    PiecewiseAffine::new(points).unwrap()
}

/// Whether the lowered model has a point with these first values.
fn reachable(lowered: &Model, values: &[f64]) -> bool {
    let mut fixed = lowered.clone();
    let variables: Vec<Variable> = fixed.variables().map(|v| v.id()).take(values.len()).collect();
    for (variable, &value) in variables.into_iter().zip(values) {
        let bounds = fixed.variable_ref(variable).unwrap().bounds();
        if value < bounds.lower - 1e-9 || value > bounds.upper + 1e-9 {
            return false;
        }
        fixed.fix(variable, value).unwrap();
    }
    fixed.minimize(0.0).unwrap();
    let solution = solve(&fixed);
    assert!(solution.is_optimal() || solution.is_infeasible(), "{:?}", solution.termination());
    solution.is_optimal()
}

proptest! {
    #![proptest_config(config(100, "tests/regressions/functions.txt"))]

    /// `w = f` is reachable, and `w` above or below it is not.
    #[test]
    fn rows_are_the_graph(kind in kind(), picks in prop::collection::vec(0..1000_usize, 4)) {
        let (mut model, [.., w]) = kind.model();
        pin(&mut model, w);
        let lowered = reformulate::lower(&model).unwrap();
        let points = kind.points();
        let exact = lowered.model().variables().skip(4).all(|v| v.kind().is_integral())
            && !matches!(kind, Kind::Piecewise(..));
        for pick in picks {
            let [n, x, y] = points[pick % points.len()];
            let value = kind.value(n, x, y);
            for shift in [0.0, 0.125, -0.125, 3.0] {
                let at = [n, x, y, value.unwrap_or(0.0) + shift];
                let expected = value.is_some() && shift == 0.0;
                let found = if exact {
                    extends(lowered.model(), &at)
                } else {
                    reachable(lowered.model(), &at)
                };
                prop_assert_eq!(found, expected, "{:?}\n{}\n{}", at, model, lowered.model());
                let point = Point::new(&model, at.to_vec()).unwrap();
                let verification = Verification::of(&model, &point, 1e-6);
                prop_assert_eq!(verification.holds(), expected, "{:?}", verification);
            }
        }
    }

    /// Rows, indicators and costs on `w` that push it any way: the answer is that of a model in
    /// which it cannot be relaxed.
    #[test]
    fn relaxing_one_side_changes_nothing(
        kind in kind(),
        rows in prop::collection::vec((-2..=2_i32, -2..=2_i32, -4..=4_i32, 0..6_u8), 0..=3),
        cost in (-2..=2_i32, -2..=2_i32, -2..=2_i32),
        bounds in prop_oneof![Just(None), (-4..=2_i32, 0..=6_i32).prop_map(Some)],
    ) {
        let (mut model, [_, x, y, w]) = kind.model();
        if let Some((lower, width)) = bounds {
            model.set_bounds(w, f64::from(lower), f64::from(lower + width)).unwrap();
        }
        let z = model.binary("z").unwrap();
        for (k, (p, q, limit, side)) in rows.into_iter().enumerate() {
            let sum = f64::from(p) * w + f64::from(q) * x + 0.25 * y;
            let limit = 0.5 * f64::from(limit);
            if sum.terms().is_empty() {
                continue;
            }
            let row = match side % 3 {
                0 => sum.le(limit),
                1 => sum.ge(limit),
                _ => sum.within(limit - 1.0, limit + 1.0),
            };
            if side < 3 {
                model.add(("r", k), row).unwrap();
            } else {
                model.add(("r", k), z.on().implies(row)).unwrap();
                model.add(("s", k), z.off().implies((w - x).ge(limit))).unwrap();
            }
        }
        let mut pinned = model.clone();
        pin(&mut pinned, w);
        let cost = f64::from(cost.0) * w + f64::from(cost.1) * x + f64::from(cost.2) * y + 0.5 * z;
        for sense in [Sense::Minimize, Sense::Maximize] {
            model.set_objective(sense, &cost).unwrap();
            pinned.set_objective(sense, &cost).unwrap();
            let results = [&model, &pinned].map(|model| BranchAndBound::default().solve(model));
            let [Ok(free), Ok(exact)] = &results else {
                // A big-M may need a bound that only the function's rows would give.
                prop_assert!(false, "{:?}\n{}", results, model);
                return Ok(());
            };
            prop_assert_eq!(free.termination(), exact.termination(), "{}", model);
            prop_assert_eq!(free.point().is_some(), exact.point().is_some());
            if let (Some(a), Some(b)) = (free.objective(), exact.objective()) {
                prop_assert!((a - b).abs() < 2e-5, "{} {}\n{}", a, b, model);
                prop_assert!(free.verification().unwrap().holds());
            }
        }
    }

    /// Lowering follows the bounds of the moment, leaves no trace in the model, and what it makes
    /// survives a file.
    #[test]
    fn rows_follow_the_bounds(kind in kind(), x_bounds in (-3..=0_i32, 1..=4_i32)) {
        let (mut model, [_, x, _, w]) = kind.model();
        pin(&mut model, w);
        let text = |model: &Model| reformulate::lower(model).unwrap().model().to_string();
        let before = text(&model);
        let (lower, upper) = (f64::from(x_bounds.0), f64::from(x_bounds.1));
        model.set_bounds(x, lower, upper).unwrap();
        let moved = text(&model);
        let (mut fresh, [.., w]) = kind.model_over(lower, upper);
        pin(&mut fresh, w);
        prop_assert_eq!(text(&fresh), moved.clone());
        model.set_bounds(x, -1.0, 1.0).unwrap();
        prop_assert_eq!(text(&model), before);
        model.set_bounds(x, lower, upper).unwrap();
        prop_assert_eq!(text(&model), moved.clone());
        // A file has no integers within [0, 1] that are not binary.
        if !matches!(kind, Kind::Integer(_, 0.., ..=1)) {
            let lowered = reformulate::lower(&model).unwrap();
            let file = carom::model::mps::write(lowered.model()).unwrap();
            prop_assert_eq!(carom::model::mps::read(&file).unwrap().model.to_string(), moved);
        }
    }

    /// Optima in both directions are no worse than the best point of a grid, are what the
    /// definition says at the point itself, and their bounds are no better than the grid's best.
    #[test]
    fn optima_agree_with_the_definition(
        kind in kind(), cost in (-3..=3_i32, -3..=3_i32), weight in -2..=2_i32, limit in any::<bool>(),
    ) {
        let (mut model, [n, x, y, w]) = kind.model();
        let cost = |x: f64, y: f64, w: f64| {
            f64::from(cost.0) * x + f64::from(cost.1) * y + f64::from(weight) * w
        };
        if limit {
            model.add("limit", (w + x).le(1.0)).unwrap();
        }
        let grid = kind.points().into_iter().filter_map(|[n, x, y]| {
            let w = kind.value(n, x, y)?;
            (!limit || w + x <= 1.0).then(|| cost(x, y, w))
        });
        let grid: Vec<f64> = grid.collect();
        for sense in [Sense::Minimize, Sense::Maximize] {
            let expression = cost(1.0, 0.0, 0.0) * x + cost(0.0, 1.0, 0.0) * y;
            model.set_objective(sense, expression + cost(0.0, 0.0, 1.0) * w).unwrap();
            let solution = solve(&model);
            let sign = sense.sign();
            let best = grid.iter().map(|value| sign * value).fold(INF, f64::min);
            if solution.is_infeasible() {
                prop_assert_eq!(best, INF, "{}", model);
                continue;
            }
            prop_assert!(solution.is_optimal(), "{:?}\n{}", solution.termination(), model);
            let at = |v| solution.value(v).unwrap();
            let (objective, bound) = (sign * solution.objective().unwrap(), sign * solution.bound());
            prop_assert!(objective <= best + 1e-5 && bound <= best + 1e-6, "{} {}\n{}", objective, best, model);
            if let Some(value) = kind.value(at(n).round(), at(x), at(y)) {
                prop_assert!((value - at(w)).abs() <= 1e-5, "{} instead of {}\n{}", at(w), value, model);
            }
            prop_assert!((sign * cost(at(x), at(y), at(w)) - objective).abs() <= 1e-6);
        }
    }

    /// Functions of functions, pushed either way: relaxing one side never changes the answer.
    #[test]
    fn nested_functions(
        lines in prop::collection::vec(line(), 4), weights in prop::collection::vec(-2..=2_i32, 3),
    ) {
        let mut model = Model::new("m");
        let x = model.continuous("x", -1.0, 1.0).unwrap();
        let y = model.continuous("y", 0.0, 1.0).unwrap();
        let a = model.maximum("a", [lines[0].of(x, y), lines[1].of(x, y)]).unwrap();
        let b = model.absolute("b", lines[2].of(x, y) - a).unwrap();
        let c = model.maximum("c", [a + b, lines[3].of(x, y), 2.0 * b]).unwrap();
        let value = |x: f64, y: f64| {
            let a = lines[0].at(x, y).max(lines[1].at(x, y));
            let b = (lines[2].at(x, y) - a).abs();
            let c = (a + b).max(lines[3].at(x, y)).max(2.0 * b);
            [a, b, c]
        };
        let sum = |of: [f64; 3]| weights.iter().zip(of).map(|(w, v)| f64::from(*w) * v).sum::<f64>();
        let cost: Affine =
            weights.iter().zip([a, b, c]).map(|(w, v)| f64::from(*w) * v).sum();
        for sense in [Sense::Minimize, Sense::Maximize] {
            model.set_objective(sense, &cost).unwrap();
            let solution = solve(&model);
            prop_assert!(solution.is_optimal(), "{:?}\n{}", solution.termination(), model);
            let sign = sense.sign();
            let grid = (-8..=8).flat_map(|x| (0..=8).map(move |y| (x, y)));
            let best = grid
                .map(|(x, y)| sign * sum(value(0.125 * f64::from(x), 0.125 * f64::from(y))))
                .fold(INF, f64::min);
            let (objective, bound) = (sign * solution.objective().unwrap(), sign * solution.bound());
            prop_assert!(objective <= best + 1e-5 && bound <= best + 1e-6, "{} {}\n{}", objective, best, model);
            let at = |v| solution.value(v).unwrap();
            let exact = value(at(x), at(y));
            for (v, exact) in [a, b, c].into_iter().zip(exact) {
                prop_assert!((at(v) - exact).abs() < 1e-5, "{} {}\n{}", at(v), exact, model);
            }
        }
    }
}

// -- binaries only where they are needed --------------------------------------------------------

#[test]
fn no_binary_where_bounds_decide() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 2.0, 5.0).unwrap();
    let y = model.continuous("y", -1.0, 1.0).unwrap();
    let ramp = PiecewiseAffine::new([(-9.0, 0.0), (0.0, 0.0), (2.0, 2.0), (6.0, 6.0)]).unwrap();
    let functions = [
        model.absolute("positive", x - 2.0).unwrap(),
        model.absolute("negative", 1.0 - x).unwrap(),
        model.maximum("larger", [Affine::from(x), y + 1.0, Affine::constant(2.0)]).unwrap(),
        model.minimum("smaller", [Affine::from(x), y + 1.0, x + y]).unwrap(),
        model.positive_part("part", y - 1.0).unwrap(),
        model.piecewise("one_piece", x, &ramp).unwrap(),
        model.piecewise("convex", x, &ramp).unwrap(),
    ];
    model.add("pin", functions.iter().sum::<Affine>().within(-100.0, 100.0)).unwrap();
    let lowered = reformulate::lower(&model).unwrap();
    assert_eq!(extra_integers(&model), 0, "{}", lowered.model());
    let text = lowered.model().to_string();
    for row in [
        "positive: -x + positive = -2\n",
        "negative: -x + negative = -1\n",
        "larger: -x + larger = 0\n",
        "part: part = 0\n",
        "one_piece: -x + one_piece = 0\n",
        "0 <= positive <= 3\n",
    ] {
        assert!(text.contains(row), "{row}\n{text}");
    }
}

#[test]
fn no_binary_where_convexity_decides() {
    let mut model = Model::new("m");
    // No bounds at all.
    let x = model.continuous("x", -INF, INF).unwrap();
    let y = model.continuous("y", -INF, INF).unwrap();
    let tent = PiecewiseAffine::new([(-4.0, -2.0), (0.0, 1.0), (4.0, -1.0)]).unwrap();
    let a = model.absolute("a", x - 1.0).unwrap();
    let top = model.maximum("top", [a + y, Affine::constant(0.5)]).unwrap();
    let low = model.minimum("low", [x + y, 2.0 * x]).unwrap();
    let bent = model.piecewise("bent", x, &tent).unwrap();
    model.minimize(top - low - bent).unwrap();
    model.add("effort", (a + y).le(7.0)).unwrap();
    assert_eq!(extra_integers(&model), 0);
    let solution = solve(&model);
    assert!(solution.is_optimal());
    let at = |v| solution.value(v).unwrap();
    assert!((at(a) - (at(x) - 1.0).abs()).abs() < 1e-6);
    assert!((at(low) - (at(x) + at(y)).min(2.0 * at(x))).abs() < 1e-6);
    assert!(solution.verification().unwrap().holds());

    // The other direction needs binaries, and bounds: those of the breakpoints.
    model.add("hold", (a - y).ge(0.0)).unwrap();
    assert_eq!(extra_integers(&model), 1);
    let entries = reformulate::lower(&model).unwrap().report().entries().to_vec();
    assert_eq!(entries.len(), 2);
    assert!(entries.iter().all(|entry| entry.source == BigMSource::ImpliedBounds));
    // Without them, there are none.
    let b = model.absolute("b", y - 1.0).unwrap();
    model.add("push", (b + y).ge(0.0)).unwrap();
    assert_eq!(
        reformulate::lower(&model).unwrap_err().to_string(),
        "`b` cannot be written as rows, because `y` has no lower bound and rows imply none (row \
         `push` needs an upper bound of `b`, which no row bounds from above); give `y` or `b` a \
         finite one"
    );
}

/// A variable without any cost is brought back to its function.
#[test]
fn idle_functions_are_restored() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -3.0, 3.0).unwrap();
    let a = model.absolute("a", x).unwrap();
    let b = model.maximum("b", [2.0 * a, x + 1.0]).unwrap();
    model.maximize(x).unwrap();
    assert_eq!(extra_integers(&model), 0);
    let solution = solve(&model);
    assert!(solution.is_optimal());
    assert!((solution.value(a).unwrap() - 3.0).abs() < 1e-6);
    assert!((solution.value(b).unwrap() - 6.0).abs() < 1e-6);
}

/// Bounds of the function's own variable are statements like any other.
#[test]
fn bounds_of_the_result() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -3.0, 3.0).unwrap();
    let a = model.absolute("a", x).unwrap();
    model.set_bounds(a, 2.0, INF).unwrap();
    model.minimize(x.square() + a).unwrap();
    let solution = solve(&model);
    assert!((solution.objective().unwrap() - 6.0).abs() < 1e-5);
    model.set_bounds(a, 4.0, INF).unwrap();
    assert!(solve(&model).is_infeasible());
    // Ms follow the bounds of the arguments.
    model.set_bounds(a, 0.0, INF).unwrap();
    model.maximize(a).unwrap();
    for radius in [1.0, 2.0, 30.0, 4.0] {
        model.set_bounds(x, -radius, radius).unwrap();
        let lowered = reformulate::lower(&model).unwrap();
        let entry = lowered.report().largest().unwrap();
        assert_eq!((entry.value, entry.source), (2.0 * radius, BigMSource::Bounds));
        assert!((solve(&model).objective().unwrap() - radius).abs() < 1e-6);
    }
}

#[test]
fn rows_of_each_kind() {
    let mut model = Model::new("m");
    let b = model.binary("b").unwrap();
    let n = model.integer("n", -1.0, 2.0).unwrap();
    let x = model.continuous("x", -2.0, 3.0).unwrap();
    let p = model.product("p", b, x + 1.0).unwrap();
    let q = model.product("q", n, x).unwrap();
    let a = model.absolute("a", x).unwrap();
    let law = PiecewiseAffine::new([(-2.0, 1.0), (0.0, 0.0), (1.0, 2.0)]).unwrap();
    let f = model.piecewise("f", x, &law).unwrap();
    model.add("pin", (a + f).within(-9.0, 9.0)).unwrap();
    model.minimize(p + q).unwrap();
    assert_eq!(
        model.to_string(),
        "minimize p + q\nsubject to\n  pin: -9 <= a + f <= 9\n  p = b * (x + 1)\n  q = n * (x)\n  \
         a = |x|\n  f = f(x) through (-2, 1) (0, 0) (1, 2)\nwhere\n  b binary\n  \
         -1 <= n <= 2 integer\n  -2 <= x <= 3\n  p free\n  q free\n  a >= 0\n  f free\n"
    );
    let lowered = reformulate::lower(&model).unwrap().model().to_string();
    for row in [
        "  p: b + p >= 0\n  p_2: -4 b + p <= 0\n  p_3: b - x + p <= 2\n  p_4: -4 b - x + p >= -3\n",
        "  q_9: n - q_bit1 - 2 q_bit2 = -1\n  q_10: x + q - q_part1 - 2 q_part2 = 0\n",
        "  a: -x + a >= 0\n  a_2: x + a >= 0\n  a_3: -x + a + 4 a_first1 <= 4\n  \
         a_4: x + a - 6 a_first1 <= 0\n",
        "  f: -f_share1 + f_full1 <= 0\n  f_2: -f_full1 + f_share2 <= 0\n  \
         f_3: x - 2 f_share1 - f_share2 = -2\n  f_4: f + f_share1 - 2 f_share2 = 1\n",
    ] {
        assert!(lowered.contains(row), "{row}\n{lowered}");
    }
    assert!(matches!(model.functions().next().unwrap().function(), Function::Product { .. }));
}

#[test]
fn what_is_refused() {
    let mut model = Model::new("m");
    let x = model.continuous("x", 0.0, INF).unwrap();
    let b = model.binary("b").unwrap();
    let n = model.integer("n", 0.0, INF).unwrap();
    let foreign = Model::new("other").continuous("y", 0.0, 1.0).unwrap();
    let text = |error: Error| error.to_string();
    assert_eq!(
        text(model.product("w", x, b).unwrap_err()),
        "`x` is continuous; the factor of the product `w` must be a binary or integer variable"
    );
    let none: [Affine; 0] = [];
    assert_eq!(
        text(model.maximum("w", none).unwrap_err()),
        "the number of expressions in `w` is 0; it must be at least 1"
    );
    assert!(matches!(
        model.absolute("w", foreign).unwrap_err().kind(),
        ErrorKind::ForeignHandle { .. }
    ));
    assert!(matches!(
        model.absolute("w", f64::NAN * x).unwrap_err().kind(),
        ErrorKind::NotFinite { .. }
    ));
    assert!(matches!(
        model.absolute("x", 2.0 * x).unwrap_err().kind(),
        ErrorKind::DuplicateName { .. }
    ));
    assert_eq!(
        text(PiecewiseAffine::new([(0.0, 1.0)]).unwrap_err()),
        "the number of breakpoints of a piecewise-affine function is 1; it must be at least 2"
    );
    assert_eq!(
        text(PiecewiseAffine::new([(0.0, 1.0), (2.0, 1.0), (2.0, 3.0)]).unwrap_err()),
        "the x of breakpoint 2 is 2; it must be greater than 2, the one before"
    );
    assert!(PiecewiseAffine::new([(0.0, f64::NAN), (2.0, 1.0)]).is_err());
    assert_eq!(model.variable_count(), 3);

    let unbounded = |model: &Model| text(reformulate::lower(model).unwrap_err());
    let mut product = model.clone();
    product.product("w", b, x).unwrap();
    assert_eq!(
        unbounded(&product),
        "`w` cannot be written as rows, because `x` has no upper bound; give `x` a finite one"
    );
    product.set_bounds(x, 0.0, 2.0).unwrap();
    product.product("v", n, x).unwrap();
    assert_eq!(
        unbounded(&product),
        "`v` cannot be written as rows, because `n` has no upper bound; give `n` a finite one"
    );
    product.set_bounds(n, 0.0, 5000.0).unwrap();
    assert_eq!(
        unbounded(&product),
        "the range of the integer `n` in the product `v` is 5000; it must be at most 1000; tighten \
         its bounds"
    );
    assert_eq!(
        text(carom::model::mps::write(&product).unwrap_err()),
        "MPS cannot express the function `w`; write the lowered model instead \
         (`reformulate::lower(&model)?.model()`)"
    );
}

#[test]
fn arguments_outside_the_domain() {
    let mut model = Model::new("m");
    let x = model.continuous("x", -5.0, 5.0).unwrap();
    let law = PiecewiseAffine::new([(-1.0, 1.0), (0.0, 0.0), (2.0, 4.0)]).unwrap();
    let f = model.piecewise("f", x, &law).unwrap();
    for (sense, cost, best) in [
        (Sense::Minimize, x + 0.0, -1.0),
        (Sense::Maximize, x + f, 6.0),
        (Sense::Minimize, f + 0.0, 0.0),
    ] {
        model.set_objective(sense, cost).unwrap();
        assert!((solve(&model).objective().unwrap() - best).abs() < 1e-6);
    }
    let point = Point::new(&model, vec![3.0, 4.0]).unwrap();
    let verification = Verification::of(&model, &point, 1e-6);
    assert_eq!(verification.violations()[0].kind, ViolationKind::Function);
    model.set_bounds(x, 3.0, 5.0).unwrap();
    assert!(solve(&model).is_infeasible());
    model.fix(x, 1.0).unwrap();
    assert!((solve(&model).value(f).unwrap() - 2.0).abs() < 1e-6);
}
