//! Mixed logical dynamical systems: the binaries are enumerated, the auxiliaries eliminated.

use faer::Mat;

use super::mixed_logical_rows::{Leaf, Rows};
use super::{Halfspace, HybridSystem, Transition};
#[cfg(doc)]
use crate::error::ErrorKind;
use crate::error::{Error, check_length};
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::matrix::{Matrix, faer};
use crate::interval::Interval;

/// The most combinations of binaries that become transitions.
pub(super) const MOST_COMBINATIONS: usize = 4096;

/// A mixed logical dynamical system (A. Bemporad and M. Morari, "Control of systems integrating
/// logic, dynamics, and constraints", Automatica 35, 1999), with constants:
///
/// ```text
/// x⁺ = A x + B1 u + B2 δ + B3 z + B5
/// y = C x + D1 u + D2 δ + D3 z + D5
/// E2 δ + E3 z <= E1 u + E4 x + E5
/// ```
///
/// with states x, outputs y, inputs u, binaries δ and continuous auxiliaries z. Each group of
/// variables is given with its columns of the first and the last line. A binary input is one of the
/// binaries, with its columns of B1 in B2 and of -E1 in E2; the planner chooses it, so declare the
/// choice [free](HybridSystem::expect). A binary state is a state from 0 to 1 that starts and is
/// kept at 0 or 1.
///
/// ```
/// use carom::hybrid::{HybridSystem, MixedLogicalDynamical};
///
/// // x⁺ = 0.8 x + u where x >= 0 and -0.8 x + u elsewhere, as 1.6 z - 0.8 x + u with z = δ x:
/// // -10 (1 - δ) <= x <= 10 δ, -10 δ <= z <= 10 δ, x - 10 (1 - δ) <= z <= x + 10 (1 - δ).
/// let range = -10.0..=10.0;
/// let system = HybridSystem::mixed_logical_dynamical(
///     1.0,
///     &MixedLogicalDynamical::new([0.0], [10.0, 0.0, 0.0, 0.0, 10.0, 10.0])
///         .with_states(
///             [("x", range.clone())],
///             [[-0.8]],
///             [[1.0], [-1.0], [0.0], [0.0], [1.0], [-1.0]],
///         )
///         .with_inputs([("u", -1.0..=1.0)], [[1.0]], [[0.0]; 6])
///         .with_binaries(1, [[0.0]], [[10.0], [-10.0], [-10.0], [-10.0], [10.0], [10.0]])
///         .with_auxiliaries([range], [[1.6]], [[0.0], [0.0], [1.0], [-1.0], [1.0], [-1.0]]),
/// )?;
/// // The two values of δ are two transitions, named by them, and z is gone.
/// let run = system.simulate(&[5.0], &[[-1.0], [-0.5]])?;
/// assert_eq!(run.taken(), [["1"], ["1"]]);
/// assert!((run.last()[0] - 1.9).abs() < 1e-12);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct MixedLogicalDynamical {
    states: Vec<(String, Interval)>,
    inputs: Vec<(String, Interval)>,
    binaries: usize,
    auxiliaries: Vec<Interval>,
    a: Mat<f64>,
    b1: Mat<f64>,
    b2: Mat<f64>,
    b3: Mat<f64>,
    b5: Vec<f64>,
    e1: Mat<f64>,
    e2: Mat<f64>,
    e3: Mat<f64>,
    e4: Mat<f64>,
    e5: Vec<f64>,
    outputs: Vec<String>,
    c: Mat<f64>,
    d: Mat<f64>,
    d5: Vec<f64>,
}

impl MixedLogicalDynamical {
    /// The constants B5, with an entry per state, and E5, with an entry per inequality.
    pub fn new(b5: impl Into<Vec<f64>>, e5: impl Into<Vec<f64>>) -> Self {
        let (b5, e5) = (b5.into(), e5.into());
        let (empty_b, empty_e) = (Mat::zeros(b5.len(), 0), Mat::zeros(e5.len(), 0));
        MixedLogicalDynamical {
            states: Vec::new(),
            inputs: Vec::new(),
            binaries: 0,
            auxiliaries: Vec::new(),
            a: empty_b.clone(),
            b1: empty_b.clone(),
            b2: empty_b.clone(),
            b3: empty_b,
            b5,
            e1: empty_e.clone(),
            e2: empty_e.clone(),
            e3: empty_e.clone(),
            e4: empty_e,
            e5,
            outputs: Vec::new(),
            c: Mat::zeros(0, 0),
            d: Mat::zeros(0, 0),
            d5: Vec::new(),
        }
    }

    /// Names and domains of the states x, finite; A and E4.
    pub fn with_states<S: Into<String>, R: Into<Interval>>(
        mut self,
        states: impl IntoIterator<Item = (S, R)>,
        a: impl Into<Matrix>,
        e4: impl Into<Matrix>,
    ) -> Self {
        self.states = states.into_iter().map(|(name, range)| (name.into(), range.into())).collect();
        (self.a, self.e4) = (faer(a), faer(e4));
        self
    }

    /// Names and ranges of the inputs u, finite; B1 and E1.
    pub fn with_inputs<S: Into<String>, R: Into<Interval>>(
        mut self,
        inputs: impl IntoIterator<Item = (S, R)>,
        b1: impl Into<Matrix>,
        e1: impl Into<Matrix>,
    ) -> Self {
        self.inputs = inputs.into_iter().map(|(name, range)| (name.into(), range.into())).collect();
        (self.b1, self.e1) = (faer(b1), faer(e1));
        self
    }

    /// The number of binaries δ; B2 and E2.
    pub fn with_binaries(
        mut self,
        count: usize,
        b2: impl Into<Matrix>,
        e2: impl Into<Matrix>,
    ) -> Self {
        self.binaries = count;
        (self.b2, self.e2) = (faer(b2), faer(e2));
        self
    }

    /// Ranges of the auxiliaries z, finite; B3 and E3.
    pub fn with_auxiliaries<R: Into<Interval>>(
        mut self,
        ranges: impl IntoIterator<Item = R>,
        b3: impl Into<Matrix>,
        e3: impl Into<Matrix>,
    ) -> Self {
        self.auxiliaries = ranges.into_iter().map(R::into).collect();
        (self.b3, self.e3) = (faer(b3), faer(e3));
        self
    }

    /// The names of the outputs y; C, and `[D1, D2, D3]` with a column per input, binary and
    /// auxiliary; D5. In programs and runs an output has a value per step, by its name.
    ///
    /// ```
    /// use carom::hybrid::{HybridSystem, MixedLogicalDynamical};
    ///
    /// // A heater, on only up to 21 °C (19 δ <= 40 - T): its power is 2 kW.
    /// let room = MixedLogicalDynamical::new([0.5], [40.0])
    ///     .with_states([("temperature", 0.0..=40.0)], [[0.9]], [[-1.0]])
    ///     .with_binaries(1, [[3.0]], [[19.0]])
    ///     .with_outputs(["power"], [[0.0]], [[2.0]], [0.0]);
    /// let room = HybridSystem::mixed_logical_dynamical(60.0, &room)?;
    /// assert!(room.to_string().contains("power = 2"));
    /// # Ok::<(), carom::Error>(())
    /// ```
    pub fn with_outputs<S: Into<String>>(
        mut self,
        names: impl IntoIterator<Item = S>,
        c: impl Into<Matrix>,
        d: impl Into<Matrix>,
        d5: impl Into<Vec<f64>>,
    ) -> Self {
        self.outputs = names.into_iter().map(Into::into).collect();
        (self.c, self.d, self.d5) = (faer(c), faer(d), d5.into());
        self
    }

    fn check(&self) -> Result<(), Error> {
        let (n, rows) = (self.b5.len(), self.e5.len());
        check_length("the states", self.states.len(), n)?;
        let groups = [
            ("the matrix A", &self.a, n, n),
            ("the matrix B1", &self.b1, n, self.inputs.len()),
            ("the matrix B2", &self.b2, n, self.binaries),
            ("the matrix B3", &self.b3, n, self.auxiliaries.len()),
            ("the matrix E1", &self.e1, rows, self.inputs.len()),
            ("the matrix E2", &self.e2, rows, self.binaries),
            ("the matrix E3", &self.e3, rows, self.auxiliaries.len()),
            ("the matrix E4", &self.e4, rows, n),
        ];
        for (what, matrix, rows, columns) in groups {
            super::check::check_matrix(what, matrix, rows, columns)?;
        }
        if !self.outputs.is_empty() {
            let (count, others) = (self.outputs.len(), self.inputs.len() + self.binaries);
            super::check::check_matrix("the matrix C", &self.c, count, n)?;
            let others = others + self.auxiliaries.len();
            super::check::check_matrix("the matrices D1, D2 and D3", &self.d, count, others)?;
            check_length("the constants D5", self.d5.len(), count)?;
        }
        let numbers = self.b5.iter().chain(&self.e5).chain(&self.d5).copied();
        super::check::check_numbers("the constants", "a number", numbers)?;
        let named = self.states.iter().chain(&self.inputs);
        named.clone().try_for_each(|(name, range)| super::check::check_ends(name, *range))?;
        let auxiliary = |range| super::check::check_ends("an auxiliary", range);
        self.auxiliaries.iter().copied().try_for_each(auxiliary)
    }

    /// An output for values of the binaries, over (x, u, z), with the constant last.
    fn output(&self, number: usize, binaries: &[bool]) -> Vec<f64> {
        let (m, z) = (self.inputs.len(), self.auxiliaries.len());
        let d = |j: usize| self.d[(number, j)];
        let states = (0..self.states.len()).map(|j| self.c[(number, j)]);
        let auxiliaries = (0..z).map(|j| d(m + self.binaries + j));
        let on = binaries.iter().enumerate().filter(|(_, on)| **on).map(|(j, _)| d(m + j));
        let constant = self.d5[number] + on.sum::<f64>();
        states.chain((0..m).map(d)).chain(auxiliaries).chain([constant]).collect()
    }

    /// The inequalities over (x, u, z, δ).
    fn rows(&self) -> Rows {
        let (n, m, z) = (self.states.len(), self.inputs.len(), self.auxiliaries.len());
        let row = |i: usize| {
            let states = (0..n).map(|j| -self.e4[(i, j)]);
            let inputs = (0..m).map(|j| -self.e1[(i, j)]);
            let auxiliaries = (0..z).map(|j| self.e3[(i, j)]);
            let binaries = (0..self.binaries).map(|j| self.e2[(i, j)]);
            states.chain(inputs).chain(auxiliaries).chain(binaries).collect()
        };
        let ranges = self.states.iter().chain(&self.inputs).map(|(_, range)| *range);
        Rows {
            rows: (0..self.e5.len()).map(row).collect(),
            limits: self.e5.clone(),
            ranges: ranges.chain(self.auxiliaries.iter().copied()).collect(),
            binaries: self.binaries,
        }
    }
}

impl HybridSystem {
    /// The system, with steps of `time_step` seconds, as one choice whose transitions are the
    /// combinations of binaries that bounds do not exclude, named by their values, as in `010`.
    ///
    /// The inequalities become guards. If they determine all auxiliaries in every combination, as
    /// in the usual encoding of products, the auxiliaries are eliminated. Otherwise they become
    /// inputs `z0`, `z1`, ... after the system's own. Either is exact.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] and [`ErrorKind::Length`] for matrices that do not fit,
    /// [`ErrorKind::OutOfRange`] if no combination of the binaries is possible or more than 4096
    /// are; the errors of [`HybridSystem::check`].
    #[doc(alias = "MLD")]
    pub fn mixed_logical_dynamical(
        time_step: f64,
        mld: &MixedLogicalDynamical,
    ) -> Result<Self, Error> {
        mld.check()?;
        let rows = mld.rows();
        let combinations = rows.combinations(MOST_COMBINATIONS)?;
        let (n, m, z) = (mld.states.len(), mld.inputs.len(), mld.auxiliaries.len());
        let leaves: Vec<Leaf> = combinations.iter().map(|binaries| rows.leaf(binaries)).collect();
        let solved: Option<Vec<_>> = leaves.iter().map(|leaf| leaf.auxiliaries(n + m)).collect();
        let mut system = HybridSystem::new(time_step);
        for (name, domain) in &mld.states {
            system = system.with_state(name, *domain);
        }
        for (name, range) in &mld.inputs {
            system = system.with_input(name, *range);
        }
        if solved.is_none() {
            for (k, range) in mld.auxiliaries.iter().enumerate() {
                system = system.with_input(format!("z{k}"), *range);
            }
        }
        for (k, (binaries, leaf)) in combinations.iter().zip(&leaves).enumerate() {
            let name: String = binaries.iter().map(|&b| if b { '1' } else { '0' }).collect();
            let name = if name.is_empty() { "only".to_owned() } else { name };
            let shift = |i: usize| {
                let on = binaries.iter().enumerate().filter(|(_, on)| **on);
                mld.b5[i] + on.map(|(j, _)| mld.b2[(i, j)]).sum::<f64>()
            };
            let own = |i: usize, j: usize| if j < n { mld.a[(i, j)] } else { mld.b1[(i, j - n)] };
            let (flow, guards) = match solved.as_ref().and_then(|solved| solved.get(k)) {
                Some(solution) => {
                    let part = |i: usize, j: usize| {
                        (0..z).map(|a| mld.b3[(i, a)] * solution[a][j]).sum::<f64>()
                    };
                    let entry = |i: usize, j: usize| own(i, j) + part(i, j);
                    let a = Mat::from_fn(n, n, entry);
                    let b = Mat::from_fn(n, m, |i, j| entry(i, n + j));
                    let c: Vec<f64> = (0..n).map(|i| shift(i) + part(i, n + m)).collect();
                    (LinearSystem::new(a, b, c)?, leaf.without_auxiliaries(&rows, solution, n + m))
                }
                None => {
                    let b = Mat::from_fn(n, m + z, |i, j| {
                        if j < m { mld.b1[(i, j)] } else { mld.b3[(i, j - m)] }
                    });
                    let c: Vec<f64> = (0..n).map(shift).collect();
                    (LinearSystem::new(&mld.a, b, c)?, leaf.needed(&rows))
                }
            };
            let mut transition = Transition::new(name, flow);
            for (number, name) in mld.outputs.iter().enumerate() {
                let mut factors = mld.output(number, binaries);
                let mut constant = factors.pop().unwrap_or(0.0);
                if let Some(solution) = solved.as_ref().and_then(|solved| solved.get(k)) {
                    for (factor, own) in factors.split_off(n + m).into_iter().zip(solution) {
                        factors.iter_mut().zip(own).for_each(|(sum, own)| *sum += factor * own);
                        constant += factor * own.last().copied().unwrap_or(0.0);
                    }
                }
                transition = transition.with_start_output(name, factors, constant);
            }
            for (row, normal, limit) in guards {
                let name = format!("inequality {row}");
                transition = transition.with_guard(Halfspace::new(name, normal, limit));
            }
            system = system.with_transition(transition);
        }
        system.check()?;
        Ok(system)
    }
}
