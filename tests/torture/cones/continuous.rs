//! The best point of a program with cones for fixed integers: Clarabel, and a translation that
//! shares no code with the crate.
//!
//! Columns are divided by their units, and rows and cones by their largest coefficients.

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

use super::case::{ConicCase, Form, Shape};
use crate::common::case::Line;
use crate::torture::oracle::FEASIBILITY;

/// The answer for fixed integers.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Rest {
    Infeasible,
    Unbounded,
    /// The least cost, and where.
    Least(f64, Vec<f64>),
    Unknown,
}

/// Tolerances that are tried.
const TOLERANCES: [f64; 3] = [1e-11, 1e-10, 1e-9];

/// By how much a solver's point may miss a row, in the row's unit, and some more.
const ACCEPTED: f64 = 2.0 * FEASIBILITY;

/// An affine expression of the open columns.
type Entry = (Vec<f64>, f64);

/// Rows `entry = 0` or `entry >= 0`, and cones.
#[derive(Default)]
struct Conic {
    equal: Vec<Entry>,
    positive: Vec<Entry>,
    cones: Vec<Vec<Entry>>,
    impossible: bool,
}

struct Fixed<'a> {
    case: &'a ConicCase,
    /// The values of integers and parameters; NaN for others.
    x: &'a [f64],
    open: Vec<usize>,
    /// Open columns, and one for each norm of the cost.
    count: usize,
    /// What is asked beyond each row and cone, relative to its largest coefficient. Where it is
    /// below 0, they are also missed by [`ACCEPTED`].
    slack: f64,
}

/// The best point for the integers and parameters of `x`; the others are NaN.
pub(super) fn least(case: &ConicCase, x: &[f64], slack: f64) -> Rest {
    let open: Vec<usize> = (0..x.len()).filter(|&j| x[j].is_nan()).collect();
    let count = open.len() + case.norms.len();
    let fixed = Fixed { case, x, open, count, slack };
    let conic = fixed.conic();
    if conic.impossible {
        return Rest::Infeasible;
    }
    let (curvature, linear) = fixed.cost();
    match solve(&conic, &curvature, &linear) {
        Answer::Infeasible => Rest::Infeasible,
        Answer::Point(z) => fixed.rest(&z),
        Answer::Ray => {
            let nothing = vec![0.0; count];
            match solve(&conic, &vec![nothing.clone(); count], &nothing) {
                Answer::Infeasible => Rest::Infeasible,
                Answer::Point(_) => Rest::Unbounded,
                _ => Rest::Unknown,
            }
        }
        Answer::Unknown => Rest::Unknown,
    }
}

impl Fixed<'_> {
    /// By how much a row may be missed in its own unit.
    fn accepted(&self) -> f64 {
        if self.slack < 0.0 { ACCEPTED } else { 0.0 }
    }

    fn unit(&self, k: usize) -> f64 {
        self.open.get(k).map_or(1.0, |&j| self.case.units[j])
    }

    fn expand(&self, form: &Form) -> Entry {
        let mut entry = (vec![0.0; self.count], form.constant);
        for (&a, &x) in form.coefficients.iter().zip(self.x).filter(|(_, x)| !x.is_nan()) {
            entry.1 += a * x;
        }
        for (k, &j) in self.open.iter().enumerate() {
            entry.0[k] = form.coefficients[j] * self.unit(k);
        }
        entry
    }

    fn conic(&self) -> Conic {
        let (case, mut conic) = (self.case, Conic::default());
        for (k, &j) in self.open.iter().enumerate() {
            let column = &case.base.columns[j];
            let mut coefficients = vec![0.0; self.count];
            coefficients[k] = 1.0;
            self.limits(
                &mut conic,
                (coefficients, 0.0),
                [column.lower / self.unit(k), column.upper / self.unit(k)],
            );
        }
        let switched = case.base.switches.iter();
        let switched = switched.filter(|s| (self.x[s.binary] > 0.5) == s.on).map(|s| &s.line);
        case.base.lines.iter().chain(switched).for_each(|line| self.line(&mut conic, line));
        for cone in case.cones.iter().filter(|cone| cone.is_active(self.x)) {
            self.shape(&mut conic, &cone.shape);
        }
        for choice in &case.choices {
            let Some(selected) = choice.selected(self.x) else {
                conic.impossible = true;
                continue;
            };
            let (lines, shapes) = &choice.terms[selected];
            lines.iter().for_each(|line| self.line(&mut conic, line));
            shapes.iter().for_each(|shape| self.shape(&mut conic, shape));
        }
        for (k, (_, tail)) in case.norms.iter().enumerate() {
            let mut head = (vec![0.0; self.count], 0.0);
            head.0[self.open.len() + k] = 1.0;
            let tail = tail.iter().map(|form| self.expand(form));
            conic.cones.push([head].into_iter().chain(tail).collect());
        }
        conic
    }

    fn line(&self, conic: &mut Conic, line: &Line) {
        let form = Form { coefficients: line.coefficients.clone(), constant: 0.0 };
        self.limits(conic, self.expand(&form), [line.lower, line.upper]);
    }

    fn limits(&self, conic: &mut Conic, entry: Entry, [lower, upper]: [f64; 2]) {
        let scale = entry.0.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        if scale == 0.0 {
            let slight = 1e-13 * (entry.1.abs() + 1e-30) - self.slack.min(0.0) + self.accepted();
            conic.impossible |= entry.1 < lower - slight || entry.1 > upper + slight;
            return;
        }
        let scaled = |sign: f64, limit: f64| -> Entry {
            let coefficients = entry.0.iter().map(|a| sign * a / scale).collect();
            (coefficients, sign * (entry.1 - limit) / scale)
        };
        if lower == upper {
            conic.equal.push(scaled(1.0, lower));
            return;
        }
        for (sign, limit) in [(1.0, lower), (-1.0, upper)] {
            if limit.is_finite() {
                let (coefficients, constant) = scaled(sign, limit);
                let slack = self.slack - self.accepted() / scale;
                conic.positive.push((coefficients, constant - slack));
            }
        }
    }

    fn shape(&self, conic: &mut Conic, shape: &Shape) {
        let largest = |entry: &Entry| entry.0.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
        let scaled = |entry: &Entry, factor: f64| -> Entry {
            (entry.0.iter().map(|a| factor * a).collect(), factor * entry.1)
        };
        let combined = |a: &Entry, b: &Entry, sign: f64| -> Entry {
            (a.0.iter().zip(&b.0).map(|(a, b)| a + sign * b).collect(), a.1 + sign * b.1)
        };
        // Squares that miss a row by this do so too where a head is longer by its root.
        let (accepted, root) = (self.accepted(), self.accepted().sqrt());
        let longer = |form: &Form, by: f64| -> Entry {
            let (coefficients, constant) = self.expand(form);
            (coefficients, constant + by)
        };
        let (tail, heads): (Vec<Entry>, Vec<Entry>) = match shape {
            Shape::Norm { tail, head, is_squared } => {
                let own = self.expand(head);
                let by = match is_squared {
                    false => accepted,
                    // Exact where the head is constant.
                    true if largest(&own) == 0.0 => own.1.hypot(root) - own.1.abs(),
                    true => root,
                };
                (tail.iter().map(|form| self.expand(form)).collect(), vec![longer(head, by)])
            }
            Shape::Convex { squares, bound } => {
                let weighted = |(w, form): &(f64, Form)| scaled(&self.expand(form), w.sqrt());
                let one = (vec![0.0; self.count], 1.0);
                (squares.iter().map(weighted).collect(), vec![longer(bound, accepted), one])
            }
            Shape::Product { tail, first, second } => (
                tail.iter().map(|form| self.expand(form)).collect(),
                vec![longer(first, root), longer(second, root)],
            ),
        };
        let mut cone = match &heads[..] {
            [first, second] => {
                // Both sides as large as the tail, if that can be.
                let size = |entry: &Entry| largest(entry).max(entry.1.abs()).max(1e-300);
                let (a, b) = (size(first), size(second));
                let factor = (b / a).sqrt();
                let (a, b) = (scaled(first, factor), scaled(second, 1.0 / factor));
                let tail = tail.iter().map(|entry| scaled(entry, 2.0));
                let pair = [combined(&a, &b, 1.0), combined(&a, &b, -1.0)];
                pair.into_iter().chain(tail).collect::<Vec<_>>()
            }
            _ => heads.into_iter().chain(tail).collect(),
        };
        let mut scale = cone.iter().map(largest).fold(0.0, f64::max);
        if scale == 0.0 {
            scale = cone.iter().map(|entry| entry.1.abs()).fold(1e-300, f64::max);
            let length = cone[1..].iter().fold(0.0, |length, entry| f64::hypot(length, entry.1));
            conic.impossible |= length - cone[0].1 > 1e-13 * scale - self.slack.min(0.0);
            return;
        }
        cone.iter_mut().for_each(|entry| *entry = scaled(entry, 1.0 / scale));
        cone[0].1 -= self.slack;
        conic.cones.push(cone);
    }

    fn cost(&self) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (case, count) = (self.case, self.count);
        let form = Form { coefficients: case.base.linear.clone(), constant: 0.0 };
        let mut linear = self.expand(&form).0;
        let mut curvature = vec![vec![0.0; count]; count];
        for square in &case.base.squares {
            let form =
                Form { coefficients: square.coefficients.clone(), constant: square.constant };
            let (a, b) = self.expand(&form);
            for i in 0..count {
                linear[i] += 2.0 * square.weight * a[i] * b;
                for j in 0..count {
                    curvature[i][j] += 2.0 * square.weight * a[i] * a[j];
                }
            }
        }
        for (k, (weight, _)) in case.norms.iter().enumerate() {
            linear[self.open.len() + k] = *weight;
        }
        let all = curvature.iter().flatten().chain(&linear);
        let scale = all.fold(0.0_f64, |most, a| most.max(a.abs()));
        if scale > 0.0 {
            curvature.iter_mut().flatten().chain(&mut linear).for_each(|a| *a /= scale);
        }
        (curvature, linear)
    }

    fn rest(&self, z: &[f64]) -> Rest {
        let mut x = self.x.to_vec();
        self.open.iter().enumerate().for_each(|(k, &j)| x[j] = z[k] * self.unit(k));
        match self.case.violation(&x, 1e-6) {
            None => Rest::Least(self.case.cost(&x), x),
            Some(_) => Rest::Unknown,
        }
    }
}

enum Answer {
    Infeasible,
    /// A direction that lowers the cost for ever.
    Ray,
    Point(Vec<f64>),
    Unknown,
}

fn solve(conic: &Conic, curvature: &[Vec<f64>], linear: &[f64]) -> Answer {
    let n = linear.len();
    if n == 0 {
        return Answer::Point(Vec::new());
    }
    let rows: Vec<&Entry> = conic.equal.iter().chain(&conic.positive).collect();
    let rows: Vec<&Entry> = rows.into_iter().chain(conic.cones.iter().flatten()).collect();
    let mut kinds = Vec::new();
    if !conic.equal.is_empty() {
        kinds.push(SupportedConeT::ZeroConeT(conic.equal.len()));
    }
    if !conic.positive.is_empty() {
        kinds.push(SupportedConeT::NonnegativeConeT(conic.positive.len()));
    }
    kinds.extend(conic.cones.iter().map(|cone| SupportedConeT::SecondOrderConeT(cone.len())));
    let matrix = |rows: usize, entry: &dyn Fn(usize, usize) -> f64| {
        let (mut start, mut index, mut value) = (vec![0], Vec::new(), Vec::new());
        for j in 0..n {
            for i in 0..rows {
                if entry(i, j) != 0.0 {
                    index.push(i);
                    value.push(entry(i, j));
                }
            }
            start.push(index.len());
        }
        CscMatrix::new(rows, n, start, index, value)
    };
    let upper = matrix(n, &|i, j| if i <= j { curvature[i][j] } else { 0.0 });
    let left = matrix(rows.len(), &|i, j| -rows[i].0[j]);
    let right: Vec<f64> = rows.iter().map(|row| row.1).collect();
    for tolerance in TOLERANCES {
        let settings = DefaultSettings {
            verbose: false,
            max_iter: 200,
            tol_gap_abs: tolerance,
            tol_gap_rel: tolerance,
            tol_feas: tolerance,
            presolve_enable: false,
            ..DefaultSettings::default()
        };
        let solver = DefaultSolver::new(&upper, linear, &left, &right, &kinds, settings);
        let Ok(mut solver) = solver else { return Answer::Unknown };
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved => return Answer::Point(solver.solution.x.clone()),
            SolverStatus::PrimalInfeasible => return Answer::Infeasible,
            SolverStatus::DualInfeasible => return Answer::Ray,
            _ => {}
        }
    }
    Answer::Unknown
}
