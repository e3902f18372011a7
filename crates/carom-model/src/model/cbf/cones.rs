//! The cones of a file as statements of a model.
//!
//! A cone Q is a norm of affine expressions. A cone QR is a quadratic row over single variables:
//! expressions become variables, so that no square has to be multiplied out.

use super::build::stored;
use super::cone_kind::ConeKind;
use super::rows::{CbfEntry, CbfRow};
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::conic::norm;
use crate::model::ids::Variable;
use crate::model::quadratic::Quadratic;
use crate::model::store::Model;
use crate::model::stored::StoredRow;
use crate::model::text::token::Token;

/// A block Q or QR.
#[derive(Debug)]
pub(super) struct CbfCone<'f> {
    pub(super) kind: ConeKind,
    /// The entries, each with its position in VAR or CON.
    pub(super) entries: Vec<(usize, CbfEntry<'f>)>,
    /// The name of the cone in the file.
    pub(super) place: Token<'f>,
    /// The number of cones before it.
    pub(super) position: usize,
}

/// The model to which cones are added.
pub(super) struct Cones<'m> {
    pub(super) model: &'m mut Model,
    pub(super) variables: &'m [Variable],
}

/// An entry with its position.
type Placed<'f> = (usize, CbfEntry<'f>);

/// A variable times a number.
type Factor = (f64, Variable);

/// Factors within these magnitudes are squared and multiplied as they are.
const MODERATE: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

impl<'f> CbfCone<'f> {
    pub(super) fn heads(&self) -> &[Placed<'f>] {
        &self.entries[..self.kind.heads().unwrap_or(0)]
    }
}

impl Cones<'_> {
    pub(super) fn add(&mut self, cone: &CbfCone<'_>) -> Result<(), Error> {
        let heads = cone.heads();
        let tail = cone.entries[heads.len()..].iter();
        let tail: Vec<Placed<'_>> =
            tail.filter(|(_, entry)| !matches!(entry, CbfEntry::Constant(0.0))).copied().collect();
        let constants = heads.iter().map(|(_, entry)| match entry {
            CbfEntry::Constant(value) => Some(*value),
            _ => None,
        });
        let constants: Vec<Option<f64>> = constants.collect();
        let closed = constants.iter().flatten().any(|&value| value <= 0.0);
        if closed || tail.is_empty() {
            heads.iter().try_for_each(|head| self.at_least_zero(head))?;
            return tail.iter().try_for_each(|entry| self.zero(entry));
        }
        if constants.iter().all(Option::is_some)
            && tail.iter().all(|(_, entry)| matches!(entry, CbfEntry::Constant(_)))
        {
            return self.check(cone, &constants, &tail);
        }
        let row = match (cone.kind, &constants[..]) {
            (ConeKind::Rotated, &[first, second]) => {
                let mut expression = match (first, second) {
                    (None, None) => self.product(&heads[0], &heads[1], &tail)?,
                    (Some(value), _) => -2.0 * value * Quadratic::from(self.affine(&heads[1].1)),
                    (_, Some(value)) => -2.0 * value * Quadratic::from(self.affine(&heads[0].1)),
                };
                for entry in &tail {
                    match (entry.1, self.factor(entry)) {
                        (CbfEntry::Constant(value), _) => expression += value * value,
                        (_, Some((q, x))) => expression.add_product(q * q, x, x),
                        (_, None) => {
                            let x = self.variable(entry, f64::NEG_INFINITY)?;
                            expression.add_product(1.0, x, x);
                        }
                    }
                }
                expression.le(0.0)
            }
            _ => {
                norm(tail.iter().map(|(_, entry)| self.affine(entry))).le(self.affine(&heads[0].1))
            }
        };
        let added = self.model.add(("cone", cone.position), row);
        added.map(|_| ()).map_err(|error| cone.place.error(error.to_string()))
    }

    /// Minus twice the product of two heads as variables that are at least 0, neither of them in
    /// the tail.
    fn product(
        &mut self,
        first: &Placed<'_>,
        second: &Placed<'_>,
        tail: &[Placed<'_>],
    ) -> Result<Quadratic, Error> {
        let others = |placed: &Placed<'_>, but: &Placed<'_>| -> bool {
            let CbfEntry::Scaled(own, _) = placed.1 else { return false };
            let same = |other: &Placed<'_>| matches!(other.1, CbfEntry::Scaled(x, _) if x == own);
            same(but) || tail.iter().any(same)
        };
        let copied = [others(first, second), others(second, first)];
        let mut factors = [(first, copied[0]), (second, copied[1])].into_iter().map(
            |(head, copied)| -> Result<Factor, Error> {
                let factor = self.factor(head).filter(|&(a, x)| {
                    let bounds = self.model.variable_ref(x).map(|variable| variable.bounds());
                    a > 0.0 && bounds.is_ok_and(|bounds| bounds.lower >= 0.0)
                });
                match factor.filter(|_| !copied) {
                    Some(factor) => Ok(factor),
                    None => Ok((1.0, self.variable(head, 0.0)?)),
                }
            },
        );
        let mut product = Quadratic::zero();
        if let (Some(first), Some(second)) = (factors.next(), factors.next()) {
            let ((a, x), (b, y)) = (first?, second?);
            product.add_product(-2.0 * a * b, x, y);
        }
        Ok(product)
    }

    /// An entry that is a variable times a number.
    fn factor(&self, entry: &Placed<'_>) -> Option<Factor> {
        match entry.1 {
            CbfEntry::Scaled(x, factor) if MODERATE.contains(&factor.abs()) => {
                Some((factor, self.variables[x]))
            }
            _ => None,
        }
    }

    fn affine(&self, entry: &CbfEntry<'_>) -> Affine {
        match *entry {
            CbfEntry::Constant(value) => Affine::constant(value),
            CbfEntry::Scaled(x, factor) => factor * self.variables[x],
            CbfEntry::Other(row) => {
                let mut affine = Affine::constant(row.offset);
                row.terms.iter().for_each(|&(x, value)| affine.add_term(value, self.variables[x]));
                affine
            }
        }
    }

    /// A further variable that is an entry.
    fn variable(&mut self, (at, entry): &Placed<'_>, lower: f64) -> Result<Variable, Error> {
        let added = self.model.continuous(("entry", *at), lower, f64::INFINITY)?;
        let (mut terms, offset) = self.affine(entry).into_parts();
        terms.push((added, -1.0));
        let limit = 0.0 - offset;
        let row = StoredRow { terms, lower: limit, upper: limit };
        self.model.push_constraint(("c", *at).into(), row)?;
        Ok(added)
    }

    /// The row that a head is at least 0, unless a bound says so.
    fn at_least_zero(&mut self, head: &Placed<'_>) -> Result<(), Error> {
        match head.1 {
            CbfEntry::Constant(value) if value >= 0.0 => Ok(()),
            CbfEntry::Scaled(x, factor) => {
                let bounds = self.model.variable_ref(self.variables[x])?.bounds();
                match factor > 0.0 && bounds.lower >= 0.0 {
                    true => Ok(()),
                    false => self.row(head, ConeKind::AtLeast),
                }
            }
            _ => self.row(head, ConeKind::AtLeast),
        }
    }

    fn zero(&mut self, entry: &Placed<'_>) -> Result<(), Error> {
        self.row(entry, ConeKind::Zero)
    }

    fn row(&mut self, (at, entry): &Placed<'_>, kind: ConeKind) -> Result<(), Error> {
        let owned;
        let row = match *entry {
            CbfEntry::Other(row) => row,
            CbfEntry::Scaled(x, factor) => {
                owned = CbfRow { terms: vec![(x, factor)], offset: 0.0 };
                &owned
            }
            CbfEntry::Constant(value) => {
                owned = CbfRow { terms: Vec::new(), offset: value };
                &owned
            }
        };
        let row = stored(row, kind, self.variables);
        self.model.push_constraint(("c", *at).into(), row)?;
        Ok(())
    }

    /// A cone of constants: nothing, or a row that no point satisfies.
    fn check(
        &mut self,
        cone: &CbfCone<'_>,
        heads: &[Option<f64>],
        tail: &[Placed<'_>],
    ) -> Result<(), Error> {
        let head = match *heads {
            [Some(first), Some(second)] => (2.0 * first).sqrt() * second.sqrt(),
            [Some(head)] => head,
            _ => return Ok(()),
        };
        let length = tail.iter().fold(0.0_f64, |length, (_, entry)| match entry {
            CbfEntry::Constant(value) => length.hypot(*value),
            _ => length,
        });
        let rounding = 1e-12 * head;
        if length <= head + rounding {
            return Ok(());
        }
        let row = StoredRow { terms: Vec::new(), lower: length - head, upper: f64::INFINITY };
        self.model.push_constraint(("c", cone.entries[0].0).into(), row)?;
        Ok(())
    }
}
