//! The program during reduction: rows by columns and columns by rows, both sparse, with the
//! original numbers.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use faer::sparse::{CreationError, SparseColMat, SparseRowMat, Triplet};

use super::postsolve::{Postsolve, Presolved, Undo};
use crate::error::{Error, ErrorKind};
use crate::presolve::coefficients::is_exact;
use crate::presolve::parameters::{CONTRADICTION, LARGEST_WHOLE};
use crate::program::{Cone, Program, conic_columns};
use crate::solver::StopToken;
use crate::tolerance::{self, finite_size};

/// The rounding of a bound, and of the limit of an equality, that its users tolerate, relative to
/// the limit.
const SOFT_ROUNDING: f64 = 1e-9;

/// The same for limits of other rows, and of rows of exact terms. Their large limits come from
/// big-Ms, which must not hide the violation of the row without them.
const EXACT_ROUNDING: f64 = 1e-14;

/// The rounding of the limit of a row that its users tolerate in any case, in units of the last
/// place of the limit.
const TOLERATED_PLACES: f64 = 64.0;

/// Proof that no point satisfies rows and bounds.
#[derive(Debug, Clone, Copy)]
pub(super) struct Infeasible;

/// A sparse vector, sorted by position.
pub(super) type Sparse = Vec<(usize, f64)>;

/// The program, and the undos of what was done to it.
#[derive(Debug)]
pub(super) struct WorkingProgram {
    pub(super) rows: Vec<Sparse>,
    /// The rows that a column is in, sorted.
    pub(super) uses: Vec<Vec<usize>>,
    pub(super) row_lower: Vec<f64>,
    pub(super) row_upper: Vec<f64>,
    pub(super) row_alive: Vec<bool>,
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    pub(super) column_alive: Vec<bool>,
    /// By row, the largest error of its limits from rounding, in its unit. Terms that cancel leave
    /// their rounding, which the remaining limit does not show.
    pub(super) row_noise: Vec<f64>,
    /// By column, the largest error of its bounds from rounding, in its unit.
    pub(super) column_noise: Vec<f64>,
    /// By column without bounds, its largest magnitude at points within the radius of proofs, as a
    /// multiple of the radius (no unit): a column may now stand for a sum of several.
    pub(super) spread: Vec<f64>,
    pub(super) integral: Vec<bool>,
    /// Columns whose value comes from outside: they keep their bounds, and no rule may choose their
    /// value, put them in terms of others, or use that they could move.
    pub(super) given: Vec<bool>,
    /// Second-order cones. Their columns stay, and no rule may choose their value, put them in
    /// terms of others, or use that they could move. Their bounds may become tighter.
    pub(super) cones: Vec<Cone>,
    /// Which columns are in cones.
    pub(super) conic: Vec<bool>,
    /// Whether the program has neither cones nor curvature.
    pub(super) is_linear: bool,
    pub(super) linear: Vec<f64>,
    /// `P`, both triangles.
    pub(super) quadratic: Vec<BTreeMap<usize, f64>>,
    pub(super) offset: f64,
    constant: f64,
    /// The largest error of the objective's constant from rounding.
    rounding: f64,
    pub(super) undos: Vec<Box<dyn Undo>>,
    /// The number of rows of the program; the others were added.
    own_row_count: usize,
    step: Vec<Option<usize>>,
    sign: f64,
    token: StopToken,
    /// Memory for a row.
    pub(super) memory: Sparse,
}

/// A column as it was before it was taken out.
#[derive(Debug, Clone)]
pub(super) struct OldColumn {
    pub(super) column: usize,
    pub(super) entries: Sparse,
    linear: f64,
    quadratic: Sparse,
}

impl OldColumn {
    /// `q + Px + A'y` of the column, leaving one row out.
    pub(super) fn gradient(&self, x: &[f64], y: &[f64], without: Option<usize>) -> f64 {
        let curved: f64 = self.quadratic.iter().map(|&(k, p)| p * x[k]).sum();
        let rows = self.entries.iter().filter(|(row, _)| Some(*row) != without);
        self.linear + curved + rows.map(|&(row, a)| a * y[row]).sum::<f64>()
    }
}

impl WorkingProgram {
    pub(super) fn new(program: &Program, token: &StopToken) -> Self {
        let (m, n) = (program.row_count(), program.column_count());
        let pairs = |(index, value): (&[usize], &[f64])| {
            let entries: Sparse = index.iter().copied().zip(value.iter().copied()).collect();
            entries.into_iter().filter(|(_, a)| *a != 0.0)
        };
        // In place: as much memory as the row had.
        let rows: Vec<Sparse> = (0..m).map(|i| pairs(program.row(i)).collect()).collect();
        let room = |j: usize| Vec::with_capacity(program.column(j).0.len());
        let mut uses: Vec<Vec<usize>> = (0..n).map(room).collect();
        for (i, row) in rows.iter().enumerate() {
            row.iter().for_each(|&(j, _)| uses[j].push(i));
        }
        let limits = program.row_lower.iter().zip(&program.row_upper);
        WorkingProgram {
            rows,
            uses,
            // Limits may come from a sum themselves.
            row_noise: limits
                .map(|(&l, &u)| f64::EPSILON * finite_size(l).max(finite_size(u)))
                .collect(),
            column_noise: vec![0.0; n],
            spread: vec![program.spread; n],
            row_lower: program.row_lower.clone(),
            row_upper: program.row_upper.clone(),
            row_alive: vec![true; m],
            lower: program.lower.clone(),
            upper: program.upper.clone(),
            column_alive: vec![true; n],
            integral: program.integral.clone(),
            given: vec![false; n],
            cones: program.cones.clone(),
            is_linear: program.cones.is_empty() && program.quadratic.compute_nnz() == 0,
            conic: conic_columns(&program.cones, n),
            linear: program.linear.clone(),
            quadratic: (0..n).map(|j| pairs(program.quadratic_column(j)).collect()).collect(),
            offset: program.offset,
            constant: program.constant,
            rounding: 0.0,
            undos: Vec::new(),
            own_row_count: m,
            step: program.step.clone(),
            sign: program.sign,
            token: token.clone(),
            memory: Sparse::new(),
        }
    }

    /// Whether rules should end. They check this between complete reductions, with the number of
    /// entries that they have visited in between.
    pub(super) fn is_late(&mut self, entries: usize) -> bool {
        // A reduction looks at several times the entries of its row or column.
        self.token.spend(8 + 4 * entries)
    }

    /// Applies a rule to one live row after another until it is late, and adds up the changes.
    pub(super) fn each_row(
        &mut self,
        mut rule: impl FnMut(&mut WorkingProgram, usize) -> Result<usize, Infeasible>,
    ) -> Result<usize, Infeasible> {
        let mut changes = 0;
        for row in self.live_rows() {
            if self.is_late(self.rows[row].len()) {
                break;
            }
            changes += rule(self, row)?;
        }
        Ok(changes)
    }

    /// Applies a rule to one column after another until it is late, and adds up the changes.
    pub(super) fn each_column(
        &mut self,
        columns: Vec<usize>,
        mut rule: impl FnMut(&mut WorkingProgram, usize) -> usize,
    ) -> usize {
        let mut changes = 0;
        for column in columns {
            if self.is_late(self.uses[column].len()) {
                break;
            }
            changes += rule(self, column);
        }
        changes
    }

    pub(super) fn live_rows(&self) -> Vec<usize> {
        (0..self.rows.len()).filter(|&i| self.row_alive[i]).collect()
    }

    pub(super) fn live_columns(&self) -> Vec<usize> {
        (0..self.uses.len()).filter(|&j| self.column_alive[j]).collect()
    }

    pub(super) fn is_equality(&self, row: usize) -> bool {
        self.row_lower[row] == self.row_upper[row]
    }

    pub(super) fn is_binary(&self, column: usize) -> bool {
        self.integral[column] && self.lower[column] == 0.0 && self.upper[column] == 1.0
    }

    /// Whether more than its rows and its cost speak of a column: it comes from outside, or a cone
    /// has it.
    pub(super) fn is_held(&self, column: usize) -> bool {
        self.given[column] || self.conic[column]
    }

    /// Whether a column has no part in the curvature of the objective.
    pub(super) fn is_straight(&self, column: usize) -> bool {
        self.quadratic[column].is_empty()
    }

    /// The coefficient of a column in a row; 0 where it is not.
    pub(super) fn coefficient(&self, row: usize, column: usize) -> f64 {
        let found = self.rows[row].binary_search_by_key(&column, |&(j, _)| j);
        found.map_or(0.0, |at| self.rows[row][at].1)
    }

    /// Rows and coefficients of a column.
    pub(super) fn column(&self, column: usize) -> impl Iterator<Item = (usize, f64)> + Clone {
        self.uses[column].iter().map(move |&row| (row, self.coefficient(row, column)))
    }

    /// A column as it is now, for its undo.
    pub(super) fn remember(&self, column: usize) -> OldColumn {
        OldColumn {
            column,
            entries: self.column(column).collect(),
            linear: self.linear[column],
            quadratic: self.quadratic[column].iter().map(|(&k, &p)| (k, p)).collect(),
        }
    }

    pub(super) fn push(&mut self, undo: impl Undo + 'static) {
        self.undos.push(Box::new(undo));
    }

    pub(super) fn drop_row(&mut self, row: usize) {
        self.row_alive[row] = false;
        for (column, _) in std::mem::take(&mut self.rows[row]) {
            self.uses[column].retain(|&i| i != row);
        }
    }

    /// Gives a row other entries (sorted by column, none of them 0). Returns the old ones.
    pub(super) fn set_row(&mut self, row: usize, entries: Sparse) -> Sparse {
        for &(column, _) in &self.rows[row] {
            self.uses[column].retain(|&i| i != row);
        }
        for &(column, _) in &entries {
            if let Err(at) = self.uses[column].binary_search(&row) {
                self.uses[column].insert(at, row);
            }
        }
        std::mem::replace(&mut self.rows[row], entries)
    }

    /// Takes a column out whose entries in rows and objective are gone or replaced.
    pub(super) fn drop_column(&mut self, column: usize) {
        self.column_alive[column] = false;
        for row in std::mem::take(&mut self.uses[column]) {
            self.rows[row].retain(|&(j, _)| j != column);
        }
        for (other, _) in std::mem::take(&mut self.quadratic[column]) {
            self.quadratic[other].remove(&column);
        }
        self.linear[column] = 0.0;
    }

    /// Adds a constant to the objective: a product that may cancel against others, and whose
    /// factors are rounded themselves.
    pub(super) fn shift_objective(&mut self, constant: f64) {
        self.offset += constant;
        self.rounding += 2.0 * f64::EPSILON * constant.abs();
    }

    /// Adds a product to the constant of the objective; one of whole numbers is exact.
    pub(super) fn add_to_objective(&mut self, factor: f64, value: f64) {
        let product = factor * value;
        let whole = |value: f64| value == value.round() && value.abs() <= LARGEST_WHOLE;
        let sum = self.offset + product;
        if whole(factor) && whole(value) && whole(product) && whole(self.offset) && whole(sum) {
            self.offset = sum;
        } else {
            self.shift_objective(product);
        }
    }

    /// Notes that the value of a column in the objective has an error of `noise`. Products with
    /// columns without bounds are left out.
    pub(super) fn blur_objective(&mut self, column: usize, value: f64, noise: f64) {
        let mut slope = self.linear[column].abs();
        for (&other, p) in &self.quadratic[column] {
            let size = finite_size(self.lower[other]).max(finite_size(self.upper[other]));
            slope += p.abs() * if other == column { value.abs() } else { size };
        }
        self.rounding += slope * noise;
    }

    /// Moves the limits of a row by a constant that joins its activity.
    pub(super) fn shift_row(&mut self, row: usize, constant: f64) {
        self.row_lower[row] -= constant;
        self.row_upper[row] -= constant;
        self.add_rounding(row, constant);
    }

    /// Notes the rounding of a constant that joined the limits of a row, and that of the sum.
    pub(super) fn add_rounding(&mut self, row: usize, constant: f64) {
        self.row_noise[row] += f64::EPSILON * (finite_size(constant) + self.limit_size(row));
    }

    /// The largest magnitude of the limits of a row.
    pub(super) fn limit_size(&self, row: usize) -> f64 {
        finite_size(self.row_lower[row]).max(finite_size(self.row_upper[row]))
    }

    /// Tightens the bounds of a column by some that rounding may have moved by `noise`; slightly
    /// crossed ones meet in the middle.
    pub(super) fn intersect(
        &mut self,
        column: usize,
        [lower, upper]: [f64; 2],
        noise: f64,
    ) -> Result<(), Infeasible> {
        if lower > self.lower[column] || upper < self.upper[column] {
            self.column_noise[column] = self.column_noise[column].max(noise);
        }
        let noise = self.column_noise[column];
        let (mut lower, mut upper) = (self.lower[column].max(lower), self.upper[column].min(upper));
        if self.given[column] && lower <= upper {
            return Ok(());
        }
        if self.integral[column] {
            let slack = noise.max(tolerance::INTEGRALITY);
            (lower, upper) = ((lower - slack).ceil(), (upper + slack).floor());
            self.column_noise[column] = 0.0;
        }
        if lower > upper {
            if self.integral[column] || lower - upper > crossed(lower, upper).max(2.0 * noise) {
                return Err(Infeasible);
            }
            self.column_noise[column] += 0.5 * (lower - upper);
            let middle = 0.5 * (lower + upper);
            (lower, upper) = (middle, middle);
        }
        (self.lower[column], self.upper[column]) = (lower, upper);
        Ok(())
    }

    /// Refuses bounds and limits that contradict each other.
    pub(super) fn settle(&mut self) -> Result<(), Infeasible> {
        for column in 0..self.uses.len() {
            self.intersect(column, [f64::NEG_INFINITY, f64::INFINITY], 0.0)?;
        }
        (0..self.rows.len()).try_for_each(|row| self.settle_row(row))
    }

    /// Whether the limits of a row, in its unit, are crossed; slightly crossed ones meet.
    pub(super) fn settle_row(&mut self, row: usize) -> Result<(), Infeasible> {
        let (lower, upper) = (self.row_lower[row], self.row_upper[row]);
        if lower <= upper {
            return Ok(());
        }
        if lower - upper > crossed(lower, upper).max(2.0 * self.row_noise[row]) {
            return Err(Infeasible);
        }
        self.row_noise[row] += 0.5 * (lower - upper);
        let middle = 0.5 * (lower + upper);
        (self.row_lower[row], self.row_upper[row]) = (middle, middle);
        Ok(())
    }

    /// Widens limits and bounds that rounding may have moved further than is allowed for, given
    /// their size, wherever they are used.
    ///
    /// Returns by how much: of rows, and of columns.
    fn allow_for_noise(&mut self) -> [Vec<f64>; 2] {
        let widen = |lower: &mut f64, upper: &mut f64, noise: f64, part: f64, least: f64| {
            let known = |limit: f64| SOFT_ROUNDING.max(part * finite_size(limit));
            let size = finite_size(*lower).max(finite_size(*upper));
            // A small coefficient multiplies the rounding where the row bounds its column.
            let shows = noise > SOFT_ROUNDING * least;
            let is_widened = noise > known(*lower).max(known(*upper))
                || (shows && noise > TOLERATED_PLACES * f64::EPSILON * size);
            if is_widened {
                (*lower, *upper) = (*lower - noise, *upper + noise);
            }
            if is_widened { noise } else { 0.0 }
        };
        let (mut rows, mut columns) = (vec![0.0; self.rows.len()], vec![0.0; self.uses.len()]);
        for (row, by) in rows.iter_mut().enumerate() {
            let exact = |&(j, a): &(usize, f64)| self.integral[j] && is_exact(a);
            let soft = self.is_equality(row) && !self.rows[row].iter().all(exact);
            let part = if soft { SOFT_ROUNDING } else { EXACT_ROUNDING };
            let (lower, upper) = (&mut self.row_lower[row], &mut self.row_upper[row]);
            let continuous = self.rows[row].iter().filter(|(j, _)| !self.integral[*j]);
            let least = continuous.map(|(_, a)| a.abs()).fold(f64::INFINITY, f64::min);
            *by = widen(lower, upper, self.row_noise[row], part, least);
        }
        for (j, by) in columns.iter_mut().enumerate().filter(|(j, _)| !self.integral[*j]) {
            let (lower, upper) = (&mut self.lower[j], &mut self.upper[j]);
            *by = widen(lower, upper, self.column_noise[j], SOFT_ROUNDING, f64::INFINITY);
        }
        [rows, columns]
    }

    /// The presolved program, numbered anew.
    pub(super) fn finish(mut self) -> Result<Presolved, Error> {
        let [widened_rows, widened_columns] = self.allow_for_noise();
        let matrix = |error: CreationError| Error::with_source(ErrorKind::Allocation, error);
        let (columns, rows) = (self.live_columns(), self.live_rows());
        let mut position = vec![usize::MAX; self.uses.len()];
        columns.iter().enumerate().for_each(|(k, &j)| position[j] = k);
        let (mut entries, mut products) = (Vec::new(), Vec::new());
        for (k, &i) in rows.iter().enumerate() {
            let terms = self.rows[i].iter();
            entries.extend(terms.map(|&(j, a)| Triplet::new(k, position[j], a)));
        }
        for (k, &j) in columns.iter().enumerate() {
            let terms = self.quadratic[j].iter();
            products.extend(terms.map(|(&i, &p)| Triplet::new(position[i], k, p)));
        }
        let (m, n) = (rows.len(), columns.len());
        let pick =
            |from: &[f64], which: &[usize]| which.iter().map(|&k| from[k]).collect::<Vec<f64>>();
        let some = |widened: Vec<f64>| match widened.iter().any(|&by| by > 0.0) {
            true => widened,
            false => Vec::new(),
        };
        let integral: Vec<bool> = columns.iter().map(|&j| self.integral[j]).collect();
        let is_open = |j: usize| self.lower[j].is_infinite() || self.upper[j].is_infinite();
        let open = columns.iter().copied().filter(|&j| is_open(j));
        let program = Program {
            quadratic: SparseColMat::try_new_from_triplets(n, n, &products).map_err(matrix)?,
            linear: pick(&self.linear, &columns),
            offset: self.offset,
            constant: self.constant,
            sign: self.sign,
            rows: SparseRowMat::try_new_from_triplets(m, n, &entries).map_err(matrix)?,
            columns: SparseColMat::try_new_from_triplets(m, n, &entries).map_err(matrix)?,
            row_lower: pick(&self.row_lower, &rows),
            row_upper: pick(&self.row_upper, &rows),
            lower: pick(&self.lower, &columns),
            upper: pick(&self.upper, &columns),
            integers: (0..n).filter(|&k| integral[k]).collect(),
            integral,
            cones: self.cones.iter().map(|cone| cone.renumbered(|j| position[j])).collect(),
            conic: OnceLock::new(),
            cone_cuts: None,
            step: columns.iter().map(|&j| self.step[j]).collect(),
            spread: open.map(|j| self.spread[j]).fold(1.0, f64::max),
            steepness: OnceLock::new(),
            squared: OnceLock::new(),
            widened: [some(pick(&widened_rows, &rows)), some(pick(&widened_columns, &columns))],
        };
        let postsolve = Postsolve {
            undos: self.undos,
            columns,
            rows,
            column_count: self.uses.len(),
            row_count: self.rows.len(),
            own_row_count: self.own_row_count,
        };
        Ok(Presolved { program, postsolve, rounding: self.rounding })
    }
}

/// The amount by which bounds or limits may be crossed: rounding, or the accepted violation.
fn crossed(lower: f64, upper: f64) -> f64 {
    let scale = lower.abs().max(upper.abs()).max(1.0);
    (CONTRADICTION * scale).min(tolerance::FEASIBILITY.max(EXACT_ROUNDING * scale))
}
