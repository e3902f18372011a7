//! A mission over the samples of a run: negations pushed inwards, equal parts once, each with its
//! range.

use std::collections::HashMap;

use super::formula::{Mission, MissionNode, Predicate};
use super::robustness::{negated_norm, too_deep};
use super::window::Window;
use crate::activity;
use crate::elementary::IntervalSeries;
use crate::error::Error;
use crate::hybrid::system::SystemRow;
use crate::interval::Interval;
use crate::model::{Affine, Model, Nonlinear, Variable};
use crate::tolerance::{INFINITE, MISSION_SEPARATION};

/// The number of a part.
pub(super) type Id = usize;

/// A part of the mission at a sample.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum MissionPart {
    /// Conditions that all hold, by number.
    Conditions(Vec<usize>),
    All(Vec<Id>),
    Any(Vec<Id>),
}

/// A condition on the model's variables: by how much it holds is the robustness of the predicate.
#[derive(Debug, Clone)]
pub(super) enum Demand {
    /// The slack.
    Slack(Affine),
    /// The same of modes and transitions only, which holds or does not.
    Logical(Affine),
    Conic(crate::model::ConicRow),
    /// A slack with functions.
    Nonlinear(Nonlinear),
}

/// A row at a sample; `None` where its handles have no values.
pub(super) type RowAt<'a> = dyn Fn(&SystemRow, usize) -> Result<Option<SystemRow>, Error> + 'a;

/// All parts of a mission over the samples of a run.
pub(super) struct Unrolled<'a> {
    model: &'a Model,
    pub(super) ranges: Vec<Interval>,
    row_at: &'a RowAt<'a>,
    /// Whether a handle is that of a mode or a transition.
    is_binary: &'a dyn Fn(Variable) -> bool,
    samples: usize,
    time_step: f64,
    /// Whether a negated row is to fail by a margin that can be seen.
    separated: bool,
    pub(super) parts: Vec<MissionPart>,
    /// By part: its robustness lies in it.
    pub(super) bounds: Vec<Interval>,
    pub(super) conditions: Vec<Demand>,
    condition_ranges: Vec<Interval>,
    predicates: Vec<&'a Predicate>,
    of_predicate: HashMap<(usize, bool, usize), Id>,
    known: HashMap<MissionPart, Id>,
    read: HashMap<(*const Mission, bool, usize), Id>,
    ends: HashMap<*const Mission, Option<usize>>,
}

/// The part that is never true.
pub(super) const FALSE: Id = 0;
/// The part that is always true.
pub(super) const TRUE: Id = 1;

impl<'a> Unrolled<'a> {
    pub(super) fn new(
        model: &'a Model,
        row_at: &'a RowAt<'a>,
        is_binary: &'a dyn Fn(Variable) -> bool,
        samples: usize,
        time_step: f64,
        separated: bool,
    ) -> Self {
        let (never, always) = (MissionPart::Any(Vec::new()), MissionPart::All(Vec::new()));
        Unrolled {
            model,
            ranges: super::ranges::ranges(model),
            row_at,
            is_binary,
            samples,
            time_step,
            separated,
            parts: vec![never.clone(), always.clone()],
            bounds: vec![Interval::point(f64::NEG_INFINITY), Interval::point(f64::INFINITY)],
            conditions: Vec::new(),
            condition_ranges: Vec::new(),
            predicates: Vec::new(),
            of_predicate: HashMap::new(),
            known: HashMap::from([(never, FALSE), (always, TRUE)]),
            read: HashMap::new(),
            ends: HashMap::new(),
        }
    }

    /// A mission, or its negation, at a sample.
    pub(super) fn at(
        &mut self,
        of: &'a Mission,
        positive: bool,
        sample: usize,
    ) -> Result<Id, Error> {
        if sample >= self.samples {
            return Ok(FALSE);
        }
        let key = (std::ptr::from_ref(of), positive, sample);
        if let Some(id) = self.read.get(&key) {
            return Ok(*id);
        }
        let id = match &of.node {
            MissionNode::Holds(predicate) => self.predicate(predicate, positive, sample)?,
            MissionNode::Not(inner) => self.at(inner, !positive, sample)?,
            MissionNode::And(all) | MissionNode::Or(all) => {
                let parts = all.iter().map(|part| self.at(part, positive, sample));
                let parts = parts.collect::<Result<_, _>>()?;
                self.join(parts, matches!(of.node, MissionNode::And(_)) == positive)
            }
            MissionNode::Always(window, inner) | MissionNode::Eventually(window, inner) => {
                let all = matches!(of.node, MissionNode::Always(..)) == positive;
                let (samples, is_cut) = self.window(of, window, sample)?;
                let parts = samples.map(|j| self.at(inner, positive, j));
                let mut parts: Vec<Id> = parts.collect::<Result<_, _>>()?;
                if all && is_cut {
                    parts.push(FALSE);
                }
                self.join(parts, all)
            }
            MissionNode::Until(window, a, b) | MissionNode::Release(window, a, b) => {
                let is_until = matches!(of.node, MissionNode::Until(..)) == positive;
                let (samples, is_cut) = self.window(of, window, sample)?;
                let (mut before, mut next) = (if is_until { TRUE } else { FALSE }, sample);
                let mut terms = Vec::new();
                for j in samples {
                    while next < j {
                        let here = self.at(a, positive, next)?;
                        before = self.join(vec![before, here], is_until);
                        next += 1;
                    }
                    let here = self.at(b, positive, j)?;
                    terms.push(self.join(vec![before, here], is_until));
                }
                if !is_until && is_cut {
                    for j in next..self.samples {
                        let here = self.at(a, positive, j)?;
                        before = self.join(vec![before, here], false);
                    }
                    terms.push(before);
                }
                self.join(terms, !is_until)
            }
            MissionNode::TooDeep => return Err(too_deep()),
        };
        self.read.insert(key, id);
        Ok(id)
    }

    fn window(
        &mut self,
        of: &'a Mission,
        window: &Window,
        sample: usize,
    ) -> Result<(std::ops::RangeInclusive<usize>, bool), Error> {
        let end = match window.is_open() {
            false => self.samples.checked_sub(1),
            true => self.end(of)?,
        };
        window.samples(self.time_step, sample, end)
    }

    /// The last sample at which all predicates inside have values.
    fn end(&mut self, of: &'a Mission) -> Result<Option<usize>, Error> {
        if let Some(end) = self.ends.get(&std::ptr::from_ref(of)) {
            return Ok(*end);
        }
        let mut predicates = Vec::new();
        of.visit(&mut |part| {
            if let MissionNode::Holds(predicate) = &part.node {
                predicates.push(predicate);
            }
        });
        let mut end = self.samples.checked_sub(1);
        for predicate in predicates {
            while let Some(last) = end {
                if self.rows(predicate, last)?.is_some() {
                    break;
                }
                end = last.checked_sub(1);
            }
        }
        self.ends.insert(std::ptr::from_ref(of), end);
        Ok(end)
    }

    /// The rows of a predicate at a sample; `None` if one has no values there.
    fn rows(&self, of: &Predicate, sample: usize) -> Result<Option<Vec<SystemRow>>, Error> {
        let Some(rows) = of.rows(sample) else { return Ok(None) };
        rows.iter().map(|row| (self.row_at)(row, sample)).collect()
    }

    fn predicate(&mut self, of: &'a Predicate, positive: bool, sample: usize) -> Result<Id, Error> {
        let number = self.predicates.iter().position(|known| *known == of);
        let number = number.unwrap_or_else(|| {
            self.predicates.push(of);
            self.predicates.len() - 1
        });
        if let Some(id) = self.of_predicate.get(&(number, positive, sample)) {
            return Ok(*id);
        }
        let id = match self.rows(of, sample)? {
            None => FALSE,
            Some(rows) => {
                let mut conditions = Vec::new();
                for (row, stated) in rows.into_iter().zip(of.rows(sample).unwrap_or_default()) {
                    let is_logical = match stated {
                        SystemRow::Row(row) => {
                            row.expression().terms().iter().all(|term| (self.is_binary)(term.0))
                        }
                        SystemRow::Conic(_) | SystemRow::Nonlinear(_) => false,
                    };
                    self.conditions_of(row, is_logical, of, positive, &mut conditions)?;
                }
                let first = self.conditions.len();
                self.conditions.extend(conditions);
                let added: Vec<usize> = (first..self.conditions.len()).collect();
                for &k in &added {
                    let range = self.range(&self.conditions[k])?;
                    self.condition_ranges.push(range);
                }
                match positive {
                    true if added.is_empty() => TRUE,
                    true => self.intern(MissionPart::Conditions(added)),
                    false => {
                        let one = added.into_iter().map(|k| MissionPart::Conditions(vec![k]));
                        let parts = one.map(|part| self.intern(part)).collect();
                        self.join(parts, false)
                    }
                }
            }
        };
        self.of_predicate.insert((number, positive, sample), id);
        Ok(id)
    }

    /// The conditions of a row, or those of its negation, of which one must hold.
    fn conditions_of(
        &self,
        row: SystemRow,
        is_logical: bool,
        of: &Predicate,
        positive: bool,
        conditions: &mut Vec<Demand>,
    ) -> Result<(), Error> {
        let row = match row {
            SystemRow::Row(row) => row,
            SystemRow::Nonlinear(row) => match row.expression().as_affine() {
                Some(own) => own.clone().within(row.lower(), row.upper()),
                None => {
                    let by = if self.separated { MISSION_SEPARATION } else { 0.0 };
                    let mut push = |slack: Nonlinear| {
                        let slack = if positive { slack } else { -slack - by };
                        conditions.push(Demand::Nonlinear(slack));
                    };
                    if row.lower().abs() < INFINITE {
                        push(row.expression() - row.lower());
                    }
                    if row.upper().abs() < INFINITE {
                        push(row.upper() - row.expression());
                    }
                    return Ok(());
                }
            },
            SystemRow::Conic(_) if !positive => return Err(negated_norm(&of.name)),
            SystemRow::Conic(row) => {
                row.clone().checked(self.model, &of.name.as_str().into())?;
                conditions.push(Demand::Conic(row));
                return Ok(());
            }
        };
        let (lower, upper) = row.limits(&of.name)?;
        let expression = row.expression();
        let mut push = |slack: Affine| {
            let slack = match positive {
                true => slack,
                false if self.separated || is_logical => -slack - MISSION_SEPARATION,
                false => -slack,
            };
            conditions.push(match is_logical {
                true => Demand::Logical(slack),
                false => Demand::Slack(slack),
            });
        };
        if lower.abs() < INFINITE {
            push(expression - lower);
        }
        if upper.abs() < INFINITE {
            push(upper - expression);
        }
        Ok(())
    }

    /// In which range the robustness of a condition is.
    fn range(&self, condition: &Demand) -> Result<Interval, Error> {
        let of = |expression: &Affine| {
            let terms = expression.terms().into_iter();
            let terms = terms.map(|(variable, factor)| (factor, self.ranges[variable.index()]));
            activity::range(expression.offset(), terms)
        };
        Ok(match condition {
            Demand::Slack(slack) => of(slack),
            Demand::Logical(slack) => match of(slack) {
                range if range.lower >= 0.0 => Interval::point(f64::INFINITY),
                range if range.upper < -0.5 * MISSION_SEPARATION => {
                    Interval::point(f64::NEG_INFINITY)
                }
                _ => Interval::REALS,
            },
            Demand::Nonlinear(slack) => {
                let range = |own: Variable| IntervalSeries::constant(self.ranges[own.index()], 1);
                let series = slack.series(&range, 1);
                series.map_or(Interval::REALS, |own| own.coefficients()[0])
            }
            Demand::Conic(row) => match row.stored() {
                crate::model::StoredConic::Norm { bound, .. } => {
                    Interval::new(f64::NEG_INFINITY, of(bound).upper)
                }
                crate::model::StoredConic::Quadratic { .. } => Interval::REALS,
            },
        })
    }

    /// In which range the robustness of a part is, as far as it is a number: that of modes is none.
    pub(super) fn finite_range(&self, id: Id) -> Interval {
        let both = self.conditions.iter().zip(&self.condition_ranges);
        let numbers = both.filter(|(own, _)| !matches!(own, Demand::Logical(_)));
        let numbers: Vec<Interval> = numbers.map(|(_, range)| *range).collect();
        let whole = numbers.iter().copied().reduce(|whole, range| whole.hull(range));
        self.bounds[id].intersection(whole.unwrap_or(Interval::point(0.0)))
    }

    /// All of these, or one of them; what cannot matter is left out.
    pub(super) fn join(&mut self, parts: Vec<Id>, all: bool) -> Id {
        let (neutral, absorbing) = if all { (TRUE, FALSE) } else { (FALSE, TRUE) };
        let mut kept: Vec<Id> = Vec::with_capacity(parts.len());
        for part in parts {
            if part == absorbing {
                return absorbing;
            }
            if part != neutral && !kept.contains(&part) {
                kept.push(part);
            }
        }
        match kept[..] {
            [] => neutral,
            [only] => only,
            _ if all => self.intern(MissionPart::All(kept)),
            _ => self.intern(MissionPart::Any(kept)),
        }
    }

    fn intern(&mut self, part: MissionPart) -> Id {
        if let Some(id) = self.known.get(&part) {
            return *id;
        }
        let bounds = |of: &[Id]| of.iter().map(|id| self.bounds[*id]).collect::<Vec<_>>();
        let fold = |all: bool, of: Vec<Interval>| {
            let pick = |a: f64, b: f64| if all { a.min(b) } else { a.max(b) };
            let first = if all { f64::INFINITY } else { f64::NEG_INFINITY };
            of.iter().fold(Interval::point(first), |sum, own| {
                Interval::new(pick(sum.lower, own.lower), pick(sum.upper, own.upper))
            })
        };
        let bound = match &part {
            MissionPart::All(of) => fold(true, bounds(of)),
            MissionPart::Any(of) => fold(false, bounds(of)),
            MissionPart::Conditions(of) => {
                let ranges = of.iter().map(|k| self.condition_ranges[*k]).collect();
                let bound = fold(true, ranges);
                Interval::new(bound.lower, bound.upper.min(self.half_width(of)))
            }
        };
        self.parts.push(part.clone());
        self.bounds.push(bound);
        self.known.insert(part, self.parts.len() - 1);
        self.parts.len() - 1
    }

    /// Half of what two opposite conditions leave between them, the least of all pairs.
    fn half_width(&self, of: &[usize]) -> f64 {
        let slacks: Vec<&Affine> = of
            .iter()
            .filter_map(|k| match &self.conditions[*k] {
                Demand::Slack(slack) => Some(slack),
                _ => None,
            })
            .collect();
        let mut least = f64::INFINITY;
        for (k, first) in slacks.iter().enumerate() {
            for second in &slacks[k + 1..] {
                let sum = *first + *second;
                if sum.terms().iter().all(|term| term.1 == 0.0) {
                    least = least.min((0.5 * sum.offset()).next_up());
                }
            }
        }
        least
    }
}
