//! Products that are 0 at every point, and make the squares that binaries switch off tighter.
//!
//! A square `q/2 (x - v)^2` of a column that is `v` while a binary is off lies far below the least
//! cost where the binary is a fraction. With `w` for 1 when on and 0 when off, the search puts
//! `q/2 (x - v)^2 + q r (x - v) (1 - w) - q r^2/2 w (1 - w)` in its place. Both products are 0 at
//! every point: one of their factors is, in either case of the binary. So the log adds them to the
//! objective.

use std::collections::{BTreeMap, BTreeSet};

use super::aggregated_row::AggregatedRow;
use super::bounds::{Bounds, Side};
use super::tree::ProofWriter;
use super::zero_products::{ObjectiveTerms, ZeroProduct};
use crate::program::Program;
use crate::search::{Switched, lifting_slopes, switched_squares};
use crate::sum::exact_sum;

/// How much more than its part the square of a binary gets, so that the sum is convex in spite of
/// rounding (no unit).
const CONVEX_IN_SPITE: f64 = 1e-10;

impl ProofWriter<'_, '_> {
    /// Adds products to the objective: those that make it convex, or else those that lift the bound
    /// of the relaxation.
    pub(super) fn add_zero_products(&mut self) {
        if !self.squares.is_empty() {
            // Where a column is never 0, the product is that of its distance from 1.
            let squares = self.squares.iter().map(|&(binary, amount)| {
                let is_off_at_one = self.bounds.of(binary)[0] > 0.0;
                let (value, factor) = if is_off_at_one { (1.0, amount) } else { (0.0, -amount) };
                let facts = Vec::new();
                ZeroProduct { column: binary, value, binary, is_off_at_one, factor, facts }
            });
            return self.add_products(&squares.collect::<Vec<ZeroProduct>>());
        }
        let bounded = self.bounded();
        let (options, token) = (self.relaxer.options, self.relaxer.token);
        let mut squares = switched_squares(&bounded, token);
        squares.retain(|square| self.off_facts(square).is_some());
        if squares.is_empty() {
            return;
        }
        let cascade = &mut self.relaxer.cascade;
        let slopes = lifting_slopes(&bounded, squares, options, token, cascade);
        let products = self.zero_products(&slopes);
        self.add_products(&products);
    }

    fn add_products(&mut self, products: &[ZeroProduct]) {
        let Some((program, terms)) = self.with_products(products) else { return };
        let mut sides = Vec::new();
        for product in products {
            let &ZeroProduct { column, binary, .. } = product;
            sides.extend([column, binary].iter().flat_map(|&j| [(j, false), (j, true)]));
            for &(is_upper, fact) in &product.facts {
                let is_upper = self.is_upper_limit(fact, (column, is_upper));
                sides.extend(Bounds::sides_of(&self.facts, fact, is_upper, Some(column)));
            }
        }
        self.write_bounds(sides.into_iter());
        self.log.zero_products(products);
        self.relaxer.terms = terms;
        self.relaxer.within = program.clone();
        self.relaxer.program = program;
    }

    /// The facts by which the column of a square has its value while the binary is off; none for a
    /// side whose own bound is the value. The search allows for rounding, and keeps no rows.
    fn off_facts(&self, square: &Switched) -> Option<Vec<(bool, usize)>> {
        let (column, bounds) = (square.column, self.bounds.of(square.column));
        let mut found = Vec::new();
        for is_upper in [false, true] {
            let own = bounds[usize::from(is_upper)];
            if own.is_infinite() || (own < square.value) == is_upper && own != square.value {
                return None;
            }
            if own != square.value {
                let facts = self.facts.of_column(column).iter().map(|&fact| fact as usize);
                let fact = { facts }.find(|&fact| self.implies(fact, is_upper, square))?;
                found.push((is_upper, fact));
            }
        }
        Some(found)
    }

    /// Whether it is the upper limit of a fact that bounds a side of a column.
    fn is_upper_limit(&self, fact: usize, (column, is_upper): Side) -> bool {
        let own = self.facts.terms(fact).find(|(j, _)| *j == column);
        own.is_some_and(|(_, a)| (a > 0.0) == is_upper)
    }

    /// Whether a fact bounds the column of a square by its value while the binary is off, without
    /// rounding.
    fn implies(&self, fact: usize, is_upper: bool, square: &Switched) -> bool {
        let &Switched { column, binary, off_at_one, value, .. } = square;
        let is_upper_limit = self.is_upper_limit(fact, (column, is_upper));
        let limit = self.facts.limits(fact)[usize::from(is_upper_limit)];
        let sign = if is_upper_limit { 1.0 } else { -1.0 };
        // A column that takes whole numbers is beyond one only from the next one on.
        let next = match (self.relaxer.program.integral[column], is_upper) {
            (true, true) => 0.5,
            (true, false) => -0.5,
            _ => 0.0,
        };
        // The limit without the terms, each at its best, must not be above 0.
        let mut sum = AggregatedRow::default();
        sum.clear(1);
        sum.add(0, limit, sign);
        for (j, a) in self.facts.terms(fact) {
            let [lower, upper] = match j {
                _ if j == column => [value + next; 2],
                _ if j == binary => [f64::from(u8::from(off_at_one)); 2],
                _ => self.bounds.of(j),
            };
            let best = if (a > 0.0) == is_upper_limit { lower } else { upper };
            if best.is_infinite() {
                return false;
            }
            sum.add(0, -sign * a, best);
        }
        limit.is_finite() && sum.missing(&|_| [0.0, f64::INFINITY]).is_empty()
    }

    /// The products of slopes, with factors with which no entry of the matrix is rounded. What
    /// would be is left out.
    fn zero_products(&self, slopes: &[(Switched, f64)]) -> Vec<ZeroProduct> {
        let program = &self.relaxer.program;
        // By binary: its products, and half of the square that they need.
        let mut of_binary: BTreeMap<usize, (Vec<ZeroProduct>, f64)> = BTreeMap::new();
        let mut taken = BTreeSet::new();
        for &(square, slope) in slopes {
            let Switched { column, curvature, binary, off_at_one, value } = square;
            let pair = [column.min(binary), column.max(binary)];
            let factor = curvature * slope;
            let is_usable = factor.is_normal() && program.quadratic_entry(column, binary) == 0.0;
            if !is_usable || taken.contains(&pair) {
                continue;
            }
            let Some(facts) = self.off_facts(&square) else { continue };
            taken.insert(pair);
            let (products, half) = of_binary.entry(binary).or_default();
            products.push(ZeroProduct {
                column,
                value,
                binary,
                is_off_at_one: off_at_one,
                factor,
                facts,
            });
            *half += 0.5 * factor * slope;
        }
        let mut all = Vec::new();
        for (binary, (products, half)) in of_binary {
            let before = program.quadratic_entry(binary, binary);
            let after = before + 2.0 * half * (1.0 + CONVEX_IN_SPITE);
            let (added, error) = exact_sum(after, -before);
            if error == 0.0 && added.is_normal() && before + added == after {
                let (column, factor, facts) = (binary, -0.5 * added, Vec::new());
                let (value, is_off_at_one) = (0.0, false);
                all.extend(products);
                all.push(ZeroProduct { column, value, binary, is_off_at_one, factor, facts });
            }
        }
        all
    }

    /// The program with products, and its terms without rounding; `None` if there are none.
    fn with_products(&self, products: &[ZeroProduct]) -> Option<(Program, ObjectiveTerms)> {
        if products.is_empty() {
            return None;
        }
        let mut program = self.relaxer.program.clone();
        let mut terms = ObjectiveTerms::of(&program);
        let mut entries: Vec<_> = program.quadratic_entries().collect();
        for product in products {
            let factor = terms.add(product);
            let &ZeroProduct { column, binary, .. } = product;
            match column == binary {
                true => entries.push((column, column, 2.0 * factor)),
                false => entries.extend([(column, binary, factor), (binary, column, factor)]),
            }
        }
        let mut linear = vec![0.0; program.column_count()];
        terms.linear.iter().for_each(|&(j, a, b)| linear[j] += a * b);
        let offset = terms.constant.iter().map(|(a, b)| a * b).sum();
        program.rewrite_objective(linear, &entries, offset)?;
        Some((program, terms))
    }
}
