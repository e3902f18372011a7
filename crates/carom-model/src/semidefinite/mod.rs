//! Proofs that a quadratic form is convex, and directions that prove that it is not.
//!
//! `sum q_jk x_j x_k` splits into blocks of variables that products link. A block's symmetric
//! matrix `M` is scaled by powers of two, which rounds nothing, until its diagonal is near 1. So no
//! unit of a variable decides. If `M + T - tau` has a Cholesky factor `L` in floats, its residual
//! `R = M + T - tau - L L'` is computed with twice the digits, and if no row of `|R|` sums up to
//! more than `tau`, `R + tau` is diagonally dominant: `M + T` is positive semidefinite, for
//! certain. (The a priori bounds of such proofs, Higham, Accuracy and Stability of Numerical
//! Algorithms, theorems 10.3 and 10.5, and Rump, Verification of positive definiteness, BIT 46,
//! 2006, would charge the square of the order.)
//!
//! `T` is what may be missing. The coefficients are floats: whoever writes `(x - 2 y + 0.1 z)^2`
//! gets a matrix whose entries are rounded, and the singular matrix meant is as often a little
//! indefinite as not. So each diagonal entry may be some units of its last place short, and by what
//! the caller allows.
//!
//! Without a factor, the failing pivot gives a direction `d`. It is rounded to few digits, and
//! `d'Md < 0` is checked with twice the digits.

mod block;
mod dense;
mod direction;
mod scaled;
mod shift;
mod sparse;

use crate::union_find::UnionFind;
use block::MatrixBlock;
pub use direction::Direction;
pub use shift::{least_multiple, with_squares};

/// A product of two variables with its coefficient; the first one is not larger, and none is
/// repeated.
pub type Product = (usize, usize, f64);

/// A direction along which `sum q_jk x_j x_k` is concave; `None` if the form is proved convex once
/// to each square is added what is allowed, and some units in the last place of its coefficient.
///
/// # Arguments
///
/// * `allowed`: by variable, what its square may lack; at least 0, in the unit of its coefficient.
///
/// # Complexity
///
/// That of a sparse Cholesky factorisation, block by block; linear for separable and diagonally
/// dominant forms.
pub fn negative_direction(
    products: &[Product],
    allowed: &dyn Fn(usize) -> f64,
) -> Option<Direction> {
    blocks(products).into_iter().find_map(|(names, products)| {
        let allowed = names.iter().map(|&name| allowed(name)).collect();
        MatrixBlock::new(names, &products, allowed).refute()
    })
}

/// The variables of a block, in order, and its products in places among them.
pub type BlockProducts = (Vec<usize>, Vec<Product>);

/// Variables that products link, directly or not, are in one block. The products of a block are in
/// places among its variables.
pub fn blocks(products: &[Product]) -> Vec<BlockProducts> {
    // Only the variables that occur: a small expression may be one of many in a large model.
    let nonzero = || products.iter().filter(|(.., q)| *q != 0.0);
    let mut variables: Vec<usize> = nonzero().flat_map(|&(a, b, _)| [a, b]).collect();
    variables.sort_unstable();
    variables.dedup();
    let rank = |v: usize| variables.binary_search(&v).unwrap_or_default();
    let used: Vec<Product> = nonzero().map(|&(a, b, q)| (rank(a), rank(b), q)).collect();
    let size = variables.len();
    let mut sets = UnionFind::new(size);
    used.iter().for_each(|&(a, b, _)| sets.join(a, b));
    // By variable: its block and its place in it. The first one of a block is its root.
    let (mut block, mut place) = (vec![0; size], vec![0; size]);
    let mut parts: Vec<BlockProducts> = Vec::new();
    for j in 0..size {
        let root = sets.root(j);
        if root == j {
            block[j] = parts.len();
            parts.push((Vec::new(), Vec::new()));
        }
        block[j] = block[root];
        let (names, _) = &mut parts[block[j]];
        place[j] = names.len();
        names.push(variables[j]);
    }
    for &(a, b, q) in &used {
        parts[block[a]].1.push((place[a], place[b], q));
    }
    parts
}
