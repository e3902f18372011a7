//! Networks with arcs that cost to open.

use carom::prelude::*;

/// A network of parallel and crossing arcs, each much wider than most needs; opening one costs 1.
fn network(nodes: usize, arcs: usize) -> Model {
    let mut state = 7_u64;
    let mut number = |most: usize| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % most
    };
    let mut model = Model::new("network");
    let mut takes = vec![Affine::default(); nodes];
    let mut cost = Affine::default();
    let wide = 50.0 * nodes as f64;
    for k in 0..arcs {
        let flow = model.continuous(format!("flow{k}"), 0.0, wide).unwrap();
        let open = model.binary(format!("open{k}")).unwrap();
        model.add(format!("switch{k}"), (flow - wide * open).le(0.0)).unwrap();
        // Every node can be reached from its neighbours.
        let from = if k < 2 * nodes { k % nodes } else { number(nodes) };
        let step = if k < nodes { 1 } else { 1 + number(nodes - 1) };
        takes[from] -= flow;
        takes[(from + step) % nodes] += flow;
        cost += open;
    }
    let mut total = 0.0;
    for (i, sum) in takes.into_iter().enumerate() {
        let need = if i + 1 == nodes {
            -total
        } else {
            match number(5) {
                0 => 1.0 + number(40) as f64,
                1 => -1.0 - number(40) as f64,
                _ => 0.0,
            }
        };
        total += need;
        model.add(format!("node{i}"), sum.equals(need)).unwrap();
    }
    model.minimize(cost).unwrap();
    model
}

#[test]
fn sets_of_nodes_that_need_a_flow_bound_the_cost() {
    let model = network(40, 90);
    // Without them, the bound is at 16 after 5,000 nodes.
    let options = Options::default().with_node_limit(200);
    let solution = BranchAndBound::new(options).solve(&model).unwrap();
    assert_eq!(solution.termination(), Termination::Optimal);
    assert_eq!(solution.objective().map(f64::round), Some(19.0));
}
