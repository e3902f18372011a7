//! The replay of scenes on a line against closed forms, conservation laws and the discretisation
//! bounds.

use crate::common::config;
use carom::collision_tolerant::{ContactLaw, Endpoint, Objective, Scenario, Wall};
use carom::hybrid::scene::{Body, Scene, Solid, Surface};
use carom::hybrid::{ImpactEstimate, Restitution};
use carom::interval::Interval;
use carom::prelude::*;
use carom_hybrid::internals::{Samples, advance_line, replay_line as replay};
use proptest::prelude::*;

/// Largest depth inside the wall, in m, of a parabola between two samples outside the wall.
fn penetration_bound(max_acceleration: f64, time_step: f64) -> f64 {
    max_acceleration * time_step * time_step / 8.0
}

/// Largest difference of speeds between the reflecting law and continuous contact over one step.
fn speed_bound(max_acceleration: f64, time_step: f64, restitution: f64) -> f64 {
    (1.0 + restitution) * max_acceleration * time_step
}

/// A point at a wall, as the paper counts its impacts.
fn scene(wall: Wall, e: f64, time_step: f64) -> Scene {
    let n = wall.normal();
    let surface = Surface::bounce(Restitution::new(e).unwrap());
    Scene::new(time_step)
        .with_body(Body::new("ball", [Interval::new(-1e6, 1e6)], 1e6, 1e13))
        .with_obstacle(Solid::halfspace("wall", [n], n * wall.position(), surface))
        .with_estimate(ImpactEstimate::EndOfStep)
}

/// What is left of a body after a step, in gap and rate.
#[derive(Debug)]
struct Advance {
    gap: f64,
    rate: f64,
    impacts: Vec<(f64, f64)>,
    rested: bool,
}

/// A body at a wall at 0 m under a constant acceleration, for a time.
fn advance(gap: f64, rate: f64, acceleration: f64, duration: f64, e: f64) -> Advance {
    let scene = scene(Wall::default(), e, duration);
    let ([gap, rate], impacts, rested) = advance_line(&scene, [gap, rate], acceleration);
    Advance { gap, rate, impacts, rested }
}

// -- continuous contact -------------------------------------------------------------------------

#[test]
fn a_dropped_ball_rebounds_to_e_squared_of_its_height() {
    for e in [0.0, 0.3, 0.5, 0.9, 1.0] {
        let (height, gravity): (f64, f64) = (2.0, 10.0);
        let fall = (2.0 * height / gravity).sqrt();
        let rise = e * fall;
        let apex = advance(height, 0.0, -gravity, fall + rise, e);
        assert!((apex.gap - e * e * height).abs() < 1e-9, "e = {e}: {apex:?}");
        assert!(apex.rate.abs() < 1e-9);
        let (time, speed) = apex.impacts[0];
        assert!((time - fall).abs() < 1e-12 && (speed - gravity * fall).abs() < 1e-12);
    }
}

#[test]
fn bounces_that_pile_up_end_in_rest() {
    // All bounces of an e = 1/2 ball are over after fall (1 + 2 e / (1 - e)) = 3 falls.
    let fall = (2.0_f64 * 2.0 / 10.0).sqrt();
    let before = advance(2.0, 0.0, -10.0, 2.99 * fall, 0.5);
    assert!(!before.rested);
    let after = advance(2.0, 0.0, -10.0, 3.0 * fall + 1.0, 0.5);
    assert!(after.rested && after.gap == 0.0 && after.rate == 0.0);
    assert!(after.impacts.len() < 60);
    assert!((after.impacts.last().unwrap().0 - 3.0 * fall).abs() < 1e-6);
}

#[test]
fn an_elastic_ball_keeps_its_energy_through_many_bounces() {
    let energy = |gap: f64, rate: f64| 0.5 * rate * rate + 10.0 * gap;
    let ball = advance(1.0, -2.0, -10.0, 50.0, 1.0);
    assert!(ball.impacts.len() > 20);
    assert!((energy(ball.gap, ball.rate) - energy(1.0, -2.0)).abs() < 1e-9);
}

#[test]
fn huge_accelerations_cost_bounded_work() {
    let ball = advance(1e-9, 0.0, -1e12, 1.0, 1.0);
    assert!(ball.rested && ball.impacts.len() <= carom::tolerance::MAX_BOUNCES);
}

#[test]
fn grazing_and_leaving_are_no_impacts() {
    assert!(advance(1.0, -2.0, 2.0, 5.0, 0.5).impacts.is_empty()); // turns exactly at the wall
    assert!(advance(0.0, 0.0, 2.0, 1.0, 0.5).impacts.is_empty()); // pulled away
    assert!(advance(0.0, 3.0, 0.0, 1.0, 0.5).impacts.is_empty()); // leaves
    assert!(advance(0.0, 0.0, 0.0, 1.0, 0.5).impacts.is_empty()); // stays
    let pressed = advance(0.0, 0.0, -1.0, 1.0, 0.5);
    assert!(pressed.rested && pressed.impacts.is_empty());
}

/// The closed form: roots of the gap's parabola, bounce by bounce, to gap and rate at the end and
/// the times of the impacts. `None` if bounces pile up.
fn closed_form(start: (f64, f64), a: f64, duration: f64, e: f64) -> Option<(f64, f64, Vec<f64>)> {
    let (mut gap, mut rate) = start;
    let (mut elapsed, mut times) = (0.0, Vec::new());
    while times.len() < 20 {
        let hit = match gap {
            0.0 if rate < 0.0 => Some(0.0),
            0.0 => (a < 0.0 && rate > 0.0).then(|| -2.0 * rate / a),
            _ => {
                let under = rate * rate - 2.0 * a * gap;
                let speed = under.max(0.0).sqrt();
                match () {
                    _ if under <= 0.0 => None,
                    _ if rate < 0.0 => Some(2.0 * gap / (speed - rate)),
                    _ if a < 0.0 => Some(-(rate + speed) / a),
                    _ => None,
                }
            }
        };
        let Some(after) = hit.filter(|after| elapsed + after <= duration) else {
            let rest = duration - elapsed;
            return Some((gap + rest * (rate + 0.5 * a * rest), rate + a * rest, times));
        };
        elapsed += after;
        times.push(elapsed);
        (gap, rate) = (0.0, -e * (rate + a * after));
    }
    None
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/physics.txt"))]

    /// Walls anywhere, facing either way, are hit when and how the closed form says.
    #[test]
    fn located_impacts_are_those_of_the_closed_form(
        at in -50.0..50.0_f64,
        above in any::<bool>(),
        gap in 0.01..1.0_f64,
        rate in -5.0..5.0_f64,
        a in -8.0..8.0_f64,
        duration in 0.01..1.0_f64,
        e in 0.2..=1.0_f64,
    ) {
        let wall = if above { Wall::above(at) } else { Wall::below(at) }.unwrap();
        let expected = closed_form((gap, rate), a, duration, e);
        prop_assume!(expected.is_some());
        let (end, speed, times) = expected.unwrap();
        // An impact at the very end may be counted or not.
        prop_assume!(times.iter().all(|time| duration - time > 1e-6) && end > 1e-6);
        let start = [wall.at_gap(gap), wall.rate(rate)];
        let scene = scene(wall, e, duration);
        let ([x, v], impacts, rested) = advance_line(&scene, start, wall.rate(a));
        prop_assert!(!rested);
        prop_assert_eq!(impacts.len(), times.len());
        for ((time, _), expected) in impacts.iter().zip(&times) {
            prop_assert!((time - expected).abs() < 1e-9, "{time} {expected}");
        }
        prop_assert!((wall.gap(x) - end).abs() < 1e-8 && (wall.rate(v) - speed).abs() < 1e-8);
    }

    /// Never inside the wall, never more energy than before, however it bounces.
    #[test]
    fn continuous_contact_dissipates(
        gap in 0.0..1.0_f64,
        rate in -5.0..5.0_f64,
        acceleration in -8.0..8.0_f64,
        duration in 0.001..1.0_f64,
        e in 0.0..=1.0_f64,
    ) {
        let end = advance(gap, rate, acceleration, duration, e);
        let energy = |gap: f64, rate: f64| 0.5 * rate * rate - acceleration * gap;
        let mut lost = 0.0;
        for &(time, speed) in &end.impacts {
            prop_assert!(time >= 0.0 && time <= duration && speed >= 0.0);
            lost += 0.5 * (1.0 - e * e) * speed * speed;
        }
        prop_assert!(end.gap >= 0.0);
        let expected = energy(gap, rate) - lost;
        prop_assert!((energy(end.gap, end.rate) - expected).abs() < 1e-9 * (1.0 + expected.abs()));
    }

    /// One step of the reflecting law against continuous contact: the speeds differ by at most
    /// (1+e) a_max Δt, a step in flight dips by at most a_max Δt²/8.
    #[test]
    fn one_step_stays_within_the_theory(
        above in any::<bool>(),
        e in 0.0..=1.0_f64,
        reach in 0.0..2.0_f64,
        rate in -4.0..4.0_f64,
        acceleration in -6.0..6.0_f64,
        dt in 0.001..0.2_f64,
    ) {
        let wall = if above { Wall::above(1.5) } else { Wall::below(-0.5) }.unwrap();
        let gap = reach * rate.abs() * dt;
        let (p, w) = (gap + dt * rate + 0.5 * dt * dt * acceleration, rate + dt * acceleration);
        prop_assume!(p >= 0.0 || w <= 0.0); // otherwise the law has no successor
        let hit = p < 0.0;
        let (next_gap, next_rate) = if hit { (-e * p, -e * w) } else { (p, w) };
        let plan = Samples {
            position: &[wall.at_gap(gap), wall.at_gap(next_gap)],
            velocity: &[wall.rate(rate), wall.rate(next_rate)],
            acceleration: &[wall.rate(acceleration)],
            contact: &[hit],
        };
        let (_, replay) = replay(&scene(wall, e, dt), &plan).unwrap();
        let speed = speed_bound(6.0, dt, e);
        prop_assert!(replay.dip <= penetration_bound(6.0, dt) + 1e-12);
        prop_assert!(replay.step_speed_error <= speed + 1e-5, "{replay:?} against {speed}");
        prop_assert!(replay.step_error <= speed * dt + 1e-5, "{replay:?}");
        prop_assert!(replay.largest_residual <= 1e-9 && replay.drift <= 1e-9);
    }
}

// -- the law at samples
// ----------------------------------------------------------------------------

/// Runs the reflecting law in plain numbers from a start, in gap and rate, for any inputs.
fn run(e: f64, dt: f64, start: (f64, f64), inputs: &[f64]) -> (Vec<f64>, Vec<f64>, Vec<bool>) {
    let (mut gap, mut rate) = start;
    let (mut gaps, mut rates, mut hits) = (vec![gap], vec![rate], vec![]);
    for &a in inputs {
        let (p, w) = (gap + dt * rate + 0.5 * dt * dt * a, rate + dt * a);
        let hit = p < 0.0 && w <= 0.0;
        // (Behind the wall on the way out: put it on the wall. Tests below avoid that case.)
        (gap, rate) = if hit { (-e * p, -e * w) } else { (p.max(0.0), w) };
        gaps.push(gap);
        rates.push(rate);
        hits.push(hit);
    }
    (gaps, rates, hits)
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/physics.txt"))]

    /// Energy after an impact is e² of the energy before, the impulse is (1+e) times the speed,
    /// and the replay finds exactly the impacts of the run.
    #[test]
    fn impacts_obey_restitution(
        e in 0.0..=1.0_f64,
        gap in 0.1..2.0_f64,
        rate in -4.0..0.0_f64,
        inputs in prop::collection::vec(-3.0..-0.1_f64, 1..40),
    ) {
        let dt = 0.1;
        let (position, velocity, hits) = run(e, dt, (gap, rate), &inputs);
        let plan = Samples {
            position: &position,
            velocity: &velocity,
            acceleration: &inputs,
            contact: &hits,
        };
        let scene = scene(Wall::default(), e, dt);
        let (impacts, certificate) = replay(&scene, &plan).unwrap();
        prop_assert!(certificate.drift <= 1e-6);
        prop_assert_eq!(impacts.len(), hits.iter().filter(|&&hit| hit).count());
        for impact in &impacts {
            prop_assert!(hits[impact.step] && impact.end_speed >= 0.0);
            let t = impact.step;
            let w = velocity[t] + dt * inputs[t];
            prop_assert!((impact.end_speed + w).abs() < 1e-9);
            prop_assert!((impact.impulse[0] - (velocity[t + 1] - w)).abs() < 1e-9);
            let lost = 0.5 * (1.0 - e * e) * impact.end_speed.powi(2);
            prop_assert!((impact.energy - lost).abs() < 1e-9);
            // Without it, or with one more at which nothing is hit, it is no plan of the scene.
            let flown = position[t] + dt * velocity[t] + 0.5 * dt * dt * inputs[t];
            if flown < -1e-5 {
                let mut claimed = hits.clone();
                claimed[t] = false;
                let plan = Samples { contact: &claimed, ..plan };
                prop_assert!(replay(&scene, &plan).is_err());
            }
        }
        if let Some(t) = (0..inputs.len()).find(|&t| !hits[t] && position[t + 1] > 1e-5) {
            let mut claimed = hits.clone();
            claimed[t] = true;
            let plan = Samples { contact: &claimed, ..plan };
            prop_assert!(replay(&scene, &plan).is_err());
        }
    }
}

#[test]
fn the_replay_decides_impacts_by_itself() {
    // The plan claims to fly on at -2 m/s through the floor.
    let floor = scene(Wall::default(), 0.5, 1.0);
    let plan = Samples {
        position: &[1.0, -1.0],
        velocity: &[-2.0, -2.0],
        acceleration: &[0.0],
        contact: &[false],
    };
    assert_eq!(
        replay(&floor, &plan).unwrap_err().to_string(),
        "step 0 of the plan is not what the scene does: ball at wall: the next sample is inside (m) \
         by 1; at most 0.000002"
    );
    let plan = Samples { position: &[1.0, 0.5], velocity: &[-2.0, 1.0], ..plan };
    assert_eq!(
        replay(&floor, &plan).unwrap_err().to_string(),
        "step 0 of the plan is not what the scene does: ball at wall: enters without a hit (m) by \
         1; at most 0.000002"
    );
    replay(&floor, &Samples { contact: &[true], ..plan }).unwrap();
}

#[test]
fn at_the_wall_the_plan_has_its_say() {
    for hit in [false, true] {
        let velocity = if hit { [-2.0, 1.0] } else { [-2.0, -2.0] };
        let plan = Samples {
            position: &[2.0, 0.0],
            velocity: &velocity,
            acceleration: &[0.0],
            contact: &[hit],
        };
        let (hits, certificate) = replay(&scene(Wall::default(), 0.5, 1.0), &plan).unwrap();
        assert_eq!(hits.len(), usize::from(hit));
        assert!(certificate.largest_residual <= 1e-9 && certificate.drift <= 1e-9);
        // The impact is in the step in which the plan has it.
        assert!(certificate.step_speed_error <= 1e-9, "{certificate:?}");
    }
}

#[test]
fn a_parabola_that_ends_behind_the_wall_on_the_way_out_has_no_successor() {
    let plan = Samples {
        position: &[0.5, 0.0],
        velocity: &[-3.0, 0.0],
        acceleration: &[4.0],
        contact: &[true],
    };
    for contact in [[true], [false]] {
        let plan = Samples { contact: &contact, ..plan };
        assert!(replay(&scene(Wall::default(), 1.0, 1.0), &plan).is_err());
    }
}

#[test]
fn the_literal_law_sinks_into_the_wall() {
    // It turns the velocity round while the vehicle moves Δt |v| (1-e)/2 farther in, again and
    // again: with e = 0 it never comes out.
    let rest = Endpoint::at_rest(0.5);
    let scenario = Scenario::new(rest, rest, Wall::default(), -30.0..=30.0, 3.0, 0.1);
    let system = scenario.with_law(ContactLaw::Literal).hybrid_system().unwrap();
    let run = system.simulate(&[-0.1, -2.0], &[[20.0], [0.0]]).unwrap();
    assert!(run.is_complete() && run.events() == 2, "{run}");
    let x = run.state("vehicle x").unwrap();
    let expected = [-0.1, -0.2, -0.2];
    assert!(x.iter().zip(expected).all(|(x, y)| (x - y).abs() < 1e-12), "{x:?}");
}

#[test]
fn bad_samples_are_refused() {
    let good = Samples {
        position: &[2.0, 2.0],
        velocity: &[0.0, 0.0],
        acceleration: &[0.0],
        contact: &[false],
    };
    let text = |time_step: f64, plan: Samples<'_>| {
        replay(&scene(Wall::default(), 0.5, time_step), &plan).unwrap_err().to_string()
    };
    assert_eq!(
        text(1.0, Samples { position: &[2.0], ..good }),
        "the length of the positions of a body is 1; it must be 2"
    );
    assert_eq!(
        text(1.0, Samples { velocity: &[0.0, f64::NAN], ..good }),
        "a velocity of `the plan` is NaN; give a finite number"
    );
    assert_eq!(text(0.0, good), "the time step (s) is 0; it must be finite and positive");
}

// -- whole plans --------------------------------------------------------------------------------

/// What the discretisation leaves out of real plans shrinks as the theory says.
#[test]
fn plans_meet_continuous_time_as_the_step_shrinks() {
    for e in [0.0, 0.5] {
        for (dt, steps) in [(0.1, 26), (0.05, 52), (0.025, 104)] {
            let scenario = Scenario::paper().with_time_step(dt).with_restitution(e).unwrap();
            // 2.6 s leave time; the cheapest plan uses the wall as a brake.
            let mut solver = BranchAndBound::default();
            let plan = scenario.plan(steps, Objective::Effort, &mut solver).unwrap();
            assert!(!plan.trajectory.impacts.is_empty());
            let report = &plan.certificate;
            assert!(report.dip <= penetration_bound(6.0, dt) + 1e-6);
            assert!(report.step_speed_error <= speed_bound(6.0, dt, e) + 1e-6);
            assert!(report.step_error <= speed_bound(6.0, dt, e) * dt + 1e-6);
            for impact in &plan.trajectory.impacts {
                let (t, a) = (impact.step, plan.trajectory.acceleration[impact.step]);
                let flown = plan.trajectory.velocity[t] + dt * a;
                assert!((impact.impulse - (plan.trajectory.velocity[t + 1] - flown)).abs() < 1e-5);
                let lost = 0.5 * (1.0 - e * e) * flown * flown;
                assert!((impact.energy_lost - lost).abs() < 1e-4);
            }
        }
    }
}
