//! The cost of a run, as data.

use faer::Mat;

use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::hybrid::matrix::IntoMatrix;
use crate::hybrid::system::{HybridSystem, Schedule};

/// How deviations are measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Norm {
    /// `e' W e`.
    Squares,
    /// The sum of the magnitudes of `W e`.
    Sum,
    /// The largest magnitude of an entry of `W e`.
    Largest,
}

/// The cost of a run: of the deviations of states and inputs from references in each step, of the
/// last sample, and of transitions.
///
/// With steps 0, ..., τ-1, each step costs its deviations at its start, `x(t)` and `u(t)`. The last
/// sample, `x(τ)`, costs nothing unless there is a [terminal cost](Cost::with_terminal).
///
/// Add it to a program with [`HybridProgram::add_cost`](super::super::HybridProgram::add_cost).
///
/// ```
/// use carom::hybrid::{Cost, Horizon, HybridSystem, LinearSystem, Lqr, Region, Transition, When};
/// use carom::interval::Interval;
/// use carom::prelude::*;
///
/// let line = LinearSystem::double_integrator(0.5)?;
/// let (q, r) = ([[1.0, 0.0], [0.0, 0.1]], [[0.2]]);
/// let lqr = Lqr::new(&line, q, r)?;
/// let system = HybridSystem::new()
///     .with_state("x", Interval::new(-9.0, 9.0))
///     .with_state("v", Interval::new(-9.0, 9.0))
///     .with_input("a", Interval::new(-4.0, 4.0))
///     .with_transition(Transition::new("drive", line));
///
/// let mut model = Model::new("m");
/// let program = system.write(&mut model, "", &Horizon::new(8, 0.5)?)?;
/// program.require(&mut model, "start", &Region::point([2.0, 0.0]), When::At(0))?;
/// let cost = Cost::quadratic(q, r).with_terminal(&lqr.cost);
/// let cost = program.add_cost(&mut model, "cost", &cost)?;
/// model.minimize(cost)?;
/// let solution = BranchAndBound::default().solve(&model)?;
/// // No limit is active, so 8 steps and the terminal cost are as good as infinitely many steps.
/// let infinite = 4.0 * lqr.cost[(0, 0)];
/// assert!((solution.objective().unwrap_or(0.0) - infinite).abs() < 1e-5);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[must_use = "a cost does nothing until it is added to a program"]
pub struct Cost {
    pub(super) norm: Norm,
    pub(super) states: Mat<f64>,
    pub(super) inputs: Mat<f64>,
    pub(super) terminal: Option<Mat<f64>>,
    pub(super) state_reference: Option<Schedule<Vec<f64>>>,
    pub(super) input_reference: Option<Schedule<Vec<f64>>>,
    /// Choice, transition, cost.
    pub(super) transitions: Vec<(String, String, f64)>,
}

impl Cost {
    fn new(norm: Norm, states: impl IntoMatrix, inputs: impl IntoMatrix) -> Self {
        Cost {
            norm,
            states: states.into_matrix(),
            inputs: inputs.into_matrix(),
            terminal: None,
            state_reference: None,
            input_reference: None,
            transitions: Vec::new(),
        }
    }

    /// `(x - x_r)' Q (x - x_r) + (u - u_r)' R (u - u_r)` in each step; without a factor 1/2.
    ///
    /// # Arguments
    ///
    /// * `q`: n x n for n states; `r`: m x m for m inputs. A cost that is minimised must be convex,
    ///   so both must be positive semidefinite; the model checks that.
    pub fn quadratic(q: impl IntoMatrix, r: impl IntoMatrix) -> Self {
        Cost::new(Norm::Squares, q, r)
    }

    /// `|Q (x - x_r)|₁ + |R (u - u_r)|₁` in each step: sums of magnitudes.
    ///
    /// # Arguments
    ///
    /// * `q`: one column per state and any number of rows; `r`: one column per input.
    pub fn one_norm(q: impl IntoMatrix, r: impl IntoMatrix) -> Self {
        Cost::new(Norm::Sum, q, r)
    }

    /// `|Q (x - x_r)|∞ + |R (u - u_r)|∞` in each step: the largest magnitudes.
    ///
    /// # Arguments
    ///
    /// As for [`one_norm`](Cost::one_norm).
    pub fn infinity_norm(q: impl IntoMatrix, r: impl IntoMatrix) -> Self {
        Cost::new(Norm::Largest, q, r)
    }

    /// Lets the last sample cost its deviation too, measured in the same way as the others; for a
    /// quadratic cost, `(x - x_r)' P (x - x_r)`.
    ///
    /// # Arguments
    ///
    /// * `p`: as the weight of the states. The one of a [regulator](super::super::Lqr::cost)
    ///   stands for all steps after the horizon.
    pub fn with_terminal(mut self, p: impl IntoMatrix) -> Self {
        self.terminal = Some(p.into_matrix());
        self
    }

    /// Sets the reference of the states, by sample; 0 by default. One entry per state, in its unit.
    pub fn with_state_reference(mut self, reference: impl Into<Schedule<Vec<f64>>>) -> Self {
        self.state_reference = Some(reference.into());
        self
    }

    /// Sets the reference of the inputs, by step; 0 by default. One entry per input, in its unit.
    pub fn with_input_reference(mut self, reference: impl Into<Schedule<Vec<f64>>>) -> Self {
        self.input_reference = Some(reference.into());
        self
    }

    /// Lets each step that takes a transition of a choice cost something.
    pub fn with_transition_cost(
        mut self,
        choice: impl Into<String>,
        transition: impl Into<String>,
        cost: f64,
    ) -> Self {
        self.transitions.push((choice.into(), transition.into(), cost));
        self
    }

    /// The cost as it is from a step on: references that depend on the step are those of that step at
    /// step 0. For the programs of a [moving horizon](crate::hybrid::RecedingHorizon::moving).
    pub fn from_step(mut self, step: usize) -> Self {
        self.state_reference = self.state_reference.map(|reference| reference.from_step(step));
        self.input_reference = self.input_reference.map(|reference| reference.from_step(step));
        self
    }

    /// Refuses costs that do not fit a system.
    pub(super) fn check(&self, system: &HybridSystem) -> Result<(), Error> {
        let (n, m) = (system.states.len(), system.inputs.len());
        let square = self.norm == Norm::Squares;
        check_weight("the weight of the states", &self.states, n, square)?;
        if self.inputs.nrows() > 0 {
            check_weight("the weight of the inputs", &self.inputs, m, square)?;
        } else if m > 0 {
            return shape("the weight of the inputs", &self.inputs, format!("{m} columns"));
        }
        if let Some(terminal) = &self.terminal {
            check_weight("the weight of the last sample", terminal, n, square)?;
        }
        for (what, reference, length) in [
            ("the reference of the states", &self.state_reference, n),
            ("the reference of the inputs", &self.input_reference, m),
        ] {
            let Some(reference) = reference else { continue };
            reference.check(what)?;
            for values in reference.values() {
                check_length(what, values.len(), length)?;
                check_finite(what, "an entry", values.iter().copied())?;
            }
        }
        for (_, transition, cost) in &self.transitions {
            check_finite(transition, "the cost", [*cost])?;
        }
        Ok(())
    }
}

fn shape(what: &'static str, matrix: &Mat<f64>, expected: String) -> Result<(), Error> {
    let (rows, columns) = (matrix.nrows(), matrix.ncols());
    Err(ErrorKind::Shape { what, rows, columns, expected }.into())
}

fn check_weight(
    what: &'static str,
    weight: &Mat<f64>,
    size: usize,
    square: bool,
) -> Result<(), Error> {
    if square && (weight.nrows() != size || weight.ncols() != size) {
        return shape(what, weight, format!("{size}x{size}"));
    }
    if weight.ncols() != size {
        return shape(what, weight, format!("{size} columns"));
    }
    let index = (0..weight.nrows()).flat_map(|i| (0..size).map(move |j| (i, j)));
    check_finite(what, "an entry", index.map(|index| weight[index]))
}
