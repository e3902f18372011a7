//! Multipliers of a continuous program: from a relaxation of the presolved program, back through
//! presolve, and checked against the original one.

use crate::presolve::Reduced;
use crate::presolve::root::{Presolve, PresolveRule, Presolved, presolve};
use crate::program::Program;
use crate::relaxation::{ConeCut, MethodCascade, Purpose, RelaxationClaim};
use crate::solver::StopToken;
use crate::sum::Sum;
use crate::tolerance::{self, largest_magnitude};

/// Reduced costs, and pressures of rows on columns, below this fraction of the largest coefficient
/// of the objective or of their own terms are rounding (no unit).
const RELATIVE_ROUNDING: f64 = 1e-8;

/// Multipliers of a program, as derivatives of its minimum: one a row and one a column.
#[derive(Debug, Clone)]
pub(super) struct Derivatives {
    pub(super) rows: Vec<f64>,
    pub(super) columns: Vec<f64>,
}

/// The multipliers at an optimal point of a program without integral columns, or `None` if they
/// cannot be verified or the token is over.
pub(super) fn derivatives(
    program: &Program,
    presolved: &Presolved,
    point: &[f64],
    cascade: &mut MethodCascade,
    token: &StopToken,
) -> Option<Derivatives> {
    if program.is_feasibility_problem() {
        let (rows, columns) = (vec![0.0; program.row_count()], vec![0.0; program.column_count()]);
        return Some(Derivatives { rows, columns });
    }
    if !program.cones.is_empty() {
        return conic_derivatives(program, point, cascade, token);
    }
    // An interior-point method wants an interior.
    let small = &presolved.program;
    let anew = if small.lower.iter().zip(&small.upper).any(|(lower, upper)| lower == upper) {
        Some(presolve(program, &PresolveRule::ALL, token).ok()?)
    } else {
        None
    };
    let presolved = match &anew {
        Some(Presolve::Presolved(presolved)) => presolved,
        Some(_) => return None,
        None => presolved,
    };
    let left = Reduced::whole(&presolved.program);
    if left.columns.is_empty() {
        return checked(program, presolved, point, &[], &vec![0.0; left.rows.len()]);
    }
    cascade.solve_until(&left, Purpose::Multipliers, token, |result| {
        let solved = result.claim == RelaxationClaim::Solved;
        solved.then(|| checked(program, presolved, point, &result.x, &result.y))?
    })
}

/// Restores multipliers of the presolved program, and checks them at a point of the original.
fn checked(
    program: &Program,
    presolved: &Presolved,
    point: &[f64],
    x: &[f64],
    y: &[f64],
) -> Option<Derivatives> {
    let restored = presolved.restore(x, y).ok()?;
    judged(program, point, restored.x, restored.y, &[])
}

/// As [`derivatives`], of a program with cones.
fn conic_derivatives(
    program: &Program,
    point: &[f64],
    cascade: &mut MethodCascade,
    token: &StopToken,
) -> Option<Derivatives> {
    cascade.conic_multipliers(&Reduced::whole(program), token, |(x, y, cuts)| {
        judged(program, point, x, y, &cuts)
    })
}

/// The part of the reduced cost of each column that the rows that hold in the cones add.
fn pressures(cuts: &[(ConeCut, f64)], columns: usize) -> Vec<f64> {
    let mut pressure = vec![0.0; columns];
    for (cut, multiplier) in cuts {
        cut.terms.iter().for_each(|&(j, a)| pressure[j] += multiplier * a);
    }
    pressure
}

/// Checks multipliers at a point, with rows `terms <= 0` that hold in the cones.
fn judged(
    program: &Program,
    point: &[f64],
    x: Vec<f64>,
    mut y: Vec<f64>,
    cuts: &[(ConeCut, f64)],
) -> Option<Derivatives> {
    let activities: Vec<f64> = (0..y.len()).map(|row| activity(program, row, &x)).collect();
    let costs = program.linear.iter().chain(program.quadratic.val());
    let scale = largest_magnitude(costs);
    drop_rounding(program, &activities, scale, &mut y);
    // The distance of the point from the bound that the pair of `x` and `y` proves.
    let mut excess = Sum::new(program.objective(point));
    excess.add(-program.objective(&x));
    for (row, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
        let room =
            [activities[row] - program.row_lower[row], program.row_upper[row] - activities[row]];
        excess.add_product(y.abs(), room[usize::from(y > 0.0)].abs());
    }
    let pressure = pressures(cuts, x.len());
    for (cut, multiplier) in cuts {
        excess.add_product(*multiplier, cut.violation(&x).abs());
    }
    let mut columns = Vec::with_capacity(x.len());
    for (j, &value) in x.iter().enumerate() {
        let (d, size) = reduced_cost(program, j, &x, &y);
        let (d, size) = (d + pressure[j], size.max(pressure[j].abs()));
        let d = if d.abs() <= RELATIVE_ROUNDING * size.max(scale) { 0.0 } else { d };
        let limits = [program.lower[j], program.upper[j]];
        if !program.cones.is_empty() && limits[usize::from(d < 0.0)].is_infinite() {
            // What an interior-point method leaves: no limit is there to press on.
            excess.add_product(d.abs(), value.abs().max(1.0));
            columns.push(0.0);
            continue;
        }
        let limit = if d > 0.0 { program.lower[j] } else { program.upper[j] };
        if d != 0.0 {
            excess.add_product(d.abs(), (value - limit).abs());
        }
        columns.push(d);
    }
    let allowed = tolerance::COMPLEMENTARITY * program.objective(point).abs().max(1.0);
    // Not a number where a multiplier presses on a limit that is not there.
    let rows = y.into_iter().map(|y| 0.0 - y).collect();
    (excess.value() <= allowed).then_some(Derivatives { rows, columns })
}

/// Multipliers become 0 if they press on no limit, or are rounding and their row does not bind.
fn drop_rounding(program: &Program, activities: &[f64], scale: f64, y: &mut [f64]) {
    let size = |row: usize| largest_magnitude(program.row(row).1);
    for (row, y) in y.iter_mut().enumerate() {
        let limit = if *y > 0.0 { program.row_upper[row] } else { program.row_lower[row] };
        let binds =
            (activities[row] - limit).abs() <= tolerance::FEASIBILITY * limit.abs().max(1.0);
        if limit.is_infinite() || (!binds && y.abs() * size(row) <= RELATIVE_ROUNDING * scale) {
            *y = 0.0;
        }
    }
}

fn activity(program: &Program, row: usize, x: &[f64]) -> f64 {
    let (columns, values) = program.row(row);
    let mut sum = Sum::new(0.0);
    columns.iter().zip(values).for_each(|(&j, &a)| sum.add_product(a, x[j]));
    sum.value()
}

/// `q + Px + A'y` of a column, and the largest of its terms.
fn reduced_cost(program: &Program, column: usize, x: &[f64], y: &[f64]) -> (f64, f64) {
    let mut sum = Sum::new(program.linear[column]);
    let mut size = program.linear[column].abs();
    let parts = [(program.quadratic_column(column), x), (program.column(column), y)];
    for ((index, values), with) in parts {
        for (&k, &a) in index.iter().zip(values) {
            sum.add_product(a, with[k]);
            size = size.max((a * with[k]).abs());
        }
    }
    (sum.value(), size)
}
