//! Questions about a hybrid system that a slip in its statement answers wrongly.
//!
//! Guards become polyhedra of states and inputs (`piece.rs`), small programs look for points in
//! gaps and overlaps (`programs.rs`) and for states that must leave the domain (`stuck.rs`), and
//! every point is evaluated again before it is reported.

mod ill_posedness;
mod joint_transitions;
mod piece;
mod programs;
mod stuck;

use std::collections::BTreeSet;

pub use ill_posedness::{IllPosedness, WitnessPoint};

use super::step::{self, Dynamics};
use super::system::{Approximation, Choice, HybridSystem, Transition};
use crate::error::Error;
use crate::interval::Interval;
use crate::solver::Solver;
use joint_transitions::{JointPiece, joined, joint_transitions};
use piece::{Piece, Units, base, piece};
use programs::{Found, gap, is_empty_at, overlap};

impl HybridSystem {
    /// Looks for slips in the statement of the system: gaps and overlaps of guards, transitions
    /// that are never possible, and dead ends.
    ///
    /// Gaps and overlaps are regions of states and inputs within domains, ranges and limits, with
    /// one such point each. Common boundaries of guards are neither. Guards stated as a
    /// [limit](super::TransitionMut::limit) do not make a gap: they are limits to be kept. A dead
    /// end is a state from which no input keeps the state in its domain, such as the end of a line
    /// at full speed: one is reported for each combination of modes. With several choices, each
    /// choice is looked at for gaps and overlaps as if the others changed nothing; only whether a
    /// transition is possible and the domain must be left depends on all.
    ///
    /// Norms count as polygons around them, which reach up to 2 % farther: a gap and a dead end are
    /// ones of the norms as well, while an overlap may be no wider than that.
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
    /// let flaws = vehicle.well_posedness(&mut BranchAndBound::default())?;
    /// let what = "gap in `mode`: no transition is possible at v = 11";
    /// assert!(flaws[0].to_string().starts_with(what));
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
    /// [`ErrorKind::NoPoint`](crate::error::ErrorKind::NoPoint) if a limit stops it.
    pub fn well_posedness(&self, solver: &mut dyn Solver) -> Result<Vec<IllPosedness>, Error> {
        self.check()?;
        self.check_is_linear("a check of well-posedness")?;
        let system = &self.polyhedral(Approximation::Outer);
        let mut search = Search { system, solver, flaws: Vec::new(), found: BTreeSet::new() };
        let never = |choice: &Choice| vec![false; choice.transitions.len()];
        let mut possible: Vec<Vec<bool>> = system.choices.iter().map(never).collect();
        let mut steps: Vec<Step> = Vec::new();
        for step in 0..=system.settles() {
            let compiled = Step::new(system, step);
            if steps.last().is_some_and(|last| last.is_like(&compiled)) {
                continue;
            }
            for c in 0..system.choices.len() {
                search.gaps(&compiled, c)?;
                search.overlaps(&compiled, c)?;
            }
            let transitions = joint_transitions(system, &compiled);
            search.stuck(&compiled, transitions.as_deref().unwrap_or_default())?;
            search.possible(&compiled, transitions.as_deref(), &mut possible)?;
            steps.push(compiled);
        }
        for (choice, possible) in system.choices.iter().zip(possible) {
            for (transition, _) in choice.transitions.iter().zip(possible).filter(|(_, p)| !p) {
                let (choice, transition) = (choice.name.clone(), transition.name.clone());
                search.flaws.push(IllPosedness::NeverTaken { choice, transition });
            }
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
    dynamics: Vec<Vec<Dynamics>>,
    /// By choice, then by transition.
    pieces: Vec<Vec<Piece>>,
}

impl Step {
    fn new(system: &HybridSystem, number: usize) -> Self {
        let units = Units::new(system, number);
        let base = base(system, &units, number);
        let mut in_range = base.clone();
        for (k, (_, range)) in system.inputs.iter().enumerate() {
            let range = range.get(number).copied().unwrap_or(Interval::REALS);
            in_range.cut_to(&units, system.states.len() + k, range);
        }
        let dynamics = |choice: &Choice| -> Vec<Dynamics> {
            let of = |transition| {
                // All numbers if the choice does not limit an input.
                let own = |k| system.input_range(choice, transition, k, number);
                let inputs = (0..system.inputs.len()).map(|k| own(k).unwrap_or(Interval::REALS));
                step::dynamics(system, transition, &[], inputs.collect(), number)
            };
            choice.transitions.iter().map(of).collect()
        };
        let dynamics: Vec<Vec<Dynamics>> = system.choices.iter().map(dynamics).collect();
        let pieces = |own: &Vec<Dynamics>| own.iter().map(|own| piece(&units, own)).collect();
        let pieces = dynamics.iter().map(pieces).collect();
        Step { number, units, base, in_range, dynamics, pieces }
    }

    fn is_like(&self, other: &Step) -> bool {
        self.units == other.units
            && self.in_range == other.in_range
            && self.dynamics == other.dynamics
    }
}

struct Search<'a> {
    system: &'a HybridSystem,
    solver: &'a mut dyn Solver,
    flaws: Vec<IllPosedness>,
    /// The keys of the flaws reported so far.
    found: BTreeSet<[String; 3]>,
}

impl Search<'_> {
    /// Whether something has not been reported yet.
    fn is_new(&self, what: &str, first: &str, second: &str) -> bool {
        !self.found.contains(&[what, first, second].map(str::to_owned))
    }

    fn report(&mut self, what: &str, first: &str, second: &str, flaw: IllPosedness) {
        if self.found.insert([what, first, second].map(str::to_owned)) {
            self.flaws.push(flaw);
        }
    }

    fn witness(&self, step: &Step, point: &[f64]) -> WitnessPoint {
        let values = step.units.at(point);
        let (state, input) = values.split_at(self.system.states.len());
        let named = |names: Vec<&String>, values: &[f64]| {
            names.into_iter().cloned().zip(values.iter().copied()).collect()
        };
        WitnessPoint {
            step: step.number,
            state: named(self.system.states.iter().map(|(name, _)| name).collect(), state),
            input: named(self.system.inputs.iter().map(|(name, _)| name).collect(), input),
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
            if !self.is_new("gap", &choice.name, key) {
                continue;
            }
            if let Some(Found { point, margin }) =
                gap(&step.in_range, &own, step.units.size(), self.solver)?
            {
                let flaw = IllPosedness::Gap {
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
                    overlap(&step.base, pieces, step.units.size(), self.solver)?
                {
                    let flaw = IllPosedness::Overlap {
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

    /// Notes which transitions can be taken in a step and lead to a state in the domain.
    fn possible(
        &mut self,
        step: &Step,
        transitions: Option<&[JointPiece]>,
        possible: &mut [Vec<bool>],
    ) -> Result<(), Error> {
        for (c, choice) in self.system.choices.iter().enumerate() {
            for (j, transition) in choice.transitions.iter().enumerate() {
                let is_excluded = transition.is_event && self.system.most_events == Some(0);
                if is_excluded || possible[c][j] {
                    continue;
                }
                let ways: Vec<&Piece> = match transitions {
                    Some(transitions) => {
                        let own = transitions.iter().filter(|own| own.taken[c] == j);
                        own.map(|own| &own.inside).collect()
                    }
                    // With many joint transitions, the conditions of the transition alone.
                    None => vec![&step.pieces[c][j]],
                };
                for way in ways {
                    let piece = joined([way, &step.base]);
                    if !is_empty_at(&piece, &[], step.units.size(), true, self.solver)? {
                        possible[c][j] = true;
                        break;
                    }
                }
            }
        }
        Ok(())
    }
}

fn begins_in(transition: &Transition, mode: Option<&str>) -> bool {
    mode.is_none_or(|mode| transition.modes.as_ref().is_some_and(|(from, _)| from == mode))
}
