//! Regions in which a run must be: starts, goals, way-points, time windows.

use std::ops::RangeInclusive;

use super::{AtSample, HybridProgram, ProgramSystems};
use crate::error::{Error, ErrorKind};
use crate::hybrid::rows::SystemVariables;
use crate::hybrid::system::{IntoRegion, Meaning, Region, StatedRegion, SystemRow, outside_domain};
use crate::interval::Interval;
use crate::model::{Affine, Either, Model, Term, Variable};
use crate::tolerance;

/// The names of the statements of starts and goals.
const START: &str = "start";
const GOAL: &str = "goal";

/// At which samples, from 0 to the number of steps τ, a run must be in a region.
///
/// `Throughout` and `OnceIn` are the bounded operators *always* and *eventually* of signal temporal
/// logic, for a region. Formulas that nest them are [missions](crate::hybrid::Mission).
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum When {
    /// At one sample: 0 is the start, τ the end.
    At(usize),
    /// At every sample of a window.
    #[doc(alias = "always")]
    Throughout(RangeInclusive<usize>),
    /// At some sample of a window, which the plan chooses.
    #[doc(alias = "eventually")]
    OnceIn(RangeInclusive<usize>),
}

/// Refuses samples beyond the horizon and empty windows.
fn check_window(
    name: &str,
    when: &When,
    window: &RangeInclusive<usize>,
    steps: usize,
) -> Result<(), Error> {
    let (first, last) = (*window.start(), *window.end());
    let (what, sample) = match when {
        When::At(_) if last > steps => ("sample", last),
        When::At(_) => return Ok(()),
        _ if first > steps => ("first sample", first),
        _ if window.is_empty() || last > steps => ("last sample", last),
        _ => return Ok(()),
    };
    let (what, sample) = (format!("the {what} of `{name}`"), sample as f64);
    Err(match first <= steps && window.is_empty() {
        true => Error::out_of_range_with(what, sample, first as f64.., ", the first sample"),
        false => {
            let more = ", the last sample of the horizon";
            Error::out_of_range_with(what, sample, ..=steps as f64, more)
        }
    })
}

/// The rows of a region at a sample.
type RowsAt<'a> = dyn Fn(usize) -> Result<Vec<SystemRow>, Error> + 'a;

impl HybridProgram {
    /// Requires the plan to begin in a region, as [`require`](HybridProgram::require) does with the
    /// name `start`.
    ///
    /// # Errors
    ///
    /// Those of [`require`](HybridProgram::require); [`ErrorKind::OutOfRange`] for a value outside
    /// the domain of its state.
    pub fn start(&mut self, region: impl IntoRegion) -> Result<(), Error> {
        self.require(START, region, When::At(0))
    }

    /// Requires the plan to end in a region, as [`require`](HybridProgram::require) does with the
    /// name `goal`.
    ///
    /// # Errors
    ///
    /// Those of [`require`](HybridProgram::require); [`ErrorKind::Misplaced`] for inputs, outputs
    /// and transitions, which have no value at the last sample.
    pub fn goal(&mut self, region: impl IntoRegion) -> Result<(), Error> {
        self.require(GOAL, region, When::At(self.steps()))
    }

    /// Requires rows of the systems' handles to hold at given samples: starts, goals, way-points,
    /// time windows. A mode is required by `on.equals(1.0)`, a disc by
    /// `norm([x - 4.0, y - 1.0]).le(0.5)`.
    ///
    /// The statements are `name[t]`. If there are several at a sample, a row about a state `x`
    /// alone is `name_x[t]`, and the `k`-th of all rows, counted from 0, is `name_k[t]` otherwise.
    /// For [`When::OnceIn`] it is one disjunction, `name`.
    ///
    /// # Errors
    ///
    /// Those of [`at`](HybridProgram::at); [`ErrorKind::OutOfRange`] for samples beyond the horizon
    /// or an empty window; [`ErrorKind::DuplicateName`]. The model then stays as it was.
    pub fn require(
        &mut self,
        name: &str,
        region: impl IntoRegion,
        when: When,
    ) -> Result<(), Error> {
        self.require_stated(name, &region.stated(), when)
    }

    pub(crate) fn require_stated(
        &mut self,
        name: &str,
        region: &StatedRegion,
        when: When,
    ) -> Result<(), Error> {
        let (systems, steps) = (self.systems.clone(), self.steps());
        match region {
            StatedRegion::Region(region) => {
                if name == START && when == When::At(0) {
                    let system = systems.first().system();
                    let ranges = system.states.iter().zip(&region.ranges);
                    ranges.into_iter().try_for_each(|(state, range)| check_start(state, *range))?;
                }
                systems.first().require(&mut self.model, name, region, when)
            }
            StatedRegion::Rows(rows) => {
                systems.check_ends(name, rows, &when)?;
                let at = |sample: usize| {
                    let own = |row: &SystemRow| {
                        let row = row.at_sample(&systems, sample)?;
                        Ok(if is_infeasible(&row) {
                            systems.first().infeasible_row_at(sample).into()
                        } else {
                            row
                        })
                    };
                    rows.iter().map(own).collect::<Result<Vec<SystemRow>, Error>>()
                };
                add(&mut self.model, name, when, steps, &at)
            }
        }
    }
}

/// Whether a row has no variables and holds.
fn is_always(row: &SystemRow) -> bool {
    matches!(row, SystemRow::Row(row) if row.is_constant_and_holds())
}

/// Whether a row has no variables and does not hold, as one about an output that no transition
/// states.
fn is_infeasible(row: &SystemRow) -> bool {
    let SystemRow::Row(row) = row else { return false };
    row.expression().terms().is_empty()
        && row.lower() <= row.upper()
        && !row.is_constant_and_holds()
}

/// Refuses a start that is a single value outside the domain of its state.
fn check_start((name, domain): &(String, Interval), range: Interval) -> Result<(), Error> {
    let is_outside = range.lower == range.upper
        && (range.lower < domain.lower - tolerance::FEASIBILITY
            || range.lower > domain.upper + tolerance::FEASIBILITY);
    match is_outside {
        true => Err(outside_domain("the start", name, range.lower, *domain)),
        false => Ok(()),
    }
}

impl ProgramSystems {
    /// Refuses a start outside a domain, and what has no value at the last sample.
    fn check_ends(&self, name: &str, rows: &[SystemRow], when: &When) -> Result<(), Error> {
        for row in rows {
            let SystemRow::Row(row) = row else { continue };
            let terms = row.expression().terms();
            if *when == When::At(self.steps) && name == GOAL {
                self.check_goal(&terms)?;
            }
            if let (START, When::At(0), [(handle, factor)]) = (name, when, &terms[..])
                && let Some((own, Meaning::State(i))) = self.meaning(*handle)
            {
                let [lower, upper] = [row.lower(), row.upper()]
                    .map(|end| (end - row.expression().offset()) / factor);
                check_start(&own.system().states[*i], Interval::new(lower, upper))?;
            }
        }
        Ok(())
    }

    /// Refuses handles that have values in steps alone, because no step begins at the last sample.
    fn check_goal(&self, terms: &[(Variable, f64)]) -> Result<(), Error> {
        for (handle, _) in terms {
            let Some((own, meaning)) = self.meaning(*handle) else { continue };
            let what = match meaning {
                Meaning::Input(_) => "input",
                Meaning::Output(_) => "output",
                Meaning::Taken(..) => "transition",
                Meaning::Acting(..) => "mode that acts",
                _ => continue,
            };
            let name = format!("the {what} `{}`", own.system().handle_name(*handle));
            let help = "goals are rows of states and modes at the last sample, at which no step begins; \
                        require it of steps by `require`, such as `When::Throughout(0..=steps - 1)`";
            return Err(ErrorKind::Misplaced { name, place: "a goal".to_owned(), help }.into());
        }
        Ok(())
    }
}

/// Adds the rows of a region at the samples of a window.
fn add(
    model: &mut Model,
    name: &str,
    when: When,
    steps: usize,
    rows: &RowsAt<'_>,
) -> Result<(), Error> {
    let window = match &when {
        When::At(sample) => *sample..=*sample,
        When::Throughout(window) | When::OnceIn(window) => window.clone(),
    };
    check_window(name, &when, &window, steps)?;
    model.all_or_nothing(|model| {
        if let When::OnceIn(_) = when {
            let samples = window.map(rows).collect::<Result<Vec<_>, _>>()?;
            // A term without rows is always true.
            if samples.iter().all(|rows| !rows.iter().all(is_always)) {
                let term = |rows: Vec<SystemRow>| {
                    let rows = rows.into_iter().filter(|row| !is_always(row));
                    rows.fold(Term::default(), |term, row| match row {
                        SystemRow::Row(row) => term.and(row),
                        SystemRow::Conic(row) => term.and(row),
                        SystemRow::Nonlinear(row) => term.and(row),
                    })
                };
                model.add(name, Either::of(samples.into_iter().map(term)))?;
            }
            return Ok(());
        }
        for sample in window {
            let rows = rows(sample)?;
            let families = families(model, name, &rows)?;
            for (row, (family, words)) in rows.into_iter().zip(families) {
                model.describe(&family, words);
                match row {
                    // Whoever has only one mode is in it.
                    row if is_always(&row) => {}
                    SystemRow::Row(row) => {
                        model.add((family, sample), row)?;
                    }
                    SystemRow::Conic(row) => {
                        model.add((family, sample), row)?;
                    }
                    SystemRow::Nonlinear(row) => {
                        model.add((family, sample), row)?;
                    }
                }
            }
        }
        Ok(())
    })
}

/// The families of the rows of a region at a sample, each with its words.
fn families(model: &Model, name: &str, rows: &[SystemRow]) -> Result<Vec<(String, String)>, Error> {
    let called = match name {
        START | GOAL => format!("the {name}"),
        _ => format!("`{name}`"),
    };
    if rows.len() == 1 {
        return Ok(vec![(name.to_owned(), called)]);
    }
    let mut families: Vec<(String, String)> = Vec::new();
    for (k, row) in rows.iter().enumerate() {
        let terms = match row {
            SystemRow::Row(row) => row.expression().terms(),
            SystemRow::Conic(_) | SystemRow::Nonlinear(_) => Vec::new(),
        };
        let quantities = terms.iter().map(|(variable, _)| model.variable_ref(*variable));
        let quantities = quantities.map(|own| Ok(own?.name().family().to_owned()));
        let quantities = quantities.collect::<Result<Vec<String>, Error>>()?;
        let own = match &quantities[..] {
            [one] => Some(format!("{name}_{one}")),
            _ => None,
        };
        let is_taken = |own: &str| families.iter().any(|(known, _)| known == own);
        // A second row about a state is known by its number, as rows about several are.
        let mut family = own.filter(|own| !is_taken(own)).unwrap_or_else(|| format!("{name}_{k}"));
        while is_taken(&family) {
            family.push('_');
        }
        let words = match quantities.is_empty() {
            true => called.clone(),
            false => format!("{called} of `{}`", quantities.join("`, `")),
        };
        families.push((family, words));
    }
    Ok(families)
}

impl HybridProgram {
    /// Requires a region of the first system at a sample, which is in the coordinates of its
    /// variables.
    pub(crate) fn require_own(
        &mut self,
        name: &str,
        region: &Region,
        sample: usize,
    ) -> Result<(), Error> {
        let (systems, steps) = (self.systems.clone(), self.steps());
        let own = systems.first();
        region.check(own.computed(), "the region")?;
        let rows = |sample| own.rows_of(region, sample);
        add(&mut self.model, name, When::At(sample), steps, &rows)
    }
}

impl SystemVariables {
    /// Requires the run to be in a region, in one of its modes, at given samples.
    #[doc(hidden)]
    pub fn require(
        &self,
        model: &mut Model,
        name: &str,
        region: &Region,
        when: When,
    ) -> Result<(), Error> {
        region.check(self.system(), "the region")?;
        let region = self.coordinates().region(region);
        let rows = |sample| self.rows_of(&region, sample);
        add(model, name, when, self.horizon().steps(), &rows)
    }

    /// The rows that state that a sample is in a region, modes included.
    fn rows_of(&self, region: &Region, sample: usize) -> Result<Vec<SystemRow>, Error> {
        let states: Vec<Affine> = self
            .states()
            .iter()
            .filter_map(|family| family.get(sample))
            .map(Affine::from)
            .collect();
        let mut rows: Vec<SystemRow> =
            region.rows(&states)?.into_iter().map(SystemRow::from).collect();
        rows.extend(region.discs(&states)?.into_iter().map(SystemRow::from));
        let coordinates = self.coordinates();
        let stated: Vec<Affine> = (0..states.len())
            .map(|i| self.in_units(coordinates.state(i), self.states()[i][sample]))
            .collect();
        rows.extend(region.nonlinear.iter().map(|own| SystemRow::from(own.over(&stated))));
        for (c, choice) in self.system().choices.iter().enumerate() {
            let allows = |mode: &&str| region.allows(&choice.name, mode);
            let modes = choice.modes();
            if modes.iter().all(allows) {
                continue;
            }
            let allowed = modes.into_iter().filter(allows);
            let allowed = allowed.map(|mode| self.mode_value(c, mode, sample));
            rows.push(allowed.sum::<Result<Affine, Error>>()?.ge(1.0).into());
        }
        Ok(rows)
    }
}
