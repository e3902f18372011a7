//! Contacts from a simulation, proposed as points for a solver to try.

use super::{Contact, ContactLaw};
use crate::model::{Family, Variable};
use crate::solver::{NodeView, Proposal};

/// Simulates the accelerations of a node's relaxation from the start under the reflecting law and
/// proposes the contacts that result. Pass it to
/// [`Guidance::with_proposal`](crate::solver::Guidance::with_proposal). Contacts that are fixed at
/// the node keep their values. Under [`ContactLaw::Literal`] there is no proposal.
///
/// ```
/// use carom::collision_tolerant::{Objective, PlanningProgram, Scenario};
/// use carom::hybrid::RollOut;
/// use carom::prelude::*;
/// use carom::solver::Guidance;
///
/// let scenario = Scenario::paper().with_restitution(0.5)?.with_time_step(0.1);
/// let program = PlanningProgram::build(&scenario, 30, Objective::Effort)?;
/// let roll_out = RollOut {
///     contact: scenario.contact,
///     time_step: scenario.time_step,
///     position: program.position.clone(),
///     velocity: program.velocity.clone(),
///     acceleration: program.acceleration.clone(),
///     events: program.contact.clone().expect("collisions are tolerated"),
/// };
/// let guidance = Guidance::default().with_proposal(&roll_out);
/// let mut control = Control::default().with_guidance(guidance);
/// let solution = BranchAndBound::default().solve_with(&program.model, &mut control)?;
/// assert!(solution.is_optimal());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct RollOut {
    /// The wall, its restitution and law.
    pub contact: Contact,
    /// Δt, in s.
    pub time_step: f64,
    /// x(0), x(1), ..., in m; the first one is the start.
    pub position: Family,
    /// v(0), v(1), ..., in m/s; the first one is the start.
    pub velocity: Family,
    /// a(0), a(1), ..., in m/s².
    pub acceleration: Family,
    /// ζ(0), ζ(1), ...
    pub events: Family,
}

impl RollOut {
    fn roll(&self, node: &NodeView<'_>) -> Option<Vec<(Variable, f64)>> {
        let (wall, e, dt) = (self.contact.wall, self.contact.restitution.value(), self.time_step);
        let start = |family: &Family| node.value(family.get(0)?).ok();
        let (mut gap, mut rate) =
            (wall.gap(start(&self.position)?), wall.rate(start(&self.velocity)?));
        let mut modes = Vec::with_capacity(self.events.len());
        for (event, acceleration) in self.events.iter().zip(self.acceleration.iter()) {
            let push = wall.rate(node.value(acceleration).ok()?);
            let bounds = node.bounds(event).ok()?;
            let (free_gap, free_rate) = (gap + dt * rate + 0.5 * dt * dt * push, rate + dt * push);
            let hits = free_gap < 0.0 && free_rate <= 0.0;
            let hits = (hits || bounds.lower == 1.0) && bounds.upper == 1.0;
            (gap, rate) =
                if hits { (-e * free_gap, -e * free_rate) } else { (free_gap, free_rate) };
            modes.push((event, f64::from(u8::from(hits))));
        }
        Some(modes)
    }
}

impl Proposal for RollOut {
    /// Contacts first, then the steps without contact.
    fn propose(&self, node: &NodeView<'_>) -> Vec<(Variable, f64)> {
        if self.contact.law != ContactLaw::Reflecting {
            return Vec::new();
        }
        let mut modes = self.roll(node).unwrap_or_default();
        modes.sort_by(|a, b| b.1.total_cmp(&a.1));
        modes
    }
}
