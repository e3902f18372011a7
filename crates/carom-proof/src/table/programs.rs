//! The programs of a table: the cells that solve them, and what that takes.

use super::cells::{Corner, UNITS, Used};
use super::exchanges::{Point, Program};
use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, rejected, unreadable};
use num_bigint::BigInt;
use std::cmp::Ordering;
use std::io::BufRead;
use std::rc::Rc;

/// The most rows of a program.
const MOST_ROWS: usize = 64;

/// A cell with plans at its corners.
#[derive(Debug)]
pub(super) struct PlannedCell {
    pub(super) share: f64,
    pub(super) corners: Vec<Rc<Corner>>,
    pub(super) plans: Vec<Rc<Used>>,
}

/// The proved parts of the programs of a device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProvedPrograms {
    /// The share of the box whose cells solve programs, from 0 to 1.
    pub share: f64,
    /// The most exchanges at any state of these cells, in exact arithmetic.
    pub exchanges: u64,
    /// By how much their inputs differ at most from those of the plans, at corners of cells.
    pub apart: f64,
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
    let apart = words.number("a difference")?;
    words.end()?;
    let mut proved = ProvedPrograms { share: 0.0, exchanges: 0, apart };
    let mut solved = vec![false; cells.len()];
    for _ in 0..count {
        let mut words = lines.expect("q")?;
        let rows = words.index("the number of rows", MOST_ROWS + 1)?;
        let exchanges = words.count("the number of exchanges")?;
        let limits = [words.number("a limit")?, words.number("a limit")?];
        words.end()?;
        let sizes = (statement.inputs.len(), statement.axes.len());
        let all = (rows + sizes.0) * (rows + sizes.1 + 1);
        let mut words = lines.expect("m")?;
        let numbers = (0..all).map(|_| words.number("an entry"));
        let numbers = numbers.collect::<Result<Vec<f64>, Refusal>>()?;
        words.end()?;
        let mut program = Program::new(rows, sizes, &numbers, limits)?;
        let mut words = lines.expect("solves")?;
        for _ in 0..words.count("the number of cells")? {
            let number = words.index("cell", cells.len())?;
            let Some(cell) = &cells[number] else {
                return rejected(format!("cell {number} has no plan, and solves a program"));
            };
            if std::mem::replace(&mut solved[number], true) {
                return rejected(format!("cell {number} solves two programs"));
            }
            let points: Vec<Point> = cell.corners.iter().map(|corner| point(corner)).collect();
            for (point, plan) in points.iter().zip(&cell.plans) {
                let inputs = program.inputs_at(point, exchanges)?;
                check_inputs(statement, (&inputs, program.scale), plan, apart)?;
            }
            let longest = program.follow(points, exchanges)?;
            proved.exchanges = proved.exchanges.max(longest as u64);
            proved.share += cell.share;
        }
        words.end()?;
    }
    Ok(proved)
}

/// The corner in shares of the sides.
fn point(corner: &Corner) -> Point {
    let units = corner.units.iter().map(|&units| BigInt::from(units));
    std::iter::once(BigInt::from(UNITS)).chain(units).collect()
}

/// Checks that inputs, as sums and what they are multiples of, are near those of a plan.
fn check_inputs(
    statement: &Statement,
    (inputs, scale): (&[(BigInt, BigInt)], u64),
    plan: &Used,
    apart: f64,
) -> Result<(), Refusal> {
    let mut sum = Sum::default();
    for ((own, unit), (offset, terms)) in inputs.iter().zip(&statement.inputs) {
        sum.add(*offset, 1.0);
        terms.iter().for_each(|&(j, a)| sum.add(a, &plan.x[j as usize]));
        let planned: Dyadic = sum.take()?;
        let own = Dyadic::scaled(own.clone(), scale);
        let unit = Dyadic::scaled(unit.clone(), 0);
        for sign in [1.0, -1.0] {
            sum.add(&own, sign);
            let signed = if sign > 0.0 { planned.clone() } else { planned.negated() };
            sum.subtract(&signed, &unit);
            sum.subtract(&unit, apart);
            if sum.take_sign()? == Ordering::Greater {
                return rejected("the inputs of a program are farther from those of a plan");
            }
        }
    }
    Ok(())
}
