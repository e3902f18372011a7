//! The independent blocks of a program.

use carom::model::Model;
use carom_solver::internals::presolve::root::blocks;
use carom_solver::internals::program::Program;

#[test]
fn columns_without_a_common_row_are_blocks_of_their_own() {
    let mut model = Model::new("two");
    let [a, b, c] = ["a", "b", "c"].map(|name| model.integer(name, 0.0, 9.0).unwrap());
    model.add("link", (2.0 * a + 3.0 * c).le(7.0)).unwrap();
    let blocks = blocks(&Program::assemble(&model).unwrap());
    assert_eq!(blocks[0].columns, [b.index()]);
    assert_eq!(blocks[1].columns, [a.index(), c.index()]);
}
