//! A conic row as one second-order cone over affine expressions.
//!
//! The squares of a quadratic row `q <= 0` are completed. Without a negative one it is convex:
//! `|tail| <= head` with a constant head if the squares take up the whole linear part, and
//! `|tail|^2 <= head * 1` otherwise. With one negative square, or one product, and no other
//! variables, it is a Lorentz cone, if the bounds tell the sign of its head. Everything else is no
//! cone.
//!
//! The roots of coefficients are rounded, so points at which the row holds with equality may miss
//! the cone by some units in the last place of its terms.

use super::squares::{Completed, ROUNDED_AWAY, SumOfSquares};
use super::stored_conic::StoredConic;
use crate::error::{Error, ErrorKind};
use crate::model::affine::Affine;
use crate::model::checks::finite;
use crate::model::name::Name;
use crate::model::quadratic::Quadratic;
use crate::model::store::Model;
use crate::semidefinite::{Direction, negative_direction};

/// How many times the constant of a completed square may be all that it stands beside, if it
/// becomes a part of the limit (no unit): it takes six digits of the others then.
const FARTHEST_SHIFT: f64 = 1e6;

/// A second-order cone over affine expressions.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardCone {
    /// One expression for `|tail| <= head`, two for `|tail|^2 <= head[0] head[1]`, both at least 0.
    pub head: Vec<Affine>,
    /// The entries of the norm.
    pub tail: Vec<Affine>,
}

impl Model {
    /// The cone that a conic row is within the bounds of its variables.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::NotCone`], [`ErrorKind::UnknownSign`].
    #[doc(hidden)]
    pub fn standard_cone(&self, conic: &StoredConic, name: &Name) -> Result<StandardCone, Error> {
        let expression = match conic {
            StoredConic::Norm { entries, bound } => {
                return Ok(StandardCone { head: vec![bound.clone()], tail: entries.clone() });
            }
            StoredConic::Quadratic { expression } => expression,
        };
        let offset = expression.affine().offset();
        let mut sum = SumOfSquares::of(expression, false);
        let heads = sum.completed().filter(|completed| completed.is_head()).count();
        let direction = if heads == 0 { None } else { concave_direction(expression) };
        let cone = match (heads, direction) {
            (0, _) => self.convex(&sum, offset),
            (_, None) => {
                sum = SumOfSquares::of(expression, true);
                self.convex(&sum, offset)
            }
            (1, Some(_)) if sum.linear.terms().is_empty() && sum.constant >= 0.0 => {
                self.lorentz(&sum, name)?
            }
            (_, Some(direction)) => return Err(self.no_cone(name, direction)),
        };
        for expression in cone.head.iter().chain(&cone.tail) {
            finite(expression.offset(), "a completed square", name)?;
            for (_, a) in expression.terms() {
                finite(a, "a completed square", name)?;
            }
        }
        Ok(cone)
    }

    /// The cone of a row without negative squares, whose constant is `offset`.
    ///
    /// `d (p + s)^2 - d s^2 = d p^2 + 2 d s p` is better where the shift `s` is larger than `p`,
    /// because the constant `d s^2` would take the digits of all others.
    fn convex(&self, sum: &SumOfSquares, offset: f64) -> StandardCone {
        let squares: Vec<(f64, &Affine, Affine, f64)> = sum
            .completed()
            .filter_map(|completed| match completed {
                Completed::Square { coefficient, root, .. } => {
                    let mut pure = root.clone();
                    pure.append(&Affine::constant(root.offset()), -1.0);
                    let range = self.range_of(&pure).magnitude();
                    Some((*coefficient, root, pure, range))
                }
                Completed::Product { .. } => None,
            })
            .collect();
        let shifts = squares.iter().map(|(d, root, ..)| d * root.offset() * root.offset());
        let others = squares.iter().map(|(d, .., range)| d * range * range).sum::<f64>();
        let is_far = shifts.fold(0.0, f64::max) > FARTHEST_SHIFT * offset.abs().max(others);
        if sum.linear.terms().is_empty() && !is_far {
            let tail = squares.iter().map(|(d, root, ..)| d.sqrt() * *root).collect();
            let limit = sum.constant;
            // A row that cannot hold has a head below 0.
            let head = Affine::constant(limit.abs().sqrt().copysign(-limit) + 0.0);
            return StandardCone { head: vec![head], tail };
        }
        let is_kept = |root: &Affine, range: f64| root.offset().abs() <= range;
        let limit = match squares.iter().all(|(_, root, _, range)| is_kept(root, *range)) {
            true => sum.constant,
            false => {
                let kept = squares.iter().filter(|(_, root, _, range)| is_kept(root, *range));
                difference(offset, kept.map(|(d, root, ..)| d * root.offset() * root.offset()))
            }
        };
        let mut head = -(&sum.linear) - Affine::constant(limit);
        let mut tail = Vec::new();
        for (d, root, pure, range) in squares {
            if is_kept(root, range) {
                tail.push(d.sqrt() * root);
            } else {
                head.append(&pure, -2.0 * d * root.offset());
                tail.push(d.sqrt() * pure);
            }
        }
        StandardCone { head: vec![head, Affine::constant(1.0)], tail }
    }

    /// The cone of a row with one negative square or one product, no linear part, and a constant
    /// that is at least 0.
    fn lorentz(&self, sum: &SumOfSquares, name: &Name) -> Result<StandardCone, Error> {
        let (mut head, mut tail) = (Vec::new(), Vec::new());
        for completed in sum.completed() {
            match completed {
                Completed::Square { coefficient, root, .. } if *coefficient > 0.0 => {
                    tail.push(coefficient.sqrt() * root);
                }
                Completed::Square { coefficient, root, .. } => {
                    head.push(coefficient.abs().sqrt() * root);
                }
                Completed::Product { coefficient, factors: [first, second], .. } => {
                    head.extend([-*coefficient * first, second.clone()]);
                }
            }
        }
        if sum.constant > 0.0 {
            tail.push(Affine::constant(sum.constant.sqrt()));
        }
        let Some(sign) = self.sheet(sum) else {
            return Err(self.unknown_sign(name, &head));
        };
        head.iter_mut().for_each(|head| head.scale(sign));
        Ok(StandardCone { head, tail })
    }

    fn unknown_sign(&self, name: &Name, head: &[Affine]) -> Error {
        let text = |of: &Affine| format!("`{}`", of.text(&|v| self.name_of(v)));
        let head: Vec<String> = head.iter().map(text).collect();
        ErrorKind::UnknownSign { row: name.to_string(), expression: head.join(" and ") }.into()
    }

    fn no_cone(&self, row: &Name, direction: Direction) -> Error {
        let curvature = direction.curvature;
        let (name, direction) = self.direction_text(direction);
        ErrorKind::NotCone { row: row.to_string(), curvature, name, direction }.into()
    }
}

/// A constant without what squares were completed by; 0 if rounding may have left it.
fn difference(constant: f64, of_squares: impl Iterator<Item = f64>) -> f64 {
    let (mut size, mut left) = (constant.abs(), constant);
    for of_square in of_squares {
        (size, left) = (size.max(of_square), left - of_square);
    }
    if left.abs() <= ROUNDED_AWAY * f64::EPSILON * size { 0.0 } else { left }
}

/// A direction along which an expression is concave.
fn concave_direction(expression: &Quadratic) -> Option<Direction> {
    let products = expression.products();
    let products = products.into_iter().map(|(a, b, q)| (a.index(), b.index(), q));
    negative_direction(&products.collect::<Vec<_>>(), &|_| 0.0)
}
