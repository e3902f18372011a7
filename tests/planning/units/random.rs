//! Random systems and scenes in random units: the same steps and hits as in ordinary ones.
//!
//! `CAROM_UNITS=500` tries 500 of each in ten units each.

use carom::hybrid::scene::{Body, Scene, Shape, Solid, Surface};
use carom::hybrid::{Restitution, ShortestOptions};
use carom::prelude::*;

use super::Units;

/// Numbers from a seed (Steele, Lea and Flood's SplitMix).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    fn is_so(&mut self, share: f64) -> bool {
        self.next() < share
    }

    /// From 1e-9 to 1e9: powers of ten and of two, and others; or another origin.
    fn units(&mut self) -> Units {
        let mut unit = || match (self.next() * 3.0) as usize {
            0 => 10.0_f64.powi(self.within(-9.0, 9.99).floor() as i32),
            1 => 2.0_f64.powi(self.within(-29.0, 29.0) as i32),
            _ => 10.0_f64.powf(self.within(-9.0, 9.0)),
        };
        let (length, time) = (unit(), unit());
        match (self.next() * 3.0) as usize {
            0 => Units { origin: 10.0_f64.powf(self.within(1.0, 8.0)), ..Units::ORDINARY },
            1 => Units { length, time, origin: self.within(-1.0, 1.0) * 1e6 },
            _ => Units::new(length, time),
        }
    }
}

/// How many random cases, and in how many units each.
fn counts(few: u64) -> (u64, usize) {
    match std::env::var("CAROM_UNITS").ok().and_then(|count| count.parse().ok()) {
        Some(count) => (count, 10),
        None => (few, 2),
    }
}

/// A vehicle with drag, two gears and a wall, and its way.
struct Vehicle {
    gears: [f64; 2],
    shift: f64,
    drag: f64,
    restitution: Option<f64>,
    most: f64,
    start: [f64; 2],
    goal: [f64; 2],
    around: f64,
}

impl Vehicle {
    fn random(numbers: &mut Numbers) -> Self {
        Vehicle {
            gears: [numbers.within(0.5, 1.0), numbers.within(1.5, 3.0)],
            shift: numbers.within(0.2, 0.8),
            drag: if numbers.is_so(0.5) { numbers.within(0.0, 0.4) } else { 0.0 },
            restitution: numbers.is_so(0.6).then(|| numbers.within(0.1, 0.9)),
            most: numbers.within(1.5, 3.0),
            start: [numbers.within(1.0, 4.0), numbers.within(-1.0, 1.0)],
            goal: [numbers.within(0.3, 6.0), 0.0],
            around: numbers.within(0.02, 0.2),
        }
    }

    /// The least number of steps and the least number of impacts with it.
    fn solve(&self, units: Units) -> Result<(Option<usize>, f64), Error> {
        let mut own = HybridSystem::new(0.2 * units.time);
        let x = own.state("x", units.place(0.0), units.place(8.0))?;
        let v = own.state("v", units.speed(-4.0), units.speed(4.0))?;
        let u = own.input("u", units.push(-1.0), units.push(1.0))?;
        let speed = own.output("impact speed")?;
        own.limit("speed", v.within(units.speed(-self.most), units.speed(self.most)))?;
        let drag = self.drag / units.time;
        let wall = units.place(0.0);
        for (name, gain) in ["low", "high"].into_iter().zip(self.gears) {
            let gear = own.mode(name)?.rates([x.is(v), v.is(gain * u - drag * v)])?;
            let gear = gear.guard(x.predicted().ge(wall))?;
            if name == "high" {
                gear.guard(v.ge(units.speed(self.shift)))?;
            }
        }
        if let Some(e) = self.restitution {
            let back = v.predicted();
            own.event("impact")?
                .rates([x.is(v), v.is(self.gears[0] * u - drag * v)])?
                .guard(x.predicted().le(wall))?
                .guard(back.le(0.0))?
                .reset([x.is((1.0 + e) * wall - e * x.predicted()), v.is(-e * back)])?
                .output(speed, -1.0 * back)?;
        }
        let start = [x.equals(units.place(self.start[0])), v.equals(units.speed(self.start[1]))];
        let near = self.around;
        let goal = [
            x.within(units.place(self.goal[0] - near), units.place(self.goal[0] + near)),
            v.within(units.speed(self.goal[1] - near), units.speed(self.goal[1] + near)),
        ];
        let mut solver = BranchAndBound::default();
        let options = ShortestOptions::default().with_max_steps(40);
        let found = own.shortest_with(start.clone(), goal.clone(), &options, &mut solver)?;
        let Some(steps) = found.steps else { return Ok((None, 0.0)) };
        let plan = found.plan.expect("found");
        // The plan is a run of the statement, in numbers relative to the room.
        let (place, rate) = (plan.run.state("x")?, plan.run.state("v")?);
        for t in 0..steps {
            let taken = &plan.run.transitions("mode")?[t];
            if self.drag == 0.0 && taken != "impact" {
                let gain = self.gears[usize::from(taken == "high")];
                let a = gain * plan.run.input("u")?[t];
                let dt = 0.2 * units.time;
                let next = place[t] + dt * (rate[t] + 0.5 * dt * a);
                let miss = (next - place[t + 1]).abs() / units.length;
                let rounding = 1e-15 * (place[t] / units.length).abs();
                assert!(miss < 2e-6 + rounding, "{units:?}: step {t} misses by {miss}");
                let miss = (rate[t] + dt * a - rate[t + 1]).abs() / units.speed(1.0);
                assert!(miss < 2e-6, "{units:?}: step {t} misses the speed by {miss}");
            }
        }
        if self.restitution.is_none() {
            return Ok((Some(steps), 0.0));
        }
        let mut program = own.program(steps)?;
        program.start(start)?;
        program.goal(goal)?;
        let hits = program.sum(own.transition_named("mode", "impact")?)?;
        program.minimize(hits)?;
        let plan = program.solve(&mut solver)?;
        Ok((Some(steps), plan.solution.objective().unwrap_or(f64::NAN).round()))
    }
}

#[test]
fn random_systems_take_as_many_steps_in_any_unit() {
    let (cases, units) = counts(6);
    for seed in 0..cases {
        let mut numbers = Numbers(seed.wrapping_mul(7919) + 1);
        let vehicle = Vehicle::random(&mut numbers);
        let ordinary = vehicle.solve(Units::ORDINARY).unwrap();
        for _ in 0..units {
            let units = numbers.units();
            assert_eq!(vehicle.solve(units).unwrap(), ordinary, "seed {seed}, {units:?}");
        }
    }
}

/// A puck on a table with a block.
struct Table {
    restitution: f64,
    friction: Option<f64>,
    rests: bool,
    gravity: f64,
    radius: f64,
    block: Option<[f64; 3]>,
    speed: f64,
    push: f64,
    start: [f64; 4],
    goal: [f64; 2],
}

impl Table {
    fn random(numbers: &mut Numbers) -> Self {
        let with_block = numbers.is_so(0.4);
        let x = numbers.within(0.7, 1.3);
        let block = [x, x + numbers.within(0.1, 0.3), numbers.within(0.2, 0.5)];
        Table {
            restitution: numbers.within(0.2, 0.95),
            friction: numbers.is_so(0.2).then_some(0.2),
            rests: numbers.is_so(0.2),
            gravity: if numbers.is_so(0.3) { numbers.within(0.2, 1.0) } else { 0.0 },
            radius: numbers.within(0.02, 0.08),
            block: with_block.then_some(block),
            speed: numbers.within(2.0, 4.0),
            push: numbers.within(2.0, 5.0),
            start: [
                numbers.within(0.2, 0.6),
                numbers.within(0.2, 0.8),
                numbers.within(-2.0, 2.0),
                numbers.within(-1.5, 1.5),
            ],
            goal: [numbers.within(1.45, 1.8), numbers.within(0.2, 0.8)],
        }
    }

    fn solve(&self, units: Units) -> Result<Option<usize>, Error> {
        let sides = |low: [f64; 2], high: [f64; 2]| {
            [0, 1].map(|i| units.place(low[i])..=units.place(high[i]))
        };
        let table = sides([0.0, 0.0], [2.0, 1.0]);
        let [x, y, v, w] = self.start;
        let near = |x: f64| units.place(x - 0.05)..=units.place(x + 0.05);
        let slow = units.speed(-0.1)..=units.speed(0.1);
        let puck = Body::new("puck", &table, units.speed(self.speed), units.push(self.push))
            .with_shape(Shape::Ball(units.length * self.radius))
            .with_gravity([0.0, units.push(-self.gravity)])
            .with_start([units.place(x), units.place(y), units.speed(v), units.speed(w)])
            .with_goal([near(self.goal[0]), near(self.goal[1]), slow.clone(), slow]);
        let mut cushion = Surface::bounce(Restitution::new(self.restitution)?);
        if let Some(friction) = self.friction {
            cushion = cushion.with_friction(friction);
        }
        if self.rests {
            cushion = cushion.with_rest();
        }
        let mut scene =
            Scene::new(0.1 * units.time).with_body(puck).with_room("cushion", &table, cushion);
        if let Some([from, to, height]) = self.block {
            let sides = sides([from, -0.1], [to, height]);
            scene = scene.with_obstacle(Solid::cuboid("block", &sides, Surface::avoid()));
        }
        let options = ShortestOptions::default().with_max_steps(25);
        let found = scene.shortest_with(&options, &mut BranchAndBound::default())?;
        if let Some(plan) = &found.plan {
            let drift = plan.certificate.drift / units.length.max(units.speed(1.0));
            assert!(drift < 1e-4, "{units:?}: a drift of {drift}");
        }
        Ok(found.steps)
    }
}

#[test]
fn random_scenes_take_as_many_steps_in_any_unit() {
    let (cases, units) = counts(2);
    for seed in 0..cases {
        let mut numbers = Numbers(seed.wrapping_mul(104_729) + 3);
        let table = Table::random(&mut numbers);
        let ordinary = table.solve(Units::ORDINARY).unwrap();
        for _ in 0..units {
            let units = numbers.units();
            assert_eq!(table.solve(units).unwrap(), ordinary, "seed {seed}, {units:?}");
        }
    }
}
