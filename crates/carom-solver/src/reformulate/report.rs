//! The report: the origin of every big-M.

use std::fmt;

use super::lowering::Lowering;
use crate::error::Error;
use crate::model::{Name, Variable};

/// Which side of an indicator's row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Side {
    /// `a'x >= lower`.
    Lower,
    /// `a'x <= upper`.
    Upper,
}

impl Side {
    pub(super) fn word(self) -> &'static str {
        match self {
            Side::Lower => "lower",
            Side::Upper => "upper",
        }
    }
}

/// The treatment of one side of an indicator, and the origin of its M.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BigMSource {
    /// M from interval arithmetic over the current bounds.
    Bounds,
    /// M from bounds of which at least one is implied by rows, because a variable has none of its
    /// own: see [`BigMShare::implied`].
    ImpliedBounds,
    /// M from linear programs: with [`Method::MultiM`](crate::model::Method::MultiM) the largest
    /// of the row's Ms.
    LinearProgram,
    /// The user's M, proved by the bounds.
    Given,
    /// The user's M, used without proof.
    Assumed,
    /// No row: the bounds alone imply this side.
    Implied,
    /// The row without an M: the condition is fixed to hold.
    ConditionHolds,
    /// No row: the condition is fixed not to hold.
    ConditionFails,
}

/// A bound that an M comes from.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BigMShare {
    /// The variable.
    pub variable: String,
    /// Which of its bounds.
    pub bound: Side,
    /// The bound, in the variable's unit.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub value: f64,
    /// Its contribution to the violation: coefficient times bound, in the row's unit, positive if
    /// it increases the violation of this side.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub part: f64,
    /// Whether rows imply the bound, because the variable has none of its own.
    #[cfg_attr(feature = "serde", serde(default))]
    pub implied: bool,
}

/// One side of one indicator or row of a disjunction, one expression of a function, or one side of
/// a member of an ordered set or of a semi-continuous variable.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BigMEntry {
    /// The indicator, the variable of the function, the semi-continuous variable, the member of an
    /// ordered set of the first kind, or `set_k` for the k-th member of a `set` of the second kind.
    pub indicator: String,
    /// The side of its row.
    pub side: Side,
    /// The treatment of the side.
    pub source: BigMSource,
    /// The M in the lowered row, in the unit of the indicator's row; 0 if there is none.
    pub value: f64,
    /// The smallest M that the bounds prove, in the row's unit (linear programs may prove a smaller
    /// one); infinite if a bound is missing.
    #[cfg_attr(feature = "serde", serde(with = "crate::serde_numbers"))]
    pub needed: f64,
    /// The variable that contributes most to `needed`.
    pub largest: Option<String>,
    /// The bounds that `needed` comes from, by variable.
    pub shares: Vec<BigMShare>,
    /// The row of the lowered model, if there is one.
    pub row: Option<String>,
}

impl BigMEntry {
    pub(super) fn new(name: &Name, side: Side, source: BigMSource) -> Self {
        let (indicator, shares) = (name.to_string(), Vec::new());
        BigMEntry {
            indicator,
            side,
            source,
            value: 0.0,
            needed: 0.0,
            largest: None,
            shares,
            row: None,
        }
    }

    /// Records which bounds the violation of a side comes from, and which variable contributes
    /// most.
    pub(super) fn note_shares(
        &mut self,
        lowering: &Lowering<'_>,
        terms: &[(Variable, f64)],
        side: Side,
    ) -> Result<(), Error> {
        let sign = if side == Side::Upper { 1.0 } else { -1.0 };
        let mut widest = -1.0;
        for &(variable, coefficient) in terms {
            let bounds = lowering.bounds(variable)?;
            let variable = lowering.model.variable_ref(variable)?;
            let (own, slope) = (variable.bounds(), sign * coefficient);
            let (bound, value, implied) = match slope > 0.0 {
                true => (Side::Upper, bounds.upper, bounds.upper < own.upper),
                false => (Side::Lower, bounds.lower, bounds.lower > own.lower),
            };
            let name = variable.name().to_string();
            let spread = (bounds * slope).width();
            let spread =
                if value.is_infinite() || spread.is_nan() { f64::INFINITY } else { spread };
            if spread > widest {
                widest = spread;
                self.largest = Some(name.clone());
            }
            self.shares.push(BigMShare {
                variable: name,
                bound,
                value,
                part: slope * value,
                implied,
            });
        }
        Ok(())
    }
}

/// Every big-M of a lowered model. A compound condition may need several rows per side, each with
/// an entry.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BigMReport {
    pub(super) entries: Vec<BigMEntry>,
}

impl BigMReport {
    /// All entries: semi-continuous variables in the order of the model, then its functions, its
    /// indicators, the rows of its disjunctions (except hulls, which have no M), and the members of
    /// its ordered sets; lower side first.
    pub fn entries(&self) -> &[BigMEntry] {
        &self.entries
    }

    /// The entries whose M is used without proof.
    pub fn assumed(&self) -> impl Iterator<Item = &BigMEntry> {
        self.entries.iter().filter(|e| e.source == BigMSource::Assumed)
    }

    /// The entry with the largest M, if any row has one.
    pub fn largest(&self) -> Option<&BigMEntry> {
        let with_m = self.entries.iter().filter(|e| e.value > 0.0);
        with_m.max_by(|a, b| a.value.total_cmp(&b.value))
    }
}

impl fmt::Display for BigMReport {
    /// One line per side: `contact upper: M = 10 from bounds (largest share: x)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for entry in &self.entries {
            write!(f, "{} {}: ", entry.indicator, entry.side.word())?;
            match entry.source {
                BigMSource::Bounds => write!(f, "M = {} from bounds", entry.value)?,
                BigMSource::ImpliedBounds => {
                    write!(f, "M = {} from bounds that rows imply", entry.value)?;
                }
                BigMSource::LinearProgram => {
                    write!(
                        f,
                        "M = {} from linear programs, {} from bounds",
                        entry.value, entry.needed
                    )?;
                }
                BigMSource::Given => {
                    write!(f, "M = {} given, {} needed", entry.value, entry.needed)?;
                }
                BigMSource::Assumed => write!(f, "M = {} assumed, not proved", entry.value)?,
                BigMSource::Implied => write!(f, "implied by bounds, no row")?,
                BigMSource::ConditionHolds => write!(f, "condition fixed, plain row")?,
                BigMSource::ConditionFails => write!(f, "condition fixed, no row")?,
            }
            match &entry.largest {
                Some(name) if entry.value > 0.0 => writeln!(f, " (largest share: {name})")?,
                _ => writeln!(f)?,
            }
        }
        Ok(())
    }
}
