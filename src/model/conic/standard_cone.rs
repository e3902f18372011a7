//! A conic row as one second-order cone over affine expressions.

use super::conic_row::StoredConic;
use crate::error::{Error, ErrorKind};
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::store::Model;

/// A second-order cone over affine expressions.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StandardCone {
    /// One expression for `|tail| <= head`, two for `|tail|^2 <= head[0] head[1]`, both at least 0.
    pub(crate) head: Vec<Affine>,
    pub(crate) tail: Vec<Affine>,
}

impl Model {
    /// The cone that a conic row is within the bounds of its variables.
    pub(crate) fn standard_cone(
        &self,
        conic: &StoredConic,
        name: &Name,
    ) -> Result<StandardCone, Error> {
        let expression = match conic {
            StoredConic::Norm { entries, bound } => {
                return Ok(StandardCone { head: vec![bound.clone()], tail: entries.clone() });
            }
            StoredConic::Quadratic { expression } => expression,
        };
        let mut tail = Vec::new();
        let (mut negative, mut product): (Vec<(f64, Variable)>, Vec<(f64, Variable, Variable)>) =
            Default::default();
        for (a, b, q) in expression.products() {
            match (a == b, q > 0.0) {
                (true, true) => tail.push(q.sqrt() * a),
                (true, false) => negative.push((-q, a)),
                (false, true) => return Err(not_convex(name)),
                (false, false) => product.push((-q, a, b)),
            }
        }
        let rest = expression.affine();
        let is_pure = rest.terms().is_empty() && rest.offset() >= 0.0;
        if is_pure && rest.offset() > 0.0 && negative.len() + product.len() > 0 {
            tail.push(Affine::constant(rest.offset().sqrt()));
        }
        match (&negative[..], &product[..]) {
            ([], []) => Ok(StandardCone { head: vec![-rest, Affine::constant(1.0)], tail }),
            ([(q, v)], []) if is_pure => Ok(StandardCone { head: vec![q.sqrt() * *v], tail }),
            ([], [(q, a, b)]) if is_pure => {
                Ok(StandardCone { head: vec![*q * *a, b.into()], tail })
            }
            _ => Err(not_convex(name)),
        }
    }
}

fn not_convex(name: &Name) -> Error {
    ErrorKind::NotConvex {
        sense: "minimise",
        curvature: -1.0,
        name: name.to_string(),
        direction: name.to_string(),
        help: "no cone",
    }
    .into()
}
