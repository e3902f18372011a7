//! The audit: which big-M rows can leak within tolerances, before anything is solved.
//!
//! A solver accepts a binary as integral within one tolerance and a row as satisfied within
//! another. If the first times M exceeds the second, a binary that is nearly 0 can relax its row
//! noticeably, and a plan may pass through a wall ("trickle flow"). This crate rounds the binaries
//! of every point that it accepts and checks the statements themselves, so it refuses such plans.
//! Other backends do not, and a large M makes a weak relaxation for all of them.

use std::collections::HashMap;
use std::fmt;

use super::report::{BigMEntry, BigMSource, Share, Side};
use super::{BigMReport, Lowered};
use crate::model::{ConstraintRef, Model, VariableKind};

/// The advice about a row of the model itself.
const BY_HAND: &str = "write it as an indicator, so that its M comes from the bounds, or tighten \
                       the bounds that it comes from";

/// The advice about a row of a function or a hull.
const WITHOUT_M: &str = "tighten the bounds of the continuous variables in it, from which its \
                         coefficients come";

/// A row that can leak.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Leak {
    /// The row of the lowered model.
    pub row: String,
    /// The statement that it comes from, if that has a big-M. `None` if the row was written by hand
    /// or belongs to a function or a hull.
    pub statement: Option<String>,
    /// The integer variable with the largest coefficient.
    pub switch: String,
    /// That coefficient's magnitude, in the row's unit.
    pub big_m: f64,
    /// Integrality tolerance times `big_m`: how much the row can be violated, in its unit.
    pub leak: f64,
    /// The feasibility tolerance of the row, in its unit.
    pub allowed: f64,
    /// The advice on what to do about it.
    pub advice: String,
}

impl Leak {
    /// The leak divided by the feasibility tolerance (no unit).
    pub fn ratio(&self) -> f64 {
        self.leak / self.allowed
    }
}

/// The rows of a lowered model that leak more than a tolerance allows, worst first; made by
/// [`Lowered::audit`].
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Audit {
    leaks: Vec<Leak>,
    rows: usize,
}

impl Audit {
    /// The rows that leak, worst first.
    pub fn leaks(&self) -> &[Leak] {
        &self.leaks
    }

    /// Number of switched rows that were checked.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Whether no row leaks.
    pub fn is_tight(&self) -> bool {
        self.leaks.is_empty()
    }
}

impl fmt::Display for Audit {
    /// One line per leak, worst first, with advice.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for leak in &self.leaks {
            let Leak { row, switch, big_m, leak, allowed, advice, .. } = leak;
            writeln!(
                f,
                "{row}: `{switch}` can relax it by {leak:.1e} (M = {big_m}), but the tolerance is \
                 {allowed:.0e}; {advice}"
            )?;
        }
        Ok(())
    }
}

impl Lowered {
    /// Compares, for every row of the lowered model that an integer variable switches, the
    /// integrality tolerance times M with the feasibility tolerance.
    ///
    /// ```
    /// use carom::prelude::*;
    /// use carom::reformulate;
    ///
    /// let mut model = Model::new("m");
    /// let x = model.continuous("x", -5e4, 1e3)?;
    /// let open = model.binary("open")?;
    /// model.add("wall", open.off().implies(x.ge(0.0)))?;
    /// let lowered = reformulate::lower(&model)?;
    /// let audit = lowered.audit(1e-6, 1e-6);
    /// assert_eq!(
    ///     audit.to_string(),
    ///     "wall_lower: `open` can relax it by 5.0e-2 (M = 50000), but the tolerance is 1e-6; raise \
    ///      the lower bound of `x` from -50000 to at least -1\n"
    /// );
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Arguments
    ///
    /// * `integrality`: the integrality tolerance of the backend (no unit); see
    ///   [`tolerance::INTEGRALITY`](crate::tolerance::INTEGRALITY).
    /// * `feasibility`: the feasibility tolerance of the backend, in the unit of each row; see
    ///   [`tolerance::FEASIBILITY`](crate::tolerance::FEASIBILITY).
    pub fn audit(&self, integrality: f64, feasibility: f64) -> Audit {
        let sources = by_row(self.report());
        let (model, mut audit) = (self.model(), Audit::default());
        for (place, row) in model.constraints().enumerate() {
            let name = row.name().to_string();
            let entry = sources.get(name.as_str()).copied();
            let Some((switch, big_m)) = switch(model, &row, entry.is_some()) else { continue };
            audit.rows += 1;
            let leak = integrality * big_m;
            if leak <= feasibility {
                continue;
            }
            audit.leaks.push(Leak {
                row: name,
                statement: entry.map(|entry| entry.indicator.clone()),
                switch,
                big_m,
                leak,
                allowed: feasibility,
                advice: match entry {
                    Some(entry) => advice(model, entry, feasibility / integrality),
                    None if place < self.written => BY_HAND.into(),
                    None => WITHOUT_M.into(),
                },
            });
        }
        audit.leaks.sort_by(|a, b| b.leak.total_cmp(&a.leak));
        audit
    }
}

fn by_row(report: &BigMReport) -> HashMap<&str, &BigMEntry> {
    report.entries().iter().filter_map(|entry| Some((entry.row.as_deref()?, entry))).collect()
}

/// The integer variable with the largest coefficient, in a row that also has continuous variables
/// or, if the row has a big-M, integers that are not binary.
fn switch(model: &Model, row: &ConstraintRef<'_>, has_m: bool) -> Option<(String, f64)> {
    let (mut switched, mut largest) = (false, None::<(String, f64)>);
    for &(variable, coefficient) in row.terms() {
        let variable = model.variable_ref(variable).ok()?;
        switched |= has_m && variable.kind() == VariableKind::Integer;
        if variable.kind() == VariableKind::Continuous {
            switched = true;
        } else if largest.as_ref().is_none_or(|(_, most)| coefficient.abs() > *most) {
            largest = Some((variable.name().to_string(), coefficient.abs()));
        }
    }
    largest.filter(|_| switched)
}

/// Advice that would reduce an M to `most`.
fn advice(model: &Model, entry: &BigMEntry, most: f64) -> String {
    if matches!(entry.source, BigMSource::Given | BigMSource::Assumed) && entry.needed < entry.value
    {
        return format!("omit its M: the bounds prove {}", entry.needed);
    }
    // Which bound to change, and how far, if it is the only one.
    let spread = |part: f64| if part.is_finite() { part } else { f64::INFINITY };
    let widest = entry.shares.iter().max_by(|a, b| spread(a.part).total_cmp(&spread(b.part)));
    if let Some((share, bound)) =
        widest.and_then(|share| Some((share, moved(model, share, entry.needed - most)?)))
    {
        let name = &share.variable;
        return match share.bound {
            bound_side if share.implied => {
                let (side, most) = match bound_side {
                    Side::Lower => ("a lower", "least"),
                    Side::Upper => ("an upper", "most"),
                };
                let implied = share.value;
                format!("give `{name}` {side} bound of at {most} {bound} (rows imply {implied})")
            }
            Side::Lower => {
                format!(
                    "raise the lower bound of `{name}` from {} to at least {bound}",
                    share.value
                )
            }
            Side::Upper => {
                format!("lower the upper bound of `{name}` from {} to at most {bound}", share.value)
            }
        };
    }
    match &entry.largest {
        Some(name) if entry.source == BigMSource::LinearProgram => {
            format!(
                "tighten the bounds of `{name}` and its neighbours, or the rows that limit them"
            )
        }
        Some(name) => format!(
            "tighten the bounds of `{name}` and its neighbours, or use linear programs \
             (`Reformulation::with_linear_programs`)"
        ),
        None => "use linear programs (`Reformulation::with_linear_programs`)".into(),
    }
}

/// The value of a bound that reduces its share by `excess`. `None` if the share is smaller or if
/// that value would cross the variable's other bound.
fn moved(model: &Model, share: &Share, excess: f64) -> Option<f64> {
    let variable =
        model.variable_ref(model.variable_by_name(share.variable.as_str()).ok()?).ok()?;
    let bounds = variable.parameter_range().unwrap_or(variable.bounds());
    // No negative zero.
    let bound = share.value * (share.part - excess) / share.part + 0.0;
    (share.part > 0.0 && share.part >= excess && bounds.contains(bound)).then_some(bound)
}
