//! Logic over binary variables: one type, [`Logic`], for statements and for conditions.
//!
//! There are no Boolean variables apart from binaries: a binary *is* the proposition "it is 1".
//! Formulas nest freely. `reformulate` turns them into rows, and solutions
//! are checked against the formula itself.
//!
//! | written | true when |
//! | --- | --- |
//! | `a`, `a.on()` | `a` is 1 |
//! | `!a`, `a.off()` | `a` is 0 |
//! | `a & b`, [`Logic::all`] | all are true |
//! | `a \| b`, [`Logic::any`] | at least one is true |
//! | `a.xor(b)` | exactly one of the two is true; a chain of them: an odd number |
//! | `a.iff(b)` | both or neither are true |
//! | `a.implies(b)` | `b` is true or `a` is not |
//! | [`at_most`]`(k, of)`, [`at_least`], [`exactly`] | that many are true |

mod adding;
mod display;
pub(crate) mod normal;
mod operators;

pub(crate) use normal::Formula;

use super::ids::Variable;
use super::literal::Literal;
use crate::error::{Error, ErrorKind};

/// Formulas nested deeper than this are refused.
const MAX_LOGIC_DEPTH: u32 = 100;

/// A formula over binary variables, used as a statement or as a condition.
///
/// A formula added to a model by [`Model::add`](super::Model::add) must hold.
///
/// ```
/// use carom::model::{Logic, at_most, exactly};
/// use carom::prelude::*;
///
/// let mut model = Model::new("modes");
/// let mode = model.binary_family("mode", 3)?;
/// let hit = model.binary_family("hit", 4)?;
/// let armed = model.binary("armed")?;
/// model.add("one_mode", exactly(1, &mode))?;
/// model.add("two_hits", at_most(2, &hit))?;
/// model.add("armed_first", Logic::any(&hit).implies(armed & !mode[0]))?;
/// model.add("last", hit[3].iff(mode[1] | (mode[2] & armed)))?;
/// assert!(model.to_string().contains("last: hit[3] iff (mode[1] | (mode[2] & armed))\n"));
/// # Ok::<(), carom::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[must_use = "a formula does nothing until it is given to `Model::add` or used as a condition"]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(from = "FormulaNode", into = "FormulaNode"))]
pub struct Logic {
    node: FormulaNode,
    depth: u32,
}

/// The structure of a formula.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
enum FormulaNode {
    Literal(Literal),
    Not(Box<Logic>),
    And(Vec<Logic>),
    Or(Vec<Logic>),
    Implies(Box<Logic>, Box<Logic>),
    /// An odd (or even) number of these is true.
    Parity {
        odd: bool,
        of: Vec<Logic>,
    },
    /// The number of true ones lies within the limits.
    Count {
        at_least: usize,
        at_most: usize,
        of: Vec<Logic>,
    },
    /// Replaces a formula that was nested too deep.
    TooDeep,
}

impl FormulaNode {
    fn members(&self) -> &[Logic] {
        match self {
            FormulaNode::Literal(_) | FormulaNode::TooDeep => &[],
            FormulaNode::Not(of) => std::slice::from_ref(of),
            FormulaNode::And(of) | FormulaNode::Or(of) => of,
            FormulaNode::Implies(..) => &[],
            FormulaNode::Parity { of, .. } | FormulaNode::Count { of, .. } => of,
        }
    }
}

impl From<FormulaNode> for Logic {
    fn from(node: FormulaNode) -> Self {
        let below = match &node {
            FormulaNode::Implies(condition, then) => condition.depth.max(then.depth),
            other => other.members().iter().map(|member| member.depth).max().unwrap_or(0),
        };
        Logic::new(node, below + 1)
    }
}

#[cfg(feature = "serde")]
impl From<Logic> for FormulaNode {
    fn from(logic: Logic) -> Self {
        logic.node
    }
}

impl Logic {
    fn new(node: FormulaNode, depth: u32) -> Self {
        match depth <= MAX_LOGIC_DEPTH {
            true => Logic { node, depth },
            false => Logic { node: FormulaNode::TooDeep, depth: 1 },
        }
    }

    /// All of these are true.
    pub fn all<T: Into<Logic>>(of: impl IntoIterator<Item = T>) -> Logic {
        FormulaNode::And(of.into_iter().map(T::into).collect()).into()
    }

    /// At least one of these is true.
    pub fn any<T: Into<Logic>>(of: impl IntoIterator<Item = T>) -> Logic {
        FormulaNode::Or(of.into_iter().map(T::into).collect()).into()
    }

    pub(super) fn implication(condition: Logic, then: Logic) -> Logic {
        FormulaNode::Implies(Box::new(condition), Box::new(then)).into()
    }

    /// The literal, if the formula is a single literal.
    pub fn as_literal(&self) -> Option<Literal> {
        match &self.node {
            FormulaNode::Literal(literal) => Some(*literal),
            _ => None,
        }
    }

    /// The variables that occur, sorted, each once; fewer if the formula is
    /// [too deep](Self::evaluate).
    pub fn variables(&self) -> Vec<Variable> {
        let mut found = Vec::new();
        self.collect(&mut found);
        found.sort_unstable();
        found.dedup();
        found
    }

    fn collect(&self, found: &mut Vec<Variable>) {
        match &self.node {
            FormulaNode::Literal(literal) => found.push(literal.variable),
            FormulaNode::Implies(condition, then) => {
                condition.collect(found);
                then.collect(found);
            }
            other => other.members().iter().for_each(|member| member.collect(found)),
        }
    }

    /// Whether the formula is true, with `value` telling which binaries are 1.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::TooDeep`] if the formula is nested more than 100 levels deep: parts of such a
    /// formula are not kept, and no model accepts it.
    pub fn evaluate(&self, value: impl Fn(Variable) -> bool) -> Result<bool, Error> {
        match self.is_too_deep() {
            true => {
                Err(ErrorKind::TooDeep { name: "the formula".into(), limit: MAX_LOGIC_DEPTH }
                    .into())
            }
            false => Ok(self.is_true(value)),
        }
    }

    /// The same for a formula of a model.
    #[doc(hidden)]
    pub fn is_true(&self, value: impl Fn(Variable) -> bool) -> bool {
        self.truth(&value)
    }

    fn truth(&self, value: &dyn Fn(Variable) -> bool) -> bool {
        let count = |of: &[Logic]| of.iter().filter(|member| member.truth(value)).count();
        match &self.node {
            FormulaNode::Literal(literal) => value(literal.variable) == literal.on,
            FormulaNode::Not(of) => !of.truth(value),
            FormulaNode::And(of) => of.iter().all(|member| member.truth(value)),
            FormulaNode::Or(of) => of.iter().any(|member| member.truth(value)),
            FormulaNode::Implies(condition, then) => !condition.truth(value) || then.truth(value),
            FormulaNode::Parity { odd, of } => (count(of) % 2 == 1) == *odd,
            FormulaNode::Count { at_least, at_most, of } => {
                (*at_least..=*at_most).contains(&count(of))
            }
            FormulaNode::TooDeep => false,
        }
    }

    fn is_too_deep(&self) -> bool {
        match &self.node {
            FormulaNode::TooDeep => true,
            FormulaNode::Implies(condition, then) => condition.is_too_deep() || then.is_too_deep(),
            other => other.members().iter().any(Logic::is_too_deep),
        }
    }
}

/// At most `count` of these are true. This is always true if `count` is at least their number.
pub fn at_most<T: Into<Logic>>(count: usize, of: impl IntoIterator<Item = T>) -> Logic {
    FormulaNode::Count { at_least: 0, at_most: count, of: of.into_iter().map(T::into).collect() }
        .into()
}

/// At least `count` of these are true. This is always true if `count` is 0.
pub fn at_least<T: Into<Logic>>(count: usize, of: impl IntoIterator<Item = T>) -> Logic {
    let of = of.into_iter().map(T::into).collect();
    FormulaNode::Count { at_least: count, at_most: usize::MAX, of }.into()
}

/// Exactly `count` of these are true.
pub fn exactly<T: Into<Logic>>(count: usize, of: impl IntoIterator<Item = T>) -> Logic {
    let of = of.into_iter().map(T::into).collect();
    FormulaNode::Count { at_least: count, at_most: count, of }.into()
}
