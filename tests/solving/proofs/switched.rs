//! Squares that binaries switch off: the logs of programs with them are made tighter by products
//! that are 0.

use carom::model::Model;
use carom::prelude::*;
use carom_proof::check;

use super::solved;
use crate::torture::generator::Random;

/// Units that are on or off in some periods, with quadratic costs, limits while they are on, costs
/// of starts and a demand. `at` is the value of a unit while it is off; binaries may be turned
/// round or shared by two units.
fn units(random: &mut Random) -> Result<Model, Error> {
    let mut model = Model::new("units");
    let (many, periods) = (2 + random.below(3), 1 + random.below(3));
    let mut cost = Quadratic::default();
    let mut sums = vec![Affine::default(); periods];
    let mut most = 0.0;
    let mut shared = None;
    for unit in 0..many {
        let is_whole = random.chance(0.2);
        let at = if random.chance(0.3) { random.below(3) as f64 } else { 0.0 };
        let (low, high) = (1.0 + random.below(3) as f64, 5.0 + random.below(9) as f64);
        let curvature = 0.1 * (1.0 + random.below(20) as f64);
        let (fixed, start) = (random.below(30) as f64 * 0.7, random.below(20) as f64);
        let is_inverted = random.chance(0.3);
        let (is_shared, has_both_signs) = (random.chance(0.3), random.chance(0.2));
        most += at + high;
        let mut before: Option<Affine> = None;
        let mut own = Vec::new();
        for (period, sum) in sums.iter_mut().enumerate() {
            let name = |what: &str| format!("{what}[{unit},{period}]");
            let lower = if has_both_signs { at - high } else { at };
            let x = match is_whole {
                true => model.integer(name("x"), lower, at + high)?,
                false => model.continuous(name("x"), lower, at + high)?,
            };
            let z = match shared.as_ref().filter(|_| is_shared) {
                Some(binaries) => {
                    let binaries: &Vec<Variable> = binaries;
                    binaries[period]
                }
                None => model.binary(name("z"))?,
            };
            own.push(z);
            let w: Affine = if is_inverted { 1.0 - z } else { z * 1.0 };
            model.add(name("high"), (x - w.clone() * high).le(at))?;
            let least = if has_both_signs { -high } else { low };
            model.add(name("low"), (x - w.clone() * least).ge(at))?;
            cost += (x - 0.3 * at).square() * curvature + x * (random.below(5) as f64);
            cost += w.clone() * fixed;
            if let Some(before) = before {
                let s = model.continuous(name("start"), 0.0, 1.0)?;
                model.add(name("starts"), (s - w.clone() + before).ge(0.0))?;
                cost += s * start;
            }
            before = Some(w);
            *sum += x;
        }
        shared = Some(own);
    }
    for (period, sum) in sums.into_iter().enumerate() {
        let demand = most * (0.2 + 0.1 * random.below(6) as f64);
        model.add(format!("demand[{period}]"), sum.ge(demand))?;
    }
    model.minimize(cost)?;
    Ok(model)
}

/// Each log is complete and accepted, and claims the answer of a solve without a log. Most have
/// products.
#[test]
fn logs_of_switched_squares_are_accepted() -> Result<(), Error> {
    let mut random = Random::new(5);
    let (mut logs, mut with_products) = (0, 0);
    for seed in 0..60 {
        let model = units(&mut random)?;
        let (solution, log) = solved(&model, &format!("switched_{seed}"));
        let plain = BranchAndBound::default().solve(&model)?;
        let (own, other) = (solution.objective(), plain.objective());
        let gap = 1e-5 * other.unwrap_or(1.0).abs().max(1.0);
        assert_eq!(own.is_some(), other.is_some(), "{seed}");
        assert!((own.unwrap_or(0.0) - other.unwrap_or(0.0)).abs() <= gap, "{seed}");
        let report = solution.proof().expect("a log");
        let proved = check(&log[..]).unwrap_or_else(|failure| panic!("{seed}: {failure}"));
        assert!(report.is_complete, "{seed}: {report:?}");
        if let (carom_proof::Claim::Bound(bound), Some(own)) = (proved.claim, own) {
            assert!(own - bound <= gap, "{seed}: {bound} of {own}");
        }
        let text = String::from_utf8(log).expect("text");
        logs += 1;
        with_products += u32::from(text.lines().any(|line| line.starts_with("e ")));
    }
    assert!(2 * with_products > logs, "{with_products} of {logs}");
    Ok(())
}
