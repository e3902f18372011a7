//! `!`, `&`, `|`, `xor`, `iff`, `implies` on binaries, literals and formulas.

use std::ops::{BitAnd, BitOr, Not};

use super::{FormulaNode, Logic};
use crate::model::ids::Variable;
use crate::model::indicator::{Consequent, Implication, Implications, Reification};
use crate::model::literal::Literal;
use crate::model::row::Row;

impl From<Literal> for Logic {
    fn from(literal: Literal) -> Self {
        FormulaNode::Literal(literal).into()
    }
}

impl From<Variable> for Logic {
    /// The proposition "this binary is 1".
    fn from(variable: Variable) -> Self {
        variable.on().into()
    }
}

impl From<&Variable> for Logic {
    fn from(variable: &Variable) -> Self {
        variable.on().into()
    }
}

impl From<&Logic> for Logic {
    fn from(logic: &Logic) -> Self {
        logic.clone()
    }
}

impl Not for Literal {
    type Output = Literal;

    fn not(self) -> Literal {
        Literal { variable: self.variable, on: !self.on }
    }
}

impl Not for Variable {
    type Output = Literal;

    fn not(self) -> Literal {
        self.off()
    }
}

impl Not for &Variable {
    type Output = Literal;

    fn not(self) -> Literal {
        self.off()
    }
}

impl Not for Logic {
    type Output = Logic;

    fn not(self) -> Logic {
        match self.node {
            FormulaNode::Literal(literal) => (!literal).into(),
            FormulaNode::Not(of) => *of,
            FormulaNode::Parity { odd, of } => {
                Logic { node: FormulaNode::Parity { odd: !odd, of }, depth: self.depth }
            }
            node => {
                let depth = self.depth;
                Logic::new(FormulaNode::Not(Box::new(Logic { node, depth })), depth + 1)
            }
        }
    }
}

impl Not for &Logic {
    type Output = Logic;

    fn not(self) -> Logic {
        !self.clone()
    }
}

/// Chains of the same connective stay flat, whichever way they are bracketed, and grow in constant
/// time.
fn and(left: Logic, right: Logic) -> Logic {
    let open = |node| match node {
        FormulaNode::And(of) => Ok(of),
        other => Err(other),
    };
    let (of, depth) = joined(left, right, open);
    Logic::new(FormulaNode::And(of), depth)
}

fn or(left: Logic, right: Logic) -> Logic {
    let open = |node| match node {
        FormulaNode::Or(of) => Ok(of),
        other => Err(other),
    };
    let (of, depth) = joined(left, right, open);
    Logic::new(FormulaNode::Or(of), depth)
}

/// An even parity is the negation of the odd one, also as a member.
fn parity(odd: bool, left: Logic, right: Logic) -> Logic {
    let even = |logic: &Logic| matches!(logic.node, FormulaNode::Parity { odd: false, .. });
    let odd = odd ^ even(&left) ^ even(&right);
    let open = |node| match node {
        FormulaNode::Parity { of, .. } => Ok(of),
        other => Err(other),
    };
    let (of, depth) = joined(left, right, open);
    Logic::new(FormulaNode::Parity { odd, of }, depth)
}

/// The members of both sides, and the depth of a formula made of them.
fn joined(
    left: Logic,
    right: Logic,
    open: impl Fn(FormulaNode) -> Result<Vec<Logic>, FormulaNode>,
) -> (Vec<Logic>, u32) {
    let opened = |side: Logic| match open(side.node) {
        Ok(of) => (of, side.depth),
        Err(node) => (vec![Logic { node, depth: side.depth }], side.depth + 1),
    };
    let ((mut members, left), (more, right)) = (opened(left), opened(right));
    members.extend(more);
    (members, left.max(right))
}

macro_rules! connectives {
    ($($left:ty, $right:ty);+ $(;)?) => {$(
        impl BitAnd<$right> for $left {
            type Output = Logic;

            fn bitand(self, right: $right) -> Logic {
                and(self.into(), right.into())
            }
        }

        impl BitOr<$right> for $left {
            type Output = Logic;

            fn bitor(self, right: $right) -> Logic {
                or(self.into(), right.into())
            }
        }
    )+};
}

connectives!(
    Variable, Variable; Variable, Literal; Variable, Logic; Variable, &Logic;
    Literal, Variable; Literal, Literal; Literal, Logic; Literal, &Logic;
    Logic, Variable; Logic, Literal; Logic, Logic; Logic, &Logic;
    &Logic, Variable; &Logic, Literal; &Logic, Logic; &Logic, &Logic;
);

macro_rules! methods {
    ($operand:ty, $self:ident: $receiver:ty) => {
        impl $operand {
            /// Exactly one of the two is true.
            pub fn xor($self: $receiver, other: impl Into<Logic>) -> Logic {
                parity(true, $self.into(), other.into())
            }

            /// Both or neither are true.
            pub fn iff($self: $receiver, other: impl Into<Logic>) -> Logic {
                parity(false, $self.into(), other.into())
            }

            /// "If this holds, then that does": with a [`Row`] or a
            /// [`ConicRow`](crate::model::ConicRow) an [`Implication`], with logic a [`Logic`].
            ///
            /// ```
            /// use carom::prelude::*;
            ///
            /// let mut model = Model::new("m");
            /// let hit = model.binary("hit")?;
            /// let armed = model.binary("armed")?;
            /// let x = model.continuous("x", -1.0, 10.0)?;
            /// model.add("contact", hit.on().implies(x.le(0.0)))?;
            /// model.add("flight", hit.off().implies(x.ge(0.0)))?;
            /// model.add("early", (armed & !hit).implies(x.ge(2.0)))?;
            /// model.add("order", hit.implies(armed))?;
            /// # Ok::<(), carom::Error>(())
            /// ```
            #[doc(alias = "indicator constraint")]
            pub fn implies<C: Consequent>($self: $receiver, consequent: C) -> C::Output {
                consequent.after($self.into())
            }

            /// "If this holds, then all these rows do", or all these norms and quadratic rows. Each
            /// row becomes a separate indicator: `name`, `name_2`, `name_3`, ...
            ///
            /// ```
            /// use carom::prelude::*;
            ///
            /// let mut model = Model::new("m");
            /// let docked = model.binary("docked")?;
            /// let x = model.continuous("x", -1.0, 10.0)?;
            /// let v = model.continuous("v", -1.0, 1.0)?;
            /// let still = [x.equals(0.0), v.within(-0.1, 0.1)];
            /// let added = model.add("dock", docked.on().implies_all(still))?;
            /// assert_eq!(added.len(), 2);
            /// assert_eq!(model.indicator_by_name("dock_2")?, added[1]);
            /// # Ok::<(), carom::Error>(())
            /// ```
            pub fn implies_all<R>(
                $self: $receiver,
                rows: impl IntoIterator<Item = R>,
            ) -> Implications<R>
            where
                R: Consequent<Output = Implication<R>>,
            {
                Implications { condition: $self.into(), rows: rows.into_iter().collect() }
            }

            /// "This holds exactly when the row does", with a margin between the two cases.
            ///
            /// For `expr <= b`: if this holds, `expr <= b`; if not, `expr >= b + margin`. Values
            /// strictly in between are excluded, because a solver cannot tell `> b` from `>= b`.
            /// `expr >= b` is the mirror image. A two-sided row fails by at least the margin below
            /// *or* above; another binary of the model, `name_above`, tells which.
            ///
            /// # Arguments
            ///
            /// * `margin`: in the row's unit, finite and greater than 0; choose it well above
            ///   the feasibility tolerance.
            ///
            /// ```
            /// use carom::prelude::*;
            ///
            /// let mut model = Model::new("m");
            /// let near = model.binary("near")?;
            /// let x = model.continuous("x", 0.0, 10.0)?;
            /// model.add("near", near.on().reify(x.le(4.0), 0.5))?;
            /// assert!(model.to_string().contains(
            ///     "  near: near = 1 implies x <= 4\n  near_else: near = 0 implies x >= 4.5\n"
            /// ));
            /// # Ok::<(), carom::Error>(())
            /// ```
            pub fn reify($self: $receiver, row: Row, margin: f64) -> Reification {
                Reification { condition: $self.into(), row, margin }
            }
        }
    };
}

methods!(Logic, self: &Self);
methods!(Literal, self: Self);
methods!(Variable, self: Self);
