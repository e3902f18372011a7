//! Reach sets for your own system: an elevator with two gears that must stop at a floor.
//!
//! `cargo run --release --example reach_sets [-- PICTURE.svg]`
//!
//! High gear is stronger but allowed only above 0.4 m/s. The gear is chosen in each step. How soon
//! can the cabin be at rest at 12 m?

use std::error::Error as StdError;

use carom::hybrid::reach::{HorizonVariables, ReachSets, SetOptions};
use carom::hybrid::{
    Halfspace, HorizonModel, HybridSystem, LinearSystem, Mat, ShortestOptions, Transition, Waiting,
    shortest_horizon,
};
use carom::interval::Interval;
use carom::model::Family;
use carom::prelude::*;

const TIME_STEP: f64 = 0.1; // s
const HEIGHT: Interval = Interval { lower: 0.0, upper: 15.0 }; // m
const SPEED: Interval = Interval { lower: -2.5, upper: 2.5 }; // m/s
const LOW_GEAR: f64 = 0.6; // m/s² at full input
const HIGH_GEAR: f64 = 1.5; // m/s² at full input
const SHIFT: f64 = 0.4; // m/s: high gear from here on
const FLOOR: f64 = 12.0; // m

struct Elevator;

impl Elevator {
    /// x⁺ and v⁺ under the input u in [-1, 1] in a gear.
    fn gear(strength: f64) -> Result<LinearSystem, Error> {
        let line = LinearSystem::double_integrator(TIME_STEP)?;
        let gain = Mat::from_fn(2, 1, |i, _| strength * line.b()[(i, 0)]);
        LinearSystem::new(line.a().clone(), gain, vec![0.0, 0.0])
    }
}

impl HorizonModel for Elevator {
    type Program = Model;

    fn build(&self, steps: usize) -> Result<Model, Error> {
        let mut model = Model::new("elevator");
        let x = model.continuous_family("x", steps + 1, HEIGHT.lower, HEIGHT.upper)?;
        let v = model.continuous_family("v", steps + 1, SPEED.lower, SPEED.upper)?;
        let u = model.continuous_family("u", steps, -1.0, 1.0)?;
        let high = model.binary_family("high", steps)?;
        for t in 0..steps {
            model.add(("fast", t), high[t].on().implies(v[t].ge(SHIFT)))?;
            for (gear, strength) in [(high[t].off(), LOW_GEAR), (high[t].on(), HIGH_GEAR)] {
                let next = Elevator::gear(strength)?.predict(&[x[t], v[t]], &[u[t]])?;
                let kind = if gear.is_on() { "high" } else { "low" };
                let rows = [("x", x[t + 1], &next[0]), ("v", v[t + 1], &next[1])];
                for (name, state, next) in rows {
                    let row = state.equals(next);
                    model.add((format!("{kind}_{name}"), t), gear.implies(row))?;
                }
            }
        }
        for (state, value) in [(x[0], 0.0), (v[0], 0.0), (x[steps], FLOOR), (v[steps], 0.0)] {
            model.fix(state, value)?;
        }
        Ok(model)
    }

    fn waiting(&self) -> Waiting {
        Waiting::Free("the cabin can rest where it starts".into())
    }

    /// The same as a hybrid system.
    fn reach_sets(&self) -> Result<Option<ReachSets>, Error> {
        let fast = Halfspace::limit("the least speed of high gear", [0.0, -1.0], -SHIFT);
        let system = HybridSystem::new()
            .with_state("x", HEIGHT)
            .with_state("v", SPEED)
            .with_input("u", Interval::new(-1.0, 1.0))
            .with_transition(Transition::new("low gear", Elevator::gear(LOW_GEAR)?))
            .with_transition(
                Transition::new("high gear", Elevator::gear(HIGH_GEAR)?).with_guard(fast),
            );
        let at = |x| [Interval::point(x), Interval::point(0.0)];
        ReachSets::new(&system, &at(0.0), &at(FLOOR), SetOptions::default()).map(Some)
    }

    /// The variables of the two states, and the binaries of transition 1.
    fn variables(&self, model: &Model) -> HorizonVariables {
        let family = |name: &str| -> Family {
            (0..).map_while(|t| model.variable_by_name((name, t)).ok()).collect()
        };
        HorizonVariables::new([family("x"), family("v")]).with_transition(1, family("high"))
    }
}

fn main() -> Result<(), Box<dyn StdError>> {
    let mut solver = BranchAndBound::default();
    let mut found = shortest_horizon(&Elevator, &ShortestOptions::default(), &mut solver)?;
    let (Some(steps), Some(tube)) = (found.steps, &found.tube) else {
        return Err(format!("no horizon found: {}", found.status).into());
    };
    println!("shortest horizon: {steps} steps of {TIME_STEP} s ({})", found.status);
    let solves = found.attempts.iter().filter(|attempt| attempt.is_solve()).count();
    println!("refuted: {} horizons, with {solves} solves in all", found.refutations().count());

    let mut model = Elevator.build(steps)?;
    let variables = Elevator.variables(&model);
    println!("presolve: {}", tube.tighten(&mut model, &variables)?);

    let solved = found.program.as_ref().zip(found.solution.as_ref());
    if let (Some((program, solution)), Some(path)) = (solved, std::env::args().nth(1)) {
        let variables = Elevator.variables(program);
        let states = |t: usize| -> Result<Vec<f64>, Error> {
            variables.states.iter().map(|family| solution.value(family[t])).collect()
        };
        let plan = (0..=steps).map(states).collect::<Result<Vec<_>, _>>()?;
        std::fs::write(&path, tube.to_svg(0, 1, &plan)?)?;
        println!("wrote {path}");
    }
    if let Some(sets) = &mut found.sets
        && let Some(reason) = sets.explain(steps - 1)?
    {
        println!("{reason}");
    }
    Ok(())
}
