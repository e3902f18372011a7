//! The division of the root along the leaves of an earlier tree.

use crate::common::config;
use carom::internals::presolve::Domain;
use carom::internals::program::Program;
use carom::internals::search::node::Decision;
use carom::internals::search::seed::{Part, SeedBox, divide};
use carom::model::Model;
use proptest::prelude::*;

/// Most parts a box, and those that are always allowed.
const PARTS: usize = 3;
const ALWAYS: usize = 16;

fn program(columns: usize, upper: f64) -> Program {
    let mut model = Model::new("box");
    for j in 0..columns {
        model.integer(format!("n{j}"), 0.0, upper).unwrap();
    }
    Program::assemble(&model).unwrap()
}

fn is_inside(path: &[Decision], point: &[f64]) -> bool {
    path.iter()
        .all(|d| if d.is_upper { point[d.column] <= d.value } else { point[d.column] >= d.value })
}

/// The ends of a tree are found again, one part each.
#[test]
fn ends_of_a_tree_are_its_parts() {
    let program = program(3, 1.0);
    let leaf = |bounds: &[(usize, f64)]| SeedBox {
        bounds: bounds.iter().map(|&(j, v)| (j, v, v)).collect(),
        order: 0.0,
    };
    let leaves = [
        leaf(&[(1, 0.0), (0, 0.0)]),
        leaf(&[(1, 0.0), (0, 1.0)]),
        leaf(&[(1, 1.0), (2, 0.0)]),
        leaf(&[(1, 1.0), (2, 1.0)]),
    ];
    let parts = divide(&program, &Domain::new(&program), &leaves);
    let mut inside: Vec<_> = parts.iter().map(|part| part.inside).collect();
    inside.sort();
    assert_eq!(inside, [Some(0), Some(1), Some(2), Some(3)]);
    // Without one of them, the rest of the root is a part that lies in no box.
    let parts = divide(&program, &Domain::new(&program), &leaves[..3]);
    assert_eq!(parts.iter().filter(|part| part.inside.is_none()).count(), 1);
    assert_eq!(parts.len(), 4);
}

proptest! {
    #![proptest_config(config(256, "tests/regressions/seed.txt"))]

    /// Whatever the boxes are, every point of the root lies in exactly one part, and a part that
    /// claims to lie in a box does.
    #[test]
    fn parts_cover_the_root(
        boxes in prop::collection::vec(
            prop::collection::vec((0..5_usize, -1..=4_i32, -1..=4_i32), 0..4),
            0..8,
        ),
    ) {
        let program = program(3, 3.0);
        let leaves: Vec<SeedBox> = boxes
            .iter()
            .map(|bounds| SeedBox {
                bounds: bounds.iter().map(|&(j, l, u)| (j, l.into(), u.into())).collect(),
                order: 0.0,
            })
            .collect();
        let parts = divide(&program, &Domain::new(&program), &leaves);
        prop_assert!(parts.len() <= PARTS * leaves.len() + ALWAYS);
        for number in 0..64 {
            let point = [number % 4, number / 4 % 4, number / 16].map(f64::from);
            let of: Vec<&Part> = parts.iter().filter(|p| is_inside(&p.path, &point)).collect();
            prop_assert_eq!(of.len(), 1);
            if let Some(k) = of[0].inside {
                for &(j, l, u) in leaves[k].bounds.iter().filter(|b| b.0 < 3) {
                    prop_assert!(l <= point[j] && point[j] <= u);
                }
            }
        }
    }
}
