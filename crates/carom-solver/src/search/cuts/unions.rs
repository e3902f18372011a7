//! Unions of polytopes in a program: the cases of some binaries, with the rows around them.
//!
//! Takes rows that say that one of some binaries is 1, at least one, or at most one; the two values
//! of a binary that is in no such row are two cases, too. Each case of a union is the polytope of
//! the rows nearby. Columns and rows are in the order in which they are met, so that equal steps of
//! a horizon have unions of one shape, whose places correspond.

use std::collections::BTreeMap;
use std::ops::Range;

use super::parameters::CUTS;
use crate::presolve::{Compressed, Domain, Reduced};
use crate::program::Program;

/// A row by places of columns, with its limits.
pub(super) type UnionRow = (Vec<(usize, f64)>, [f64; 2]);

/// The places of binaries and their values in a case.
pub(super) type UnionCase = Vec<(usize, f64)>;

/// Terms by places of columns, and a constant.
pub(super) type CaseWeight = (Vec<(usize, f64)>, f64);

/// A union of polytopes.
#[derive(Debug, Clone)]
pub(super) struct CaseUnion {
    /// The columns; those of the cases come first.
    pub(super) columns: Vec<usize>,
    pub(super) rows: Vec<usize>,
    /// The cases, by places among the columns.
    pub(super) cases: Vec<UnionCase>,
    /// The number of its shape.
    pub(super) shape: usize,
}

/// The unions of a program.
#[derive(Debug, Clone, Default)]
pub(super) struct CaseUnions {
    pub(super) all: Vec<CaseUnion>,
    /// The number of shapes.
    pub(super) shapes: usize,
}

impl CaseUnions {
    pub(super) fn of(program: &Program, domain: &Domain) -> CaseUnions {
        let mut found = CaseUnions::default();
        let mut shapes: BTreeMap<Vec<u64>, usize> = BTreeMap::new();
        let mut is_grouped = vec![false; program.column_count()];
        let mut region = Region::new(program, domain);
        let mut add = |binaries: &[usize], cases: Vec<Vec<(usize, f64)>>| {
            let (columns, rows) = region.around(binaries);
            if rows.is_empty() || found.all.len() >= CUTS.most_unions {
                return;
            }
            let key = shape(program, &columns, &rows, &cases);
            let next = shapes.len();
            let shape = *shapes.entry(key).or_insert(next);
            found.all.push(CaseUnion { columns, rows, cases, shape });
        };
        for row in 0..program.row_count() {
            let Some((binaries, cases)) = cases_of(program, domain, row) else { continue };
            binaries.iter().for_each(|&j| is_grouped[j] = true);
            add(&binaries, cases);
        }
        let is_open = |&&j: &&usize| !is_grouped[j] && is_binary(program, domain, j);
        for &j in program.integers.iter().filter(is_open) {
            add(&[j], vec![vec![(0, 1.0)], vec![(0, 0.0)]]);
        }
        found.shapes = shapes.len();
        found
    }
}

impl CaseUnion {
    /// The columns, rows and cases that make it up.
    pub(super) fn content(&self) -> (&[usize], &[usize], Vec<u64>) {
        (&self.columns, &self.rows, written(&self.cases).collect())
    }

    /// Whether a point may be outside of the union: it is inside of a case if that one's binaries
    /// have their values.
    pub(super) fn is_undecided(&self, x: &[f64]) -> bool {
        let is_case = |case: &Vec<(usize, f64)>| {
            case.iter().all(|&(k, value)| (x[self.columns[k]] - value).abs() <= CUTS.least_fraction)
        };
        !self.cases.iter().any(is_case)
    }

    /// The binaries whose values are the cases.
    pub(super) fn case_columns(&self) -> Vec<usize> {
        let mut places: Vec<usize> = self.cases.iter().flatten().map(|(k, _)| *k).collect();
        places.sort_unstable();
        places.dedup();
        places.into_iter().map(|k| self.columns[k]).collect()
    }

    /// By case, what is 1 in it and 0 in the others: terms by places of binaries and a constant;
    /// `None` if cases overlap.
    pub(super) fn weights(&self) -> Option<Vec<CaseWeight>> {
        let binaries = self.case_columns().len();
        if self.cases.iter().any(|case| case.len() != binaries) {
            return None;
        }
        let literal = |(k, case): (usize, &Vec<(usize, f64)>)| match case[k].1 {
            1.0 => (vec![(k, 1.0)], 0.0),
            _ => (vec![(k, -1.0)], 1.0),
        };
        let mut weights: Vec<CaseWeight> =
            self.cases.iter().take(binaries).enumerate().map(literal).collect();
        if self.cases.len() > binaries {
            let terms = weights.iter().flat_map(|(terms, _)| terms.iter().map(|&(k, a)| (k, -a)));
            let held: f64 = weights.iter().map(|weight| weight.1).sum();
            weights.push((terms.collect(), 1.0 - held));
        }
        Some(weights)
    }

    /// The bounds of its columns in a case.
    pub(super) fn bounds(&self, domain: &Domain, case: usize) -> Vec<[f64; 2]> {
        let mut bounds: Vec<[f64; 2]> = self.columns.iter().map(|&j| domain.bounds(j)).collect();
        self.cases[case].iter().for_each(|&(k, value)| bounds[k] = [value, value]);
        bounds
    }

    /// The rows in its own columns, with their limits.
    pub(super) fn own_rows(&self, program: &Program) -> Vec<UnionRow> {
        let places: BTreeMap<usize, usize> = self.columns.iter().copied().zip(0..).collect();
        let own = |&row: &usize| {
            let terms = program.row_terms(row);
            let terms = terms.into_iter().filter_map(|(j, a)| Some((*places.get(&j)?, a)));
            (terms.collect(), [program.row_lower[row], program.row_upper[row]])
        };
        self.rows.iter().map(own).collect()
    }

    /// The polytope of a case, with a cost for each column.
    pub(super) fn polytope(rows: &[UnionRow], bounds: &[[f64; 2]], cost: Vec<f64>) -> Reduced {
        let mut compressed = Compressed::with_capacity(rows.len(), 4 * rows.len());
        rows.iter().for_each(|(terms, _)| compressed.push(terms.iter().copied()));
        linear_program(compressed, rows.iter().map(|row| row.1), bounds, cost)
    }
}

/// A linear program.
pub(super) fn linear_program(
    rows: Compressed,
    limits: impl Iterator<Item = [f64; 2]>,
    bounds: &[[f64; 2]],
    linear: Vec<f64>,
) -> Reduced {
    let columns = bounds.len();
    let (row_lower, row_upper) = limits.map(|[lower, upper]| (lower, upper)).unzip();
    let quadratic = Compressed { start: vec![0; columns + 1], ..Compressed::default() };
    Reduced {
        columns: (0..columns).collect(),
        values: vec![0.0; columns],
        slack: vec![0.0; columns],
        quadratic,
        linear,
        rows,
        row_lower,
        row_upper,
        lower: bounds.iter().map(|bounds| bounds[0]).collect(),
        upper: bounds.iter().map(|bounds| bounds[1]).collect(),
        wants_vertex: true,
        spread: 1.0,
        ..Reduced::default()
    }
}

fn is_binary(program: &Program, domain: &Domain, j: usize) -> bool {
    program.integral[j] && domain.bounds(j) == [0.0, 1.0]
}

/// The binaries of a row and the cases that it leaves, if it says how many of them, or of their
/// complements, are 1.
fn cases_of(
    program: &Program,
    domain: &Domain,
    row: usize,
) -> Option<(Vec<usize>, Vec<UnionCase>)> {
    let terms = program.row_terms(row);
    let open: Vec<(usize, f64)> =
        terms.iter().copied().filter(|&(j, _)| !domain.is_fixed(j)).collect();
    let &(_, first) = open.first()?;
    let is_alike = |&(j, a): &(usize, f64)| a.abs() == first.abs() && is_binary(program, domain, j);
    if !CUTS.case_counts.contains(&open.len()) || !open.iter().all(is_alike) {
        return None;
    }
    let fixed: f64 =
        terms.iter().filter(|t| domain.is_fixed(t.0)).map(|&(j, a)| a * domain.lower(j)).sum();
    let scale = first.abs();
    let limits = [program.row_lower[row], program.row_upper[row]].map(|l| (l - fixed) / scale);
    let count = |sign: f64| open.iter().filter(|(_, a)| sign * a < 0.0).count() as f64;
    for sign in [1.0, -1.0] {
        // How many literals hold; that of a term with the other sign is a complement.
        let negative = count(sign);
        let [least, most] = match sign > 0.0 {
            true => [limits[0] + negative, limits[1] + negative],
            false => [negative - limits[1], negative - limits[0]],
        };
        let value = |k: usize, holds: bool| {
            let is_positive = sign * open[k].1 > 0.0;
            (k, if is_positive == holds { 1.0 } else { 0.0 })
        };
        let all = 0..open.len();
        let is_one = most == 1.0;
        let alone = |k: usize| {
            all.clone().filter(|&i| is_one || i == k).map(|i| value(i, i == k)).collect()
        };
        if least == 1.0 || is_one && least <= 0.0 {
            let mut cases: Vec<Vec<(usize, f64)>> = all.clone().map(alone).collect();
            if least <= 0.0 {
                cases.push(all.map(|k| value(k, false)).collect());
            }
            return Some((open.iter().map(|term| term.0).collect(), cases));
        }
    }
    None
}

/// The rows around binaries.
struct Region<'a> {
    program: &'a Program,
    domain: &'a Domain,
    has_column: Vec<bool>,
    has_row: Vec<bool>,
}

impl<'a> Region<'a> {
    fn new(program: &'a Program, domain: &'a Domain) -> Self {
        let has_column = vec![false; program.column_count()];
        Region { program, domain, has_column, has_row: vec![false; program.row_count()] }
    }

    /// The columns and rows around some binaries: the rows that have one of them, and those with
    /// few further columns.
    fn around(&mut self, binaries: &[usize]) -> (Vec<usize>, Vec<usize>) {
        let (mut columns, mut rows) = (binaries.to_vec(), Vec::new());
        columns.iter().for_each(|&j| self.has_column[j] = true);
        self.grow(&mut columns, &mut rows, 0..binaries.len(), usize::MAX);
        for most_new in CUTS.region_growth {
            let all = 0..columns.len();
            self.grow(&mut columns, &mut rows, all, most_new);
        }
        columns.iter().for_each(|&j| self.has_column[j] = false);
        rows.iter().for_each(|&row| self.has_row[row] = false);
        (columns, rows)
    }

    /// Adds the rows of some columns that have at most so many further ones.
    fn grow(
        &mut self,
        columns: &mut Vec<usize>,
        rows: &mut Vec<usize>,
        from: Range<usize>,
        most_new: usize,
    ) {
        let program = self.program;
        for place in from {
            let column = columns[place];
            if self.domain.is_fixed(column) {
                continue;
            }
            for &row in program.column(column).0 {
                let own = program.row(row).0;
                if self.has_row[row] || own.len() > CUTS.longest_region_row {
                    continue;
                }
                let new = own.iter().filter(|j| !self.has_column[**j]).count();
                let is_small =
                    columns.len() + new <= CUTS.region_columns && rows.len() < CUTS.region_rows;
                if new > most_new || !is_small {
                    continue;
                }
                self.has_row[row] = true;
                rows.push(row);
                for &j in own {
                    if !std::mem::replace(&mut self.has_column[j], true) {
                        columns.push(j);
                    }
                }
            }
        }
    }
}

/// Cases as numbers, to compare them; each begins with the largest number.
fn written(cases: &[UnionCase]) -> impl Iterator<Item = u64> {
    cases.iter().flat_map(|case| {
        let places = case.iter().flat_map(|&(k, value)| [k as u64, value.to_bits()]);
        std::iter::once(u64::MAX).chain(places)
    })
}

/// The common part of the unions of a shape: the places of columns in rows, and the cases.
fn shape(
    program: &Program,
    columns: &[usize],
    rows: &[usize],
    cases: &[Vec<(usize, f64)>],
) -> Vec<u64> {
    let places: BTreeMap<usize, usize> = columns.iter().copied().zip(0..).collect();
    let mut key = vec![columns.len() as u64, rows.len() as u64];
    key.extend(written(cases));
    for &row in rows {
        key.push(u64::MAX);
        for (j, a) in program.row_terms(row) {
            let place = places.get(&j).map_or(u64::MAX, |k| *k as u64);
            key.extend([place, u64::from(a > 0.0)]);
        }
        let limits = [program.row_lower[row], program.row_upper[row]];
        key.extend(limits.map(|limit| u64::from(limit.is_finite())));
    }
    key
}
