//! The programs of a table: the cells that solve them, their plans, and what they cost.
//!
//! At the end of a way, inputs and columns are affine in the state, so that they interpolate those
//! at the corners of the part of the cell that takes the way. So rows that hold at its corners hold
//! in it, and the cost is a quadratic form of the weights of its corners. So is the cost of the
//! explicit law of the cell, whose loss is proved: the cost is higher by at most the largest
//! difference of coefficients.

use super::cells::{Corner, UNITS, Used};
use super::evidence::product;
use super::exchanges::{HullCorner, Point, Program, Tableau, dot};
use super::leaves::twice_costs;
use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, Words, rejected, unreadable};
use num_bigint::BigInt;
use std::cmp::Ordering;
use std::io::BufRead;
use std::rc::Rc;

/// The most rows of a program, and the most exchanges.
const MOST_STATED_ROWS: usize = 64;
const MOST_STATED_EXCHANGES: usize = 1000;

/// A cell with plans at its corners.
#[derive(Debug)]
pub(super) struct PlannedCell {
    pub(super) share: f64,
    pub(super) corners: Vec<Rc<Corner>>,
    pub(super) plans: Vec<Rc<Used>>,
}

/// The proved parts of the programs of a device, in exact arithmetic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProvedPrograms {
    /// The share of the box whose cells solve programs, from 0 to 1.
    pub share: f64,
    /// The most exchanges at any state of these cells.
    pub exchanges: u64,
    /// By how much rows are missed, at most, beside the tolerance of the table.
    pub missed: f64,
    /// By how much inputs differ from those of the plan, at most.
    pub off: f64,
    /// By how much the plan of a program costs more than that of the cell's explicit law, at most.
    pub excess: f64,
}

impl ProvedPrograms {
    pub(super) const NONE: Self =
        ProvedPrograms { share: 0.0, exchanges: 0, missed: 0.0, off: 0.0, excess: 0.0 };
}

/// A plan at a corner of a hull, multiplied by a positive number.
struct ScaledPlan {
    unit: Dyadic,
    x: Vec<Dyadic>,
    px: Vec<Dyadic>,
    linear: Dyadic,
}

/// A program and the cell that solves it.
struct SolvedCell<'a> {
    statement: &'a Statement,
    cell: &'a PlannedCell,
    states: Vec<Vec<Dyadic>>,
    points: Vec<Point>,
    rows: usize,
    scale: u64,
    /// By how much rows may be missed, and inputs be off.
    missed: f64,
    off: f64,
}

/// Reads the programs of a device with numbers of so many bits, and checks them.
pub(super) fn read_programs<R: BufRead>(
    lines: &mut Lines<R>,
    statement: &Statement,
    cells: &[Option<PlannedCell>],
    bits: usize,
) -> Result<ProvedPrograms, Refusal> {
    let mut words = lines.expect("programs")?;
    if words.count("the number of bits")? != bits {
        return unreadable("the programs are those of another device");
    }
    let count = words.count("the number of programs")?;
    words.end()?;
    let mut proved = ProvedPrograms::NONE;
    let mut solved = vec![false; cells.len()];
    for _ in 0..count {
        let mut words = lines.expect("q")?;
        let rows = words.index("the number of rows", MOST_STATED_ROWS + 1)?;
        let exchanges = words.index("the number of exchanges", MOST_STATED_EXCHANGES + 1)?;
        let limits = [words.number("a limit")?, words.number("a limit")?];
        let (missed, off) = (words.number("a tolerance")?, words.number("a tolerance")?);
        words.end()?;
        if missed < 0.0 || off < 0.0 {
            return rejected("a tolerance of a program is negative");
        }
        let (inputs, columns) = (statement.inputs.len(), statement.columns.len());
        let states = statement.axes.len();
        let (mut matrix, mut right) = (Vec::new(), Vec::new());
        for (word, functions) in [("m", rows + inputs), ("v", columns)] {
            let mut words = lines.expect(word)?;
            matrix.extend(numbers(&mut words, functions * rows)?);
            right.extend(numbers(&mut words, functions * (states + 1))?);
            words.end()?;
        }
        let mut program = Program::new((rows, states), &matrix, &right, limits)?;
        let mut words = lines.expect("solves")?;
        for _ in 0..words.count("the number of cells")? {
            let number = words.index("cell", cells.len())?;
            let excess = words.number("an excess")?;
            let Some(cell) = &cells[number] else {
                return rejected(format!("cell {number} has no plan, and solves a program"));
            };
            if std::mem::replace(&mut solved[number], true) {
                return rejected(format!("cell {number} solves two programs"));
            }
            let state = |corner: &Rc<Corner>| corner.state(statement);
            let states = cell.corners.iter().map(state).collect::<Result<_, _>>()?;
            let points: Vec<Point> = cell.corners.iter().map(|corner| point(corner)).collect();
            let scale = program.scale;
            let own = SolvedCell { statement, cell, states, points, rows, scale, missed, off };
            let law = twice_costs(statement, &cell.plans)?;
            let mut end =
                |tableau: &Tableau, hull: &[HullCorner]| own.check_end(tableau, hull, &law, excess);
            let longest = program.follow(&own.points, exchanges, &mut end)?;
            proved.exchanges = proved.exchanges.max(longest as u64);
            proved.excess = proved.excess.max(excess);
            proved.share += cell.share;
        }
        words.end()?;
        (proved.missed, proved.off) = (proved.missed.max(missed), proved.off.max(off));
    }
    Ok(proved)
}

fn numbers(words: &mut Words<'_>, count: usize) -> Result<Vec<f64>, Refusal> {
    (0..count).map(|_| words.number("an entry")).collect()
}

/// The corner in shares of the sides.
fn point(corner: &Corner) -> Point {
    let units = corner.units.iter().map(|&units| BigInt::from(units));
    std::iter::once(BigInt::from(UNITS)).chain(units).collect()
}

impl SolvedCell<'_> {
    /// Checks the plans of a part of the cell: their rows, their inputs, and what they cost.
    fn check_end(
        &self,
        tableau: &Tableau,
        hull: &[HullCorner],
        law: &[Dyadic],
        excess: f64,
    ) -> Result<(), Refusal> {
        let mut plans = Vec::new();
        for corner in hull {
            let plan = self.plan(tableau, &corner.at)?;
            self.check_rows(&plan)?;
            self.check_inputs(tableau, &corner.at, &plan)?;
            plans.push(plan);
        }
        // Of a plan, the unit is this and the sum of its weights.
        let common = Dyadic::scaled(&tableau.common * UNITS, 0);
        let square = product(&common, &common)?;
        let mut sum = Sum::default();
        for (p, first) in plans.iter().enumerate() {
            for (q, second) in plans.iter().enumerate().take(p + 1) {
                first.x.iter().zip(&second.px).for_each(|(x, px)| sum.add(x, px));
                sum.add(&first.linear, &second.unit);
                sum.add(&second.linear, &first.unit);
                let units = product(&first.unit, &second.unit)?;
                sum.add(2.0 * self.statement.offset, &units);
                sum.subtract(2.0 * excess, &units);
                let mut coefficients = law.iter();
                for v in 0..self.points.len() {
                    for w in 0..=v {
                        let weight = |v: usize, w: usize| &hull[p].at[v] * &hull[q].at[w];
                        let both = if v == w { weight(v, w) } else { weight(v, w) + weight(w, v) };
                        let factor = product(&square, &Dyadic::scaled(both, 0))?;
                        if let Some(coefficient) = coefficients.next() {
                            sum.subtract(coefficient, &factor);
                        }
                    }
                }
                if sum.take_sign()? == Ordering::Greater {
                    return rejected("the plan of a program costs more than is said");
                }
            }
        }
        Ok(())
    }

    /// The plan at a point with these weights, times its unit.
    fn plan(&self, tableau: &Tableau, weights: &[BigInt]) -> Result<ScaledPlan, Refusal> {
        let Statement { columns, inputs, .. } = self.statement;
        let total: BigInt = weights.iter().sum();
        let unit = Dyadic::scaled(&tableau.common * UNITS * total, 0);
        let mut sum = Sum::default();
        let mut x = Vec::with_capacity(columns.len());
        let first = self.rows + inputs.len();
        for (j, column) in columns.iter().enumerate() {
            x.push(match column.axis {
                _ if column.whole => product(&self.cell.plans[0].x[j], &unit)?,
                Some(axis) => {
                    for (weight, state) in weights.iter().zip(&self.states) {
                        let factor = Dyadic::scaled(weight * &tableau.common * UNITS, 0);
                        sum.add(&factor, &state[axis]);
                    }
                    sum.take()?
                }
                None => self.at(&tableau.right[first + j], weights),
            });
        }
        let mut px = Vec::with_capacity(x.len());
        for column in columns {
            column.squares.iter().for_each(|&(k, p)| sum.add(p, &x[k]));
            px.push(sum.take()?);
        }
        columns.iter().zip(&x).for_each(|(column, x)| sum.add(column.linear, x));
        let linear = sum.take()?;
        Ok(ScaledPlan { unit, x, px, linear })
    }

    /// A function of states at a point with these weights, times the unit.
    fn at(&self, of: &[BigInt], weights: &[BigInt]) -> Dyadic {
        let corners = self.points.iter().zip(weights);
        let value: BigInt = corners.map(|(point, weight)| dot(of, point) * weight).sum();
        Dyadic::scaled(value, self.scale)
    }

    /// Checks rows and bounds.
    fn check_rows(&self, plan: &ScaledPlan) -> Result<(), Refusal> {
        let statement = self.statement;
        let mut sum = Sum::default();
        let is_kept = |value: &Dyadic, [lower, upper]: [f64; 2], sum: &mut Sum| {
            for (limit, sign) in [(lower, -1.0), (upper, 1.0)] {
                if limit.is_infinite() && (limit > 0.0) == (sign > 0.0) {
                    continue;
                }
                sum.add(value, sign);
                sum.subtract(sign * limit, &plan.unit);
                sum.subtract(statement.tolerance, &plan.unit);
                sum.subtract(self.missed, &plan.unit);
                if sum.take_sign()? == Ordering::Greater {
                    return Ok(false);
                }
            }
            Ok::<bool, Refusal>(true)
        };
        for (i, (lower, upper, terms)) in statement.rows.iter().enumerate() {
            terms.iter().for_each(|&(j, a)| sum.add(a, &plan.x[j as usize]));
            let value = sum.take()?;
            if !is_kept(&value, [*lower, *upper], &mut sum)? {
                return rejected(format!("the plan of a program misses row {i}"));
            }
        }
        for (j, column) in statement.columns.iter().enumerate() {
            if column.axis.is_none()
                && !column.whole
                && !is_kept(&plan.x[j], [column.lower, column.upper], &mut sum)?
            {
                return rejected(format!("the plan of a program misses a bound of column {j}"));
            }
        }
        Ok(())
    }

    /// Checks that the inputs of the program are those of the plan.
    fn check_inputs(
        &self,
        tableau: &Tableau,
        weights: &[BigInt],
        plan: &ScaledPlan,
    ) -> Result<(), Refusal> {
        let mut sum = Sum::default();
        for (k, (offset, terms)) in self.statement.inputs.iter().enumerate() {
            let own = self.at(&tableau.right[self.rows + k], weights);
            for sign in [1.0, -1.0] {
                sum.add(&own, sign);
                sum.subtract(sign * offset, &plan.unit);
                terms.iter().for_each(|&(j, a)| sum.subtract(sign * a, &plan.x[j as usize]));
                sum.subtract(self.off, &plan.unit);
                if sum.take_sign()? == Ordering::Greater {
                    return rejected("the inputs of a program are not those of its plan");
                }
            }
        }
        Ok(())
    }
}
