//! Linear inequalities: by how little can they all be missed?
//!
//! The answer is enclosed from both sides by arithmetic that does not trust the simplex method
//! that found it: from above by the violation at a point, from below by a nonnegative combination
//! of the rows.

/// The row `terms · a <= limit`.
#[derive(Debug, Clone)]
pub(crate) struct Row {
    pub(crate) terms: Vec<f64>,
    pub(crate) limit: f64,
}

impl Row {
    /// How far a point is beyond the limit; negative inside.
    pub(crate) fn excess(&self, point: &[f64]) -> f64 {
        self.terms.iter().zip(point).map(|(g, a)| g * a).sum::<f64>() - self.limit
    }

    /// The smallest excess of any point whose coordinates miss their limits by at most `margin`.
    fn least_excess(&self, limits: &[(f64, f64)], margin: f64) -> f64 {
        let least = |(g, &(lower, upper)): (&f64, &(f64, f64))| {
            g * if *g > 0.0 { lower - margin } else { upper + margin }
        };
        self.terms.iter().zip(limits).map(least).sum::<f64>() - self.limit
    }

    /// Whether some point whose coordinates miss their limits by at most `margin` is beyond the
    /// limit at all.
    fn matters(&self, limits: &[(f64, f64)], margin: f64) -> bool {
        let mirrored = Row { terms: self.terms.iter().map(|g| -g).collect(), limit: -self.limit };
        mirrored.least_excess(limits, margin) < 0.0
    }
}

/// Whether one of the rows alone is missed by at least this much.
pub(crate) fn one_is_missed(rows: &[Row], limits: &[(f64, f64)], by: f64) -> bool {
    rows.iter().any(|row| row.least_excess(limits, by) >= by)
}

/// An enclosure of the least violation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Violation {
    /// No point violates less.
    pub(crate) lower: f64,
    /// Some point violates no more.
    pub(crate) upper: f64,
}

/// How far beyond its limits a coordinate is searched. Points farther away violate their limits by
/// more than this.
const REACH: f64 = 1.0;

/// Entries of the tableau below this count as zero: rounding leaves about 1e-14 of numbers near 10.
const ZERO: f64 = 1e-11;

/// Pivots after which entering columns are chosen by Bland's rule, which cannot cycle.
const PATIENCE: usize = 400;

/// Pivots after which the method is broken.
const MOST_PIVOTS: usize = 20_000;

/// The smallest `t >= 0` for which some point `a` has `terms · a <= limit + t` in every row and
/// `lower - t <= a <= upper + t` in every coordinate.
///
/// # Arguments
///
/// * `rows`: all with as many terms as there are `limits`.
/// * `limits`: lower and upper limit of each coordinate.
pub(crate) fn least_violation(rows: &[Row], limits: &[(f64, f64)]) -> Violation {
    let mut rows = rows.to_vec();
    rows.retain(|row| row.matters(limits, REACH));
    for (i, &(lower, upper)) in limits.iter().enumerate() {
        for (sign, limit) in [(-1.0, -lower), (1.0, upper)] {
            let mut terms = vec![0.0; limits.len()];
            terms[i] = sign;
            rows.push(Row { terms, limit });
        }
    }
    let (point, weights) = Tableau::new(&rows, limits).solve();
    let upper = rows.iter().map(|row| row.excess(&point)).fold(0.0, f64::max);
    let lower = lower_bound(&rows, limits, &weights);
    let closed = lower >= REACH || upper - lower <= 1e-9;
    assert!(closed, "the simplex method left a gap: {lower} {upper}");
    Violation { lower, upper }
}

/// What a combination of the rows proves: with weights `λ >= 0`, `Σ λ (terms · a - limit)` is at
/// most `t Σ λ`, and its least value over all `a` near the limits is a sum over the coordinates.
fn lower_bound(rows: &[Row], limits: &[(f64, f64)], weights: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    if total <= 0.0 {
        return 0.0;
    }
    let mut least = 0.0;
    for (i, &(lower, upper)) in limits.iter().enumerate() {
        let slope: f64 = rows.iter().zip(weights).map(|(row, w)| w * row.terms[i]).sum();
        least += slope * if slope > 0.0 { lower - REACH } else { upper + REACH };
    }
    let offset: f64 = rows.iter().zip(weights).map(|(row, w)| w * row.limit).sum();
    // Farther away than `REACH` the violation is larger than that.
    ((least - offset) / total).clamp(0.0, REACH)
}

/// The dictionary of the simplex method: each basic variable as a constant and a combination of
/// the nonbasic ones. Variables are numbered: the coordinates `y = a - (lower - REACH) >= 0`, then
/// t, then the slack of each row.
struct Tableau {
    /// Constant first.
    rows: Vec<Vec<f64>>,
    basic: Vec<usize>,
    nonbasic: Vec<usize>,
    origin: Vec<f64>,
}

impl Tableau {
    fn new(rows: &[Row], limits: &[(f64, f64)]) -> Self {
        let n = limits.len();
        let origin: Vec<f64> = limits.iter().map(|&(lower, _)| lower - REACH).collect();
        // Slack = limit - terms · origin - terms · y + t.
        let expand = |row: &Row| {
            let mut line = vec![-row.excess(&origin)];
            line.extend(row.terms.iter().map(|g| -g));
            line.push(1.0);
            line
        };
        Tableau {
            rows: rows.iter().map(expand).collect(),
            basic: (n + 1..=n + rows.len()).collect(),
            nonbasic: (0..=n).collect(),
            origin,
        }
    }

    /// The number of t.
    fn relaxation(&self) -> usize {
        self.origin.len()
    }

    /// A point of least violation and the weights of the rows that prove it.
    fn solve(mut self) -> (Vec<f64>, Vec<f64>) {
        let worst = (0..self.rows.len())
            .min_by(|&i, &j| self.rows[i][0].total_cmp(&self.rows[j][0]))
            .expect("rows");
        if self.rows[worst][0] < 0.0 {
            // From here on every basic variable is nonnegative.
            self.pivot(worst, self.relaxation());
            self.minimize();
        }
        let mut point = self.origin.clone();
        let mut weights = vec![0.0; self.rows.len()];
        for (row, &variable) in self.rows.iter().zip(&self.basic) {
            if variable < point.len() {
                point[variable] += row[0];
            } else if variable == self.relaxation() {
                for (&slope, &other) in row[1..].iter().zip(&self.nonbasic) {
                    if other > self.relaxation() {
                        weights[other - self.relaxation() - 1] = slope.max(0.0);
                    }
                }
            }
        }
        (point, weights)
    }

    /// Lowers t as far as it goes.
    fn minimize(&mut self) {
        for pivots in 0.. {
            assert!(pivots < MOST_PIVOTS, "the simplex method does not end");
            let relaxation = self.relaxation();
            let Some(goal) = self.basic.iter().position(|&b| b == relaxation) else { return };
            let slopes = || self.rows[goal][1..].iter().enumerate().filter(|(_, s)| **s < -ZERO);
            let entering = if pivots < PATIENCE {
                slopes().min_by(|a, b| a.1.total_cmp(b.1))
            } else {
                slopes().min_by_key(|&(column, _)| self.nonbasic[column])
            };
            let Some((column, _)) = entering else { return };
            let leaving = self.leaving(column, pivots >= PATIENCE);
            self.pivot(leaving, column);
        }
    }

    /// The row that limits how far a column may grow; t is always one of them.
    fn leaving(&self, column: usize, bland: bool) -> usize {
        let relaxation = self.relaxation();
        let mut best: Option<(usize, f64)> = None;
        for (i, row) in self.rows.iter().enumerate() {
            let slope = row[column + 1];
            if slope >= -ZERO {
                continue;
            }
            let ratio = row[0].max(0.0) / -slope;
            let better = match best {
                None => true,
                Some((other, least)) if ratio == least => {
                    let (basic, rival) = (self.basic[i], self.basic[other]);
                    match bland {
                        _ if basic == relaxation || rival == relaxation => basic == relaxation,
                        true => basic < rival,
                        false => slope < self.rows[other][column + 1],
                    }
                }
                Some((_, least)) => ratio < least,
            };
            if better {
                best = Some((i, ratio));
            }
        }
        best.expect("t bounds every direction that lowers it").0
    }

    /// Exchanges the basic variable of a row with the nonbasic one of a column.
    fn pivot(&mut self, row: usize, column: usize) {
        let mut line = std::mem::take(&mut self.rows[row]);
        let slope = line[column + 1];
        line[column + 1] = -1.0;
        line.iter_mut().for_each(|entry| *entry /= -slope);
        for other in self.rows.iter_mut().filter(|other| !other.is_empty()) {
            let factor = std::mem::take(&mut other[column + 1]);
            if factor != 0.0 {
                other.iter_mut().zip(&line).for_each(|(entry, new)| *entry += factor * new);
            }
        }
        self.rows[row] = line;
        std::mem::swap(&mut self.basic[row], &mut self.nonbasic[column]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(terms: &[f64], limit: f64) -> Row {
        Row { terms: terms.to_vec(), limit }
    }

    fn value(rows: &[Row], limits: &[(f64, f64)]) -> f64 {
        let violation = least_violation(rows, limits);
        assert!(violation.upper - violation.lower <= 1e-12, "{violation:?}");
        violation.upper
    }

    #[test]
    fn violations_known_by_hand() {
        let box_ = [(-1.0, 1.0), (-1.0, 1.0)];
        assert_eq!(value(&[row(&[1.0, 1.0], 2.0)], &box_), 0.0);
        assert_eq!(value(&[row(&[-1.0, -1.0], -2.0)], &box_), 0.0); // the corner
        // x + y >= 2.3: each limit gives way by t, the row too, 2 + 2t + t = 2.3.
        assert!((value(&[row(&[-1.0, -1.0], -2.3)], &box_) - 0.1).abs() < 1e-12);
        // x - y <= -0.5 and y - x <= 0.1 miss by 0.4 in all.
        let apart = [row(&[1.0, -1.0], -0.5), row(&[-1.0, 1.0], 0.1)];
        assert!((value(&apart, &box_) - 0.2).abs() < 1e-12);
        // A pinned coordinate: 3 x <= 1 at x = 0.5 + 1e-6 - t, so 4 t = 0.5 + 3e-6.
        let pinned = [(0.5 + 1e-6, 0.5 + 1e-6), (0.0, 0.0)];
        assert!((value(&[row(&[3.0, 0.0], 1.0)], &pinned) - (0.5 + 3e-6) / 4.0).abs() < 1e-12);
    }

    #[test]
    fn single_rows() {
        let (limits, row) = ([(-1.0, 1.0), (0.0, 2.0)], row(&[1.0, -2.0], -5.5));
        assert!(row.matters(&limits, 0.0) && !row.matters(&[(-9.0, -6.0), (0.0, 2.0)], 0.1));
        // -5 at best, so it is missed by 0.5, or by 0.125 when all limits give way by that.
        assert_eq!(row.least_excess(&limits, 0.0), 0.5);
        assert!(one_is_missed(std::slice::from_ref(&row), &limits, 0.125));
        assert!(!one_is_missed(&[row], &limits, 0.126));
    }

    #[test]
    fn far_away_is_only_a_bound() {
        let violation = least_violation(&[row(&[1.0], -50.0)], &[(0.0, 1.0)]);
        assert!(violation.lower >= REACH);
    }
}
