//! The transitions of one step: which are possible, and which are taken.

use super::condition::{Slack, tightest};
use super::memory::Memory;
use super::options::SimulationOptions;
use super::simulation::{Candidate, DeadEnd, SimulatedStep};
use super::step::{Flown, StepStart};
use crate::error::Error;
use crate::hybrid::system::{Choice, Transition};

/// Up to how many combinations of transitions are counted in a step.
const MOST_MOVES: usize = 65_536;

/// Finds the transitions of one step.
pub(super) struct Stepper<'a> {
    pub(super) start: StepStart<'a>,
    pub(super) memory: &'a Memory,
    pub(super) options: &'a SimulationOptions,
    /// The disturbance that is added to the next state; empty if there is none.
    pub(super) disturbance: &'a [f64],
}

/// The transitions taken, and where they lead.
pub(super) struct Taken {
    /// By choice, their positions.
    pub(super) picked: Vec<usize>,
    pub(super) next: Vec<f64>,
    pub(super) report: SimulatedStep,
}

/// A transition, where it leads, and the tightest of its conditions.
struct Way<'a> {
    transition: &'a Transition,
    flown: Flown,
    own: Option<Slack>,
    /// The tightest condition on it and the others together: the best over the combinations that
    /// contain it.
    joint: Option<Slack>,
    is_possible: bool,
}

/// A combination of transitions, one per choice, by their positions.
struct Combination {
    picked: Vec<usize>,
    next: Vec<f64>,
    tightest: Option<Slack>,
}

/// The dead end at a sample, if one of its conditions is violated.
pub(super) fn violated(step: usize, slacks: Vec<Slack>, tolerance: f64) -> Option<DeadEnd> {
    let tightest = tightest(slacks).filter(|slack| !slack.holds(tolerance))?;
    Some(DeadEnd::Sample { step, condition: tightest.condition, violation: -tightest.slack })
}

impl<'a> Stepper<'a> {
    /// The step that is taken, or why there is none.
    pub(super) fn take(&self, plan: Option<&[String]>) -> Result<Result<Taken, DeadEnd>, Error> {
        let (step, tolerance) = (self.start.step, self.options.tolerance);
        if let Some(end) = violated(step, self.start.joint_limits(), tolerance) {
            return Ok(Err(end));
        }
        let choices = &self.start.system.choices;
        let ways = choices.iter().enumerate().map(|(c, choice)| {
            choice.transitions.iter().map(|transition| self.way(c, choice, transition)).collect()
        });
        let mut ways: Vec<Vec<Way<'a>>> = ways.collect::<Result<_, Error>>()?;
        let (moves, best) = self.combine(&mut ways)?;
        let candidates: Vec<Vec<Candidate>> =
            ways.iter().map(|ways| ways.iter().map(Way::candidate).collect()).collect();
        let best = match plan {
            Some(plan) => match self.planned(plan, &ways, &candidates)? {
                Ok(planned) => Some(planned),
                Err(end) => return Ok(Err(end)),
            },
            None => best,
        };
        let stuck = ways.iter().zip(choices).zip(&candidates).find(|((ways, _), _)| {
            let alone = ways.iter().any(|way| way.holds(tolerance));
            !alone || moves == 0 && choices.len() == 1
        });
        if let Some(((_, choice), candidates)) = stuck {
            let (choice, candidates) = (choice.name.clone(), candidates.clone());
            return Ok(Err(DeadEnd::Choice { step, choice, candidates }));
        }
        let Some(Combination { picked, next, tightest }) = best else {
            let what = "the number of combinations of transitions in a step";
            return Err(Error::out_of_range(what, f64::INFINITY, format!("at most {MOST_MOVES}")));
        };
        if let Some(slack) = tightest.filter(|slack| !slack.holds(tolerance)) {
            let (condition, violation) = (slack.condition, -slack.slack);
            return Ok(Err(DeadEnd::Combination { step, condition, violation }));
        }
        let taken: Vec<&Way<'a>> =
            picked.iter().zip(&ways).filter_map(|(&k, ways)| ways.get(k)).collect();
        let report = report(&taken, candidates, moves);
        Ok(Ok(Taken { picked, next, report }))
    }

    fn way(&self, c: usize, choice: &Choice, transition: &'a Transition) -> Result<Way<'a>, Error> {
        let (flown, mut slacks) = self.start.fly(choice, transition)?;
        slacks.extend(self.memory.conditions(self.start.system, c, transition));
        let own = tightest(slacks);
        Ok(Way { transition, flown, own, joint: None, is_possible: false })
    }

    /// Where a combination leads, and the tightest condition of what the transitions must satisfy
    /// together.
    fn evaluate(&self, ways: &[Vec<Way<'a>>], picked: &[usize]) -> Result<Combination, Error> {
        let chosen = picked.iter().zip(ways).filter_map(|(&k, ways)| ways.get(k));
        let chosen: Vec<&Way<'a>> = chosen.collect();
        let flown: Vec<&Flown> = chosen.iter().map(|way| &way.flown).collect();
        let transitions: Vec<&Transition> = chosen.iter().map(|way| way.transition).collect();
        let mut next = self.start.next_state(&flown)?;
        next.iter_mut().zip(self.disturbance).for_each(|(x, w)| *x += w);
        let tightest = tightest(self.start.together(&transitions, &next, self.memory.events));
        Ok(Combination { picked: picked.to_vec(), next, tightest })
    }

    /// Tries all combinations of transitions that are possible alone. Returns how many are
    /// possible, and the first of these, or the least violating one if there is none. `None` if
    /// there were too many to try.
    fn combine(&self, ways: &mut [Vec<Way<'a>>]) -> Result<(usize, Option<Combination>), Error> {
        let tolerance = self.options.tolerance;
        let alone: Vec<Vec<usize>> = ways
            .iter()
            .map(|ways| (0..ways.len()).filter(|&k| ways[k].holds(tolerance)).collect())
            .collect();
        let (mut moves, mut best): (usize, Option<Combination>) = (0, None);
        let mut digits = vec![0; ways.len()];
        let mut tried = 0;
        while alone.iter().all(|list| !list.is_empty()) {
            if tried == MOST_MOVES {
                return Ok((moves, best.filter(|_| moves > 0)));
            }
            tried += 1;
            let picked: Vec<usize> =
                digits.iter().zip(&alone).filter_map(|(&d, list)| list.get(d)).copied().collect();
            let found = self.evaluate(ways, &picked)?;
            let holds = found.tightest.as_ref().is_none_or(|slack| slack.holds(tolerance));
            for (&k, ways) in picked.iter().zip(ways.iter_mut()) {
                ways[k].is_possible |= holds;
                let joint = found.tightest.clone().into_iter().chain(ways[k].joint.take());
                let best = joint.max_by(|a, b| a.scaled().total_cmp(&b.scaled()));
                ways[k].joint = best;
            }
            let scaled = |c: &Combination| c.tightest.as_ref().map_or(f64::INFINITY, Slack::scaled);
            let is_better = match &best {
                None => true,
                Some(best) => moves == 0 && (holds || scaled(&found) > scaled(best)),
            };
            if is_better {
                best = Some(found);
            }
            moves += usize::from(holds);
            let Some(last) = (0..digits.len()).rfind(|&c| digits[c] + 1 < alone[c].len()) else {
                break;
            };
            digits[last] += 1;
            digits[last + 1..].fill(0);
        }
        Ok((moves, best))
    }

    /// The planned combination, or why it is not possible.
    fn planned(
        &self,
        plan: &[String],
        ways: &[Vec<Way<'a>>],
        candidates: &[Vec<Candidate>],
    ) -> Result<Result<Combination, DeadEnd>, Error> {
        let choices = &self.start.system.choices;
        let mut picked = Vec::new();
        for (c, (choice, name)) in choices.iter().zip(plan).enumerate() {
            let end = |candidate| DeadEnd::Planned {
                step: self.start.step,
                choice: choice.name.clone(),
                transition: name.clone(),
                candidate,
            };
            let Some(k) = choice.transitions.iter().position(|own| own.name == *name) else {
                return Ok(Err(end(None)));
            };
            let holds = ways[c][k].holds(self.options.tolerance)
                && (choices.len() > 1 || ways[c][k].is_possible);
            if !holds {
                return Ok(Err(end(Some(candidates[c][k].clone()))));
            }
            picked.push(k);
        }
        self.evaluate(ways, &picked).map(Ok)
    }
}

impl Way<'_> {
    /// Whether its own conditions hold.
    fn holds(&self, tolerance: f64) -> bool {
        self.own.as_ref().is_none_or(|slack| slack.holds(tolerance))
    }

    fn candidate(&self) -> Candidate {
        let tightest = tightest(self.own.iter().chain(&self.joint).cloned());
        Candidate {
            transition: self.transition.name.clone(),
            is_possible: self.is_possible,
            slack: tightest.as_ref().map_or(f64::INFINITY, |slack| slack.slack),
            tightest: tightest.map(|slack| slack.condition),
        }
    }
}

fn report(picked: &[&Way<'_>], candidates: Vec<Vec<Candidate>>, moves: usize) -> SimulatedStep {
    let outputs = picked.iter().flat_map(|way| {
        let names = way.transition.outputs.iter().map(|output| output.name.clone());
        names.zip(way.flown.outputs.iter().copied())
    });
    SimulatedStep {
        taken: picked.iter().map(|way| way.transition.name.clone()).collect(),
        candidates,
        moves,
        events: picked.iter().filter(|way| way.transition.is_event).count(),
        outputs: outputs.collect(),
    }
}
