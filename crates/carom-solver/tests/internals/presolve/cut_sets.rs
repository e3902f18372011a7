//! Cut sets keep every whole point.
//!
//! Random networks with arcs that binaries open are enumerated: a choice of binaries is a point if
//! some whole flow meets all rows, which is so whenever any flow does.

use carom::prelude::*;
use carom::solver::StopToken;
use carom_solver::internals::presolve::{Domain, Propagator};
use carom_solver::internals::program::Program;
use carom_solver::internals::search::cuts::cut_set_cuts;
use proptest::prelude::*;

use crate::common::config;

const REGRESSIONS: &str = "tests/regressions/cut_sets.txt";

const NODES: usize = 5;

#[derive(Debug, Clone)]
struct Arc {
    ends: [usize; 2],
    /// Over the flow through a closed arc, and how much more an open one has.
    constant: i32,
    capacity: i32,
    /// Whether the flow has no bound but that of the row.
    free: bool,
    /// Whether a binary opens it.
    switched: bool,
    open: f64,
    flow: f64,
}

#[derive(Debug, Clone)]
struct Network {
    arcs: Vec<Arc>,
    /// What each node takes, and whether it may take more.
    nodes: Vec<(i32, bool)>,
}

fn network() -> impl Strategy<Value = Network> {
    let value = || prop_oneof![2 => 0.0..=1.0, 1 => Just(0.0), 1 => Just(1.0)];
    let capacity = prop_oneof![3 => 1..=3, 1 => Just(60), 1 => Just(500)];
    let constant = prop_oneof![4 => Just(0), 1 => Just(1)];
    let flags = (prop::bool::weighted(0.3), prop::bool::weighted(0.85));
    let ends = (0..NODES, 1..NODES).prop_map(|(a, step)| [a, (a + step) % NODES]);
    let arc = (ends, constant, capacity, flags, value(), value()).prop_map(
        |(ends, constant, capacity, (free, switched), open, flow)| Arc {
            ends,
            constant,
            capacity,
            free: free && switched,
            switched,
            open,
            flow,
        },
    );
    let node = (prop_oneof![2 => Just(0), 3 => -2..=2], prop::bool::weighted(0.2));
    (prop::collection::vec(arc, 3..9), prop::collection::vec(node, NODES))
        .prop_map(|(arcs, nodes)| Network { arcs, nodes })
}

impl Network {
    fn model(&self) -> Model {
        let mut model = Model::new("network");
        let mut takes = vec![Affine::default(); NODES];
        for (k, arc) in self.arcs.iter().enumerate() {
            let most = f64::from(arc.constant + arc.capacity);
            let upper = if arc.free { f64::INFINITY } else { most };
            let flow = model.continuous(format!("flow{k}"), 0.0, upper).unwrap();
            if arc.switched {
                let open = model.binary(format!("open{k}")).unwrap();
                let row = (flow - f64::from(arc.capacity) * open).le(f64::from(arc.constant));
                model.add(format!("switch{k}"), row).unwrap();
            }
            let [from, to] = arc.ends;
            takes[from] -= flow;
            takes[to] += flow;
        }
        for (i, (sum, &(need, more))) in takes.into_iter().zip(&self.nodes).enumerate() {
            let need = f64::from(need);
            if !sum.terms().is_empty() {
                let row = if more { sum.ge(need) } else { sum.equals(need) };
                model.add(format!("node{i}"), row).unwrap();
            }
        }
        model
    }

    /// Whether flows of these arcs can meet all nodes: augmenting paths from what is missing.
    fn can_flow(&self, open: &[bool]) -> bool {
        // Nodes with arcs, a source and a sink; what a node may take more goes to a drain.
        let (source, sink, drain) = (NODES, NODES + 1, NODES + 2);
        let mut room = vec![vec![0_i64; NODES + 3]; NODES + 3];
        for (arc, &open) in self.arcs.iter().zip(open) {
            let closed = if arc.switched { arc.constant } else { arc.constant + arc.capacity };
            let most = if open { arc.constant + arc.capacity } else { closed };
            room[arc.ends[0]][arc.ends[1]] += i64::from(most);
        }
        let mut wanted = 0;
        let touched = |i: usize| self.arcs.iter().any(|arc| arc.ends.contains(&i));
        let net: i32 = (0..NODES).filter(|&i| touched(i)).map(|i| self.nodes[i].0).sum();
        for i in (0..NODES).filter(|&i| touched(i)) {
            let (need, more) = self.nodes[i];
            if need > 0 {
                room[i][sink] += i64::from(need);
                wanted += i64::from(need);
            } else {
                room[source][i] += i64::from(-need);
            }
            if more {
                room[i][drain] += 1_000_000;
            }
        }
        // What sources have over must drain away.
        if net > 0 {
            return false;
        }
        room[drain][sink] += i64::from(-net);
        wanted += i64::from(-net);
        let mut sent = 0;
        while augment(&mut room, source, sink) {
            sent += 1;
        }
        sent == wanted
    }
}

/// Sends one unit along a path with room.
fn augment(room: &mut [Vec<i64>], source: usize, sink: usize) -> bool {
    let mut from = vec![usize::MAX; room.len()];
    let mut queue = vec![source];
    from[source] = source;
    while let Some(at) = queue.pop() {
        for next in 0..room.len() {
            if room[at][next] > 0 && from[next] == usize::MAX {
                from[next] = at;
                queue.push(next);
            }
        }
    }
    if from[sink] == usize::MAX {
        return false;
    }
    let mut at = sink;
    while at != source {
        room[from[at]][at] -= 1;
        room[at][from[at]] += 1;
        at = from[at];
    }
    true
}

proptest! {
    #![proptest_config(config(1000, REGRESSIONS))]

    #[test]
    fn no_whole_point_is_cut_off(network in network()) {
        let program = Program::assemble(&network.model()).unwrap();
        let mut domain = Domain::new(&program);
        let mut propagator = Propagator::new(&program);
        let conflict = propagator.propagate_all(&program, &mut domain).is_err();
        let mut relaxed = Vec::new();
        for arc in &network.arcs {
            relaxed.push(arc.flow * f64::from(arc.constant + arc.capacity));
            relaxed.extend(arc.switched.then_some(arc.open));
        }
        let cuts = cut_set_cuts(&program, &domain, &relaxed, &StopToken::default());
        for cut in &cuts {
            prop_assert!(cut.room(&relaxed) < 0.0, "the relaxed point is not cut off");
        }
        for choice in 0..1_u32 << network.arcs.len() {
            let open: Vec<bool> = (0..network.arcs.len()).map(|k| choice >> k & 1 == 1).collect();
            if !network.can_flow(&open) {
                continue;
            }
            prop_assert!(!conflict);
            let mut point = Vec::new();
            for (arc, &open) in network.arcs.iter().zip(&open) {
                point.push(0.0);
                point.extend(arc.switched.then_some(f64::from(u8::from(open))));
            }
            for cut in &cuts {
                let whole = cut.terms.iter().all(|&(j, _)| program.integral[j]);
                prop_assert!(!whole || cut.room(&point) >= -1e-7, "{:?} cuts off {:?}", cut, open);
            }
        }
    }
}

/// A node needs a unit, which arcs of a thousand carry: one of them is open.
#[test]
fn a_small_need_opens_one_of_many_wide_arcs() {
    let mut model = Model::new("wide");
    let mut sum = [Affine::default(), Affine::default()];
    for k in 0..3 {
        let flow = model.continuous(format!("flow{k}"), 0.0, 1000.0).unwrap();
        let open = model.binary(format!("open{k}")).unwrap();
        model.add(format!("switch{k}"), (flow - 1000.0 * open).le(0.0)).unwrap();
        sum[0] -= flow;
        sum[1] += flow;
    }
    let [from, to] = sum;
    model.add("from", from.equals(-1.0)).unwrap();
    model.add("to", to.equals(1.0)).unwrap();
    let program = Program::assemble(&model).unwrap();
    let relaxed = [1.0, 0.001, 0.0, 0.0, 0.0, 0.0];
    let cuts = cut_set_cuts(&program, &Domain::new(&program), &relaxed, &StopToken::default());
    let open = |k: usize| {
        let mut point = [0.0; 6];
        point[2 * k + 1] = 1.0;
        point
    };
    assert!(!cuts.is_empty());
    for cut in cuts {
        assert!(cut.room(&[0.0; 6]) < -0.5);
        (0..3).for_each(|k| assert!(cut.room(&open(k)).abs() < 1e-6));
    }
}
