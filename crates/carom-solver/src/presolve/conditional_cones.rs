//! Cones that have room while a binary has one of its values.
//!
//! Takes second-order cones and binaries; leaves heads that are smaller, by the room, while a
//! binary has such a value.
//!
//! A norm under a condition is often `|z| <= r + M (1 - b)`. If propagation tells that `|z|` is at
//! most `h - c` wherever `b` is 0, where `h` is the head, then `|z| <= h - c (1 - b)` has the same
//! points with whole `b`: nothing changes where `b` is 1. It is the coefficient tightening of rows,
//! for cones.
//!
//! Rotated cones have such a room, too. In `t^2 <= h g` it is enough that `k |t| <= h - c` and
//! `|t| <= k g` for some `k > 0` wherever `b` is 0; then `h - c (1 - b)` takes the place of `h`. An
//! example is the convex hull of `w <= y / (1 + y)` and `w = 0`: as a cone,
//! `y^2 <= (1 + y) (y - w)`, which is `y^2 <= (b + y) (y - w)` with the room `c = 1`.
//!
//! Differences such as `h - k t` are measured in terms of the columns that define heads and tails
//! by rows, because their bounds apart from each other say little.

use std::collections::BTreeMap;

use super::domain::Domain;
use super::parameters::FEW_ROUNDINGS;
use super::switched_cones::{Literal, fixed_literals, strongest, try_binaries};
use crate::activity::ends;
use crate::program::{Addition, Cone, ConeRole, ConeShape, Program};
use crate::solver::StopToken;

/// The least room that is used, in units of the head and relative to its constants.
const LEAST_ROOM: f64 = 1e-4;

/// Rooms from this part of the largest one on count as alike.
const MOST_OF_IT: f64 = 0.999;

/// By how much propagated bounds may miss a condition, in its unit: propagation loosens each bound
/// a little.
const LOOSE: f64 = 1e-8;

/// Longest rows that define a column.
const LONGEST_DEFINITION: usize = 50;

/// Most factors `k` that are tried for a cone.
const MOST_FACTORS: usize = 4;

/// A sum over columns, and a constant.
#[derive(Debug, Clone, Default)]
struct ColumnSum {
    terms: BTreeMap<usize, f64>,
    constant: f64,
}

/// A cone in terms of the columns that define its own.
struct Defined {
    /// Its place among the cones.
    place: usize,
    heads: Vec<ColumnSum>,
    tail: Vec<ColumnSum>,
    /// The room of heads by literal: the head, the literal and the room.
    rooms: Vec<(usize, Literal, f64)>,
}

/// Takes the room of cones out of their heads; `None` if there is none. Columns and rows keep their
/// numbers; further ones, without a cost, follow. No point with whole binaries is lost or won.
pub fn tighten_conditional_cones(program: &Program, token: &StopToken) -> Option<Program> {
    if program.integers.is_empty() {
        return None;
    }
    let mut cones: Vec<Defined> =
        (0..program.cones.len()).filter_map(|place| define(program, place)).collect();
    let mut users: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, cone) in cones.iter().enumerate() {
        for expression in cone.heads.iter().chain(&cone.tail) {
            expression.terms.keys().for_each(|&j| users.entry(j).or_default().push(k));
        }
    }
    if users.is_empty() {
        return None;
    }
    let mut fixes: BTreeMap<Literal, Vec<Literal>> = BTreeMap::new();
    try_binaries(program, token, |domain, mark, literal| {
        let changed = domain.changed_since(mark).filter_map(|(j, _)| users.get(&j));
        let mut touched: Vec<usize> = changed.flatten().copied().collect();
        touched.sort_unstable();
        touched.dedup();
        let mut gives_room = false;
        for k in touched {
            gives_room |= cones[k].try_room(program, domain, literal);
        }
        if gives_room {
            let mut changed: Vec<usize> = domain.changed_since(mark).map(|(j, _)| j).collect();
            changed.sort_unstable();
            changed.dedup();
            fixes.insert(literal, fixed_literals(program, domain, &changed));
        }
    })?;
    let (mut upper, mut rows): (Vec<f64>, Vec<Addition>) = (Vec::new(), Vec::new());
    let mut tight = program.cones.clone();
    for cone in cones {
        let Some((head, literal, room)) = cone.best(&fixes) else { continue };
        let columns = &mut tight[cone.place].columns;
        let (binary, old) = (literal / 2, columns[head]);
        columns[head] = program.column_count() + upper.len();
        // `new = old - room (1 - b)`, or `old - room b`.
        let (a, limit) = if literal % 2 == 0 { (-room, -room) } else { (room, 0.0) };
        let mut terms = BTreeMap::from([(columns[head], 1.0), (old, -1.0)]);
        *terms.entry(binary).or_default() += a;
        rows.push((terms.into_iter().filter(|term| term.1 != 0.0).collect(), [limit, limit]));
        upper.push(program.upper[old]);
    }
    if upper.is_empty() {
        return None;
    }
    let mut tighter = program.clone();
    tighter.append_continuous(&upper, &rows)?;
    tighter.set_cones(tight);
    Some(tighter)
}

/// A cone that stands for itself, in terms of other columns.
fn define(program: &Program, place: usize) -> Option<Defined> {
    let cone = &program.cones[place];
    let is_fixed = |j: &usize| program.lower[*j] == program.upper[*j];
    if cone.role != ConeRole::Single || cone.tail().iter().all(is_fixed) {
        return None;
    }
    let expand = |columns: &[usize]| columns.iter().map(|&j| expand(program, j)).collect();
    Some(Defined {
        place,
        heads: expand(cone.head()),
        tail: expand(cone.tail()),
        rooms: Vec::new(),
    })
}

/// A column in terms of those that its only row, an equality, defines it by, twice at most.
fn expand(program: &Program, column: usize) -> ColumnSum {
    let mut expression = ColumnSum::default();
    let own = defining_row(program, column);
    let Some(first) = own else {
        expression.terms.insert(column, 1.0);
        return expression;
    };
    let (terms, constant) = solved(program, first, column);
    expression.constant = constant;
    for (j, a) in terms {
        match defining_row(program, j).filter(|&row| row != first) {
            Some(row) => {
                let (terms, constant) = solved(program, row, j);
                expression.constant += a * constant;
                terms.into_iter().for_each(|(i, b)| expression.add(i, a * b, 0.0));
            }
            None => expression.add(j, a, 0.0),
        }
    }
    expression
}

fn defining_row(program: &Program, column: usize) -> Option<usize> {
    let &[row] = program.column(column).0 else { return None };
    let limit = program.row_lower[row];
    let is_short = program.row(row).0.len() <= LONGEST_DEFINITION;
    (limit == program.row_upper[row] && is_short && !program.integral[column]).then_some(row)
}

/// A row solved for one of its columns: the other terms, and the constant.
fn solved(program: &Program, row: usize, column: usize) -> (Vec<(usize, f64)>, f64) {
    let terms = || program.row(row).0.iter().copied().zip(program.row(row).1.iter().copied());
    let own = terms().find(|term| term.0 == column).map_or(1.0, |term| term.1);
    let others = terms().filter(|term| term.0 != column);
    (others.map(|(j, a)| (j, -a / own)).collect(), program.row_lower[row] / own)
}

impl ColumnSum {
    /// Adds a term; a sum that is no more than the rounding of its parts is 0.
    fn add(&mut self, column: usize, a: f64, rounding: f64) {
        let term = self.terms.entry(column).or_default();
        let size = term.abs().max(a.abs());
        *term += a;
        if term.abs() <= rounding * size {
            *term = 0.0;
        }
    }

    /// This expression plus a multiple of another one.
    fn plus(&self, factor: f64, other: &ColumnSum) -> ColumnSum {
        let mut sum = self.clone();
        sum.constant += factor * other.constant;
        other.terms.iter().for_each(|(&j, &a)| sum.add(j, factor * a, FEW_ROUNDINGS));
        sum
    }

    /// Its least and largest value.
    fn range(&self, domain: &Domain) -> [f64; 2] {
        let terms = self.terms.iter().filter(|term| *term.1 != 0.0);
        ends([self.constant; 2], terms.map(|(&j, &a)| (a, domain.bounds(j))))
    }
}

impl Defined {
    /// Measures the room of the heads in a domain in which a literal holds. Returns whether there
    /// is any.
    fn try_room(&mut self, program: &Program, domain: &Domain, literal: Literal) -> bool {
        let known = self.rooms.len();
        let cone: &Cone = &program.cones[self.place];
        for head in 0..self.heads.len() {
            let room = match cone.shape {
                // Other binaries bound tails, too, but rows or cones say that.
                ConeShape::Norm if !self.heads[0].terms.contains_key(&(literal / 2)) => None,
                ConeShape::Norm => self.room_of_norm(domain),
                ConeShape::Rotated => self.room_of_rotated(domain, head),
            };
            let Some(room) = room else { continue };
            let least = LEAST_ROOM * self.heads[head].constant.abs().max(1.0);
            if room.is_finite() && room > least {
                self.rooms.push((head, literal, room));
            }
        }
        self.rooms.len() > known
    }

    /// The largest room, and of several literals with it the one that the others fix.
    fn best(&self, fixes: &BTreeMap<Literal, Vec<Literal>>) -> Option<(usize, Literal, f64)> {
        let most = self.rooms.iter().map(|(_, _, room)| *room).reduce(f64::max)?;
        let near = || self.rooms.iter().filter(|(_, _, room)| *room >= MOST_OF_IT * most);
        let literals: Vec<Literal> = near().map(|(_, literal, _)| *literal).collect();
        let &literal = strongest(fixes, &literals).first()?;
        near().find(|(_, own, _)| *own == literal).copied()
    }

    fn room_of_norm(&self, domain: &Domain) -> Option<f64> {
        let [least, _] = self.heads.first()?.range(domain);
        let longest = self.tail.iter().map(|entry| {
            let [lower, upper] = entry.range(domain);
            upper.max(-lower)
        });
        let length = longest.fold(0.0_f64, f64::hypot);
        Some(least - length * (1.0 + FEW_ROUNDINGS) - LOOSE)
    }

    fn room_of_rotated(&self, domain: &Domain, head: usize) -> Option<f64> {
        let (own, other) = (&self.heads[head], &self.heads[1 - head]);
        let is_off = |entry: &&ColumnSum| {
            let [lower, upper] = entry.range(domain);
            lower >= -LOOSE && upper <= LOOSE
        };
        let mut left = self.tail.iter().filter(|entry| !is_off(entry));
        let (entry, more) = (left.next(), left.next());
        let Some(entry) = entry else { return Some(own.range(domain)[0]) };
        if more.is_some() {
            return None;
        }
        // Factors at which a column cancels.
        let open = entry.terms.iter().filter(|(j, t)| **t != 0.0 && !domain.is_fixed(**j));
        let mut factors: Vec<f64> = Vec::new();
        for (j, t) in open {
            let of = |expression: &ColumnSum| expression.terms.get(j).map_or(0.0, |a| a.abs());
            factors.extend([of(own) / t.abs(), t.abs() / of(other)]);
        }
        factors.retain(|factor| factor.is_finite() && *factor > 0.0);
        factors.dedup();
        let rooms = factors.into_iter().take(MOST_FACTORS).filter_map(|factor| {
            let least = |head: &ColumnSum, factor: f64| {
                let both = [factor, -factor].map(|k| head.plus(k, entry).range(domain)[0]);
                both[0].min(both[1])
            };
            (least(other, 1.0 / factor) >= -LOOSE).then(|| least(own, factor))
        });
        rooms.reduce(f64::max)
    }
}
