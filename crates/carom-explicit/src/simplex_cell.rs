//! Cells: simplices with dyadic corners, which bisections of edges make from the n! simplices of a
//! box (H. W. Kuhn, Some combinatorial lemmas in topology, IBM J. Res. Dev. 4, 1960).
//!
//! Coordinates are whole numbers of units, of which a side of the box has `2^30`, so that midpoints
//! are exact.

/// Units along a side of the box.
pub(crate) const BOX_UNITS: i64 = 1 << 30;

/// The corners of Kuhn's simplex of an order of the axes.
pub(crate) fn kuhn(order: &[usize]) -> Vec<Vec<i64>> {
    let mut at = vec![0; order.len()];
    let mut corners = vec![at.clone()];
    for &axis in order {
        at[axis] = BOX_UNITS;
        corners.push(at.clone());
    }
    corners
}

/// The midpoint of an edge; `None` if it is finer than the unit.
pub(crate) fn midpoint(a: &[i64], b: &[i64]) -> Option<Vec<i64>> {
    a.iter().zip(b).map(|(a, b)| ((a + b) % 2 == 0).then_some((a + b) / 2)).collect()
}

/// The square of the length of an edge, in squares of units.
pub(crate) fn squared_length(a: &[i64], b: &[i64]) -> i128 {
    a.iter().zip(b).map(|(a, b)| i128::from(a - b).pow(2)).sum()
}

/// All orders of `n` axes, in lexicographic order.
pub(crate) fn orders(n: usize) -> Vec<Vec<usize>> {
    let mut all = vec![Vec::new()];
    for _ in 0..n {
        let longer = |order: &Vec<usize>| {
            let order = order.clone();
            let left = (0..n).filter(|axis| !order.contains(axis)).collect::<Vec<_>>();
            left.into_iter().map(move |axis| [&order[..], &[axis]].concat())
        };
        all = all.iter().flat_map(longer).collect();
    }
    all
}
