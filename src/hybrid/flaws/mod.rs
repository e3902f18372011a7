//! Questions about a hybrid system that a slip in its statement answers wrongly.
//!
//! Guards become polyhedra of states and inputs (`piece.rs`), small programs look for points in
//! gaps and overlaps (`programs.rs`), and every point is evaluated again before it is reported.

mod flaw;
mod piece;
mod programs;
mod stuck;

use std::collections::BTreeSet;

pub use flaw::{Flaw, Witness};

use super::system::{Choice, HybridSystem, Transition};
use crate::error::Error;
use crate::interval::Interval;
use crate::solver::Solver;
use crate::tolerance::FREE_RADIUS;
use piece::{AffineMap, Piece, Units, base, cut_to_ranges, next_state, piece};
use programs::{Found, Steps, gap, is_possible, largest, overlap};

/// Longest dwell time, in samples, for which a run is looked for.
const LONGEST_DWELL: usize = 50;

impl HybridSystem {
    /// Looks for slips in the statement of the system: gaps and overlaps of guards, transitions that
    /// are never possible, resets that leave the domain, states that must leave it, modes without a
    /// way in or on, dwell times that cannot be kept, inputs without effect, and domains that are
    /// hardly meant.
    ///
    /// Gaps and overlaps are regions of states and inputs within domains, ranges and limits, with
    /// one such point each. Common boundaries of guards are neither. Guards stated as a
    /// [limit](super::TransitionMut::limit) do not make a gap: they are limits to be kept.
    /// That inputs can drive the state out of its domain is no flaw, but a state from which no input
    /// keeps it inside is one, such as the end of a line at full speed: one is reported for each
    /// combination of modes. With several choices, each is looked at as if the others changed nothing;
    /// only whether a transition is possible, a mode can be kept and the domain must be left depends
    /// on all.
    ///
    /// Distances are fractions of the widths of domains and ranges; up to 1e-5 they count as none.
    /// If the system depends on the step, every different step is looked at, and a flaw is
    /// reported once, at the first one.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // Nothing is said between 10 and 12 m/s.
    /// let mut vehicle = HybridSystem::new(0.1); // s
    /// let v = vehicle.state("v", 0.0, 30.0)?; // m/s
    /// let thrust = vehicle.input("thrust", 0.0, 3.0)?; // m/s²
    /// vehicle.mode("slow")?.rates([v.is(thrust - 0.1 * v)])?.guard(v.le(10.0))?;
    /// vehicle.mode("fast")?.rates([v.is(thrust - 0.2 * v)])?.guard(v.ge(12.0))?;
    ///
    /// let flaws = vehicle.flaws(&mut BranchAndBound::default())?;
    /// assert!(flaws[0].to_string().starts_with("gap in `mode`: no transition is possible at v = 11"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `solver`: solves mixed-integer linear programs with a variable per state and input.
    ///
    /// # Errors
    ///
    /// Those of [`HybridSystem::check`] and of the solver;
    /// [`ErrorKind::NoPoint`](crate::ErrorKind::NoPoint) if a limit stops it.
    pub fn flaws(&self, solver: &mut dyn Solver) -> Result<Vec<Flaw>, Error> {
        self.check()?;
        let mut search = Search { system: self, solver, flaws: Vec::new(), found: BTreeSet::new() };
        search.numbers();
        let mut steps: Vec<Step> = Vec::new();
        for step in 0..=self.settles() {
            let compiled = Step::new(self, step);
            if steps.last().is_some_and(|last| last.is_like(&compiled)) {
                continue;
            }
            for c in 0..self.choices.len() {
                search.gaps(&compiled, c)?;
                search.overlaps(&compiled, c)?;
                search.leaving(&compiled, c)?;
            }
            search.stuck(&compiled)?;
            steps.push(compiled);
        }
        for (c, choice) in self.choices.iter().enumerate() {
            let possible = search.possible(&steps, c)?;
            search.modes(&steps, c, choice, &possible)?;
        }
        Ok(search.flaws)
    }
}

/// The polyhedra of a step.
struct Step {
    number: usize,
    units: Units,
    base: Piece,
    /// The base within the system's own ranges of the inputs.
    in_range: Piece,
    /// By choice, then by transition.
    pieces: Vec<Vec<Piece>>,
    /// The next state, by choice, then by transition, then by state.
    next: Vec<Vec<Vec<AffineMap>>>,
}

impl Step {
    fn new(system: &HybridSystem, number: usize) -> Self {
        let units = Units::new(system, number);
        let base = base(system, &units, number);
        let mut in_range = base.clone();
        cut_to_ranges(&mut in_range, system, &units, number);
        let pieces = |choice: &Choice| {
            choice.transitions.iter().map(|t| piece(system, &units, choice, t, number)).collect()
        };
        let next = |choice: &Choice| {
            choice.transitions.iter().map(|t| next_state(system, t, number)).collect()
        };
        let (pieces, next) = (
            system.choices.iter().map(pieces).collect(),
            system.choices.iter().map(next).collect(),
        );
        Step { number, units, base, in_range, pieces, next }
    }

    fn is_like(&self, other: &Step) -> bool {
        self.units == other.units
            && self.in_range == other.in_range
            && self.pieces == other.pieces
            && self.next == other.next
    }

    fn size(&self) -> usize {
        self.units.lower.len()
    }
}

struct Search<'a> {
    system: &'a HybridSystem,
    solver: &'a mut dyn Solver,
    flaws: Vec<Flaw>,
    /// The keys of the flaws reported so far.
    found: BTreeSet<[String; 3]>,
}

impl Search<'_> {
    /// Whether something has not been reported yet.
    fn is_new(&self, what: &str, first: &str, second: &str) -> bool {
        !self.found.contains(&[what, first, second].map(str::to_owned))
    }

    fn report(&mut self, what: &str, first: &str, second: &str, flaw: Flaw) {
        if self.found.insert([what, first, second].map(str::to_owned)) {
            self.flaws.push(flaw);
        }
    }

    fn witness(&self, step: &Step, point: &[f64]) -> Witness {
        let values = step.units.at(point);
        let (state, input) = values.split_at(self.system.states.len());
        let named = |names: Vec<&String>, values: &[f64]| {
            names.into_iter().cloned().zip(values.iter().copied()).collect()
        };
        Witness {
            step: step.number,
            state: named(self.system.states.iter().map(|(name, _)| name).collect(), state),
            input: named(self.system.inputs.iter().map(|(name, _)| name).collect(), input),
        }
    }

    /// Domains that are hardly meant, and inputs without effect.
    fn numbers(&mut self) {
        let system = self.system;
        let domains = system.states.iter().map(|(name, domain)| (name, *domain));
        let own = system.transitions().flat_map(|transition| &transition.inputs);
        let ranges = system.inputs.iter().chain(own);
        let ranges = ranges.flat_map(|(name, range)| range.values().map(move |r| (name, *r)));
        for (name, range) in domains.chain(ranges) {
            if range.magnitude() >= FREE_RADIUS {
                let flaw = Flaw::Unbounded { name: name.clone(), range };
                self.report("unbounded", name, "", flaw);
            }
        }
        for (k, (name, _)) in system.inputs.iter().enumerate() {
            let flows = system.transitions().map(|t| &t.flow).chain(&system.flow);
            let moves = flows.flat_map(|flow| (0..flow.states()).map(|i| flow.b()[(i, k)]));
            let guards = system.transitions().flat_map(|t| &t.guards).chain(&system.limits);
            let limits = guards.filter_map(|h| h.parts(system.states.len()).1.get(k)).copied();
            if moves.chain(limits).all(|factor| factor == 0.0) {
                let flaw = Flaw::NoEffect { input: name.clone() };
                self.report("no effect", name, "", flaw);
            }
        }
    }

    fn gaps(&mut self, step: &Step, c: usize) -> Result<(), Error> {
        let choice = &self.system.choices[c];
        if choice.may_end {
            return Ok(());
        }
        let modes = choice.modes();
        let modes: Vec<Option<&str>> =
            if modes.is_empty() { vec![None] } else { modes.into_iter().map(Some).collect() };
        for mode in modes {
            let key = mode.unwrap_or("");
            let own = choice.transitions.iter().zip(&step.pieces[c]);
            let own: Vec<&Piece> =
                own.filter(|(t, _)| begins_in(t, mode)).map(|(_, piece)| piece).collect();
            // A mode without transitions is reported as such.
            if own.is_empty() || !self.is_new("gap", &choice.name, key) {
                continue;
            }
            if let Some(Found { point, margin }) =
                gap(&step.in_range, &own, step.size(), self.solver)?
            {
                let flaw = Flaw::Gap {
                    choice: choice.name.clone(),
                    mode: mode.map(str::to_owned),
                    witness: self.witness(step, &point),
                    margin,
                };
                self.report("gap", &choice.name, key, flaw);
            }
        }
        Ok(())
    }

    fn overlaps(&mut self, step: &Step, c: usize) -> Result<(), Error> {
        let choice = &self.system.choices[c];
        if choice.is_free {
            return Ok(());
        }
        for (i, a) in choice.transitions.iter().enumerate() {
            for (j, b) in choice.transitions.iter().enumerate().skip(i + 1) {
                let from = |t: &Transition| t.modes.as_ref().map(|(from, _)| from.clone());
                let pair = format!("{i}, {j}");
                if from(a) != from(b) || !self.is_new("overlap", &choice.name, &pair) {
                    continue;
                }
                let pieces = [&step.pieces[c][i], &step.pieces[c][j]];
                if let Some(Found { point, margin }) =
                    overlap(&step.base, pieces, step.size(), self.solver)?
                {
                    let flaw = Flaw::Overlap {
                        choice: choice.name.clone(),
                        transitions: [a.name.clone(), b.name.clone()],
                        witness: self.witness(step, &point),
                        margin,
                    };
                    self.report("overlap", &choice.name, &pair, flaw);
                }
            }
        }
        Ok(())
    }

    /// Resets, and flows on which no input acts, that lead out of the domain.
    fn leaving(&mut self, step: &Step, c: usize) -> Result<(), Error> {
        let system = self.system;
        let (choice, n) = (&system.choices[c], system.states.len());
        for (j, transition) in choice.transitions.iter().enumerate() {
            let next = &step.next[c][j];
            let is_autonomous = system.choices.len() == 1
                && !choice.may_end
                && next.iter().all(|map| map.factors[n..].iter().all(|&factor| factor == 0.0));
            for (i, (name, domain)) in system.states.iter().enumerate() {
                let key = format!("{j}, {i}");
                let is_reset = changes(transition, i, step.number);
                if !(is_reset || is_autonomous) || !self.is_new("leaves", &choice.name, &key) {
                    continue;
                }
                let width = if domain.width() > 0.0 { domain.width() } else { 1.0 };
                let mut worst: Option<Found> = None;
                for (sign, end) in [(1.0, domain.upper), (-1.0, -domain.lower)] {
                    let beyond = beyond(system, choice, transition, step, (&next[i], sign / width));
                    let beyond = AffineMap { constant: beyond.constant - end / width, ..beyond };
                    let found = largest(&step.base, &step.pieces[c][j], &beyond, self.solver)?;
                    let best = worst.as_ref().map_or(0.0, |found| found.margin);
                    worst = found.filter(|found| found.margin > best).or(worst);
                }
                if let Some(Found { point, .. }) = worst {
                    let value = next[i].value(&step.units.at(&point));
                    let flaw = Flaw::LeavesDomain {
                        choice: choice.name.clone(),
                        transition: transition.name.clone(),
                        state: name.clone(),
                        witness: self.witness(step, &point),
                        distance: (domain.lower - value).max(value - domain.upper),
                    };
                    self.report("leaves", &choice.name, &key, flaw);
                }
            }
        }
        Ok(())
    }

    /// Which transitions of a choice can be taken at all.
    fn possible(&mut self, steps: &[Step], c: usize) -> Result<Vec<bool>, Error> {
        let (system, choice) = (self.system, &self.system.choices[c]);
        let mut possible = Vec::new();
        for (j, transition) in choice.transitions.iter().enumerate() {
            let mut is_taken = false;
            if !(transition.is_event && system.most_events == Some(0)) {
                for step in steps {
                    let run = vec![(step.number, allowed(system, c, vec![j]))];
                    is_taken = is_taken || is_possible(system, &run, self.solver)?;
                }
            }
            if !is_taken {
                let (choice, transition) = (choice.name.clone(), transition.name.clone());
                self.flaws.push(Flaw::NeverTaken { choice, transition });
            }
            possible.push(is_taken);
        }
        Ok(possible)
    }

    /// Modes without a way in or on, and dwell times that cannot be kept.
    fn modes(
        &mut self,
        steps: &[Step],
        c: usize,
        choice: &Choice,
        possible: &[bool],
    ) -> Result<(), Error> {
        let between = |test: &dyn Fn(&str, &str) -> bool| -> Vec<usize> {
            let own = choice.transitions.iter().zip(possible).enumerate();
            let own = own.filter(|(_, (t, possible))| {
                **possible && t.modes.as_ref().is_some_and(|(from, to)| test(from, to))
            });
            own.map(|(j, _)| j).collect()
        };
        for mode in choice.modes() {
            let name = mode.to_owned();
            let entering = between(&|from, to| from != mode && to == mode);
            let staying = between(&|from, to| from == mode && to == mode);
            let leaving = between(&|from, to| from == mode && to != mode);
            if entering.is_empty() {
                let flaw = Flaw::NeverEntered { choice: choice.name.clone(), mode: name.clone() };
                self.flaws.push(flaw);
            }
            let own = choice.dwells.iter().filter(|dwell| dwell.mode == mode);
            let must_leave = own.clone().any(|dwell| dwell.most.is_some());
            let is_stuck = leaving.is_empty() && (staying.is_empty() || must_leave);
            if is_stuck && !choice.may_end {
                let flaw = Flaw::NoWayOn { choice: choice.name.clone(), mode: name.clone() };
                self.flaws.push(flaw);
            }
            let least = own.map(|dwell| dwell.least).max().unwrap_or(1);
            if least < 2 || entering.is_empty() {
                continue;
            }
            let mut is_kept = false;
            for step in steps.iter().filter(|_| !staying.is_empty()) {
                let run: Steps = (0..least.min(LONGEST_DWELL))
                    .map(|k| {
                        let own = if k == 0 { &entering } else { &staying };
                        (step.number + k, allowed(self.system, c, own.clone()))
                    })
                    .collect();
                is_kept = is_kept || is_possible(self.system, &run, self.solver)?;
            }
            if !is_kept {
                let choice = choice.name.clone();
                self.flaws.push(Flaw::NeverKept { choice, mode: name, least });
            }
        }
        Ok(())
    }
}

fn begins_in(transition: &Transition, mode: Option<&str>) -> bool {
    mode.is_none_or(|mode| transition.modes.as_ref().is_some_and(|(from, _)| from == mode))
}

/// All transitions of every choice, except for one choice.
fn allowed(system: &HybridSystem, choice: usize, own: Vec<usize>) -> Vec<Vec<usize>> {
    let all = system.choices.iter().map(|choice| (0..choice.transitions.len()).collect());
    let mut allowed: Vec<Vec<usize>> = all.collect();
    allowed[choice] = own;
    allowed
}

/// Whether a reset changes a state.
fn changes(transition: &Transition, state: usize, step: usize) -> bool {
    transition.reset.as_ref().is_some_and(|reset| {
        let own = |j: usize| if j == state { 1.0 } else { 0.0 };
        let row = (0..reset.matrix.ncols()).any(|j| reset.matrix[(state, j)] != own(j));
        row || reset.offset.get(step).and_then(|r| r.get(state)).is_some_and(|&r| r != 0.0)
    })
}

/// A next state times a factor, as a function of the unit box, with those inputs that keep it the
/// lowest.
fn beyond(
    system: &HybridSystem,
    choice: &Choice,
    transition: &Transition,
    step: &Step,
    (next, factor): (&AffineMap, f64),
) -> AffineMap {
    let n = system.states.len();
    let factors = next.factors.iter().map(|own| factor * own);
    let mut map = AffineMap { factors: factors.collect(), constant: factor * next.constant };
    for k in 0..system.inputs.len() {
        let widest = Interval::new(
            step.units.lower[n + k],
            step.units.lower[n + k] + step.units.width[n + k],
        );
        let own = system.input_range(choice, transition, k, step.number);
        let Interval { lower, upper } = own.unwrap_or(widest);
        let own = std::mem::take(&mut map.factors[n + k]);
        map.constant += (own * lower).min(own * upper);
    }
    step.units.scaled(&map)
}
