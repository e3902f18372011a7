//! A tree that several searches share, here on threads: nodes and points pass through one store.

use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use carom::prelude::*;
use carom::solver::{Elsewhere, OpenNode, TreeExchange, TreePart};

use super::{knapsack, parity};
use crate::instances::generators::{boxes, puck};

/// What the parts of a tree share.
#[derive(Default)]
struct Store {
    program: Option<u64>,
    nodes: Vec<OpenNode>,
    best: Option<(f64, Vec<f64>)>,
    /// By part: open nodes and their smallest bound.
    parts: Vec<(usize, f64)>,
    /// Bounds of what was closed or stalled.
    closed: [f64; 2],
    moved: usize,
}

struct Part<'a> {
    store: &'a Mutex<Store>,
    own: usize,
    interrupt: Interrupt,
    over: bool,
}

impl TreeExchange for Part<'_> {
    fn begin(&mut self, program: u64, _: bool) -> bool {
        let mut store = self.store.lock().unwrap();
        assert_eq!(*store.program.get_or_insert(program), program, "all parts have one program");
        self.own == 0
    }

    fn meet(&mut self, part: &mut dyn TreePart, is_idle: bool) -> bool {
        if self.over {
            return false;
        }
        {
            let shared = self.store;
            let mut store = shared.lock().unwrap();
            match (&store.best, part.incumbent()) {
                (Some((theirs, point)), own) if own.as_ref().is_none_or(|own| *theirs < own.0) => {
                    assert!(part.offer(point.clone()), "a verified point is refused");
                }
                (_, own) => store.best = own,
            }
            // Nodes go wherever they are taken: a part with nodes gives some, a part without takes
            // one.
            if is_idle && part.state().open == 0 {
                let node = store.nodes.pop();
                store.moved += usize::from(node.is_some());
                assert!(part.put(node.into_iter().collect()));
            } else if store.nodes.len() < 2 {
                let before = part.open_nodes().len();
                let given = part.take(2);
                assert_eq!(part.open_nodes().len() + given.len(), before);
                store.nodes.extend(given);
            }
            let state = part.state();
            store.parts[self.own] = (state.open, state.floor);
            let [closed, stalled] = store.closed;
            store.closed = [closed.min(state.closed), stalled.min(state.stalled)];
            let floor = store.nodes.iter().map(|node| node.bound).fold(f64::INFINITY, f64::min);
            let others = store.parts.iter().enumerate().filter(|(k, _)| *k != self.own);
            let floor = others.fold(floor, |floor, (_, (_, own))| floor.min(*own));
            let elsewhere = Elsewhere { floor, open: store.nodes.len(), nodes: 0 };
            part.note_elsewhere(elsewhere);
            part.note_closed(store.closed[0], store.closed[1]);
            let is_empty = store.nodes.is_empty() && store.parts.iter().all(|(open, _)| *open == 0);
            if is_idle && is_empty {
                self.over = true;
            }
        }
        if self.over && self.own > 0 {
            self.interrupt.trigger();
        }
        if is_idle && !self.over {
            thread::sleep(Duration::from_micros(100));
        }
        !self.over
    }
}

/// Solves a model in so many parts; returns the answer of the first one and how many nodes have
/// moved.
fn solve(model: &Model, parts: usize) -> (Solution, usize) {
    let store = Store {
        // The root is the first part's.
        parts: (0..parts).map(|k| (usize::from(k == 0), f64::NEG_INFINITY)).collect(),
        closed: [f64::INFINITY; 2],
        ..Store::default()
    };
    let store = &Mutex::new(store);
    let solve = |own: usize| {
        let interrupt = Interrupt::new();
        let mut part = Part { store, own, interrupt: interrupt.clone(), over: false };
        let mut control = Control::default().with_interrupt(&interrupt).with_exchange(&mut part);
        // The store holds one tree; blocks would be trees of their own.
        let options = Options::default().with_blocks(false);
        BranchAndBound::new(options).solve_with(model, &mut control).unwrap()
    };
    let solution = thread::scope(|scope| {
        for own in 1..parts {
            scope.spawn(move || solve(own));
        }
        solve(0)
    });
    let moved = store.lock().unwrap().moved;
    (solution, moved)
}

#[test]
fn parts_come_to_the_answer_of_the_whole() {
    let mut all = 0;
    for model in [knapsack(24, 1), knapsack(26, 2), parity(12), boxes(12, 3, false), puck(15, 0.33)]
    {
        let whole = BranchAndBound::default().solve(&model).unwrap();
        for parts in [1, 2, 3] {
            let (solution, moved) = solve(&model, parts);
            all += moved;
            assert_eq!(solution.termination(), whole.termination(), "{}", model.name());
            let (own, other) = (solution.objective(), whole.objective());
            assert_eq!(own.is_some(), other.is_some());
            if let Some((own, other)) = own.zip(other) {
                assert!((own - other).abs() <= 2e-6 * other.abs().max(1.0), "{own}, {other}");
                assert!(solution.relative_gap() <= 1e-6 || solution.gap() <= 1e-7);
            }
        }
    }
    assert!(all > 20, "only {all} nodes have moved");
}

#[test]
fn nodes_and_points_of_other_programs_are_refused() {
    struct Liar(usize);
    impl TreeExchange for Liar {
        fn begin(&mut self, _: u64, _: bool) -> bool {
            true
        }

        fn meet(&mut self, part: &mut dyn TreePart, _: bool) -> bool {
            self.0 += 1;
            for decision in [(9_999, true, 0.0), (0, false, 0.5), (0, true, f64::NAN)] {
                assert!(!part.put(vec![OpenNode { bound: 0.0, decisions: vec![decision] }]));
            }
            assert!(!part.put(vec![OpenNode { bound: f64::NAN, decisions: Vec::new() }]));
            for point in [Vec::new(), vec![0.0], vec![f64::NAN; 24], vec![1.0; 24]] {
                assert!(!part.offer(point));
            }
            false
        }
    }
    let mut liar = Liar(0);
    let model = knapsack(24, 1);
    let mut control = Control::default().with_exchange(&mut liar);
    let solution = BranchAndBound::default().solve_with(&model, &mut control).unwrap();
    drop(control);
    assert!(solution.is_optimal() && liar.0 > 1);
}
