//! The multiple of given squares with which a form is convex.

use std::collections::BTreeMap;

use super::direction::Direction;
use super::{Product, negative_direction};
use crate::tolerance::largest_magnitude;

/// The part by which a multiple may be larger than the least one (no unit).
const CLOSE_MULTIPLE: f64 = 0.05;

/// Most factorisations for one multiple.
const MOST_MULTIPLES: usize = 60;

/// The largest multiple, relative to the largest coefficient for a weight of 1 (no unit).
const LARGEST_MULTIPLE: f64 = 1e6;

/// The least one that is tried, relative to the largest (no unit).
const LEAST_MULTIPLE: f64 = 1e-22;

/// A small `t` such that `sum q_jk x_j x_k + t sum weight_j x_j^2` is proved convex.
///
/// A direction `d` along which a form is concave asks for a multiple of at least
/// `-d'Md / sum weight_j d_j^2`; so the multiple rises until there is none, and is then closed in.
///
/// # Arguments
///
/// * `weights`: by variable, in order; at least 0.
///
/// # Errors
///
/// A direction that no multiple mends.
pub fn least_multiple(
    products: &[Product],
    weights: &BTreeMap<usize, f64>,
) -> Result<f64, Direction> {
    let largest = largest_magnitude(products.iter().map(|product| product.2));
    let lightest = weights.values().copied().filter(|w| *w > 0.0).fold(f64::INFINITY, f64::min);
    let most = LARGEST_MULTIPLE * largest / lightest;
    let (mut below, mut above, mut at) = (0.0_f64, f64::INFINITY, 0.0_f64);
    let (mut growth, mut worst) = (CLOSE_MULTIPLE / 2.0, None);
    for _ in 0..MOST_MULTIPLES {
        match negative_direction(&with_squares(products, weights, at), &|_| 0.0) {
            None => above = at,
            Some(direction) => {
                let square = |&(j, d): &(usize, f64)| weights.get(&j).map_or(0.0, |w| w * d * d);
                let weight: f64 = direction.steps.iter().map(square).sum();
                let length: f64 = direction.steps.iter().map(|(_, d)| d * d).sum();
                if weight <= 0.0 || at >= most {
                    return Err(direction);
                }
                // A direction that is no proof may have a positive curvature.
                below = at + (-0.5 * direction.curvature * length / weight).max(0.0);
                worst = Some(direction);
            }
        }
        if above <= below * (1.0 + CLOSE_MULTIPLE) || above == 0.0 {
            return Ok(above);
        }
        at = match above.is_finite() {
            true if below > 0.0 => (below * above).sqrt(),
            true => 0.5 * above,
            false => (below * (1.0 + growth)).max(LEAST_MULTIPLE * most).min(most),
        };
        growth *= 2.0;
    }
    match worst {
        Some(direction) if above.is_infinite() => Err(direction),
        _ => Ok(above),
    }
}

/// The form with multiples of squares; its products are in order.
pub fn with_squares(
    products: &[Product],
    weights: &BTreeMap<usize, f64>,
    multiple: f64,
) -> Vec<Product> {
    let mut sum: BTreeMap<(usize, usize), f64> =
        products.iter().map(|&(a, b, q)| ((a, b), q)).collect();
    for (&j, &weight) in weights.iter().filter(|(_, weight)| **weight > 0.0) {
        *sum.entry((j, j)).or_default() += multiple * weight;
    }
    sum.into_iter().map(|((a, b), q)| (a, b, q)).collect()
}
