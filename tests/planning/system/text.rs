//! The text form of a hybrid system.

use carom::hybrid::{HybridSystem, LinearSystem};
use carom::interval::Interval;
use carom_hybrid::internals::{Choice, Halfspace, Transition};

#[test]
fn everything_is_written() {
    let flow =
        |c: f64| LinearSystem::new([[1.0, 0.5], [0.0, 1.0]], [[0.0], [-2.0]], [0.0, c]).unwrap();
    let system = HybridSystem::new(1.0)
        .with_state("x", Interval::new(0.0, 9.0))
        .with_state("v", Interval::new(-3.0, 3.0))
        .with_input(
            "u",
            vec![Interval::new(0.0, 1.0), Interval::new(0.0, 1.0), Interval::point(0.0)],
        )
        .with_limit(Halfspace::limit("door", [1.0, -1.0, 0.5], vec![4.0, f64::INFINITY]))
        .with_most_events(2)
        .with_disturbance([Interval::point(0.0), Interval::new(-0.5, 0.5)])
        .with_flow(flow(0.0))
        .with_choice(
            Choice::new("heater")
                .with_transition(
                    Transition::event("start", flow(1.0))
                        .between("off", "on")
                        .with_guard(Halfspace::new("near", [1.0, 0.0], 2.0))
                        .with_input_range("u", Interval::new(0.0, 2.0))
                        .with_prediction_guard(Halfspace::new("slow", [0.0, 1.0], 1.0))
                        .with_reset_by_step(
                            [[1.0, 0.0], [0.0, -1.0]],
                            vec![vec![0.0, 0.0], vec![0.0, -0.25]],
                        )
                        .with_output("speed", [0.0, -1.0], 0.5),
                )
                .with_transition(Transition::new("heat", flow(-1.0)).within("on"))
                .with_dwell("on", 2, 5)
                .with_free_choice(true),
        )
        .with_choice(
            Choice::new("rest")
                .with_transition(Transition::new("rest", flow(0.0)))
                .with_dead_ends(true),
        );
    system.check().unwrap();
    let expected = "\
state x in [0, 9]
state v in [-3, 3]
input u in [0, 1] until step 1, [0, 0] from then on
always x - v + 0.5 u <= 4 until step 0, inf from then on (door; a limit)
at most 2 events
disturbance of x in [0, 0]
disturbance of v in [-0.5, 0.5]
common flow
    x' = x + 0.5 v
    v' = v - 2 u
choice heater, free
  on lasts for 2 to 5 samples
  transition start, from off to on (event)
    if x <= 2 (near)
    u in [0, 2]
    x' = x + 0.5 v
    v' = v - 2 u + 1
    if v' <= 1 (slow)
    x+ = x'
    v+ = -v' until step 0, -v' - 0.25 from then on
    speed = -v' + 0.5
  transition heat, from on to on
    x+ = x + 0.5 v
    v+ = v - 2 u - 1
choice rest, may end
  transition rest
    x+ = x + 0.5 v
    v+ = v - 2 u
";
    assert_eq!(system.to_string(), expected);
}
