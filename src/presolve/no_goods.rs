//! No-goods: bounds of integral columns that cannot hold together, and their propagation.
//!
//! Each no-good watches two of its literals. If a watched literal becomes true, another literal
//! that is not true is watched instead. If there is none, the other watched literal is denied, or
//! the no-good is a contradiction. Undoing bounds costs nothing.

use super::domain::{Domain, Reason};

/// Most no-goods that are kept at a time; from half of it on, the least active half goes when the
/// search is back at its root.
const MOST: usize = 2000;

/// By what the weight of a use grows from one to the next, so that recent ones count more.
const GROWTH: f64 = 1.01;

/// A bound of an integral column, as a statement that may hold or not.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Literal {
    /// The column.
    pub column: usize,
    /// Whether the statement is `x <= value` rather than `x >= value`.
    pub is_upper: bool,
    /// A whole number.
    pub value: f64,
}

impl Literal {
    /// Whether it holds for all values between two bounds.
    pub fn holds(&self, [lower, upper]: [f64; 2]) -> bool {
        if self.is_upper { upper <= self.value } else { lower >= self.value }
    }

    /// Whether it holds for no value between two bounds.
    pub fn fails(&self, [lower, upper]: [f64; 2]) -> bool {
        if self.is_upper { lower > self.value } else { upper < self.value }
    }

    /// The literal that holds exactly where this one does not.
    pub fn denial(&self) -> Literal {
        let value = if self.is_upper { self.value + 1.0 } else { self.value - 1.0 };
        Literal { column: self.column, is_upper: !self.is_upper, value }
    }

    fn bound(&self) -> usize {
        2 * self.column + usize::from(self.is_upper)
    }
}

/// Literals that cannot all hold.
#[derive(Debug, Clone, PartialEq)]
pub struct NoGood {
    /// At most one for each bound of a column; the first two are watched.
    pub literals: Vec<Literal>,
    /// It excludes only points whose (minimised) objective is at most this; infinite where it
    /// holds for all points.
    pub cutoff: f64,
    activity: f64,
    used: bool,
}

/// What became of conflicts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ConflictCounts {
    /// No-goods learned.
    pub learned: u64,
    /// Bounds moved by no-goods.
    pub fixed: u64,
    /// Contradictions found by no-goods.
    pub refuted: u64,
}

#[derive(Debug, Clone, Copy)]
struct Watch {
    no_good: u32,
    /// The value of the literal on this bound.
    value: f64,
}

/// The no-goods of a search.
#[derive(Debug, Clone)]
pub struct NoGoods {
    list: Vec<NoGood>,
    /// By bound, twice the column plus one for an upper one: who watches it.
    watches: Vec<Vec<Watch>>,
    /// Those of one literal, which nothing has to come to hold for.
    single: Vec<u32>,
    /// The weight of the next use.
    weight: f64,
    counts: ConflictCounts,
}

impl NoGoods {
    /// None yet, for so many columns.
    pub fn new(columns: usize) -> Self {
        NoGoods {
            list: Vec::new(),
            watches: vec![Vec::new(); 2 * columns],
            single: Vec::new(),
            weight: 1.0,
            counts: ConflictCounts::default(),
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Whether there is no place for another one.
    pub fn is_full(&self) -> bool {
        self.list.len() >= MOST
    }

    /// All of them.
    pub fn iter(&self) -> impl Iterator<Item = &NoGood> {
        self.list.iter()
    }

    pub(super) fn get(&self, number: u32) -> Option<&NoGood> {
        self.list.get(number as usize)
    }

    /// What they brought so far.
    pub fn counts(&self) -> ConflictCounts {
        self.counts
    }

    /// What they brought since this was last asked.
    pub(super) fn take_counts(&mut self) -> ConflictCounts {
        std::mem::take(&mut self.counts)
    }

    /// Takes in a no-good, whose literals come in the order in which undoing would loosen them;
    /// its number.
    pub fn add(&mut self, literals: Vec<Literal>, cutoff: f64) -> u32 {
        self.counts.learned += 1;
        let activity = self.weight;
        self.list.push(NoGood { literals, cutoff, activity, used: false });
        let number = self.list.len() - 1;
        self.watch(number);
        number as u32
    }

    fn watch(&mut self, number: usize) {
        let no_good = number as u32;
        match self.list[number].literals[..] {
            [] => {}
            [_] => self.single.push(no_good),
            [a, b, ..] => {
                for literal in [a, b] {
                    let watch = Watch { no_good, value: literal.value };
                    self.watches[literal.bound()].push(watch);
                }
            }
        }
    }

    /// Whether [`tidy`](Self::tidy) would drop some.
    pub(super) fn is_untidy(&self, only_used: bool) -> bool {
        self.are_many() || (only_used && self.list.iter().any(|n| !n.used))
    }

    fn are_many(&self) -> bool {
        self.list.len() > MOST / 2
    }

    /// Drops those that are little used where there are many, and those that were never used where
    /// only used ones are wanted. Nothing on the trail may name a no-good when this is called.
    pub fn tidy(&mut self, only_used: bool) {
        if !self.is_untidy(only_used) {
            return;
        }
        let many = self.are_many();
        if only_used {
            self.list.retain(|no_good| no_good.used);
        }
        if many {
            let mut activities: Vec<f64> = self.list.iter().map(|n| n.activity).collect();
            activities.sort_by(f64::total_cmp);
            let middle = activities.get(activities.len() / 2);
            let least = middle.copied().unwrap_or(f64::INFINITY);
            self.list.retain(|no_good| no_good.activity > least);
        }
        self.watches.iter_mut().for_each(Vec::clear);
        self.single.clear();
        (0..self.list.len()).for_each(|number| self.watch(number));
    }

    fn reward(&mut self, number: usize) {
        self.list[number].used = true;
        self.list[number].activity += self.weight;
        self.weight *= GROWTH;
        if self.weight > 1e100 {
            self.list.iter_mut().for_each(|no_good| no_good.activity *= 1e-100);
            self.weight *= 1e-100;
        }
    }

    /// Denies the literals that no-goods of one literal exclude.
    ///
    /// # Errors
    ///
    /// The number of a no-good that the bounds contradict.
    pub fn deny_single(&mut self, domain: &mut Domain, cutoff: f64) -> Result<(), u32> {
        for k in 0..self.single.len() {
            let number = self.single[k];
            let no_good = &self.list[number as usize];
            if cutoff <= no_good.cutoff {
                self.deny(domain, number, no_good.literals[0])?;
            }
        }
        Ok(())
    }

    /// Follows one bound that has changed.
    ///
    /// # Errors
    ///
    /// The number of a no-good that the bounds contradict.
    pub fn follow(
        &mut self,
        domain: &mut Domain,
        column: usize,
        is_upper: bool,
        cutoff: f64,
    ) -> Result<(), u32> {
        let bound = 2 * column + usize::from(is_upper);
        if self.watches[bound].is_empty() {
            return Ok(());
        }
        let mut watches = std::mem::take(&mut self.watches[bound]);
        let mut result = Ok(());
        watches.retain(|watch| {
            let literal = Literal { column, is_upper, value: watch.value };
            if result.is_err() || !literal.holds(domain.bounds(column)) {
                return true;
            }
            let no_good = &mut self.list[watch.no_good as usize];
            if no_good.literals[0].bound() == bound {
                no_good.literals.swap(0, 1);
            }
            // The literal that has come to hold is now the second one.
            let other = no_good.literals[0];
            if other.fails(domain.bounds(other.column)) {
                return true;
            }
            let open = |l: &Literal| !l.holds(domain.bounds(l.column));
            if let Some(k) = no_good.literals[2..].iter().position(open) {
                no_good.literals.swap(1, k + 2);
                let next = no_good.literals[1];
                let watch = Watch { value: next.value, ..*watch };
                self.watches[next.bound()].push(watch);
                return false;
            }
            if cutoff <= no_good.cutoff {
                result = self.deny(domain, watch.no_good, other);
            }
            true
        });
        // Literals of a no-good are on different bounds, so nobody has come to watch this one.
        self.watches[bound] = watches;
        result
    }

    /// Denies the last literal of a no-good that may not hold.
    fn deny(&mut self, domain: &mut Domain, number: u32, last: Literal) -> Result<(), u32> {
        let bounds = domain.bounds(last.column);
        if last.fails(bounds) {
            return Ok(());
        }
        self.reward(number as usize);
        if last.holds(bounds) {
            self.counts.refuted += 1;
            return Err(number);
        }
        self.counts.fixed += 1;
        let denial = last.denial();
        let reason = Reason::NoGood(number);
        domain.apply_because(denial.column, denial.is_upper, denial.value, reason);
        Ok(())
    }
}
