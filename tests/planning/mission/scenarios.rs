//! The scenarios of stlpy (Kurtz and Lin, arXiv:2204.06367), with the optima that other solvers find for their
//! programs in rows.

use carom::hybrid::Mission;
use carom::prelude::*;

struct Point {
    system: HybridSystem,
    position: [State; 2],
    velocity: [State; 2],
    input: [Variable; 2],
}

impl Point {
    fn new() -> Result<Point, Error> {
        let mut system = HybridSystem::new(1.0);
        let position = [system.state("x", 0.0, 10.0)?, system.state("y", 0.0, 10.0)?];
        let velocity = [system.state("vx", -1.0, 1.0)?, system.state("vy", -1.0, 1.0)?];
        let input = [system.input("ux", -0.5, 0.5)?, system.input("uy", -0.5, 0.5)?];
        let next = (0..2).flat_map(|k| {
            let (p, v) = (position[k], velocity[k]);
            [p.is(p + v), v.is(v + input[k])]
        });
        let next: Vec<_> = next.collect();
        system.mode("drift")?.next(next)?;
        Ok(Point { system, position, velocity, input })
    }

    fn within(&self, name: &str, [x0, x1, y0, y1]: [f64; 4]) -> Mission {
        let [x, y] = self.position;
        Mission::holds(name, [x.within(x0, x1), y.within(y0, y1)])
    }

    /// The least cost, by the weights of squares of velocities and inputs.
    fn least(
        &self,
        start: [f64; 2],
        steps: usize,
        mission: &Mission,
        weights: [f64; 2],
    ) -> Result<f64, Error> {
        let mut program = self.system.program(steps)?;
        let ([x, y], [vx, vy]) = (self.position, self.velocity);
        let at = [x.equals(start[0]), y.equals(start[1]), vx.equals(0.0), vy.equals(0.0)];
        program.start(at)?;
        let margin = program.mission_margin("margin", mission, 0.0)?;
        let mut cost = Quadratic::from(-Affine::from(margin));
        for k in 0..=steps {
            for axis in 0..2 {
                cost += weights[0] * program.variable(self.velocity[axis], k)?.square();
                if k < steps {
                    cost += weights[1] * program.variable(self.input[axis], k)?.square();
                }
            }
        }
        program.minimize(cost)?;
        let plan = program.solve(&mut BranchAndBound::default())?;
        // By another way than the rows.
        assert!(plan.robustness(mission)? >= plan.value(margin, 0)? - 1e-6);
        assert!(
            (self.system.robustness(mission, &plan.run)? - plan.robustness(mission)?).abs() < 1e-9
        );
        Ok(plan.solution.objective().expect("there is one"))
    }
}

fn assert_near(value: f64, expected: f64) {
    assert!((value - expected).abs() < 2e-6 * (1.0 + expected.abs()), "{value}, not {expected}");
}

#[test]
fn a_goal_behind_an_obstacle() -> Result<(), Error> {
    let point = Point::new()?;
    let goal = point.within("goal", [7.0, 8.0, 8.0, 9.0]);
    let obstacle = point.within("obstacle", [3.0, 5.0, 4.0, 6.0]);
    let mission = (!obstacle).always(0..=10) & goal.eventually(0..=10);
    let start = [1.0, 2.0];
    assert_near(point.least(start, 10, &mission, [0.0, 0.0])?, -0.5);
    assert_near(point.least(start, 10, &mission, [0.1, 0.1])?, 0.7417690580794793);
    Ok(())
}

#[test]
fn one_of_two_targets_for_a_while_and_then_a_goal() -> Result<(), Error> {
    let point = Point::new()?;
    let goal = point.within("goal", [7.0, 8.0, 8.0, 9.0]);
    let one = point.within("one", [1.0, 2.0, 6.0, 7.0]);
    let two = point.within("two", [7.0, 8.0, 4.5, 5.5]);
    let obstacle = point.within("obstacle", [3.0, 5.0, 4.0, 6.0]);
    let dwell = one.always(0..=5) | two.always(0..=5);
    let mission =
        dwell.eventually(0.0..=15.0) & (!obstacle).always(0.0..=20.0) & goal.eventually(0..=20);
    assert_near(point.least([2.0, 2.0], 20, &mission, [0.0, 0.0])?, -0.5);
    assert_near(point.least([2.0, 2.0], 20, &mission, [0.1, 1.0])?, 0.789260481821);
    Ok(())
}

#[test]
fn one_of_two_goals_through_a_narrow_passage() -> Result<(), Error> {
    let point = Point::new()?;
    let north = point.within("north", [7.0, 8.0, 8.0, 9.0]);
    let east = point.within("east", [9.5, 10.5, 1.5, 2.5]);
    let walls =
        [[2.0, 5.0, 4.0, 6.0], [5.5, 9.0, 3.8, 5.7], [4.6, 8.0, 0.5, 3.5], [2.2, 4.4, 6.4, 11.0]];
    let clear = walls.iter().zip(1..).map(|(w, k)| !point.within(&format!("wall {k}"), *w));
    let mission = Mission::all(clear).always(0..) & (north | east).eventually(0..);
    assert_near(point.least([3.0, 3.6], 25, &mission, [0.0, 0.0])?, -0.4);
    Ok(())
}

#[test]
fn a_door_that_needs_a_key() -> Result<(), Error> {
    let point = Point::new()?;
    let key = point.within("at the key", [1.0, 2.0, 7.0, 8.0]);
    let door = point.within("in the door", [4.0, 5.0, 4.0, 5.0]);
    let walls = [[4.0, 5.0, -1.0, 4.0], [4.0, 5.0, 5.0, 11.0]];
    let clear = walls.iter().zip(1..).map(|(w, k)| !point.within(&format!("wall {k}"), *w));
    let goal = point.within("goal", [8.0, 9.0, 4.0, 5.0]);
    let until_key = (!door).until(0.., key);
    let mission = Mission::all(clear).always(0..) & until_key & goal.eventually(0..);
    // SCIP 10 finds the same for a program with a binary for each part and sample.
    assert_near(point.least([1.0, 4.0], 13, &mission, [0.0, 0.0])?, -1.0 / 6.0);
    Ok(())
}

#[test]
fn one_target_of_each_group() -> Result<(), Error> {
    let point = Point::new()?;
    let groups = [
        [[1.0, 2.0, 3.0, 4.0], [8.0, 9.0, 1.0, 2.0]],
        [[3.0, 4.0, 6.5, 7.5], [8.0, 9.0, 8.0, 9.0]],
        [[6.6, 7.4, 5.0, 6.0], [0.0, 1.0, 9.0, 10.0]],
    ];
    let visits = groups.iter().enumerate().map(|(g, group)| {
        let targets =
            group.iter().zip(1..).map(|(t, k)| point.within(&format!("target {g} {k}"), *t));
        Mission::any(targets).eventually(0..)
    });
    let obstacle = point.within("obstacle", [4.0, 6.0, 4.0, 6.0]);
    let mission = Mission::all(visits) & (!obstacle).always(0..);
    // As SCIP 10.
    assert_near(point.least([2.0, 1.0], 11, &mission, [0.0, 0.0])?, -0.3529411764705882);
    Ok(())
}

#[test]
fn stepping_stones() -> Result<(), Error> {
    let point = Point::new()?;
    let stones = [
        [0.5, 1.7, 0.5, 1.5],
        [1.5, 2.9, 1.2, 2.2],
        [2.6, 3.8, 1.8, 3.2],
        [1.0, 2.2, 2.5, 3.5],
        [3.4, 4.6, 2.9, 4.1],
        [3.0, 4.4, 3.8, 4.8],
    ];
    let stone = |k: usize| point.within(&format!("stone {k}"), stones[k]);
    let mission = Mission::any((0..6).map(stone)).always(0..) & stone(5).eventually(0..);
    // As SCIP 10.
    assert_near(point.least([1.0, 1.0], 12, &mission, [0.0, 0.0])?, -0.45);
    Ok(())
}
