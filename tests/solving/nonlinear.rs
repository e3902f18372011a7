//! Nonlinear programs against an optimum that is bracketed by intervals and samples.
//!
//! The bracket shares no code with the crate: expressions are trees of the test, with intervals of
//! their own, and boxes are halved until the bracket is narrow. `PROPTEST_CASES=5000 cargo test
//! --test solving -- nonlinear` runs as many programs.

use std::time::Duration;

use carom::model::Nonlinear;
use carom::prelude::*;
use proptest::prelude::*;

/// An expression over the variables of a box.
#[derive(Debug, Clone)]
enum Tree {
    Variable(usize),
    Constant(f64),
    Sum(Box<Tree>, Box<Tree>),
    Product(Box<Tree>, Box<Tree>),
    /// Divided by one more than the square of the other.
    Quotient(Box<Tree>, Box<Tree>),
    Function(Shape, Box<Tree>),
}

#[derive(Debug, Clone, Copy)]
enum Shape {
    Sin,
    Cos,
    Tanh,
    Atan,
    Square,
    Cube,
    Absolute,
    /// Of one more than the square.
    Ln,
    Sqrt,
    /// Of the hyperbolic tangent, so that it stays small.
    Exp,
}

const SHAPES: [Shape; 10] = [
    Shape::Sin,
    Shape::Cos,
    Shape::Tanh,
    Shape::Atan,
    Shape::Square,
    Shape::Cube,
    Shape::Absolute,
    Shape::Ln,
    Shape::Sqrt,
    Shape::Exp,
];

type Span = (f64, f64);

fn tree(depth: u32, variables: usize) -> BoxedStrategy<Tree> {
    let leaf = prop_oneof![
        4 => (0..variables).prop_map(Tree::Variable),
        1 => (-2.0..2.0_f64).prop_map(|c| Tree::Constant((c * 16.0).round() / 16.0)),
    ];
    leaf.prop_recursive(depth, 12, 2, |inner| {
        let pair = (inner.clone(), inner.clone());
        let boxed = |(a, b): (Tree, Tree)| (Box::new(a), Box::new(b));
        prop_oneof![
            2 => pair.clone().prop_map(boxed).prop_map(|(a, b)| Tree::Sum(a, b)),
            2 => pair.clone().prop_map(boxed).prop_map(|(a, b)| Tree::Product(a, b)),
            1 => pair.prop_map(boxed).prop_map(|(a, b)| Tree::Quotient(a, b)),
            4 => (0..SHAPES.len(), inner)
                .prop_map(|(k, of)| Tree::Function(SHAPES[k], Box::new(of))),
        ]
    })
    .boxed()
}

impl Tree {
    fn value(&self, x: &[f64]) -> f64 {
        match self {
            Tree::Variable(k) => x[*k],
            Tree::Constant(c) => *c,
            Tree::Sum(a, b) => a.value(x) + b.value(x),
            Tree::Product(a, b) => a.value(x) * b.value(x),
            Tree::Quotient(a, b) => a.value(x) / (1.0 + b.value(x).powi(2)),
            Tree::Function(shape, of) => {
                let v = of.value(x);
                match shape {
                    Shape::Sin => v.sin(),
                    Shape::Cos => v.cos(),
                    Shape::Tanh => v.tanh(),
                    Shape::Atan => v.atan(),
                    Shape::Square => v * v,
                    Shape::Cube => v * v * v,
                    Shape::Absolute => v.abs(),
                    Shape::Ln => (1.0 + v * v).ln(),
                    Shape::Sqrt => (1.0 + v * v).sqrt(),
                    Shape::Exp => v.tanh().exp(),
                }
            }
        }
    }

    fn span(&self, x: &[Span]) -> Span {
        let square = |(l, u): Span| {
            let most = (l * l).max(u * u);
            (if l <= 0.0 && u >= 0.0 { 0.0 } else { (l * l).min(u * u) }, most)
        };
        let times = |(a, b): Span, (c, d): Span| {
            let all = [a * c, a * d, b * c, b * d];
            (all.into_iter().fold(f64::MAX, f64::min), all.into_iter().fold(f64::MIN, f64::max))
        };
        let rising = |(l, u): Span, f: fn(f64) -> f64| (f(l), f(u));
        let (l, u) = match self {
            Tree::Variable(k) => x[*k],
            Tree::Constant(c) => (*c, *c),
            Tree::Sum(a, b) => {
                let (a, b) = (a.span(x), b.span(x));
                (a.0 + b.0, a.1 + b.1)
            }
            Tree::Product(a, b) => times(a.span(x), b.span(x)),
            Tree::Quotient(a, b) => {
                let square = square(b.span(x));
                times(a.span(x), (1.0 / (1.0 + square.1), 1.0 / (1.0 + square.0)))
            }
            Tree::Function(shape, of) => {
                let v = of.span(x);
                match shape {
                    Shape::Sin => wave(v, std::f64::consts::FRAC_PI_2, f64::sin),
                    Shape::Cos => wave(v, 0.0, f64::cos),
                    Shape::Tanh => rising(v, f64::tanh),
                    Shape::Atan => rising(v, f64::atan),
                    Shape::Square => square(v),
                    Shape::Cube => rising(v, |v| v * v * v),
                    Shape::Absolute => rising(square(v), f64::sqrt),
                    Shape::Ln => rising(square(v), f64::ln_1p),
                    Shape::Sqrt => rising(square(v), |s| (1.0 + s).sqrt()),
                    Shape::Exp => rising(v, |v| v.tanh().exp()),
                }
            }
        };
        let slack = 1e-12 * l.abs().max(u.abs()).max(1.0);
        (l - slack, u + slack)
    }

    fn nonlinear(&self, x: &[Variable]) -> Nonlinear {
        match self {
            Tree::Variable(k) => x[*k].into(),
            Tree::Constant(c) => (*c).into(),
            Tree::Sum(a, b) => a.nonlinear(x) + b.nonlinear(x),
            Tree::Product(a, b) => a.nonlinear(x) * b.nonlinear(x),
            Tree::Quotient(a, b) => a.nonlinear(x) / (1.0 + b.nonlinear(x).square()),
            Tree::Function(shape, of) => {
                let v = of.nonlinear(x);
                match shape {
                    Shape::Sin => v.sin(),
                    Shape::Cos => v.cos(),
                    Shape::Tanh => v.tanh(),
                    Shape::Atan => v.atan(),
                    Shape::Square => v.square(),
                    Shape::Cube => v.pow(3.0),
                    Shape::Absolute => v.abs(),
                    Shape::Ln => (1.0 + v.square()).ln(),
                    Shape::Sqrt => (1.0 + v.square()).sqrt(),
                    Shape::Exp => v.tanh().exp(),
                }
            }
        }
    }
}

/// The values of a sine or cosine.
fn wave((l, u): Span, crest: f64, f: fn(f64) -> f64) -> Span {
    use std::f64::consts::{PI, TAU};
    let contains = |first: f64| {
        let k = ((l - first - 1e-9) / TAU).ceil();
        u - l >= TAU || first + k * TAU <= u + 1e-9
    };
    let ends = (f(l).min(f(u)), f(l).max(f(u)));
    let low = if contains(crest + PI) { -1.0 } else { ends.0 };
    (low, if contains(crest) { 1.0 } else { ends.1 })
}

/// `min cost` over a box, with one row `row <= limit`, and another one that a binary switches on
/// for a reward.
#[derive(Debug, Clone)]
pub(crate) struct NonlinearCase {
    cost: Tree,
    row: Tree,
    limit: f64,
    switched: Option<(Tree, f64, f64)>,
    bounds: Vec<Span>,
    whole: bool,
}

pub(crate) fn case() -> impl Strategy<Value = NonlinearCase> {
    (1..=2_usize).prop_flat_map(|n| {
        let bounds = proptest::collection::vec((-3..=1_i32, 1..=3_i32), n);
        let switched = (tree(2, n), -1.0..1.0_f64, 0.1..1.0_f64);
        (
            tree(3, n),
            tree(2, n),
            -1.5..1.5_f64,
            proptest::option::weighted(0.3, switched),
            bounds,
            any::<bool>(),
        )
            .prop_map(move |(cost, row, limit, switched, bounds, whole)| NonlinearCase {
                cost,
                row,
                limit,
                switched,
                bounds: bounds.into_iter().map(|(l, w)| (f64::from(l), f64::from(l + w))).collect(),
                whole: whole && n == 2,
            })
    })
}

impl NonlinearCase {
    pub(crate) fn model(&self) -> Result<(Model, Vec<Variable>), Error> {
        let mut model = Model::new("case");
        let mut x = Vec::new();
        for (k, &(l, u)) in self.bounds.iter().enumerate() {
            x.push(match k == 1 && self.whole {
                true => model.integer(("x", k), l, u)?,
                false => model.continuous(("x", k), l, u)?,
            });
        }
        model.add("row", self.row.nonlinear(&x).le(self.limit))?;
        let mut cost = self.cost.nonlinear(&x);
        if let Some((tree, limit, reward)) = &self.switched {
            let on = model.binary("on")?;
            let of = model.nonlinear("switched", tree.nonlinear(&x))?;
            match of.terms().is_empty() {
                true if of.offset() > *limit => model.set_bounds(on, 0.0, 0.0)?,
                true => {}
                false => _ = model.add("switched", on.on().implies(of.le(*limit)))?,
            }
            cost -= *reward * on;
        }
        model.minimize(cost)?;
        Ok((model, x))
    }

    /// A lower and an upper bound on the optimum; the upper one is infinite if no sample is a
    /// point. Points that miss a row by up to `miss` count for the lower bound.
    pub(crate) fn bracket(&self, miss: f64) -> Span {
        let mut best = f64::INFINITY;
        let mut boxes = vec![self.bounds.clone()];
        let (mut lower, mut count) = (f64::INFINITY, 0);
        while let Some(of) = boxes.pop() {
            count += 1;
            let cost = self.least(&of, miss);
            if cost >= best - 1e-4 || cost.is_infinite() {
                lower = lower.min(cost);
                continue;
            }
            let middle: Vec<f64> = of.iter().map(|(l, u)| 0.5 * (l + u)).collect();
            best = best.min(self.at(&middle));
            let widest =
                (0..of.len()).max_by(|&a, &b| (of[a].1 - of[a].0).total_cmp(&(of[b].1 - of[b].0)));
            let Some(k) = widest.filter(|&k| of[k].1 - of[k].0 > 1e-5 && count < 6000) else {
                lower = lower.min(cost);
                continue;
            };
            let (l, u) = of[k];
            let (left, right) = match k == 1 && self.whole {
                true => {
                    let at = (0.5 * (l + u)).floor();
                    ((l, at), (at + 1.0, u))
                }
                false => ((l, 0.5 * (l + u)), (0.5 * (l + u), u)),
            };
            for half in [left, right] {
                if half.0 <= half.1 {
                    let mut next = of.clone();
                    next[k] = half;
                    boxes.push(next);
                }
            }
        }
        (lower.min(best), best)
    }

    /// The least cost over a box; infinite if no point of it keeps the row.
    fn least(&self, of: &[Span], miss: f64) -> f64 {
        if self.row.span(of).0 > self.limit + miss {
            return f64::INFINITY;
        }
        let mut cost = self.cost.span(of).0;
        if let Some((tree, limit, reward)) = &self.switched
            && tree.span(of).0 <= limit + miss
        {
            cost -= reward;
        }
        cost
    }

    /// The cost at a point; infinite if it is none.
    fn at(&self, x: &[f64]) -> f64 {
        if self.whole && x[1].fract() != 0.0 || self.row.value(x) > self.limit {
            return f64::INFINITY;
        }
        let mut cost = self.cost.value(x);
        if let Some((tree, limit, reward)) = &self.switched
            && tree.value(x) <= *limit
        {
            cost -= reward;
        }
        cost
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 120, ..ProptestConfig::default() })]

    #[test]
    fn optima_lie_in_brackets(case in case()) {
        // A row of constants that does not hold is refused.
        let Ok((model, x)) = case.model() else {
            let corner: Vec<f64> = case.bounds.iter().map(|(l, _)| *l).collect();
            prop_assert!(case.row.value(&corner) > case.limit - 1e-9);
            return Ok(());
        };
        let mut solver = BranchAndBound::default();
        solver.options_mut().relative_gap = 1e-5;
        solver.options_mut().absolute_gap = 1e-5;
        solver.options_mut().time_limit = Some(Duration::from_secs(10));
        let solution = solver.solve(&model).unwrap();
        // What the tolerance of rows allows.
        let (lower, _) = case.bracket(2e-6);
        let (_, upper) = case.bracket(0.0);
        let slack = 1e-4 * upper.abs().clamp(1.0, 1e6);
        prop_assert!(solution.bound() <= upper + slack, "bound {} of {upper}", solution.bound());
        prop_assert!(!solution.is_infeasible() || upper.is_infinite());
        if let Some(objective) = solution.objective() {
            prop_assert!(objective >= lower - slack, "objective {objective} below {lower}");
            let at: Vec<f64> = x.iter().map(|x| solution.value(*x).unwrap()).collect();
            prop_assert!(case.row.value(&at) <= case.limit + 1e-5);
            if solution.is_optimal() {
                prop_assert!(objective <= upper + slack, "objective {objective} above {upper}");
            }
        }
        prop_assert!(solution.termination() != Termination::Unbounded);
    }
}
