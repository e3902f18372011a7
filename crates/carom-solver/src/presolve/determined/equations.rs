//! Equalities of a program that may determine columns.

/// Kinds of columns before the equations are looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColumnKind {
    /// Its value is given.
    Known,
    /// A continuous column that an equation may determine.
    Unknown,
    /// Neither: equations with this column are left out.
    Other,
}

/// Equalities over known and unknown columns.
#[derive(Debug, Clone)]
pub(super) struct Equations {
    /// By equation: where its terms begin; the end of all.
    start: Vec<usize>,
    terms: Vec<(usize, f64)>,
    right: Vec<f64>,
    /// By equation: its row in the program.
    rows: Vec<usize>,
}

impl Equations {
    /// Those of some equalities that have no other columns, and an unknown one.
    pub(super) fn of<T: Iterator<Item = (usize, f64)>>(
        equalities: impl Iterator<Item = (usize, T, f64)>,
        kind: impl Fn(usize) -> ColumnKind,
    ) -> Self {
        let mut all =
            Equations { start: vec![0], terms: Vec::new(), right: Vec::new(), rows: Vec::new() };
        for (row, terms, right) in equalities {
            let begin = all.terms.len();
            all.terms.extend(terms.filter(|(_, a)| *a != 0.0));
            let has = |wanted| all.terms[begin..].iter().any(|&(j, _)| kind(j) == wanted);
            if has(ColumnKind::Other) || !has(ColumnKind::Unknown) || !right.is_finite() {
                all.terms.truncate(begin);
                continue;
            }
            all.start.push(all.terms.len());
            all.right.push(right);
            all.rows.push(row);
        }
        all
    }

    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn row(&self, equation: usize) -> usize {
        self.rows[equation]
    }

    pub(super) fn right(&self, equation: usize) -> f64 {
        self.right[equation]
    }

    pub(super) fn terms(&self, equation: usize) -> &[(usize, f64)] {
        &self.terms[self.start[equation]..self.start[equation + 1]]
    }

    /// By how much an equation multiplies the errors of its other columns.
    ///
    /// # Arguments
    ///
    /// * `own`: the columns that the equation helps to determine.
    /// * `error`: the errors of columns that were determined before.
    pub(super) fn growth(
        &self,
        equation: usize,
        own: &[usize],
        error: impl Fn(usize) -> Option<f64>,
    ) -> f64 {
        let (mut pivot, mut grown) = (0.0_f64, 0.0);
        for &(j, a) in self.terms(equation) {
            if own.contains(&j) {
                pivot = pivot.max(a.abs());
            } else {
                grown += a.abs() * error(j).unwrap_or(0.0);
            }
        }
        grown / pivot
    }
}
