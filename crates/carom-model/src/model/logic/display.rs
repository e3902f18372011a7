//! Formulas as text: `(a & !b) | at_most(2, c, d, e)`.

use std::fmt;

use super::{FormulaNode, Logic};
use crate::model::ids::Variable;

impl fmt::Display for Logic {
    /// Variables appear by position (`#3`); the model's own text form has their names.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(&|variable| format!("#{}", variable.index())))
    }
}

impl Logic {
    /// The formula with its variables named.
    pub(crate) fn text(&self, name: &dyn Fn(Variable) -> String) -> String {
        let joined = |of: &[Logic], word: &str| {
            of.iter().map(|member| member.operand(name)).collect::<Vec<_>>().join(word)
        };
        match &self.node {
            FormulaNode::Literal(literal) if literal.on => name(literal.variable),
            FormulaNode::Literal(literal) => format!("!{}", name(literal.variable)),
            FormulaNode::Not(of) => format!("!{}", of.operand(name)),
            FormulaNode::And(of) if of.is_empty() => "true".into(),
            FormulaNode::Or(of) if of.is_empty() => "false".into(),
            FormulaNode::And(of) => joined(of, " & "),
            FormulaNode::Or(of) => joined(of, " | "),
            FormulaNode::Implies(condition, then) => {
                format!("{} implies {}", condition.operand(name), then.operand(name))
            }
            FormulaNode::Parity { odd: false, of } if of.len() == 2 => joined(of, " iff "),
            FormulaNode::Parity { odd: true, of } => joined(of, " xor "),
            FormulaNode::Parity { odd: false, of } => format!("!({})", joined(of, " xor ")),
            FormulaNode::Count { at_least, at_most, of } => {
                let of: String =
                    of.iter().map(|member| format!(", {}", member.text(name))).collect();
                match (*at_least, *at_most) {
                    (low, high) if low == high => format!("exactly({low}{of})"),
                    (low, usize::MAX) => format!("at_least({low}{of})"),
                    (0, high) => format!("at_most({high}{of})"),
                    (low, high) => format!("between({low}, {high}{of})"),
                }
            }
            FormulaNode::TooDeep => "...".into(),
        }
    }

    /// The text, in parentheses if it is part of a larger formula.
    pub(crate) fn operand(&self, name: &dyn Fn(Variable) -> String) -> String {
        let text = self.text(name);
        match &self.node {
            FormulaNode::Literal(_)
            | FormulaNode::Not(_)
            | FormulaNode::Count { .. }
            | FormulaNode::TooDeep => text,
            _ => format!("({text})"),
        }
    }
}
