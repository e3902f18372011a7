//! Facts: the rows of a program, and those that a proof has derived from them.

use crate::program::Program;

/// Sums of whole numbers below this are exact (no unit).
pub(super) const LARGEST_EXACT: f64 = (1_u64 << 50) as f64;

/// Linear rows `lower <= terms <= upper`, numbered as in the log.
#[derive(Debug, Default)]
pub(super) struct Facts {
    start: Vec<usize>,
    column: Vec<u32>,
    value: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// Whether all numbers of a fact are whole, and not large.
    is_whole: Vec<bool>,
    /// By column, the facts that it is in.
    of_column: Vec<Vec<u32>>,
    /// By function of the program, its columns: the result first.
    functions: Vec<Vec<usize>>,
}

/// The numbers from here on stand for functions, where those below are facts.
const FIRST_FUNCTION: u32 = 1 << 31;

/// The number of places in a function: its result and up to two arguments.
const FUNCTION_PLACES: u32 = 3;

/// The source of a bound that is derived.
#[derive(Debug, Clone, Copy)]
pub(super) enum BoundSource {
    /// A row.
    Fact(usize),
    /// A function of the program, and the place of the column in it.
    Function(usize, usize),
}

impl BoundSource {
    pub(super) fn from_code(code: u32) -> Self {
        match code.checked_sub(FIRST_FUNCTION) {
            None => BoundSource::Fact(code as usize),
            Some(own) => BoundSource::Function(
                (own / FUNCTION_PLACES) as usize,
                (own % FUNCTION_PLACES) as usize,
            ),
        }
    }

    pub(super) fn code(self) -> u32 {
        match self {
            BoundSource::Fact(fact) => fact as u32,
            BoundSource::Function(function, place) => {
                FIRST_FUNCTION + function as u32 * FUNCTION_PLACES + place as u32
            }
        }
    }
}

/// Whether a number is whole, and below [`LARGEST_EXACT`].
pub(super) fn is_whole(value: f64) -> bool {
    value == value.round() && value.abs() < LARGEST_EXACT
}

impl Facts {
    /// The rows of a program.
    pub(super) fn new(program: &Program) -> Self {
        let of_column = vec![Vec::new(); program.column_count()];
        let mut facts = Facts { start: vec![0], of_column, ..Facts::default() };
        for row in 0..program.row_count() {
            let (columns, values) = program.row(row);
            let limits = [program.row_lower[row], program.row_upper[row]];
            facts.push(columns.iter().copied().zip(values.iter().copied()), limits);
        }
        facts
    }

    /// Adds a fact, and returns its number.
    pub(super) fn push(
        &mut self,
        terms: impl Iterator<Item = (usize, f64)>,
        [lower, upper]: [f64; 2],
    ) -> usize {
        let number = self.len();
        let mut all_whole = [lower, upper].iter().all(|v| v.is_infinite() || is_whole(*v));
        for (column, value) in terms.filter(|(_, value)| *value != 0.0) {
            all_whole &= is_whole(value);
            self.column.push(column as u32);
            self.value.push(value);
            self.of_column[column].push(number as u32);
        }
        self.start.push(self.column.len());
        self.lower.push(lower);
        self.upper.push(upper);
        self.is_whole.push(all_whole);
        number
    }

    /// Forgets the facts from a number on.
    pub(super) fn truncate(&mut self, count: usize) {
        for number in count..self.len() {
            for k in self.start[number]..self.start[number + 1] {
                let of_column = &mut self.of_column[self.column[k] as usize];
                of_column.retain(|&fact| (fact as usize) < count);
            }
        }
        let entries = self.start[count];
        self.start.truncate(count + 1);
        self.column.truncate(entries);
        self.value.truncate(entries);
        self.lower.truncate(count);
        self.upper.truncate(count);
        self.is_whole.truncate(count);
    }

    /// Names the columns of the functions of a program.
    #[cfg(feature = "nonlinear")]
    pub(super) fn set_functions(&mut self, functions: Vec<Vec<usize>>) {
        self.functions = functions;
    }

    /// The columns whose bounds a bound of a function rests on.
    pub(super) fn function_needs(&self, function: usize, place: usize) -> Vec<usize> {
        let columns = &self.functions[function];
        let others = columns.iter().enumerate().filter(|(k, _)| *k != place);
        // A bound of the only argument rests on its other bound, too.
        let own = columns.get(place).filter(|_| columns.len() == 2 && place == 1);
        others.map(|(_, column)| *column).chain(own.copied()).collect()
    }

    pub(super) fn len(&self) -> usize {
        self.lower.len()
    }

    /// Columns and coefficients of a fact.
    pub(super) fn terms(&self, fact: usize) -> impl ExactSizeIterator<Item = (usize, f64)> + '_ {
        let range = self.start[fact]..self.start[fact + 1];
        let columns = self.column[range.clone()].iter().map(|&j| j as usize);
        columns.zip(self.value[range].iter().copied())
    }

    /// Its limits.
    pub(super) fn limits(&self, fact: usize) -> [f64; 2] {
        [self.lower[fact], self.upper[fact]]
    }

    /// Whether all its coefficients and limits are whole, and below [`LARGEST_EXACT`].
    pub(super) fn is_whole(&self, fact: usize) -> bool {
        self.is_whole[fact]
    }

    /// Gives a fact other limits.
    pub(super) fn set_limits(&mut self, fact: usize, [lower, upper]: [f64; 2]) {
        (self.lower[fact], self.upper[fact]) = (lower, upper);
        self.is_whole[fact] &= [lower, upper].iter().all(|v| v.is_infinite() || is_whole(*v));
    }

    /// The facts that a column is in.
    pub(super) fn of_column(&self, column: usize) -> &[u32] {
        &self.of_column[column]
    }
}
