//! The answer of a look-up.

/// The answer of a table for a state.
///
/// Only `Plan` comes with inputs. For the others the caller has a fallback, see
/// [`LookupTable::evaluate_or`](crate::LookupTable::evaluate_or).
#[derive(Debug, Clone, Copy, PartialEq)]
#[must_use]
pub enum LookupAnswer<T> {
    /// The inputs are those of a plan that keeps every row.
    Plan {
        /// The most that the plan costs above the least cost from this state, in the unit of the
        /// objective. More than the ε of the table where its build has ended before; infinite if
        /// nothing is proved.
        loss: T,
    },
    /// It is proved that there is no plan from this state.
    NoPlan,
    /// The build of the table has ended before this part of the set was decided.
    Open,
    /// The state is not in the set of the table, or is no number.
    Outside,
    /// The slices of the table, of the state or of the inputs do not fit together.
    Damaged,
}

impl<T> LookupAnswer<T> {
    /// Whether the inputs were written.
    #[must_use]
    pub const fn has_inputs(&self) -> bool {
        matches!(self, LookupAnswer::Plan { .. })
    }
}
