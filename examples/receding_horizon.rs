//! A controller with a receding horizon: each solve is warm-started from the previous one.
//!
//! `cargo run --release --example receding_horizon -- [STEPS] [MOVES]`
//!
//! An inverted pendulum next to an elastic wall is planned STEPS (20) steps ahead, MOVES (15)
//! times. After each solve the first input is applied, the state is disturbed a little, and the
//! horizon moves by one step. The table shows the nodes of each solve without a warm start, with
//! the shifted plan as a MIP start, and with the shifted plan and the shifted leaves of the
//! previous tree.

use carom::prelude::*;
use carom::solution::GuessStatus;
use carom::solver::TreeSeed;

const H: f64 = 0.01;
const GAP: f64 = 0.1;
const STIFFNESS: f64 = 100.0;

struct Horizon {
    model: Model,
    start: [Variable; 2],
    state: [Family; 2],
    touching: Family,
}

fn horizon(steps: usize) -> Result<Horizon, Error> {
    let mut model = Model::new("pendulum");
    let angle = model.continuous_family("angle", steps + 1, -2.0 * GAP, 2.0 * GAP)?;
    let rate = model.continuous_family("rate", steps + 1, -1.5, 1.5)?;
    let u = model.continuous_family("u", steps, -4.0, 4.0)?;
    let touching = model.binary_family("touching", steps)?;
    let start =
        [model.parameter("angle0", 0.0, -0.2, 0.2)?, model.parameter("rate0", 0.0, -1.5, 1.5)?];
    model.add("start_angle", (angle[0] - start[0]).equals(0.0))?;
    model.add("start_rate", (rate[0] - start[1]).equals(0.0))?;
    for t in 0..steps {
        let on = touching[t];
        model.add(("move", t), (angle[t + 1] - angle[t] - H * rate[t]).equals(0.0))?;
        let change = rate[t + 1] - rate[t] - H * u[t] - 10.0 * H * angle[t];
        let spring = H * STIFFNESS * (angle[t] - GAP);
        model.add(("free", t), on.off().implies(change.clone().equals(0.0)))?;
        model.add(("pushed", t), on.on().implies((change + spring).equals(0.0)))?;
        model.add(("apart", t), on.off().implies(angle[t].le(GAP)))?;
        model.add(("contact", t), on.on().implies(angle[t].ge(GAP)))?;
    }
    let stage = |t: usize| angle[t].square() + rate[t].square();
    let effort: Quadratic = (0..steps).map(|t| stage(t) + u[t].square()).sum();
    model.minimize(effort + 30.0 * stage(steps))?;
    Ok(Horizon { model, start, state: [angle, rate], touching })
}

fn main() -> Result<(), Error> {
    let mut numbers = std::env::args().skip(1).map(|word| word.parse().unwrap_or(20));
    let (steps, moves) = (numbers.next().unwrap_or(20), numbers.next().unwrap_or(15));
    let Horizon { mut model, start, state, touching } = horizon(steps)?;
    let mut solver = BranchAndBound::new(Options::default().with_leaves(true));
    let (mut now, mut last): ([f64; 2], Option<Solution>) = ([0.0, 0.8], None);
    let mut totals = [0; 3];
    println!("move  objective  nodes from nothing  from the plan  from plan and tree  guess");
    for step in 0..moves {
        for (variable, value) in start.into_iter().zip(now) {
            model.set_parameter(variable, value)?;
        }
        let plain = solver.solve(&model)?;
        let mut nodes = [plain.statistics().nodes; 3];
        let mut guess = "-";
        if let Some(last) = &last {
            // The decision of each step is now a proposal for the step before it.
            let binaries: Vec<Variable> = touching.iter().collect();
            let earlier = |v: Variable| {
                let place = binaries.iter().position(|&binary| binary == v)?;
                place.checked_sub(1).map(|place| binaries[place])
            };
            let seed = TreeSeed::of(last, binaries.iter().copied()).mapped(earlier);
            let guess_only = seed.clone().with_leaves([]);
            for (seed, nodes) in [guess_only, seed].iter().zip(&mut nodes[1..]) {
                let mut control = Control::default().with_seed(seed);
                let solution = solver.solve_with(&model, &mut control)?;
                assert_eq!(solution.termination(), plain.termination());
                *nodes = solution.statistics().nodes;
                guess = match solution.seed_report().and_then(|report| report.guess.as_ref()) {
                    Some(GuessStatus::Accepted) => "accepted",
                    Some(GuessStatus::Repaired { .. }) => "repaired",
                    Some(GuessStatus::Rejected { .. }) => "rejected",
                    _ => "-",
                };
            }
            totals.iter_mut().zip(nodes).for_each(|(total, nodes)| *total += nodes);
        }
        let Some(objective) = plain.objective() else {
            println!("{step:>4}  {}", plain.termination());
            break;
        };
        let [nothing, plan, both] = nodes;
        println!("{step:>4} {objective:>10.4} {nothing:>19} {plan:>14} {both:>19}  {guess}");
        let disturbance = 0.02 * (1.7 * step as f64).sin();
        now = [plain.value(state[0][1])?, plain.value(state[1][1])? + disturbance];
        last = Some(plain);
    }
    println!("{:>4} {:>10} {:>19} {:>14} {:>19}", "sum", "", totals[0], totals[1], totals[2]);
    Ok(())
}
