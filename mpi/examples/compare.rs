//! Time and nodes of three trees: one thread, two threads of one process, and two ranks.
//!
//! `mpirun -n 1 target/release/examples/compare NAME` and `mpirun -n 2 target/release/examples/compare NAME
//! ranks`, where NAME is `boxes`, `units` or `puck`, or the path of a model as JSON; `compare NAME threads` takes two
//! threads.

#[path = "../../tests/instances/mod.rs"]
mod instances;

use std::error::Error;
use std::time::Instant;

use carom::prelude::*;
use instances::generators;
use mpi::traits::Communicator;

fn main() -> Result<(), Box<dyn Error>> {
    let universe = mpi::initialize().ok_or("no MPI")?;
    let world = universe.world();
    let words: Vec<String> = std::env::args().skip(1).collect();
    let name = words.first().ok_or("which program?")?;
    let size = |usual: usize| words.get(2).map_or(Ok(usual), |word| word.parse());
    let model = match name.as_str() {
        "boxes" => generators::boxes(size(20)?, 12, false),
        "units" => units(20, size(48)?)?,
        "puck" => generators::puck(size(100)?, 0.1),
        path => serde_json::from_str(&std::fs::read_to_string(path)?)?,
    };
    let how = words.get(1).map_or("one thread", |how| how);
    let began = Instant::now();
    let options = Options::default().with_time_limit(std::time::Duration::from_secs(40));
    let (solution, ranks) = match how {
        "ranks" => {
            let answer = carom_mpi::solve(&model, &options, &world)?;
            (answer.solution, answer.ranks)
        }
        "whole" => {
            (Some(BranchAndBound::new(options.with_blocks(false)).solve(&model)?), Vec::new())
        }
        "threads" => {
            (Some(BranchAndBound::new(options.with_threads(2)).solve(&model)?), Vec::new())
        }
        _ => (Some(BranchAndBound::new(options).solve(&model)?), Vec::new()),
    };
    let Some(solution) = solution else { return Ok(()) };
    println!(
        "{name}, {how} ({}): {} {:?}, {} nodes, {:.2} s",
        world.size(),
        solution.termination(),
        solution.objective(),
        solution.statistics().nodes,
        began.elapsed().as_secs_f64()
    );
    for counts in ranks {
        println!("    {counts:?}");
    }
    Ok(())
}

/// Units that run or rest in each hour, with costs of starting, and a demand.
fn units(count: usize, hours: usize) -> Result<Model, Box<dyn Error>> {
    let mut model = Model::new("units");
    let mut supply = vec![Affine::from(0.0); hours];
    let mut reserve = vec![Affine::from(0.0); hours];
    let (mut cost, mut most) = (Affine::from(0.0), 0.0);
    for k in 0..count {
        let own = |what: &str| format!("{what}{k}");
        let on = model.binary_family(&own("on"), hours)?;
        let start = model.binary_family(&own("start"), hours)?;
        let size = 50.0 + 7.0 * ((k * 5) % 11) as f64;
        let power = model.continuous_family(&own("power"), hours, 0.0, size)?;
        for t in 0..hours {
            model.add((own("most"), t), (power[t] - size * on[t]).le(0.0))?;
            model.add((own("least"), t), (power[t] - 0.4 * size * on[t]).ge(0.0))?;
            if t > 0 {
                model.add((own("begin"), t), (on[t] - on[t - 1] - start[t]).le(0.0))?;
                model.add((own("ramp"), t), (power[t] - power[t - 1]).le(0.6 * size))?;
            }
            supply[t] += power[t];
            reserve[t] += size * on[t];
            cost += (10.0 + ((k * 3) % 7) as f64) * power[t] + 90.0 * on[t] + 200.0 * start[t];
        }
        most += size;
    }
    for (t, (supply, reserve)) in supply.into_iter().zip(reserve).enumerate() {
        let demand = most * (0.5 + 0.25 * (t as f64 * 0.26).sin());
        model.add(("demand", t), supply.equals(demand))?;
        model.add(("reserve", t), reserve.ge(1.1 * demand))?;
    }
    model.minimize(cost)?;
    Ok(model)
}
