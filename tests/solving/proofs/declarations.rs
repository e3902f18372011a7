//! Programs of which a search uses more than their rows imply: truth values that are continuous,
//! columns with a code of binaries, and columns that can be shifted together. Their logs declare
//! it.

use carom::model::Model;
use carom::prelude::*;
use carom_proof::check;

use super::{is_proved, solved};
use crate::torture::generator::Random;

/// How often a log has each command, and checks that it proves nothing beyond an optimum.
fn count(model: &Model, name: &str, commands: [&str; 3]) -> Result<[usize; 3], Error> {
    let solution = is_proved(model, name);
    let (_, log) = solved(model, name);
    let text = String::from_utf8(log).expect("text");
    if let Some(value) = solution.objective() {
        let claim = text.lines().find(|line| line.starts_with("claim ")).expect("a claim");
        let beyond = format!("claim bound {}", model.sense().sign() * value + 1e-3);
        assert!(check(text.replace(claim, &beyond).as_bytes()).is_err(), "{name}");
    }
    Ok(commands.map(|command| text.lines().filter(|line| line.starts_with(command)).count()))
}

/// A formula over binaries, true at any point: conjunctions and disjunctions of what is below them,
/// as continuous columns, and a choice of one of four by two binaries.
fn formula(random: &mut Random) -> Result<Model, Error> {
    let mut model = Model::new("formula");
    let mut nodes: Vec<Variable> =
        (0..4).map(|k| model.binary(format!("b[{k}]"))).collect::<Result<_, _>>()?;
    let mut cost = Affine::default();
    for b in &nodes {
        cost += *b * (1.0 + random.below(5) as f64 * 0.3);
    }
    let chosen: Vec<Variable> = (0..4)
        .map(|k| model.continuous(format!("one[{k}]"), 0.0, f64::INFINITY))
        .collect::<Result<_, _>>()?;
    let bits = [model.binary("bit[0]")?, model.binary("bit[1]")?];
    model.add("one", chosen.iter().copied().sum::<Affine>().equals(1.0))?;
    for (k, bit) in bits.into_iter().enumerate() {
        let of = |is_set: usize| {
            let own = (0..4).filter(|j| (j >> k) & 1 == is_set).map(|j| chosen[j]);
            own.sum::<Affine>()
        };
        model.add(format!("set[{k}]"), (of(1) - bit).le(0.0))?;
        model.add(format!("not[{k}]"), (of(0) + bit).le(1.0))?;
    }
    for (k, one) in chosen.iter().enumerate() {
        cost += *one * (0.2 * random.below(4) as f64);
        model.add(format!("with[{k}]"), (*one - nodes[k]).le(0.0))?;
    }
    for k in 0..6 {
        let z = model.continuous(format!("z[{k}]"), 0.0, 1.0)?;
        let below: Vec<Variable> = (0..3).map(|_| nodes[random.below(nodes.len())]).collect();
        if random.chance(0.5) {
            for (place, own) in below.iter().enumerate() {
                model.add(format!("all[{k}][{place}]"), (z - *own).le(0.0))?;
            }
        } else {
            model.add(format!("any[{k}]"), (below.into_iter().sum::<Affine>() - z).ge(0.0))?;
        }
        nodes.push(z);
    }
    let top = nodes[nodes.len() - 2] + nodes[nodes.len() - 1];
    model.add("true", top.ge(1.2))?;
    model.minimize(cost)?;
    Ok(model)
}

#[test]
fn logs_of_formulas_declare_truth_values() -> Result<(), Error> {
    let (mut random, mut all) = (Random::new(11), [0; 3]);
    for k in 0..12 {
        let model = formula(&mut random)?;
        let found = count(&model, &format!("formula_{k}"), ["u ", "i ", "v "])?;
        all.iter_mut().zip(found).for_each(|(sum, one)| *sum += one);
    }
    assert!(all[0] > 12 && all[1] > 12 && all[2] == 0, "{all:?}");
    Ok(())
}

/// Orders of five jobs by whole potentials without bounds below, on one of them from above.
#[test]
fn logs_of_orders_declare_a_zero() -> Result<(), Error> {
    let mut random = Random::new(12);
    for k in 0..6 {
        let mut model = Model::new("orders");
        let many = 4;
        let times: Vec<Variable> = (0..many)
            .map(|j| match k % 2 {
                0 => model.integer(format!("t[{j}]"), f64::NEG_INFINITY, f64::INFINITY),
                _ => model.continuous(format!("t[{j}]"), f64::NEG_INFINITY, f64::INFINITY),
            })
            .collect::<Result<_, _>>()?;
        model.add("most", times[0].le(9.0))?;
        let mut cost = Affine::default();
        for i in 0..many {
            for j in 0..i {
                let first = model.binary(format!("first[{i}][{j}]"))?;
                let (a, b) = (1.0 + random.below(3) as f64, 1.0 + random.below(3) as f64);
                let apart = times[i] - times[j];
                model.add(format!("a[{i}][{j}]"), (apart.clone() + first * 9.0).ge(a))?;
                model.add(format!("b[{i}][{j}]"), (apart + first * 9.0).le(9.0 - b))?;
                cost += first * (random.below(7) as f64 - 3.0);
            }
        }
        model.minimize(cost)?;
        let [zeros, ..] = count(&model, &format!("orders_{k}"), ["v ", "u ", "i "])?;
        assert_eq!(zeros, 1, "{k}");
    }
    Ok(())
}
