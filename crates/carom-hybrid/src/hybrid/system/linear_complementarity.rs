//! Linear complementarity systems: forces that act only where a gap is closed.

use super::HybridSystem;
use super::check::check_matrix;
use super::handles::Input;
use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::hybrid::matrix::{Matrix, faer};
use crate::interval::Interval;
use crate::model::Affine;

/// A linear complementarity system (A. Aydinoglu, A. Wei, M. Posa, "Consensus complementarity
/// control for multi-contact MPC", arXiv:2304.11259):
///
/// ```text
/// x⁺ = A x + B u + D λ + d
/// 0 <= λ ⟂ E x + F λ + H u + c >= 0
/// ```
///
/// with states x, inputs u and forces λ: of each force and its gap, the row of the second line, one
/// is 0. Each group of variables is given with its columns of both lines.
///
/// ```
/// use carom::hybrid::LinearComplementarity;
/// use carom::prelude::*;
///
/// // A cart of 1 kg, in steps of 0.05 s, before a soft wall at 1 m of 100 N/m:
/// // 0 <= λ ⟂ λ / 100 + 1 - x >= 0.
/// let (h, most) = (0.05, -2.0..=2.0);
/// let system = HybridSystem::linear_complementarity(
///     h,
///     &LinearComplementarity::new([0.0, 0.0], [1.0])
///         .with_states([("x", most.clone()), ("v", most)], [[1.0, h], [0.0, 1.0]], [[-1.0, 0.0]])
///         .with_inputs([("push", -1.0..=1.0)], [[0.0], [h]], [[0.0]])
///         .with_forces([("wall", 100.0)], [[0.0], [-h]], [[0.01]]),
/// )?;
/// let (x, wall) = (system.state_named("x")?, system.input_named("wall")?);
/// let v = system.state_named("v")?;
/// let mut program = system.program(12)?;
/// program.start([x.equals(0.8), v.equals(1.0)])?;
/// program.minimize(program.end(v)?)?;
/// let plan = program.solve(&mut BranchAndBound::default())?;
/// // It is pushed back while it is in the wall.
/// let (x, wall) = (plan.values(x)?, plan.values(wall)?);
/// assert!((0..12).all(|t| (wall[t] - 100.0 * (x[t] - 1.0).max(0.0)).abs() < 1e-5));
/// assert!(wall.iter().any(|force| *force > 1.0));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[must_use]
pub struct LinearComplementarity {
    states: Vec<(String, Interval)>,
    inputs: Vec<(String, Interval)>,
    forces: Vec<(String, f64)>,
    a: faer::Mat<f64>,
    b: faer::Mat<f64>,
    d: faer::Mat<f64>,
    shift: Vec<f64>,
    e: faer::Mat<f64>,
    f: faer::Mat<f64>,
    h: faer::Mat<f64>,
    c: Vec<f64>,
}

impl LinearComplementarity {
    /// The constants d, with an entry per state, and c, with an entry per force.
    pub fn new(d: impl Into<Vec<f64>>, c: impl Into<Vec<f64>>) -> Self {
        let (shift, c) = (d.into(), c.into());
        let (next, gap) = (faer::Mat::zeros(shift.len(), 0), faer::Mat::zeros(c.len(), 0));
        LinearComplementarity {
            states: Vec::new(),
            inputs: Vec::new(),
            forces: Vec::new(),
            a: next.clone(),
            b: next.clone(),
            d: next,
            shift,
            e: gap.clone(),
            f: gap.clone(),
            h: gap,
            c,
        }
    }

    /// Names and domains of the states x, finite; A and E.
    pub fn with_states<S: Into<String>, R: Into<Interval>>(
        mut self,
        states: impl IntoIterator<Item = (S, R)>,
        a: impl Into<Matrix>,
        e: impl Into<Matrix>,
    ) -> Self {
        self.states = states.into_iter().map(|(name, range)| (name.into(), range.into())).collect();
        (self.a, self.e) = (faer(a), faer(e));
        self
    }

    /// Names and ranges of the inputs u, finite; B and H.
    pub fn with_inputs<S: Into<String>, R: Into<Interval>>(
        mut self,
        inputs: impl IntoIterator<Item = (S, R)>,
        b: impl Into<Matrix>,
        h: impl Into<Matrix>,
    ) -> Self {
        self.inputs = inputs.into_iter().map(|(name, range)| (name.into(), range.into())).collect();
        (self.b, self.h) = (faer(b), faer(h));
        self
    }

    /// Names of the forces λ with the most that each can be, finite; D and F.
    pub fn with_forces<S: Into<String>>(
        mut self,
        forces: impl IntoIterator<Item = (S, f64)>,
        d: impl Into<Matrix>,
        f: impl Into<Matrix>,
    ) -> Self {
        self.forces = forces.into_iter().map(|(name, most)| (name.into(), most)).collect();
        (self.d, self.f) = (faer(d), faer(f));
        self
    }

    fn check(&self) -> Result<(), Error> {
        let (n, k) = (self.shift.len(), self.c.len());
        check_length("the states", self.states.len(), n)?;
        check_length("the forces", self.forces.len(), k)?;
        let m = self.inputs.len();
        let matrices = [
            ("the matrix A", &self.a, n, n),
            ("the matrix B", &self.b, n, m),
            ("the matrix D", &self.d, n, k),
            ("the matrix E", &self.e, k, n),
            ("the matrix F", &self.f, k, k),
            ("the matrix H", &self.h, k, m),
        ];
        for (what, matrix, rows, columns) in matrices {
            // Without inputs, B and H need not be given.
            if !(columns == 0 && matrix.ncols() == 0) {
                check_matrix(what, matrix, rows, columns)?;
            }
        }
        let constants = self.shift.iter().chain(&self.c).copied();
        check_finite("the system", "a constant", constants)
    }
}

impl HybridSystem {
    /// A linear complementarity system, with steps of `time_step` seconds. The forces are inputs,
    /// after the others, and each of them is a choice with its name: `free` without force, and
    /// `pressed` with a closed gap, as by [`complementarity`](HybridSystem::complementarity).
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] and [`ErrorKind::Length`] for matrices that do not fit; the errors of
    /// [`HybridSystem::check`].
    pub fn linear_complementarity(
        time_step: f64,
        stated: &LinearComplementarity,
    ) -> Result<Self, Error> {
        stated.check()?;
        let mut system = HybridSystem::new(time_step);
        let states = stated.states.iter().map(|(name, r)| system.state(name, r.lower, r.upper));
        let states = states.collect::<Result<Vec<_>, _>>()?;
        let inputs = stated.inputs.iter().map(|(name, r)| system.input(name, r.lower, r.upper));
        let inputs = inputs.collect::<Result<Vec<_>, _>>()?;
        let forces = stated.forces.iter().map(|(name, most)| system.input(name, 0.0, *most));
        let forces = forces.collect::<Result<Vec<_>, _>>()?;
        let row = |i: usize, of: [&faer::Mat<f64>; 3], constant: f64| -> Affine {
            let [x, u, f] = of;
            let mut sum = Affine::constant(constant);
            states.iter().enumerate().for_each(|(j, state)| sum += x[(i, j)] * state);
            inputs.iter().enumerate().for_each(|(j, input)| sum += u[(i, j)] * input);
            forces.iter().enumerate().for_each(|(j, force)| sum += f[(i, j)] * force);
            sum
        };
        let next = states
            .iter()
            .enumerate()
            .map(|(i, state)| (*state, row(i, [&stated.a, &stated.b, &stated.d], stated.shift[i])));
        system.next(next.collect::<Vec<_>>())?;
        for (i, ((name, _), force)) in stated.forces.iter().zip(&forces).enumerate() {
            let gap = row(i, [&stated.e, &stated.h, &stated.f], stated.c[i]);
            system.complementarity(name, *force, gap)?;
        }
        system.check()?;
        Ok(system)
    }

    /// Adds a complementarity `0 <= force ⟂ gap >= 0`: a choice with the mode `free`, in which the
    /// force is 0, and the mode `pressed`, in which the gap is. The common flow says what the force
    /// does.
    ///
    /// ```
    /// use carom::prelude::*;
    ///
    /// // A cart of 1 kg between two soft walls at ±1 m, of 100 N/m.
    /// let mut cart = HybridSystem::new(0.05); // s
    /// let x = cart.state("x", -2.0, 2.0)?; // m
    /// let v = cart.state("v", -3.0, 3.0)?; // m/s
    /// let u = cart.input("push", -1.0, 1.0)?; // N
    /// let [left, right] = [cart.input("left", 0.0, 100.0)?, cart.input("right", 0.0, 100.0)?];
    /// cart.rates([x.is(v), v.is(u + left - right)])?;
    /// cart.complementarity("left", left, 0.01 * left + 1.0 + x)?;
    /// cart.complementarity("right", right, 0.01 * right + 1.0 - x)?;
    /// let (start, goal) = ([x.equals(0.9), v.equals(1.0)], [x.equals(0.0), v.within(-0.1, 0.1)]);
    /// let found = cart.shortest(start, goal, &mut BranchAndBound::default())?;
    /// assert_eq!(found.steps, Some(35));
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `force`: an input whose range begins at 0.
    /// * `gap`: a function of states, inputs and series, of the force itself too.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for another force or another gap; [`ErrorKind::DuplicateName`];
    /// [`ErrorKind::ForeignHandle`].
    #[doc(alias("LCP", "contact force"))]
    pub fn complementarity(
        &mut self,
        name: &str,
        force: Input,
        gap: impl Into<Affine>,
    ) -> Result<(), Error> {
        let gap = gap.into();
        if self.flow.is_none() {
            let (name, place) = (format!("`{name}`"), "a system without a common flow".to_owned());
            let help =
                "state the flow, with the force in it, by `rates` or `next` of the system first";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        self.mode_of(name, "free")?.guard(force.le(0.0))?.guard_or_never(gap.ge(0.0))?;
        self.mode_of(name, "pressed")?.guard_or_never(gap.equals(0.0))?;
        Ok(())
    }
}
