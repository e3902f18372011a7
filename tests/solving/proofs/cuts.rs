//! Proofs of programs that are hardly branched, because cuts do the work.

use super::*;

/// Lots of several items on one machine, with setups: random demands and costs.
fn lots(model: &mut Model, seed: u64, items: usize, periods: usize) -> Result<Affine, Error> {
    let mut state = seed;
    let mut number = |most: u64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % most) as f64
    };
    let mut cost = Affine::from(0.0);
    let mut load = vec![Affine::from(0.0); periods];
    for item in 0..items {
        let mut stock = Affine::from(0.0);
        for (period, load) in load.iter_mut().enumerate() {
            let name = |what: &str| format!("{what}[{seed},{item},{period}]");
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
        model.add(format!("capacity[{seed},{period}]"), load.le(130.0))?;
    }
    Ok(cost)
}

/// A proof has the cuts of the search, in whose rows equalities have replaced columns, and so is
/// not much longer than the tree.
#[test]
fn a_proof_has_the_cuts_of_its_search() -> Result<(), Error> {
    let (mut nodes, mut commands) = (0, 0);
    for seed in 0..12 {
        let mut model = Model::new("lots");
        let cost = lots(&mut model, seed, 4, 10)?;
        model.minimize(cost)?;
        let solution = is_proved(&model, &format!("lots_{seed}"));
        nodes += solution.statistics().nodes;
        commands += solution.proof().map_or(0, |proof| proof.commands);
    }
    assert!(commands < 100_000, "{commands} commands for {nodes} nodes");
    Ok(())
}

/// Two machines: each block has lemmas and a search of its own, and none uses what holds in the
/// other alone.
#[test]
fn blocks_have_the_cuts_of_their_search() -> Result<(), Error> {
    for seed in 0..4 {
        let mut model = Model::new("two machines");
        let one = lots(&mut model, seed, 4, 8)?;
        let two = lots(&mut model, seed + 100, 4, 8)?;
        model.minimize(one + two)?;
        let solution = is_proved(&model, &format!("machines_{seed}"));
        assert!(solution.is_optimal() || solution.is_infeasible());
    }
    Ok(())
}
