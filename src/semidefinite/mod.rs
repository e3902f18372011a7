//! Proofs that a quadratic form is convex, and directions that prove that it is not.
//!
//! `sum q_jk x_j x_k` splits into blocks of variables that products link. A block's symmetric matrix `M` is
//! scaled by powers of two, which rounds nothing, until its diagonal is near 1. So no unit of a variable
//! decides. If `M + T - tau` has a Cholesky factor `L` in floats, its residual `R = M + T - tau - L L'` is
//! computed with twice the digits, and if no row of `|R|` sums up to more than `tau`, `R + tau` is
//! diagonally dominant: `M + T` is positive semidefinite, for certain. (The a priori bounds of such proofs,
//! Higham, Accuracy and Stability of Numerical Algorithms, theorems 10.3 and 10.5, and Rump, Verification
//! of positive definiteness, BIT 46, 2006, would charge the square of the order.)
//!
//! `T` is what may be missing. The coefficients are floats: whoever writes `(x - 2 y + 0.1 z)^2` gets a
//! matrix whose entries are rounded, and the singular matrix meant is as often a little indefinite as not.
//! So each diagonal entry may be some units of its last place short, and by what the caller allows.
//!
//! Without a factor, the failing pivot gives a direction `d`. It is rounded to few digits, and `d'Md < 0` is
//! checked with twice the digits.

mod block;
mod dense;
mod direction;
mod scaled;
mod sparse;

use std::collections::BTreeMap;

use block::Block;
pub use direction::Direction;

/// A product of two variables with its coefficient; the first one is not larger, and none is repeated.
pub type Product = (usize, usize, f64);

/// A direction along which `sum q_jk x_j x_k` is concave; `None` if the form is proved convex once to each
/// square is added what is allowed, and some units in the last place of its coefficient.
///
/// # Arguments
///
/// * `allowed`: by variable, what its square may lack; at least 0, in the unit of its coefficient.
///
/// # Complexity
///
/// That of a sparse Cholesky factorisation, block by block; linear for separable and diagonally dominant
/// forms.
pub fn negative_direction(
    products: &[Product],
    allowed: &dyn Fn(usize) -> f64,
) -> Option<Direction> {
    blocks(products).into_iter().find_map(|products| Block::new(&products, allowed).refute())
}

/// Variables that products link, directly or not, are in one block.
fn blocks(products: &[Product]) -> Vec<Vec<Product>> {
    let used = products.iter().filter(|(.., q)| *q != 0.0);
    if products.iter().all(|(a, b, _)| a == b) {
        return used.map(|&product| vec![product]).collect();
    }
    let mut position = BTreeMap::new();
    for &(a, b, _) in used.clone() {
        for variable in [a, b] {
            let next = position.len();
            position.entry(variable).or_insert(next);
        }
    }
    let mut parent: Vec<usize> = (0..position.len()).collect();
    for (a, b, _) in used.clone() {
        let (a, b) = (root(&mut parent, position[a]), root(&mut parent, position[b]));
        parent[a.max(b)] = a.min(b);
    }
    let mut blocks: BTreeMap<usize, Vec<Product>> = BTreeMap::new();
    for &product in used {
        blocks.entry(root(&mut parent, position[&product.0])).or_default().push(product);
    }
    blocks.into_values().collect()
}

fn root(parent: &mut [usize], mut node: usize) -> usize {
    while parent[node] != node {
        parent[node] = parent[parent[node]];
        node = parent[node];
    }
    node
}
