//! Three formulations of disjunctions: sizes, root bounds and nodes, for a flight around boxes and
//! for stops in bounded regions.
//!
//! `cargo run --release --example disjunction`

use carom::model::{Method, Reformulation};
use carom::prelude::*;
use carom::reformulate;

/// A flight of 8 s past two boxes with at most 1 m/s^2 per axis. At every step the vehicle is on
/// one of the four sides of each box. Minimises the sum of squared accelerations.
fn around_boxes() -> Result<Model, Error> {
    let (steps, dt) = (8, 1.0);
    let mut model = Model::new("around boxes");
    let mut axes = Vec::new();
    for (axis, start, goal) in [("x", 0.0, 10.0), ("y", 2.0, 2.0)] {
        let x = model.continuous_family(axis, steps + 1, -5.0, 15.0)?; // m
        let v = model.continuous_family(&format!("v{axis}"), steps + 1, -3.0, 3.0)?; // m/s
        let u = model.continuous_family(&format!("u{axis}"), steps, -1.0, 1.0)?; // m/s^2
        for t in 0..steps {
            let next = x[t] + dt * v[t] + 0.5 * dt * dt * u[t];
            model.add((format!("{axis}_moves"), t), x[t + 1].equals(next))?;
            model.add((format!("{axis}_speeds"), t), v[t + 1].equals(v[t] + dt * u[t]))?;
        }
        for (variable, value) in [(x[0], start), (v[0], 0.0), (x[steps], goal), (v[steps], 0.0)] {
            model.fix(variable, value)?;
        }
        axes.push((x, u));
    }
    let (x, y) = (&axes[0].0, &axes[1].0);
    for (b, [left, right, below, above]) in
        [[2.0, 4.0, 0.0, 3.0], [6.0, 8.0, 1.5, 5.0]].into_iter().enumerate()
    {
        for t in 1..steps {
            let outside = either(x[t].le(left)).or(x[t].ge(right)).or(y[t].le(below));
            model.add((format!("box{b}"), t), outside.or(y[t].ge(above)))?;
        }
    }
    let effort = axes.iter().flat_map(|(_, u)| u.iter());
    model.minimize(effort.map(|u| u.square()).sum::<Quadratic>())?;
    Ok(model)
}

/// A tour of eight stops, each in one of three small regions. Minimises the sum of squared
/// distances.
fn stops_in_regions() -> Result<Model, Error> {
    let mut model = Model::new("stops in regions");
    let x = model.continuous_family("x", 8, 0.0, 20.0)?; // m
    let y = model.continuous_family("y", 8, 0.0, 20.0)?; // m
    for k in 0..8 {
        let at = |shift: usize| ((7 * k + 5 * shift) % 17) as f64;
        let regions = (0..3).map(|r| {
            let (left, below) = (at(r), at(r + 4));
            [x[k].within(left, left + 2.0), y[k].within(below, below + 1.0)]
        });
        model.add(("region", k), Either::of(regions))?;
    }
    let legs = (0..7).map(|k| (x[k + 1] - x[k]).square() + (y[k + 1] - y[k]).square());
    let way: Quadratic = legs.sum::<Quadratic>();
    model.minimize(way + (x[0] - 1.0).square() + (y[7] - 19.0).square())?;
    Ok(model)
}

fn main() -> Result<(), Error> {
    let mut solver = BranchAndBound::default();
    for mut model in [around_boxes()?, stops_in_regions()?] {
        println!("{}\n{}", model.name(), reformulate::compare_methods(&model, &mut solver)?);
        for method in Method::ALL {
            for programs in [false, true] {
                let reformulation = Reformulation::default();
                model.set_reformulation(
                    reformulation.with_method(method).with_linear_programs(programs),
                );
                let solution = solver.solve(&model)?;
                let statistics = solution.statistics();
                println!(
                    "{:<8} {:<21} optimum {:.6}, {} nodes, {} ms",
                    method.word(),
                    if programs { "with linear programs" } else { "" },
                    solution.objective().unwrap_or(f64::NAN),
                    statistics.nodes,
                    statistics.time.as_millis(),
                );
            }
        }
        println!();
    }
    Ok(())
}
