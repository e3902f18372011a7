//! The tree of a proof: the splits of the search again, each end closed by facts.

use std::rc::Rc;

use super::bounds::{Bounds, Clash, Side};
use super::facts::Facts;
use super::guide::Guide;
use super::guided_splits::SideRelation;
use super::log::ProofLog;
use super::relaxed::{FactRefutation, Relaxed, Relaxer};
use super::split_places::{is_counted, place_of};
use super::tightened::{TightRowLemma, TightStep};
use crate::search::{Decision, SavedSplit, opposite};

/// The distance from a whole number from which a column can be split there (no unit).
pub(super) const FRACTIONAL: f64 = 1e-7;

/// Columns in a row that are probed in vain.
const MOST_FAILURES: usize = 100;

/// Own splits below each other after which a search is asked again.
const SPLITS_BETWEEN_SEARCHES: u32 = 6;

/// The bytes from which on a trial has failed: a long proof gains by lemmas.
const LARGEST_TRIAL: usize = 1 << 22;

/// Most nodes of a search for splits.
const MOST_NODES: u64 = 2000;

/// Own splits below each other before the first search.
const SPLITS_BEFORE_A_SEARCH: u32 = 3;

/// Where a part of the tree goes on.
#[derive(Debug, Clone)]
pub(super) enum ProofPart {
    /// At a node of a search.
    Node(Rc<Guide>, u32),
    /// At a place of its splits.
    Splits(Rc<Guide>, u32, usize),
    /// At the end of the tree of a search.
    End(Rc<Guide>),
    /// Below such an end, so many own splits.
    Own(u32),
    /// Where integral columns are still to be probed.
    Probing(Box<Probing>),
    /// In the proof of a lemma, with few splits.
    Lemma,
}

/// A probing of integral columns: each is tried at both values, and what propagation refutes is
/// split off.
#[derive(Debug, Clone)]
pub(super) struct Probing {
    order: Vec<usize>,
    place: usize,
    /// Columns in a row of which neither value was refuted, and most of them.
    failures: usize,
    most_failures: usize,
    has_found: bool,
    /// Where to go on.
    then: ProofPart,
    /// The relaxed point before.
    point: Option<Vec<f64>>,
}

impl Probing {
    pub(super) fn new(order: Vec<usize>, then: ProofPart, point: Option<Vec<f64>>) -> Self {
        let most_failures = MOST_FAILURES;
        Probing { order, place: 0, failures: 0, most_failures, has_found: false, then, point }
    }
}

/// A part that is still to be proved.
#[derive(Debug)]
struct Open {
    mark: usize,
    /// How many facts hold on both sides of the split.
    facts: usize,
    decision: Decision,
    part: ProofPart,
}

/// A limit came before the end of a proof.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Limit;

/// The state of a proof.
pub(super) struct ProofWriter<'a, 'b> {
    pub(super) log: &'a mut ProofLog<'b>,
    pub(super) facts: Facts,
    pub(super) bounds: Bounds,
    pub(super) relaxer: Relaxer<'a>,
    /// Multiples of `z^2 - z` that make the objective convex.
    pub(super) squares: &'a [(usize, f64)],
    /// Own splits that may still be made.
    pub(super) splits_left: u64,
    /// Splits that a trial may still make; `None` outside of trials.
    pub(super) trial_left: Option<u64>,
    /// Splits that the proof of a lemma may still make.
    pub(super) lemma_splits: u32,
    /// The fact that is the negation of a lemma.
    pub(super) lemma_fact: usize,
    /// The binaries that the proof of a lemma splits first.
    pub(super) lemma_cases: Vec<usize>,
    /// The splits and cuts of the search.
    pub(super) guide: Rc<Guide>,
    /// Contexts that no sum of facts has closed.
    pub(super) gaps: u64,
}

impl ProofWriter<'_, '_> {
    /// Closes the present context along the tree of a search.
    pub(super) fn close(&mut self, part: ProofPart) -> Result<(), Limit> {
        let (ground, known) = (self.bounds.mark(), self.facts.len());
        let (mut open, mut next) = (Vec::new(), Some(part));
        let mut conflict = self.bounds.propagate(&self.facts).err();
        loop {
            let is_large = self.trial_left.is_some() && self.log.trial_size() > LARGEST_TRIAL;
            if is_large || self.log.has_failed() {
                return Err(Limit);
            }
            if let Some(what) = conflict.take() {
                self.write_conflict(what);
            } else if let Some(part) = next.take()
                && let Some((decision, near, far)) = self.step(part)?
            {
                if !self.is_split(decision) {
                    self.leave_open()?;
                    continue;
                }
                let mark = self.bounds.mark();
                self.log.split(decision.column, place_of(decision));
                // The context with the upper bound comes first.
                let (first, part, then) = match decision.is_upper {
                    true => (decision, near, far),
                    false => (opposite(decision), far, near),
                };
                let facts = self.facts.len();
                open.push(Open { mark, facts, decision: opposite(first), part: then });
                conflict = self.enter(first);
                next = Some(part);
                continue;
            }
            let Some(Open { mark, facts, decision, part }) = open.pop() else { break };
            self.bounds.undo_to(mark);
            self.facts.truncate(facts);
            conflict = self.enter(decision);
            next = Some(part);
        }
        self.bounds.undo_to(ground);
        self.facts.truncate(known);
        Ok(())
    }

    pub(super) fn enter(&mut self, decision: Decision) -> Option<Clash> {
        let Decision { column, is_upper, value } = decision;
        let [lower, upper] = self.bounds.of(column);
        if (is_upper && value < upper) || (!is_upper && value > lower) {
            self.bounds.decide(&self.facts, column, is_upper, value);
        }
        self.bounds.propagate(&self.facts).err()
    }

    /// Goes on with a part: closes it, or returns a split with the parts inside and outside of its
    /// decision.
    fn step(
        &mut self,
        mut part: ProofPart,
    ) -> Result<Option<(Decision, ProofPart, ProofPart)>, Limit> {
        loop {
            part = match part {
                ProofPart::Own(_) | ProofPart::End(_) => match self.close_or_probe(part)? {
                    Some(part) => part,
                    None => return Ok(None),
                },
                ProofPart::Probing(mut probing) => {
                    if let Some(decision) = self.probe(&mut probing) {
                        let again = ProofPart::Probing(probing);
                        return Ok(Some((decision, ProofPart::Own(0), again)));
                    }
                    match probing.then {
                        then @ (ProofPart::Own(_) | ProofPart::End(_)) => {
                            let point = probing.point.filter(|_| !probing.has_found);
                            match self.split_or_search(then, point)? {
                                Step::Closed => return Ok(None),
                                Step::Split(decision, below) => {
                                    return Ok(Some((decision, below.clone(), below)));
                                }
                                Step::Again(part) => part,
                            }
                        }
                        then => then,
                    }
                }
                ProofPart::Lemma => {
                    let split = self.split_lemma()?;
                    return Ok(split.map(|split| (split, ProofPart::Lemma, ProofPart::Lemma)));
                }
                ProofPart::Node(guide, node) if guide.saved_split(node).is_some() => {
                    if guide.is_plain && self.relaxer.keeps_multipliers && self.is_refuted()? {
                        return Ok(None);
                    }
                    ProofPart::Splits(guide, node, 0)
                }
                ProofPart::Node(guide, _) => ProofPart::End(guide),
                ProofPart::Splits(guide, node, place) => {
                    let split = guide.saved_split(node).and_then(|saved| guide.split(saved, place));
                    let Some((decision, child)) = split else {
                        let rest = guide.saved_split(node).and_then(SavedSplit::rest);
                        part = guide.part(rest);
                        continue;
                    };
                    match decision.and_then(|decision| self.usable(decision)) {
                        None => {
                            let split = decision.and_then(|d| self.deciding_split(d.column));
                            let Some(split) = split.filter(|_| self.splits_left > 0) else {
                                part = ProofPart::End(guide);
                                continue;
                            };
                            self.splits_left -= 1;
                            let again = ProofPart::Splits(guide, node, place);
                            return Ok(Some((split, again.clone(), again)));
                        }
                        Some(SideRelation::Holds) => guide.part(child),
                        Some(SideRelation::Fails) => ProofPart::Splits(guide, node, place + 1),
                        Some(SideRelation::Open(decision)) => {
                            let inside = guide.clone().part(child);
                            return Ok(Some((
                                decision,
                                inside,
                                ProofPart::Splits(guide, node, place + 1),
                            )));
                        }
                    }
                }
            };
        }
    }

    /// Whether the relaxation of the context closes it, at once or by bounds from its multipliers.
    fn is_refuted(&mut self) -> Result<bool, Limit> {
        match self.relaxer.relax(&self.facts, &self.bounds, [false, true]) {
            Relaxed::Refuted(refutation) => {
                self.write(refutation);
                Ok(true)
            }
            Relaxed::Stopped => Err(Limit),
            Relaxed::Open(_) => Ok(self.fix_by_reduced_costs()),
        }
    }

    /// Closes the context by its relaxation, or goes on with a probing of its columns.
    fn close_or_probe(&mut self, part: ProofPart) -> Result<Option<ProofPart>, Limit> {
        let point = match self.relaxer.relax(&self.facts, &self.bounds, [false, true]) {
            Relaxed::Refuted(refutation) => {
                self.write(refutation);
                return Ok(None);
            }
            Relaxed::Stopped => return Err(Limit),
            Relaxed::Open(point) => point,
        };
        if self.fix_by_reduced_costs() {
            return Ok(None);
        }
        let order = self.probing_order(point.as_deref());
        Ok(Some(ProofPart::Probing(Box::new(Probing::new(order, part, point)))))
    }

    /// Chooses a split of a context, by a search or on its own.
    fn split_or_search(&mut self, part: ProofPart, known: Option<Vec<f64>>) -> Result<Step, Limit> {
        let mut point = known;
        for (is_fine, is_tight) in [(false, true), (true, false)] {
            let is_open = point.is_some() && self.own_split(point.as_deref()).is_some();
            if is_open {
                break;
            }
            if is_fine && let Err(what) = self.bounds.propagate_finely(&self.facts) {
                self.write_conflict(what);
                return Ok(Step::Closed);
            }
            match self.relaxer.relax(&self.facts, &self.bounds, [is_fine, is_tight]) {
                Relaxed::Refuted(refutation) => {
                    self.write(refutation);
                    return Ok(Step::Closed);
                }
                Relaxed::Stopped => return Err(Limit),
                Relaxed::Open(found) => point = found,
            }
        }
        let depth = match part {
            ProofPart::End(guide) if guide.is_plain => 0,
            // A search costs more than a few splits, which often suffice.
            ProofPart::End(_) => SPLITS_BETWEEN_SEARCHES - SPLITS_BEFORE_A_SEARCH,
            ProofPart::Own(depth) if depth < SPLITS_BETWEEN_SEARCHES => depth,
            _ => {
                let guide = self.relaxer.search(&self.bounds, MOST_NODES)?;
                self.spend_trial(1 + guide.splits.len() as u64)?;
                return Ok(Step::Again(match guide.splits.is_empty() {
                    true => {
                        let order = self.probing_order(point.as_deref());
                        let mut probing = Probing::new(order, ProofPart::Own(0), point);
                        probing.most_failures = usize::MAX;
                        ProofPart::Probing(Box::new(probing))
                    }
                    false => ProofPart::Node(Rc::new(guide), 0),
                }));
            }
        };
        let Some(decision) = self.own_split(point.as_deref()) else {
            // What the search has closed here has a point, or whole numbers beyond those that are
            // counted in.
            self.leave_open()?;
            return Ok(Step::Closed);
        };
        self.splits_left = self.splits_left.checked_sub(1).ok_or(Limit)?;
        self.spend_trial(1)?;
        Ok(Step::Split(decision, ProofPart::Own(depth + 1)))
    }

    /// Closes a context by a step that no checker accepts.
    fn leave_open(&mut self) -> Result<(), Limit> {
        self.spend_trial(u64::MAX)?;
        self.log.remark("no sum of facts closes this context");
        self.log.contradiction(std::iter::empty());
        self.gaps += 1;
        Ok(())
    }

    /// Counts splits of a trial.
    fn spend_trial(&mut self, splits: u64) -> Result<(), Limit> {
        if let Some(left) = &mut self.trial_left {
            *left = left.checked_sub(splits).ok_or(Limit)?;
        }
        Ok(())
    }

    /// The integral columns to probe: the fractional ones, the most fractional first, then some
    /// others.
    fn probing_order(&self, point: Option<&[f64]>) -> Vec<usize> {
        let program = &self.relaxer.program;
        let Some(point) = point else { return program.integers.clone() };
        let distance = |j: &usize| (point[*j] - point[*j].round()).abs();
        let (mut order, others): (Vec<usize>, Vec<usize>) =
            program.integers.iter().partition(|j| distance(j) > FRACTIONAL);
        order.sort_by(|a, b| distance(b).total_cmp(&distance(a)));
        order.extend(others);
        order
    }

    /// The next side of a column that propagation refutes.
    fn probe(&mut self, probing: &mut Probing) -> Option<Decision> {
        while let Some(&column) = probing.order.get(probing.place) {
            if probing.failures >= probing.most_failures {
                return None;
            }
            let [lower, upper] = self.bounds.of(column);
            if upper - lower == 1.0 && is_counted(lower) {
                for is_upper in [true, false] {
                    let value = if is_upper { lower } else { upper };
                    let decision = Decision { column, is_upper, value };
                    let mark = self.bounds.mark();
                    let is_refuted = self.enter(decision).is_some();
                    self.bounds.undo_to(mark);
                    if is_refuted {
                        (probing.failures, probing.has_found) = (0, true);
                        probing.place += 1;
                        return Some(decision);
                    }
                }
                probing.failures += 1;
            }
            probing.place += 1;
        }
        None
    }

    /// Writes the bounds that some sides rest on.
    pub(super) fn write_bounds(&mut self, sides: impl Iterator<Item = Side>) {
        for (change, fact) in self.bounds.reasons(&self.facts, sides) {
            self.log.bound(&change, fact);
        }
    }

    pub(super) fn write_conflict(&mut self, what: Clash) {
        match what {
            Clash::Column(j) => self.write_bounds([(j, false), (j, true)].into_iter()),
            Clash::Fact(fact, is_upper) => {
                let sides: Vec<Side> =
                    Bounds::sides_of(&self.facts, fact, is_upper, None).collect();
                self.write_bounds(sides.into_iter());
            }
        }
        self.log.conflict(what);
    }

    /// Writes a sum of facts that closes the context.
    pub(super) fn write(&mut self, refutation: FactRefutation) {
        let FactRefutation { facts, tangent, cones, tight, sides } = refutation;
        self.write_bounds(sides.into_iter());
        let mut sum = facts;
        let mut next = self.facts.len();
        for (row, y) in tight {
            let TightRowLemma { terms, is_upper, limit, steps, .. } = row;
            self.log.lemma(is_upper, limit, terms.into_iter());
            for step in steps {
                match step {
                    TightStep::Split(column) => self.log.split(column, 0.0),
                    TightStep::Close(sign, fact) => {
                        let own = std::iter::once((next, sign));
                        self.log.contradiction(own.chain(fact));
                    }
                }
            }
            sum.push((next, y));
            next += 1;
        }
        if let Some(point) = tangent {
            self.log.tangent(point.into_iter());
            sum.push((next, -1.0));
            next += 1;
        }
        for (row, y) in cones {
            self.log.cone_row(row.cone, &row.head, &row.tail);
            sum.push((next, y));
            next += 1;
        }
        self.log.contradiction(sum.into_iter());
    }
}

/// The next step at the end of a tree.
enum Step {
    Closed,
    /// A split, and how both sides go on.
    Split(Decision, ProofPart),
    Again(ProofPart),
}
