//! Logic as rows.
//!
//! Takes a formula over binaries; leaves rows, and auxiliary binaries for parts of the formula
//! (Plaisted and Greenbaum, A structure-preserving clause form translation, Journal of Symbolic
//! Computation 2, 1986).
//!
//! With `l = z` for a literal "on" and `l = 1 - z` for one "off", over binaries:
//!
//! | formula | rows |
//! | --- | --- |
//! | clause `l1 or l2 or ...` | `l1 + l2 + ... >= 1` |
//! | `k` to `m` of `l1, ..., ln` | `k <= l1 + ... + ln <= m` |
//! | `l1 xor l2`, `l1 iff l2` | `l1 + l2 = 1`, `l1 = l2` |
//! | longer parities | up to eight clauses, or `l1 + ... + ln = 2 k + 1` with an integer `k` |
//! | fewer or more than `k` to `m` | a binary for which of the two, one row each |
//! | conjunction | the rows of its members |
//! | disjunction of literals `g` and one formula | its rows, each relaxed by a multiple of the sum of `g` |
//! | disjunction of several formulas | up to eight rows by distribution; else binaries for all but one |
//!
//! An auxiliary binary represents a formula only in the direction that is needed: if the formula
//! occurs positively, the binary implies it; if negatively, it implies the binary. Equal formulas
//! share one, across statements.

use super::clauses::{Clause, clauses, product, tidy};
use super::lowering::Lowering;
use crate::error::Error;
use crate::model::{Formula, Literal, Logic, LogicalConstraintRef, Variable, VariableKind, merge};

/// The largest number of clauses that are written out instead of adding an auxiliary variable.
const MAX_CLAUSES: usize = 8;

/// The largest number of clauses that are written out for the condition of a row, each with its own
/// big-M.
const MAX_CONDITION_CLAUSES: usize = 4;

/// The auxiliary binary of a formula, and which directions have rows.
#[derive(Debug, Clone, Copy)]
pub(super) struct AuxiliaryBinary {
    variable: Variable,
    /// The binary implies the formula.
    implies: bool,
    /// The formula implies the binary.
    implied: bool,
}

/// Which direction of an auxiliary binary is needed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Needed {
    Implies,
    Implied,
    Both,
}

impl Needed {
    fn mirrored(self) -> Self {
        match self {
            Needed::Implies => Needed::Implied,
            Needed::Implied => Needed::Implies,
            Needed::Both => Needed::Both,
        }
    }
}

/// Adds the rows of one logic statement.
pub(super) fn apply(
    statement: &LogicalConstraintRef<'_>,
    lowering: &mut Lowering<'_>,
) -> Result<(), Error> {
    lowering.begin(statement.name());
    lowering.assert(&[], &Formula::of(statement.logic(), true))
}

impl Lowering<'_> {
    /// Clauses of which one is false whenever the condition holds. A row that follows from the
    /// condition must hold whenever one of them is false.
    pub(super) fn unless(&mut self, condition: &Logic) -> Result<Vec<Clause>, Error> {
        if let Some(literal) = condition.as_literal() {
            return Ok(vec![vec![!literal]]);
        }
        let fails = Formula::of(condition, false);
        match clauses(&fails, MAX_CONDITION_CLAUSES) {
            Some(clauses) => Ok(clauses),
            None => Ok(vec![vec![!self.part(&fails.negated(), Needed::Implied)?]]),
        }
    }

    /// Adds rows for "`formula`, or one of `guard`".
    fn assert(&mut self, guard: &[Literal], formula: &Formula) -> Result<(), Error> {
        match formula {
            Formula::Constant(true) => Ok(()),
            Formula::Constant(false) => self.clause(guard.to_vec()),
            Formula::Literal(literal) => self.clause([guard, &[*literal]].concat()),
            Formula::And(of) => of.iter().try_for_each(|member| self.assert(guard, member)),
            Formula::Or(of) => self.disjunction(guard, of),
            Formula::Parity { odd, of } => self.parity(guard, *odd, of),
            Formula::Count { at_least, at_most, of } => {
                let needed = match (*at_least > 0, *at_most < of.len()) {
                    (true, false) => Needed::Implies,
                    (false, _) => Needed::Implied,
                    (true, true) => Needed::Both,
                };
                let literals = self.literals(of, needed)?;
                self.count(guard, *at_least, *at_most, &literals)
            }
            Formula::Except { at_least, at_most, of } => {
                let literals = self.literals(of, Needed::Both)?;
                let more = self.column("more", VariableKind::Binary, 0.0, 1.0)?;
                self.count(&[guard, &[more.on()]].concat(), 0, at_least - 1, &literals)?;
                let (least, all) = (at_most + 1, literals.len());
                self.count(&[guard, &[more.off()]].concat(), least, all, &literals)
            }
        }
    }

    fn disjunction(&mut self, guard: &[Literal], of: &[Formula]) -> Result<(), Error> {
        let mut guard = guard.to_vec();
        guard.extend(of.iter().filter_map(Formula::as_literal));
        let mut rest: Vec<&Formula> = of.iter().filter(|f| f.as_literal().is_none()).collect();
        // The rows of the body are relaxed by the other members, so the body is the member with
        // most rows.
        let rows = |f: &Formula| clauses(f, MAX_CLAUSES).map_or(usize::MAX, |c| c.len().max(1));
        let Some(body) = (0..rest.len()).max_by_key(|&k| rows(rest[k])) else {
            return self.clause(guard);
        };
        let body = rest.remove(body);
        let body_rows = match body {
            Formula::Count { .. } => 2,
            other => rows(other),
        };
        let mut guards = vec![guard];
        for formula in rest {
            let limit = MAX_CLAUSES / body_rows;
            let distributed =
                clauses(formula, limit).and_then(|clauses| product(&guards, &clauses, limit));
            match distributed {
                Some(longer) => guards = longer,
                None => {
                    let part = self.part(formula, Needed::Implies)?;
                    guards.iter_mut().for_each(|guard| guard.push(part));
                }
            }
        }
        guards.iter().try_for_each(|guard| self.assert(guard, body))
    }

    fn parity(&mut self, guard: &[Literal], odd: bool, of: &[Formula]) -> Result<(), Error> {
        let literals: Option<Vec<Literal>> = of.iter().map(Formula::as_literal).collect();
        if let (Some([first, second]), []) = (literals.as_deref(), guard) {
            return match odd {
                true => self.linear(&[(*first, 1.0), (*second, 1.0)], 1.0, 1.0),
                false => self.linear(&[(*first, 1.0), (*second, -1.0)], 0.0, 0.0),
            };
        }
        let whole = Formula::Parity { odd, of: of.to_vec() };
        if let Some(clauses) = clauses(&whole, MAX_CLAUSES) {
            return clauses.into_iter().try_for_each(|c| self.clause([guard, &c].concat()));
        }
        if let [first, second] = of {
            // The literal, if any, decides the direction of the other member.
            let (one, other) =
                if second.as_literal().is_some() { (second, first) } else { (first, second) };
            let one = self.part(one, Needed::Both)?;
            // Both directions are written out here. A nested formula of this kind gets a binary,
            // because otherwise the number of rows doubles at every level.
            let same = match other.is_two_sided() {
                true => Formula::Literal(self.part(other, Needed::Both)?),
                false => other.clone(),
            };
            let (on, off) =
                if odd { (same.negated(), same) } else { (same.clone(), same.negated()) };
            self.assert(&[guard, &[!one]].concat(), &on)?;
            return self.assert(&[guard, &[one]].concat(), &off);
        }
        let literals = self.literals(of, Needed::Both)?;
        let small =
            Formula::Parity { odd, of: literals.iter().map(|l| Formula::Literal(*l)).collect() };
        if let Some(clauses) = clauses(&small, MAX_CLAUSES) {
            return clauses.into_iter().try_for_each(|c| self.clause([guard, &c].concat()));
        }
        // The sum is odd (or even): sum - 2 pairs = 1 (or 0).
        let (odd, n) = (f64::from(u8::from(odd)), literals.len() as f64);
        let most = ((n - odd) / 2.0).floor();
        let pairs = self.column("pairs", VariableKind::Integer, 0.0, most)?;
        let sum = |m: f64| {
            let literals = literals.iter().map(|&l| (l, 1.0));
            literals.chain(guard.iter().map(move |&g| (g, m))).collect::<Vec<_>>()
        };
        let twice = Some((pairs, -2.0));
        if guard.is_empty() {
            return self.linear_with(&sum(0.0), twice, odd, odd);
        }
        self.linear_with(&sum(odd + 2.0 * most), twice, odd, f64::INFINITY)?;
        self.linear_with(&sum(-(n - odd)), twice, f64::NEG_INFINITY, odd)
    }

    fn count(
        &mut self,
        guard: &[Literal],
        at_least: usize,
        at_most: usize,
        literals: &[Literal],
    ) -> Result<(), Error> {
        let n = literals.len();
        let (low, high) = (at_least as f64, at_most as f64);
        let sum = |m: f64| {
            let literals = literals.iter().map(|&l| (l, 1.0));
            literals.chain(guard.iter().map(move |&g| (g, m))).collect::<Vec<_>>()
        };
        let (lower, upper) = (at_least > 0, at_most < n);
        if guard.is_empty() && lower && upper {
            return self.linear(&sum(0.0), low, high);
        }
        if lower {
            self.linear(&sum(low), low, f64::INFINITY)?;
        }
        if upper {
            self.linear(&sum(high - n as f64), f64::NEG_INFINITY, high)?;
        }
        Ok(())
    }

    /// Each formula as a literal, through an auxiliary binary if it is not one.
    fn literals(&mut self, of: &[Formula], needed: Needed) -> Result<Vec<Literal>, Error> {
        of.iter().map(|formula| self.part(formula, needed)).collect()
    }

    /// A literal that represents a formula in the needed direction.
    fn part(&mut self, formula: &Formula, needed: Needed) -> Result<Literal, Error> {
        if let Some(literal) = formula.as_literal() {
            return Ok(literal);
        }
        let opposite = formula.negated();
        if !self.parts.contains_key(formula) && self.parts.contains_key(&opposite) {
            return Ok(!self.part(&opposite, needed.mirrored())?);
        }
        let mut part = match self.parts.get(formula) {
            Some(part) => *part,
            None => {
                let variable = self.column("part", VariableKind::Binary, 0.0, 1.0)?;
                AuxiliaryBinary { variable, implies: false, implied: false }
            }
        };
        let literal = part.variable.on();
        let implies = needed != Needed::Implied && !part.implies;
        let implied = needed != Needed::Implies && !part.implied;
        part.implies |= implies;
        part.implied |= implied;
        self.parts.insert(formula.clone(), part);
        if implies {
            self.assert(&[!literal], formula)?;
        }
        if implied {
            self.assert(&[literal], &opposite)?;
        }
        Ok(literal)
    }

    fn clause(&mut self, clause: Clause) -> Result<(), Error> {
        match tidy(clause) {
            Some(clause) => {
                let sum: Vec<_> = clause.into_iter().map(|literal| (literal, 1.0)).collect();
                self.linear(&sum, 1.0, f64::INFINITY)
            }
            None => Ok(()),
        }
    }

    fn linear(&mut self, sum: &[(Literal, f64)], lower: f64, upper: f64) -> Result<(), Error> {
        self.linear_with(sum, None, lower, upper)
    }

    /// The row `lower <= sum of literals (+ one more term) <= upper`. Coefficients are integers, so
    /// nothing is rounded.
    fn linear_with(
        &mut self,
        sum: &[(Literal, f64)],
        more: Option<(Variable, f64)>,
        mut lower: f64,
        mut upper: f64,
    ) -> Result<(), Error> {
        let mut terms: Vec<(Variable, f64)> = more.into_iter().collect();
        for &(literal, factor) in sum {
            if literal.is_on() {
                terms.push((literal.variable(), factor));
            } else {
                terms.push((literal.variable(), -factor));
                lower -= factor;
                upper -= factor;
            }
        }
        merge(&mut terms);
        self.row(terms, lower, upper)
    }
}
