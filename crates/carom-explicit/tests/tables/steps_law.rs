/// state `x` from -3 to 3.
///
/// input `u`.
///
/// 16 cells, 10 laws.
///
/// loss at most 0.001 + 0.01 |least cost|.
///
/// of the set, in percent: 99.219 within that loss, 0.781 with a larger one, 0.000 without a plan, 0.000 open.
///
/// 512 bytes of constants.
///
/// at most 8 comparisons, 5 multiplications and as many sums.
///
/// a state is rounded by at most 1.8e-6.
///
/// an input is rounded by at most 3.0e-7.
#[rustfmt::skip]
#[allow(clippy::all, dead_code)]
pub const STEPS: carom_embedded::LookupTable<f32> = {
use carom_embedded::{LookupLeaf, LookupNode, LookupTable};
const LEAF: u32 = LookupTable::<f32>::LEAF;
const fn n(i: u8, j: u8, first: u32, second: u32) -> LookupNode {
    LookupNode { edge: [i, j], next: [first, second] }
}
const fn p(law: u32, loss: f32) -> LookupLeaf<f32> {
    LookupLeaf::Plan { law, loss }
}
const fn s(program: u32, loss: f32) -> LookupLeaf<f32> {
    LookupLeaf::Solve { program, loss }
}
LookupTable {
lower: &[
    -3.0,
],
upper: &[
    3.0,
],
scale: &[
    2796202.8,
],
roots: &[
    0,
],
nodes: &[
    n(0, 1, 1, 2), n(0, 1, LEAF + 0, 3), n(0, 1, 4, LEAF + 1), n(0, 1, LEAF + 2, 5),
    n(0, 1, 6, LEAF + 3), n(0, 1, 7, LEAF + 4), n(0, 1, LEAF + 5, 8), n(0, 1, LEAF + 6, 9),
    n(0, 1, 10, LEAF + 7), n(0, 1, 11, LEAF + 8), n(0, 1, LEAF + 9, 12), n(0, 1, 13, LEAF + 10),
    n(0, 1, LEAF + 11, 14), n(0, 1, LEAF + 12, LEAF + 13), n(0, 1, LEAF + 14, LEAF + 15),
],
leaves: &[
    p(0, 7.62886e-9), p(1, 7.628857e-9), p(0, 1.3640253e-9), p(1, 1.3640253e-9),
    p(2, 1.1560968e-9), p(3, 1.1508792e-9), p(0, 1.3035698e-9), p(1, 1.3035698e-9),
    p(4, 1.2351984e-9), p(5, 1.2328181e-9), p(6, 1.2789548e-9), p(7, 1.28042e-9),
    p(0, 0.021875001), p(8, 1.3028083e-9), p(9, 1.3058798e-9), p(1, 0.021875001),
],
laws: &[
    0, 0, 1, 1, 2, 3, 3, 4, 5, 2, 4, 6, 7, 5, 6, 8, 9, 7, 8, 10,
],
values: &[
    1.0, -1.0, 0.0, 0.0, -0.0, 0.0, -0.0, 0.0, -0.0, 0.0, -0.0,
],
programs: &[
],
numbers: &[
],
inputs: 1,
depth: 8,
}
};
const _: () = assert!(STEPS.is_sound());
