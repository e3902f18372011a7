//! The fate of a cell: a leaf with a plan or without, or two halves.

use std::rc::Rc;
use std::sync::Arc;

use crate::bounds::{self, Coefficients};
use crate::corner::{Corner, CornerOptimum, Workshop};
use crate::edge_choice::CellEdge;
use crate::form::ParametricForm;
use crate::proof_of_cell::{CellClaim, CellProof, NoProof, square};
use crate::relaxed::CornerRelaxation;
use crate::simplex_cell::midpoint;

/// When a cell is finished.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BuildGoal {
    pub(crate) absolute: f64,
    pub(crate) relative: f64,
    /// The length of an edge, as a share of the side of the box, below which cells are not cut.
    pub(crate) finest: f64,
    /// The most leaves.
    pub(crate) cells: usize,
}

impl BuildGoal {
    /// The number of cuts after which a cell is not cut: then it is as small as if all of its edges
    /// were the finest ones.
    pub(crate) fn deepest(&self, axes: usize) -> usize {
        axes * ((axes as f64).sqrt() / self.finest).log2().ceil().max(0.0) as usize
    }

    /// The loss that is allowed over a cell, from the coefficients of its cost: with the least cost
    /// f over the cell, at most `absolute + relative |f|`.
    fn loss(&self, cost: &Coefficients) -> f64 {
        let least = cost.iter().copied().fold(f64::INFINITY, f64::min);
        let most = cost.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let BuildGoal { absolute, relative, .. } = *self;
        // The optimum is at least the cost less the loss, and at most the cost.
        let positive = (absolute + relative * least) / (1.0 + relative);
        absolute.max(positive).max(absolute - relative * most)
    }
}

/// A room that a claimed loss leaves for the rounding of the sums, relative to the cost.
const LOSS_ROUNDING: f64 = 1e-9;

/// The most integers that are tried before a cell is cut.
const MOST_LAWS_TRIED: usize = 3;

/// The most integers that a half takes over from the whole.
const MOST_INHERITED: usize = 8;

/// A law: the plans of the corners, with the same integers.
#[derive(Debug)]
pub(crate) struct CellLaw {
    pub(crate) plans: Vec<Arc<CornerRelaxation>>,
    /// The most that it loses; infinite without a proof.
    pub(crate) loss: f64,
    /// The most that it may lose.
    pub(crate) allowed: f64,
    /// No steps without a proof.
    pub(crate) proof: CellProof,
}

/// A cell of the finished partition.
#[derive(Debug)]
pub(crate) enum PartitionCell {
    Cut { edge: [usize; 2], next: [usize; 2] },
    Plan(CellLaw),
    NoPlan(CellProof),
    Open,
}

impl PartitionCell {
    /// Whether the cell is finished by another goal, which is noted.
    pub(crate) fn is_finished(&mut self, form: &ParametricForm, goal: BuildGoal) -> bool {
        match self {
            PartitionCell::Open => false,
            PartitionCell::Plan(law) => {
                law.allowed = goal.loss(&plans_cost(form, &law.plans));
                law.loss <= law.allowed
            }
            PartitionCell::Cut { .. } | PartitionCell::NoPlan(_) => true,
        }
    }
}

/// The cost of interpolated plans.
pub(crate) fn plans_cost(form: &ParametricForm, plans: &[Arc<CornerRelaxation>]) -> Coefficients {
    let point = |plan: &Arc<CornerRelaxation>| match &**plan {
        CornerRelaxation::Solved { x, .. } => x.clone(),
        _ => Vec::new(),
    };
    let points: Vec<Vec<f64>> = plans.iter().map(point).collect();
    let points: Vec<&[f64]> = points.iter().map(Vec::as_slice).collect();
    bounds::cost(form, &points)
}

/// The fate of a cell.
pub(crate) enum CellDecision {
    Leaf(PartitionCell),
    /// The edge that is cut, the corners of the halves, and integers to try there.
    Cut(CellEdge, [Vec<Rc<Corner>>; 2], Vec<usize>),
}

/// A law that is not proved yet.
struct Trial {
    number: usize,
    plans: Vec<Arc<CornerRelaxation>>,
    cost: Coefficients,
    sum: f64,
}

impl Trial {
    fn slack(&self) -> f64 {
        let largest = self.cost.iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        LOSS_ROUNDING * (1.0 + largest)
    }

    /// The loss that a proof may have, so that there is room for rounding.
    fn allowed(&self, goal: BuildGoal) -> f64 {
        goal.loss(&self.cost) - self.slack()
    }

    /// Whether another law costs less at a corner by more than a loss that is allowed.
    fn is_dearer(&self, other: &Trial, goal: BuildGoal) -> bool {
        let allowed = self.allowed(goal);
        let corner = |v: usize| self.cost[square(v)] - other.cost[square(v)] > allowed;
        (0..self.plans.len()).any(corner)
    }

    fn law(self, proof: CellProof, goal: BuildGoal) -> PartitionCell {
        let (loss, allowed) = (proof.loss.max(0.0) + self.slack(), goal.loss(&self.cost));
        PartitionCell::Plan(CellLaw { plans: self.plans, loss, allowed, proof })
    }
}

impl Workshop<'_> {
    /// Decides a cell; without `room` it becomes a leaf.
    ///
    /// # Arguments
    ///
    /// * `tried`: integers that were good for the whole.
    /// * `depth`: the number of cuts that led to the cell.
    pub(crate) fn decide(
        &mut self,
        corners: &[Rc<Corner>],
        tried: &[usize],
        (goal, depth): (BuildGoal, usize),
        room: bool,
    ) -> CellDecision {
        if self.is_over() {
            return CellDecision::Leaf(PartitionCell::Open);
        }
        let mut waiting = tried.to_vec();
        let (mut seen, mut trials, mut failed) = (Vec::new(), Vec::new(), Vec::new());
        let (mut has_optima, mut proofs) = (false, 0);
        // The best integers of corners come first for the halves.
        let mut good = Vec::new();
        loop {
            for number in std::mem::take(&mut waiting) {
                if !seen.contains(&number) {
                    seen.push(number);
                    trials.extend(self.trial(corners, number));
                }
            }
            // The cheapest one is last.
            trials.sort_by(|a: &Trial, b: &Trial| b.sum.total_cmp(&a.sum));
            let next = if proofs < MOST_LAWS_TRIED { trials.pop() } else { None };
            if let Some(trial) = next {
                // Where another law is cheaper by more at a corner, there is no proof.
                let mut others = trials.iter().chain(&failed);
                if others.any(|other| trial.is_dearer(other, goal)) {
                    failed.push(trial);
                    continue;
                }
                proofs += 1;
                match self
                    .prove(corners, CellClaim::Loss(&trial.cost, trial.allowed(goal), trial.number))
                {
                    Ok(proof) => return CellDecision::Leaf(trial.law(proof, goal)),
                    Err(NoProof { better }) => waiting.extend(better),
                }
                failed.push(trial);
                continue;
            }
            if has_optima || proofs >= MOST_LAWS_TRIED {
                break;
            }
            has_optima = true;
            let optima = corners.iter().map(|corner| self.optimum(corner));
            let optima: Vec<CornerOptimum> = optima.collect();
            if optima.iter().all(|optimum| *optimum == CornerOptimum::NoPlan) {
                match self.prove(corners, CellClaim::NoPlan) {
                    Ok(proof) => return CellDecision::Leaf(PartitionCell::NoPlan(proof)),
                    Err(_) => break,
                }
            }
            let best = |optimum: &CornerOptimum| match optimum {
                CornerOptimum::Best(number) => Some(*number),
                _ => None,
            };
            waiting.extend(optima.iter().filter_map(best));
            good = waiting.clone();
            if optima.contains(&CornerOptimum::NoPlan) {
                // No law holds at a corner without a plan, and some may in a half.
                break;
            }
        }
        failed.append(&mut trials);
        failed.sort_by(|a, b| a.sum.total_cmp(&b.sum));
        let cheapest = failed.first().map(|trial| self.any_loss(corners, trial, goal));
        if room && cheapest.as_ref().is_none_or(|(is_within, _)| !*is_within) {
            good.extend(failed.iter().map(|trial| trial.number));
            good.extend(seen);
            let mut known = Vec::new();
            good.retain(|number| {
                !known.contains(number) && {
                    known.push(*number);
                    true
                }
            });
            good.truncate(MOST_INHERITED);
            let edge = self.edge(corners, &good, goal, depth);
            if let Some((edge, halves)) = edge.and_then(|edge| self.halves(corners, edge)) {
                return CellDecision::Cut(edge, halves, good);
            }
        }
        let Some((trial, (_, proof))) = failed.into_iter().next().zip(cheapest) else {
            return CellDecision::Leaf(PartitionCell::Open);
        };
        CellDecision::Leaf(trial.law(proof, goal))
    }

    /// The proof of whatever a law loses, and whether that is little enough. The box of its
    /// integers alone may have worse multipliers than a larger one, which is all that is asked
    /// here.
    fn any_loss(
        &mut self,
        corners: &[Rc<Corner>],
        trial: &Trial,
        goal: BuildGoal,
    ) -> (bool, CellProof) {
        let claim = CellClaim::AnyLoss(&trial.cost, trial.allowed(goal));
        let none = CellProof { steps: Vec::new(), loss: f64::INFINITY };
        let proof = self.prove(corners, claim).unwrap_or(none);
        (proof.loss <= trial.allowed(goal), proof)
    }

    /// The law of these integers, if it holds at all corners.
    fn trial(&mut self, corners: &[Rc<Corner>], number: usize) -> Option<Trial> {
        let mut plans = Vec::with_capacity(corners.len());
        let mut sum = 0.0;
        for corner in corners {
            let plan = self.relaxed(corner, number);
            let CornerRelaxation::Solved { cost, .. } = &*plan else { return None };
            sum += cost;
            plans.push(plan);
        }
        let cost = plans_cost(self.form, &plans);
        Some(Trial { number, plans, cost, sum })
    }

    /// The corners of the halves; `None` if the middle is finer than the unit.
    fn halves(
        &mut self,
        corners: &[Rc<Corner>],
        [i, j]: CellEdge,
    ) -> Option<(CellEdge, [Vec<Rc<Corner>>; 2])> {
        let middle = self.corner(midpoint(corners[i].units(), corners[j].units())?);
        let with = |k: usize| {
            let mut half = corners.to_vec();
            half[k] = Rc::clone(&middle);
            half
        };
        Some(([i, j], [with(j), with(i)]))
    }
}
