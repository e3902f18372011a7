//! Small formulas as clauses, without auxiliary variables.
//!
//! Takes a formula; leaves its clauses, if they are few.

use crate::model::{Formula, Literal};

/// A disjunction of literals.
pub(super) type Clause = Vec<Literal>;

/// The clauses whose conjunction is the formula. `None` if there are more than `limit`, or if the
/// formula contains a count (which is one row but many clauses). Clauses that are always true are
/// omitted; a constant `false` is one empty clause.
pub(super) fn clauses(formula: &Formula, limit: usize) -> Option<Vec<Clause>> {
    let found = match formula {
        Formula::Constant(true) => Vec::new(),
        Formula::Constant(false) => vec![Vec::new()],
        Formula::Literal(literal) => vec![vec![*literal]],
        Formula::And(of) => {
            let mut all = Vec::new();
            for member in of {
                all.extend(clauses(member, limit.checked_sub(all.len())?)?);
            }
            all
        }
        Formula::Or(of) => {
            let mut all = vec![Vec::new()];
            for member in of {
                all = product(&all, &clauses(member, limit)?, limit)?;
            }
            all
        }
        Formula::Parity { odd, of } => parity_clauses(*odd, of, limit)?,
        Formula::Count { .. } | Formula::Except { .. } => return None,
    };
    (found.len() <= limit).then_some(found)
}

/// If the first member is true, the rest has the opposite parity, otherwise the same.
fn parity_clauses(odd: bool, of: &[Formula], limit: usize) -> Option<Vec<Clause>> {
    let Some((first, rest)) = of.split_first() else {
        return Some(if odd { vec![Vec::new()] } else { Vec::new() });
    };
    // Every member doubles the number of clauses.
    if rest.len() >= 8 || 1 << rest.len() > limit {
        return None;
    }
    let mut all = Vec::new();
    for (condition, odd) in [(first.negated(), !odd), (first.clone(), odd)] {
        let condition = clauses(&condition, limit)?;
        all.extend(product(&condition, &parity_clauses(odd, rest, limit)?, limit)?);
    }
    (all.len() <= limit).then_some(all)
}

/// The clauses of the disjunction of two formulas.
pub(super) fn product(left: &[Clause], right: &[Clause], limit: usize) -> Option<Vec<Clause>> {
    let mut all = Vec::new();
    for a in left {
        for b in right {
            if let Some(clause) = tidy([&a[..], b].concat()) {
                all.push(clause);
            }
            if all.len() > limit {
                return None;
            }
        }
    }
    Some(all)
}

/// Sorted, each literal once; `None` for a clause that is always true.
pub(super) fn tidy(mut clause: Clause) -> Option<Clause> {
    clause.sort_unstable();
    clause.dedup();
    // A variable's two literals are neighbours.
    let both = clause.windows(2).any(|pair| pair[0].variable() == pair[1].variable());
    (!both).then_some(clause)
}
