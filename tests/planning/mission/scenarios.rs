//! The scenarios of stlpy, with the optima that other solvers find for their programs in rows.

use carom::prelude::*;

#[path = "../../instances/missions.rs"]
mod missions;

use missions::{Point, SCENARIOS};

fn assert_solved(name: &str) -> Result<(), Error> {
    let scenario = SCENARIOS.iter().find(|own| own.name == name).expect("a scenario");
    let point = Point::new()?;
    let (program, mission, margin) = scenario.program(&point)?;
    let plan = program.solve(&mut BranchAndBound::default())?;
    // By another way than the rows.
    let robustness = plan.robustness(&mission)?;
    assert!(robustness >= plan.value(margin, 0)? - 1e-6);
    assert!((point.system.robustness(&mission, &plan.run)? - robustness).abs() < 1e-9);
    let (found, expected) = (plan.solution.objective().expect("there is one"), scenario.optimum);
    assert!((found - expected).abs() < 2e-6 * (1.0 + expected.abs()), "{found}, not {expected}");
    Ok(())
}

#[test]
fn a_goal_behind_an_obstacle() -> Result<(), Error> {
    assert_solved("reach_avoid_l")?;
    assert_solved("reach_avoid_q")
}

#[test]
fn one_of_two_targets_for_a_while_and_then_a_goal() -> Result<(), Error> {
    assert_solved("either_or_l")?;
    assert_solved("either_or_q")
}

#[test]
fn one_of_two_goals_through_a_narrow_passage() -> Result<(), Error> {
    assert_solved("narrow_passage_l")
}

#[test]
fn a_door_that_needs_a_key() -> Result<(), Error> {
    assert_solved("door_puzzle_l")
}

#[test]
fn one_target_of_each_group() -> Result<(), Error> {
    assert_solved("multitarget_l")
}

#[test]
fn stepping_stones() -> Result<(), Error> {
    assert_solved("stepping_stones_l")
}
