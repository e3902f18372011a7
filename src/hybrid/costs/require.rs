//! Regions in which a run must be: starts, goals, way-points, time windows.

use std::ops::RangeInclusive;

use crate::error::Error;
use crate::hybrid::rows::HybridProgram;
use crate::hybrid::system::Region;
use crate::model::{Affine, Either, Model, Row};

/// At which samples, from 0 to the number of steps τ, a run must be in a region.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum When {
    /// At one sample: 0 is the start, τ the end.
    At(usize),
    /// At every sample of a window.
    Throughout(RangeInclusive<usize>),
    /// At some sample of a window, which the plan chooses.
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
    let horizon = format!("at most {steps}, the last sample of the horizon");
    let (what, sample, range) = match when {
        When::At(_) if last > steps => ("sample", last, horizon),
        When::At(_) => return Ok(()),
        _ if first > steps => ("first sample", first, horizon),
        _ if window.is_empty() => {
            ("last sample", last, format!("at least {first}, the first sample"))
        }
        _ if last > steps => ("last sample", last, horizon),
        _ => return Ok(()),
    };
    Err(Error::out_of_range(format!("the {what} of `{name}`"), sample as f64, range))
}

impl HybridProgram {
    /// Requires the run to be in a region, in one of its modes, at given samples.
    ///
    /// The statements are `name[t]`, or `name_k[t]` if there are several at a sample; for
    /// [`When::OnceIn`] it is one disjunction, `name`.
    ///
    /// ```
    /// use carom::hybrid::{Cost, Horizon, HybridSystem, LinearSystem, Region, Transition, When};
    /// use carom::interval::Interval;
    /// use carom::prelude::*;
    ///
    /// let system = HybridSystem::new()
    ///     .with_state("x", Interval::new(0.0, 9.0))
    ///     .with_input("u", Interval::new(-2.0, 2.0))
    ///     .with_transition(Transition::new("go", LinearSystem::new([[1.0]], [[1.0]], [0.0])?));
    /// let mut model = Model::new("m");
    /// let program = system.write(&mut model, "", &Horizon::new(5, 1.0)?)?;
    /// program.require(&mut model, "start", &Region::point([0.0]), When::At(0))?;
    /// // At the depot at one of the samples 2, 3 and 4, and back in the end.
    /// let depot = Region::from([Interval::new(4.0, 5.0)]);
    /// program.require(&mut model, "depot", &depot, When::OnceIn(2..=4))?;
    /// program.require(&mut model, "back", &Region::point([0.0]), When::At(5))?;
    /// let effort = program.add_cost(&mut model, "effort", &Cost::one_norm([[0.0]], [[1.0]]))?;
    /// model.minimize(effort)?;
    /// let solution = BranchAndBound::default().solve(&model)?;
    /// assert!((solution.objective().unwrap_or(0.0) - 8.0).abs() < 1e-5);
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`](crate::ErrorKind::Length),
    /// [`ErrorKind::UnknownName`](crate::ErrorKind::UnknownName) and others for a region that does
    /// not fit the system; [`ErrorKind::OutOfRange`](crate::ErrorKind::OutOfRange) for samples
    /// beyond the horizon or an empty window;
    /// [`ErrorKind::DuplicateName`](crate::ErrorKind::DuplicateName). The model then stays as it
    /// was.
    pub fn require(
        &self,
        model: &mut Model,
        name: &str,
        region: &Region,
        when: When,
    ) -> Result<(), Error> {
        region.check(self.system(), "the region")?;
        let window = match &when {
            When::At(sample) => *sample..=*sample,
            When::Throughout(window) | When::OnceIn(window) => window.clone(),
        };
        let steps = self.horizon().steps();
        check_window(name, &when, &window, steps)?;
        model.all_or_nothing(|model| {
            if let When::OnceIn(_) = when {
                let terms = window.map(|sample| self.rows_of(region, sample));
                let terms = terms.collect::<Result<Vec<_>, _>>()?;
                // A term without rows is always true.
                if terms.iter().all(|rows| !rows.is_empty()) {
                    model.add(name, Either::of(terms))?;
                }
                return Ok(());
            }
            for sample in window {
                let rows = self.rows_of(region, sample)?;
                let single = rows.len() == 1;
                for (k, row) in rows.into_iter().enumerate() {
                    let family = if single { name.to_owned() } else { format!("{name}_{k}") };
                    model.add((family, sample), row)?;
                }
            }
            Ok(())
        })
    }

    /// The rows that state that a sample is in a region, modes included.
    fn rows_of(&self, region: &Region, sample: usize) -> Result<Vec<Row>, Error> {
        let states: Vec<Affine> = self
            .states()
            .iter()
            .filter_map(|family| family.get(sample))
            .map(Affine::from)
            .collect();
        let mut rows = region.rows(&states)?;
        for choice in &self.system().choices {
            let modes = choice.modes();
            if modes.iter().all(|mode| region.allows(&choice.name, mode)) {
                continue;
            }
            let mut allowed = Affine::zero();
            for mode in modes.iter().filter(|mode| region.allows(&choice.name, mode)) {
                allowed += match self.mode(&choice.name, mode, sample)? {
                    None => Affine::constant(1.0),
                    Some(literal) if literal.is_on() => literal.variable().into(),
                    Some(literal) => 1.0 - literal.variable(),
                };
            }
            rows.push(allowed.ge(1.0));
        }
        Ok(rows)
    }
}
