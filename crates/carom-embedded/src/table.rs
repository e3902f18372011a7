//! The table and its look-up.

use crate::answer::LookupAnswer;
use crate::program::LookupProgram;
use crate::real::LookupNumber;
use crate::simplex::{MOST_CORNERS, Weights};

/// A cell that is cut through the middle of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LookupNode {
    /// The numbers of the corners at the ends of the edge. In the first half, the middle takes the
    /// place of the second corner, and in the second half that of the first one.
    pub edge: [u8; 2],
    /// The halves: later nodes, or leaves with [`LookupTable::LEAF`] added.
    pub next: [u32; 2],
}

/// A cell that is not cut.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LookupLeaf<T> {
    /// Between its corners, inputs are interpolated.
    Plan {
        /// The number of its law among those of the table.
        law: u32,
        /// The most that the law loses, in the unit of the objective; infinite if nothing is
        /// proved.
        loss: T,
    },
    /// The cell gives the integers; a quadratic program is solved for the inputs.
    Solve {
        /// The number of its program among those of the table.
        program: u32,
        /// The most that its optimum loses, in the unit of the objective; infinite if nothing is
        /// proved.
        loss: T,
    },
    /// Proved to have no plan.
    NoPlan,
    /// Not decided.
    Open,
}

/// A table of laws over a box of states, borrowed from constants.
///
/// Tables are written by `carom::explicit`. The fields are public so that a table can be a `const`;
/// [`is_sound`](Self::is_sound) checks at compile time that they fit together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LookupTable<'a, T> {
    /// The lower corner of the box, an entry a state, in the states' units; from 1 to 6 states.
    pub lower: &'a [T],
    /// The upper corner.
    pub upper: &'a [T],
    /// [`LookupNumber::UNITS`] by the length of the side, an entry a state.
    pub scale: &'a [T],
    /// The first cells: nodes or leaves, one for each order of the states in lexicographic order.
    pub roots: &'a [u32],
    /// The cells that are cut; halves come after the whole.
    pub nodes: &'a [LookupNode],
    /// The other cells.
    pub leaves: &'a [LookupLeaf<T>],
    /// The laws, one after the other: for each corner of the cell, the number of its inputs.
    pub laws: &'a [u32],
    /// Inputs at corners, one after the other.
    pub values: &'a [T],
    /// The quadratic programs of the leaves that solve one.
    pub programs: &'a [LookupProgram<T>],
    /// The numbers of the programs, one after the other.
    pub numbers: &'a [T],
    /// The number of inputs of a corner.
    pub inputs: usize,
    /// The most cuts on a way to a leaf.
    pub depth: u32,
}

impl<T> LookupTable<'_, T> {
    /// Added to the numbers of leaves.
    pub const LEAF: u32 = 1 << 31;

    /// Whether all numbers of nodes, leaves, corners, laws and inputs exist, and halves come after
    /// the whole, so that only slices of wrong lengths, or too small a depth, end with
    /// [`LookupAnswer::Damaged`].
    ///
    /// ```
    /// use carom_embedded::{LookupLeaf, LookupTable};
    ///
    /// const TABLE: LookupTable<f32> = LookupTable {
    ///     lower: &[0.0],
    ///     upper: &[1.0],
    ///     scale: &[16777216.0],
    ///     roots: &[LookupTable::<f32>::LEAF],
    ///     nodes: &[],
    ///     leaves: &[LookupLeaf::Plan { law: 0, loss: 0.0 }],
    ///     laws: &[0, 1],
    ///     values: &[0.5, -2.0],
    ///     programs: &[],
    ///     numbers: &[],
    ///     inputs: 1,
    ///     depth: 0,
    /// };
    /// const _: () = assert!(TABLE.is_sound());
    /// ```
    #[must_use]
    pub const fn is_sound(&self) -> bool {
        let states = self.lower.len();
        if states == 0
            || states >= MOST_CORNERS
            || self.upper.len() != states
            || self.scale.len() != states
            || self.inputs == 0
        {
            return false;
        }
        let (mut orders, mut factor) = (1, 2);
        while factor <= states {
            orders *= factor;
            factor += 1;
        }
        if self.roots.len() != orders {
            return false;
        }
        let mut rest = self.roots;
        while let [root, others @ ..] = rest {
            if !self.exists(*root, 0) {
                return false;
            }
            rest = others;
        }
        let mut rest = self.nodes;
        let mut number = 0;
        while let [node, others @ ..] = rest {
            number += 1;
            let [i, j] = node.edge;
            if i as usize > states
                || j as usize > states
                || i == j
                || !self.exists(node.next[0], number)
                || !self.exists(node.next[1], number)
            {
                return false;
            }
            rest = others;
        }
        let (corners, values) = (states + 1, self.values.len() / self.inputs);
        let mut rest = self.leaves;
        while let [leaf, others @ ..] = rest {
            let exists = match leaf {
                LookupLeaf::Plan { law, .. } => (*law as usize) < self.laws.len() / corners,
                LookupLeaf::Solve { program, .. } => (*program as usize) < self.programs.len(),
                LookupLeaf::NoPlan | LookupLeaf::Open => true,
            };
            if !exists {
                return false;
            }
            rest = others;
        }
        let mut rest = self.programs;
        while let [program, others @ ..] = rest {
            if !program.is_sound(self.numbers.len(), states, self.inputs) {
                return false;
            }
            rest = others;
        }
        let mut rest = self.laws;
        while let [value, others @ ..] = rest {
            if *value as usize >= values {
                return false;
            }
            rest = others;
        }
        true
    }

    /// The numbers of work space that [`solve`](Self::solve) takes; 0 without programs.
    #[must_use]
    pub const fn work(&self) -> usize {
        let mut most = 0;
        let mut rest = self.programs;
        while let [program, others @ ..] = rest {
            if program.work(self.inputs) > most {
                most = program.work(self.inputs);
            }
            rest = others;
        }
        most
    }

    /// Whether there is a leaf of this code, or a node that is not before `first`.
    const fn exists(&self, code: u32, first: usize) -> bool {
        match code & Self::LEAF {
            0 => (code as usize) >= first && (code as usize) < self.nodes.len(),
            _ => ((code ^ Self::LEAF) as usize) < self.leaves.len(),
        }
    }
}

/// Where a state is.
struct FoundLeaf<'a, T> {
    leaf: &'a LookupLeaf<T>,
    weights: Weights,
    /// Zero behind the states of the table.
    shares: [T; MOST_CORNERS - 1],
}

impl<T: LookupNumber> LookupTable<'_, T> {
    /// The leaf of a state, the weights of its corners, and the state as shares of the sides of the
    /// box.
    fn find(&self, state: &[T]) -> Result<FoundLeaf<'_, T>, LookupAnswer<T>> {
        let states = self.lower.len();
        let fits = state.len() == states && self.upper.len() == states;
        if !fits || self.scale.len() != states || states >= MOST_CORNERS {
            return Err(LookupAnswer::Damaged);
        }
        let bounds = self.lower.iter().zip(self.upper);
        // Also for NaN.
        if !state.iter().zip(bounds).all(|(x, (lower, upper))| lower <= x && x <= upper) {
            return Err(LookupAnswer::Outside);
        }
        let mut coordinates = [0; MOST_CORNERS - 1];
        let scaled = state.iter().zip(self.lower).zip(self.scale);
        for (coordinate, ((&x, &lower), &scale)) in coordinates.iter_mut().zip(scaled) {
            *coordinate = ((x - lower) * scale).to_units();
        }
        let (mut weights, order) =
            Weights::locate(T::UNITS, coordinates.iter().copied().take(states));
        let mut at = *self.roots.get(order as usize).ok_or(LookupAnswer::Damaged)?;
        for _ in 0..=self.depth {
            if at & Self::LEAF != 0 {
                let number = (at ^ Self::LEAF) as usize;
                let leaf = self.leaves.get(number).ok_or(LookupAnswer::Damaged)?;
                return Ok(FoundLeaf { leaf, weights, shares: coordinates.map(T::share) });
            }
            let node = self.nodes.get(at as usize).ok_or(LookupAnswer::Damaged)?;
            let [first, second] = node.next;
            at = match weights.halve(node.edge) {
                Some(0) => first,
                Some(_) => second,
                None => return Err(LookupAnswer::Damaged),
            };
        }
        Err(LookupAnswer::Damaged)
    }

    /// Looks up the cell of a state and evaluates its law.
    ///
    /// A program with rows needs the work space of [`solve`](Self::solve): without, the answer is
    /// [`LookupAnswer::Damaged`].
    ///
    /// # Arguments
    ///
    /// * `state`: an entry for each state of the table, in its unit.
    /// * `inputs`: where the inputs are written, an entry for each input of the table. They stay as
    ///   they are if the answer has none; if it is [`LookupAnswer::Damaged`], they may be anything.
    ///
    /// # Complexity
    ///
    /// At most `depth` comparisons of whole numbers; for each input, a product for each state and
    /// one more.
    pub fn evaluate(&self, state: &[T], inputs: &mut [T]) -> LookupAnswer<T> {
        self.solve(state, inputs, &mut [])
    }

    /// As [`evaluate`](Self::evaluate), with work space for programs.
    ///
    /// # Arguments
    ///
    /// * `work`: at least [`work`](Self::work) numbers, whose values do not matter.
    ///
    /// # Complexity
    ///
    /// That of `evaluate`; or, for a program, at most its
    /// [`exchanges`](LookupProgram::exchanges), each with at most two passes over its matrix.
    pub fn solve(&self, state: &[T], inputs: &mut [T], work: &mut [T]) -> LookupAnswer<T> {
        let FoundLeaf { leaf, weights, shares } = match self.find(state) {
            Ok(found) => found,
            Err(answer) => return answer,
        };
        if inputs.len() != self.inputs {
            return LookupAnswer::Damaged;
        }
        let (law, loss) = match *leaf {
            LookupLeaf::NoPlan => return LookupAnswer::NoPlan,
            LookupLeaf::Open => return LookupAnswer::Open,
            LookupLeaf::Solve { program, loss } => {
                let program = self.programs.get(program as usize);
                let solved =
                    program.zip(shares.get(..state.len())).and_then(|(program, shares)| {
                        program.solve(self.numbers, shares, inputs, work)
                    });
                return match solved {
                    Some(()) => LookupAnswer::Plan { loss },
                    None => LookupAnswer::Damaged,
                };
            }
            LookupLeaf::Plan { law, loss } => (law as usize, loss),
        };
        let corners = state.len() + 1;
        let law = self.laws.get(law.wrapping_mul(corners)..).and_then(|rest| rest.get(..corners));
        let Some(law) = law else { return LookupAnswer::Damaged };
        let exists = |value: &u32| self.value(*value).is_some();
        if !law.iter().all(exists) {
            return LookupAnswer::Damaged;
        }
        inputs.iter_mut().for_each(|input| *input = T::ZERO);
        for (&value, &weight) in law.iter().zip(&weights.of) {
            let share = T::share(weight);
            // In this order, and without fused operations, as in the C code.
            for (input, &value) in inputs.iter_mut().zip(self.value(value).unwrap_or_default()) {
                *input = *input + share * value;
            }
        }
        LookupAnswer::Plan { loss }
    }

    /// The inputs of a number.
    fn value(&self, number: u32) -> Option<&[T]> {
        let first = (number as usize).wrapping_mul(self.inputs);
        self.values.get(first..).and_then(|rest| rest.get(..self.inputs))
    }

    /// As [`evaluate`](Self::evaluate), with other inputs where the answer has none.
    pub fn evaluate_or(&self, state: &[T], fallback: &[T], inputs: &mut [T]) -> LookupAnswer<T> {
        self.solve_or(state, fallback, inputs, &mut [])
    }

    /// As [`solve`](Self::solve), with other inputs where the answer has none.
    pub fn solve_or(
        &self,
        state: &[T],
        fallback: &[T],
        inputs: &mut [T],
        work: &mut [T],
    ) -> LookupAnswer<T> {
        let answer = self.solve(state, inputs, work);
        if !answer.has_inputs() {
            inputs.iter_mut().zip(fallback).for_each(|(input, &other)| *input = other);
        }
        answer
    }
}
