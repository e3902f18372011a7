//! Cuts and search after presolve.

use super::first_point::FirstPoint;
use super::looks::Looks;
use super::refusals::Refusals;
use super::row_judge::RowJudge;
use crate::model::Model;
use crate::presolve::{tighten_big_ms, tighten_by_disjunctions};
use crate::program::Program;
use crate::relaxation::LadderPool;
use crate::search::cuts::strengthen;
use crate::search::{
    Accept, ColumnGuidance, Found, Root, Seed, Strengthened, Task, complete, search,
    search_unstrengthened, with_perspective,
};
use crate::solution::{Point, Verification};
use crate::solver::{Control, Options, StopToken};

/// A presolved program, and the way back to the model.
#[derive(Clone, Copy)]
pub(super) struct Stage<'a> {
    pub(super) model: &'a Model,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    pub(super) guidance: &'a ColumnGuidance<'a>,
    pub(super) ladders: &'a LadderPool,
    pub(super) refusals: &'a Refusals,
    pub(super) judge: Option<&'a RowJudge<'a>>,
    pub(super) program: &'a Program,
    /// From values of the program's columns to values of the model's variables.
    pub(super) restore: &'a (dyn Fn(&[f64]) -> Vec<f64> + Sync),
    /// Whether the columns must stay as they are.
    pub(super) as_is: bool,
    /// The program tightened beforehand for all values of the parameters, if it was.
    pub(super) tightened: Option<&'a Tightened>,
    /// Whether cuts and tighter costs are tried.
    pub(super) strengthens: bool,
}

/// A program with tighter big-Ms, and its root.
#[derive(Debug)]
pub(super) struct Tightened {
    pub(super) program: Program,
    root: Root,
}

impl Tightened {
    /// Tightens a program. What is concluded holds for all bounds within its own.
    pub(super) fn new(program: &Program, options: &Options, token: &StopToken) -> Self {
        let mut tight = None;
        if options.disjunctive_tightening {
            tight = tighten_by_disjunctions(program, token);
        }
        if options.big_m_tightening {
            tight = tighten_big_ms(tight.as_ref().unwrap_or(program), token).or(tight);
        }
        let program = tight.unwrap_or_else(|| program.clone());
        let root = Root::new(&program, token, options.probing);
        Tightened { program, root }
    }
}

/// A program to search, and the check of its points.
#[derive(Clone, Copy)]
pub(super) struct Search<'a> {
    pub(super) program: &'a Program,
    pub(super) accept: &'a Accept<'a>,
    /// The user's point that a point stands for; `None` if there is none.
    pub(super) describe: &'a (dyn Fn(&[f64]) -> Option<Point> + Sync),
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
}

impl Stage<'_> {
    /// The result of searching the program, block by block if it has several.
    pub(super) fn run(&self, control: &mut Control<'_>, seed: Option<&Seed>) -> Found {
        if seed.is_none()
            && self.guidance.is_idle()
            && let Some(found) = self.run_blocks(control)
        {
            return found;
        }
        let accept = |values: &[f64]| self.verified(values).is_some();
        let describe = |values: &[f64]| self.point(values);
        let search = Search {
            program: self.program,
            accept: &accept,
            describe: &describe,
            options: self.options,
            token: self.token,
        };
        self.search(search, control, seed)
    }

    /// Completes the guess of a seed, without a search.
    pub(super) fn complete(&self, seed: &Seed) -> Found {
        let task = Task {
            program: self.program,
            exact: None,
            root: None,
            accept: &|values: &[f64]| self.verified(values).is_some(),
            key: &|_: &[f64]| Vec::new(),
            describe: &|values: &[f64]| self.point(values),
            guidance: self.guidance,
            ladders: self.ladders,
            options: self.options,
            cutoff: f64::INFINITY,
            token: self.token,
        };
        complete(task, seed)
    }

    /// The model's point behind values of all columns.
    pub(super) fn point(&self, values: &[f64]) -> Option<Point> {
        Point::new(self.model, (self.restore)(values)).ok()
    }

    /// The same, where the model's own verification accepts it.
    pub(super) fn verified(&self, values: &[f64]) -> Option<Point> {
        let model = self.judge.map_or(self.model, RowJudge::model);
        let holds = |point: &Point| {
            let check = Verification::of(model, point, self.options.feasibility);
            let holds = check.holds();
            if !holds {
                self.refusals.note(check);
            }
            holds
        };
        self.point(values).filter(holds)
    }

    /// Cuts and searches a program: this one, or a part of it.
    pub(super) fn search(
        &self,
        search: Search<'_>,
        control: &mut Control<'_>,
        seed: Option<&Seed>,
    ) -> Found {
        let mut begun = self.first_point(&search, seed);
        if FirstPoint::suffices(&search)
            && let Some(point) = begun.take()
        {
            return point.answer(&search, control);
        }
        let mut found = if self.alternates(&search) {
            self.search_in_turns(search, control, seed)
        } else {
            self.search_once(search, control, seed)
        };
        if let Some(begun) = begun {
            begun.serve(&search, &mut found, control);
        }
        found
    }

    /// Cuts a program and searches it once.
    pub(super) fn search_once(
        &self,
        Search { program, accept, describe, options, token }: Search<'_>,
        control: &mut Control<'_>,
        seed: Option<&Seed>,
    ) -> Found {
        let integral: Vec<bool> = self.model.variables().map(|v| v.kind().is_integral()).collect();
        // Asked for only where a pool is kept, and there all columns are searched together.
        let key = |values: &[f64]| {
            let values = (self.restore)(values);
            let integers = values.iter().zip(&integral).filter(|(_, integral)| **integral);
            integers.map(|(value, _)| value.round() as i64).collect()
        };
        let mut ladder = self.ladders.take();
        let exact = program;
        let mut own = None;
        let (program, mut root) = match self.tightened {
            Some(tightened) => {
                let program = &tightened.program;
                (program, tightened.root.within(program, token, options.probing))
            }
            None if self.as_is => (program, Root::new(program, token, options.probing)),
            None => {
                let tightened = Tightened::new(program, options, token);
                (&*own.insert(tightened.program), tightened.root)
            }
        };
        let strengthens = options.cuts && !self.as_is && self.strengthens;
        let bent = if strengthens {
            with_perspective(program, &mut root, options, token, &mut ladder)
        } else {
            None
        };
        let program = bent.as_ref().map_or(program, |bent| &bent.program);
        let guidance = self.guidance;
        let (exact, cutoff) = (Some(exact), f64::INFINITY);
        let key = &key;
        let task = Task {
            program,
            exact,
            root: None,
            accept,
            key,
            describe,
            guidance,
            ladders: self.ladders,
            options,
            cutoff,
            token,
        };
        let looks = Looks::new(task, seed);
        let cut = if strengthens {
            let look = |root: &Root, nodes| looks.look(root, nodes);
            strengthen(program, &mut root, options, token, &mut ladder, &look)
        } else {
            None
        };
        let program = cut.as_ref().map_or(program, |cut| &cut.program);
        if bent.is_some() || cut.is_some() {
            root.carry_over(program, token);
        }
        let spent = ladder.take_spent();
        self.ladders.give_back(ladder);
        let task = Task { program, root: Some(&root), ..task };
        let own = looks.seed(cut.is_none());
        let mut found = search(task, control, own.as_ref().or(seed));
        if let Some(what) = found.contradiction {
            debug_assert!(false, "a strengthened program is wrong: {what:?}");
            found = search_unstrengthened(task, found, control);
        }
        spent.count(&mut found.statistics);
        looks.add_to(&mut found);
        // Columns of event windows come after the program's.
        let value = |x: &Vec<f64>| program.objective(&x[..program.column_count()]);
        let best = found.points.first().map_or(f64::INFINITY, value);
        let strengthens = strengthens && found.statistics.contradictions == 0;
        found.strengthened = strengthens.then(|| closed([&bent, &cut], best));
        found
    }
}

/// The part of the gap between the first relaxed root and a value that steps have closed.
fn closed(steps: [&Option<Strengthened>; 2], best: f64) -> f64 {
    let steps = || steps.into_iter().flatten();
    let (Some(first), Some(last)) = (steps().next(), steps().last()) else { return 0.0 };
    (last.values[1] - first.values[0]) / (best - first.values[0])
}
