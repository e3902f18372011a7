//! Values that a node's relaxed point can do without, on trial.
//!
//! A binary that may be 0 or 1 at the same point of the dynamics is nothing to branch on, but one of its
//! values may cost more than the best point is worth: then the other one is a fact. On walls an impact
//! at most steps is excluded that way, and propagation follows. Elsewhere such trials find nothing, so
//! they are paid from a credit that every exclusion raises.

use super::branching::Split;
use super::worker::Worker;

/// Most trials at a node that find nothing.
const PATIENCE: usize = 8;

/// The credit at first and at most, in trials.
const START: f64 = 1.0;
const MOST: f64 = 16.0;

/// What an exclusion is worth, in trials, and what a node without credit gains.
const EXCLUDED: f64 = 2.0;
const DRIP: f64 = 0.05;

/// The account of one worker.
#[derive(Debug)]
pub(super) struct Exclusion {
    credit: f64,
}

impl Exclusion {
    pub(super) fn new() -> Self {
        Exclusion { credit: START }
    }

    /// Whether there is credit for a trial.
    fn may_try(&mut self) -> bool {
        if self.credit < 1.0 {
            self.credit += DRIP;
            return false;
        }
        true
    }

    fn book(&mut self, excluded: bool) {
        let gain = if excluded { EXCLUDED } else { -1.0 };
        self.credit = (self.credit + gain).min(MOST);
    }
}

impl Worker<'_> {
    /// Tries the other value of binaries that are whole at the point `x` and were not at the relaxed
    /// point `raw`, those with most choice first; whether any was excluded.
    pub(super) fn exclude_values(
        &mut self,
        x: &[f64],
        raw: &[f64],
        bound: f64,
    ) -> Result<bool, Split> {
        let integrality = self.task.options.integrality;
        let away = |value: f64| (value - value.round()).abs();
        let settled = |j: &usize| away(raw[*j]) > integrality && away(x[*j]) <= integrality;
        let mut settled: Vec<usize> = self.lone.iter().copied().filter(settled).collect();
        settled.sort_by(|&a, &b| away(raw[b]).total_cmp(&away(raw[a])).then(a.cmp(&b)));
        let (mut idle, mut any) = (0, false);
        for j in settled {
            if idle == PATIENCE || !self.accounts.exclusion.may_try() {
                break;
            }
            if self.domain.is_fixed(j) {
                continue;
            }
            let [near, far] = self.split(j, x[j]);
            let excluded = self.try_child(far, x[j], bound).is_none();
            self.accounts.exclusion.book(excluded);
            if excluded {
                self.keep_only(near, bound)?;
                (idle, any) = (0, true);
            } else {
                idle += 1;
            }
        }
        Ok(any)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn trials_end_where_they_find_nothing_and_come_back() {
        let trials = |account: &mut Exclusion, excluded: bool| {
            let open = |_: &usize| {
                let may = account.may_try();
                if may {
                    account.book(excluded);
                }
                may
            };
            (0..100).filter(open).count()
        };
        let mut account = Exclusion::new();
        assert!(trials(&mut account, false) < 15);
        assert!(trials(&mut account, true) > 80);
        assert_eq!(account.credit, MOST);
    }
}
