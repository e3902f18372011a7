//! Formulas as text: `(a & !b) | at_most(2, c, d, e)`.

use std::fmt;

use super::{Logic, Node};
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
            Node::Literal(literal) if literal.on => name(literal.variable),
            Node::Literal(literal) => format!("!{}", name(literal.variable)),
            Node::Not(of) => format!("!{}", of.operand(name)),
            Node::And(of) if of.is_empty() => "true".into(),
            Node::Or(of) if of.is_empty() => "false".into(),
            Node::And(of) => joined(of, " & "),
            Node::Or(of) => joined(of, " | "),
            Node::Implies(condition, then) => {
                format!("{} implies {}", condition.operand(name), then.operand(name))
            }
            Node::Parity { odd: false, of } if of.len() == 2 => joined(of, " iff "),
            Node::Parity { odd: true, of } => joined(of, " xor "),
            Node::Parity { odd: false, of } => format!("!({})", joined(of, " xor ")),
            Node::Count { at_least, at_most, of } => {
                let of: String =
                    of.iter().map(|member| format!(", {}", member.text(name))).collect();
                match (*at_least, *at_most) {
                    (low, high) if low == high => format!("exactly({low}{of})"),
                    (low, usize::MAX) => format!("at_least({low}{of})"),
                    (0, high) => format!("at_most({high}{of})"),
                    (low, high) => format!("between({low}, {high}{of})"),
                }
            }
            Node::TooDeep => "...".into(),
        }
    }

    /// The text, in parentheses if it is part of a larger formula.
    pub(crate) fn operand(&self, name: &dyn Fn(Variable) -> String) -> String {
        let text = self.text(name);
        match &self.node {
            Node::Literal(_) | Node::Not(_) | Node::Count { .. } | Node::TooDeep => text,
            _ => format!("({text})"),
        }
    }
}
