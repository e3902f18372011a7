//! Proofs of programs that are hardly branched, because cuts do the work.

use super::*;

/// Lots of several items on one machine, with setups: random demands and costs.
fn lots(seed: u64, items: usize, periods: usize) -> Result<Model, Error> {
    let mut state = seed;
    let mut number = |most: u64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % most) as f64
    };
    let mut model = Model::new("lots");
    let mut cost = Affine::from(0.0);
    let mut load = vec![Affine::from(0.0); periods];
    for item in 0..items {
        let mut stock = Affine::from(0.0);
        for (period, load) in load.iter_mut().enumerate() {
            let name = |what: &str| format!("{what}[{item},{period}]");
            let lot = model.continuous(name("lot"), 0.0, 200.0)?;
            let kept = model.continuous(name("kept"), 0.0, 500.0)?;
            let setup = model.binary(name("setup"))?;
            let demand = 5.0 * number(9);
            model.add(name("balance"), (stock + lot - kept).equals(demand))?;
            model.add(name("setup"), (lot - setup * 150.0).le(0.0))?;
            stock = kept.into();
            *load += lot + setup * 10.0;
            cost += setup * (100.0 + 10.0 * number(20)) + kept * (1.0 + number(3));
        }
    }
    for (period, load) in load.into_iter().enumerate() {
        model.add(format!("capacity[{period}]"), load.le(130.0))?;
    }
    model.minimize(cost)?;
    Ok(model)
}

/// A proof has the cuts of the search, in whose rows equalities have replaced columns, and so is
/// not much longer than the tree.
#[test]
fn a_proof_has_the_cuts_of_its_search() -> Result<(), Error> {
    let (mut nodes, mut commands) = (0, 0);
    for seed in 0..12 {
        let solution = is_proved(&lots(seed, 4, 10)?, &format!("lots_{seed}"));
        nodes += solution.statistics().nodes;
        commands += solution.proof().map_or(0, |proof| proof.commands);
    }
    assert!(commands < 100_000, "{commands} commands for {nodes} nodes");
    Ok(())
}
