//! The normal form of formulas: negations only at variables, no constants, no repetitions.
//!
//! It tells whether a statement is trivially false when it is added, and gives its rows when it is
//! lowered.

use super::{FormulaNode, Logic};
use crate::model::literal::Literal;

/// A formula in negation normal form. Members are sorted, and no member is a constant or, in a
/// conjunction (disjunction), a conjunction (disjunction) itself.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Formula {
    /// True or false.
    Constant(bool),
    /// A binary that is on or off.
    Literal(Literal),
    /// All members are true.
    And(Vec<Formula>),
    /// At least one member is true.
    Or(Vec<Formula>),
    /// An odd (or even) number of at least two members is true; literals among them are "on".
    Parity {
        /// Whether the number is odd.
        odd: bool,
        /// The members.
        of: Vec<Formula>,
    },
    /// `at_least <= number of true ones <= at_most`, neither a clause nor a conjunction.
    Count {
        /// The smallest number of true members.
        at_least: usize,
        /// The largest number of true members.
        at_most: usize,
        /// The members.
        of: Vec<Formula>,
    },
    /// The negation of such a count: fewer or more.
    Except {
        /// The smallest number of true members.
        at_least: usize,
        /// The largest number of true members.
        at_most: usize,
        /// The members.
        of: Vec<Formula>,
    },
}

impl Formula {
    /// The normal form of "`logic` is `value`".
    #[doc(hidden)]
    pub fn of(logic: &Logic, value: bool) -> Formula {
        let all =
            |of: &[Logic], value| of.iter().map(|member| Formula::of(member, value)).collect();
        match &logic.node {
            FormulaNode::Literal(literal) => {
                Formula::Literal(if value { *literal } else { !*literal })
            }
            FormulaNode::Not(of) => Formula::of(of, !value),
            FormulaNode::And(of) if value => and(all(of, true)),
            FormulaNode::And(of) => or(all(of, false)),
            FormulaNode::Or(of) if value => or(all(of, true)),
            FormulaNode::Or(of) => and(all(of, false)),
            FormulaNode::Implies(condition, then) => {
                let (condition, then) = (Formula::of(condition, !value), Formula::of(then, value));
                if value { or(vec![condition, then]) } else { and(vec![condition, then]) }
            }
            FormulaNode::Parity { odd, of } => parity(*odd == value, all(of, true)),
            FormulaNode::Count { at_least, at_most, of } => {
                let count = count(*at_least, *at_most, all(of, true));
                if value { count } else { count.negated() }
            }
            FormulaNode::TooDeep => Formula::Constant(!value),
        }
    }

    #[doc(hidden)]
    pub fn negated(&self) -> Formula {
        let each = |of: &[Formula]| of.iter().map(Formula::negated).collect();
        match self {
            Formula::Constant(value) => Formula::Constant(!value),
            Formula::Literal(literal) => Formula::Literal(!*literal),
            Formula::And(of) => or(each(of)),
            Formula::Or(of) => and(each(of)),
            Formula::Parity { odd, of } => Formula::Parity { odd: !odd, of: of.clone() },
            Formula::Count { at_least: 0, at_most, of } => {
                count(at_most + 1, usize::MAX, of.clone())
            }
            Formula::Count { at_least, at_most, of } if *at_most == of.len() => {
                count(0, at_least - 1, of.clone())
            }
            Formula::Count { at_least, at_most, of } => {
                Formula::Except { at_least: *at_least, at_most: *at_most, of: of.clone() }
            }
            Formula::Except { at_least, at_most, of } => {
                Formula::Count { at_least: *at_least, at_most: *at_most, of: of.clone() }
            }
        }
    }

    /// Whether the formula and its negation both mention all members of some part.
    #[doc(hidden)]
    pub fn is_two_sided(&self) -> bool {
        match self {
            Formula::Constant(_) | Formula::Literal(_) => false,
            Formula::And(of) | Formula::Or(of) => of.iter().any(Formula::is_two_sided),
            Formula::Parity { .. } | Formula::Count { .. } | Formula::Except { .. } => true,
        }
    }

    /// The literal, if the formula is a single literal.
    #[doc(hidden)]
    pub fn as_literal(&self) -> Option<Literal> {
        match self {
            Formula::Literal(literal) => Some(*literal),
            _ => None,
        }
    }
}

pub(super) fn and(members: Vec<Formula>) -> Formula {
    joined(members, true)
}

pub(super) fn or(members: Vec<Formula>) -> Formula {
    joined(members, false)
}

/// A conjunction (`neutral` = true) or disjunction (`neutral` = false).
fn joined(members: Vec<Formula>, neutral: bool) -> Formula {
    let mut flat = Vec::with_capacity(members.len());
    for member in members {
        match member {
            Formula::Constant(value) if value == neutral => {}
            Formula::Constant(value) => return Formula::Constant(value),
            Formula::And(of) if neutral => flat.extend(of),
            Formula::Or(of) if !neutral => flat.extend(of),
            other => flat.push(other),
        }
    }
    flat.sort();
    flat.dedup();
    let opposite = |of: &Formula| flat.binary_search(&of.negated()).is_ok();
    if flat.iter().any(|of| of.as_literal().is_some() && opposite(of)) {
        return Formula::Constant(!neutral);
    }
    match (flat.len(), neutral) {
        (0, _) => Formula::Constant(neutral),
        (1, _) => flat.remove(0),
        (_, true) => Formula::And(flat),
        (_, false) => Formula::Or(flat),
    }
}

fn parity(mut odd: bool, members: Vec<Formula>) -> Formula {
    let mut flat = Vec::with_capacity(members.len());
    for member in members {
        match member {
            Formula::Constant(value) => odd ^= value,
            Formula::Parity { odd: inner, of } => {
                odd ^= !inner;
                flat.extend(of);
            }
            Formula::Literal(literal) if !literal.on => {
                odd = !odd;
                flat.push(Formula::Literal(!literal));
            }
            other => flat.push(other),
        }
    }
    flat.sort();
    // Equal members cancel in pairs.
    let mut of: Vec<Formula> = Vec::with_capacity(flat.len());
    for member in flat {
        if of.last() == Some(&member) {
            of.pop();
        } else {
            of.push(member);
        }
    }
    match of.len() {
        0 => Formula::Constant(!odd),
        1 if odd => of.remove(0),
        1 => of[0].negated(),
        _ => Formula::Parity { odd, of },
    }
}

fn count(mut at_least: usize, mut at_most: usize, members: Vec<Formula>) -> Formula {
    let mut of = Vec::with_capacity(members.len());
    for member in members {
        match member {
            Formula::Constant(false) => {}
            Formula::Constant(true) => {
                at_least = at_least.saturating_sub(1);
                match at_most {
                    0 => return Formula::Constant(false),
                    usize::MAX => {}
                    _ => at_most -= 1,
                }
            }
            other => of.push(other),
        }
    }
    let n = of.len();
    at_most = at_most.min(n);
    if at_least > at_most {
        return Formula::Constant(false);
    }
    of.sort();
    let negated = |of: Vec<Formula>| of.iter().map(Formula::negated).collect();
    match (at_least, at_most) {
        (0, high) if high == n => Formula::Constant(true),
        (low, _) if low == n => and(of),
        (_, 0) => and(negated(of)),
        (1, high) if high == n => or(of),
        (0, high) if high == n - 1 => or(negated(of)),
        (1, 1) if n == 2 => parity(true, of),
        _ => Formula::Count { at_least, at_most, of },
    }
}
