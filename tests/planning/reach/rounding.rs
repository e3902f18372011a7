//! Rounding margins at small steps and far from the origin.
//!
//! With Δt = 2^-13 s, accelerations in eighths and e = 1/2, every number of a run is a short binary
//! fraction, so that the run is computed without any rounding: what the sets lose to rounding has
//! nowhere to hide, even with their margin set to 0.

use crate::common::config;
use crate::rows::wall::reflecting;
use carom::collision_tolerant::Wall;
use carom::hybrid::HybridSystem;
use carom::hybrid::reach::{ReachSets, SetOptions};
use carom::interval::Interval;
use proptest::prelude::*;

const DT: f64 = 1.0 / 8192.0;

struct Ball {
    wall: f64,
    normal: f64,
}

impl Ball {
    fn system(&self, accelerations: Interval, dt: f64) -> HybridSystem {
        let wall = if self.normal > 0.0 { Wall::above(self.wall) } else { Wall::below(self.wall) };
        let [flight, impact] = reflecting(wall.unwrap(), 0.5, dt, None);
        let far = self.wall + 1e4 * self.normal;
        HybridSystem::new(1.0)
            .with_state("x", Interval::new(self.wall.min(far), self.wall.max(far)))
            .with_state("v", Interval::new(-20.0, 20.0))
            .with_input("a", accelerations)
            .with_transition(flight)
            .with_transition(impact)
    }

    /// One step of the reflecting law; whether it was an impact, and whether it is admissible.
    fn step(&self, [x, v]: [f64; 2], a: f64, dt: f64) -> ([f64; 2], bool, bool) {
        let (p, w) = (x + dt * v + 0.5 * dt * dt * a, v + dt * a);
        if self.normal * (p - self.wall) >= 0.0 {
            return ([p, w], false, w.abs() <= 20.0);
        }
        ([self.wall - 0.5 * (p - self.wall), -0.5 * w], true, self.normal * w <= 0.0)
    }
}

fn point([x, v]: [f64; 2]) -> [Interval; 2] {
    [Interval::point(x), Interval::point(v)]
}

proptest! {
    #![proptest_config(config(8, "tests/regressions/reach.txt"))]

    #[test]
    fn exact_runs_stay_in_sets_without_a_margin(
        wall in prop_oneof![Just(0.0), Just(8192.0), Just(-8192.0)],
        up in any::<bool>(),
        gap in 1..64_u32,
        pushes in prop::collection::vec((-8..=8_i32, 20..200_usize), 8),
        vertices in prop_oneof![Just(32_usize), Just(256)],
    ) {
        let ball = Ball { wall, normal: if up { 1.0 } else { -1.0 } };
        let start = [wall + ball.normal * f64::from(gap) / 128.0, -2.0 * ball.normal];
        let options = SetOptions::default().with_margin(0.0).with_vertices(vertices);
        let system = ball.system(Interval::new(-1.0, 1.0), DT);
        let mut sets = ReachSets::new(&system, point(start), point(start), options).unwrap();
        let (mut state, mut events, mut t) = (start, 0_usize, 0);
        for (eighths, steps) in pushes {
            for _ in 0..steps {
                let (next, hit, fine) = ball.step(state, f64::from(eighths) / 8.0, DT);
                if !fine || (hit && events >= 3) {
                    // More impacts would need more digits than there are.
                    return Ok(());
                }
                (state, events, t) = (next, events + usize::from(hit), t + 1);
                if hit || t % 50 == 0 {
                    let set = sets.forward(t).unwrap().swap_remove(events).expect("a run is here");
                    prop_assert!(set.contains(&state).unwrap(), "step {t}: {state:?}");
                }
            }
        }
    }

    #[test]
    fn runs_at_a_tenth_of_a_millisecond_stay_in_the_sets_and_back(
        wall in prop_oneof![Just(0.0), Just(1e4), Just(-1e4)],
        pushes in prop::collection::vec((-6.0..6.0_f64, 20..150_usize), 6),
    ) {
        let (ball, dt) = (Ball { wall, normal: 1.0 }, 1e-4);
        let start = [wall + 0.05, -3.0];
        let mut run = vec![(start, false)];
        for (a, steps) in pushes {
            for _ in 0..steps {
                let (next, hit, fine) = ball.step(run[run.len() - 1].0, a, dt);
                if fine {
                    run.push((next, hit));
                }
            }
        }
        let (steps, goal) = (run.len() - 1, run[run.len() - 1].0);
        let system = ball.system(Interval::new(-6.0, 6.0), dt);
        let options = SetOptions::default();
        let mut sets = ReachSets::new(&system, point(start), point(goal), options).unwrap();
        let tube = sets.tube(steps).unwrap();
        prop_assert!(!tube.is_empty());
        for (t, (state, _)) in run.iter().enumerate() {
            let bounds = tube.bounds(t).unwrap();
            prop_assert!(bounds.iter().zip(state).all(|(range, &value)| range.contains(value)));
        }
        for (t, (_, hit)) in run.iter().enumerate().skip(1) {
            prop_assert!(tube.is_possible(t - 1, usize::from(*hit)), "step {}", t - 1);
        }
    }
}

#[test]
fn rounding_loosens_sets_by_very_little() {
    // A single run, 10 000 steps of 0.1 ms at 10 km: no input, no margin, so nothing but rounding
    // makes the set larger than a point.
    let ball = Ball { wall: 1e4, normal: 1.0 };
    let (dt, start) = (1e-4, [1e4 + 5.0, -3.0]);
    let system = ball.system(Interval::point(0.0), dt);
    let options = SetOptions::default().with_margin(0.0);
    let mut sets = ReachSets::new(&system, point(start), point(start), options).unwrap();
    let set = sets.forward(10_000).unwrap().swap_remove(0).expect("it is still in flight");
    let [x, v] = set.bounding_box()[..] else { panic!("two states") };
    assert!(x.contains(1e4 + 2.0) && x.width() < 1e-6, "{x:?}");
    assert!(v.contains(-3.0) && v.width() < 1e-9, "{v:?}");
    // The set says itself how much that is.
    let margin = set.margin();
    assert!(margin[0] > 0.0 && x.width() <= 2.1 * margin[0] && margin[1] <= v.width());
}
