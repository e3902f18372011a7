//! Scenes with gusts: plans that hold for every one of them, and flights through some.

use carom::hybrid::RobustPlan;
use carom::interval::Interval;
use carom::prelude::*;

use crate::motion::Motion;
use crate::scene_task::SceneTask;
use crate::task::round;
use crate::words::PlanCheck;

/// Nodes of a solve: those of programs with a tube are large.
const NODES: u64 = 1000;
/// How many flights are drawn.
const FLIGHTS: usize = 100;
/// Plans keep their conditions to within a millionth.
const MISS: f64 = 2e-6;

/// The shortest plan that holds for every gust, with a linear-quadratic regulator as its feedback.
pub fn plan(
    task: &SceneTask,
    scene: &Scene,
    options: &ShortestOptions,
) -> Result<ShortestHorizon<Motion>, Error> {
    let feedback = Feedback::regulator(&scene.hybrid_system()?)?;
    let mut solver = BranchAndBound::new(Options::default().with_node_limit(NODES));
    let found = scene.shortest_robust(&feedback, options, &mut solver)?;
    found.try_map(|plan| fly(task, &plan))
}

/// The plan, with flights through random gusts.
fn fly(task: &SceneTask, plan: &RobustPlan) -> Result<Motion, Error> {
    // The same flights for everybody.
    let (mut dice, mut arrived, mut flights) = (Disturbance::new([0.0..=1.0], 1), 0, Vec::new());
    let check = |arrived| PlanCheck::EveryGust { flights: FLIGHTS, arrived };
    for _ in 0..FLIGHTS {
        let mut share = || dice.next_value().first().copied().unwrap_or(0.5);
        let flight = plan.simulate(&mut |range| range.lower + share() * range.width())?;
        arrived += usize::from(flight.kept && is_at_goal(task, &flight.run.states));
        let motion = Motion::of_run(task, &flight.run, check(0))?;
        let mut corners = Vec::new();
        for (step, place) in motion.bodies.iter().flat_map(|body| &body.position).enumerate() {
            corners.push([round(place[0]), round(place[1])]);
            let hit = motion.hits.iter().find(|hit| hit.step == step);
            corners.extend(hit.map(|hit| [round(hit.place[0]), round(hit.place[1])]));
        }
        flights.push(corners);
    }
    let mut motion = Motion::of_run(task, &plan.plan.run, check(arrived))?;
    let around = |(place, errors): (&Vec<f64>, &Vec<Interval>)| {
        [0, 1].map(|k| [errors[k].lower, errors[k].upper].map(|error| round(place[k] + error)))
    };
    let places = motion.bodies.iter().flat_map(|body| &body.position);
    motion.tube = places.zip(&plan.certificate.states).map(around).collect();
    motion.flights = flights;
    Ok(motion)
}

/// Whether the last values of all states are those of the goals.
fn is_at_goal(task: &SceneTask, states: &[(String, Vec<f64>)]) -> bool {
    let goals = task.bodies.iter().filter_map(|body| body.goal_ranges()).flatten();
    goals.zip(states).all(|(goal, (_, values))| {
        values.last().is_some_and(|end| goal.lower - MISS <= *end && *end <= goal.upper + MISS)
    })
}
