//! The paper's scenario in other units and from other origins: the same plans.

use carom::collision_tolerant::{Endpoint, Objective, Scenario, Wall};
use carom::hybrid::ImpactEstimate;
use carom::hybrid::scene::{DamageMeasure, DamageRule};
use carom::prelude::*;
use proptest::prelude::*;

use super::Units;
use crate::common::config;

/// A scenario in metres and seconds.
#[derive(Debug, Clone, Copy)]
struct Task {
    start: [f64; 2],
    goal: f64,
    restitution: f64,
    per_hit: Option<f64>,
    energy: bool,
    is_sound: bool,
    is_above: bool,
}

const DT: f64 = 0.1;

impl Task {
    fn scenario(&self, units: Units) -> Result<Scenario, Error> {
        let Units { length, time, origin } = units;
        let speed = length / time;
        let side = if self.is_above { 1.0 } else { -1.0 };
        let at = |gap: f64| length * (origin + side * gap);
        let wall = if self.is_above { Wall::above(at(0.0))? } else { Wall::below(at(0.0))? };
        let [gap, rate] = self.start;
        let start = Endpoint::at_rest(at(gap)).with_velocity(side * rate * speed);
        let a = 6.0 * speed / time;
        let goal = Endpoint::at_rest(at(self.goal));
        let scenario = Scenario::new(start, goal, wall, -a..=a, 15.0 * speed, DT * time)
            .with_restitution(self.restitution)?;
        let (measure, unit) = match self.energy {
            true => (DamageMeasure::DissipatedEnergy, speed * speed),
            false => (DamageMeasure::ImpactSpeed, speed),
        };
        let mut rule = DamageRule::new("bumper", measure);
        rule.per_hit = self.per_hit.map(|most| most * unit);
        let scenario = scenario.with_damage(rule);
        let estimate =
            if self.is_sound { ImpactEstimate::Sound } else { ImpactEstimate::EndOfStep };
        Ok(scenario.with_estimate(estimate))
    }
}

/// The steps, the contacts, and the least effort and damage at that horizon in m and s, each with
/// what the absolute gap allows.
fn answer(task: Task, units: Units) -> Result<(usize, usize, [[f64; 2]; 2]), Error> {
    let scenario = task.scenario(units)?;
    let (options, mut solver) = (ShortestOptions::default(), BranchAndBound::default());
    let found = scenario.shortest_with(&options, &mut solver)?;
    let steps = found.steps.expect("a plan");
    assert_eq!(found.refuted_steps, Some(steps - 1));
    let hits = found.plan.expect("a plan").trajectory.impacts.len();
    let speed = units.length / units.time;
    let mut costs = [[0.0; 2]; 2];
    let objectives =
        [(Objective::Effort, speed * speed / units.time), (Objective::LargestDamage, speed)];
    for (cost, (objective, unit)) in costs.iter_mut().zip(objectives) {
        let mut program = scenario.program(steps + 2, objective)?;
        // A row of one's own, in one's own units.
        program.add("slow", program.velocity[steps / 2].within(-8.0 * speed, 8.0 * speed))?;
        let plan = program.solve(&mut solver)?;
        let trajectory = &plan.trajectory;
        let last = trajectory.position[trajectory.steps()];
        assert!(
            (last - scenario.goal.position).abs() <= 1e-6 * units.length.max(1e-9 * last.abs())
        );
        *cost = [plan.solution.objective().unwrap() / unit, solver.options().absolute_gap / unit];
    }
    Ok((steps, hits, costs))
}

fn task() -> impl Strategy<Value = Task> {
    let numbers = (2.0..6.0, -4.0..1.0, 0.1..1.0, 0.0..0.8);
    let switches = (any::<bool>(), any::<bool>(), any::<bool>());
    (numbers, prop::option::of(2.0..6.0), switches).prop_map(|(numbers, per_hit, switches)| {
        let ((gap, rate, goal, restitution), (energy, is_sound, is_above)) = (numbers, switches);
        Task { start: [gap, rate], goal, restitution, per_hit, energy, is_sound, is_above }
    })
}

fn units() -> impl Strategy<Value = Units> {
    let origin = prop_oneof![Just(0.0), (1.0..8.0_f64).prop_map(|e| 10.0_f64.powf(e))];
    (-9.0..9.0_f64, -3.0..9.0_f64, origin).prop_map(|(length, time, origin)| Units {
        length: 10.0_f64.powf(length),
        time: 10.0_f64.powf(time),
        origin,
    })
}

proptest! {
    #![proptest_config(config(8, "tests/regressions/scenario_units.txt"))]

    #[test]
    fn units_and_origins_change_nothing(task in task(), units in units()) {
        let (steps, hits, costs) = answer(task, Units::ORDINARY).unwrap();
        let (own_steps, own_hits, own_costs) = answer(task, units).unwrap();
        prop_assert_eq!((steps, hits), (own_steps, own_hits), "{:?}", units);
        for ([cost, gap], [own, own_gap]) in costs.into_iter().zip(own_costs) {
            let allowed = 1e-4 * cost.abs().max(1.0) + gap + own_gap;
            prop_assert!((cost - own).abs() <= allowed, "{} {} {:?}", cost, own, units);
        }
    }
}

/// What is so far away that floats cannot tell its places apart is refused by name.
#[test]
fn places_beyond_the_digits_are_refused() {
    let far = Scenario::new(
        Endpoint::at_rest(1e12 + 10.0),
        Endpoint::at_rest(1e12 + 0.3),
        Wall::above(1e12).unwrap(),
        -6.0..=6.0,
        15.0,
        0.05,
    );
    let error = far.check().unwrap_err().to_string();
    assert!(error.contains("`vehicle x`") && error.contains("another origin"), "{error}");
}
