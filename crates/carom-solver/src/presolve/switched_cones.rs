//! Perspective of cones that binaries switch off.
//!
//! Takes cones with a constant in the head and a tail that binaries switch off; leaves in the place
//! of the constant a column that is 0 wherever a binary switches the tail off (Günlük and
//! Linderoth, Perspective reformulations of mixed integer nonlinear programs with indicator
//! variables, Mathematical Programming 124, 2010).
//!
//! Where a binary `b` is 0, the tail of `z^2 <= s c` with a constant `c > 0` is often 0: rows such
//! as `z <= u b` say so. The relaxation has `b` at a fraction, and there the cone asks too little
//! of `s`. The convex hull of both cases is `z^2 <= s (c b)`, with the same points wherever `b` is
//! whole: for `b = 1` it is the cone, and for `b = 0` it says `z = 0`, which holds anyway. So `c b`
//! takes the place of `c`: the column `b` itself where `c` is 1, or a further column `w = c b`.
//!
//! Where several binaries switch the tail off, `w <= c b` for each of them. Entries of a tail that
//! have binaries of their own are split: `z_i^2 <= p_i (c b_i)` with `sum p <= s`. A norm
//! `|z| <= c` is the case in which `s` is `c`, too.
//!
//! Propagation on trial finds the columns that a binary switches off.

use std::collections::BTreeMap;

use super::domain::Domain;
use super::propagation::Propagator;
use crate::program::{Addition, Cone, ConeRole, ConeShape, Program};
use crate::solver::StopToken;

/// The largest number of trials. A trial propagates the rows that it reaches.
const MOST_BINARY_TRIALS: usize = 4000;

/// Propagated bounds of a column that is off are this close to 0, and those of one that is not
/// exceed the least reach (in the unit of the column): propagation loosens each bound a little.
const OFF: f64 = 1e-8;
const LEAST_REACH: f64 = 1e-4;

/// The middle of such bounds is this close to 0, as a part of their distance: propagation loosens
/// both alike.
const EVEN: f64 = 1e-3;

/// Most binaries that are used of those that switch one entry off.
const MOST_SWITCHES: usize = 3;

/// A binary at a value: twice the column, plus the value.
pub(super) type Literal = usize;

/// The findings of the trials.
#[derive(Debug, Default)]
struct Switches {
    /// By column, the literals that fix it at 0.
    of: BTreeMap<usize, Vec<Literal>>,
    /// By literal that switches something off, what it fixes of the binaries.
    fixes: BTreeMap<Literal, Vec<Literal>>,
}

/// Replaces constant heads of cones whose tail binaries switch off; `None` if there are none.
/// Columns and rows keep their numbers; further ones, without a cost, follow. No point with whole
/// binaries is lost or won.
pub fn tighten_switched_cones(program: &Program, token: &StopToken) -> Option<Program> {
    let groups = groups(program);
    let mut wanted = vec![false; program.column_count()];
    let candidates = groups.iter().filter(|group| constant_head(program, group).is_some());
    for &j in candidates.flat_map(|group| group[0].tail()) {
        let [lower, upper] = [program.lower[j], program.upper[j]];
        wanted[j] = lower < upper && upper.max(-lower) >= LEAST_REACH;
    }
    if program.integers.is_empty() || !wanted.contains(&true) {
        return None;
    }
    let switches = find_switches(program, &wanted, token)?;
    let mut tighter = Tighter::new(program, &switches);
    groups.into_iter().for_each(|group| tighter.add(group));
    tighter.finish()
}

/// The cones, each whole one with its parts.
fn groups(program: &Program) -> Vec<&[Cone]> {
    program.cones.chunk_by(|_, next| next.role == ConeRole::Part).collect()
}

/// The last column of the head, which is that of all parts, and its value, if it is a positive
/// constant. A rotated cone whose first column is a constant, too, says no more than a norm.
fn constant_head(program: &Program, group: &[Cone]) -> Option<(usize, f64)> {
    let [cone, parts @ ..] = group else { return None };
    let &last = cone.head().last()?;
    let value = program.lower[last];
    let is_constant = value == program.upper[last] && value > 0.0 && value.is_finite();
    let agrees = parts.iter().all(|part| part.head().last() == Some(&last));
    (is_constant && agrees).then_some((last, value))
}

/// The columns that both values of the binaries switch off; `None` if there is a contradiction.
fn find_switches(program: &Program, wanted: &[bool], token: &StopToken) -> Option<Switches> {
    let mut switches = Switches::default();
    try_binaries(program, token, |domain, mark, literal| {
        switches.note(program, domain, mark, wanted, literal);
    })?;
    Some(switches)
}

/// Propagates both values of the binaries on trial, and shows those that do not contradict: the
/// domain, the mark before the trial, and the literal. `None` if there is a contradiction without
/// them.
pub(super) fn try_binaries(
    program: &Program,
    token: &StopToken,
    mut visit: impl FnMut(&Domain, usize, Literal),
) -> Option<()> {
    let mut domain = Domain::new(program);
    let mut propagator = Propagator::new(program);
    propagator.set_stop_token(token);
    // If there is a contradiction, the search reports it.
    propagator.propagate_all(program, &mut domain).ok()?;
    let mut trials = 0;
    let is_binary = |&j: &usize| domain.bounds(j) == [0.0, 1.0];
    let binaries: Vec<usize> = program.integers.iter().copied().filter(is_binary).collect();
    for j in binaries {
        for value in [0.0, 1.0] {
            trials += 1;
            if trials > MOST_BINARY_TRIALS || token.is_over() {
                return Some(());
            }
            let mark = domain.mark();
            domain.apply(j, value == 0.0, value);
            if propagator.propagate_since(program, &mut domain, mark).is_ok() {
                visit(&domain, mark, 2 * j + usize::from(value == 1.0));
            }
            domain.undo_to(mark);
        }
    }
    Some(())
}

/// Whether bounds that propagation has loosened a little are those of 0, and not of a slight
/// constant.
fn is_zero([lower, upper]: [f64; 2]) -> bool {
    let is_even = (lower + upper).abs() <= EVEN * (upper - lower);
    lower <= 0.0 && upper >= 0.0 && (is_even || lower == 0.0 || upper == 0.0)
}

impl Switches {
    /// Takes note of what a literal has fixed since a mark.
    fn note(
        &mut self,
        program: &Program,
        domain: &Domain,
        mark: usize,
        wanted: &[bool],
        literal: Literal,
    ) {
        let mut changed: Vec<usize> = domain.changed_since(mark).map(|(j, _)| j).collect();
        changed.sort_unstable();
        changed.dedup();
        let is_off = |&&j: &&usize| {
            let [lower, upper] = domain.bounds(j);
            let is_small = lower >= -OFF && upper <= OFF;
            wanted[j] && is_small && is_zero([lower, upper])
        };
        let mut switches = false;
        for &j in changed.iter().filter(is_off) {
            self.of.entry(j).or_default().push(literal);
            switches = true;
        }
        if switches {
            self.fixes.insert(literal, fixed_literals(program, domain, &changed));
        }
    }

    /// The literals that fix all of these columns at 0.
    fn common(&self, columns: &[usize]) -> Vec<Literal> {
        let Some((first, others)) = columns.split_first() else { return Vec::new() };
        let of = |j: &usize| self.of.get(j).map_or(&[][..], Vec::as_slice);
        let everywhere = |literal: &Literal| others.iter().all(|j| of(j).contains(literal));
        of(first).iter().copied().filter(everywhere).collect()
    }
}

/// The literals that changed columns are fixed at, sorted.
pub(super) fn fixed_literals(
    program: &Program,
    domain: &Domain,
    changed: &[usize],
) -> Vec<Literal> {
    let fixed = |j: &usize| program.integral[*j] && domain.is_fixed(*j);
    let fixed = changed.iter().copied().filter(fixed);
    fixed.map(|j| 2 * j + usize::from(domain.lower(j) == 1.0)).collect()
}

/// Those of some literals that are not of no use beside another one: if `a` fixes `b`, what is
/// relaxed by `b` says all that it says relaxed by `a`.
pub(super) fn strongest(
    fixes: &BTreeMap<Literal, Vec<Literal>>,
    literals: &[Literal],
) -> Vec<Literal> {
    let fixes = |a: usize, b: usize| {
        let (a, b) = (literals[a], literals[b]);
        fixes.get(&a).is_some_and(|fixed| fixed.binary_search(&b).is_ok())
    };
    let is_idle =
        |&a: &usize| (0..literals.len()).any(|b| b != a && fixes(a, b) && (b < a || !fixes(b, a)));
    let kept = (0..literals.len()).filter(|a| !is_idle(a));
    kept.map(|a| literals[a]).take(MOST_SWITCHES).collect()
}

/// The program that is being made.
struct Tighter<'a> {
    program: &'a Program,
    switches: &'a Switches,
    cones: Vec<Cone>,
    /// Upper bounds of the further columns.
    upper: Vec<f64>,
    rows: Vec<Addition>,
    /// The columns that stand for values times binaries.
    weights: BTreeMap<(u64, Vec<Literal>), usize>,
    is_tighter: bool,
}

impl<'a> Tighter<'a> {
    fn new(program: &'a Program, switches: &'a Switches) -> Self {
        Tighter {
            program,
            switches,
            cones: Vec::with_capacity(program.cones.len()),
            upper: Vec::new(),
            rows: Vec::new(),
            weights: BTreeMap::new(),
            is_tighter: false,
        }
    }

    /// Adds a cone with its parts, as tight as its switches allow.
    fn add(&mut self, group: &[Cone]) {
        let Some((head, value)) = constant_head(self.program, group) else {
            self.cones.extend_from_slice(group);
            return;
        };
        let cone = &group[0];
        let bounds = |j: usize| [self.program.lower[j], self.program.upper[j]];
        let open = cone.tail().iter().copied().filter(|&j| bounds(j) != [0.0, 0.0]);
        let common = self.switches.common(&open.collect::<Vec<_>>());
        let is_switched = |j: &usize| self.switches.of.contains_key(j);
        if !common.is_empty() {
            self.is_tighter = true;
            let weight = self.weight(value, &common, &cone.columns);
            self.cones.extend(group.iter().map(|cone| with_head(cone, weight)));
            if cone.shape == ConeShape::Norm && group.len() > 1 {
                let parts = group[1..].iter().map(|part| part.columns[0]);
                self.add_sum(parts.collect(), weight);
            }
        } else if cone.tail().len() > 1 && cone.tail().iter().any(is_switched) {
            self.is_tighter = true;
            self.split(group, head, value);
        } else {
            self.cones.extend_from_slice(group);
        }
    }

    /// Adds the parts of a cone as cones of their own, each with the binary of its entry.
    fn split(&mut self, group: &[Cone], head: usize, value: f64) {
        let sum = group[0].columns[0];
        let tail = group[0].tail();
        let parts: Vec<usize> = match &group[1..] {
            [] => tail.iter().map(|_| self.column(self.program.upper[sum])).collect(),
            parts => parts.iter().map(|part| part.columns[0]).collect(),
        };
        for (&part, &entry) in parts.iter().zip(tail) {
            let literals = self.switches.common(&[entry]);
            let head = match &literals[..] {
                [] => head,
                _ => self.weight(value, &literals, &[entry]),
            };
            self.cones.push(Cone {
                shape: ConeShape::Rotated,
                columns: vec![part, head, entry],
                role: ConeRole::Single,
            });
        }
        if group.len() == 1 {
            self.add_sum(parts, sum);
        }
    }

    /// Adds the row that the sum of some columns is at most another one.
    fn add_sum(&mut self, columns: Vec<usize>, most: usize) {
        let terms = columns.into_iter().map(|j| (j, 1.0)).chain([(most, -1.0)]);
        self.rows.push((terms.collect(), [f64::NEG_INFINITY, 0.0]));
    }

    /// A further column between 0 and a bound.
    fn column(&mut self, upper: f64) -> usize {
        self.upper.push(upper);
        self.program.column_count() + self.upper.len() - 1
    }

    /// The column of a value that is 0 where one of some literals holds; none of `taken` itself.
    fn weight(&mut self, value: f64, literals: &[Literal], taken: &[usize]) -> usize {
        let literals = strongest(&self.switches.fixes, literals);
        if let [literal] = literals[..]
            && (value, literal % 2) == (1.0, 0)
            && !taken.contains(&(literal / 2))
        {
            return literal / 2;
        }
        let key = (value.to_bits(), literals);
        if let Some(&column) = self.weights.get(&key) {
            return column;
        }
        let column = self.column(value);
        let is_single = key.1.len() == 1;
        for &literal in &key.1 {
            let (binary, off_at_one) = (literal / 2, literal % 2 == 1);
            let (a, most) = if off_at_one { (value, value) } else { (-value, 0.0) };
            let least = if is_single { most } else { f64::NEG_INFINITY };
            self.rows.push((vec![(column, 1.0), (binary, a)], [least, most]));
        }
        self.weights.insert(key, column);
        column
    }

    fn finish(self) -> Option<Program> {
        if !self.is_tighter {
            return None;
        }
        let mut program = self.program.clone();
        program.append_continuous(&self.upper, &self.rows)?;
        program.set_cones(self.cones);
        Some(program)
    }
}

/// A cone with another last column of its head.
fn with_head(cone: &Cone, column: usize) -> Cone {
    let mut cone = cone.clone();
    cone.columns[cone.shape.head() - 1] = column;
    cone
}
