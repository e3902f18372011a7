//! What must not change the shortest plan, and what may only change it one way.

use proptest::prelude::*;
use proptest::sample::select;

use super::brute_force::ShortestHorizon;
use super::scenes::{End, Scene, scene};
use super::{REGRESSIONS, clear_answer};
use crate::common::config;

const MAX_STEPS: usize = 9;

fn random() -> impl Strategy<Value = Scene> {
    scene(6)
}

/// The answers to two scenes.
fn both(a: &Scene, b: &Scene) -> Result<(ShortestHorizon, ShortestHorizon), TestCaseError> {
    Ok((clear_answer(&a.plain(), MAX_STEPS)?, clear_answer(&b.plain(), MAX_STEPS)?))
}

/// Shortest horizon; endless when there is none.
fn steps(answer: ShortestHorizon) -> usize {
    match answer {
        ShortestHorizon::Found { steps, .. } => steps,
        _ => usize::MAX,
    }
}

/// An interval that is smaller by a share at both ends but still holds some values.
fn shrunk((lower, upper): (f64, f64), share: f64, held: &[f64]) -> (f64, f64) {
    let margin = 0.5 * share * (upper - lower);
    let held = |start: f64, pick: fn(f64, f64) -> f64| held.iter().copied().fold(start, pick);
    (held(lower + margin, f64::min), held(upper - margin, f64::max))
}

/// One limit tightened by a share, as far as start and goal allow.
fn tightened(scene: &Scene, which: usize, share: f64) -> Scene {
    let mut other = *scene;
    let (start, goal) = (scene.start, scene.goal);
    let pulls: Vec<f64> = [start.pull, goal.pull].into_iter().flatten().collect();
    let fastest = start.rate.abs().max(goal.rate.abs());
    match which {
        0 => other.limits = shrunk(scene.limits, share, &pulls),
        1 => other.per_impact = Some((1.0 - share) * scene.per_impact.unwrap_or(4.0)),
        2 => other.cumulative = Some((1.0 - share) * scene.cumulative.unwrap_or(5.0)),
        3 => {
            let speed = if scene.max_speed < 64.0 { scene.max_speed } else { fastest + 2.0 };
            other.max_speed = fastest + (1.0 - share) * (speed - fastest);
        }
        4 => {
            let domain = scene.domain.unwrap_or((0.0, 2.0 * start.gap.max(goal.gap) + 1.0));
            other.domain = Some(shrunk(domain, share, &[start.gap, goal.gap]));
        }
        _ => other.start.pull = start.pull.or(Some(shrunk(scene.limits, share, &[]).0)),
    }
    other
}

proptest! {
    #![proptest_config(config(60, REGRESSIONS))]

    #[test]
    fn where_the_wall_stands_and_faces(
        scene in random(),
        at in select(vec![0.0, 0.3, -1.0, 5.5, -40.7, 250.0]),
        side in select(vec![1.0, -1.0]),
    ) {
        let plain = clear_answer(&scene.plain(), MAX_STEPS)?;
        let moved = clear_answer(&scene.beside(at, side), MAX_STEPS)?;
        prop_assert_eq!(plain, moved, "{:?} at {}, {}", scene, at, side);
    }

    #[test]
    fn the_unit_of_length(scene in random(), factor in select(vec![0.25, 0.5, 2.0, 16.0, 64.0])) {
        let (one, other) = both(&scene, &scene.in_lengths(factor))?;
        prop_assert_eq!(one, other, "{:?} times {}", scene, factor);
    }

    #[test]
    fn the_unit_of_time(scene in random(), factor in select(vec![0.25, 0.5, 2.0, 8.0])) {
        let (one, other) = both(&scene, &scene.in_times(factor))?;
        prop_assert_eq!(one, other, "{:?} times {}", scene, factor);
    }

    #[test]
    fn tighter_limits_never_shorten_a_plan(
        scene in random(),
        which in 0..6_usize,
        share in select(vec![0.01, 0.1, 0.3, 0.7]),
    ) {
        let tight = tightened(&scene, which, share);
        let (loose, strict) = both(&scene, &tight)?;
        prop_assert!(steps(loose) <= steps(strict), "{loose:?} {strict:?} {scene:?} {tight:?}");
    }

    #[test]
    fn impacts_are_made_only_to_be_faster(scene in random()) {
        let forbidden = Scene { collisions: false, ..scene };
        let tolerated = Scene { collisions: true, ..scene };
        let (careful, tolerant) = both(&forbidden, &tolerated)?;
        match tolerant {
            ShortestHorizon::Found { impacts: 1.., steps: fast } => prop_assert!(fast < steps(careful)),
            _ => prop_assert_eq!(careful, tolerant),
        }
        // Damage is done by impacts only.
        let undamaged = Scene { per_impact: Some(0.0), ..tolerated };
        let strict = clear_answer(&undamaged.plain(), MAX_STEPS)?;
        prop_assert!(steps(strict) <= steps(careful) && steps(tolerant) <= steps(strict));
    }

    /// Free flight run backwards is free flight.
    #[test]
    fn collision_free_plans_run_backwards(scene in random()) {
        let back = |end: End| End { rate: -end.rate, pull: None, ..end };
        let ahead = |end: End| End { pull: None, ..end };
        let (start, goal) = (scene.start, scene.goal);
        let forth = Scene { start: ahead(start), goal: ahead(goal), collisions: false, ..scene };
        let reversed = Scene { start: back(goal), goal: back(start), ..forth };
        let (one, other) = both(&forth, &reversed)?;
        prop_assert_eq!(one, other, "{:?}", forth);
    }
}
