//! Which columns equations determine, by their pattern, and in which order.

use super::equations::{ColumnKind, Equations};

/// The largest number of columns that are determined together.
const MAX_BLOCK: usize = 128;

/// Most visits of terms in the search for a largest matching, as a multiple of the terms.
const MATCHING_WORK: usize = 20;

const UNMATCHED: usize = usize::MAX;

/// Columns that are determined together by as many equations.
#[derive(Debug, Clone, Default)]
pub(crate) struct DeterminedBlock {
    /// The rows of the program.
    pub(crate) rows: Vec<usize>,
    pub(crate) columns: Vec<usize>,
    /// The positions of the rows among the equations.
    pub(super) equations: Vec<usize>,
}

/// The pattern of some equations: which unknown columns they have.
pub(super) struct Structure<'a> {
    equations: &'a Equations,
    /// By column: where its equations begin; the end of all.
    start: Vec<usize>,
    uses: Vec<usize>,
    /// By column: whether it is still unknown.
    unknown: Vec<bool>,
    /// By equation: the number of its unknown columns.
    open: Vec<usize>,
    blocks: Vec<DeterminedBlock>,
}

impl<'a> Structure<'a> {
    pub(super) fn new(
        columns: usize,
        equations: &'a Equations,
        kind: impl Fn(usize) -> ColumnKind,
    ) -> Self {
        let unknown: Vec<bool> = (0..columns).map(|j| kind(j) == ColumnKind::Unknown).collect();
        let (mut start, mut open) = (vec![0; columns + 1], vec![0; equations.len()]);
        for (e, open) in open.iter_mut().enumerate() {
            for &(j, _) in equations.terms(e).iter().filter(|(j, _)| unknown[*j]) {
                start[j + 1] += 1;
                *open += 1;
            }
        }
        (0..columns).for_each(|j| start[j + 1] += start[j]);
        let (mut next, mut uses) = (start.clone(), vec![0; start[columns]]);
        for e in 0..equations.len() {
            for &(j, _) in equations.terms(e).iter().filter(|(j, _)| unknown[*j]) {
                uses[next[j]] = e;
                next[j] += 1;
            }
        }
        Structure { equations, start, uses, unknown, open, blocks: Vec::new() }
    }

    /// The determined columns, in the order of their computation.
    pub(super) fn order(mut self) -> Vec<DeterminedBlock> {
        self.cascade();
        if let Some(matched) = self.largest_matching() {
            self.take_square_part(&matched);
        }
        self.blocks
    }

    fn uses(&self, column: usize) -> &[usize] {
        &self.uses[self.start[column]..self.start[column + 1]]
    }

    fn unknown_columns(&self, equation: usize) -> impl Iterator<Item = usize> + '_ {
        self.equations.terms(equation).iter().map(|&(j, _)| j).filter(|&j| self.unknown[j])
    }

    /// Takes columns that are the only unknown one of an equation, as long as there are any.
    fn cascade(&mut self) {
        let mut ready: Vec<usize> = (0..self.open.len()).filter(|&e| self.open[e] == 1).collect();
        ready.reverse();
        while let Some(equation) = ready.pop() {
            let Some(column) = self.unknown_columns(equation).next() else { continue };
            self.unknown[column] = false;
            for k in self.start[column]..self.start[column + 1] {
                let other = self.uses[k];
                self.open[other] -= 1;
                if self.open[other] == 1 {
                    ready.push(other);
                }
            }
            let (equations, columns) = (vec![equation], vec![column]);
            self.blocks.push(DeterminedBlock { rows: Vec::new(), columns, equations });
        }
    }

    /// A largest matching of equations and their unknown columns: by equation its column. Columns
    /// with one equation left and equations with one column left go first, which is never wrong
    /// (Karp and Sipser, 1981). `None` where it takes too long.
    fn largest_matching(&self) -> Option<Matching> {
        let columns = self.unknown.len();
        let mut matching = Matching {
            column: vec![UNMATCHED; self.open.len()],
            equation: vec![UNMATCHED; columns],
        };
        let mut left: Vec<usize> =
            (0..columns).map(|j| if self.unknown[j] { self.uses(j).len() } else { 0 }).collect();
        let mut single: Vec<usize> = (0..columns).filter(|&j| left[j] == 1).collect();
        for first in 0..=self.open.len() {
            while let Some(column) = single.pop() {
                let free = |e: &&usize| matching.column[**e] == UNMATCHED;
                if matching.equation[column] == UNMATCHED
                    && let Some(&equation) = self.uses(column).iter().find(free)
                {
                    self.pair(&mut matching, equation, column, &mut left, &mut single);
                }
            }
            if first == self.open.len() || matching.column[first] != UNMATCHED {
                continue;
            }
            let free = self.unknown_columns(first).filter(|&j| matching.equation[j] == UNMATCHED);
            if let Some(column) = free.min_by_key(|&j| left[j]) {
                self.pair(&mut matching, first, column, &mut left, &mut single);
            }
        }
        let mut work = MATCHING_WORK * self.uses.len() + 1000;
        for equation in 0..self.open.len() {
            if self.open[equation] > 0 && matching.column[equation] == UNMATCHED {
                self.augment(&mut matching, equation, &mut work)?;
            }
        }
        Some(matching)
    }

    fn pair(
        &self,
        matching: &mut Matching,
        equation: usize,
        column: usize,
        left: &mut [usize],
        single: &mut Vec<usize>,
    ) {
        (matching.column[equation], matching.equation[column]) = (column, equation);
        for j in self.unknown_columns(equation) {
            left[j] -= 1;
            if left[j] == 1 && matching.equation[j] == UNMATCHED {
                single.push(j);
            }
        }
    }

    /// Looks for a path along which one more equation gets a column; `None` where no work is left.
    fn augment(&self, matching: &mut Matching, from: usize, work: &mut usize) -> Option<()> {
        // By equation that was reached: the column through which.
        let mut through = std::collections::BTreeMap::from([(from, UNMATCHED)]);
        let mut queue = vec![from];
        let mut next = 0;
        while let Some(&equation) = queue.get(next) {
            next += 1;
            for column in self.unknown_columns(equation) {
                *work = work.checked_sub(1)?;
                let other = matching.equation[column];
                if other == UNMATCHED {
                    // Every equation on the way gets the column through which the next one was
                    // reached.
                    let (mut equation, mut column) = (equation, column);
                    loop {
                        let before = matching.column[equation];
                        matching.column[equation] = column;
                        matching.equation[column] = equation;
                        if equation == from {
                            return Some(());
                        }
                        column = before;
                        equation = *through.get(&equation)?;
                    }
                }
                if let std::collections::btree_map::Entry::Vacant(entry) = through.entry(other) {
                    entry.insert(equation);
                    queue.push(other);
                }
            }
        }
        Some(())
    }

    /// Takes the columns that no unmatched column reaches, a strong component at a time.
    fn take_square_part(&mut self, matching: &Matching) {
        let columns = self.unknown.len();
        let mut reached: Vec<bool> =
            (0..columns).map(|j| self.unknown[j] && matching.equation[j] == UNMATCHED).collect();
        let mut stack: Vec<usize> = (0..columns).filter(|&j| reached[j]).collect();
        while let Some(column) = stack.pop() {
            for &equation in self.uses(column) {
                let other = matching.column[equation];
                if other != UNMATCHED && !reached[other] {
                    reached[other] = true;
                    stack.push(other);
                }
            }
        }
        let inside = |e: &usize| {
            let column = matching.column[*e];
            column != UNMATCHED && !reached[column]
        };
        let roots: Vec<usize> = (0..self.open.len()).filter(inside).collect();
        let components = self.components(matching, &roots);
        for mut equations in components {
            equations.sort_unstable();
            let own: Vec<usize> = equations.iter().map(|&e| matching.column[e]).collect();
            let is_own = |&e: &usize| self.unknown_columns(e).all(|j| own.contains(&j));
            if own.len() <= MAX_BLOCK && equations.iter().all(is_own) {
                for &column in &own {
                    self.unknown[column] = false;
                }
                self.blocks.push(DeterminedBlock { rows: Vec::new(), columns: own, equations });
            }
        }
    }

    /// The strong components of equations, where each needs those that are matched to its other
    /// columns; what is needed comes first (Tarjan 1972, without recursion).
    fn components(&self, matching: &Matching, roots: &[usize]) -> Vec<Vec<usize>> {
        let count = self.open.len();
        let (mut index, mut lowest) = (vec![UNMATCHED; count], vec![0; count]);
        let (mut on_stack, mut stack) = (vec![false; count], Vec::new());
        let (mut found, mut counter) = (Vec::new(), 0);
        for &root in roots {
            if index[root] != UNMATCHED {
                continue;
            }
            // Equations on the way, and the next term of each.
            let mut way = vec![(root, 0)];
            while let Some((equation, next)) = way.pop() {
                if next == 0 {
                    (index[equation], lowest[equation]) = (counter, counter);
                    counter += 1;
                    stack.push(equation);
                    on_stack[equation] = true;
                }
                let terms = self.equations.terms(equation);
                let needed = |&(j, _): &(usize, f64)| match self.unknown[j] {
                    true => Some(matching.equation[j]).filter(|&e| e != UNMATCHED && e != equation),
                    false => None,
                };
                let mut place = next;
                let mut deeper = None;
                while let Some(term) = terms.get(place) {
                    place += 1;
                    let Some(other) = needed(term) else { continue };
                    if index[other] == UNMATCHED {
                        deeper = Some(other);
                        break;
                    }
                    if on_stack[other] {
                        lowest[equation] = lowest[equation].min(index[other]);
                    }
                }
                if let Some(other) = deeper {
                    way.push((equation, place));
                    way.push((other, 0));
                    continue;
                }
                if lowest[equation] == index[equation] {
                    let mut component = Vec::new();
                    while let Some(other) = stack.pop() {
                        on_stack[other] = false;
                        component.push(other);
                        if other == equation {
                            break;
                        }
                    }
                    found.push(component);
                }
                if let Some(&(above, _)) = way.last() {
                    lowest[above] = lowest[above].min(lowest[equation]);
                }
            }
        }
        found
    }
}

/// Pairs of equations and columns.
struct Matching {
    /// By equation.
    column: Vec<usize>,
    /// By column.
    equation: Vec<usize>,
}
