//! Nodes, their paths and their queue.

use std::sync::atomic::Ordering as Memory;

use carom_solver::internals::search::node::{Decision, Node, NodeQueue, Path, StepCount};

fn decision(column: usize) -> Decision {
    Decision { column, is_upper: column.is_multiple_of(2), value: column as f64 }
}

#[test]
fn siblings_share_their_ancestors() {
    let count = StepCount::default();
    let mut path = Path::default();
    for column in 0..1000 {
        path = path.then(&decision(column), &count);
    }
    let siblings = [path.then(&decision(1000), &count), path.then(&decision(1001), &count)];
    drop(path);
    assert_eq!(count.load(Memory::Relaxed), 1002);
    let mut decisions = Vec::new();
    siblings[1].write_to(&mut decisions);
    assert_eq!(decisions.len(), siblings[1].len());
    assert!(decisions[..1000].iter().enumerate().all(|(k, d)| *d == decision(k)));
    assert_eq!(decisions[1000], decision(1001));
    drop(siblings);
    assert_eq!(count.load(Memory::Relaxed), 0);
}

#[test]
fn long_paths_go_without_recursion() {
    let count = StepCount::default();
    let mut path = Path::default();
    for column in 0..1_000_000 {
        path = path.then(&decision(column), &count);
    }
    drop(path);
    assert_eq!(count.load(Memory::Relaxed), 0);
}

#[test]
fn the_best_bound_comes_first_then_depth_then_youth() {
    let count = StepCount::default();
    let deep = Path::default().then(&decision(0), &count);
    let node = |path: &Path, bound: f64, serial| {
        let mut node = Node::root();
        (node.path, node.bound, node.serial) = (path.clone(), bound, serial);
        node
    };
    let mut queue = NodeQueue::default();
    for (path, bound, serial) in
        [(&deep, 2.0, 1), (&Path::default(), 1.0, 2), (&deep, 1.0, 3), (&deep, 1.0, 4)]
    {
        queue.push(node(path, bound, serial));
    }
    assert_eq!(queue.best_bound(), 1.0);
    let order: Vec<u64> = std::iter::from_fn(|| queue.pop()).map(|node| node.serial).collect();
    assert_eq!(order, [4, 3, 2, 1]);
}
