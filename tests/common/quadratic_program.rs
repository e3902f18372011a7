//! Convex quadratic programs in up to four variables, solved by trying every set of active
//! constraints.
//!
//! For each linearly independent set the conditions of Karush, Kuhn and Tucker are one linear
//! system, solved by Gaussian elimination. By convexity the first solution that is feasible and
//! has multipliers of the right sign is optimal. A set on which such a solution exists is always
//! among the tried ones: take an optimum on a minimal face of the optimal set, a basis of the rows
//! active there that contains the support of a multiplier; every solution of its system lies on
//! that face. A convex quadratic that is bounded below over a polyhedron attains its minimum, so
//! no solution means infeasible or unbounded, and which of the two is settled by minimising the
//! distance to the origin, which is never unbounded.
//!
//! The data are small whole numbers and halves, so quantities that are not zero are far from it
//! and [`ZERO`] separates the two.

/// Magnitude below which a computed quantity counts as zero; rows are normalised.
const ZERO: f64 = 1e-8;

/// `min 1/2 x'Px + q'x` subject to `a'x = b` and `a'x <= b`.
#[derive(Debug, Clone, Default)]
pub(crate) struct QuadraticProgram {
    pub(crate) curvature: Vec<Vec<f64>>,
    pub(crate) linear: Vec<f64>,
    pub(crate) equalities: Vec<(Vec<f64>, f64)>,
    pub(crate) inequalities: Vec<(Vec<f64>, f64)>,
}

/// The exact answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Minimum {
    Infeasible,
    Unbounded,
    Attained { value: f64, point: Vec<f64> },
}

impl QuadraticProgram {
    /// Without constraints and objective, in `n` variables.
    pub(crate) fn new(n: usize) -> Self {
        QuadraticProgram {
            curvature: vec![vec![0.0; n]; n],
            linear: vec![0.0; n],
            ..QuadraticProgram::default()
        }
    }

    /// Adds `lower <= a'x <= upper`.
    pub(crate) fn add_range(&mut self, coefficients: &[f64], lower: f64, upper: f64) {
        if lower == upper {
            self.equalities.push((coefficients.to_vec(), upper));
            return;
        }
        if upper.is_finite() {
            self.inequalities.push((coefficients.to_vec(), upper));
        }
        if lower.is_finite() {
            self.inequalities.push((coefficients.iter().map(|a| -a).collect(), -lower));
        }
    }

    /// Value of the objective.
    pub(crate) fn value(&self, x: &[f64]) -> f64 {
        let curved = |i: usize| 0.5 * x[i] * dot(&self.curvature[i], x);
        dot(&self.linear, x) + (0..x.len()).map(curved).sum::<f64>()
    }

    /// The exact minimum.
    pub(crate) fn solve(&self) -> Minimum {
        let Some(clean) = self.normalised() else { return Minimum::Infeasible };
        if let Some(point) = clean.stationary_point() {
            return Minimum::Attained { value: self.value(&point), point };
        }
        let mut nearest = clean.clone();
        nearest.linear.fill(0.0);
        for (i, row) in nearest.curvature.iter_mut().enumerate() {
            row.fill(0.0);
            row[i] = 1.0;
        }
        if nearest.stationary_point().is_none() {
            return Minimum::Infeasible;
        }
        assert!(clean.falls_forever(), "no optimum, yet no direction of descent either: {self:?}");
        Minimum::Unbounded
    }

    /// Rows scaled to a largest coefficient of 1, equalities independent, duplicates dropped;
    /// nothing when rows without variables or equalities contradict each other.
    fn normalised(&self) -> Option<Self> {
        let mut clean = self.clone();
        clean.equalities.clear();
        clean.inequalities.clear();
        for (a, b) in &self.equalities {
            let size = largest(a);
            if size == 0.0 {
                if b.abs() > ZERO {
                    return None;
                }
                continue;
            }
            clean.equalities.push((a.iter().map(|v| v / size).collect(), b / size));
        }
        for (a, b) in &self.inequalities {
            let size = largest(a);
            if size == 0.0 {
                if *b < -ZERO {
                    return None;
                }
                continue;
            }
            let row = (a.iter().map(|v| v / size).collect::<Vec<f64>>(), b / size);
            let same = clean.inequalities.iter_mut().find(|(kept, _)| *kept == row.0);
            match same {
                Some((_, limit)) => *limit = limit.min(row.1),
                None => clean.inequalities.push(row),
            }
        }
        let mut independent: Vec<(Vec<f64>, f64)> = Vec::new();
        for (a, b) in clean.equalities {
            let mut system: Vec<Vec<f64>> =
                independent.iter().map(|(a, b)| with_right(a, *b)).collect();
            let rank = eliminate(&mut system.clone(), a.len()).len();
            system.push(with_right(&a, b));
            if eliminate(&mut system, a.len()).len() > rank {
                independent.push((a, b));
            } else if system
                .iter()
                .any(|row| largest(&row[..a.len()]) < ZERO && row[a.len()].abs() > ZERO)
            {
                return None;
            }
        }
        clean.equalities = independent;
        Some(clean)
    }

    /// A feasible point with multipliers, by trying the sets of active inequalities, small ones
    /// first.
    fn stationary_point(&self) -> Option<Vec<f64>> {
        let free = self.linear.len().checked_sub(self.equalities.len())?;
        (0..=free).find_map(|size| self.try_sets(&mut Vec::new(), 0, size))
    }

    fn try_sets(&self, active: &mut Vec<usize>, from: usize, size: usize) -> Option<Vec<f64>> {
        if active.len() == size {
            return self.try_active(active);
        }
        for next in from..self.inequalities.len() {
            active.push(next);
            let found = self.try_sets(active, next + 1, size);
            active.pop();
            if found.is_some() {
                return found;
            }
        }
        None
    }

    fn try_active(&self, active: &[usize]) -> Option<Vec<f64>> {
        let n = self.linear.len();
        let rows: Vec<&(Vec<f64>, f64)> =
            self.equalities.iter().chain(active.iter().map(|&i| &self.inequalities[i])).collect();
        if rows.len() > self.equalities.len() {
            let mut gradients: Vec<Vec<f64>> =
                rows.iter().map(|(a, _)| with_right(a, 0.0)).collect();
            if eliminate(&mut gradients, n).len() < rows.len() {
                return None;
            }
        }
        // P x + A'y = -q, A x = b.
        let width = n + rows.len();
        let mut system = Vec::with_capacity(width);
        for i in 0..n {
            let mut line = self.curvature[i].clone();
            line.extend(rows.iter().map(|(a, _)| a[i]));
            line.push(-self.linear[i]);
            system.push(line);
        }
        for (a, b) in &rows {
            let mut line = a.clone();
            line.resize(width, 0.0);
            line.push(*b);
            system.push(line);
        }
        let solution = solve(system, width)?;
        let (x, y) = solution.split_at(n);
        let pressing = y[self.equalities.len()..].iter().all(|&y| y >= -ZERO);
        let inside =
            self.inequalities.iter().all(|(a, b)| dot(a, x) <= b + ZERO * b.abs().max(1.0));
        (pressing && inside).then(|| x.to_vec())
    }

    /// Whether some direction keeps feasibility and curvature and lowers the objective: a linear
    /// program over a box of directions.
    fn falls_forever(&self) -> bool {
        let n = self.linear.len();
        let mut directions = QuadraticProgram::new(n);
        directions.linear.clone_from(&self.linear);
        directions.equalities = self.equalities.iter().map(|(a, _)| (a.clone(), 0.0)).collect();
        directions.equalities.extend(self.curvature.iter().map(|row| (row.clone(), 0.0)));
        directions.inequalities = self.inequalities.iter().map(|(a, _)| (a.clone(), 0.0)).collect();
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            directions.add_range(&unit, -1.0, 1.0);
        }
        let clean = directions.normalised().expect("the zero direction is feasible");
        let steepest = clean.stationary_point().expect("a box has an optimum");
        dot(&self.linear, &steepest) < -ZERO
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn largest(a: &[f64]) -> f64 {
    a.iter().fold(0.0, |m, v| m.max(v.abs()))
}

fn with_right(a: &[f64], right: f64) -> Vec<f64> {
    let mut row = a.to_vec();
    row.push(right);
    row
}

/// Reduces `[A | b]` to reduced row echelon form by complete pivoting over the first `width`
/// columns. Pivot rows come first; returns their columns, as many as the rank of `A`.
fn eliminate(system: &mut [Vec<f64>], width: usize) -> Vec<usize> {
    let mut pivots = Vec::new();
    while pivots.len() < system.len() {
        let rank = pivots.len();
        let (mut at, mut column, mut size) = (0, 0, ZERO);
        for (i, row) in system.iter().enumerate().skip(rank) {
            for (j, value) in row[..width].iter().enumerate() {
                if value.abs() > size {
                    (at, column, size) = (i, j, value.abs());
                }
            }
        }
        if size <= ZERO {
            break;
        }
        system.swap(rank, at);
        let pivot = system[rank][column];
        system[rank].iter_mut().for_each(|v| *v /= pivot);
        let pivot_row = system[rank].clone();
        for (i, row) in system.iter_mut().enumerate() {
            let factor = row[column];
            if i != rank && factor != 0.0 {
                row.iter_mut().zip(&pivot_row).for_each(|(v, p)| *v -= factor * p);
                row[column] = 0.0;
            }
        }
        pivots.push(column);
    }
    pivots
}

/// One solution of `A z = b`, free variables at 0; nothing when there is none.
fn solve(mut system: Vec<Vec<f64>>, width: usize) -> Option<Vec<f64>> {
    let scale = system.iter().map(|row| row[width].abs()).fold(1.0, f64::max);
    let pivots = eliminate(&mut system, width);
    if system[pivots.len()..].iter().any(|row| row[width].abs() > ZERO * scale) {
        return None;
    }
    let mut solution = vec![0.0; width];
    for (row, pivot) in system.iter().zip(pivots) {
        solution[pivot] = row[width];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `min (-x1 + x5 + 2)^2 + (-x0 + x4 + x5 - 1)^2` over `x0 = -2`, and x1, x4, x5 in boxes. Free
    /// columns of the eliminated system have entries of 1, which once passed for its pivots.
    #[test]
    fn a_ridge_in_a_box() {
        let mut program = QuadraticProgram::new(4);
        for (a, constant) in [([0.0, -1.0, 0.0, 1.0], 2.0), ([-1.0, 0.0, 1.0, 1.0], -1.0)] {
            for i in 0..4 {
                program.linear[i] += 2.0 * constant * a[i];
                (0..4).for_each(|j| program.curvature[i][j] += 2.0 * a[i] * a[j]);
            }
        }
        let boxes = [(-2.0, -2.0), (0.0, 1.0), (-1.0, 0.0), (-1.0, 0.0)];
        for (j, (lower, upper)) in boxes.into_iter().enumerate() {
            let mut unit = vec![0.0; 4];
            unit[j] = 1.0;
            program.add_range(&unit, lower, upper);
        }
        let Minimum::Attained { value, point } = program.solve() else { panic!("attained") };
        assert_eq!((value, point), (-5.0, vec![-2.0, 1.0, 0.0, -1.0]));
    }

    #[test]
    fn known_answers() {
        // min (x - 3)^2 over x <= 1.
        let mut program = QuadraticProgram::new(1);
        program.curvature[0][0] = 2.0;
        program.linear[0] = -6.0;
        program.add_range(&[1.0], f64::NEG_INFINITY, 1.0);
        assert_eq!(program.solve(), Minimum::Attained { value: -5.0, point: vec![1.0] });
        // Two free variables, a ridge: (x + y)^2 - 2 (x + y) is smallest on x + y = 1.
        let mut program = QuadraticProgram::new(2);
        program.curvature = vec![vec![2.0, 2.0], vec![2.0, 2.0]];
        program.linear = vec![-2.0, -2.0];
        let Minimum::Attained { value, .. } = program.solve() else { panic!("attained") };
        assert_eq!(value, -1.0);
        program.linear = vec![-2.0, -1.0];
        assert_eq!(program.solve(), Minimum::Unbounded);
        program.equalities = vec![(vec![1.0, 2.0], 1.0), (vec![2.0, 4.0], 3.0)];
        assert_eq!(program.solve(), Minimum::Infeasible);
        // No variable at all.
        let mut program = QuadraticProgram::new(0);
        assert_eq!(program.solve(), Minimum::Attained { value: 0.0, point: vec![] });
        program.add_range(&[], 1.0, 2.0);
        assert_eq!(program.solve(), Minimum::Infeasible);
    }
}
