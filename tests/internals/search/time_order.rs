//! The order of binaries in time.

use carom::internals::program::Program;
use carom::internals::search::time_order::in_time;
use carom::model::Model;

/// A chain of twelve steps, written down in a strange order.
#[test]
fn the_order_of_columns_and_names_does_not_matter() {
    const STEPS: usize = 12;
    let order: Vec<usize> = (0..STEPS).map(|k| (5 * k) % STEPS).collect();
    let mut model = Model::new("chain");
    let mut state = [None; STEPS + 1];
    let mut hit = [None; STEPS];
    for &t in &order {
        state[t] = Some(model.continuous(format!("q{}", 7 * t % 13), 0.0, 9.0).unwrap());
        hit[t] = Some(model.binary(format!("h{}", 5 * t % 13)).unwrap());
    }
    state[STEPS] = Some(model.continuous("end", 0.0, 9.0).unwrap());
    for &t in &order {
        let (now, next) = (state[t].unwrap(), state[t + 1].unwrap());
        model.add(format!("r{t}"), (next - now - hit[t].unwrap()).within(-1.0, 1.0)).unwrap();
    }
    let program = Program::assemble(&model).unwrap();
    let found = in_time(&program).unwrap();
    let mut wanted: Vec<usize> = hit.iter().map(|h| h.unwrap().index()).collect();
    if found[0] != wanted[0] {
        wanted.reverse();
    }
    assert_eq!(found, wanted);
}

#[test]
fn a_knapsack_is_no_chain() {
    let mut model = Model::new("knapsack");
    let z = model.binary_family("z", 12).unwrap();
    for pair in z.as_slice().windows(2) {
        model.add(format!("p{}", pair[0].index()), (pair[0] + z[0] + pair[1]).le(2.0)).unwrap();
    }
    assert_eq!(in_time(&Program::assemble(&model).unwrap()), None);
}
