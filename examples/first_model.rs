//! A first model: pass a post on its left or on its right, as close as possible to a preferred
//! position.
//!
//! `cargo run --release --example first_model`

use carom::prelude::*;

fn main() -> Result<(), Error> {
    let mut model = Model::new("post");
    let x = model.continuous("x", 0.0, 10.0)?; // where to pass, m
    let right = model.binary("right")?;
    model.add("pass_right", right.on().implies(x.ge(6.5)))?;
    model.add("pass_left", right.off().implies(x.le(4.0)))?;
    model.minimize((x - 5.5).square())?;
    print!("{model}");

    let mut solver = BranchAndBound::default();
    let solution = solver.solve(&model)?;
    println!("pass at {:.3} m, proved: {}", solution.value(x)?, solution.is_optimal());

    // The model is still there: close the right side and solve again.
    model.fix(right, 0.0)?;
    println!("right side closed: pass at {:.3} m", solver.solve(&model)?.value(x)?);
    Ok(())
}
