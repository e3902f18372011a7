//! A program with cones as interior-point methods take it: `G x + h` lies in cones
//! `|tail| <= head`.
//!
//! The cones of a program are over columns. Where such a column is there only to name a sum,
//! `y = a'x + b`, the sum itself becomes a row of `G`: a column and an equality less, and no column
//! without curvature and without bounds.

use std::borrow::Cow;

use super::RelaxationResult;
use crate::activity::ends;
use crate::presolve::{Compressed, FIXED, Reduced, ReducedCone};
use crate::program::ConeRole;
use crate::tolerance::largest_magnitude;

/// The least coefficient of a column in its row, relative to the largest, that is divided by.
const LEAST_COEFFICIENT: f64 = 1e-3;

/// By how much a bound may cut into the values that others allow, relative (at least 1).
const MAX_CUT_BY_BOUND: f64 = 1e-7;

/// By how much the limits of an equality may be apart because of rounding, relative (at least 1).
const MOST_ROUNDING: f64 = 1e-12;

/// The rows of cones.
#[derive(Debug, Default)]
pub(super) struct ConeRows {
    /// By cone, its first row; one more number than cones.
    pub(super) first: Vec<usize>,
    /// `G`, by row.
    pub(super) rows: Compressed,
    /// `h`, by row.
    pub(super) constant: Vec<f64>,
    /// By row, its number among the entries of all cones of the program.
    pub(super) names: Vec<usize>,
}

impl ConeRows {
    /// The number of cones.
    pub(super) fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// The rows of a cone.
    pub(super) fn rows_of(&self, cone: usize) -> std::ops::Range<usize> {
        self.first[cone]..self.first[cone + 1]
    }
}

/// A program, without the columns that name sums, and the rows of its cones.
pub(super) struct ConicForm<'a> {
    /// The program as it was.
    whole: &'a Reduced,
    pub(super) program: Cow<'a, Reduced>,
    pub(super) cones: ConeRows,
    /// By cone of the whole program, its number here; `None` for parts of others, and for fixed
    /// ones.
    place: Vec<Option<usize>>,
    names: Vec<NamedSum>,
    /// By column and by row of the whole program, whether it is here; empty if all are.
    has_column: Vec<bool>,
    has_row: Vec<bool>,
}

/// A column that names a sum: `row: a'x + coefficient column = limit`.
#[derive(Clone, Copy)]
struct NamedSum {
    column: usize,
    row: usize,
    coefficient: f64,
    /// Whether the column has bounds that neither its row nor its cone implies: they become limits
    /// of the row without it.
    is_limited: bool,
}

impl NamedSum {
    /// The limits that the bounds of the column put on the rest of its row.
    fn limits(&self, program: &Reduced) -> [f64; 2] {
        let (limit, c) = (middle(program, self.row), self.coefficient);
        let at = |bound: f64| limit - c * bound;
        let (one, other) = (at(program.lower[self.column]), at(program.upper[self.column]));
        [one.min(other), one.max(other)]
    }
}

impl<'a> ConicForm<'a> {
    pub(super) fn new(whole: &'a Reduced) -> Self {
        ConicForm::without(whole, named_sums(whole, false))
    }

    /// The form in which columns name sums also if they have bounds that do not follow otherwise:
    /// these become limits of their rows. Methods that end inside of cones need them as bounds.
    pub(super) fn with_limits(whole: &'a Reduced) -> Self {
        ConicForm::without(whole, named_sums(whole, true))
    }

    fn without(whole: &'a Reduced, names: Vec<NamedSum>) -> Self {
        let (mut has_column, mut has_row) = (Vec::new(), Vec::new());
        let mut program = Cow::Borrowed(whole);
        if !names.is_empty() {
            has_column.resize(whole.columns.len(), true);
            has_row.resize(whole.rows.len(), true);
            for name in &names {
                (has_column[name.column], has_row[name.row]) = (false, name.is_limited);
            }
            let mut without = part(whole, &has_column, &has_row);
            let at = places(&has_row);
            for name in names.iter().filter(|name| name.is_limited) {
                let (row, limits) = (at[name.row], name.limits(whole));
                (without.row_lower[row], without.row_upper[row]) = (limits[0], limits[1]);
            }
            program = Cow::Owned(without);
        }
        let mut form = ConicForm {
            whole,
            program,
            cones: ConeRows::default(),
            place: Vec::new(),
            names,
            has_column,
            has_row,
        };
        form.write_cones();
        form
    }

    fn write_cones(&mut self) {
        let ConicForm { whole, cones, place, names, has_column, .. } = self;
        let at = match has_column.is_empty() {
            true => (0..whole.columns.len()).collect(),
            false => places(has_column),
        };
        let mut sum = vec![None; whole.columns.len()];
        names.iter().for_each(|name| sum[name.column] = Some(*name));
        cones.first.push(0);
        cones.rows = Compressed::with_capacity(0, 0);
        let mut next = 0;
        let mut terms = Vec::new();
        for cone in &whole.cones {
            let before = next;
            next += cone.entries.len();
            if cone.role == ConeRole::Part || cone.is_fixed() {
                place.push(None);
                continue;
            }
            place.push(Some(cones.first.len() - 1));
            for e in 0..cone.entries.len() {
                let mut h = 0.0;
                terms.clear();
                for (entry, g) in cone.conic_row(e) {
                    match entry.is_fixed() {
                        true => h += g * entry.value,
                        false => match sum[entry.place] {
                            None => {
                                let known = terms.len();
                                add(&mut terms, known, (at[entry.place], g));
                            }
                            Some(NamedSum { column, row, coefficient, .. }) => {
                                let factor = g / coefficient;
                                h += factor * middle(whole, row);
                                let known = terms.len();
                                let others = whole.rows.entries(row).filter(|(j, _)| *j != column);
                                for (j, a) in others {
                                    add(&mut terms, known, (at[j], -factor * a));
                                }
                            }
                        },
                    }
                }
                cones.rows.push(terms.iter().copied());
                cones.constant.push(h);
                cones.names.push(before + e);
            }
            cones.first.push(cones.constant.len());
        }
    }

    /// The result for the whole program, and for each cone the multipliers of its entries. Without
    /// multipliers of the cones' rows, they are 0.
    pub(super) fn lift(
        &self,
        result: RelaxationResult,
        mut z: Vec<f64>,
    ) -> (RelaxationResult, Vec<Vec<f64>>) {
        z.resize(self.cones.constant.len(), 0.0);
        let of = |(cone, place): (&ReducedCone, &Option<usize>)| match place {
            Some(k) => z[self.cones.rows_of(*k)].to_vec(),
            None => vec![0.0; cone.entries.len()],
        };
        let multipliers = self.whole.cones.iter().zip(&self.place).map(of).collect();
        if self.names.is_empty() {
            return (result, multipliers);
        }
        let spread = |has: &[bool], values: &[f64]| {
            let mut values = values.iter();
            has.iter().map(|has| if *has { *values.next().unwrap_or(&0.0) } else { 0.0 }).collect()
        };
        let mut x: Vec<f64> = spread(&self.has_column, &result.x);
        let mut y: Vec<f64> = spread(&self.has_row, &result.y);
        let mut pull = vec![0.0; x.len()];
        for (cone, place) in self.whole.cones.iter().zip(&self.place) {
            let Some(k) = place else { continue };
            for (e, z) in z[self.cones.rows_of(*k)].iter().enumerate() {
                let free = cone.conic_row(e).filter(|(entry, _)| !entry.is_fixed());
                free.for_each(|(entry, g)| pull[entry.place] += g * z);
            }
        }
        for &NamedSum { column, row, coefficient, .. } in &self.names {
            let others = self.whole.rows.entries(row).filter(|(j, _)| *j != column);
            let sum: f64 = others.map(|(j, a)| a * x[j]).sum();
            x[column] = (middle(self.whole, row) - sum) / coefficient;
            y[row] += pull[column] / coefficient;
        }
        (RelaxationResult { x, y, ..result }, multipliers)
    }
}

/// Adds a term to a sum; its column may be among the first terms, so many.
fn add(terms: &mut Vec<(usize, f64)>, known: usize, (column, a): (usize, f64)) {
    match terms[..known].iter_mut().find(|term| term.0 == column) {
        Some(term) => term.1 += a,
        None => terms.push((column, a)),
    }
}

/// The columns that name sums, at most one for each row, in only one cone, and without a cost.
///
/// # Arguments
///
/// * `with_limits`: also those with bounds that neither their row nor their cone implies, and those
///   whose equality has rounded limits.
fn named_sums(program: &Reduced, with_limits: bool) -> Vec<NamedSum> {
    const NONE: usize = usize::MAX;
    const MANY: usize = usize::MAX - 1;
    let n = program.columns.len();
    // By column, its only cone, and its only row.
    let (mut cone_of, mut row_of) = (vec![NONE; n], vec![NONE; n]);
    let note = |of: &mut usize, k: usize| *of = if *of == NONE || *of == k { k } else { MANY };
    for (k, cone) in program.cones.iter().enumerate() {
        if cone.role == ConeRole::Part || cone.is_fixed() {
            continue;
        }
        let free = cone.entries.iter().filter(|entry| !entry.is_fixed());
        free.for_each(|entry| note(&mut cone_of[entry.place], k));
    }
    if cone_of.iter().all(|of| *of >= MANY) {
        return Vec::new();
    }
    for i in 0..program.rows.len() {
        program.rows.vector(i).0.iter().for_each(|&j| note(&mut row_of[j], i));
    }
    let mut is_bent = vec![false; n];
    for j in 0..n {
        for &i in program.quadratic.vector(j).0 {
            (is_bent[i], is_bent[j]) = (true, true);
        }
    }
    let mut taken = vec![false; program.rows.len()];
    let mut names = Vec::new();
    for column in 0..n {
        let (cone, row) = (cone_of[column], row_of[column]);
        let is_simple = cone < MANY && row < MANY && program.linear[column] == 0.0;
        if !is_simple || is_bent[column] || taken[row] {
            continue;
        }
        let is_sum = program.rows.vector(row).0.len() > 1;
        let limits = [program.row_lower[row], program.row_upper[row]];
        let rounding = if with_limits { MOST_ROUNDING * limits[1].abs().max(1.0) } else { 0.0 };
        let is_equality =
            limits.iter().all(|limit| limit.is_finite()) && limits[1] - limits[0] <= rounding;
        if !is_sum || !is_equality {
            continue;
        }
        let largest = largest_magnitude(program.rows.entries(row).map(|(_, a)| a));
        let own = program.rows.entries(row).find(|(j, _)| *j == column);
        let Some((_, coefficient)) = own.filter(|(_, c)| c.abs() >= LEAST_COEFFICIENT * largest)
        else {
            continue;
        };
        let mut name = NamedSum { column, row, coefficient, is_limited: false };
        name.is_limited = !are_bounds_implied(program, name, &program.cones[cone]);
        if with_limits || !name.is_limited {
            taken[row] = true;
            names.push(name);
        }
    }
    names
}

/// Whether the row of a column, or its cone, implies the column's bounds.
fn are_bounds_implied(program: &Reduced, name: NamedSum, cone: &ReducedCone) -> bool {
    let NamedSum { column, row, coefficient, .. } = name;
    let (lower, upper) = (program.lower[column], program.upper[column]);
    if lower == f64::NEG_INFINITY && upper == f64::INFINITY {
        return true;
    }
    let others = program.rows.entries(row).filter(|(j, _)| *j != column);
    let term = |(j, a): (usize, f64)| (-a / coefficient, [program.lower[j], program.upper[j]]);
    let range = ends([middle(program, row) / coefficient; 2], others.map(term));
    let is_head = cone.head().iter().any(|entry| entry.place == column);
    let most = |entry: &crate::presolve::ConeEntry| match entry.is_fixed() {
        true => entry.value,
        false => program.upper[entry.place],
    };
    let reach = match cone.head() {
        [head] => most(head),
        [first, second] => (most(first) * most(second)).sqrt(),
        _ => f64::INFINITY,
    };
    let of_cone = if is_head { [0.0, f64::INFINITY] } else { [-reach, reach] };
    let room = |bound: f64| MAX_CUT_BY_BOUND * bound.abs().max(1.0);
    range[0].max(of_cone[0]) >= lower - room(lower)
        && range[1].min(of_cone[1]) <= upper + room(upper)
}

/// The right side of an equality.
fn middle(program: &Reduced, row: usize) -> f64 {
    let (lower, upper) = (program.row_lower[row], program.row_upper[row]);
    lower + 0.5 * (upper - lower)
}

/// The place of each that is kept among these.
fn places(has: &[bool]) -> Vec<usize> {
    let mut at = vec![FIXED; has.len()];
    let kept = at.iter_mut().zip(has).filter(|(_, has)| **has);
    kept.enumerate().for_each(|(k, (at, _))| *at = k);
    at
}

/// The values of those that are kept.
fn kept<T: Copy>(values: &[T], has: &[bool]) -> Vec<T> {
    values.iter().zip(has).filter(|(_, has)| **has).map(|(value, _)| *value).collect()
}

/// Some columns and rows of a program, without its cones.
fn part(whole: &Reduced, has_column: &[bool], has_row: &[bool]) -> Reduced {
    let at = places(has_column);
    let vectors = |matrix: &Compressed, has: &[bool]| {
        let mut own = Compressed::with_capacity(has.len(), matrix.index.len());
        for k in (0..has.len()).filter(|k| has[*k]) {
            own.push(matrix.entries(k).map(|(j, a)| (at[j], a)).filter(|(j, _)| *j != FIXED));
        }
        own
    };
    Reduced {
        columns: kept(&whole.columns, has_column),
        values: whole.values.clone(),
        slack: whole.slack.clone(),
        quadratic: vectors(&whole.quadratic, has_column),
        linear: kept(&whole.linear, has_column),
        offset: whole.offset,
        rows: vectors(&whole.rows, has_row),
        merged: Vec::new(),
        origin: kept(&whole.origin, has_row),
        row_lower: kept(&whole.row_lower, has_row),
        row_upper: kept(&whole.row_upper, has_row),
        lower: kept(&whole.lower, has_column),
        upper: kept(&whole.upper, has_column),
        steepness: kept(&whole.steepness, has_column),
        cones: Vec::new(),
        is_cut_off: false,
        wants_vertex: false,
        spread: whole.spread,
    }
}
