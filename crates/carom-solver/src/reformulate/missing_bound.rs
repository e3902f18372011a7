//! Why a bound is missing: which row would give it, and what that row lacks.

use super::implied_bounds::{ImpliedBounds, MAX_IMPLIED_BOUND};
use crate::model::{ConstraintRef, Variable};

/// The largest number of rows that are named before and after those that are not.
const NAMED_ROWS: usize = 2;

/// The longest chain that is followed.
const MAX_CHAIN: usize = 100;

/// One of the two bounds of a variable.
type MissingBound = (Variable, bool);

/// A missing bound, in words.
pub(super) struct BoundReason {
    /// The chain of rows; empty if no row holds the variable.
    pub(super) chain: String,
    /// The variable at the end of the chain, if it is another one.
    pub(super) root: Option<Variable>,
}

/// Why rows give a variable no bound.
pub(super) fn reason(
    implied: &ImpliedBounds<'_>,
    variable: Variable,
    is_upper: bool,
) -> BoundReason {
    let bounds = implied.implied(variable);
    let end = if is_upper { bounds.upper } else { bounds.lower };
    if end.is_finite() && end.abs() > MAX_IMPLIED_BOUND {
        let chain = format!(
            " and rows bound it only by {end:.1e}, which is too large for a big-M (at most \
             {MAX_IMPLIED_BOUND:.0e})"
        );
        return BoundReason { chain, root: None };
    }
    let name = |v: Variable| format!("`{}`", implied.rows().name_of(v));
    let mut seen = vec![(variable, is_upper)];
    let mut links: Vec<String> = Vec::new();
    let mut at = (variable, is_upper);
    while links.len() < MAX_CHAIN {
        let Some((row, lacks)) = nearest(implied, at, &seen) else { break };
        let fresh = lacks.iter().copied().find(|end| !seen.contains(end));
        let Some((other, upper)) = fresh else { break };
        let side = if upper { "an upper" } else { "a lower" };
        let others = match lacks.len() - 1 {
            0 => String::new(),
            1 => " and of another variable".to_owned(),
            n => format!(" and of {n} other variables"),
        };
        links.push(format!("row `{}` needs {side} bound of {}{others}", row.name(), name(other)));
        at = (other, upper);
        seen.push(at);
    }
    if links.is_empty() {
        return BoundReason { chain: String::new(), root: None };
    }
    if links.len() > 2 * NAMED_ROWS {
        let between = NAMED_ROWS..links.len() - NAMED_ROWS + 1;
        let skipped = format!("and so on over {} rows", between.len());
        links.splice(between, [skipped]);
    }
    let side = if at.1 { "from above" } else { "from below" };
    let (ending, root) = match nearest(implied, at, &[]) {
        _ if seen.len() > MAX_CHAIN => ("and so on".to_owned(), None),
        None => (format!("which no row bounds {side}"), Some(at.0)),
        // All other rows need bounds that are in the chain already.
        Some(_) => (format!("which no other row bounds {side}"), Some(at.0)),
    };
    let chain = format!(" and rows imply none ({}, {ending})", links.join(", "));
    BoundReason { chain, root: root.filter(|root| *root != variable) }
}

/// The row that would give a bound with the fewest other bounds, and those that it lacks. Rows that
/// lack only bounds already seen come last.
fn nearest<'a>(
    implied: &'a ImpliedBounds<'_>,
    end: MissingBound,
    seen: &[MissingBound],
) -> Option<(ConstraintRef<'a>, Vec<MissingBound>)> {
    let found = implied.rows().constraints().filter_map(|row| {
        let lacks = lacking(implied, &row, end)?;
        Some((row, lacks))
    });
    found
        .filter(|(_, lacks)| !lacks.is_empty())
        .min_by_key(|(_, lacks)| (lacks.iter().all(|end| seen.contains(end)), lacks.len()))
}

/// The bounds that a row lacks to give one; `None` if it cannot give it at all.
fn lacking(
    implied: &ImpliedBounds<'_>,
    row: &ConstraintRef<'_>,
    (variable, is_upper): MissingBound,
) -> Option<Vec<MissingBound>> {
    let place = row.terms().binary_search_by_key(&variable, |&(v, _)| v).ok()?;
    // An upper bound comes from the upper limit if the coefficient is positive.
    let by_upper = (row.terms()[place].1 > 0.0) == is_upper;
    let limit = if by_upper { row.limits().upper } else { row.limits().lower };
    if limit.is_infinite() {
        return None;
    }
    let others = row.terms().iter().filter(|(v, _)| *v != variable);
    let lacks = others.filter_map(|&(other, a)| {
        // The others' terms must be bounded from below for an upper limit.
        let upper = (a > 0.0) != by_upper;
        let bounds = implied.implied(other);
        let end = if upper { bounds.upper } else { bounds.lower };
        end.is_infinite().then_some((other, upper))
    });
    Some(lacks.collect())
}
