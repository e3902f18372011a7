//! Parts that only the log has: the columns, rows and cones that statements of the model have
//! become which are no rows.
//!
//! * A further column that a row sets equal to a linear form, or that is a constant, is an entry of
//!   a cone. With the forms in their places, each cone must be a statement: a quadratic row, or a
//!   cone of expressions.
//! * A row of an indicator is the row of the statement where its binary has the value of the
//!   condition, and holds anyway elsewhere, by bounds.
//! * A row with a further binary is one of an ordered set or a semi-continuous column: it lets the
//!   column be 0 if its binaries are 0, and any of its values if one of them is 1; or it is a sum
//!   of such binaries that is at most 1.
//!
//! Anything else is refused: it might exclude points of the model.

use super::model::{Indicator, Model, Row, StatedCone, Statement};
use super::polynomial::{Affine, Polynomial};
use crate::exact::Sum;
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet, VecDeque};

/// The error of the limits of rows with a big number, relative to their terms (no unit): they are
/// sums.
pub(super) const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// Findings about the statements of a model.
#[derive(Default)]
pub(super) struct Found {
    /// Columns of the log whose lower bound is 0 because they are heads.
    pub(super) heads: HashSet<u32>,
    /// Statements that were compared up to rounding.
    pub(super) rounded: Vec<String>,
    /// Numbers of the log that the model says nothing of.
    pub(super) taken: Vec<String>,
}

/// The part of a log that may be only there.
pub(super) struct Further<'a> {
    pub(super) model: &'a Model,
    pub(super) log: &'a mut Model,
    /// By column of the model, that of the log.
    order: &'a [u32],
    /// By column of the log, that of the model, if it has it.
    places: HashMap<u32, u32>,
    /// By column of the log, the form in columns of the model (by their numbers in the log), if it
    /// is one.
    forms: Vec<Option<Affine>>,
    found: Found,
}

impl<'a> Further<'a> {
    /// Takes what statements have become out of a log; its number of columns is as it was.
    ///
    /// # Errors
    ///
    /// Names the parts that are only in the log, or only in the model.
    pub(super) fn take_out(
        model: &'a Model,
        log: &'a mut Model,
        order: &'a [u32],
    ) -> Result<Found, String> {
        let mut forms = vec![None; log.columns.len()];
        for &place in order {
            if let Some(form) = forms.get_mut(place as usize) {
                *form = Some(Affine::column(place));
            }
        }
        let places = order.iter().copied().zip(0..).collect();
        let mut further = Further { model, log, order, places, forms, found: Found::default() };
        further.take_entries();
        further.take_cones()?;
        further.take_rows()?;
        Ok(further.found)
    }

    pub(super) fn at(&self, column: u32) -> u32 {
        self.order.get(column as usize).copied().unwrap_or(u32::MAX)
    }

    pub(super) fn is_known(&self, column: u32) -> bool {
        self.forms.get(column as usize).is_some_and(Option::is_some)
    }

    /// Takes out the rows that set a further column equal to a form.
    fn take_entries(&mut self) {
        let in_rows: HashSet<u32> =
            self.log.rows.iter().flat_map(|row| row.entries.iter().map(|entry| entry.0)).collect();
        for (place, column) in self.log.columns.iter().enumerate() {
            let is_constant = column.lower == column.upper && !column.is_integral;
            if is_constant && self.forms[place].is_none() && !in_rows.contains(&(place as u32)) {
                self.forms[place] = Some(Affine::constant(column.lower));
            }
        }
        loop {
            let before = self.log.rows.len();
            let rows = std::mem::take(&mut self.log.rows);
            for row in rows {
                match self.entry(&row) {
                    Some((place, form)) => self.forms[place] = Some(form),
                    None => self.log.rows.push(row),
                }
            }
            if self.log.rows.len() == before {
                return;
            }
        }
    }

    /// The column that a row sets equal to a form of columns that are known.
    fn entry(&self, row: &Row) -> Option<(usize, Affine)> {
        let mut unknown = row.entries.iter().filter(|entry| !self.is_known(entry.0));
        let (&(place, factor), None) = (unknown.next()?, unknown.next()) else { return None };
        let column = self.log.columns.get(place as usize)?;
        let is_open = column.upper == f64::INFINITY
            && (column.lower == 0.0 || column.lower == f64::NEG_INFINITY);
        if factor != -1.0 || row.lower != row.upper || column.is_integral || !is_open {
            return None;
        }
        let mut form = Affine::constant(-row.lower);
        for &(other, value) in row.entries.iter().filter(|entry| entry.0 != place) {
            form.add(value, self.forms.get(other as usize)?.as_ref()?);
        }
        Some((place as usize, form))
    }

    /// Takes out the cones that statements are.
    fn take_cones(&mut self) -> Result<(), String> {
        let at = |column: u32| self.at(column);
        // In the order of the file, which mostly is that of the log.
        let mut open: VecDeque<StatedCone> = VecDeque::new();
        for statement in &self.model.statements {
            if let Statement::Cone(own) = statement {
                open.push_back(own.renumbered(&at));
            }
        }
        let mut stated: BTreeSet<(u32, Option<u32>, Vec<u32>)> = BTreeSet::new();
        for cone in &self.model.cones {
            let mut tail: Vec<u32> = cone.tail.iter().map(|&j| at(j)).collect();
            tail.sort_unstable();
            stated.insert((at(cone.head), cone.second.map(at), tail));
        }
        // Entries that a bound keeps at least 0 must be heads.
        let own = self.log.columns.iter().enumerate();
        let is_entry = |place: usize| !self.places.contains_key(&(place as u32));
        let bounded =
            own.filter(|(k, c)| c.lower == 0.0 && c.upper > 0.0 && !c.is_integral && is_entry(*k));
        let mut bounded: BTreeSet<u32> =
            bounded.map(|(k, _)| k as u32).filter(|&k| self.is_known(k)).collect();
        let cones = std::mem::take(&mut self.log.cones);
        for cone in cones {
            let mut tail = cone.tail.clone();
            tail.sort_unstable();
            if stated.contains(&(cone.head, cone.second, tail)) {
                self.log.cones.push(cone);
                continue;
            }
            let form = |column: u32| self.forms.get(column as usize).cloned().flatten();
            let name = |column: u32| self.log.name_of(column);
            let unknown =
                || format!("the cone with the head {} is only in the log", name(cone.head));
            let head = form(cone.head).ok_or_else(unknown)?;
            let mut polynomial = Polynomial::default();
            match cone.second {
                Some(second) => {
                    polynomial.add_product(1.0, &head, &form(second).ok_or_else(unknown)?);
                }
                None if head.terms.is_empty() => {
                    // A limit below 0 cannot be met.
                    let limit = head.constant * head.constant.abs();
                    polynomial.add_affine(1.0, &Affine::constant(limit));
                }
                None => polynomial.add_product(1.0, &head, &head),
            }
            for &entry in &cone.tail {
                let entry = form(entry).ok_or_else(unknown)?;
                polynomial.add_product(-1.0, &entry, &entry);
            }
            let heads: Vec<u32> = [Some(cone.head), cone.second].into_iter().flatten().collect();
            let forms: Vec<Affine> = heads.iter().filter_map(|&head| form(head)).collect();
            let place = open.iter().position(|own| {
                polynomial.is_multiple(&own.polynomial) && self.are_heads(&forms, own)
            });
            let own = place.and_then(|k| open.remove(k)).ok_or_else(unknown)?;
            self.found.rounded.push(own.what);
            for head in heads {
                // So is a form of which a head is a positive multiple.
                let of = |column: u32| Polynomial::of(&form(column).unwrap_or_default());
                let own = of(head);
                bounded.retain(|&place| !of(place).is_multiple(&own));
                if self.places.contains_key(&head) {
                    self.found.heads.insert(head);
                }
            }
        }
        if let Some(&place) = bounded.first() {
            return Err(format!(
                "a bound of column {} is only in the log",
                self.log.name_of(place)
            ));
        }
        match open.front() {
            Some(own) => Err(format!("not in the log: {}", own.what)),
            None => Ok(()),
        }
    }

    /// Whether heads that the log keeps at least 0 are so at every point that the statement allows:
    /// constants; forms that it says this of, or that bounds do; and the other head beside a
    /// constant, which a sum of squares is below.
    fn are_heads(&self, forms: &[Affine], own: &StatedCone) -> bool {
        // The least value by bounds is at least 0, but for rounding.
        let is_bounded = |form: &Affine| {
            let (mut least, mut size) = (form.constant, form.constant.abs());
            for &(column, value) in form.terms.iter().filter(|term| term.1 != 0.0) {
                let own = self.places.get(&column).map(|&own| self.range_of(own));
                let (lower, upper) = own.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
                let term = value * if value > 0.0 { lower } else { upper };
                (least, size) = (least + term, size + term.abs());
            }
            least.is_finite() && least >= -ROUNDING * size
        };
        let is_constant = |form: &Affine| form.terms.iter().all(|term| term.1 == 0.0);
        let is_stated =
            |form: &Affine| own.heads.iter().any(|head| Polynomial::of(form).is_multiple(head));
        match forms {
            // A constant below 0 is judged by the polynomial.
            [head] if is_constant(head) => true,
            [a, b] if is_constant(a) => a.constant > 0.0 && !is_constant(b),
            [a, b] if is_constant(b) => b.constant > 0.0 && !is_constant(a),
            _ => forms.iter().all(|form| is_stated(form) || is_bounded(form)),
        }
    }

    /// Takes out the rows of indicators, sets and semi-continuous columns.
    fn take_rows(&mut self) -> Result<(), String> {
        let stated: HashSet<Vec<(u32, u64)>> = self
            .model
            .rows
            .iter()
            .map(|row| form_of(&row.entries, |column| self.at(column)))
            .collect();
        let singles: HashSet<Vec<(u32, u64)>> = self
            .model
            .rows
            .iter()
            .filter(|row| row.entries.len() < 2)
            .map(|row| {
                let entries = row.entries.iter().map(|&(column, value)| (self.at(column), value));
                limits_of(&entries.collect::<Vec<_>>(), [row.lower, row.upper])
            })
            .collect();
        // Each side of an indicator, and whether bounds imply it.
        let mut indicators: Vec<(&Indicator, bool, bool)> = Vec::new();
        // Those with some entries besides the binary.
        let mut by_others: HashMap<Vec<(u32, u64)>, Vec<usize>> = HashMap::new();
        let mut binaries: HashSet<u32> = HashSet::new();
        for statement in &self.model.statements {
            if let Statement::Indicator(indicator) = statement {
                for (is_upper, limit) in [(false, indicator.row.lower), (true, indicator.row.upper)]
                {
                    if limit.is_finite() {
                        let holds = self.holds_anyway(indicator, is_upper);
                        let entries = &indicator.row.entries;
                        let others = entries.iter().filter(|entry| entry.0 != indicator.binary);
                        let others: Vec<(u32, f64)> = others.copied().collect();
                        let form = form_of(&others, |column| self.at(column));
                        by_others.entry(form).or_default().push(indicators.len());
                        binaries.insert(self.at(indicator.binary));
                        indicators.push((indicator, is_upper, holds));
                    }
                }
            }
        }
        let rows = std::mem::take(&mut self.log.rows);
        let (mut of_sets, mut used) = (Vec::new(), HashSet::new());
        for row in rows {
            let is_single =
                row.entries.len() < 2 && row.entries.iter().all(|entry| self.is_known(entry.0));
            // Any row of a single column has the form of another one.
            let is_stated = match is_single {
                true => singles.contains(&limits_of(&row.entries, [row.lower, row.upper])),
                false => stated.contains(&form_of(&row.entries, |column| column)),
            };
            let is_own = |place: &usize| {
                let own = indicators.get(*place).filter(|_| !used.contains(place));
                own.is_some_and(|&(own, is_upper, _)| self.is_of(own, is_upper, &row))
            };
            let mut places = self.places(&row, &binaries, &by_others).into_iter();
            if is_stated {
                self.log.rows.push(row);
            } else if let Some(place) = places.find(is_own) {
                used.insert(place);
                let &(indicator, is_upper, _) = &indicators[place];
                if !self.is_loose(indicator, is_upper, &row)? {
                    let taken = format!("the big number of indicator {}", indicator.row.name);
                    self.found.taken.push(taken);
                }
            } else if is_single {
                self.log.rows.push(row);
            } else {
                of_sets.push(row);
            }
        }
        let mut open = indicators.iter().enumerate().filter(|(k, own)| !own.2 && !used.contains(k));
        if let Some((_, (indicator, ..))) = open.next() {
            return Err(format!("not in the log: indicator {}", indicator.row.name));
        }
        self.check_sets(&of_sets)
    }

    /// The sides of indicators whose entries besides the binary a row may have.
    fn places(
        &self,
        row: &Row,
        binaries: &HashSet<u32>,
        by_others: &HashMap<Vec<(u32, u64)>, Vec<usize>>,
    ) -> Vec<usize> {
        let own = row.entries.iter().map(|entry| entry.0).filter(|j| binaries.contains(j));
        let mut places = Vec::new();
        for binary in own.chain([u32::MAX]) {
            let others: Vec<(u32, f64)> =
                row.entries.iter().copied().filter(|entry| entry.0 != binary).collect();
            let form = form_of(&others, |column| column);
            places.extend(by_others.get(&form).into_iter().flatten());
        }
        places
    }

    /// The bounds of a column of the model, with 0 if it is semi-continuous.
    fn range_of(&self, column: u32) -> (f64, f64) {
        let (lower, upper) = self.model.bounds_of(column);
        let is_own = |s: &Statement| matches!(s, Statement::Semicontinuous(own) if *own == column);
        match self.model.statements.iter().any(is_own) {
            true => (lower.min(0.0), upper.max(0.0)),
            false => (lower, upper),
        }
    }

    /// The largest sum of terms of a model's columns within its bounds, but for one of them.
    fn largest(&self, entries: &[(u32, f64)], but: u32, sign: f64) -> f64 {
        let terms = entries.iter().filter(|entry| entry.0 != but).map(|&(column, value)| {
            let (lower, upper) = self.range_of(column);
            let value = sign * value;
            value * if value > 0.0 { upper } else { lower }
        });
        terms.sum()
    }

    /// Whether a side of an indicator's row holds by bounds alone.
    fn holds_anyway(&self, own: &Indicator, is_upper: bool) -> bool {
        let sign = if is_upper { 1.0 } else { -1.0 };
        let limit = if is_upper { own.row.upper } else { -own.row.lower };
        let own_value = own.row.entries.iter().find(|entry| entry.0 == own.binary);
        let at = own_value.map_or(0.0, |entry| sign * entry.1) * own.value;
        self.largest(&own.row.entries, own.binary, sign) + at <= limit
    }

    /// Whether a row of the log is that of an indicator while its condition holds.
    fn is_of(&self, own: &Indicator, is_upper: bool, row: &Row) -> bool {
        let (limit, wanted) = match is_upper {
            true => (row.upper, own.row.upper),
            false => (row.lower, own.row.lower),
        };
        if !limit.is_finite() {
            return false;
        }
        let binary = self.at(own.binary);
        let (others, at) = split(&row.entries, binary);
        let own_entries: Vec<(u32, f64)> =
            own.row.entries.iter().map(|&(column, value)| (self.at(column), value)).collect();
        let (own_others, own_at) = split(&own_entries, binary);
        let size = limit.abs() + at.abs() + wanted.abs() + own_at.abs();
        // Limits are rounded away from what they exclude, if at all.
        let mut miss = Sum::default();
        for (value, factor) in [(limit, 1.0), (wanted, -1.0), (at, -own.value), (own_at, own.value)]
        {
            miss.add(value, factor);
        }
        let Ok(miss) = miss.take() else { return false };
        let tight = if is_upper { Ordering::Less } else { Ordering::Greater };
        let is_near = miss.nearest().abs() <= ROUNDING * size && miss.sign() != tight;
        let is_one_sided = row.lower.is_infinite() != row.upper.is_infinite();
        is_one_sided && others == own_others && is_near
    }

    /// Whether a row of an indicator holds by bounds where its condition does not; `Ok(false)` if
    /// bounds are missing.
    fn is_loose(&self, own: &Indicator, is_upper: bool, row: &Row) -> Result<bool, String> {
        let sign = if is_upper { 1.0 } else { -1.0 };
        let (_, at) = split(&row.entries, self.at(own.binary));
        let limit = if is_upper { row.upper } else { -row.lower };
        let left = limit - sign * at * (1.0 - own.value);
        let largest = self.largest(&own.row.entries, own.binary, sign);
        if largest <= left + ROUNDING * (limit.abs() + at.abs()) {
            return Ok(true);
        }
        // The lowering asks rows for bounds as soon as one is missing anywhere.
        let has_open =
            self.model.columns.iter().any(|c| c.lower.is_infinite() || c.upper.is_infinite());
        match has_open {
            true => Ok(false),
            false => {
                Err(format!("the big number of indicator {} is too small in the log", own.row.name))
            }
        }
    }
}

/// The entries without a column, sorted, and its coefficient.
fn split(entries: &[(u32, f64)], column: u32) -> (Vec<(u32, f64)>, f64) {
    let mut sums: BTreeMap<u32, f64> = BTreeMap::new();
    entries.iter().for_each(|&(j, value)| *sums.entry(j).or_default() += value);
    let own = sums.remove(&column).unwrap_or_default();
    (sums.into_iter().filter(|entry| entry.1 != 0.0).collect(), own)
}

/// Coefficients by column, of which the first is positive; the floats as bits.
fn form_of(entries: &[(u32, f64)], at: impl Fn(u32) -> u32) -> Vec<(u32, u64)> {
    let placed: Vec<(u32, f64)> =
        entries.iter().map(|&(column, value)| (at(column), value)).collect();
    let (entries, _) = split(&placed, u32::MAX);
    let sign = entries.first().map_or(1.0, |entry| entry.1.signum());
    entries.iter().map(|&(column, value)| (column, (sign * value).to_bits())).collect()
}

/// Entries and limits, the floats as bits.
fn limits_of(entries: &[(u32, f64)], limits: [f64; 2]) -> Vec<(u32, u64)> {
    let limits = limits.into_iter().map(|limit| (u32::MAX, limit));
    entries.iter().copied().chain(limits).map(|(j, value)| (j, (value + 0.0).to_bits())).collect()
}
