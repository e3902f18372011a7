//! Warm starts from an earlier solve.

use crate::model::Variable;
use crate::solution::{LeafBox, Solution};

/// A warm start: values of some integers (a MIP start), and boxes into which to divide the root.
///
/// None of it is trusted. The guess is fixed, completed and verified like any other point. The root
/// is divided along the bounds of the boxes into parts that always cover it, and every part is
/// relaxed again; the bounds of the boxes only decide the order. So a seed never changes the status
/// or the optimum, only the search.
///
/// A controller with a receding horizon repeatedly solves nearly the same program. It shifts the
/// result of the previous solve by one step:
///
/// ```
/// use carom::prelude::*;
/// use carom::solver::TreeSeed;
///
/// /// Reach the goal with few switches; the state at the beginning is a parameter.
/// let mut model = Model::new("horizon");
/// let steps = 8;
/// let x = model.continuous_family("x", steps + 1, -20.0, 20.0)?;
/// let up = model.binary_family("up", steps)?;
/// let start = model.parameter("start", 4.0, -10.0, 10.0)?;
/// model.add("start", (x[0] - start).equals(0.0))?;
/// for t in 0..steps {
///     model.add(("step", t), (x[t + 1] - x[t] - 3.0 * up[t]).equals(-1.2))?;
/// }
/// model.minimize((0..=steps).map(|t| (x[t] - 0.3).square()).sum::<Quadratic>())?;
///
/// let mut solver = BranchAndBound::new(Options::default().with_leaves(true));
/// let first = solver.solve(&model)?;
///
/// // One step later: the plan's second state is the first one, and all decisions move by one.
/// let next = first.value(x[1])?;
/// model.set_parameter(start, next)?;
/// let without = solver.solve(&model)?;
/// let earlier = |v: Variable| up.iter().position(|u| u == v)?.checked_sub(1).map(|t| up[t]);
/// let seed = TreeSeed::of(&first, up.iter()).mapped(earlier);
/// let mut control = Control::default().with_seed(&seed);
/// let with = solver.solve_with(&model, &mut control)?;
///
/// assert!(with.is_optimal() && without.is_optimal());
/// assert!((with.objective().unwrap() - without.objective().unwrap()).abs() < 1e-4);
/// let report = with.seed_report().unwrap();
/// assert!(report.guess.is_some());
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TreeSeed {
    /// Values of some integer variables, the most certain first. If all of them together lead to no
    /// point, the first half is tried, and then the first quarter.
    pub guess: Vec<(Variable, f64)>,
    /// Boxes into which to divide the root; they need not cover it.
    pub leaves: Vec<LeafBox>,
}

impl TreeSeed {
    /// An empty seed.
    pub fn new() -> Self {
        TreeSeed::default()
    }

    /// A seed from a solution: the values of the given integer variables at its point, if there is
    /// one, and its leaves, if they were kept.
    pub fn of(solution: &Solution, integers: impl IntoIterator<Item = Variable>) -> Self {
        let value = |variable| Some((variable, solution.value(variable).ok()?));
        let guess = integers.into_iter().filter_map(value).collect();
        TreeSeed { guess, leaves: solution.leaves().to_vec() }
    }

    /// Sets the guess.
    #[must_use]
    pub fn with_guess(mut self, guess: impl IntoIterator<Item = (Variable, f64)>) -> Self {
        self.guess = guess.into_iter().collect();
        self
    }

    /// Sets the boxes.
    #[must_use]
    pub fn with_leaves(mut self, leaves: impl IntoIterator<Item = LeafBox>) -> Self {
        self.leaves = leaves.into_iter().collect();
        self
    }

    /// The seed over other variables: `to` maps each variable to its replacement, or to `None` to
    /// drop its entries.
    #[must_use]
    pub fn mapped(&self, to: impl Fn(Variable) -> Option<Variable>) -> Self {
        let guess = self.guess.iter().filter_map(|&(v, value)| Some((to(v)?, value))).collect();
        TreeSeed { guess, leaves: self.leaves.iter().map(|leaf| leaf.mapped(&to)).collect() }
    }
}
