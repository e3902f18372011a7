//! Time and nodes of three trees: one thread, two threads of one process, and two ranks.
//!
//! `compare NAME`, `compare NAME threads` and `mpirun -n 2 compare NAME ranks`, where NAME is
//! `boxes`, `puck` or `market`, or the path of a model as JSON. A number of steps, or of columns,
//! may follow.

#[path = "../tests/programs/mod.rs"]
mod programs;

use std::error::Error;
use std::time::Instant;

use carom::prelude::*;
use mpi::traits::Communicator;
use programs::instances::generators;
use programs::market;

fn main() -> Result<(), Box<dyn Error>> {
    let universe = mpi::initialize().ok_or("no MPI")?;
    let world = universe.world();
    let words: Vec<String> = std::env::args().skip(1).collect();
    let name = words.first().ok_or("which program?")?;
    let size = |usual: usize| words.get(2).map_or(Ok(usual), |word| word.parse());
    let model = match name.as_str() {
        "boxes" => boxes(size(40)?, 12)?,
        "puck" => generators::puck(size(70)?, 0.1),
        "market" => market(4, size(28)?, true),
        path => serde_json::from_str(&std::fs::read_to_string(path)?)?,
    };
    let how = words.get(1).map_or("one", |how| how);
    let began = Instant::now();
    let options = Options::default().with_time_limit(std::time::Duration::from_secs(600));
    let (solution, ranks) = match how {
        "ranks" => {
            let answer = carom_mpi::solve(&model, &options, &world)?;
            (answer.solution, answer.ranks)
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

/// A point mass that passes boxes on its way, with the least sum of its accelerations.
fn boxes(steps: usize, count: usize) -> Result<Model, Box<dyn Error>> {
    let (dt, size) = (0.5, 10.0);
    let mut state = 3_u64;
    let mut between = |low: f64, high: f64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((state >> 33) % 1000) as f64 / 1000.0
    };
    let places: Vec<[f64; 4]> = (0..count)
        .map(|_| [between(2.0, 8.0), between(2.0, 8.0), between(0.6, 1.4), between(0.6, 1.4)])
        .collect();
    let mut model = Model::new("boxes");
    let mut effort = Affine::from(0.0);
    let mut axes = Vec::new();
    for axis in ["x", "y"] {
        let x = model.continuous_family(axis, steps + 1, 0.0, size)?;
        let v = model.continuous_family(&format!("v{axis}"), steps + 1, -2.0, 2.0)?;
        let a = model.continuous_family(&format!("a{axis}"), steps, -1.5, 1.5)?;
        let w = model.continuous_family(&format!("w{axis}"), steps, 0.0, 1.5)?;
        for (k, (variable, value)) in
            [(x[0], 0.5), (v[0], 0.0), (x[steps], 9.5), (v[steps], 0.0)].into_iter().enumerate()
        {
            model.add((format!("end_{axis}"), k), variable.equals(value))?;
        }
        for t in 0..steps {
            let there = x[t] + dt * v[t] + 0.5 * dt * dt * a[t];
            model.add((format!("drift_{axis}"), t), (x[t + 1] - there).equals(0.0))?;
            model.add((format!("speed_{axis}"), t), (v[t + 1] - v[t] - dt * a[t]).equals(0.0))?;
            model.add((format!("over_{axis}"), t), (a[t] - w[t]).le(0.0))?;
            model.add((format!("under_{axis}"), t), (a[t] + w[t]).ge(0.0))?;
            effort += w[t];
        }
        axes.push(x);
    }
    let (across, along) = (&axes[0], &axes[1]);
    for (b, [x, y, half_x, half_y]) in places.into_iter().enumerate() {
        for t in 1..steps {
            let side = |name: &str| (format!("{name}_{b}"), t);
            let rows = [
                ("left", across[t].le(x - half_x)),
                ("right", across[t].ge(x + half_x)),
                ("below", along[t].le(y - half_y)),
                ("above", along[t].ge(y + half_y)),
            ];
            let mut any = Affine::from(0.0);
            for (name, row) in rows {
                let on = model.binary(side(name))?;
                model.add(side(&format!("if_{name}")), on.on().implies(row))?;
                any += on;
            }
            model.add(side("any"), any.ge(1.0))?;
        }
    }
    model.minimize(effort)?;
    Ok(model)
}
