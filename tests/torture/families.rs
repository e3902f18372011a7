//! Kinds of random programs, each a function of a seed, and ways of solving them.

use carom::prelude::*;
use carom::solver::{BranchingRule, PoolMode};

use super::big_m::big_m;
use super::dense;
use super::generator::{Random, large, program};
use super::open_integers;
use super::oracle::{Truth, Verdict, judge, truth};
use crate::common::case::{Case, Column, Line, Square};
use crate::common::other_words::{complemented, in_units, negated, rows};
use crate::common::quadratic_program::dot;

/// A kind of programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    /// Of everything a little.
    Mixed,
    /// Terms of 1e6 to 1e10.
    Large,
    /// Coefficients of 1e4 to 1e8 beside small ones.
    BigM,
    /// Continuous columns without bounds, with one, or with huge ones, in rows with binaries, under
    /// squares of their own.
    Open,
    /// A row that a corner of the box satisfies exactly, or would if decimals were doubles.
    Borderline,
    /// Ten steps and fewer of an unstable system: what is missed at the start is amplified.
    Chain,
    /// Integers without bounds in equalities over whole numbers: divisibility decides.
    OpenIntegers,
    /// Unstable systems that start at rest: nothing happens without an input.
    AtRest,
    /// Mixed ones in other units, with complements of columns and rows from the other side.
    OtherWords,
    /// Dense quadratic objectives, convex or not, over columns with two values and a few others.
    Dense,
}

impl Family {
    pub(crate) const ALL: [Family; 10] = [
        Family::Mixed,
        Family::Large,
        Family::BigM,
        Family::Open,
        Family::Borderline,
        Family::Chain,
        Family::OpenIntegers,
        Family::AtRest,
        Family::OtherWords,
        Family::Dense,
    ];

    pub(crate) fn named(name: &str) -> Option<Family> {
        Family::ALL.into_iter().find(|family| family.name() == name)
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Family::Mixed => "mixed",
            Family::Large => "large",
            Family::BigM => "big-m",
            Family::Open => "open",
            Family::Borderline => "borderline",
            Family::Chain => "chain",
            Family::OpenIntegers => "open-integers",
            Family::AtRest => "at-rest",
            Family::OtherWords => "other-words",
            Family::Dense => "dense",
        }
    }

    /// The program of a seed.
    pub(crate) fn program(self, seed: u64) -> Case {
        match self {
            Family::Mixed => program(seed),
            Family::Large => large(seed),
            Family::BigM => big_m(seed),
            Family::Open => open(seed),
            Family::Borderline => borderline(seed),
            Family::Chain => chain(seed),
            Family::OpenIntegers => open_integers::program(seed),
            Family::AtRest => at_rest(seed),
            Family::OtherWords => other_words(seed),
            Family::Dense => dense::program(seed),
        }
    }

    /// Whether a solve may stall: where terms are larger than a float has digits for.
    pub(crate) fn may_stall(self) -> bool {
        self == Family::Large
    }

    /// Whether a point within the tolerance that is much better than the exact optimum is wrong.
    pub(crate) fn is_strict(self) -> bool {
        matches!(self, Family::Chain | Family::AtRest)
    }

    /// The exact answer.
    pub(crate) fn truth(self, case: &Case) -> Truth {
        match self {
            Family::Borderline => at_the_corner(case),
            Family::OpenIntegers => open_integers::truth(case),
            _ => truth(case),
        }
    }

    /// What an answer is worth; `variables` are the model's, in the order of the columns.
    pub(crate) fn judge(
        self,
        case: &Case,
        variables: &[Variable],
        options: &Options,
        solution: &Solution,
        truth: &Truth,
    ) -> Verdict {
        let verdict = judge(case, variables, options, solution, truth);
        if let (Truth::Least { value, .. }, Verdict::Right) = (truth, &verdict)
            && let Some(objective) = solution.objective().filter(|_| self.is_strict())
            && case.sign() * objective < value - AMPLIFIED * value.abs().max(1.0)
        {
            return Verdict::Wrong(format!("{objective} is better than {value}"));
        }
        verdict
    }
}

/// A way of solving.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Path {
    Usual,
    WithoutPresolve,
    /// The two best points are kept.
    Pool,
    /// The ends of the tree are kept.
    Leaves,
    /// Latest first, in two threads.
    LatestFirst,
    WithoutCuts,
}

impl Path {
    pub(crate) const ALL: [Path; 6] = [
        Path::Usual,
        Path::WithoutPresolve,
        Path::Pool,
        Path::Leaves,
        Path::LatestFirst,
        Path::WithoutCuts,
    ];

    pub(crate) fn options(self) -> Options {
        let mut options = Options::default();
        match self {
            Path::Usual => {}
            Path::WithoutPresolve => options = options.with_presolve(false),
            Path::Pool => options = options.with_pool(2, PoolMode::Found),
            Path::Leaves => options.parts_mut().keep_leaves = true,
            Path::LatestFirst => {
                (options.branching, options.threads) = (BranchingRule::LatestFirst, 2);
            }
            Path::WithoutCuts => options.cuts = false,
        }
        options
    }
}

/// By how much a point of a strict family may be better than the exact optimum, relative: points
/// are accepted within 1e-6, and steps multiply some of that.
const AMPLIFIED: f64 = 1e-3;

pub(super) fn sign(r: &mut Random) -> f64 {
    if r.chance(0.5) { 1.0 } else { -1.0 }
}

/// A small whole number that is not zero.
fn factor(r: &mut Random, most: i32) -> f64 {
    f64::from(r.within(1, most)) * sign(r)
}

pub(super) const BINARY: Column = Column { kind: VariableKind::Binary, lower: 0.0, upper: 1.0 };

fn open(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let (continuous, binaries) = (1 + r.below(4), 1 + r.below(5));
    let mut columns: Vec<Column> = (0..continuous).map(|_| wide_column(r)).collect();
    columns.extend((0..binaries).map(|_| BINARY));
    if r.chance(0.3) {
        let lower = f64::from(r.within(-4, 2));
        let upper = lower + f64::from(r.within(0, 4));
        columns.push(Column { kind: VariableKind::Integer, lower, upper });
    }
    let n = columns.len();
    let anchor: Vec<f64> = columns.iter().map(|column| anchored(r, column)).collect();
    let lines = (0..1 + r.below(5)).map(|_| {
        let mut coefficients = vec![0.0; n];
        for _ in 0..1 + r.below(3) {
            coefficients[r.below(continuous)] = factor(r, 3);
        }
        for _ in 0..r.below(3) {
            coefficients[continuous + r.below(n - continuous)] =
                factor(r, 9) * 2.0_f64.powi(r.within(0, 5));
        }
        around(r, coefficients, &anchor)
    });
    let lines = lines.collect();
    let mut squares = Vec::new();
    for j in 0..continuous {
        if r.chance(0.7) {
            let mut coefficients = vec![0.0; n];
            coefficients[j] = 1.0;
            if r.chance(0.2) {
                coefficients[r.below(n)] = factor(r, 2);
            }
            let weight = 2.0_f64.powi(r.within(-3, 6));
            let constant = f64::from(r.within(-6, 6));
            squares.push(Square { weight, coefficients, constant });
        }
    }
    let linear =
        (0..n).map(|_| if r.chance(0.6) { factor(r, 40) } else { 0.0 }).collect::<Vec<f64>>();
    let maximize = r.chance(0.3);
    Case { columns, lines, switches: Vec::new(), squares, linear, constant: 0.0, maximize }
}

/// A continuous column of which at least one bound is missing or far away, mostly.
fn wide_column(r: &mut Random) -> Column {
    let far = |r: &mut Random| f64::from(r.within(1, 9)) * 2.0_f64.powi(r.within(10, 20));
    let near = f64::from(r.within(-9, 9));
    let width = f64::from(r.within(1, 20));
    let (lower, upper) = match r.below(8) {
        0 | 1 => (f64::NEG_INFINITY, f64::INFINITY),
        2 => (near, f64::INFINITY),
        3 => (f64::NEG_INFINITY, near),
        4 => (-far(r), far(r)),
        5 => (near, near + far(r)),
        6 => (near - far(r), near),
        _ => (near, near + width),
    };
    Column { kind: VariableKind::Continuous, lower, upper }
}

/// A whole number within the bounds, near 0.
fn anchored(r: &mut Random, column: &Column) -> f64 {
    let value = if column.kind == VariableKind::Continuous {
        f64::from(r.within(-12, 12))
    } else {
        f64::from(r.within(-4, 6))
    };
    value.max(column.lower).min(column.upper)
}

/// A row that the anchor keeps, mostly.
fn around(r: &mut Random, coefficients: Vec<f64>, anchor: &[f64]) -> Line {
    let activity = dot(&coefficients, anchor);
    let off = if r.chance(0.1) { f64::from(r.within(-4, 4)) } else { 0.0 };
    let slack = f64::from(r.within(0, 12));
    let (lower, upper) = match r.below(5) {
        0 => (activity + off, activity + off),
        1 | 2 => (f64::NEG_INFINITY, activity + off + slack),
        _ => (activity + off - slack, f64::INFINITY),
    };
    Line { coefficients, lower, upper, scale: 1.0 }
}

/// The answer to a borderline program in decimals: the row leaves its columns the corner, and the
/// others have their cheapest bounds. Rounding decides whether the corner is a point, so the value
/// is known to a millionth only.
fn at_the_corner(case: &Case) -> Truth {
    let row = &case.lines[0];
    let below = row.upper.is_finite();
    let columns = case.columns.iter().zip(row.coefficients.iter().zip(&case.linear));
    let point: Vec<f64> = columns
        .map(|(column, (&a, &cost))| {
            let lower = if a == 0.0 { cost > 0.0 } else { (a > 0.0) == below };
            if lower { column.lower } else { column.upper }
        })
        .collect();
    let value = case.cost(&point);
    Truth::Least { value: value + 1e-6 * value.abs().max(1.0), point }
}

/// Decimals, a row whose limit is its largest or smallest activity in decimals, and columns that it
/// does not hold.
fn borderline(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let held = 1 + r.below(3);
    let n = held + 1 + r.below(4);
    let mut columns: Vec<Column> = (0..n)
        .map(|_| {
            let (lower, width) = (r.within(-30, 30), r.within(1, 50));
            let decimal = |tenths: i32| f64::from(tenths) / 10.0;
            let (lower, upper) = (decimal(lower), decimal(lower + width));
            Column { kind: VariableKind::Continuous, lower, upper }
        })
        .collect();
    for column in columns.iter_mut().skip(held) {
        match r.below(3) {
            0 => *column = BINARY,
            1 => column.upper = 10.0_f64.powi(r.within(2, 6)),
            _ => {}
        }
    }
    let (below, mut coefficients) = (r.chance(0.5), vec![0.0; n]);
    // The sum in millionths of tenths, exactly.
    let mut limit = 0_i128;
    for (coefficient, column) in coefficients.iter_mut().zip(&columns).take(held) {
        let micro = i128::from(r.within(1, 99)) * 10_i128.pow(r.below(7) as u32);
        let micro = if r.chance(0.5) { micro } else { -micro };
        *coefficient = micro as f64 / 1e6;
        let corner = if (micro > 0) == below { column.lower } else { column.upper };
        limit += micro * (corner * 10.0).round() as i128;
    }
    let limit = limit as f64 / 1e7;
    let (lower, upper) = if below { (f64::NEG_INFINITY, limit) } else { (limit, f64::INFINITY) };
    let lines = vec![Line { coefficients, lower, upper, scale: 1.0 }];
    let linear = (0..n).map(|_| factor(r, 5)).collect();
    let maximize = r.chance(0.5);
    let (switches, squares) = (Vec::new(), Vec::new());
    Case { columns, lines, switches, squares, linear, constant: 0.0, maximize }
}

/// `x+ = g x + b u` from a start that bounds or rows fix or limit, to an end with a limit; inputs
/// are continuous or small integers.
fn chain(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let steps = 3 + r.below(6);
    let gain = [2.0, 3.0, 10.0, -10.0][r.below(4)];
    let by_rows = r.chance(0.5);
    let far = if r.chance(0.5) { 2.0_f64.powi(20) } else { f64::INFINITY };
    let mut columns = Vec::new();
    for k in 0..=steps {
        let (lower, upper) = match k {
            0 if by_rows => (f64::NEG_INFINITY, f64::INFINITY),
            0 => (0.0, f64::from(r.within(0, 2))),
            _ => (if r.chance(0.5) { f64::NEG_INFINITY } else { -far }, far),
        };
        columns.push(Column { kind: VariableKind::Continuous, lower, upper });
    }
    let mut assignments = 1;
    for _ in 0..steps {
        let upper = r.within(1, 3);
        let whole = r.chance(0.3) && assignments * (upper + 1) <= 64;
        assignments *= if whole { upper + 1 } else { 1 };
        let kind = if whole { VariableKind::Integer } else { VariableKind::Continuous };
        columns.push(Column { kind, lower: 0.0, upper: f64::from(upper) });
    }
    let n = columns.len();
    let row = |terms: &[(usize, f64)], lower: f64, upper: f64| {
        let mut coefficients = vec![0.0; n];
        terms.iter().for_each(|&(j, a)| coefficients[j] = a);
        Line { coefficients, lower, upper, scale: 1.0 }
    };
    let mut lines: Vec<Line> = (0..steps)
        .map(|k| {
            let input = f64::from(r.within(1, 3)) * if r.chance(0.8) { -1.0 } else { 1.0 };
            row(&[(k + 1, 1.0), (k, -gain), (steps + 1 + k, input)], 0.0, 0.0)
        })
        .collect();
    if by_rows {
        lines.push(row(&[(0, 1.0)], 0.0, f64::INFINITY));
        lines.push(row(&[(0, 1.0)], f64::NEG_INFINITY, f64::from(r.within(0, 2))));
    }
    let end = f64::from(r.within(-1, 2)) * f64::from(u8::from(r.chance(0.5)));
    lines.push(row(&[(steps, 1.0)], f64::NEG_INFINITY, end));
    let mut linear: Vec<f64> = (0..n).map(|_| 0.0).collect();
    linear[steps] = 1.0;
    for cost in linear.iter_mut().skip(steps + 1) {
        *cost = f64::from(r.within(-3, 3));
    }
    let (switches, squares) = (Vec::new(), Vec::new());
    Case { columns, lines, switches, squares, linear, constant: 0.0, maximize: r.chance(0.3) }
}

/// `x+ = A x + b z` from 0 with a binary `z` in one step or none, and an end with a limit; columns
/// in any order, rows in units of their own.
fn at_rest(seed: u64) -> Case {
    let r = &mut Random::new(seed);
    let (states, steps) = (1 + r.below(2), 3 + r.below(8));
    let switched = r.chance(0.4).then(|| r.below(steps));
    // The input leads beyond all bounds, so the search has to leave it off.
    let far = if switched.is_some() || r.chance(0.5) { 1000.0 } else { f64::INFINITY };
    let n = states * (steps + 1) + usize::from(switched.is_some());
    let mut order: Vec<usize> = (0..n).collect();
    if r.chance(0.5) {
        for i in (1..n).rev() {
            order.swap(i, r.below(i + 1));
        }
    }
    let at = |k: usize, i: usize| order[states * k + i];
    let column = |lower, upper| Column { kind: VariableKind::Continuous, lower, upper };
    let mut columns: Vec<Column> = (0..n).map(|_| column(-far, far)).collect();
    let by_rows = r.chance(0.5);
    let mut lines = Vec::new();
    let row = |terms: &[(usize, f64)], lower: f64, upper: f64| {
        let mut coefficients = vec![0.0; n];
        terms.iter().for_each(|&(j, a)| coefficients[j] += a);
        Line { coefficients, lower, upper, scale: 1.0 }
    };
    for i in 0..states {
        if by_rows {
            lines.push(row(&[(at(0, i), 1.0)], 0.0, 0.0));
        } else {
            columns[at(0, i)] = column(0.0, 0.0);
        }
    }
    if switched.is_some() {
        columns[order[n - 1]] = BINARY;
    }
    let matrix: Vec<f64> = (0..states * states).map(|_| f64::from(r.within(-10, 10))).collect();
    for k in 0..steps {
        for i in 0..states {
            let unit = 2.0_f64.powi(if r.chance(0.3) { r.within(-8, 8) } else { 0 });
            let mut terms = vec![(at(k + 1, i), unit)];
            terms.extend((0..states).map(|j| (at(k, j), -unit * matrix[states * i + j])));
            if switched == Some(k) {
                terms.push((order[n - 1], -unit * factor(r, 3)));
            }
            lines.push(row(&terms, 0.0, 0.0));
        }
    }
    if r.chance(0.4) {
        let end = f64::from(r.within(0, 2));
        lines.push(row(&[(at(steps, 0), 1.0)], end, f64::INFINITY));
    }
    let mut linear = vec![0.0; n];
    linear[at(steps, 0)] = f64::from(r.within(-1, 1));
    let (switches, squares) = (Vec::new(), Vec::new());
    Case { columns, lines, switches, squares, linear, constant: 0.0, maximize: r.chance(0.3) }
}

/// A mixed program in other words: continuous columns and rows times powers of two up to 1e4 either
/// way, half of the bounded columns as complements, half of the rows negated.
fn other_words(seed: u64) -> Case {
    let (case, r) = (program(seed), &mut Random::new(!seed));
    let (columns, lines) = (case.columns.len(), rows(&mut case.clone()).count());
    let mut powers = |count: usize| (0..count).map(|_| r.within(-13, 13)).collect::<Vec<i32>>();
    let (of_columns, of_rows) = (powers(columns), powers(lines));
    let mut halves = |count: usize| (0..count).map(|_| r.chance(0.5)).collect::<Vec<bool>>();
    let (complements, negations) = (halves(columns), halves(lines));
    in_units(&negated(&complemented(&case, &complements), &negations), &of_columns, &of_rows)
}
