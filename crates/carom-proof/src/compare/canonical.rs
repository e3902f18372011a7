//! A program without what files say in several ways.

use super::model::Model;
use crate::exact::{Plain, Sum};
use crate::program::Column;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Coefficients by column; the floats as bits, of which each stands for one number.
type Form = Vec<(u32, u64)>;

/// The tightest sides of rows that have the same form.
struct Sides {
    lower: f64,
    upper: f64,
    /// The name of the first of them, and -1 if its form has the other sign.
    name: String,
    sign: f64,
}

pub(super) struct Canonical {
    columns: BTreeMap<u32, Column>,
    /// Rows by their forms, of which the first coefficient is positive.
    rows: BTreeMap<Form, Sides>,
    cones: BTreeSet<(u32, Option<u32>, Vec<u32>)>,
    constant: f64,
    linear: Form,
    squares: Vec<(u32, u32, u64)>,
}

impl Canonical {
    /// `order` says which number each column has here.
    pub(super) fn new(model: Model, order: &[u32]) -> Self {
        let at = |column: u32| order.get(column as usize).copied().unwrap_or(u32::MAX);
        let mut columns: Vec<Column> = model.columns;
        let mut rows: BTreeMap<Form, Sides> = BTreeMap::new();
        for row in model.rows {
            let mut entries = row.entries;
            entries.sort_by_key(|entry| at(entry.0));
            let entries = added(entries);
            let sign = entries.first().map_or(1.0, |entry| entry.1.signum());
            let (mut lower, mut upper) = (sign * row.lower, sign * row.upper);
            if sign < 0.0 {
                (lower, upper) = (upper, lower);
            }
            if let [(column, coefficient)] = entries[..]
                && let Some(column) = columns.get_mut(column as usize)
                && let (Some(least), Some(most)) =
                    (quotient(lower, sign * coefficient), quotient(upper, sign * coefficient))
            {
                column.lower = column.lower.max(least);
                column.upper = column.upper.min(most);
                continue;
            }
            if (lower == f64::NEG_INFINITY && upper == f64::INFINITY)
                || (entries.is_empty() && lower <= 0.0 && upper >= 0.0)
            {
                continue;
            }
            let form =
                entries.iter().map(|&(j, value)| (at(j), (sign * value).to_bits())).collect();
            let (free, name) = (f64::INFINITY, row.name);
            let sides = rows.entry(form).or_insert(Sides { lower: -free, upper: free, name, sign });
            sides.lower = sides.lower.max(lower);
            sides.upper = sides.upper.min(upper);
        }
        // A head is at least a norm.
        for cone in &model.cones {
            columns
                .get_mut(cone.head as usize)
                .into_iter()
                .for_each(|c| c.lower = c.lower.max(0.0));
        }
        for column in columns.iter_mut().filter(|column| column.is_integral) {
            (column.lower, column.upper) = (column.lower.ceil(), column.upper.floor());
        }
        let cones = model.cones.into_iter().map(|cone| {
            let mut tail: Vec<u32> = cone.tail.into_iter().map(at).collect();
            tail.sort_unstable();
            (at(cone.head), cone.second.map(at), tail)
        });
        let mut linear: Vec<(u32, f64)> = model.linear.iter().map(|e| (at(e.0), e.1)).collect();
        linear.sort_by_key(|entry| entry.0);
        let mut squares: BTreeMap<(u32, u32), f64> = BTreeMap::new();
        for (i, j, value) in model.triangle {
            let (i, j) = (at(i).min(at(j)), at(i).max(at(j)));
            *squares.entry((i, j)).or_insert(0.0) += value;
        }
        squares.retain(|_, value| *value != 0.0);
        Canonical {
            cones: cones.collect(),
            columns: columns.into_iter().zip(0..).map(|(column, j)| (at(j), column)).collect(),
            rows,
            constant: model.constant,
            linear: added(linear).iter().map(|&(j, value)| (j, value.to_bits())).collect(),
            squares: squares.iter().map(|(&(i, j), value)| (i, j, value.to_bits())).collect(),
        }
    }

    fn column(&self, place: u32) -> Option<&Column> {
        self.columns.get(&place)
    }

    /// A column at `place` that differs in a log.
    ///
    /// # Arguments
    ///
    /// * `is_head`: whether a cone keeps it at least 0.
    pub(super) fn other_column(
        &self,
        log: &Canonical,
        place: u32,
        is_head: bool,
    ) -> Option<String> {
        let (own, other) = (self.columns.get(&place)?, log.columns.get(&place)?);
        let (is_integral, lower, upper) = own.limits();
        let is_same = own.limits() == other.limits()
            || is_head && (is_integral, lower.max(0.0), upper) == other.limits();
        let name = &own.name;
        (!is_same).then(|| format!("column {name}: {own} in the model, {other} in the log"))
    }

    /// A row that is not in another program, which is called `there`.
    pub(super) fn other_row(&self, other: &Canonical, there: &str) -> Option<String> {
        self.rows.iter().find_map(|(form, own)| {
            let name = &own.name;
            let Some(sides) = other.rows.get(form) else {
                return Some(format!("row {name} is not in {there}"));
            };
            let signed = |sides: &Sides| {
                let Sides { lower, upper, .. } = *sides;
                if own.sign < 0.0 { (-upper, -lower) } else { (lower, upper) }
            };
            let (a, b) = (signed(own), signed(sides));
            (a != b).then(|| {
                let words = |s: (f64, f64)| format!("from {} to {}", Plain(s.0), Plain(s.1));
                format!("row {name}: {}, and {} in {there}", words(a), words(b))
            })
        })
    }

    pub(super) fn other_objective(&self, log: &Canonical) -> Option<String> {
        if self.constant != log.constant {
            let (own, other) = (Plain(self.constant), Plain(log.constant));
            return Some(format!("the constant is {own} in the model, {other} in the log"));
        }
        let name = |column: u32| self.column(column).map_or("of the log", |column| &column.name);
        let first = first_other(&self.linear, &log.linear);
        let first = first.map(|(column, _)| format!("the cost of {}", name(column)));
        first.or_else(|| {
            let (i, j, _) = first_other(&self.squares, &log.squares)?;
            Some(format!("the cost of {} times {}", name(i), name(j)))
        })
    }

    /// A cone that is only in one of two programs.
    pub(super) fn other_cone(&self, log: &Canonical) -> Option<String> {
        let name = |column: u32| self.column(column).map_or("of the log", |column| &column.name);
        let missing = self.cones.difference(&log.cones).next();
        let further = log.cones.difference(&self.cones).next();
        let cone = |cone: &(u32, Option<u32>, Vec<u32>)| {
            format!("the cone with the head {}", name(cone.0))
        };
        missing.or(further).map(cone)
    }
}

impl Column {
    pub(super) fn limits(&self) -> (bool, f64, f64) {
        (self.is_integral, self.lower, self.upper)
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_integral { "integral" } else { "continuous" };
        write!(f, "{kind} from {} to {}", Plain(self.lower), Plain(self.upper))
    }
}

/// Entries of the same column added; zeros left out.
fn added(entries: Vec<(u32, f64)>) -> Vec<(u32, f64)> {
    let mut sums: Vec<(u32, f64)> = Vec::new();
    for (column, value) in entries {
        match sums.last_mut() {
            Some(last) if last.0 == column => last.1 += value,
            _ => sums.push((column, value)),
        }
    }
    sums.retain(|entry| entry.1 != 0.0);
    sums
}

/// `side / coefficient`, if that is a float.
fn quotient(side: f64, coefficient: f64) -> Option<f64> {
    if side.is_infinite() {
        return Some(side);
    }
    let quotient = side / coefficient;
    let mut sum = Sum::default();
    sum.add(quotient, coefficient);
    sum.subtract(side, 1.0);
    (sum.take_sign() == Ok(Ordering::Equal)).then_some(quotient)
}

/// The first of the entries, sorted by what comes before the value, that only one of two lists has.
fn first_other<T: Ord + Copy>(a: &[T], b: &[T]) -> Option<T> {
    let (a, b): (BTreeSet<T>, BTreeSet<T>) =
        (a.iter().copied().collect(), b.iter().copied().collect());
    a.symmetric_difference(&b).next().copied()
}
