//! An arm of two links moves its hand past a post, in the least number of steps.
//!
//! `cargo run --release --example two_link_arm [PICTURE.svg]`
//!
//! Joints turn at limited rates, so the flow is linear; where hand and forearm are is a matter of
//! sines and cosines of the joints.

use carom::picture::{AVOIDED, Chart, GOAL_COLOUR, WITHOUT_COLLISION};
use carom::prelude::*;

/// The post (m): from left to right, and from below to above.
const POST: [[f64; 2]; 2] = [[1.0, 1.3], [0.3, 0.6]];

/// The least distance of the post from the line of the forearm (m).
const MARGIN: f64 = 0.03;

/// Where the hand should end (m).
const GOAL: [[f64; 2]; 2] = [[0.9, 1.0], [1.1, 1.2]];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arm = HybridSystem::new(0.2); // s
    let shoulder = arm.state("shoulder", -1.0, 2.0)?; // rad
    let elbow = arm.state("elbow", -2.5, 2.5)?; // rad
    let u = arm.input("shoulder rate", -1.5, 1.5)?; // rad/s
    let w = arm.input("elbow rate", -2.0, 2.0)?; // rad/s
    arm.rates([shoulder.is(u), elbow.is(w)])?;
    // Links of 1 m.
    let elbow_at = [shoulder.cos(), shoulder.sin()];
    let forearm = [(shoulder + elbow).cos(), (shoulder + elbow).sin()];
    let hand = [0, 1].map(|axis| &elbow_at[axis] + &forearm[axis]);
    let [x, y] = hand;
    // The forearm has the post on one side of its line, or ends before it.
    let corners = [0, 1].map(|i| [0, 1].map(|j| [POST[0][i], POST[1][j]]));
    let beside = |[along, above]: [f64; 2]| above * &forearm[0] - along * &forearm[1] + elbow.sin();
    let mut right = arm.mode_of("forearm", "right of the post")?;
    for corner in corners.concat() {
        right = right.guard(beside(corner).ge(MARGIN))?;
    }
    let mut left = arm.mode_of("forearm", "left of the post")?;
    for corner in corners.concat() {
        left = left.guard(beside(corner).le(-MARGIN))?;
    }
    arm.mode_of("forearm", "before the post")?.guard(x.le(POST[0][0]))?;
    arm.mode_of("forearm", "below the post")?.guard(y.le(POST[1][0]))?;
    let start = [shoulder.equals(-0.5), elbow.equals(0.3)];
    let goal = [x.within(GOAL[0][0], GOAL[0][1]), y.within(GOAL[1][0], GOAL[1][1])];
    let found = arm.shortest(start, goal, &mut BranchAndBound::default())?;
    println!("{found}");
    let Some(plan) = found.plan else { return Ok(()) };
    print!("{}", plan.run.to_csv());
    let Some(path) = std::env::args().nth(1) else { return Ok(()) };

    let mut chart = Chart::new("x (m)", "y (m)").with_equal_axes().with_size(560.0, 520.0);
    chart.rectangles(AVOIDED, [[[POST[0][0], POST[1][0]], [POST[0][1], POST[1][1]]]]);
    let [[left, right], [low, high]] = GOAL;
    chart.area("", GOAL_COLOUR, 0.4, [[left, low], [right, low], [right, high], [left, high]]);
    let angles = plan.run.state("shoulder")?.iter().zip(plan.run.state("elbow")?);
    for (shoulder, elbow) in angles {
        let at = [shoulder.cos(), shoulder.sin()];
        let hand = [at[0] + (shoulder + elbow).cos(), at[1] + (shoulder + elbow).sin()];
        chart.line_of_width(2.0, "", WITHOUT_COLLISION[0], [[0.0, 0.0], at, hand]);
    }
    let steps = plan.run.state("elbow")?.len() - 1;
    let title = format!("The hand is at its goal after {steps} steps of 0.2 s; no plan has fewer");
    std::fs::write(path, Chart::to_svg(&[chart], &title))?;
    Ok(())
}
