//! The linear system of an iteration, condensed onto columns, equalities and long rows.
//!
//! With weights `w` of the sides, an inequality row adds `w a a'` to the block of the columns, so
//! only equalities (and rows so long that `a a'` would fill the block) have unknowns:
//!
//! `[ P + D + A_s' W A_s + δ   A_e'   A_l'      ]`
//! `[ A_e                      -δ               ]`
//! `[ A_l                             -1/w_l - δ ]`

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par};

use super::condensed::{Condensed, Term};
use super::elimination_order::{KeptOrders, Unknowns, minimum_degree};
use super::scaled::Scaled;
use crate::presolve::Reduced;
use crate::solver::StopToken;

/// Operations per entry of the factors, in units of 40, from which they are computed in dense blocks.
const SUPERNODAL: f64 = 0.25;

pub(super) struct Kkt {
    /// Its upper triangle, by columns, in the order of elimination.
    pattern: SymbolicSparseColMat<usize>,
    value: Vec<f64>,
    /// By unknown, when it is eliminated.
    order: Vec<usize>,
    /// A right side in that order.
    ordered: Vec<f64>,
    /// The matrix without weights.
    constant: Vec<f64>,
    diagonal: Vec<usize>,
    terms: Vec<Term>,
    /// Rows with an unknown, after the equalities.
    pub(super) long: Vec<usize>,
    signs: Vec<i8>,
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
    memory: MemBuffer,
}

impl Kkt {
    /// The pattern of the system of a program in even units; `None` if it cannot be ordered or the
    /// token is over. `kept` are orders of earlier systems.
    pub(super) fn new(
        reduced: &Reduced,
        program: &Scaled,
        kept: &mut KeptOrders,
        token: &StopToken,
    ) -> Option<Self> {
        let Condensed { start, index, constant, mut diagonal, mut terms, long } =
            Condensed::new(program);
        let (n, size) = (program.column.len(), diagonal.len());
        if token.is_over() {
            return None;
        }
        let rows = program.equalities.iter().map(|(row, _)| *row).chain(long.iter().copied());
        let unknowns = Unknowns::new(reduced, rows);
        let part = kept.part(&unknowns).and_then(|(order, most)| {
            Ordered::new(&start, &index, order).filter(|part| part.fill() <= most)
        });
        let ordered = match part {
            Some(part) => part,
            None => {
                let order = minimum_degree(size, &start, &index)?;
                let ordered = Ordered::new(&start, &index, order)?;
                kept.keep(&unknowns, &ordered.order, ordered.fill());
                ordered
            }
        };
        let Ordered { pattern, moved, order, symbolic } = ordered;
        let mut signs = vec![1; size];
        order[n..].iter().for_each(|&k| signs[k] = -1);
        let mut by_column = vec![0.0; constant.len()];
        moved.iter().zip(&constant).for_each(|(&k, v)| by_column[k] = *v);
        let constant = by_column;
        terms.iter_mut().for_each(|term| term.position = moved[term.position]);
        diagonal.iter_mut().for_each(|k| *k = moved[*k]);
        if token.is_over() {
            return None;
        }
        let need = symbolic
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        let memory = MemBuffer::try_new(need).ok()?;
        Some(Kkt {
            value: constant.clone(),
            factor: vec![0.0; symbolic.len_val()],
            pattern,
            order,
            ordered: vec![0.0; size],
            constant,
            diagonal,
            terms,
            long,
            signs,
            symbolic,
            memory,
        })
    }

    /// Factorises with the weights of columns and rows; `false` if that breaks down.
    pub(super) fn factorise(&mut self, of_columns: &[f64], of_rows: &[f64]) -> bool {
        self.value.copy_from_slice(&self.constant);
        for (&k, w) in self.diagonal.iter().zip(of_columns) {
            self.value[k] += w;
        }
        for term in &self.terms {
            self.value[term.position] += of_rows[term.row] * term.product;
        }
        let owned = self.diagonal.len() - self.long.len();
        for (k, &row) in self.long.iter().enumerate() {
            self.value[self.diagonal[owned + k]] -= 1.0 / of_rows[row].max(1e-12);
        }
        let matrix = SparseColMatRef::new(self.pattern.as_ref(), &self.value);
        let regularization = LdltRegularization {
            dynamic_regularization_signs: Some(&self.signs),
            dynamic_regularization_delta: 1e-8,
            dynamic_regularization_epsilon: 1e-14,
        };
        let stack = MemStack::new(&mut self.memory);
        self.symbolic
            .factorize_numeric_ldlt(
                &mut self.factor,
                matrix,
                faer::Side::Upper,
                regularization,
                Par::Seq,
                stack,
                Default::default(),
            )
            .is_ok()
    }

    /// Solves with the factors; `right` is columns, equalities, long rows.
    pub(super) fn solve(&mut self, right: &mut [f64]) {
        let size = right.len();
        self.order.iter().zip(&*right).for_each(|(&k, v)| self.ordered[k] = *v);
        let factor = LdltRef::new(&self.symbolic, &self.factor);
        let stack = MemStack::new(&mut self.memory);
        let ordered = MatMut::from_column_major_slice_mut(&mut self.ordered, size, 1);
        factor.solve_in_place_with_conj(Conj::No, ordered, Par::Seq, stack);
        self.order.iter().zip(right).for_each(|(&k, v)| *v = self.ordered[k]);
    }
}

/// The upper triangle of a symmetric pattern in an order of elimination. Ordered once, it need not be
/// permuted with every factorisation.
struct Ordered {
    /// Its columns are not sorted.
    pattern: SymbolicSparseColMat<usize>,
    /// By entry as it was given, where it is.
    moved: Vec<usize>,
    /// By unknown, when it is eliminated.
    order: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
}

impl Ordered {
    /// `None` if there is no memory for the factor.
    fn new(start: &[usize], index: &[usize], order: Vec<usize>) -> Option<Self> {
        let size = order.len();
        let entries = || {
            let columns =
                (0..size).flat_map(|c| index[start[c]..start[c + 1]].iter().map(move |i| (*i, c)));
            columns.map(|(i, c)| {
                let (i, c) = (order[i], order[c]);
                (i.min(c), i.max(c))
            })
        };
        let mut first = vec![0; size + 1];
        entries().for_each(|(_, c)| first[c + 1] += 1);
        (0..size).for_each(|c| first[c + 1] += first[c]);
        let mut next = first.clone();
        let (mut rows, mut moved) = (vec![0; index.len()], Vec::with_capacity(index.len()));
        for (i, c) in entries() {
            rows[next[c]] = i;
            moved.push(next[c]);
            next[c] += 1;
        }
        let pattern = SymbolicSparseColMat::new_unsorted_checked(size, size, first, None, rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            faer::Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold(SUPERNODAL),
                ..CholeskySymbolicParams::default()
            },
        )
        .ok()?;
        Some(Ordered { pattern, moved, order, symbolic })
    }

    /// Entries of the factor for each of the pattern's.
    fn fill(&self) -> f64 {
        self.symbolic.len_val() as f64 / self.moved.len().max(1) as f64
    }
}
