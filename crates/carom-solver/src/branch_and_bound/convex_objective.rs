//! An objective that is not convex as a convex one that is the same at all points, or less by a
//! known loss.
//!
//! For an integral column with the two values `l` and `l + 1`, `(x - l)(x - l - 1)` is 0. So a
//! multiple of it may be added, until the form is convex (Hammer and Rubin, Some remarks on
//! quadratic programming with 0-1 variables, RIRO 4, 1970). Or products with the column get columns
//! of their own (McCormick, Computability of global solutions to factorable nonconvex programs,
//! Mathematical Programming 10, 1976). For another column, `(x - l)(x - u)` is at least
//! `-(u - l)^2 / 4`; so a multiple lowers the objective, by so much at most (Androulakis, Maranas
//! and Floudas, alphaBB, Journal of Global Optimization 7, 1995).

use std::collections::{BTreeMap, BTreeSet};

use super::curvature_dual::{BinaryBlock, BinaryRow, proved_amounts, square_of, with_few_digits};
use super::equation_squares::{EquationSquare, squares_of_equations, with_equations};
use crate::error::Error;
use crate::interval::{add_down, add_up};
use crate::model::{
    ConstraintRef, Model, Name, Quadratic, StoredRow, Variable, VariableKind, WRITE_SQUARES,
};
use crate::presolve::Domain;
use crate::semidefinite::{
    Direction, Product, blocks, least_multiple, negative_direction, with_squares,
};
use crate::sum::exact_sum;
use crate::tolerance;

/// The sum of multiples that is slight beside the coefficients of the products (no unit).
const SLIGHT_SHIFT: f64 = 0.1;

/// The loss of a block that is taken without another thought, in the objective's unit.
const SMALL_LOSS: f64 = 0.1 * tolerance::ABSOLUTE_GAP;

/// Most products of a column, on average, that get columns of their own, and most of a block.
const FEW_PRODUCTS: f64 = 4.0;
const MOST_PRODUCTS: usize = 20_000;

/// How much more than the least multiple the squares of columns with more values get where products
/// tie them to columns with two, so that these need no large one (no unit).
const WITH_ROOM: f64 = 1.5;

/// The help of errors of a solve.
const GIVE_BOUNDS: &str = "products with a binary have linear forms within bounds only; give its variables \
                           finite ones";
/// A model whose objective is convex.
pub(super) struct ConvexForm {
    pub(super) model: Model,
    /// By how much its objective may be below that of the model at a point, in the objective's
    /// unit.
    pub(super) loss: f64,
    /// CurvedColumns between 0 and 1 and the multiples of `z^2 - z` that make the objective as it
    /// was convex, as far as there are any: for proofs.
    pub(super) squares: Option<Vec<(usize, f64)>>,
}

/// The bounds of columns, and which have two values at most.
struct CurvedColumns<'a> {
    domain: &'a Domain,
    has_two_values: Vec<bool>,
    /// Which are integral within 0 and 1 by their own bounds.
    is_binary: Vec<bool>,
}

impl CurvedColumns<'_> {
    fn ends(&self, j: usize) -> [f64; 2] {
        self.domain.bounds(j)
    }

    fn width(&self, j: usize) -> f64 {
        let [lower, upper] = self.ends(j);
        upper - lower
    }
}

/// The changes of an objective.
#[derive(Default)]
struct ConvexChanges {
    /// Squares of equations, which come first.
    equations: Vec<EquationSquare>,
    /// Multiples of `(x - l)(x - u)`.
    squares: Vec<(usize, f64)>,
    /// Products that get columns of their own.
    products: Vec<Product>,
    loss: f64,
    /// Those of columns between 0 and 1 that are enough; `None` where they are not.
    proof: Option<Vec<(usize, f64)>>,
}

/// The form of a model that has only rows.
///
/// # Arguments
///
/// * `may_square`: whether squares of equations may be added, which proofs do not know.
///
/// # Errors
///
/// [`ErrorKind::NotConvex`](crate::error::ErrorKind::NotConvex) if there is none within these
/// bounds.
pub(super) fn convex_form(
    model: &Model,
    domain: &Domain,
    may_square: bool,
) -> Result<ConvexForm, Error> {
    let whole = model.variables().map(|variable| variable.kind().is_integral());
    let two = whole.enumerate().map(|(j, whole)| {
        let width = domain.upper(j) - domain.lower(j);
        width == 0.0 || (whole && width <= 1.0)
    });
    let binary = model.variables().map(|variable| {
        let bounds = variable.bounds();
        variable.kind().is_integral() && bounds.lower >= 0.0 && bounds.upper <= 1.0
    });
    let (has_two_values, is_binary) = (two.collect(), binary.collect());
    let columns = CurvedColumns { domain, has_two_values, is_binary };
    let mut changes = ConvexChanges { proof: Some(Vec::new()), ..ConvexChanges::default() };
    for (names, products) in blocks(&model.minimized_products()) {
        let products = products.into_iter().map(|(a, b, q)| (names[a], names[b], q));
        let mut products: Vec<Product> = products.collect();
        products.sort_by_key(|&(a, b, _)| (a, b));
        changes.add_block(model, &products, &columns, may_square)?;
    }
    let (loss, squares) = (changes.loss, std::mem::take(&mut changes.proof));
    Ok(ConvexForm { model: changes.apply(model, &columns)?, loss, squares })
}

impl ConvexChanges {
    /// Makes the products of a block convex.
    fn add_block(
        &mut self,
        model: &Model,
        block: &[Product],
        columns: &CurvedColumns<'_>,
        may_square: bool,
    ) -> Result<(), Error> {
        let Some(direction) = negative_direction(block, &|_| 0.0) else { return Ok(()) };
        let two = |j: usize| columns.has_two_values[j];
        if self.raise_slightly(block, columns) {
            return Ok(());
        }
        let refused = |direction, help| model.not_convex(model.sense(), direction, help);
        let (inner, with_two): (Vec<Product>, Vec<Product>) =
            block.iter().partition(|(a, b, _)| !two(*a) && !two(*b));
        let mut raised = block.to_vec();
        if !inner.is_empty() {
            let weight = |&j: &usize| columns.width(j).powi(-2);
            let weights = members(&inner).into_iter().map(|j| (j, weight(&j))).collect();
            let multiple =
                least_multiple(&inner, &weights).map_err(|d| refused(d, WRITE_SQUARES))?;
            let multiple = if with_two.is_empty() { multiple } else { WITH_ROOM * multiple };
            if multiple > 0.0 {
                let amounts = weights.iter().map(|(&j, w)| (j, multiple * w));
                let amounts: Vec<(usize, f64)> = amounts.filter(|(_, a)| *a > 0.0).collect();
                self.loss += amounts
                    .iter()
                    .map(|&(j, a)| add_up(0.25 * a * columns.width(j).powi(2), 0.0))
                    .sum::<f64>();
                self.squares.extend(amounts);
                raised = with_squares(block, &weights, multiple);
            }
        }
        if with_two.is_empty() {
            return Ok(());
        }
        let crossing = |(a, b, _): &&Product| a != b;
        let is_bounded =
            |(a, b, _): &Product| columns.width(*a).is_finite() && columns.width(*b).is_finite();
        let count = with_two.iter().filter(crossing).count();
        let involved = with_two.iter().flat_map(|&(a, b, _)| [a, b]).collect::<BTreeSet<_>>();
        let is_sparse =
            2.0 * count as f64 <= FEW_PRODUCTS * involved.len() as f64 && count <= MOST_PRODUCTS;
        let own = members(block);
        let of_two = own.iter().copied().filter(|j| two(*j)).collect();
        let (mut equations, mut best) = (Vec::new(), None);
        if of_two == own && !is_sparse {
            let rows = binary_rows(model, &own, columns);
            if may_square {
                equations = squares_of_equations(block, &rows);
                raised = with_equations(block, &equations);
            }
            best = dual_shift(model, &raised, &equations, &rows, columns);
        }
        let shift = match best {
            Some(amounts) => Ok(amounts),
            None => least_shift(&raised, &of_two),
        };
        let shift = shift.map(|amounts| {
            let short = |(j, a)| (j, with_few_digits(a, square_of(&raised, j), columns.ends(j)));
            amounts.into_iter().map(short).collect::<Vec<_>>()
        });
        match (&shift, &mut self.proof) {
            (Ok(amounts), Some(proof)) if amounts.iter().all(|(j, _)| columns.is_binary[*j]) => {
                proof.extend(amounts);
            }
            _ => self.proof = None,
        }
        let total: f64 = with_two.iter().map(|(.., q)| q.abs()).sum();
        let is_linear = with_two.iter().all(is_bounded);
        match shift {
            Ok(amounts)
                if !is_linear
                    || !is_sparse
                    || amounts.iter().map(|(_, a)| a).sum::<f64>() <= SLIGHT_SHIFT * total =>
            {
                self.squares.extend(amounts);
                self.equations.extend(equations);
            }
            Err(_) if !is_linear => return Err(refused(direction, GIVE_BOUNDS)),
            _ => self.products.extend(with_two),
        }
        Ok(())
    }

    /// Raises the squares of all columns of a block, if that costs next to nothing: coefficients of
    /// a convex form that were rounded.
    fn raise_slightly(&mut self, block: &[Product], columns: &CurvedColumns<'_>) -> bool {
        let weight = |j: usize| match columns.has_two_values[j] {
            true => 1.0,
            false => columns.width(j).powi(-2),
        };
        let weights: BTreeMap<usize, f64> =
            members(block).into_iter().map(|j| (j, weight(j))).collect();
        let wide = weights.keys().filter(|j| !columns.has_two_values[**j]).count();
        let Ok(multiple) = least_multiple(block, &weights) else { return false };
        let loss = add_up(0.25 * multiple * wide as f64, 0.0);
        if wide == 0 || loss > SMALL_LOSS {
            return false;
        }
        self.loss += loss;
        let amounts = weights.iter().map(|(&j, weight)| (j, multiple * weight));
        self.squares.extend(amounts.filter(|(_, amount)| *amount > 0.0));
        if let Some(proof) = &mut self.proof {
            let binaries = weights.keys().filter(|j| columns.is_binary[**j]);
            proof.extend(binaries.map(|&j| (j, multiple)));
        }
        true
    }

    /// The model with the objective that the changes leave, and rows for products.
    fn apply(self, model: &Model, columns: &CurvedColumns<'_>) -> Result<Model, Error> {
        let sign = model.sense().sign();
        let ids: Vec<Variable> = model.variables().map(|variable| variable.id()).collect();
        let mut convex = model.clone();
        let mut objective = model.objective().clone();
        let add_affine = |objective: &mut Quadratic, j: usize, a: f64| {
            objective.append(&Quadratic::from(sign * a * ids[j]), 1.0);
        };
        for square in &self.equations {
            for (a, b, q) in square.products() {
                objective.add_product(sign * q, ids[a], ids[b]);
            }
            square.linear().for_each(|(j, a)| add_affine(&mut objective, j, a));
            let constant = square.factor * square.limit * square.limit;
            objective.append(&Quadratic::from(sign * constant), 1.0);
        }
        for (j, amount) in self.squares {
            // a (x - l)(x - u)
            let [lower, upper] = columns.ends(j);
            objective.add_product(sign * amount, ids[j], ids[j]);
            add_affine(&mut objective, j, -amount * (lower + upper));
            objective.append(&Quadratic::from(sign * amount * lower * upper), 1.0);
        }
        for (number, (a, b, q)) in (1..).zip(self.products) {
            objective.add_product(-sign * q, ids[a], ids[b]);
            // The first one has two values at most, `l` and `u`; the second is within `[m, n]`.
            let (x, y) = if columns.has_two_values[a] { (a, b) } else { (b, a) };
            let ([l, u], [m, n]) = (columns.ends(x), columns.ends(y));
            let height = add_up(n, -m);
            // x y = (l + t)(m + s) = l y + m x - l m + t s
            add_affine(&mut objective, y, q * l);
            add_affine(&mut objective, x, q * m);
            objective.append(&Quadratic::from(-sign * q * l * m), 1.0);
            if u == l || height == 0.0 {
                continue;
            }
            if x == y {
                // t s = t^2 = t
                add_affine(&mut objective, x, q);
                objective.append(&Quadratic::from(-sign * q * l), 1.0);
                continue;
            }
            let name = format!("objective_product{number}");
            let name = Name::from(name).free(|name| {
                model.variable_by_name(name.clone()).is_ok() || model.has_statement(name)
            });
            let w = convex.variable(name.clone(), VariableKind::Continuous, 0.0, height)?;
            objective.append(&Quadratic::from(sign * q * w), 1.0);
            let mut row = |suffix, terms: Vec<(Variable, f64)>, [lower, upper]: [f64; 2]| {
                let name = name.suffixed(suffix).free(|name| convex.has_statement(name));
                convex.push_constraint(name, StoredRow { terms: sorted(terms), lower, upper })
            };
            let (none, any) = (f64::NEG_INFINITY, f64::INFINITY);
            if q > 0.0 {
                // w >= s - height (1 - t)
                let least = add_down(add_down(-height, -m), -height * l);
                row("_least", vec![(w, 1.0), (ids[y], -1.0), (ids[x], -height)], [least, any])?;
            } else {
                row(
                    "_switch",
                    vec![(w, 1.0), (ids[x], -height)],
                    [none, add_up(-height * l, 0.0)],
                )?;
                row("_most", vec![(w, 1.0), (ids[y], -1.0)], [none, -m])?;
            }
        }
        convex.replace_convex_objective(objective.compacted());
        Ok(convex)
    }
}

fn sorted(mut terms: Vec<(Variable, f64)>) -> Vec<(Variable, f64)> {
    terms.sort_by_key(|term| term.0);
    terms
}

fn members(products: &[Product]) -> BTreeSet<usize> {
    products.iter().flat_map(|&(a, b, _)| [a, b]).collect()
}

/// Amounts by which the squares of some columns make a form convex, with a small sum.
fn least_shift(
    products: &[Product],
    columns: &BTreeSet<usize>,
) -> Result<Vec<(usize, f64)>, Direction> {
    let even: BTreeMap<usize, f64> = columns.iter().map(|&j| (j, 1.0)).collect();
    // What each row lacks of the sum of its other entries.
    let mut lacking: BTreeMap<usize, f64> = columns.iter().map(|&j| (j, 0.0)).collect();
    for &(a, b, q) in products {
        if a == b {
            lacking.entry(a).and_modify(|sum| *sum -= q);
        } else {
            for j in [a, b] {
                lacking.entry(j).and_modify(|sum| *sum += 0.5 * q.abs());
            }
        }
    }
    lacking.values_mut().for_each(|sum| *sum = sum.max(0.0));
    let sum = |weights: &BTreeMap<usize, f64>| weights.values().sum::<f64>();
    let by_rows = least_multiple(products, &lacking).map(|t| (t * sum(&lacking), t, &lacking));
    let evenly = least_multiple(products, &even).map(|t| (t * sum(&even), t, &even));
    let (_, multiple, weights) = match (by_rows, evenly) {
        (Ok(by_rows), Ok(evenly)) => {
            if by_rows.0 < evenly.0 {
                by_rows
            } else {
                evenly
            }
        }
        (Ok(one), Err(_)) | (Err(_), Ok(one)) => one,
        (Err(direction), Err(_)) => return Err(direction),
    };
    let amount = |(&j, &weight): (&usize, &f64)| {
        let before = square_of(products, j);
        let (amount, error) = exact_sum(before + multiple * weight, -before);
        // No digit of the sum is lost.
        (j, if error == 0.0 { amount } else { multiple * weight })
    };
    Ok(weights.iter().filter(|(_, weight)| **weight > 0.0).map(amount).collect())
}

/// The rows over columns with two values.
fn binary_rows(
    model: &Model,
    members: &BTreeSet<usize>,
    columns: &CurvedColumns<'_>,
) -> Vec<BinaryRow> {
    let fixed = |j: usize| (columns.width(j) == 0.0).then(|| columns.ends(j)[0]);
    let is_over = |row: &ConstraintRef<'_>| {
        let mut own = row.terms().iter().map(|(variable, _)| variable.index());
        own.all(|j| members.contains(&j) || fixed(j).is_some())
    };
    let rows = model.constraints().filter(is_over).flat_map(|row| {
        let terms = row.terms().iter().map(|&(variable, a)| (variable.index(), a));
        BinaryRow::of(terms, [row.limits().lower, row.limits().upper], fixed)
    });
    rows.collect()
}

/// Amounts by which squares make a form convex, with a high bound; `None` if that takes too long.
///
/// # Arguments
///
/// * `products`: with those of `equations`.
/// * `rows`: those over columns with two values.
fn dual_shift(
    model: &Model,
    products: &[Product],
    equations: &[EquationSquare],
    rows: &[BinaryRow],
    columns: &CurvedColumns<'_>,
) -> Option<Vec<(usize, f64)>> {
    let sign = model.sense().sign();
    let own = model.objective().affine().terms();
    let own = own.into_iter().map(|(variable, cost)| (variable.index(), sign * cost));
    let mut costs: BTreeMap<usize, f64> = BTreeMap::new();
    for (j, cost) in own.chain(equations.iter().flat_map(EquationSquare::linear)) {
        *costs.entry(j).or_default() += cost;
    }
    let cost = |j: usize| costs.get(&j).copied().unwrap_or(0.0);
    let block = BinaryBlock { products, rows, ends: &|j| columns.ends(j), cost: &cost };
    let even: BTreeMap<usize, f64> = members(products).into_iter().map(|j| (j, 1.0)).collect();
    proved_amounts(products, &block.multiples()?, &even)
}
