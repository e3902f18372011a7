//! Points from a guess that was handed over: fixed, completed, repaired where it contradicts the
//! program.

use super::node_relaxation::Verdict;
use super::trace::span;
use super::worker::Worker;
use crate::solution::Heuristic;

/// What became of a guess, in columns and values of the program.
#[derive(Debug, Clone, PartialEq)]
pub enum GuessEnd {
    /// A verified point, with all guessed values or most of them.
    Point(Vec<f64>),
    /// Already propagation contradicts the value of this column, and no repair was found.
    Contradiction(usize),
    /// No point with these values was found.
    Nothing,
    /// A limit came first.
    Stopped,
}

/// Most relaxations of a completion.
const DIVE: usize = 20;

/// The shares of a guess, from its beginning, that are tried.
const SHARES: [f64; 3] = [1.0, 0.5, 0.25];

impl Worker<'_> {
    /// Tries the guess at the root. The domain is left as it was.
    pub(super) fn try_guess(&mut self) {
        let Some(seed) = self.tree.seed().filter(|seed| !seed.guess.is_empty()) else { return };
        span!(DEBUG, "heuristic", name = "guess");
        let before = self.tree.begin(Heuristic::Guess);
        let mut contradiction = None;
        let mut found = None;
        for share in SHARES {
            let kept = (share * seed.guess.len() as f64).ceil() as usize;
            let mark = self.domain.mark();
            for &(j, value) in &seed.guess[..kept] {
                if !self.fix_guessed(j, value) {
                    contradiction.get_or_insert(j);
                }
            }
            self.tree.take_last_found();
            self.complete();
            self.domain.undo_to(mark);
            found = self.tree.take_last_found();
            if found.is_some() || self.token.is_over() {
                break;
            }
        }
        self.tree.end(before);
        self.tree.report_guess(match (found, contradiction) {
            (Some(point), _) => GuessEnd::Point(point),
            _ if self.token.is_over() => GuessEnd::Stopped,
            (None, Some(column)) => GuessEnd::Contradiction(column),
            (None, None) => GuessEnd::Nothing,
        });
    }

    /// Fixes one guessed value; `false`, and nothing changed, where that is a contradiction.
    pub(super) fn fix_guessed(&mut self, j: usize, value: f64) -> bool {
        let (value, [lower, upper]) = (value.round(), self.domain.bounds(j));
        if !(lower <= value && value <= upper) {
            return false;
        }
        let mark = self.domain.mark();
        self.domain.apply(j, false, value);
        self.domain.apply(j, true, value);
        let holds = self.propagate_since(mark).is_ok();
        if !holds {
            self.domain.undo_to(mark);
        }
        holds
    }

    /// Looks for a point of the present domain: rounds its relaxed point, and dives where that
    /// leads nowhere.
    fn complete(&mut self) {
        for _ in 0..DIVE {
            if self.is_leaf() {
                self.solve_assignment(self.domain.mark());
                return;
            }
            let Some(projection) = self.project_node() else { return };
            let Verdict::Relaxed { x, .. } = self.relax(&projection.reduced, false) else { return };
            let point = self.complete_point(projection.lift(&x));
            self.round_and_propagate(&point);
            if self.tree.has_last_found() {
                return;
            }
            let distance = |j: usize| (point[j] - point[j].round()).abs();
            let open = |&&j: &&usize| !self.domain.is_fixed(j);
            let mut order: Vec<usize> = self.own_integers().iter().filter(open).copied().collect();
            order.sort_by(|&a, &b| distance(a).total_cmp(&distance(b)).then(a.cmp(&b)));
            let sure = order.iter().take_while(|&&j| distance(j) <= 1e-3).count();
            for &j in order.iter().take(sure.max(1)) {
                if !self.fix_rounded(j, point[j]) {
                    return;
                }
            }
        }
    }
}
