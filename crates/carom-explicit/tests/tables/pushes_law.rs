/// state `x` from -3 to 3.
///
/// input `sum`.
///
/// 2 cells, 0 laws.
///
/// loss at most 0.001 + 0.01 |least cost|.
///
/// of the set, in percent: 100.000 within that loss, 0.000 with a larger one, 0.000 without a plan, 0.000 open.
///
/// 140 bytes of constants.
///
/// at most 5 comparisons, 12 multiplications and as many sums, 8 divisions.
///
/// 2 programs, with at most 1 exchanges, in 4 numbers of work space.
///
/// by rounding in programs, rows are missed by at most 4.6e-4, and the loss is larger by at most 8.7e-4.
///
/// a state is rounded by at most 1.8e-6.
///
/// an input is rounded by at most 3.7e-6.
#[rustfmt::skip]
#[allow(clippy::all, dead_code)]
pub const PUSHES: carom_embedded::LookupTable<f32> = {
use carom_embedded::{LookupLeaf, LookupNode, LookupProgram, LookupTable};
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
    n(0, 1, LEAF + 0, LEAF + 1),
],
leaves: &[
    s(1, 0.0012892884), s(0, 0.0017201671),
],
laws: &[
],
values: &[
],
programs: &[
    LookupProgram { rows: 1, first: 0, exchanges: 1, negative: -2.8295104e-5, positive: 0.00024414063 },
    LookupProgram { rows: 1, first: 6, exchanges: 1, negative: -1.4137203e-5, positive: 0.00024414063 },
],
numbers: &[
    1.0, 0.706246, -5.6534133, 8.474953, -1.0, 0.0, 1.0, -0.706246, 2.821539, -8.474953, 1.0,
    0.0,
],
inputs: 1,
depth: 1,
}
};
const _: () = assert!(PUSHES.is_sound());
