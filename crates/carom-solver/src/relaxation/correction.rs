//! Corrections of a pair `(x̂, y)` that make the gradient vanish on given columns.
//!
//! The least change of `x̂` on columns with curvature and of the multipliers of active rows is a
//! least-squares problem. Its dense normal matrix is factorised once and used for every round.

use faer::Mat;
use faer::linalg::solvers::{Llt, Solve};

use super::bound::{Gradient, PrimalDualPair, is_equality, largest};

/// The largest number of columns that are corrected at once.
const MAX_CORRECTED_COLUMNS: usize = 400;

/// The smallest diagonal entry of a factor of scaled curvature that is used alone: the square root
/// of the smallest curvature.
const MIN_CURVATURE_PIVOT: f64 = 1e-4;

/// A quantity that can be moved to change the gradient.
#[derive(Debug, Clone, Copy)]
enum Lever {
    /// An entry of `x̂`.
    Point(usize),
    /// An entry of `y`.
    Multiplier(usize),
}

/// A lever, its weight, and the positions of the gradient that it moves.
type Weighted = (Lever, f64, Vec<(usize, f64)>);

/// A factorised correction of some columns.
pub(super) struct Correction {
    columns: Vec<usize>,
    /// The scale of each entry of the gradient.
    units: Vec<f64>,
    /// Empty if the columns' own curvature is factorised.
    levers: Vec<Weighted>,
    factor: Llt<f64>,
}

impl Correction {
    /// The correction of the given columns; `None` if there are too many or if nothing moves their
    /// gradient.
    pub(super) fn new(pair: &PrimalDualPair<'_>, columns: &[usize]) -> Option<Self> {
        let k = columns.len();
        if k == 0 || k > MAX_CORRECTED_COLUMNS {
            return None;
        }
        if let Some(correction) = Correction::by_curvature(pair, columns) {
            return Some(correction);
        }
        let levers = levers(pair, columns);
        let mut effects = Mat::<f64>::zeros(k, levers.len());
        for (l, (_, weight, effect)) in levers.iter().enumerate() {
            effect.iter().for_each(|&(r, a)| effects[(r, l)] += weight * a);
        }
        let mut normal = &effects * effects.transpose();
        // Each entry of the gradient is scaled, because curvatures may differ by orders of
        // magnitude.
        let unit = |r: usize| 1.0 / normal[(r, r)].max(f64::MIN_POSITIVE).sqrt();
        let units: Vec<f64> = (0..k).map(unit).collect();
        for c in 0..k {
            (0..k).for_each(|r| normal[(r, c)] *= units[r] * units[c]);
            normal[(c, c)] += 1e-13;
        }
        let factor = normal.llt(faer::Side::Lower).ok()?;
        Some(Correction { columns: columns.to_vec(), units, levers, factor })
    }

    /// The correction by the columns' own curvature; `None` if that is flat somewhere.
    fn by_curvature(pair: &PrimalDualPair<'_>, columns: &[usize]) -> Option<Self> {
        let k = columns.len();
        let mut position = vec![usize::MAX; pair.x.len()];
        columns.iter().enumerate().for_each(|(r, &j)| position[j] = r);
        let mut curvature = Mat::<f64>::zeros(k, k);
        for &j in columns.iter().filter(|_| pair.objective) {
            let (rows, entries) = pair.program.quadratic.vector(j);
            for (&i, &p) in rows.iter().zip(entries).filter(|(i, _)| position[**i] < k) {
                curvature[(position[i], position[j])] += p;
                if i != j {
                    curvature[(position[j], position[i])] += p;
                }
            }
        }
        if (0..k).any(|r| curvature[(r, r)] <= 0.0) {
            return None;
        }
        let units: Vec<f64> = (0..k).map(|r| 1.0 / curvature[(r, r)].sqrt()).collect();
        for c in 0..k {
            (0..k).for_each(|r| curvature[(r, c)] *= units[r] * units[c]);
        }
        let factor = curvature.llt(faer::Side::Lower).ok()?;
        let steep = (0..k).all(|r| factor.L()[(r, r)] >= MIN_CURVATURE_PIVOT);
        let columns = columns.to_vec();
        steep.then(|| Correction { columns, units, levers: Vec::new(), factor })
    }

    /// Moves the pair; `false` if the step is not finite.
    pub(super) fn apply(&self, pair: &mut PrimalDualPair<'_>, gradient: &Gradient) -> bool {
        let entry = |r: usize, _| -gradient.value[self.columns[r]].high * self.units[r];
        let multiplier = self.factor.solve(&Mat::from_fn(self.columns.len(), 1, entry));
        if self.levers.is_empty() {
            for (r, &j) in self.columns.iter().enumerate() {
                let step = self.units[r] * multiplier[(r, 0)];
                if !step.is_finite() {
                    return false;
                }
                pair.x[j] = pair.x[j].plus(step);
            }
        }
        for (lever, weight, effect) in &self.levers {
            let along: f64 =
                effect.iter().map(|&(r, a)| a * self.units[r] * multiplier[(r, 0)]).sum();
            let step = weight * weight * along;
            if !step.is_finite() {
                return false;
            }
            match *lever {
                Lever::Point(j) => pair.x[j] = pair.x[j].plus(step),
                Lever::Multiplier(i) => {
                    let moved = pair.y[i].plus(step);
                    let keeps_sign = moved.high * pair.y[i].high >= 0.0;
                    let allowed = keeps_sign || is_equality(pair.program, i);
                    pair.y[i] = if allowed { moved } else { Default::default() };
                }
            }
        }
        true
    }
}

/// Each change of one entry of `x̂` or `y` moves the gradient along one of these.
fn levers(pair: &PrimalDualPair<'_>, columns: &[usize]) -> Vec<Weighted> {
    let (program, k) = (pair.program, columns.len());
    let mut position = vec![usize::MAX; pair.x.len()];
    columns.iter().enumerate().for_each(|(r, &j)| position[j] = r);
    let within = |j: &usize| position[*j] < k;
    let mut levers = Vec::new();
    if pair.objective {
        let mut curvature = vec![Vec::new(); k];
        for &j in columns {
            let (rows, entries) = program.quadratic.vector(j);
            for (&i, &p) in rows.iter().zip(entries).filter(|(i, _)| within(i)) {
                curvature[position[j]].push((position[i], p));
                if i != j {
                    curvature[position[i]].push((position[j], p));
                }
            }
        }
        let levers_of = columns.iter().zip(curvature);
        levers.extend(levers_of.map(|(&j, effect)| (Lever::Point(j), 1.0, effect)));
    }
    for (i, y) in pair.y.iter().enumerate() {
        // Small multipliers of inequalities move little, so that their signs survive. Measured in
        // the unit of the gradient, so that a row's own unit does not matter.
        let unit = largest(program, i);
        let weight =
            if is_equality(program, i) { 1.0 / unit } else { y.high.abs().min(1.0 / unit) };
        let (columns, values) = program.rows.vector(i);
        let entries = columns.iter().zip(values).filter(|(j, _)| within(j));
        let effect = entries.map(|(&j, &a)| (position[j], a)).collect();
        levers.push((Lever::Multiplier(i), weight, effect));
    }
    levers.retain(|(_, weight, effect)| *weight > 0.0 && !effect.is_empty());
    levers
}
