//! A portfolio: at most three of five assets, each at least a tenth of it, with a limit on the
//! risk.
//!
//! `cargo run --release -p carom-solver --example portfolio`

use carom_solver::carom_model::Error;
use carom_solver::prelude::*;

fn main() -> Result<(), Error> {
    let gain = [0.08, 0.12, 0.10, 0.07, 0.15]; // a year
    let deviation = [0.10, 0.22, 0.17, 0.08, 0.33];

    let mut model = Model::new("portfolio");
    let share = model.continuous_family("share", 5, 0.0, 1.0)?;
    let held = model.binary_family("held", 5)?;
    model.add("all", share.iter().sum::<Affine>().equals(1.0))?;
    model.add("few", at_most(3, held.iter().map(|asset| asset.on())))?;
    for k in 0..5 {
        model.add(("least", k), held[k].on().implies(share[k].ge(0.1)))?;
        model.add(("none", k), held[k].off().implies(share[k].le(0.0)))?;
    }
    // Independent assets: the standard deviation of the sum is the length of a vector.
    let risk = norm((0..5).map(|k| deviation[k] * share[k]));
    model.add("risk", risk.le(0.12))?;
    // Gain, less a cost of trades that grows with the square.
    let gains: Affine = (0..5).map(|k| gain[k] * share[k]).sum();
    let trades: Quadratic = share.iter().map(|share| share.square()).sum();
    model.maximize(gains - 0.01 * trades)?;

    let solution = BranchAndBound::default().solve(&model)?;
    println!(
        "{:?}, gain {:.4}, at most {:.4}",
        solution.termination(),
        solution.objective().unwrap_or(f64::NAN),
        solution.bound()
    );
    for k in 0..5 {
        let value = solution.value(share[k])?;
        if value > 0.0 {
            println!("asset {k}: {:5.1} %", 100.0 * value);
        }
    }
    Ok(())
}
