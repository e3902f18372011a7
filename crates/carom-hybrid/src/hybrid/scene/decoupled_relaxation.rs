//! A relaxation of a scene's system in which axes are independent, for sets of each axis.

use super::contact::ContactPair;
use super::system::Stated;
use crate::activity::term_ends;
use crate::hybrid::system::{Halfspace, HybridSystem};
use crate::interval::Interval;
use crate::tolerance::REACH;

/// The system in which conditions that couple axes are replaced by what they say about each axis,
/// while the other axes are anywhere in their domains. Each of its plans may be impossible, but
/// each plan of the scene is one of them.
pub(super) fn decoupled_relaxation(stated: &Stated) -> HybridSystem {
    let mut system = stated.system.clone();
    let block = 2 * stated.scene.axes();
    let axes = Axes {
        count: stated.scene.axes(),
        // A plan may miss its domain by as much as sets allow.
        domains: system.states.iter().map(|(_, domain)| widened(*domain)).collect(),
        block,
    };
    // What is predicted for a step with a hit may be outside the domains.
    let bounces = stated.contacts.iter().any(ContactPair::bounces);
    for choice in &mut system.choices {
        for transition in &mut choice.transitions {
            transition.guards = axes.apart(&transition.guards, true);
            transition.prediction_guards = axes.apart(&transition.prediction_guards, !bounces);
        }
    }
    system.limits = axes.apart(&system.limits, true);
    // Domains and ranges remain of the limits of lengths.
    system.clear_norms();
    system
}

/// The states of each axis of each body: its position and its speed.
struct Axes {
    count: usize,
    domains: Vec<Interval>,
    block: usize,
}

impl Axes {
    /// Conditions about one axis each.
    ///
    /// # Arguments
    ///
    /// * `within`: whether the states of the conditions are in their domains.
    fn apart(&self, conditions: &[Halfspace], within: bool) -> Vec<Halfspace> {
        conditions.iter().flat_map(|condition| self.about_axes(condition, within)).collect()
    }

    fn about_axes(&self, condition: &Halfspace, within: bool) -> Vec<Halfspace> {
        let mut touched: Vec<(usize, usize)> = (0..condition.normal.len())
            .filter(|&i| condition.normal[i] != 0.0)
            .map(|i| self.of(i))
            .collect();
        touched.sort_unstable();
        touched.dedup();
        if touched.len() < 2 {
            return vec![condition.clone()];
        }
        let one = |&own: &(usize, usize)| {
            let others = (0..condition.normal.len()).filter(|&i| self.of(i) != own);
            let least: f64 = others.map(|i| self.least(i, condition.normal[i])).sum();
            let mut normal = condition.normal.clone();
            (0..normal.len()).filter(|&i| self.of(i) != own).for_each(|i| normal[i] = 0.0);
            let mut about = condition.clone();
            about.limit = condition.limit.map(|limit| limit - least);
            about.normal = normal;
            about
        };
        let told = touched.iter().map(one);
        told.filter(|about| within && about.limit.values().all(|limit| !limit.is_nan())).collect()
    }

    /// The least value of a term.
    fn least(&self, state: usize, factor: f64) -> f64 {
        match (factor, self.domains.get(state)) {
            (0.0, _) => 0.0,
            (_, None) => f64::NEG_INFINITY,
            (factor, Some(domain)) => term_ends(factor, [domain.lower, domain.upper])[0],
        }
    }

    /// The body and the axis of a state.
    fn of(&self, state: usize) -> (usize, usize) {
        (state / self.block, state % self.block % self.count)
    }
}

fn widened(domain: Interval) -> Interval {
    let slack = REACH * domain.magnitude().max(1.0);
    Interval::new(domain.lower - slack, domain.upper + slack)
}
