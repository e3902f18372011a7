//! The order in which a roll-out fixes columns.

use carom::model::Model;
use carom_solver::internals::presolve::Domain;
use carom_solver::internals::program::Program;
use carom_solver::internals::search::heuristics::Frontier;

/// Three steps of a double integrator that starts at rest: the inputs come one after the other, in
/// the order of time, although they stand last.
#[test]
fn inputs_come_in_the_order_of_time() {
    const STEPS: usize = 3;
    let mut model = Model::new("cart");
    let place = model.continuous_family("place", STEPS + 1, -10.0, 10.0).unwrap();
    let speed = model.continuous_family("speed", STEPS + 1, -10.0, 10.0).unwrap();
    let push = model.continuous_family("push", STEPS, -1.0, 1.0).unwrap();
    for (first, name) in [(place[0], "here"), (speed[0], "rest")] {
        model.add(name, first.equals(0.0)).unwrap();
    }
    for t in 0..STEPS {
        let moved = place[t + 1] - place[t] - speed[t] - 0.5 * push[t];
        model.add(format!("place{t}"), moved.equals(0.0)).unwrap();
        let pushed = speed[t + 1] - speed[t] - push[t];
        model.add(format!("speed{t}"), pushed.equals(0.0)).unwrap();
    }
    let program = Program::assemble(&model).unwrap();
    let mut domain = Domain::new(&program);
    for j in [place[0].index(), speed[0].index()] {
        domain.apply(j, false, 0.0);
        domain.apply(j, true, 0.0);
    }
    let mut frontier = Frontier::new(&program, &domain);
    for t in 0..STEPS {
        // In the last step the states reach no further than the input.
        assert!(t == STEPS - 1 || frontier.next_column() == Some(push[t].index()));
        // What propagation would conclude.
        for known in [push[t], place[t + 1], speed[t + 1]] {
            frontier.learn(known.index());
        }
    }
    assert_eq!(frontier.next_column(), None);
}
