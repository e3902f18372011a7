//! Products of powers of positive columns also as exponentials of sums of logarithms.
//!
//! A product of several factors is enclosed factor by factor, which loses what they have in common.
//! `x^a y^b z^c = exp(a ln x + b ln y + c ln z)` is convex where no exponent is positive, and its
//! tangents then are its hull (C. D. Maranas, C. A. Floudas, "Global optimization in generalized
//! geometric programming", Computers and Chemical Engineering 21(4), 1997). Both forms hold, and
//! each cuts off what the other leaves.

use std::collections::BTreeMap;

use super::program::Builder;
use super::term::{Shape, SmoothTerm};
use crate::elementary::Elementary;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::{Affine, Model, Name, StoredRow, Variable, VariableKind};
use crate::reformulate::Tie;

/// The least lower bound of a factor whose logarithm is taken: below, it is too wide to say much.
const LEAST_BASE: f64 = 1e-6;

/// Fewest factors of a product that is not convex.
const LEAST_POWERS: usize = 4;

/// Most factors of a product that is restated.
const MOST_POWERS: usize = 40;

/// The terms that say products once more.
pub(super) fn exponentials(
    rows: &mut Model,
    builder: &mut Builder,
    terms: &[SmoothTerm],
) -> Result<Vec<SmoothTerm>, Error> {
    let by_result: BTreeMap<usize, &SmoothTerm> =
        terms.iter().map(|term| (term.result, term)).collect();
    let is_product = |term: &SmoothTerm| !matches!(term.shape, Shape::Elementary { .. });
    let mut inner = vec![false; rows.variable_count()];
    for term in terms.iter().filter(|term| is_product(term)) {
        term.arguments().iter().for_each(|&column| inner[column] = true);
    }
    let mut logarithms: BTreeMap<usize, Variable> = BTreeMap::new();
    let mut found = Vec::new();
    for top in terms.iter().filter(|term| is_product(term) && !inner[term.result]) {
        let mut product =
            ProductFactors { terms: &by_result, builder, constant: 1.0, powers: BTreeMap::new() };
        product.expand(top.result, 1.0);
        let ProductFactors { constant, mut powers, .. } = product;
        powers.retain(|_, power| *power != 0.0);
        let is_convex = powers.len() > 1 && powers.values().all(|power| *power < 0.0);
        let is_plain = !is_convex && powers.len() < LEAST_POWERS;
        let mut is_positive = true;
        for &column in powers.keys() {
            let range = bounds(rows, column)?;
            is_positive &= range.lower >= LEAST_BASE && range.upper.is_finite();
        }
        let is_stated = constant != 0.0 && constant.is_finite();
        if is_plain || powers.len() > MOST_POWERS || !is_positive || !is_stated {
            continue;
        }
        let mut sum = Affine::zero();
        for (&column, &power) in &powers {
            let logarithm = match logarithms.get(&column) {
                Some(known) => *known,
                None => {
                    let range = Elementary::Ln.range(bounds(rows, column)?);
                    let name = free_name(rows, "logarithm");
                    let kind = VariableKind::Continuous;
                    let variable = rows.variable(name, kind, range.lower, range.upper)?;
                    logarithms.insert(column, variable);
                    let shape = Shape::Elementary { function: Elementary::Ln, of: column };
                    let result = variable.index();
                    found.push(SmoothTerm { result, shape, tie: Tie::Exact, is_implied: true });
                    variable
                }
            };
            sum.add_term(power, logarithm);
        }
        let name = free_name(rows, "exponent");
        let of = builder.column(rows, &name, &sum)?;
        let shape = Shape::Elementary { function: Elementary::Exp, of };
        let range = Elementary::Exp.range(bounds(rows, of)?);
        let name = free_name(rows, "exponential");
        let kind = VariableKind::Continuous;
        let variable = rows.variable(name.clone(), kind, range.lower, range.upper)?;
        let own = Variable::new(top.result, rows.tag());
        let terms = vec![(own, 1.0), (variable, -constant)];
        rows.push_constraint(name, StoredRow { terms, lower: 0.0, upper: 0.0 })?;
        let result = variable.index();
        found.push(SmoothTerm { result, shape, tie: Tie::Exact, is_implied: true });
    }
    Ok(found)
}

/// A product, taken apart.
struct ProductFactors<'a> {
    terms: &'a BTreeMap<usize, &'a SmoothTerm>,
    builder: &'a Builder,
    constant: f64,
    /// By column, its exponent.
    powers: BTreeMap<usize, f64>,
}

impl ProductFactors<'_> {
    /// Takes the factors of a column with an exponent.
    fn expand(&mut self, column: usize, power: f64) {
        match self.terms.get(&column).map(|term| &term.shape) {
            Some(Shape::Bilinear([a, b])) => {
                self.expand(*a, power);
                self.expand(*b, power);
            }
            Some(Shape::Quotient([a, b])) => {
                self.expand(*a, power);
                self.expand(*b, -power);
            }
            Some(Shape::Elementary { function: Elementary::Power(p), of }) => {
                self.expand(*of, power * p);
            }
            _ => match self.builder.multiple(column) {
                Some((of, factor)) => {
                    // NaN for a power that a negative number does not have.
                    self.constant *= factor.powf(power);
                    self.expand(of, power);
                }
                None => *self.powers.entry(column).or_default() += power,
            },
        }
    }
}

fn bounds(rows: &Model, column: usize) -> Result<Interval, Error> {
    Ok(rows.variable_ref(Variable::new(column, rows.tag()))?.bounds())
}

fn free_name(rows: &Model, word: &str) -> Name {
    let name = Name::from(word);
    let name = name.free(|name| rows.variable_by_name(name.clone()).is_ok());
    name.free(|name| rows.has_statement(name))
}
