//! The knapsack problem: which things to take if the bag holds 15 kg.
//!
//! `cargo run --release --example knapsack`

use carom::prelude::*;

fn main() -> Result<(), Error> {
    // Name, value and weight in kg.
    let things =
        [("tent", 14.0, 7.0), ("stove", 9.0, 4.0), ("rope", 6.0, 3.0), ("books", 11.0, 8.0)];

    let mut model = Model::new("knapsack");
    let (mut value, mut weight) = (Affine::zero(), Affine::zero());
    let mut taken = Vec::new();
    for (name, worth, kilograms) in things {
        let take = model.binary(name)?;
        value += worth * take;
        weight += kilograms * take;
        taken.push(take);
    }
    model.add("weight", weight.le(15.0))?;
    model.maximize(&value)?;

    let solution = BranchAndBound::default().solve(&model)?;
    for ((name, _, _), take) in things.iter().zip(taken) {
        println!("{name}: {}", if solution.is_on(take)? { "take" } else { "leave" });
    }
    println!("value {}, weight {} kg", solution.value(&value)?, solution.value(&weight)?);
    Ok(())
}
