//! The linear system of an iteration, condensed onto columns, equalities and long rows.
//!
//! With weights `w` of the sides, an inequality row adds `w a a'` to the block of the columns, so
//! only equalities (and rows so long that `a a'` would fill the block) have unknowns:
//!
//! `[ P + D + A_s' W A_s + δ   A_e'   A_l'         G'       ]`
//! `[ A_e                      -δ                           ]`
//! `[ A_l                             -1/w_l - δ            ]`
//! `[ G                                            -W^2 - δ ]`
//!
//! The entries of cones have unknowns, too, because the inverse of `W^2` is far less accurate near
//! the boundary of a cone.

use super::parameters::{ASSUMED_RATE, LARGE_FACTORISATION, MAX_KEPT_SYSTEMS, SUPERNODAL_RATIO};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par};
use web_time::{Duration, Instant};

use super::condensed::Condensed;
use super::cone_iterate::ConeIterate;
use super::elimination_order::{KeptOrders, stack};
use super::scaled::ScaledProgram;
use super::scaled_cones::ScaledCones;
use crate::presolve::{Reduced, refill};
use crate::solver::StopToken;

pub(super) struct Kkt {
    condensed: Condensed,
    /// The last systems, the current one first.
    ordered: Vec<Ordered>,
    orders: KeptOrders,
    /// The matrix in the order of elimination, and the one without weights.
    value: Vec<f64>,
    constant: Vec<f64>,
    /// A right side in that order.
    right: Vec<f64>,
    signs: Vec<i8>,
    factor: Vec<f64>,
    memory: Option<MemBuffer>,
    /// Operations a second of a large factorisation.
    rate: f64,
    /// A factorisation cannot be stopped, so one that takes longer than what is left is not begun.
    token: StopToken,
}

impl Default for Kkt {
    fn default() -> Self {
        Kkt {
            condensed: Condensed::default(),
            ordered: Vec::new(),
            orders: KeptOrders::default(),
            value: Vec::new(),
            constant: Vec::new(),
            right: Vec::new(),
            signs: Vec::new(),
            factor: Vec::new(),
            memory: None,
            rate: ASSUMED_RATE,
            token: StopToken::default(),
        }
    }
}

impl Kkt {
    /// Becomes the system of a program in even units, in the memory that it has; `false` if it
    /// cannot be ordered or the token is over. A system that has the pattern of one of the last
    /// ones is neither ordered nor analysed again.
    pub(super) fn load(
        &mut self,
        reduced: &Reduced,
        program: &ScaledProgram,
        token: &StopToken,
    ) -> bool {
        self.condensed.load(program);
        if token.is_over() || self.order(reduced, program).is_none() {
            return false;
        }
        let ordered = &self.ordered[0];
        if token.cannot_wait(ordered.duration(self.rate)) {
            return false;
        }
        self.token = token.clone();
        let (n, size) = (program.column.len(), self.condensed.size());
        refill(&mut self.signs, size, 1);
        ordered.order[n..].iter().for_each(|&k| self.signs[k] = -1);
        let Condensed { constant, terms, blocks, diagonal, .. } = &mut self.condensed;
        refill(&mut self.constant, constant.len(), 0.0);
        for (&k, v) in ordered.moved.iter().zip(&*constant) {
            self.constant[k] = *v;
        }
        terms.iter_mut().for_each(|term| term.position = ordered.moved[term.position]);
        blocks.iter_mut().for_each(|k| *k = ordered.moved[*k]);
        diagonal.iter_mut().for_each(|k| *k = ordered.moved[*k]);
        refill(&mut self.factor, ordered.symbolic.len_val(), 0.0);
        refill(&mut self.right, size, 0.0);
        self.value.clone_from(&self.constant);
        true
    }

    /// Puts the order of the loaded system first; `None` if there is none.
    fn order(&mut self, reduced: &Reduced, program: &ScaledProgram) -> Option<()> {
        let Condensed { start, index, long, .. } = &self.condensed;
        if let Some(k) = self.ordered.iter().position(|kept| kept.is_of(start, index)) {
            self.ordered[..=k].rotate_right(1);
        } else {
            let rows = program.equalities.iter().map(|(row, _)| *row).chain(long.iter().copied());
            let mut memory = OrderMemory::default();
            if self.ordered.len() >= MAX_KEPT_SYSTEMS {
                memory = self.ordered.pop().map(Ordered::into_memory).unwrap_or_default();
            }
            let entries = program.cones.names();
            let names = (rows, entries);
            let part = self.orders.write_part(reduced, names, &mut memory.order).and_then(|most| {
                let part = Ordered::new(start, index, std::mem::take(&mut memory))?;
                if part.fill() <= most {
                    return Some(part);
                }
                memory = part.into_memory();
                None
            });
            let ordered = match part {
                Some(part) => part,
                None => {
                    let size = self.condensed.size();
                    self.orders.write_minimum_degree(size, (start, index), &mut memory.order)?;
                    let ordered = Ordered::new(start, index, memory)?;
                    self.orders.keep(&ordered.order, ordered.fill());
                    ordered
                }
            };
            self.ordered.insert(0, ordered);
        }
        let symbolic = &self.ordered[0].symbolic;
        let need = symbolic
            .factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        stack(&mut self.memory, need).map(|_| ())
    }

    /// Rows with an unknown, after the equalities.
    pub(super) fn long(&self) -> &[usize] {
        &self.condensed.long
    }

    /// Factorises with the weights of columns and rows, and the scaling of cones; `false` if that
    /// breaks down or would take longer than what is left.
    pub(super) fn factorise(
        &mut self,
        of_columns: &[f64],
        of_rows: &[f64],
        cones: (&ScaledCones, &ConeIterate),
    ) -> bool {
        let Condensed { diagonal, terms, blocks, long, .. } = &self.condensed;
        let (Some(ordered), Some(memory)) = (self.ordered.first(), &mut self.memory) else {
            return false;
        };
        if self.token.cannot_wait(ordered.duration(self.rate)) {
            return false;
        }
        self.value.copy_from_slice(&self.constant);
        for (&k, w) in diagonal.iter().zip(of_columns) {
            self.value[k] += w;
        }
        for term in terms {
            self.value[term.position] += of_rows[term.row] * term.product;
        }
        let (cones, of_cones) = cones;
        of_cones.for_each_block_entry(cones, blocks, |k, value| self.value[k] -= value);
        let owned = diagonal.len() - long.len();
        for (k, &row) in long.iter().enumerate() {
            self.value[diagonal[owned + k]] -= 1.0 / of_rows[row].max(1e-12);
        }
        let matrix = SparseColMatRef::new(ordered.pattern.as_ref(), &self.value);
        let regularization = LdltRegularization {
            dynamic_regularization_signs: Some(&self.signs),
            dynamic_regularization_delta: 1e-8,
            dynamic_regularization_epsilon: 1e-14,
        };
        let stack = MemStack::new(memory);
        let (began, operations) = (Instant::now(), ordered.operations);
        let done = ordered
            .symbolic
            .factorize_numeric_ldlt(
                &mut self.factor,
                matrix,
                faer::Side::Upper,
                regularization,
                Par::Seq,
                stack,
                Default::default(),
            )
            .is_ok();
        if operations > LARGE_FACTORISATION {
            self.rate = operations / began.elapsed().as_secs_f64().max(1e-9);
        }
        done
    }

    /// Solves with the factors; `right` is columns, equalities, long rows, entries of cones.
    pub(super) fn solve(&mut self, right: &mut [f64]) {
        let (Some(ordered), Some(memory)) = (self.ordered.first(), &mut self.memory) else {
            return;
        };
        let size = right.len();
        ordered.order.iter().zip(&*right).for_each(|(&k, v)| self.right[k] = *v);
        let factor = LdltRef::new(&ordered.symbolic, &self.factor);
        let stack = MemStack::new(memory);
        let in_order = MatMut::from_column_major_slice_mut(&mut self.right, size, 1);
        factor.solve_in_place_with_conj(Conj::No, in_order, Par::Seq, stack);
        ordered.order.iter().zip(right).for_each(|(&k, v)| *v = self.right[k]);
    }
}

/// The upper triangle of a symmetric pattern in an order of elimination, so that no factorisation
/// has to permute it.
struct Ordered {
    /// The pattern as it was given, by columns.
    start: Vec<usize>,
    index: Vec<usize>,
    /// Its columns are not sorted.
    pattern: SymbolicSparseColMat<usize>,
    /// By entry as it was given, where it is.
    moved: Vec<usize>,
    /// By unknown, when it is eliminated.
    order: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    /// Multiplications of a factorisation.
    operations: f64,
}

/// An order of elimination, and memory for the rest of an [`Ordered`].
#[derive(Default)]
struct OrderMemory {
    order: Vec<usize>,
    start: Vec<usize>,
    index: Vec<usize>,
    first: Vec<usize>,
    rows: Vec<usize>,
    moved: Vec<usize>,
}

impl Ordered {
    /// `None` if there is no memory for the factor.
    fn new(start: &[usize], index: &[usize], memory: OrderMemory) -> Option<Self> {
        let OrderMemory { order, mut first, mut rows, mut moved, .. } = memory;
        let (mut own_start, mut own_index) = (memory.start, memory.index);
        let size = order.len();
        let entries = || {
            let columns =
                (0..size).flat_map(|c| index[start[c]..start[c + 1]].iter().map(move |i| (*i, c)));
            columns.map(|(i, c)| {
                let (i, c) = (order[i], order[c]);
                (i.min(c), i.max(c))
            })
        };
        refill(&mut first, size + 1, 0);
        entries().for_each(|(_, c)| first[c + 1] += 1);
        (0..size).for_each(|c| first[c + 1] += first[c]);
        refill(&mut rows, index.len(), 0);
        moved.clear();
        // Every beginning moves to its end, which is where the next one began.
        for (i, c) in entries() {
            rows[first[c]] = i;
            moved.push(first[c]);
            first[c] += 1;
        }
        first.rotate_right(1);
        first[0] = 0;
        let pattern = SymbolicSparseColMat::new_unsorted_checked(size, size, first, None, rows);
        let symbolic = factorize_symbolic_cholesky(
            pattern.as_ref(),
            faer::Side::Upper,
            SymmetricOrdering::Identity,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold(SUPERNODAL_RATIO),
                ..CholeskySymbolicParams::default()
            },
        )
        .ok()?;
        own_start.clear();
        own_start.extend_from_slice(start);
        own_index.clear();
        own_index.extend_from_slice(index);
        let operations = operations(&symbolic);
        let (start, index) = (own_start, own_index);
        Some(Ordered { start, index, pattern, moved, order, symbolic, operations })
    }

    /// The memory of one that is no longer needed.
    fn into_memory(self) -> OrderMemory {
        let Ordered { start, index, pattern, moved, order, .. } = self;
        let (_, _, first, _, rows) = pattern.into_parts();
        OrderMemory { order, start, index, first, rows, moved }
    }

    /// Whether it is that of a given pattern.
    fn is_of(&self, start: &[usize], index: &[usize]) -> bool {
        self.start == start && self.index == index
    }

    /// The duration of a factorisation at a rate in operations a second.
    fn duration(&self, rate: f64) -> Duration {
        Duration::try_from_secs_f64(self.operations / rate).unwrap_or(Duration::MAX)
    }

    /// Entries of the factor for each of the pattern's.
    fn fill(&self) -> f64 {
        self.symbolic.len_val() as f64 / self.moved.len().max(1) as f64
    }
}

/// Multiplications of a factorisation: half the squares of the lengths of the factor's columns.
fn operations(symbolic: &SymbolicCholesky<usize>) -> f64 {
    let square = |length: usize| 0.5 * (length as f64).powi(2);
    match symbolic.raw() {
        SymbolicCholeskyRaw::Simplicial(factor) => {
            factor.col_ptr().windows(2).map(|pair| square(pair[1] - pair[0])).sum()
        }
        SymbolicCholeskyRaw::Supernodal(factor) => {
            let blocks = factor.supernode_begin().iter().zip(factor.supernode_end());
            let below = factor.col_ptr_for_row_idx().windows(2).map(|pair| pair[1] - pair[0]);
            let block = |((begin, end), below): ((&usize, &usize), usize)| {
                (0..end - begin).map(|k| square(k + 1 + below)).sum::<f64>()
            };
            blocks.zip(below).map(block).sum()
        }
    }
}
