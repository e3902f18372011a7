//! The proof of a cell: the integers are cut into boxes, each with a bound on what it can save, or
//! with a refutation.

use std::rc::Rc;
use std::sync::Arc;

use crate::bounds::{self, Coefficients, CornerPlace, Evidence};
use crate::corner::{Corner, Workshop};
use crate::integer_tree::IntegerTree;
use crate::relaxed::{CornerRelaxation, RAY_MARGIN};

/// A step of a proof. The steps are in the order of a walk: a box, its first half and all below,
/// its second half and all below.
#[derive(Debug, Clone)]
pub(crate) enum CellStep {
    /// The box is cut: the column is at most the value, or at least one more.
    Cut { column: usize, value: f64 },
    /// The bound of this evidence, corner by corner.
    Bound(Vec<Arc<Evidence>>),
    /// This evidence says that there is no point, corner by corner.
    Refuted(Vec<Arc<Evidence>>),
}

/// A proof, and the largest coefficient of cost less bound.
#[derive(Debug, Clone)]
pub(crate) struct CellProof {
    pub(crate) steps: Vec<CellStep>,
    pub(crate) loss: f64,
}

/// Why there is no proof.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NoProof {
    /// Integers that are better at a corner, if that is why.
    pub(crate) better: Option<usize>,
}

/// A claim about a cell that is to be proved.
#[derive(Debug, Clone, Copy)]
pub(crate) enum CellClaim<'a> {
    /// A plan of this cost loses at most so much. It has the integers of the last number.
    Loss(&'a Coefficients, f64, usize),
    /// A plan of this cost loses what is found out; boxes that do not lose more than that are not
    /// cut.
    AnyLoss(&'a Coefficients, f64),
    /// There is no plan.
    NoPlan,
}

impl CellClaim<'_> {
    fn cost(&self) -> Option<&Coefficients> {
        match self {
            CellClaim::Loss(cost, ..) | CellClaim::AnyLoss(cost, _) => Some(cost),
            CellClaim::NoPlan => None,
        }
    }
}

enum Closing {
    Closed(CellStep, f64),
    /// A relaxation that is cheaper at a corner than the claim allows, if that is why.
    Cheaper(Arc<CornerRelaxation>),
    /// A relaxation at which to cut.
    Failed(Option<Arc<CornerRelaxation>>),
}

/// The most boxes that a proof may have.
const MOST_CELL_STEPS: usize = 2_000;

/// Multiples of rays that are tried.
const RAY_FACTORS: [f64; 3] = [1.0, 4.0, 32.0];

/// The position of the pair (v, v) among coefficients.
pub(crate) fn square(v: usize) -> usize {
    v * (v + 3) / 2
}

pub(crate) fn largest_difference(cost: &Coefficients, bound: &Coefficients) -> f64 {
    cost.iter().zip(bound).map(|(c, b)| c - b).fold(f64::NEG_INFINITY, f64::max)
}

impl Workshop<'_> {
    /// Proves a claim about a cell.
    pub(crate) fn prove(
        &mut self,
        corners: &[Rc<Corner>],
        claim: CellClaim<'_>,
    ) -> Result<CellProof, NoProof> {
        // The integers of the plan are in each cover of all integers: without them it is in vain.
        if let CellClaim::Loss(_, _, own) = claim
            && !matches!(self.close(corners, own, claim), Closing::Closed(..))
        {
            return Err(NoProof { better: None });
        }
        let mut proof = CellProof { steps: Vec::new(), loss: 0.0 };
        let mut waiting = vec![IntegerTree::WHOLE];
        while let Some(number) = waiting.pop() {
            if proof.steps.len() >= MOST_CELL_STEPS || self.is_over() {
                return Err(NoProof { better: None });
            }
            let (relaxed, is_cheaper) = match self.close(corners, number, claim) {
                Closing::Closed(step, loss) => {
                    proof.steps.push(step);
                    proof.loss = proof.loss.max(loss);
                    continue;
                }
                Closing::Cheaper(relaxed) => (Some(relaxed), true),
                Closing::Failed(relaxed) => (relaxed, false),
            };
            let x = match relaxed.as_deref() {
                Some(CornerRelaxation::Solved { x, .. }) => Some(&x[..]),
                _ => None,
            };
            let better = x.filter(|_| is_cheaper).and_then(|x| self.tree.point(x));
            let cut = if better.is_none() { self.tree.cut(number, x) } else { None };
            let Some((column, value, halves)) = cut else { return Err(NoProof { better }) };
            proof.steps.push(CellStep::Cut { column, value });
            let [below, above] = halves;
            waiting.extend([above, below]);
        }
        Ok(proof)
    }

    /// Closes a box of the integers, if it can.
    fn close(&mut self, corners: &[Rc<Corner>], number: usize, claim: CellClaim<'_>) -> Closing {
        let mut order: Vec<usize> = (0..corners.len()).collect();
        order.sort_by_key(|&v| !corners[v].knows(number));
        let unknown = Arc::new(CornerRelaxation::Unknown);
        let mut found = vec![unknown; corners.len()];
        for v in order {
            let relaxed = self.relaxed(&corners[v], number);
            let fails = match (&*relaxed, claim) {
                (CornerRelaxation::Refuted(_), _) | (_, CellClaim::AnyLoss(..)) => false,
                (CornerRelaxation::Unknown, _) | (_, CellClaim::NoPlan) => true,
                (CornerRelaxation::Solved { evidence, .. }, CellClaim::Loss(cost, loss, _)) => {
                    let sides = self.tree.sides(number);
                    let bound = evidence.value(self.form, corners[v].place(), sides);
                    cost[square(v)] - bound > loss
                }
            };
            if fails {
                return Closing::Cheaper(relaxed);
            }
            found[v] = relaxed;
        }
        let places: Vec<&CornerPlace> = corners.iter().map(|corner| corner.place()).collect();
        if let Some(evidence) = self.refutation(&found, &places, number) {
            return Closing::Closed(CellStep::Refuted(evidence), 0.0);
        }
        let Some(cost) = claim.cost() else { return Closing::Failed(None) };
        let (CellClaim::Loss(_, loss, _) | CellClaim::AnyLoss(_, loss)) = claim else {
            return Closing::Failed(None);
        };
        let mut best: Option<(f64, Vec<Arc<Evidence>>)> = None;
        for evidence in self.candidates(&found, &places, number, (cost, loss)) {
            let bound = bounds::bound(self.form, &evidence, &places, self.tree.sides(number));
            let worst = largest_difference(cost, &bound);
            if best.as_ref().is_none_or(|(least, _)| worst < *least) {
                best = Some((worst, evidence));
            }
            if worst <= loss {
                break;
            }
        }
        let is_last = matches!(claim, CellClaim::AnyLoss(..)) && self.tree.is_point(number);
        match best {
            Some((worst, evidence)) if worst <= loss || is_last => {
                Closing::Closed(CellStep::Bound(evidence), worst)
            }
            _ => {
                let fractional = |relaxed: &&Arc<CornerRelaxation>| match &***relaxed {
                    CornerRelaxation::Solved { x, .. } => self.tree.is_fractional(x),
                    _ => false,
                };
                Closing::Failed(found.iter().find(fractional).cloned())
            }
        }
    }

    /// Evidence for a bound, to be tried one after the other.
    fn candidates(
        &self,
        found: &[Arc<CornerRelaxation>],
        places: &[&CornerPlace],
        number: usize,
        (cost, loss): (&Coefficients, f64),
    ) -> Vec<Vec<Arc<Evidence>>> {
        let form = self.form;
        let own = |relaxed: &Arc<CornerRelaxation>| match &**relaxed {
            CornerRelaxation::Solved { evidence, .. } => Some(Arc::clone(evidence)),
            _ => None,
        };
        let solved: Vec<Option<Arc<Evidence>>> = found.iter().map(own).collect();
        let known: Vec<&Arc<Evidence>> = solved.iter().flatten().collect();
        let mean = |of: fn(&Evidence) -> &Vec<f64>, length: usize| {
            let mut sum = vec![0.0; length];
            for evidence in &known {
                let share = 1.0 / known.len() as f64;
                sum.iter_mut().zip(of(evidence)).for_each(|(s, value)| *s += share * value);
            }
            sum
        };
        if known.len() == found.len() {
            let mut all = vec![known.iter().map(|e| Arc::clone(e)).collect()];
            // Where multipliers jump within the cell, those of one corner may do better.
            let one = |e: &&Arc<Evidence>| vec![Arc::clone(*e); found.len()];
            all.extend(known.iter().map(one));
            return all;
        }
        // A corner without a point has the mean of the others' evidence, and a multiple of its ray
        // that lifts its bound to the cost.
        let z = mean(|evidence| &evidence.z, form.columns());
        let y = mean(|evidence| &evidence.y, form.rows.len());
        let base = Arc::new(Evidence::bound(form, z.clone(), y.clone()));
        let sides = self.tree.sides(number);
        let lifted = |factor: f64| {
            let at = |v: usize| {
                if let Some(evidence) = &solved[v] {
                    return Arc::clone(evidence);
                }
                let CornerRelaxation::Refuted(ray) = &*found[v] else { return Arc::clone(&base) };
                let lacks = cost[square(v)] - loss - base.value(form, places[v], sides);
                let multiple = factor * lacks.max(0.0) / ray.value(form, places[v], sides);
                let sum = y.iter().zip(&ray.y).map(|(y, r)| y + multiple * r).collect();
                Arc::new(Evidence::bound(form, z.clone(), sum))
            };
            (0..found.len()).map(at).collect()
        };
        RAY_FACTORS.map(lifted).into()
    }

    /// Evidence that a box has no point in the cell.
    fn refutation(
        &self,
        found: &[Arc<CornerRelaxation>],
        places: &[&CornerPlace],
        number: usize,
    ) -> Option<Vec<Arc<Evidence>>> {
        let ray = |relaxed: &Arc<CornerRelaxation>| match &**relaxed {
            CornerRelaxation::Refuted(ray) => Some(Arc::clone(ray)),
            _ => None,
        };
        let rays: Vec<Arc<Evidence>> = found.iter().map(ray).collect::<Option<_>>()?;
        let (form, sides) = (self.form, self.tree.sides(number));
        let holds = |rays: &Vec<Arc<Evidence>>| {
            let above = bounds::bound(form, rays, places, sides);
            above.into_iter().all(|value| value > RAY_MARGIN)
        };
        if holds(&rays) {
            return Some(rays);
        }
        let one = rays.iter().map(|ray| vec![Arc::clone(ray); rays.len()]);
        one.into_iter().find(holds)
    }
}
