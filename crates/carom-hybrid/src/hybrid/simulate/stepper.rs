//! The transitions of one step: which are possible, and which are taken.

use super::condition::{Slack, tightest};
use super::memory;
use super::options::SimulationOptions;
use super::simulation::SimulatedStep;
use super::step::{Flown, StepStart};
use crate::error::{Condition, DeadEnd, Error, TransitionCandidate};
use crate::hybrid::memory::Memory;
use crate::hybrid::step::CartesianProduct;
use crate::hybrid::system::{Choice, Transition};
use crate::tolerance::margin_scale;

/// Up to how many combinations of transitions are counted in a step.
const MOST_TRIED: usize = 65_536;

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
    /// Whether the step begins or is predicted to end on the boundary of one of its guards.
    is_at_boundary: bool,
}

/// The combinations of transitions of a step.
struct PossibleMoves {
    /// How many are possible.
    moves: usize,
    /// The first of these, or the least violating one if there is none; `None` if there were too
    /// many to try.
    best: Option<Combination>,
    /// Another possible one that leads elsewhere.
    rival: Option<Vec<usize>>,
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
    ///
    /// # Arguments
    ///
    /// * `plan`: the transitions that are named, by choice; empty if there are none.
    ///
    /// # Errors
    ///
    /// [`DeadEnd::Ambiguous`], unless the options allow the first possible one.
    pub(super) fn take(&self, plan: &[Option<&str>]) -> Result<Result<Taken, DeadEnd>, Error> {
        let (step, tolerance) = (self.start.step, self.options.tolerance);
        if self.options.keeps_limits
            && let Some(end) = violated(step, self.start.joint_limits(), tolerance)
        {
            return Ok(Err(end));
        }
        let choices = &self.start.system.choices;
        let ways = choices.iter().map(|choice| {
            choice.transitions.iter().map(|transition| self.way(choice, transition)).collect()
        });
        let mut ways: Vec<Vec<Way<'a>>> = ways.collect::<Result<_, Error>>()?;
        let alone: Vec<Vec<usize>> = ways
            .iter()
            .map(|ways| (0..ways.len()).filter(|&k| ways[k].holds(tolerance)).collect())
            .collect();
        let PossibleMoves { moves, mut best, mut rival } = self.combine(&mut ways, &alone)?;
        let candidates: Vec<Vec<TransitionCandidate>> =
            ways.iter().map(|ways| ways.iter().map(Way::candidate).collect()).collect();
        if plan.iter().any(Option::is_some) {
            let named = match self.named(plan, alone, &ways, &candidates) {
                Ok(named) => named,
                Err(end) => return Ok(Err(*end)),
            };
            let planned = self.combine(&mut ways, &named)?;
            if !self.options.prefers || planned.moves > 0 {
                (best, rival) = (planned.best, planned.rival);
            }
        }
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
            return Err(Error::out_of_range(what, f64::INFINITY, ..=MOST_TRIED as f64));
        };
        if let Some(slack) = tightest.filter(|slack| !slack.holds(tolerance)) {
            let (condition, violation) = (slack.condition, -slack.slack);
            return Ok(Err(DeadEnd::Combination { step, condition, violation }));
        }
        if let Some(rival) = rival.filter(|_| !self.options.first_possible) {
            return Err(self.ambiguous(&picked, &rival, &ways).into());
        }
        let taken: Vec<&Way<'a>> =
            picked.iter().zip(&ways).filter_map(|(&k, ways)| ways.get(k)).collect();
        let report = report(&taken, candidates, moves);
        Ok(Ok(Taken { picked, next, report }))
    }

    fn way(&self, choice: &Choice, transition: &'a Transition) -> Result<Way<'a>, Error> {
        let (flown, mut slacks) = self.start.fly(choice, transition)?;
        slacks.extend(memory::conditions(self.memory, self.start.system, choice, transition));
        let is_guard = |slack: &Slack| {
            matches!(slack.condition, Condition::Guard { .. } | Condition::PredictionGuard { .. })
        };
        let mut guards = slacks.iter().filter(|slack| is_guard(slack));
        let is_at_boundary = guards.any(|slack| slack.scaled().abs() <= self.options.tolerance);
        let own = tightest(slacks);
        Ok(Way { transition, flown, own, joint: None, is_possible: false, is_at_boundary })
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
        let mut slacks = self.start.together(&transitions, &next, self.memory.events);
        if !self.options.keeps_limits {
            slacks.retain(|slack| slack.condition == Condition::MostEvents);
        }
        let tightest = tightest(slacks);
        Ok(Combination { picked: picked.to_vec(), next, tightest })
    }

    /// Tries all combinations of some transitions, given by choice.
    fn combine(
        &self,
        ways: &mut [Vec<Way<'a>>],
        alone: &[Vec<usize>],
    ) -> Result<PossibleMoves, Error> {
        let tolerance = self.options.tolerance;
        let mut all = PossibleMoves { moves: 0, best: None, rival: None };
        let lists = alone.iter().map(Vec::len);
        for (tried, digits) in CartesianProduct::new(lists).enumerate() {
            if tried == MOST_TRIED {
                all.best = all.best.filter(|_| all.moves > 0);
                return Ok(all);
            }
            let picked: Vec<usize> = digits.iter().zip(alone).map(|(&d, list)| list[d]).collect();
            let found = self.evaluate(ways, &picked)?;
            let holds = found.tightest.as_ref().is_none_or(|slack| slack.holds(tolerance));
            for (&k, ways) in picked.iter().zip(ways.iter_mut()) {
                ways[k].is_possible |= holds;
                let joint = found.tightest.clone().into_iter().chain(ways[k].joint.take());
                let best = joint.max_by(|a, b| a.scaled().total_cmp(&b.scaled()));
                ways[k].joint = best;
            }
            let scaled = |c: &Combination| c.tightest.as_ref().map_or(f64::INFINITY, Slack::scaled);
            let is_better = match &all.best {
                None => true,
                Some(best) => all.moves == 0 && (holds || scaled(&found) > scaled(best)),
            };
            if is_better {
                all.best = Some(found);
            } else if holds
                && all.rival.is_none()
                && let Some(best) = &all.best
                && self.leads_elsewhere(ways, best, &found)
            {
                all.rival = Some(found.picked);
            }
            all.moves += usize::from(holds);
        }
        Ok(all)
    }

    /// Whether two combinations lead to different states or modes, and not only because they meet
    /// at a boundary of their guards.
    fn leads_elsewhere(
        &self,
        ways: &[Vec<Way<'a>>],
        first: &Combination,
        second: &Combination,
    ) -> bool {
        let pairs = ways.iter().zip(first.picked.iter().zip(&second.picked));
        let pairs = pairs.filter_map(|(ways, (&a, &b))| Some((ways.get(a)?, ways.get(b)?)));
        let differing: Vec<_> =
            pairs.filter(|(a, b)| a.transition.name != b.transition.name).collect();
        if differing.iter().all(|(a, b)| a.is_at_boundary && b.is_at_boundary) {
            return false;
        }
        let entered = |way: &Way<'a>| way.transition.modes.as_ref().map(|(_, to)| to);
        let counts_events = self.start.system.most_events.is_some();
        let other_memory = differing.iter().any(|(a, b)| {
            let (a_events, b_events) = (a.transition.is_event, b.transition.is_event);
            entered(a) != entered(b) || counts_events && a_events != b_events
        });
        let mut states = first.next.iter().zip(&second.next);
        let tolerance = self.options.tolerance;
        let differ = |(a, b): (&f64, &f64)| (a - b).abs() > tolerance * margin_scale(a.abs(), *b);
        other_memory || states.any(differ)
    }

    /// The first choice of which two combinations take different transitions.
    fn ambiguous(&self, first: &[usize], second: &[usize], ways: &[Vec<Way<'a>>]) -> DeadEnd {
        let c = first.iter().zip(second).position(|(a, b)| a != b).unwrap_or(0);
        let possible = ways[c].iter().filter(|way| way.is_possible);
        DeadEnd::Ambiguous {
            step: self.start.step,
            choice: self.start.system.choices[c].name.clone(),
            transitions: possible.map(|way| way.transition.name.clone()).collect(),
        }
    }

    /// The transitions that are possible alone, by choice, where a plan names one only this one; or
    /// why it is not possible.
    fn named(
        &self,
        plan: &[Option<&str>],
        mut alone: Vec<Vec<usize>>,
        ways: &[Vec<Way<'a>>],
        candidates: &[Vec<TransitionCandidate>],
    ) -> Result<Vec<Vec<usize>>, Box<DeadEnd>> {
        let choices = &self.start.system.choices;
        for (c, (choice, name)) in choices.iter().zip(plan).enumerate() {
            let Some(name) = name else { continue };
            let end = |candidate| {
                Box::new(DeadEnd::Planned {
                    step: self.start.step,
                    choice: choice.name.clone(),
                    transition: (*name).to_owned(),
                    candidate,
                })
            };
            let k = choice.transitions.iter().position(|own| own.name == *name);
            let Some(k) = k else { return Err(end(None)) };
            let holds = ways[c][k].holds(self.options.tolerance)
                && (choices.len() > 1 || ways[c][k].is_possible);
            match (holds, self.options.prefers) {
                (true, _) => alone[c] = vec![k],
                (false, true) => {}
                (false, false) => return Err(end(Some(candidates[c][k].clone()))),
            }
        }
        Ok(alone)
    }
}

impl Way<'_> {
    /// Whether its own conditions hold.
    fn holds(&self, tolerance: f64) -> bool {
        self.own.as_ref().is_none_or(|slack| slack.holds(tolerance))
    }

    fn candidate(&self) -> TransitionCandidate {
        let tightest = tightest(self.own.iter().chain(&self.joint).cloned());
        let slack = tightest.as_ref().map_or(f64::INFINITY, |slack| slack.slack);
        let condition = tightest.map(|slack| slack.condition);
        TransitionCandidate::new(self.transition.name.clone(), self.is_possible, condition, slack)
    }
}

fn report(
    picked: &[&Way<'_>],
    candidates: Vec<Vec<TransitionCandidate>>,
    moves: usize,
) -> SimulatedStep {
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
