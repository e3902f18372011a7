//! Facets that a solve of a prepared model leaves for the next one: they are proved anew for other
//! values of the parameters, so no optimum changes.

use carom::prelude::*;
use proptest::prelude::*;

use crate::common::config;
use crate::common::mode_steps::{ModeSteps, Numbers};
use crate::search::facets::car;

/// A system whose first state and goal are parameters, and these.
fn with_parameters(system: &ModeSteps) -> Result<(Model, [Variable; 2]), Error> {
    let mut model = system.model(false)?;
    let of_step = |step: usize| {
        let prefix = format!("x[{step}]");
        let states = model.variables().filter(|v| v.name().to_string().starts_with(&prefix));
        states.map(|v| v.id()).collect::<Vec<Variable>>()
    };
    let (first, last) = (of_step(0)[0], of_step(system.horizon));
    let start = model.parameter("start", 0.0, -6.0, 6.0)?;
    let goal = model.parameter("least", -6.0, -6.0, 6.0)?;
    model.add("begin", (first - start).equals(0.0))?;
    model.add("end", (last.iter().sum::<Affine>() - goal).ge(0.0))?;
    Ok((model, [start, goal]))
}

proptest! {
    #![proptest_config(config(12, "tests/regressions/kept_facets.txt"))]

    /// Facets are taken whether or not they pay.
    #[test]
    fn kept_facets_change_no_optimum(seed in any::<u64>(), horizon in 1..=4_usize) {
        let numbers = &mut Numbers(seed);
        let (mut model, [start, goal]) = with_parameters(&ModeSteps::random(numbers, horizon))?;
        let mut solver = BranchAndBound::new(Options::default().with_facet_nodes(0));
        let mut plain = BranchAndBound::new(Options::default().with_facets(false));
        let mut prepared = solver.prepare(&model)?;
        for _ in 0..4 {
            let values = [0.5 * numbers.within(-12, 12), numbers.within(-6, 4)];
            let values = [(start, values[0]), (goal, values[1])];
            let kept = prepared.solve(&values, &mut Control::default())?;
            model.set_parameters(&values)?;
            let cold = plain.solve(&model)?;
            prop_assert_eq!(kept.termination(), cold.termination());
            let value = |solution: &Solution| solution.objective().unwrap_or(0.0);
            let gap = (value(&kept) - value(&cold)).abs();
            prop_assert!(gap <= 1e-5 * value(&cold).abs().max(1.0), "{gap}");
            prop_assert_eq!(kept.statistics().contradictions, 0);
        }
    }
}

/// Only the first solve looks for facets; the next ones begin with them.
#[test]
fn facets_are_kept_from_solve_to_solve() -> Result<(), Error> {
    let (program, first) = car(12)?;
    let mut model = program.model().clone();
    let start = model.parameter("start", 8.0, 5.0, 12.0)?;
    model.add("begin", (first - start).equals(0.0))?;
    let mut solver = BranchAndBound::new(Options::default().with_facet_nodes(30));
    let mut prepared = solver.prepare(&model)?;
    let mut begun_again = Vec::new();
    for value in [8.0, 8.3, 7.6] {
        let mut count = 0;
        let mut watch = |event: &Event| count += u32::from(matches!(event, Event::BegunAgain(..)));
        let mut control = Control::default().with_progress(&mut watch);
        let found = prepared.solve(&[(start, value)], &mut control)?;
        begun_again.push(count);
        let facets = found.statistics().facets;
        assert!(facets.facets > 0 && facets.root_before < facets.root_after, "{value}: {facets:?}");
        model.set_parameter(start, value)?;
        let cold = BranchAndBound::new(Options::default().with_facets(false)).solve(&model)?;
        let values = [found.objective(), cold.objective()].map(|value| value.unwrap_or(0.0));
        assert!((values[0] - values[1]).abs() < 1e-5, "{value}: {values:?}");
        assert!(facets.root_after < values[1] + 1e-6, "{value}: {facets:?} of {values:?}");
    }
    assert_eq!(begun_again, [1, 0, 0]);
    Ok(())
}
