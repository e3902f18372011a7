//! The paper's question with air: a vehicle with drag `-c |v| v` may hit a wall to turn around.
//!
//! `cargo run --release --example air_drag [PICTURE.svg]`
//!
//! Drag is a function of one's own: its value, its slope, and intervals of both and of its
//! curvature.

use carom::hybrid::{Discretization, HybridPlan};
use carom::interval::Interval;
use carom::model::SmoothFunction;
use carom::picture::{Chart, SOLID, WITH_COLLISION, WITHOUT_COLLISION};
use carom::prelude::*;

/// Length of a step (s).
const STEP: f64 = 0.1;

/// `|v| v`.
#[derive(Debug)]
struct SignedSquare;

impl SmoothFunction for SignedSquare {
    fn name(&self) -> &str {
        "signed square"
    }

    fn value(&self, v: f64) -> f64 {
        v * v.abs()
    }

    fn derivative(&self, v: f64) -> f64 {
        2.0 * v.abs()
    }

    fn range(&self, v: Interval) -> Interval {
        // It grows.
        let [lower, upper] = [self.value(v.lower), self.value(v.upper)];
        Interval::new(lower.next_down(), upper.next_up())
    }

    fn slope_range(&self, v: Interval) -> Interval {
        let least = if v.contains(0.0) { 0.0 } else { v.lower.abs().min(v.upper.abs()) };
        Interval::new(2.0 * least, 2.0 * v.magnitude())
    }

    fn curvature_range(&self, v: Interval) -> Interval {
        let lower = if v.lower < 0.0 { -2.0 } else { 2.0 };
        Interval::new(lower, if v.upper > 0.0 { 2.0 } else { -2.0 })
    }
}

/// The vehicle, which may hit the wall at 0 m up to an impact speed (m/s), or must not.
fn vehicle(impact: Option<f64>) -> Result<HybridSystem, Error> {
    let mut vehicle = HybridSystem::new(STEP);
    let x = vehicle.state("x", 0.0, 3.0)?; // m from the wall
    let v = vehicle.state("v", -4.0, 4.0)?; // m/s
    let a = vehicle.input("a", -2.0, 2.0)?; // m/s²
    vehicle.discretization(Discretization::Euler)?;
    vehicle.rates([x.is(v), v.is(a - 0.15 * v.own(SignedSquare))])?;
    vehicle.mode("flight")?.guard(x.predicted().ge(0.0))?;
    if let Some(impact) = impact {
        vehicle
            .event("hit")?
            .guard(x.predicted().le(0.0))?
            .guard(v.predicted().within(-impact, 0.0))?
            .reset([x.is(0.0), v.is(-0.6 * v.predicted())])?;
    }
    Ok(vehicle)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut plans = Vec::new();
    for (name, impact) in [("avoiding", None), ("hitting", Some(2.5))] {
        let system = vehicle(impact)?;
        let [x, v] = [system.state_named("x")?, system.state_named("v")?];
        let start = [x.equals(2.0), v.equals(-2.5)];
        let goal = [x.ge(2.5), v.ge(0.0)];
        let found = system.shortest(start, goal, &mut BranchAndBound::default())?;
        println!("{name}: {found}");
        let Some(plan) = found.plan else { return Err("no plan".into()) };
        let motion = system.enclose_motion(&plan.run)?;
        println!("  its motion leaves the samples by at most {:.3} m, proved", motion.errors[0]);
        plans.push((name, plan));
    }
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(path, picture(&plans)?)?;
    }
    Ok(())
}

fn picture(plans: &[(&str, HybridPlan)]) -> Result<String, Error> {
    let mut chart = Chart::new("time (s)", "distance from the wall (m)").with_size(760.0, 320.0);
    let mut steps = Vec::new();
    for ((name, plan), colour) in plans.iter().zip([WITHOUT_COLLISION[0], WITH_COLLISION[0]]) {
        let places = plan.run.state("x")?;
        let points = places.iter().enumerate().map(|(t, x)| [t as f64 * STEP, *x]);
        chart.line(*name, colour, points);
        steps.push(places.len() - 1);
    }
    let last = steps.iter().max().copied().unwrap_or(1) as f64 * STEP;
    chart.line("wall", SOLID, [[0.0, 0.0], [last, 0.0]]);
    let title = format!(
        "{} steps by braking, {} off the wall; both are the least\nA vehicle with air drag, towards a wall at \
         first.",
        steps[0], steps[1]
    );
    Ok(Chart::to_svg(&[chart], &title))
}
