//! A rounded aggregate as a cut in the program's columns, with the sums that prove it.
//!
//! Takes an aggregate in measured columns and its divisor; leaves the cut, the form that was
//! rounded, and for both sides of the form the multipliers of rows from which the cut follows
//! (Dash, Günlük and Lodi, MIR closures of polyhedral sets, Mathematical Programming 121, 2010, on
//! mixed-integer rounding as a split).

use std::collections::BTreeMap;

use super::cut::{Cut, CutSide, WholeForm, reach};
use super::parameters::CUTS;
use super::rounding::{Aggregate, Base, fraction, rounded};
use super::separated_point::SeparatedPoint;
use crate::presolve::Domain;
use crate::tolerance::largest_magnitude;

/// A sum of rows in the making. Terms that cancel leave rounding; `size` is its measure.
struct Total<'a> {
    domain: &'a Domain,
    terms: BTreeMap<usize, f64>,
    limit: f64,
    size: f64,
}

impl Total<'_> {
    fn add(&mut self, j: usize, a: f64) {
        *self.terms.entry(j).or_insert(0.0) += a;
        self.size = self.size.max(a.abs() * reach(self.domain, j));
    }

    fn raise(&mut self, limit: f64) {
        self.limit += limit;
        self.size = self.size.max(limit.abs());
    }
}

/// The rounding of an aggregate times a sign, in the program's columns.
pub(super) fn write(
    (point, aggregate, sign): (&SeparatedPoint<'_>, &Aggregate, f64),
    base: &Base,
    divisor: f64,
) -> Option<Cut> {
    let SeparatedPoint { program, domain, x, .. } = *point;
    let f = fraction(base, divisor)?;
    let n = program.column_count();
    let scale = 1.0 / (divisor * (1.0 - f));
    let size = CUTS.margin_share * aggregate.size * scale;
    let mut total = Total { domain, terms: BTreeMap::new(), limit: 0.0, size };
    total.raise((base.right / divisor).floor());
    for whole in &base.whole {
        let a = rounded(whole.coefficient / divisor, f);
        if whole.at_upper {
            total.add(whole.column, -a);
            total.raise(-a * whole.bounds[1]);
        } else {
            total.add(whole.column, a);
            total.raise(a * whole.bounds[0]);
        }
    }
    for rest in &base.rest {
        let (a, from) = (rest.coefficient / (divisor * (1.0 - f)), rest.from);
        if rest.key < n {
            total.add(rest.key, a * from.sign);
            total.raise(a * from.sign * from.constant);
            if from.slope != 0.0 {
                total.add(from.binary, -a * from.sign * from.slope);
            }
        } else {
            // s = upper - a'x, or a'x - lower.
            let row = rest.key - n;
            let sign = point.slack_sign(row);
            let (columns, values) = program.row(row);
            columns.iter().zip(values).for_each(|(&j, v)| total.add(j, -a * sign * v));
            let end = if sign > 0.0 { program.row_upper[row] } else { -program.row_lower[row] };
            total.raise(-a * end);
        }
    }
    let Total { terms, limit, size, .. } = total;
    let largest = largest_magnitude(terms.values());
    let mut cut = Cut::new(terms, limit, size, domain, x)?;
    let mut form = whole_form(base, divisor, f);
    form.sides = sides((point, aggregate, sign), base, [scale / largest, f / (1.0 - f) / largest]);
    form.sides[0].form = -1.0 / largest;
    cut.form = Some(form);
    Some(cut)
}

/// The sums that prove a cut on both sides of its form. On the lower side, the cut is at most the
/// form but for what slacks and columns with negative coefficients add, which the rows say to be at
/// most 0. On the upper side, it is the aggregate minus a multiple of the form.
///
/// # Arguments
///
/// * `scale`: the multiplier of the aggregate in the cut; `ratio`: that of the form on the upper
///   side.
fn sides(
    (point, aggregate, sign): (&SeparatedPoint<'_>, &Aggregate, f64),
    base: &Base,
    [scale, ratio]: [f64; 2],
) -> [CutSide; 2] {
    let program = point.program;
    let n = program.column_count();
    let mut below = CutSide::default();
    for rest in &base.rest {
        if rest.key >= n {
            let row = rest.key - n;
            below.rows.push((row, scale * rest.coefficient * point.slack_sign(row)));
        } else if rest.from.slope != 0.0 {
            let a = point.coefficient(rest.from.row, rest.key);
            below.rows.push((rest.from.row, -scale * rest.coefficient * rest.from.sign / a));
        }
    }
    let mut above = CutSide { form: ratio, rows: Vec::new() };
    for &(row, factor) in &aggregate.rows {
        let is_equation = program.row_lower[row] == program.row_upper[row];
        if is_equation || sign * factor > 0.0 {
            above.rows.push((row, -scale * sign * factor * point.slack_sign(row)));
        }
    }
    above.rows.extend(base.removed.iter().map(|&(row, a)| (row, scale * a)));
    [below, above]
}

/// The form whose rounding the cut is: in measured columns, the coefficients of the aggregate over
/// the divisor, rounded down where their fraction is less than `f`, and else up.
fn whole_form(base: &Base, divisor: f64, f: f64) -> WholeForm {
    let mut form = WholeForm {
        terms: Vec::new(),
        value: (base.right / divisor).floor(),
        sides: Default::default(),
    };
    for whole in &base.whole {
        let a = rounded(whole.coefficient / divisor, f).ceil();
        match whole.at_upper {
            true => form.value -= a * whole.bounds[1],
            false => form.value += a * whole.bounds[0],
        }
        let a = if whole.at_upper { -a } else { a };
        if a != 0.0 {
            form.terms.push((whole.column, a));
        }
    }
    form
}
