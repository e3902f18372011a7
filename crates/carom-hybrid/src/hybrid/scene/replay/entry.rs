//! Whether a hit is at the face through which its step enters.

use super::world::{State, Touch};
use super::{MISS, Played};
use crate::error::SceneError;
use crate::hybrid::damage::ImpactEstimate;
use crate::hybrid::scene::entry::SHARP;
use crate::hybrid::scene::geometry::dot;

impl Played<'_> {
    /// A hit begins in front of the face, ends behind it moving inward, and both within its extent.
    pub(super) fn entry(
        &self,
        step: usize,
        touch: Touch,
        face: usize,
        flown: &State,
    ) -> Result<(), SceneError> {
        let world = &self.world;
        let name = world.name(touch);
        let start = &self.samples[step];
        let n = world.normal(touch, face);
        let before = world.gap(touch, face, &start.x, step, 0.0);
        let after = world.gap(touch, face, &flown.x, step, 1.0);
        let rate = dot(n, &world.relative(touch, &flown.v, step));
        self.refuse(step, &format!("{name}: hits from behind (m)"), -before, MISS)?;
        self.refuse(step, &format!("{name}: hits without reaching it (m)"), after, MISS)?;
        self.refuse(step, &format!("{name}: hits while moving away (m/s)"), rate, MISS)?;
        for (state, part, gap) in [(start, 0.0, before), (flown, 1.0, after)] {
            // The point of the face nearest to the body must be in no other face's front.
            let (body, _) = world.shares(touch)[0];
            let mut x = state.x.clone();
            x[body].iter_mut().zip(n).for_each(|(x, n)| *x -= gap * n);
            for other in (0..world.faces(touch)).filter(|&k| k != face) {
                let beside = world.gap(touch, other, &x, step, part);
                let across = dot(world.normal(touch, other), n);
                if across.abs() < 1.0 - 1e-12 {
                    let what = format!("{name}: hits beside face {face} (m)");
                    self.refuse(step, &what, beside, 10.0 * MISS)?;
                }
            }
        }
        let beyond = self.beyond_edge(step, touch, face, flown);
        let what = format!("{name}: leaves in front of another face, not through face {face}, (m)");
        self.refuse(step, &what, beyond, 10.0 * MISS)
    }

    /// For a step that starts in the edge of its face and another one at an acute angle: how far it
    /// goes in front of the other one, in m.
    fn beyond_edge(&self, step: usize, touch: Touch, face: usize, flown: &State) -> f64 {
        let world = &self.world;
        let start = &self.samples[step];
        let is_at = |k: usize| world.gap(touch, k, &start.x, step, 0.0) >= -10.0 * MISS;
        if world.gap(touch, face, &start.x, step, 0.0) > 10.0 * MISS {
            return 0.0;
        }
        let half = 0.5 * world.scene.time_step;
        let mut middle = start.x.clone();
        for (x, v) in middle.iter_mut().zip(&start.v) {
            x.iter_mut().zip(v).for_each(|(x, v)| *x += half * v);
        }
        let others = (0..world.faces(touch)).filter(|&other| {
            let across = dot(world.normal(touch, other), world.normal(touch, face));
            across < -1e-9 && across > -1.0 + 1e-12 && is_at(other)
        });
        let beyond = others.map(|other| {
            let before = world.gap(touch, other, &start.x, step, 0.0);
            let after = world.gap(touch, other, &flown.x, step, 1.0);
            match world.scene.estimate {
                ImpactEstimate::EndOfStep => after + SHARP * before,
                ImpactEstimate::Sound => {
                    let middle = world.gap(touch, other, &middle, step, 0.5) + SHARP * before;
                    // The row that keeps the end behind may miss as much as the factor enlarges.
                    middle.max((after + SHARP * middle) / SHARP)
                }
            }
        });
        beyond.fold(0.0, f64::max)
    }
}
