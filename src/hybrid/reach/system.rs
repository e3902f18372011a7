//! Hybrid systems for reach sets: linear steps with bounded inputs, guards and resets.

use faer::Mat;

use crate::error::{Error, ErrorKind, check_finite, check_length};
use crate::hybrid::linear::LinearSystem;
use crate::interval::Interval;
use crate::tolerance::INFINITE;

/// A named half-space `normal . state <= limit`.
///
/// ```
/// use carom::hybrid::reach::Halfspace;
///
/// // x + 0.5 v <= 3.
/// let brake = Halfspace::new("braking distance", [1.0, 0.5], 3.0);
/// assert_eq!(brake.limit, 3.0);
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Halfspace {
    /// Its description, which explanations quote if it empties a set.
    pub name: String,
    /// One coefficient per state, in the limit's unit per unit of the state.
    pub normal: Vec<f64>,
    /// The limit, in any unit you choose.
    pub limit: f64,
    /// Whether it could be dropped, unlike physics. An [explanation](super::ReachExplanation) says
    /// whether dropping it would help.
    pub is_limit: bool,
}

impl Halfspace {
    /// `normal . state <= limit`.
    pub fn new(name: impl Into<String>, normal: impl Into<Vec<f64>>, limit: f64) -> Self {
        Halfspace { name: name.into(), normal: normal.into(), limit, is_limit: false }
    }

    /// `normal . state <= limit`, which could be dropped.
    pub fn limit(name: impl Into<String>, normal: impl Into<Vec<f64>>, limit: f64) -> Self {
        Halfspace { is_limit: true, ..Halfspace::new(name, normal, limit) }
    }
}

/// The reset after a transition's flow: `x⁺ = R y + r`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reset {
    pub(super) matrix: Mat<f64>,
    pub(super) offset: Vec<f64>,
}

/// One way to get from a sample to the next, such as a mode or a contact.
///
/// A step in this transition starts in a state that satisfies its guards, follows the flow
/// `y = A x + B u + c` under an admissible input, arrives at a prediction `y` that satisfies the
/// guards on the prediction, and is reset to `x⁺ = R y + r`.
///
/// ```
/// use carom::hybrid::{LinearSystem, Mat};
/// use carom::hybrid::reach::{Halfspace, Transition};
///
/// // A ball that meets the floor at 0 m rebounds with half its speed.
/// let fall = LinearSystem::double_integrator(0.1)?;
/// let bounce = Transition::event("bounce", fall)
///     .with_prediction_guard(Halfspace::new("at the floor", [1.0, 0.0], 0.0))
///     .with_prediction_guard(Halfspace::new("moving down", [0.0, 1.0], 0.0))
///     .with_reset(Mat::from_fn(2, 2, |i, j| if i == j { -0.5 } else { 0.0 }), vec![0.0, 0.0]);
/// assert!(bounce.is_event);
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Transition {
    /// Its name, for reports.
    pub name: String,
    /// The flow.
    pub flow: LinearSystem,
    /// Limits on the state at the start of the step.
    pub guards: Vec<Halfspace>,
    /// Limits on the flow's result, before the reset.
    pub prediction_guards: Vec<Halfspace>,
    pub(super) reset: Option<Reset>,
    /// Whether it counts as an event, for the layers of the sets.
    pub is_event: bool,
}

impl Transition {
    /// A transition that is not an event: a mode that may last.
    pub fn new(name: impl Into<String>, flow: LinearSystem) -> Self {
        Transition {
            name: name.into(),
            flow,
            guards: Vec::new(),
            prediction_guards: Vec::new(),
            reset: None,
            is_event: false,
        }
    }

    /// A transition that is an event: an impact, a switch.
    pub fn event(name: impl Into<String>, flow: LinearSystem) -> Self {
        Transition { is_event: true, ..Transition::new(name, flow) }
    }

    /// Limits the state at the start of the step.
    #[must_use]
    pub fn with_guard(mut self, guard: Halfspace) -> Self {
        self.guards.push(guard);
        self
    }

    /// Limits the flow's result, before the reset.
    #[must_use]
    pub fn with_prediction_guard(mut self, guard: Halfspace) -> Self {
        self.prediction_guards.push(guard);
        self
    }

    /// Sets the reset `x⁺ = matrix . y + offset`; with n states, `matrix` is n x n and `offset` has
    /// n entries.
    #[must_use]
    pub fn with_reset(mut self, matrix: Mat<f64>, offset: Vec<f64>) -> Self {
        self.reset = Some(Reset { matrix, offset });
        self
    }
}

/// A discrete-time hybrid system with bounded states and inputs.
///
/// The state at every sample lies in its domain and satisfies the limits; each step takes one of
/// the transitions, with every input within its range.
///
/// ```
/// use carom::hybrid::LinearSystem;
/// use carom::hybrid::reach::{HybridSystem, Transition};
/// use carom::interval::Interval;
///
/// let push = HybridSystem::new()
///     .with_state("x", Interval::new(-9.0, 9.0))
///     .with_state("v", Interval::new(-9.0, 9.0))
///     .with_input("a", Interval::new(-1.0, 1.0))
///     .with_transition(Transition::new("flight", LinearSystem::double_integrator(0.1)?));
/// push.check()?;
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct HybridSystem {
    /// Names and domains (finite) of the states.
    pub states: Vec<(String, Interval)>,
    /// Names and ranges (finite) of the inputs.
    pub inputs: Vec<(String, Interval)>,
    /// Limits at every sample, in addition to the domains.
    pub limits: Vec<Halfspace>,
    /// The transitions of a step, at least one.
    pub transitions: Vec<Transition>,
}

impl HybridSystem {
    /// A system without states, inputs and transitions.
    pub fn new() -> Self {
        HybridSystem::default()
    }

    /// Adds a state with its domain, in the state's unit.
    #[must_use]
    pub fn with_state(mut self, name: impl Into<String>, domain: Interval) -> Self {
        self.states.push((name.into(), domain));
        self
    }

    /// Adds an input with its range, in the input's unit.
    #[must_use]
    pub fn with_input(mut self, name: impl Into<String>, range: Interval) -> Self {
        self.inputs.push((name.into(), range));
        self
    }

    /// Adds a limit that holds at every sample.
    #[must_use]
    pub fn with_limit(mut self, limit: Halfspace) -> Self {
        self.limits.push(limit);
        self
    }

    /// Adds a transition.
    #[must_use]
    pub fn with_transition(mut self, transition: Transition) -> Self {
        self.transitions.push(transition);
        self
    }

    /// Refuses systems whose parts do not fit together.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`], [`ErrorKind::Length`], [`ErrorKind::NotFinite`],
    /// [`ErrorKind::CrossedBounds`]; [`ErrorKind::OutOfRange`] for a system without states or
    /// transitions and for numbers of 1e20 and more in magnitude.
    pub fn check(&self) -> Result<(), Error> {
        let counts = [("states", self.states.len()), ("transitions", self.transitions.len())];
        for (what, count) in counts {
            if count == 0 {
                let what = format!("the number of {what} of the hybrid system");
                return Err(Error::out_of_range(what, 0.0, "at least 1"));
            }
        }
        for (name, range) in self.states.iter().chain(&self.inputs) {
            check_ends(name, *range)?;
        }
        let n = self.states.len();
        for limit in &self.limits {
            check_halfspace(limit, n)?;
        }
        for transition in &self.transitions {
            transition.check(n, self.inputs.len())?;
        }
        Ok(())
    }
}

impl Transition {
    fn check(&self, states: usize, inputs: usize) -> Result<(), Error> {
        let shape = |what, rows, columns, expected| {
            Err(ErrorKind::Shape { what, rows, columns, expected }.into())
        };
        let (n, m) = (self.flow.states(), self.flow.inputs());
        if n != states || m != inputs {
            let expected = format!("{states} states and {inputs} inputs");
            return shape("the flow of a transition", n, m, expected);
        }
        for guard in self.guards.iter().chain(&self.prediction_guards) {
            check_halfspace(guard, states)?;
        }
        let (a, b, c) = (self.flow.a(), self.flow.b(), self.flow.c());
        let flow = (0..n).flat_map(|i| {
            let row = (0..n).map(move |j| a[(i, j)]).chain((0..m).map(move |j| b[(i, j)]));
            row.chain([c[i]])
        });
        check_numbers(&self.name, "an entry of the flow", flow)?;
        let Some(Reset { matrix, offset }) = &self.reset else { return Ok(()) };
        let (rows, columns) = (matrix.nrows(), matrix.ncols());
        if rows != states || columns != states {
            return shape("the matrix of a reset", rows, columns, format!("{states}x{states}"));
        }
        check_length("the offset of a reset", offset.len(), states)?;
        let entries = (0..rows).flat_map(|i| (0..columns).map(move |j| matrix[(i, j)]));
        check_numbers(&self.name, "an entry of the reset", entries.chain(offset.iter().copied()))
    }
}

fn check_halfspace(halfspace: &Halfspace, states: usize) -> Result<(), Error> {
    check_length("the normal of a half-space", halfspace.normal.len(), states)?;
    let numbers = halfspace.normal.iter().chain([&halfspace.limit]);
    check_numbers(&halfspace.name, "a number", numbers.copied())
}

/// Refuses ranges whose ends are not finite, crossed, or too large.
pub(super) fn check_ends(name: &str, range: Interval) -> Result<(), Error> {
    range.check(name)?;
    check_numbers(name, "a limit", [range.lower, range.upper].into_iter())
}

/// Refuses numbers that are not finite or are 1e20 and more in magnitude, because products of them
/// could overflow.
fn check_numbers(
    name: &str,
    what: &'static str,
    numbers: impl Iterator<Item = f64>,
) -> Result<(), Error> {
    for value in numbers {
        check_finite(name, what, [value])?;
        if value.abs() >= INFINITE {
            let what = format!("{what} of `{name}`");
            return Err(Error::out_of_range(what, value, "below 1e20 in magnitude"));
        }
    }
    Ok(())
}
