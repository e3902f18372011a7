//! The exact answer to a small program: every assignment of the integers is tried, and what is
//! left of the program is solved by [`quadratic_program`](super::quadratic_program).

use carom::prelude::VariableKind;

use super::case::{Case, Line};
use super::quadratic_program::{Minimum, QuadraticProgram, dot};

/// The optimum of a case, as a cost to minimise.
pub(crate) fn optimum(case: &Case) -> Minimum {
    relaxed_optimum(case, 0.0)
}

/// The optimum when every row, implication and bound of a continuous variable may be missed by
/// `tolerance` in the model's (scaled) unit. With rows scaled down, a tolerance in the row's unit
/// is a large distance in the variables' units, and the answer within the tolerance may differ
/// visibly from the exact one; this is how far it may.
pub(crate) fn relaxed_optimum(case: &Case, tolerance: f64) -> Minimum {
    let mut best = Minimum::Infeasible;
    for_each_assignment(case, tolerance, &mut |_, minimum| match (minimum, &best) {
        (_, Minimum::Unbounded) | (Minimum::Infeasible, _) => {}
        (Minimum::Attained { value, .. }, Minimum::Attained { value: old, .. })
            if value >= *old => {}
        (better, _) => best = better,
    });
    best
}

/// Every assignment of the integers that leaves a point, with the best cost that it allows.
pub(crate) fn all_optima(case: &Case) -> Vec<(Vec<i64>, f64)> {
    let mut all = Vec::new();
    for_each_assignment(case, 0.0, &mut |integers, minimum| {
        if let Minimum::Attained { value, .. } = minimum {
            all.push((integers.iter().map(|&v| v as i64).collect(), value));
        }
    });
    all.sort_by(|a, b| a.1.total_cmp(&b.1));
    all
}

/// Tries every assignment of the integers: their values, and the optimum of the rest.
fn for_each_assignment(case: &Case, tolerance: f64, visit: &mut dyn FnMut(&[f64], Minimum)) {
    let integers: Vec<usize> = (0..case.columns.len()).filter(|&j| is_integral(case, j)).collect();
    let mut x: Vec<f64> = case.columns.iter().map(|c| c.lower.ceil()).collect();
    if integers.iter().any(|&j| x[j] > case.columns[j].upper) {
        return;
    }
    loop {
        let values: Vec<f64> = integers.iter().map(|&j| x[j]).collect();
        visit(&values, minimum_at(case, &x, tolerance));
        // The next assignment: an odometer.
        let Some(&wheel) = integers.iter().find(|&&j| x[j] + 1.0 <= case.columns[j].upper) else {
            return;
        };
        for &j in integers.iter().take_while(|&&j| j != wheel) {
            x[j] = case.columns[j].lower.ceil();
        }
        x[wheel] += 1.0;
    }
}

fn is_integral(case: &Case, j: usize) -> bool {
    case.columns[j].kind != VariableKind::Continuous
}

/// The optimum for the integers of `x`; its continuous entries are ignored.
fn minimum_at(case: &Case, x: &[f64], tolerance: f64) -> Minimum {
    let continuous: Vec<usize> = (0..x.len()).filter(|&j| !is_integral(case, j)).collect();
    let mut fixed = x.to_vec();
    continuous.iter().for_each(|&j| fixed[j] = 0.0);
    let part = |a: &[f64]| -> Vec<f64> { continuous.iter().map(|&j| a[j]).collect() };

    let mut program = QuadraticProgram::new(continuous.len());
    let holds = |line: &&Line| may_hold(case, line, &continuous, &fixed, tolerance);
    let switched = case.switches.iter().filter(|s| (fixed[s.binary] == 1.0) == s.on);
    let lines: Vec<&Line> = case.lines.iter().chain(switched.map(|s| &s.line)).collect();
    if !lines.iter().all(holds) {
        return Minimum::Infeasible;
    }
    for line in lines {
        let (constant, slack) = (dot(&line.coefficients, &fixed), tolerance / line.scale);
        let (lower, upper) = (line.lower - slack, line.upper + slack);
        program.add_range(&part(&line.coefficients), lower - constant, upper - constant);
    }
    for (k, &j) in continuous.iter().enumerate() {
        let mut unit = vec![0.0; continuous.len()];
        unit[k] = 1.0;
        let column = case.columns[j];
        program.add_range(&unit, column.lower - tolerance, column.upper + tolerance);
    }
    program.linear = part(&case.linear);
    for square in &case.squares {
        let (a, b) =
            (part(&square.coefficients), dot(&square.coefficients, &fixed) + square.constant);
        for i in 0..a.len() {
            program.linear[i] += 2.0 * square.weight * a[i] * b;
            for j in 0..a.len() {
                program.curvature[i][j] += 2.0 * square.weight * a[i] * a[j];
            }
        }
    }
    match program.solve() {
        Minimum::Attained { point, .. } => {
            continuous.iter().zip(point).for_each(|(&j, v)| fixed[j] = v);
            Minimum::Attained { value: case.cost(&fixed), point: fixed }
        }
        other => other,
    }
}

/// Whether a row can hold within the bounds of the continuous columns: spares the exact method
/// the plainly infeasible assignments.
fn may_hold(case: &Case, line: &Line, continuous: &[usize], fixed: &[f64], tolerance: f64) -> bool {
    let slack = 1e-8 + tolerance / line.scale;
    let (mut least, mut most) = (dot(&line.coefficients, fixed), dot(&line.coefficients, fixed));
    for &j in continuous.iter().filter(|&&j| line.coefficients[j] != 0.0) {
        let a = line.coefficients[j];
        let (p, q) =
            (a * (case.columns[j].lower - tolerance), a * (case.columns[j].upper + tolerance));
        least += p.min(q);
        most += p.max(q);
    }
    least <= line.upper + slack && most >= line.lower - slack
}
