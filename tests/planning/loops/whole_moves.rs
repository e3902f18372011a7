//! Random systems in loops, with plants that share no code with the crate: they know the numbers of
//! the statement, take the move as it says, and watch guards, dwell times and events themselves.
//!
//! `CAROM_LOOPS` sets the number of systems, `CAROM_SEED` the first seed.

use std::time::Duration;

use carom::hybrid::{Memory, MoveSource};
use carom::prelude::*;

const STEPS: usize = 7;
const HORIZON: usize = 4;

/// SplitMix64.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// A multiple of 1/8.
    fn eighths(&mut self, least: i64, most: i64) -> f64 {
        (least + self.below((most - least + 1) as usize) as i64) as f64 / 8.0
    }

    fn chance(&mut self, of: usize) -> bool {
        self.below(of) == 0
    }
}

/// What a transition or a mode adds to the common next state, and the guard on its start.
struct Part {
    name: String,
    added: Vec<f64>,
    /// The state, the sign and the limit of `sign x <= limit`.
    guard: Option<(usize, f64, f64)>,
}

/// Modes with memory, and their least and most samples.
type Heater = (Vec<Part>, [(usize, Option<usize>); 2]);

/// The numbers of a statement.
struct Statement {
    /// A, with rows whose magnitudes sum up to less than 1.
    a: Vec<Vec<f64>>,
    b: Vec<f64>,
    /// Whether the input is 0 or 1 alone, or -1 to 1.
    is_binary: bool,
    /// Modes without memory.
    valve: Vec<Part>,
    /// Modes with memory: off and on, with least and most samples.
    heater: Option<Heater>,
    most_events: Option<usize>,
    aim: f64,
}

impl Statement {
    fn new(draw: &mut Draw) -> Self {
        let n = 1 + draw.below(2);
        let a = (0..n).map(|_| (0..n).map(|_| draw.eighths(-3, 3)).collect()).collect();
        let b = (0..n).map(|_| draw.eighths(-8, 8)).collect();
        let part = |draw: &mut Draw, name: String, may_guard: bool| {
            let added = (0..n).map(|_| draw.eighths(-12, 12)).collect();
            let side = if draw.chance(2) { 1.0 } else { -1.0 };
            let guard = (may_guard && draw.chance(2))
                .then(|| (draw.below(n), side, draw.eighths(-8, 8) + 0.01));
            Part { name, added, guard }
        };
        let count = 1 + draw.below(3);
        // One of them is always possible, wherever it is in the list.
        let free = draw.below(count);
        let valve = (0..count).map(|k| part(draw, format!("way {k}"), k != free)).collect();
        let heater = draw.chance(2).then(|| {
            let modes = ["off", "on"].map(|name| part(draw, name.to_owned(), false)).into();
            let dwell = |draw: &mut Draw| {
                let least = 1 + draw.below(4);
                (least, draw.chance(3).then(|| least + draw.below(3)))
            };
            (modes, [dwell(draw), dwell(draw)])
        });
        // Without a longest time a heater can stay as it is when no events are left.
        let can_stay =
            heater.as_ref().is_none_or(|(_, dwells)| dwells.iter().all(|d| d.1.is_none()));
        let most_events = (can_stay && draw.chance(4)).then(|| draw.below(4));
        let aim = draw.eighths(-16, 16);
        Statement { a, b, is_binary: draw.chance(3), valve, heater, most_events, aim }
    }

    fn system(&self) -> (HybridSystem, Vec<State>, Input) {
        let mut system = HybridSystem::new(1.0);
        let n = self.a.len();
        let x: Vec<State> =
            (0..n).map(|i| system.state(&format!("x{i}"), -40.0, 40.0).unwrap()).collect();
        let u = match self.is_binary {
            true => system.input_from("u", [0.0, 1.0]).unwrap(),
            false => system.input("u", -1.0, 1.0).unwrap(),
        };
        let next = |i: usize, by: f64| {
            let own = (0..n).map(|j| self.a[i][j] * x[j]).sum::<Affine>();
            x[i].is(own + self.b[i] * u + by)
        };
        system.next((0..n).map(|i| next(i, 0.0)).collect::<Vec<_>>()).unwrap();
        let rows = |part: &Part| (0..n).map(|i| next(i, part.added[i])).collect::<Vec<_>>();
        for part in &self.valve {
            let mode = system.mode_of("valve", &part.name).unwrap().next(rows(part)).unwrap();
            if let Some((i, sign, limit)) = part.guard {
                mode.guard((sign * x[i]).le(limit)).unwrap();
            }
        }
        if let Some((parts, dwells)) = &self.heater {
            let [off, on] = system.modes("heater", ["off", "on"]).unwrap();
            for (mode, part) in [off, on].into_iter().zip(parts) {
                system.stay(mode).unwrap().next(rows(part)).unwrap();
            }
            system.switch(off, on).unwrap();
            system.switch(on, off).unwrap();
            for (mode, (least, most)) in [off, on].into_iter().zip(dwells) {
                system.dwell(mode, *least, *most).unwrap();
            }
        }
        if let Some(most) = self.most_events {
            system.most_events(most);
        }
        (system, x, u)
    }

    fn program(&self, steps: usize) -> Result<HybridProgram, Error> {
        let (system, x, u) = self.system();
        let mut program = system.program(steps)?;
        let miss = x.iter().map(|x| (*x - self.aim).square()).sum::<Quadratic>();
        program.minimize(program.sum(miss + 0.125 * u.square())?)?;
        Ok(program)
    }

    fn cost(&self, state: &[f64], input: f64) -> f64 {
        let miss: f64 = state.iter().map(|x| (x - self.aim).powi(2)).sum();
        miss + 0.125 * input * input
    }
}

/// A plant that watches what it is told.
struct Plant<'s> {
    statement: &'s Statement,
    /// The mode, the samples that it has lasted, whether its entry was seen.
    heater: (usize, usize, bool),
    events: usize,
}

impl Plant<'_> {
    fn follow(&mut self, state: &[f64], next: &ControlMove) -> Vec<f64> {
        let Statement { a, b, is_binary, valve, heater, most_events, .. } = self.statement;
        let u = next.input[0];
        assert!(if *is_binary { u == 0.0 || u == 1.0 } else { u.abs() <= 1.0 + 1e-6 }, "{u}");
        let n = state.len();
        let mut after: Vec<f64> =
            (0..n).map(|i| (0..n).map(|j| a[i][j] * state[j]).sum::<f64>() + b[i] * u).collect();
        let mut add = |part: &Part| after.iter_mut().zip(&part.added).for_each(|(x, by)| *x += by);
        let way = next.transition("valve").expect("a way");
        let way = valve.iter().find(|part| part.name == way).expect("a known way");
        if let Some((i, sign, limit)) = way.guard {
            assert!(sign * state[i] <= limit + 2e-6, "the guard of {}: {state:?}", way.name);
        }
        add(way);
        if let Some((parts, dwells)) = heater {
            let name = next.mode("heater").expect("a mode");
            let to = parts.iter().position(|part| part.name == name).expect("a known mode");
            add(&parts[to]);
            let (from, samples, is_seen) = self.heater;
            let (least, most) = dwells[from];
            if from == to {
                assert!(most.is_none_or(|most| samples < most), "{name} for {samples} already");
                assert_eq!(next.transition("heater"), Some(name));
                self.heater.1 += 1;
            } else {
                assert!(!is_seen || samples >= least, "left after {samples} of {least}");
                let switch = format!("{} to {name}", parts[from].name);
                assert_eq!(next.transition("heater"), Some(&switch[..]));
                (self.heater, self.events) = ((to, 1, true), self.events + 1);
            }
            assert!(most_events.is_none_or(|most| self.events <= most), "{} events", self.events);
        }
        after
    }
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Receding,
    Moving,
    Shrinking,
}

/// One loop, with disturbances or without.
fn assert_moves_are_whole(statement: &Statement, kind: Kind, is_disturbed: bool, draw: &mut Draw) {
    let mut solver = BranchAndBound::default();
    let build = |_: usize| statement.program(HORIZON);
    let mut controller = match kind {
        Kind::Receding => {
            RecedingHorizon::new(statement.program(HORIZON).unwrap(), &mut solver).unwrap()
        }
        Kind::Moving => RecedingHorizon::moving(build, &mut solver),
        Kind::Shrinking => {
            RecedingHorizon::shrinking(STEPS, |steps| statement.program(steps), &mut solver)
        }
    };
    let mode = draw.below(2);
    let samples = (!draw.chance(3)).then(|| 1 + draw.below(3));
    let samples = statement.heater.as_ref().and_then(|(_, dwells)| {
        let longest = dwells[mode].1.unwrap_or(usize::MAX);
        samples.map(|samples| samples.min(longest))
    });
    if statement.heater.is_some() {
        let name = ["off", "on"][mode];
        controller.set_memory(Memory::default().with_mode("heater", name, samples));
    }
    let heater = (mode, samples.unwrap_or(1), samples.is_some());
    let mut plant = Plant { statement, heater, events: 0 };
    let mut state: Vec<f64> = statement.a.iter().map(|_| draw.eighths(-24, 24)).collect();
    let hour = Duration::from_secs(3600);
    let mut last: Option<(f64, f64)> = None;
    for step in 0..STEPS {
        // Sometimes there is no time to plan.
        let has_time = step == 0 || !draw.chance(4);
        controller = controller.with_budget(if has_time { hour } else { Duration::ZERO });
        let next = controller.step(&state).unwrap();
        assert_eq!((next.is_admissible, next.step), (Some(true), step), "{next:?}");
        assert!(!has_time || next.source == MoveSource::Optimal, "{next:?}");
        if statement.heater.is_some() {
            assert_eq!(next.memory.mode("heater"), Some(["off", "on"][plant.heater.0]));
            let seen = plant.heater.2.then_some(plant.heater.1);
            assert_eq!(next.memory.samples("heater"), seen);
        }
        let after = plant.follow(&state, &next);
        // Where the move says it leads, and where the crate's own simulation of it does.
        if !next.states.is_empty() {
            assert!(apart(&after, &next.states[1]) < 1e-5, "{after:?}, {next:?}");
        }
        let simulated = statement.system().0.simulate(&state, &next).unwrap().end().unwrap();
        assert!(apart(&after, &simulated) < 1e-9, "{after:?}, {simulated:?}");
        // The optimal rest of a plan is at least as good as the plan.
        let cost = statement.cost(&state, next.input[0]);
        if let (Some((before, spent)), Some(now)) = (last, next.objective)
            && kind == Kind::Shrinking
            && !is_disturbed
        {
            assert!(
                now <= before - spent + 1e-5 * before.max(1.0),
                "{now} after {before} - {spent}"
            );
        }
        last = match (next.objective, last) {
            (Some(objective), _) => Some((objective, cost)),
            (None, Some((before, spent))) => Some((before, spent + cost)),
            (None, None) => None,
        };
        state = after;
        if is_disturbed {
            state.iter_mut().for_each(|x| *x += draw.eighths(-4, 4));
        }
    }
}

#[test]
fn plants_arrive_where_moves_say_and_dwell_times_hold() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse::<u64>().ok());
    let (count, seed) = (number("CAROM_LOOPS").unwrap_or(60), number("CAROM_SEED").unwrap_or(1));
    for system in 0..count {
        let mut draw = Draw(seed.wrapping_mul(0x1000_0000).wrapping_add(system));
        let statement = Statement::new(&mut draw);
        let kind = [Kind::Receding, Kind::Moving, Kind::Shrinking][draw.below(3)];
        for is_disturbed in [false, true] {
            let told = || format!("seed {seed}, system {system}, {kind:?}, {is_disturbed}");
            let one = std::panic::AssertUnwindSafe(|| {
                assert_moves_are_whole(&statement, kind, is_disturbed, &mut draw);
            });
            if let Err(panic) = std::panic::catch_unwind(one) {
                eprintln!("{}\n{}", told(), statement.system().0);
                std::panic::resume_unwind(panic);
            }
        }
    }
}
