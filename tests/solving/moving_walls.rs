//! Plans between moving walls: prepared solves, each begun with what the last one has left, cost
//! what solves from nothing cost, from any states and with any walls.

use std::ops::ControlFlow;

use carom::prelude::*;
use proptest::prelude::*;

use crate::instances::moving_walls::{Gust, MovingWalls, after};

/// A state with walls: position, angle, their rates, and the distances of both walls.
fn measured() -> impl Strategy<Value = [f64; 6]> {
    [-0.4..0.4, -0.5..0.5, -2.0..2.0, -4.0..4.0, 0.25..0.5, 0.25..0.5]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn prepared_plans_cost_what_plans_from_nothing_do(
        steps in 3..8_usize,
        jumps in prop::collection::vec((measured(), 0..3_usize), 3),
    ) {
        let MovingWalls { mut model, push } = MovingWalls::new(steps).unwrap();
        let parameters: Vec<Variable> = model.parameters().collect();
        let [mut cold, mut solver] = [(); 2].map(|()| BranchAndBound::default());
        let mut prepared = solver.prepare(&model).unwrap();
        for ([x, angle, v, rate, left, right], follows) in jumps {
            // A jump, and states that follow from it in the loop.
            let (mut state, walls) = ([x, angle, v, rate], [left, right]);
            let gust = Gust { torque: 1.0, walls };
            for passed in 0..=follows {
                let values = state.into_iter().chain(walls);
                let values: Vec<(Variable, f64)> = parameters.iter().copied().zip(values).collect();
                model.set_parameters(&values).unwrap();
                let one = cold.solve(&model).unwrap();
                let mut told = Vec::new();
                let mut note = |best: &Incumbent<'_>| {
                    told.push(best.objective);
                    ControlFlow::Continue(())
                };
                let mut control =
                    Control::default().with_steps_passed(passed).with_incumbent(&mut note);
                let warm = prepared.solve(&values, &mut control).unwrap();
                prop_assert_eq!(one.termination(), warm.termination());
                let Some((best, own)) = one.objective().zip(warm.objective()) else { break };
                let slack = 3e-6 * best.abs().max(1.0);
                prop_assert!((best - own).abs() <= slack, "{} and {}", best, own);
                // Each better plan is told once.
                prop_assert!(told.windows(2).all(|two| two[1] < two[0]), "{:?}", told);
                prop_assert!(told.last().is_some_and(|last| (last - own).abs() <= slack));
                prop_assert!(warm.bound() <= best + slack && one.bound() <= own + slack);
                prop_assert!(warm.verification().is_some_and(|check| check.holds()));
                state = after(state, warm.value(&push).unwrap(), &gust, 0.02);
            }
        }
    }
}

/// The last plan, completed for the new state, is told before the root is relaxed, and whoever is
/// content with it ends the solve.
#[test]
fn the_completed_plan_is_told_first() {
    let MovingWalls { model, .. } = MovingWalls::new(6).unwrap();
    let parameters: Vec<Variable> = model.parameters().collect();
    let mut solver = BranchAndBound::default();
    let mut prepared = solver.prepare(&model).unwrap();
    let mut found = Vec::new();
    for x in [0.0, 0.001] {
        let values = [x, -0.05, 0.5, -0.5, 0.4, 0.35];
        let values: Vec<(Variable, f64)> = parameters.iter().copied().zip(values).collect();
        let mut nodes = None;
        let mut note = |best: &Incumbent<'_>| {
            nodes.get_or_insert(best.progress.nodes);
            if x > 0.0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        let mut control = Control::default().with_incumbent(&mut note);
        found.push(prepared.solve(&values, &mut control).unwrap());
        assert!(x == 0.0 || nodes == Some(0));
    }
    assert!(found[0].is_optimal());
    assert_eq!(found[1].termination(), Termination::Interrupted);
    assert!(found[1].point().is_some() && found[1].bound() <= found[1].objective().unwrap());
}
