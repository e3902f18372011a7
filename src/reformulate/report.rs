//! The provenance of every big-M.

use std::fmt;

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

/// Where the treatment of one side of an indicator comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum BigMSource {
    /// M from interval arithmetic over the current bounds.
    Bounds,
    /// The user's M, proved by the bounds.
    Given,
    /// The user's M, taken on trust.
    Assumed,
    /// No row: the bounds alone imply this side.
    Implied,
    /// The row without any M: the condition is fixed to hold.
    ConditionHolds,
    /// No row: the condition is fixed not to hold.
    ConditionFails,
}

/// One side of one indicator, or one expression of a function.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BigMEntry {
    /// The indicator, or the variable of the function.
    pub indicator: String,
    /// The side of its row.
    pub side: Side,
    /// How the side was treated.
    pub source: BigMSource,
    /// The M in the lowered row, in the unit of the indicator's row; 0 where there is none.
    pub value: f64,
    /// The smallest M that the bounds prove; infinite where a bound is missing.
    #[cfg_attr(feature = "serde", serde(with = "crate::wire"))]
    pub needed: f64,
    /// The variable that contributes most to `needed`.
    pub largest: Option<String>,
}

/// Every side of every indicator, in the order of the model; before them the functions that need
/// an M. A compound condition may need several rows a side, with an entry each.
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BigMReport {
    pub(super) entries: Vec<BigMEntry>,
}

impl BigMReport {
    /// All entries: functions in the order of the model, then its indicators, lower side first.
    pub fn entries(&self) -> &[BigMEntry] {
        &self.entries
    }

    /// The entries whose M was taken on trust.
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
    /// One line a side: `contact upper: M = 10 from bounds (largest share: x)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for entry in &self.entries {
            write!(f, "{} {}: ", entry.indicator, entry.side.word())?;
            match entry.source {
                BigMSource::Bounds => write!(f, "M = {} from bounds", entry.value)?,
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
