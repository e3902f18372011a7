//! The order of the methods: the dual one, and the primal one for what is left of the true costs.

use super::dual::Dual;
use super::parameters::{DUAL_TOLERANCE, IDLE_PART, MIN_IDLE_STEPS};
use super::primal::Primal;
use super::tableau::{Iteration, NONBASIC, Tableau};
use crate::relaxation::{Effort, RelaxationClaim};

/// The number of times that the dual method begins.
const MAX_ROUNDS: u32 = 5;

/// The number of exchanges after which the bound of perturbed costs is compared with that of the
/// true ones.
const BOUND_INTERVAL: u32 = 20;

/// A run of the methods on a program.
pub(super) struct Run<'a> {
    pub(super) dual: Dual,
    effort: &'a Effort<'a>,
    /// The dual objective that is enough, scaled.
    enough: f64,
    pub(super) iterations: u32,
    is_perturbed: bool,
    /// The iteration of the last look at the true bound.
    looked: u32,
}

/// The end of a run.
pub(super) struct RunEnd {
    pub(super) claim: RelaxationClaim,
    /// Multipliers that prove that there is no point, or a ray; scaled.
    pub(super) ray: Option<Vec<f64>>,
}

impl RunEnd {
    fn without_ray(claim: RelaxationClaim) -> Self {
        RunEnd { claim, ray: None }
    }
}

impl<'a> Run<'a> {
    pub(super) fn new(dual: Dual, effort: &'a Effort<'a>, enough: f64) -> Self {
        Run { dual, effort, enough, iterations: 0, is_perturbed: false, looked: 0 }
    }

    pub(super) fn solve(&mut self) -> RunEnd {
        for round in 0..MAX_ROUNDS {
            if let Some(end) = self.run_dual(round == 0) {
                return end;
            }
            if let Some(end) = self.run_primal() {
                return end;
            }
            // What the primal method has left of the violations.
            self.dual.restart();
            self.dual.allow(self.effort.tolerance);
            if self.dual.is_optimal() {
                let is_beyond = self.dual.value > self.enough;
                return RunEnd::without_ray(match is_beyond {
                    true => RelaxationClaim::Beyond,
                    false => RelaxationClaim::Solved,
                });
            }
        }
        RunEnd::without_ray(RelaxationClaim::Unknown)
    }

    fn is_over(&self) -> bool {
        self.iterations >= self.effort.iterations || self.effort.token.is_over()
    }

    /// Runs the dual method until its basis is optimal for the costs that it uses.
    fn run_dual(&mut self, may_perturb: bool) -> Option<RunEnd> {
        while !self.is_over() {
            if self.dual.value > self.enough && self.is_beyond() {
                return Some(RunEnd::without_ray(RelaxationClaim::Beyond));
            }
            match self.dual.step() {
                Iteration::Moved => self.iterations += 1,
                Iteration::Optimal => return None,
                Iteration::Infeasible(ray) => {
                    return Some(RunEnd { claim: RelaxationClaim::Infeasible, ray: Some(ray) });
                }
                _ => return Some(RunEnd::without_ray(RelaxationClaim::Unknown)),
            }
            let stalls = self.dual.idle_steps > MIN_IDLE_STEPS.max(self.iterations / IDLE_PART);
            if stalls && may_perturb && !self.is_perturbed {
                self.perturb();
            }
        }
        Some(RunEnd::without_ray(RelaxationClaim::Unknown))
    }

    fn perturb(&mut self) {
        self.is_perturbed = true;
        self.dual.tableau.perturb();
        self.dual.value = self.dual.tableau.dual_value();
    }

    /// Whether the bound of the true costs is enough.
    fn is_beyond(&mut self) -> bool {
        if !self.is_perturbed {
            return true;
        }
        if self.iterations < self.looked + BOUND_INTERVAL {
            return false;
        }
        self.looked = self.iterations;
        self.dual.tableau.true_bound() > self.enough
    }

    /// Goes back to the true costs, and runs the primal method if that leaves reduced costs of the
    /// wrong sign.
    fn run_primal(&mut self) -> Option<RunEnd> {
        let tableau = &mut self.dual.tableau;
        tableau.used.copy_from_slice(&tableau.program.cost);
        tableau.compute_costs();
        let misses = |tableau: &Tableau| {
            let outside = (0..tableau.slot.len()).filter(|&k| tableau.slot[k] == NONBASIC);
            outside.map(|k| tableau.dual_miss(k)).any(|miss| miss > DUAL_TOLERANCE)
        };
        if !misses(tableau) {
            return None;
        }
        let mut primal = Primal::new(tableau);
        while !self.is_over() {
            match primal.step(&mut self.dual.tableau) {
                Iteration::Moved => self.iterations += 1,
                Iteration::Optimal => return None,
                Iteration::Unbounded(ray) => {
                    return Some(RunEnd { claim: RelaxationClaim::Unbounded, ray: Some(ray) });
                }
                _ => break,
            }
        }
        Some(RunEnd::without_ray(RelaxationClaim::Unknown))
    }
}
