//! Interchangeable columns.

use carom::internals::program::Program;
use carom::internals::search::symmetry::classes;
use carom::model::{Affine, Model};

fn found(model: &Model) -> Vec<Vec<usize>> {
    classes(&Program::assemble(model).unwrap())
}

#[test]
fn parts_of_one_kind_are_interchangeable() {
    let mut model = Model::new("parts");
    let z = model.binary_family("z", 6).unwrap();
    let sum =
        |weights: [f64; 6]| z.iter().zip(weights).fold(Affine::zero(), |sum, (v, a)| sum + a * v);
    model.add("weight", sum([2.0, 2.0, 2.0, 3.0, 3.0, 2.0]).le(7.0)).unwrap();
    model.add("least", (z[0] + z[1]).ge(1.0)).unwrap();
    model.maximize(sum([1.0; 6])).unwrap();
    assert_eq!(found(&model), [vec![0, 1], vec![2, 5], vec![3, 4]]);
}

#[test]
fn rows_of_their_own_must_have_a_twin() {
    let mut model = Model::new("twins");
    let z = model.binary_family("z", 3).unwrap();
    let x = model.continuous("x", 0.0, 4.0).unwrap();
    model.add("a", (x + 2.0 * z[0]).le(4.0)).unwrap();
    model.add("b", (x + 2.0 * z[1]).le(4.0)).unwrap();
    model.add("c", (x + 2.0 * z[2]).le(3.0)).unwrap();
    assert_eq!(found(&model), [vec![0, 1]]);
}

#[test]
fn products_count() {
    let mut model = Model::new("products");
    let x = model.integer_family("x", 3, -2.0, 2.0).unwrap();
    model.add("sum", (x[0] + x[1] + x[2]).le(3.0)).unwrap();
    let cost = (x[0] + x[1]).square() + x[2].square() + x[0].square() + x[1].square();
    model.minimize(cost).unwrap();
    assert_eq!(found(&model), [vec![0, 1]]);
}
