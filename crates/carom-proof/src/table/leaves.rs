//! Cells that are not cut: their plans, and the steps of their proofs.

use super::ProvedTable;
use super::cells::{Checked, Corner, Used, Waiting};
use super::closed_loop::image;
use super::evidence::{Evidence, Part, dense, twice_bound};
use super::statement::Statement;
use crate::exact::{Dyadic, Sum};
use crate::text::{Lines, Refusal, Words, rejected, unreadable};
use std::cmp::Ordering;
use std::io::BufRead;
use std::rc::Rc;

/// A part of a proof: bounds of the columns.
type Sides = Vec<(f64, f64)>;

/// The cost of a law, and the loss that is claimed.
pub(super) struct Claimed {
    /// Twice the coefficients of pairs of corners, in the order (0, 0), (1, 0), (1, 1), ...
    twice_cost: Vec<Dyadic>,
    loss: f64,
}

impl Checked {
    /// A plan at a corner, checked if it is new.
    fn plan(
        &mut self,
        number: usize,
        corner: &Corner,
        statement: &Statement,
    ) -> Result<Rc<Used>, Refusal> {
        let plan = &mut self.plans[number];
        if let Some(used) = &plan.used {
            if used.units != corner.units {
                return rejected(format!("plan {number} is used at two corners"));
            }
            return Ok(Rc::clone(used));
        }
        let own = dense(&plan.entries, statement.columns.len());
        let mut x: Vec<Dyadic> = own.iter().map(|&value| Dyadic::from_f64(value)).collect();
        for (axis, state) in corner.state(statement)?.into_iter().enumerate() {
            x[statement.axes[axis]] = state;
        }
        let mut sum = Sum::default();
        let tolerance = statement.tolerance;
        for (j, (column, &value)) in statement.columns.iter().zip(&own).enumerate() {
            if column.axis.is_some() {
                continue;
            }
            if column.whole && value != value.round() {
                return rejected(format!("column {j} of plan {number} is no whole number"));
            }
            let slack = if column.whole { 0.0 } else { tolerance };
            for (a, b) in [(column.lower, value), (value, column.upper)] {
                sum.add(a, 1.0);
                sum.subtract(b, 1.0);
                sum.subtract(slack, 1.0);
                if sum.take_sign()? == Ordering::Greater {
                    return rejected(format!("plan {number} misses a bound of column {j}"));
                }
            }
        }
        for (i, (lower, upper, terms)) in statement.rows.iter().enumerate() {
            for &(j, a) in terms {
                sum.add(a, &x[j as usize]);
            }
            let value = sum.take()?;
            for (limit, sign) in [(*lower, -1.0), (*upper, 1.0)] {
                if limit.is_infinite() && (limit > 0.0) == (sign > 0.0) {
                    continue;
                }
                sum.add(&value, sign);
                sum.subtract(sign, limit);
                sum.subtract(tolerance, 1.0);
                if sum.take_sign()? == Ordering::Greater {
                    return rejected(format!("plan {number} misses row {i}"));
                }
            }
        }
        for device in &statement.devices {
            device.check_inputs(statement, &x)?;
        }
        let mut px = Vec::with_capacity(x.len());
        for column in &statement.columns {
            column.squares.iter().for_each(|&(k, p)| sum.add(p, &x[k]));
            px.push(sum.take()?);
        }
        statement.columns.iter().zip(&x).for_each(|(column, x)| sum.add(column.linear, x));
        let linear = sum.take()?;
        let next = if statement.next.is_empty() { None } else { image(statement, &x)? };
        let used = Rc::new(Used { units: corner.units.clone(), x, px, linear, next });
        plan.used = Some(Rc::clone(&used));
        Ok(used)
    }

    /// Checks a cell with a plan, and returns the plans of its corners.
    pub(super) fn check_plan<R: BufRead>(
        &mut self,
        head: (f64, Vec<usize>, usize),
        lines: &mut Lines<R>,
        statement: &Statement,
        cell: &Waiting,
        proved: &mut ProvedTable,
    ) -> Result<Vec<Rc<Used>>, Refusal> {
        let (loss, numbers, steps) = head;
        let mut plans = Vec::new();
        for (&number, corner) in numbers.iter().zip(&cell.corners) {
            plans.push(self.plan(number, corner, statement)?);
        }
        for (j, _) in statement.columns.iter().enumerate().filter(|(_, column)| column.whole) {
            let first = plans[0].x[j].nearest();
            if plans.iter().any(|plan| plan.x[j].nearest() != first) {
                return rejected(format!("the plans differ in column {j}, which is whole"));
            }
        }
        if loss.is_infinite() {
            if steps != 0 {
                return rejected("there are steps for an infinite loss");
            }
            proved.unproved += cell.share;
            return Ok(plans);
        }
        let twice_cost = twice_costs(statement, &plans)?;
        let is_within = is_within(statement, &twice_cost, loss)?;
        let claimed = Claimed { twice_cost, loss };
        self.steps(lines, statement, cell, steps, Some(&claimed))?;
        match is_within {
            true => {
                proved.within += cell.share;
                proved.loss = proved.loss.max(loss);
            }
            false => proved.larger += cell.share,
        }
        Ok(plans)
    }

    /// Checks the steps of a proof: that there is no point, or that a claimed loss holds.
    pub(super) fn steps<R: BufRead>(
        &self,
        lines: &mut Lines<R>,
        statement: &Statement,
        cell: &Waiting,
        steps: usize,
        claimed: Option<&Claimed>,
    ) -> Result<(), Refusal> {
        let states = cell.corners.iter().map(|corner| corner.state(statement));
        let states: Vec<Vec<Dyadic>> = states.collect::<Result<_, _>>()?;
        let whole = statement.columns.iter().map(|column| (column.lower, column.upper));
        let mut parts: Vec<Sides> = vec![whole.collect()];
        for _ in 0..steps {
            let (mut words, keyword) = lines.expect_any(&["s", "b", "f"])?;
            let Some(sides) = parts.pop() else {
                return rejected("there are more steps than parts");
            };
            if keyword == "s" {
                let j = words.index("column", sides.len())?;
                let value = words.number("the value")?;
                words.end()?;
                let (lower, upper) = sides[j];
                let is_between = lower <= value && value + 1.0 <= upper;
                if !statement.columns[j].whole || value != value.round() || !is_between {
                    return rejected(format!(
                        "column {j} is not cut into whole numbers at {value}"
                    ));
                }
                let (mut below, mut above) = (sides.clone(), sides);
                below[j] = (lower, value);
                above[j] = (value + 1.0, upper);
                parts.extend([above, below]);
                continue;
            }
            let mut own: Vec<&Evidence> = Vec::new();
            for _ in &cell.corners {
                own.push(&self.evidence[words.index("evidence", self.evidence.len())?]);
            }
            words.end()?;
            if own.iter().any(|one| one.is_ray != (keyword == "f")) {
                return rejected("the evidence is of the other kind");
            }
            close(statement, &own, &states, &sides, claimed)?;
        }
        match parts.is_empty() {
            true => Ok(()),
            false => rejected("a part of the integers has no step"),
        }
    }

    /// The numbers of a line `plan`.
    pub(super) fn head(
        &self,
        words: &mut Words<'_>,
        corners: usize,
    ) -> Result<(f64, Vec<usize>, usize), Refusal> {
        let loss = words.limit("the loss")?;
        if loss < 0.0 {
            return unreadable("the loss is negative");
        }
        let numbers = (0..corners).map(|_| words.index("plan", self.plans.len()));
        let numbers = numbers.collect::<Result<_, _>>()?;
        let steps = words.count("the number of steps")?;
        words.end()?;
        Ok((loss, numbers, steps))
    }
}

/// Twice the coefficients of the cost of interpolated plans, by pairs of corners, in the order
/// (0, 0), (1, 0), (1, 1), ...
pub(super) fn twice_costs(
    statement: &Statement,
    plans: &[Rc<Used>],
) -> Result<Vec<Dyadic>, Refusal> {
    let mut twice_cost = Vec::new();
    let mut sum = Sum::default();
    for (v, plan) in plans.iter().enumerate() {
        for other in &plans[..=v] {
            plan.x.iter().zip(&other.px).for_each(|(x, p)| sum.add(x, p));
            sum.add(&plan.linear, 1.0);
            sum.add(&other.linear, 1.0);
            sum.add(statement.offset, 2.0);
            twice_cost.push(sum.take()?);
        }
    }
    Ok(twice_cost)
}

/// Whether a loss is at most `absolute + relative |f|` for the least cost f at each state of a
/// cell, where f is between cost less loss, and cost.
fn is_within(statement: &Statement, twice_cost: &[Dyadic], loss: f64) -> Result<bool, Refusal> {
    let [absolute, relative] = statement.loss;
    let mut sum = Sum::default();
    // Twice `loss - absolute - relative (cost - loss)`, or `... - relative (-cost)`.
    let mut holds = [true; 2];
    for cost in twice_cost {
        for (sign, holds) in [1.0, -1.0].into_iter().zip(&mut holds) {
            sum.add(2.0, loss);
            sum.subtract(2.0, absolute);
            sum.subtract(cost, sign * relative);
            if sign > 0.0 {
                sum.add(2.0 * relative, loss);
            }
            *holds &= sum.take_sign()? != Ordering::Greater;
        }
    }
    Ok(loss <= absolute || holds[0] || holds[1])
}

/// Checks that evidence closes a part.
fn close(
    statement: &Statement,
    own: &[&Evidence],
    states: &[Vec<Dyadic>],
    sides: &Sides,
    claimed: Option<&Claimed>,
) -> Result<(), Refusal> {
    let parts = own.iter().zip(states).map(|(one, state)| one.part(statement, state, sides));
    let parts: Vec<Part> = parts.collect::<Result<_, _>>()?;
    let mut sum = Sum::default();
    let mut number = 0;
    for v in 0..own.len() {
        for w in 0..=v {
            let at = |k: usize| (own[k], &parts[k], &states[k][..]);
            let twice = twice_bound(statement, [at(v), at(w)])?;
            sum.add(&twice, 1.0);
            if own[v].is_ray {
                if sum.take_sign()? != Ordering::Greater {
                    return rejected("the multipliers do not exclude a point");
                }
                continue;
            }
            let Some(Claimed { twice_cost, loss }) = claimed else {
                return rejected("a bound does not exclude a point");
            };
            sum.add(2.0, *loss);
            sum.subtract(&twice_cost[number], 1.0);
            if sum.take_sign()? == Ordering::Less {
                return rejected(format!("the loss is not at most {loss}"));
            }
            number += 1;
        }
    }
    Ok(())
}
