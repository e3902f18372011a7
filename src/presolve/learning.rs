//! A propagator that learns from its conflicts: each is explained, kept as a no-good, and the
//! no-goods take part in every later propagation.

use super::conflict_analysis::{Analysis, Clash, Explanation, Resolution, Sources};
use super::domain::{Domain, Reason};
use super::no_goods::{ConflictCounts, NoGood, NoGoods};
use super::propagation::{Conflict, Propagator};
use crate::program::Program;

/// Most literals of a no-good: longer ones hardly ever come to say anything.
const LONGEST: usize = 30;

/// The credit at first and at most, in conflicts that are analysed. So many literals of a no-good
/// cost as much as the analysis; what a bound moved by a no-good is worth, and a contradiction.
const CREDIT: i64 = 500;
const LITERALS: usize = 8;
const FIXED: u64 = 1;
const REFUTED: u64 = 10;

/// Without credit, one conflict in so many is analysed, to notice when learning begins to pay.
const SELDOM: u64 = 50;

/// How much is analysed: as much as it has paid.
#[derive(Debug, Clone)]
struct Account {
    credit: i64,
    conflicts: u64,
    /// What no-goods had brought when it was last booked.
    booked: u64,
}

impl Account {
    fn new() -> Self {
        Account { credit: CREDIT, conflicts: 0, booked: 0 }
    }

    /// Whether the next conflict is analysed, after no-goods have moved and refuted so much.
    fn pays(&mut self, brought: u64) -> bool {
        self.conflicts += 1;
        let gain = i64::try_from(brought - self.booked).unwrap_or(CREDIT);
        self.booked = brought;
        self.credit = self.credit.saturating_add(gain).min(CREDIT);
        let pays = self.credit > 0 || self.conflicts.is_multiple_of(SELDOM);
        self.credit -= i64::from(pays);
        pays
    }

    /// Books a no-good of so many literals.
    fn book(&mut self, literals: usize) {
        self.credit -= (literals / LITERALS) as i64;
    }
}

/// What learns.
#[derive(Debug, Clone)]
pub(super) struct Learner {
    analysis: Analysis,
    no_goods: NoGoods,
    account: Account,
    /// What no-goods have brought, in the unit of the account.
    brought: u64,
    /// What the last propagation taught.
    last: Option<u32>,
}

impl Learner {
    fn take_counts(&mut self) -> ConflictCounts {
        let counts = self.no_goods.take_counts();
        self.brought += FIXED * counts.fixed + REFUTED * counts.refuted;
        counts
    }

    /// Whether the next conflict is worth its analysis.
    fn pays(&mut self) -> bool {
        let counts = self.no_goods.counts();
        let brought = self.brought + FIXED * counts.fixed + REFUTED * counts.refuted;
        self.account.pays(brought) && !self.no_goods.is_full()
    }
}

impl Propagator {
    /// Learns from every conflict from here on. What `domain` holds now is taken to hold
    /// everywhere: every later change must be undone before the program is another one. A bound that
    /// is applied without a reason counts as a decision, whatever led to it.
    pub fn learn_conflicts(&mut self, domain: &Domain) {
        self.learner = Some(Box::new(Learner {
            analysis: Analysis::new(domain),
            no_goods: NoGoods::new(domain.column_count()),
            account: Account::new(),
            brought: 0,
            last: None,
        }));
    }

    /// The no-goods that are known.
    pub fn no_goods(&self) -> impl Iterator<Item = &NoGood> {
        self.learner.iter().flat_map(|learner| learner.no_goods.iter())
    }

    /// Whether [`tidy_no_goods`](Self::tidy_no_goods) has something to do.
    pub fn has_untidy_no_goods(&self) -> bool {
        self.learner.as_ref().is_some_and(|l| l.no_goods.is_untidy(l.account.credit <= 0))
    }

    /// Drops little used no-goods where there are many, or where they have not paid. Only for domains
    /// in which nothing has changed since learning began.
    pub fn tidy_no_goods(&mut self) {
        if let Some(learner) = &mut self.learner {
            learner.no_goods.tidy(learner.account.credit <= 0);
        }
    }

    /// What became of conflicts since this was last asked for.
    pub fn take_conflict_counts(&mut self) -> ConflictCounts {
        self.learner.as_mut().map_or_else(ConflictCounts::default, |l| l.take_counts())
    }

    /// Explains how a propagation failed, and keeps that.
    pub(super) fn learn(
        &mut self,
        program: &Program,
        domain: &Domain,
        mark: usize,
        clash: Option<Clash>,
        cut: Resolution,
    ) {
        let Some(mut learner) = self.learner.take() else { return };
        let wanted = clash.filter(|_| learner.pays());
        learner.last = wanted.and_then(|clash| {
            let sources = Sources {
                integral: &program.integral,
                rows: &self.rows,
                entries: &self.entries,
                implications: &self.implications,
                no_goods: &learner.no_goods,
                cutoff: self.cutoff,
            };
            let explained = learner.analysis.explain(&sources, domain, mark, clash, cut);
            let Explanation { literals, cutoff } = explained?;
            let length = 1..=LONGEST;
            length.contains(&literals.len()).then(|| {
                learner.account.book(literals.len());
                learner.no_goods.add(literals, cutoff)
            })
        });
        self.learner = Some(learner);
    }

    /// Why a literal was denied whose trial has just failed.
    pub(super) fn reason_against(&self, column: usize, is_upper: bool) -> Reason {
        let known = self.learner.as_ref().and_then(|learner| {
            let number = learner.last?;
            let mut literals = learner.no_goods.get(number)?.literals.iter();
            let tried = literals.any(|l| (l.column, l.is_upper) == (column, is_upper));
            tried.then_some(Reason::NoGood(number))
        });
        known.unwrap_or(Reason::Path)
    }

    /// Denies what no-goods of one literal exclude.
    pub(super) fn deny_single(&mut self, domain: &mut Domain) -> Result<(), Conflict> {
        let Some(learner) = &mut self.learner else { return Ok(()) };
        let denied = learner.no_goods.deny_single(domain, self.cutoff);
        denied.map_err(|number| self.contradiction(number))
    }

    /// Propagates no-goods over the changes from position `next` of the trail on.
    pub(super) fn follow_no_goods(
        &mut self,
        program: &Program,
        domain: &mut Domain,
        next: &mut usize,
    ) -> Result<(), Conflict> {
        while *next < domain.mark() {
            let Some(learner) = self.learner.as_mut().filter(|l| !l.no_goods.is_empty()) else {
                *next = domain.mark();
                break;
            };
            let change = domain.change(*next);
            *next += 1;
            let (column, is_upper) = (change.column(), change.is_upper());
            if !program.integral[column] {
                continue;
            }
            let mark = domain.mark();
            let followed = learner.no_goods.follow(domain, column, is_upper, self.cutoff);
            followed.map_err(|number| self.contradiction(number))?;
            for position in mark..domain.mark() {
                let change = domain.change(position);
                self.enqueue_uses(change.column(), change.is_upper(), usize::MAX);
                self.imply(program, domain, change.column())?;
            }
        }
        Ok(())
    }

    fn contradiction(&mut self, number: u32) -> Conflict {
        self.clash = Some(Clash::NoGood(number));
        let no_good = self.learner.as_ref().and_then(|l| l.no_goods.get(number));
        let literal = no_good.and_then(|no_good| no_good.literals.first());
        Conflict::Column(literal.map_or(0, |literal| literal.column))
    }
}
