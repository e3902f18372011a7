//! The reduction of a program at a node to a smaller continuous program.
//!
//! Takes a program and the bounds of a node; leaves a continuous program over the free columns.
//!
//! Fixed columns are substituted, rows with one free column become bounds, rows that the bounds
//! imply are dropped, and parallel rows are merged: two opposite inequalities become one equality.
//!
//! Everything dropped is implied (up to rounding) by what is kept, so a dual bound of the reduced
//! program is a dual bound of the node.

use super::coefficients::is_exact;
use super::domain::Domain;
use super::parallel::{Patterns, ratio};
use super::parameters::{CONTRADICTION, FEW_ROUNDINGS, IMPLIED};
use super::projection::{Projection, Projector};
use super::reduced::{Compressed, Reduced};
use super::reduced_cone::ReducedCone;
use crate::activity::implied_ends;
use crate::program::{Cone, ConeRole, Program};
use crate::sum::Sum;
use crate::tolerance;

/// A row over fixed columns is refuted if it is violated by more than this, relative to its largest
/// term that is not exact, and by more than [`CONTRADICTION`], absolute. Presolve leaves at least
/// this many digits; exact terms have all of them.
const ROW_DIGITS: f64 = 1e-10;

/// The room that the fixed entries of a cone leave the others counts as none up to this, relative
/// to their squares: no interior-point method finds an inside there.
const NO_ROOM: f64 = 1e-13;

/// The largest number of passes over the rows: rows over one column fix columns, which makes more
/// such rows.
const MAX_SWEEPS: usize = 3;

/// Reduces a program to a node's domain, leaving integrality aside: a continuous program over the
/// free columns, possibly none. Returns `None` if bounds and rows contradict each other.
pub fn reduce(program: &Program, domain: &Domain) -> Option<Reduced> {
    Reducer::default().reduce(program, domain)
}

/// Reduces one node after the other, in the same memory.
#[derive(Debug, Clone, Default)]
pub(crate) struct Reducer {
    lower: Vec<f64>,
    upper: Vec<f64>,
    fixed: Vec<bool>,
    /// By column, the largest distance of a fixed value from the other values within its narrow
    /// bounds. Rows that the value is substituted in are loosened accordingly.
    slack: Vec<f64>,
    alive: Vec<usize>,
    /// Columns and rows whose sides are closer together than this, absolute, count as fixed; row
    /// sides implied up to this margin count as implied.
    negligible: f64,
    row_lower: Vec<f64>,
    row_upper: Vec<f64>,
    /// By column of the program: its column in the reduced program.
    position: Vec<usize>,
    /// By cone, whether the bounds of its entries say all of it.
    is_settled: Vec<bool>,
    patterns: Patterns,
    projector: Projector,
    /// Programs that are no longer needed, for their memory.
    spare: Vec<Reduced>,
}

struct Contradictory;

/// Replaces the entries of a vector.
fn fill<T>(vector: &mut Vec<T>, values: impl Iterator<Item = T>) {
    vector.clear();
    vector.extend(values);
}

impl Reducer {
    /// As [`reduce`](reduce()).
    pub(crate) fn reduce(&mut self, program: &Program, domain: &Domain) -> Option<Reduced> {
        self.negligible = IMPLIED;
        self.reduce_to(program, domain)
    }

    /// As [`reduce`](Self::reduce), but only rounding is dropped. Interior-point methods may find
    /// no interior then.
    pub(crate) fn reduce_strictly(
        &mut self,
        program: &Program,
        domain: &Domain,
    ) -> Option<Reduced> {
        self.negligible = 0.0;
        self.reduce_to(program, domain)
    }

    fn reduce_to(&mut self, program: &Program, domain: &Domain) -> Option<Reduced> {
        self.start(program, domain).ok()?;
        let mut reduced = self.spare.pop().unwrap_or_default();
        match self.build(program, &mut reduced) {
            Ok(()) => Some(reduced),
            Err(Contradictory) => {
                self.reuse(reduced);
                None
            }
        }
    }

    /// Takes back a program that is no longer needed: the next one is built in its memory.
    pub(crate) fn reuse(&mut self, reduced: Reduced) {
        self.spare.push(reduced);
    }

    /// Takes binaries out of a reduced program, as `project` does.
    pub(crate) fn project(&mut self, reduced: Reduced, integral: &[bool]) -> Projection {
        self.projector.project(reduced, integral, &mut self.spare)
    }

    /// Takes back a projection that is no longer needed.
    pub(crate) fn reuse_projection(&mut self, projection: Projection) {
        let reduced = self.projector.reuse(projection);
        self.reuse(reduced);
    }

    /// Tightens bounds by rows over one column, and drops implied rows.
    fn start(&mut self, program: &Program, domain: &Domain) -> Result<(), Contradictory> {
        let n = program.column_count();
        fill(&mut self.lower, (0..n).map(|j| domain.lower(j)));
        fill(&mut self.upper, (0..n).map(|j| domain.upper(j)));
        fill(&mut self.fixed, (0..n).map(|_| false));
        fill(&mut self.slack, (0..n).map(|_| 0.0));
        fill(&mut self.alive, 0..program.row_count());
        fill(&mut self.row_lower, program.row_lower.iter().copied());
        fill(&mut self.row_upper, program.row_upper.iter().copied());
        for j in 0..n {
            // Fixes columns with narrow bounds and refuses crossed ones.
            self.intersect(program, j, f64::NEG_INFINITY, f64::INFINITY)?;
        }
        for _ in 0..MAX_SWEEPS {
            if !self.sweep(program)? {
                break;
            }
        }
        if self.settle_cones(program)? {
            self.sweep(program)?;
        }
        Ok(())
    }

    /// Bounds the open entries of cones whose fixed entries leave them no room, and notes these
    /// cones with their parts. Returns whether there are any.
    fn settle_cones(&mut self, program: &Program) -> Result<bool, Contradictory> {
        fill(&mut self.is_settled, program.cones.iter().map(|_| false));
        let (mut next, mut found) = (0, false);
        for group in program.cones.chunk_by(|_, other| other.role == ConeRole::Part) {
            let range = next..next + group.len();
            next = range.end;
            let Some(reach) = self.reach_of_rest(&group[0]) else { continue };
            for &j in group[0].tail() {
                if !self.fixed[j] {
                    self.intersect(program, j, -reach, reach)?;
                }
            }
            self.is_settled[range].fill(true);
            found = true;
        }
        Ok(found)
    }

    /// The largest magnitude of the open entries of the tail of a cone whose other entries leave no
    /// room for more: 0, or what their rounding makes of it. `None` if there is room, or no open
    /// entry.
    fn reach_of_rest(&self, cone: &Cone) -> Option<f64> {
        let tail = cone.tail();
        if tail.iter().all(|&j| self.fixed[j]) {
            return None;
        }
        let (mut room, mut size, mut error) = (Sum::default(), 0.0, 0.0);
        let mut add = |sign: f64, i: usize, j: usize| {
            let (a, b) = (self.lower[i], self.lower[j]);
            room.add_product(sign * a, b);
            size += (a * b).abs();
            error += self.slack[i] * b.abs() + self.slack[j] * a.abs();
        };
        let is_zero = |&j: &usize| self.fixed[j] && self.lower[j] == 0.0 && self.slack[j] == 0.0;
        if !cone.head().iter().any(is_zero) {
            let known = |&j: &usize| self.fixed[j] && self.lower[j] > 0.0;
            match cone.head() {
                [first, second] if known(first) && known(second) => add(1.0, *first, *second),
                [head] if known(head) => add(1.0, *head, *head),
                _ => return None,
            }
        }
        tail.iter().filter(|&&j| self.fixed[j]).for_each(|&j| add(-1.0, j, j));
        let room = room.value();
        let most = room.max(0.0) + error;
        // Where the fixed entries miss the cone, other steps judge by how much they may.
        let is_missed = room < -error - FEW_ROUNDINGS * size;
        (most <= NO_ROOM * size && !is_missed).then(|| most.sqrt() * (1.0 + FEW_ROUNDINGS))
    }

    fn fix_if_narrow(&mut self, program: &Program, j: usize) {
        let (lower, upper) = (self.lower[j], self.upper[j]);
        let scale = lower.abs().max(upper.abs()).max(1.0);
        let bounded = scale.is_finite() && !program.integral[j];
        let narrow = bounded && upper - lower <= self.negligible.max(4.0 * f64::EPSILON * scale);
        if lower == upper {
            self.fixed[j] = true;
        } else if narrow {
            self.fix_at_middle(j, lower, upper);
        }
    }

    fn fix_at_middle(&mut self, j: usize, one: f64, other: f64) {
        let middle = 0.5 * (one + other);
        (self.lower[j], self.upper[j]) = (middle, middle);
        self.slack[j] = self.slack[j].max((one - middle).abs().max((other - middle).abs()));
        self.fixed[j] = true;
    }

    /// Drops implied rows and turns singletons into bounds; `true` when a column became fixed.
    fn sweep(&mut self, program: &Program) -> Result<bool, Contradictory> {
        let mut changed = false;
        let mut left = 0;
        for k in 0..self.alive.len() {
            let row = self.alive[k];
            let (columns, coefficients) = program.row(row);
            let (mut least, mut most, mut scale) = (0.0, 0.0, 1.0_f64);
            let (mut free, mut single, mut constant, mut slack) = (0, 0, 0.0, 0.0);
            for (k, (&j, &a)) in columns.iter().zip(coefficients).enumerate() {
                let (p, q) = (a * self.lower[j], a * self.upper[j]);
                let (low, high) = if p < q { (p, q) } else { (q, p) };
                least += low;
                most += high;
                if self.fixed[j] {
                    constant += p;
                    slack += a.abs() * self.slack[j];
                    scale = scale.max(p.abs());
                } else {
                    (free, single) = (free + 1, k);
                }
            }
            // A dropped side may be violated by the margin, so the margin does not grow with a
            // big-M: it only covers rounding of the activity.
            let margin = self.negligible.max(4.0 * f64::EPSILON * scale);
            if most <= self.row_upper[row] + margin {
                self.row_upper[row] = f64::INFINITY;
            }
            if least >= self.row_lower[row] - margin {
                self.row_lower[row] = f64::NEG_INFINITY;
            }
            let (l, u) = (self.row_lower[row], self.row_upper[row]);
            if l.is_infinite() && u.is_infinite() {
                continue;
            }
            match free {
                0 => {
                    let miss = (l - constant).max(constant - u);
                    if miss > CONTRADICTION + slack
                        && is_missed(program, row, [l, u], &self.lower, &self.slack)
                    {
                        return Err(Contradictory);
                    }
                }
                1 => {
                    let (j, a) = (columns[single], coefficients[single]);
                    let slack = slack + 4.0 * f64::EPSILON * scale;
                    let [lower, upper] =
                        implied_ends(a, [l - constant - slack, u - constant + slack]);
                    self.intersect(program, j, lower, upper)?;
                    changed |= self.fixed[j];
                }
                _ => {
                    self.alive[left] = row;
                    left += 1;
                }
            }
        }
        self.alive.truncate(left);
        Ok(changed)
    }

    fn intersect(
        &mut self,
        program: &Program,
        j: usize,
        lower: f64,
        upper: f64,
    ) -> Result<(), Contradictory> {
        let (l, u) = (self.lower[j].max(lower), self.upper[j].min(upper));
        let scale = l.abs().max(u.abs()).max(1.0);
        if l > u && l - u > CONTRADICTION * scale {
            return Err(Contradictory);
        }
        if l > u {
            self.fix_at_middle(j, l, u);
        } else {
            (self.lower[j], self.upper[j]) = (l, u);
            self.fix_if_narrow(program, j);
        }
        Ok(())
    }

    fn build(&mut self, program: &Program, reduced: &mut Reduced) -> Result<(), Contradictory> {
        let n = program.column_count();
        fill(&mut self.position, (0..n).map(|_| usize::MAX));
        fill(&mut reduced.columns, (0..n).filter(|&j| !self.fixed[j]));
        for (k, &j) in reduced.columns.iter().enumerate() {
            self.position[j] = k;
        }
        fill(&mut reduced.linear, reduced.columns.iter().map(|&j| program.linear[j]));
        fill(&mut reduced.lower, reduced.columns.iter().map(|&j| self.lower[j]));
        fill(&mut reduced.upper, reduced.columns.iter().map(|&j| self.upper[j]));
        self.substitute_objective(program, reduced);
        self.collect_rows(program, reduced)?;
        reduced.values.clone_from(&self.lower);
        reduced.slack.clone_from(&self.slack);
        let cones = program.cones.iter().zip(&self.is_settled).filter(|(_, settled)| !**settled);
        let cones = cones.map(|(cone, _)| ReducedCone::new(cone, &self.position, &self.lower));
        fill(&mut reduced.cones, cones);
        reduced.is_cut_off = program.cone_cuts.is_some();
        reduced.wants_vertex = false;
        reduced.spread = program.spread;
        reduced.find_steepness(program);
        Ok(())
    }

    fn substitute_objective(&self, program: &Program, reduced: &mut Reduced) {
        let position = &self.position;
        let mut constant = Sum::new(program.offset);
        // Half of a symmetric matrix, and its diagonal.
        let most = (program.quadratic.compute_nnz() + reduced.linear.len()) / 2;
        reduced.quadratic.clear(reduced.linear.len(), most);
        for j in 0..program.column_count() {
            let (rows, entries) = program.quadratic_column(j);
            if self.fixed[j] {
                constant.add_product(program.linear[j], self.lower[j]);
            }
            if self.slack[j] > 0.0 {
                constant.add(-self.worth_of_slack(program, j));
            }
            for (&i, &p) in rows.iter().zip(entries) {
                match (self.fixed[i], self.fixed[j]) {
                    (true, true) => {
                        constant.add_product_of_three(self.lower[i], self.lower[j], 0.5 * p);
                    }
                    (true, false) => reduced.linear[position[j]] += p * self.lower[i],
                    (false, true) => {}
                    (false, false) if i <= j => {
                        reduced.quadratic.index.push(position[i]);
                        reduced.quadratic.value.push(p);
                    }
                    (false, false) => {}
                }
            }
            if !self.fixed[j] {
                reduced.quadratic.start.push(reduced.quadratic.index.len());
            }
        }
        reduced.offset = constant.value();
    }

    /// The amount by which the other values within the narrow bounds of a fixed column may lower
    /// the objective, without products with columns that have no bounds.
    fn worth_of_slack(&self, program: &Program, j: usize) -> f64 {
        let (rows, entries) = program.quadratic_column(j);
        let reach = |i: usize| self.lower[i].abs().max(self.upper[i].abs());
        let products = rows.iter().zip(entries).map(|(&i, p)| p.abs() * reach(i));
        let curved: f64 = products.filter(|v| v.is_finite()).sum();
        self.slack[j] * (program.linear[j].abs() + curved)
    }

    /// Copies the live rows over the free columns, merging parallel ones.
    fn collect_rows(&mut self, program: &Program, out: &mut Reduced) -> Result<(), Contradictory> {
        let (position, seen) = (&self.position, &mut self.patterns);
        seen.clear(self.alive.len());
        let entries = self.alive.iter().map(|&row| program.row(row).0.len()).sum();
        out.rows.clear(self.alive.len(), entries);
        for limits in [&mut out.row_lower, &mut out.row_upper] {
            limits.clear();
            limits.reserve(self.alive.len());
        }
        out.merged.clear();
        out.origin.clear();
        out.origin.reserve(self.alive.len());
        for &row in &self.alive {
            let (columns, coefficients) = program.row(row);
            let begin = out.rows.index.len();
            let (mut constant, mut slack, mut scale) = (0.0, 0.0, 1.0_f64);
            for (&j, &a) in columns.iter().zip(coefficients) {
                if self.fixed[j] {
                    constant += a * self.lower[j];
                    slack += a.abs() * self.slack[j];
                    scale = scale.max((a * self.lower[j]).abs());
                } else {
                    out.rows.index.push(position[j]);
                    out.rows.value.push(a);
                }
            }
            let (lower, upper) = (self.row_lower[row], self.row_upper[row]);
            // Large terms that cancel leave their rounding.
            let rounding = 4.0 * f64::EPSILON * scale;
            slack += if rounding > self.negligible { rounding } else { 0.0 };
            let mut limits = [lower - constant - slack, upper - constant + slack];
            if out.rows.index.len() == begin {
                // All its columns became fixed in the last sweep, after the row was looked at.
                let is_suspect = limits[0].max(-limits[1]) > CONTRADICTION;
                if is_suspect && is_missed(program, row, [lower, upper], &self.lower, &self.slack) {
                    return Err(Contradictory);
                }
                continue;
            }
            let bucket = seen.bucket(out.rows.index[begin..].iter().copied());
            if let Some((kept, ratio)) = find_parallel(&out.rows, seen.candidates(bucket), begin) {
                // This row is `ratio` times the kept one.
                if ratio < 0.0 {
                    limits.swap(0, 1);
                }
                let (lower, upper) = (limits[0] / ratio, limits[1] / ratio);
                out.row_lower[kept] = out.row_lower[kept].max(lower);
                out.row_upper[kept] = out.row_upper[kept].min(upper);
                out.merged.push((kept, row, ratio));
                out.rows.index.truncate(begin);
                out.rows.value.truncate(begin);
                continue;
            }
            seen.insert(out.row_lower.len(), bucket);
            out.origin.push(row);
            out.row_lower.push(limits[0]);
            out.row_upper.push(limits[1]);
            out.rows.start.push(out.rows.index.len());
        }
        for (lower, upper) in out.row_lower.iter_mut().zip(&mut out.row_upper) {
            let scale = lower.abs().max(upper.abs()).max(1.0);
            if scale.is_infinite() {
                continue;
            }
            if *lower - *upper > CONTRADICTION * scale {
                return Err(Contradictory);
            }
            if *upper - *lower <= self.negligible.max(4.0 * f64::EPSILON * scale) {
                let middle = 0.5 * (*lower + *upper);
                (*lower, *upper) = (middle, middle);
            }
        }
        Ok(())
    }
}

/// Whether a row whose columns are all fixed is violated by more than rounding explains.
///
/// # Arguments
///
/// * `values`, `slack`: by column, the fixed value and its possible error.
fn is_missed(
    program: &Program,
    row: usize,
    [lower, upper]: [f64; 2],
    values: &[f64],
    slack: &[f64],
) -> bool {
    let (columns, coefficients) = program.row(row);
    let (mut sum, mut loosened) = (Sum::default(), 0.0);
    let (mut soft, mut scale) = (1.0_f64, 1.0_f64);
    for (&j, &a) in columns.iter().zip(coefficients) {
        let size = (a * values[j]).abs();
        sum.add_product(a, values[j]);
        loosened += a.abs() * slack[j];
        scale = scale.max(size);
        if !(program.integral[j] && is_exact(a)) {
            soft = soft.max(size);
        }
    }
    let beyond = |limit: f64| {
        let mut beyond = sum;
        beyond.add(-limit);
        beyond.value()
    };
    let miss = (-beyond(lower)).max(beyond(upper));
    // Exact terms have no rounding, so their violation counts beyond the tolerance.
    let lost = (ROW_DIGITS * scale).min(tolerance::FEASIBILITY.max(ROW_DIGITS * soft));
    miss > CONTRADICTION.max(lost) + 4.0 * f64::EPSILON * scale + loosened
}

/// A finished row that is parallel to the unfinished one from `begin` on, and the factor between
/// them.
fn find_parallel(
    rows: &Compressed,
    mut candidates: impl Iterator<Item = usize>,
    begin: usize,
) -> Option<(usize, f64)> {
    let (index, value) = (&rows.index[begin..], &rows.value[begin..]);
    candidates.find_map(|other| {
        let (other_index, other_value) = rows.vector(other);
        if other_index != index {
            return None;
        }
        Some((other, ratio(value.iter().copied().zip(other_value.iter().copied()))?))
    })
}
