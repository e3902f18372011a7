//! Expressions and rows of a system's handles, as coefficients.

use super::HybridSystem;
use super::halfspace::Halfspace;
use super::handles::Meaning;
use super::norm_limit::NormLimit;
use super::region::Region;
use super::schedule::Schedule;
use super::system_row::SystemRow;
use crate::error::{Error, ErrorKind, check_finite};
use crate::hybrid::step::Moment;
use crate::interval::Interval;
use crate::model::{Affine, ConicRow, Row, Variable};

/// The coefficients of an affine expression.
pub(crate) struct Coefficients {
    /// By state, at the start of the step.
    pub(crate) states: Vec<f64>,
    /// By state, of the predictions.
    pub(crate) predictions: Vec<f64>,
    /// By input.
    pub(crate) inputs: Vec<f64>,
    /// Of modes: the number of the choice, the mode, the coefficient.
    pub(crate) modes: Vec<(usize, String, f64)>,
    /// By step.
    pub(crate) constant: Schedule<f64>,
}

impl Coefficients {
    pub(crate) fn uses_start(&self) -> bool {
        self.states.iter().chain(&self.inputs).any(|a| *a != 0.0)
    }

    pub(crate) fn uses_inputs(&self) -> bool {
        self.inputs.iter().any(|a| *a != 0.0)
    }

    pub(crate) fn uses_predictions(&self) -> bool {
        self.predictions.iter().any(|a| *a != 0.0)
    }

    /// The coefficients of the states and, if there are any, of the inputs.
    pub(crate) fn start(&self) -> Vec<f64> {
        match self.uses_inputs() {
            true => [&self.states[..], &self.inputs].concat(),
            false => self.states.clone(),
        }
    }
}

impl HybridSystem {
    /// The coefficients of an expression of states, predictions, inputs, series and modes.
    pub(crate) fn coefficients(
        &self,
        expression: &Affine,
        place: &str,
    ) -> Result<Coefficients, Error> {
        let (n, m) = (self.states.len(), self.inputs.len());
        let mut all = Coefficients {
            states: vec![0.0; n],
            predictions: vec![0.0; n],
            inputs: vec![0.0; m],
            modes: Vec::new(),
            constant: expression.offset().into(),
        };
        let numbers = expression.raw_terms().iter().map(|&(_, factor)| factor);
        check_finite(place, "a number", numbers.chain([expression.offset()]))?;
        for (variable, factor) in expression.terms() {
            match self.meaning(variable, place)? {
                Meaning::State(i) => all.states[*i] += factor,
                Meaning::Prediction(i) => all.predictions[*i] += factor,
                Meaning::Input(u) => all.inputs[*u] += factor,
                Meaning::InMode(choice, mode) => all.modes.push((*choice, mode.clone(), factor)),
                Meaning::Series(_, values) => {
                    let last = all.constant.settles().max(values.settles());
                    let at = |step| match (all.constant.get(step), values.get(step)) {
                        (Some(constant), Some(value)) => constant + factor * value,
                        _ => f64::NAN,
                    };
                    all.constant = (0..=last).map(at).collect::<Vec<f64>>().into();
                }
                Meaning::Acting(..) | Meaning::Taken(..) | Meaning::Output(_) => {
                    let help = "transitions and outputs stand in expressions of a program";
                    return Err(self.misplaced(variable, place, help));
                }
            }
        }
        Ok(all)
    }

    /// The same for an expression without modes.
    pub(super) fn plain_coefficients(
        &self,
        expression: &Affine,
        place: &str,
    ) -> Result<Coefficients, Error> {
        let all = self.coefficients(expression, place)?;
        for (variable, _) in expression.terms() {
            if let Meaning::InMode(..) = self.meaning(variable, place)? {
                let help = "use `stay` and `switch` to say what holds in a mode";
                return Err(self.misplaced(variable, place, help));
            }
        }
        Ok(all)
    }

    pub(in crate::hybrid) fn misplaced(
        &self,
        variable: Variable,
        place: &str,
        help: &'static str,
    ) -> Error {
        let name = format!("`{}`", self.handle_name(variable));
        ErrorKind::Misplaced { name, place: place.to_owned(), help }.into()
    }

    /// The error for the first input among some coefficients.
    pub(super) fn misplaced_input(
        &self,
        all: &Coefficients,
        place: &str,
        help: &'static str,
    ) -> Error {
        let input = all.inputs.iter().position(|a| *a != 0.0);
        let input = input.and_then(|u| self.inputs.get(u)).map_or("", |(name, _)| name);
        let (name, place) = (format!("the input `{input}`"), place.to_owned());
        ErrorKind::Misplaced { name, place, help }.into()
    }

    /// A row as half-spaces, one for each of its limits, and when they hold.
    ///
    /// # Arguments
    ///
    /// * `name`: of the row, and whether it could be dropped; without it, the row's text.
    pub(super) fn halfspaces(
        &self,
        name: Option<(&str, bool)>,
        row: &Row,
        place: &str,
    ) -> Result<(Moment, Vec<Halfspace>), Error> {
        let all = self.plain_coefficients(row.expression(), place)?;
        let moment = match (all.uses_start(), all.uses_predictions()) {
            (true, true) => {
                let (name, place) = (format!("the row `{}`", self.row_text(row)), place.to_owned());
                let help = "state it of the start of the step alone or of the prediction alone";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
            (_, true) => Moment::Prediction,
            _ => Moment::Start,
        };
        let normal = match moment {
            Moment::Start => all.start(),
            Moment::Prediction => all.predictions,
        };
        let text = name.map_or_else(|| self.row_text(row), |(name, _)| name.to_owned());
        if normal.iter().all(|a| *a == 0.0) {
            return Err(ErrorKind::EmptyRow { name: text }.into());
        }
        let (lower, upper) = row.limits(&text)?;
        let is_limit = name.is_some_and(|(_, is_limit)| is_limit);
        let mut halves = Vec::new();
        for (end, sign) in [(upper, 1.0), (lower, -1.0)] {
            if end.is_infinite() {
                continue;
            }
            let normal: Vec<f64> = normal.iter().map(|a| sign * a).collect();
            // Without a sign before a zero.
            let limit = all.constant.map(|constant| sign * (end - constant) + 0.0);
            halves.push(Halfspace { is_limit, ..Halfspace::new(text.clone(), normal, limit) });
        }
        Ok((moment, halves))
    }

    /// A row that limits one input alone, as the input's number and its range by step.
    pub(super) fn input_limits(
        &self,
        row: &Row,
        place: &str,
    ) -> Result<Option<(usize, Schedule<Interval>)>, Error> {
        let all = self.plain_coefficients(row.expression(), place)?;
        if all.uses_predictions() || all.states.iter().any(|a| *a != 0.0) {
            return Ok(None);
        }
        let mut used = all.inputs.iter().enumerate().filter(|(_, a)| **a != 0.0);
        let (Some((input, &factor)), None) = (used.next(), used.next()) else { return Ok(None) };
        let limits = row.limits(&self.row_text(row))?;
        let range = |constant: &f64| range(limits, factor, *constant);
        let ranges: Vec<Interval> = all.constant.values().map(range).collect();
        Ok(Some((input, ranges.into())))
    }

    /// A region of states, as rows: `[x.equals(0.0), v.within(-1.0, 1.0)]`. Rows may combine
    /// states, and modes are stated as `on.equals(1.0)`, or `(on + starting).equals(1.0)` for
    /// either of them. Discs are stated as `norm([x - 4.0, y - 1.0]).le(0.5)`; [`SystemRow`] is
    /// either of both.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Misplaced`] for rows of anything else, [`ErrorKind::ForeignHandle`] for handles
    /// of another system, [`ErrorKind::CrossedBounds`] for rows that contradict each other.
    pub fn region<R: Into<SystemRow>>(
        &self,
        rows: impl IntoIterator<Item = R>,
    ) -> Result<Region, Error> {
        const PLACE: &str = "a region of states";
        let mut region = Region::from(vec![Interval::REALS; self.states.len()]);
        for row in rows {
            let row = match row.into() {
                SystemRow::Row(row) => row,
                SystemRow::Conic(row) => {
                    region.norms.push(self.disc(&row, PLACE)?);
                    continue;
                }
                SystemRow::Nonlinear(row) => {
                    let help = "a region is stated with states and modes";
                    region.nonlinear.push(self.state_row(None, &row, PLACE, help)?);
                    continue;
                }
            };
            let all = self.coefficients(row.expression(), PLACE)?;
            if !all.modes.is_empty() {
                let allowed = self.modes_of(&row, all, PLACE)?;
                self.allow_only(&mut region, &row, allowed, PLACE)?;
                continue;
            }
            for (variable, _) in row.expression().terms() {
                if !matches!(
                    self.meaning(variable, PLACE)?,
                    Meaning::State(_) | Meaning::Series(..)
                ) {
                    let help = "a region is stated with states and modes";
                    return Err(self.misplaced(variable, PLACE, help));
                }
            }
            let mut used = all.states.iter().enumerate().filter(|(_, a)| **a != 0.0);
            match (used.next(), used.next(), all.constant.is_constant()) {
                (Some((i, &factor)), None, true) => {
                    let limits = row.limits(&self.row_text(&row))?;
                    let own = range(limits, factor, row.expression().offset());
                    let both = region.ranges[i].intersection(own);
                    if both.is_empty() {
                        let name = self.states[i].0.clone();
                        let (lower, upper) = (both.lower, both.upper);
                        return Err(ErrorKind::CrossedBounds { name, lower, upper }.into());
                    }
                    region.ranges[i] = both;
                }
                _ => region.halfspaces.extend(self.halfspaces(None, &row, PLACE)?.1),
            }
        }
        Ok(region)
    }

    /// A disc of a region.
    fn disc(&self, row: &ConicRow, place: &str) -> Result<NormLimit, Error> {
        let (moment, disc) = self.norm_limit(None, row, place)?;
        if moment == Moment::Prediction || disc.bound.factors.len() != self.states.len() {
            let (name, place) = (format!("the row `{}`", disc.name), place.to_owned());
            let help = "a region is stated with states and modes";
            return Err(ErrorKind::Misplaced { name, place, help }.into());
        }
        Ok(disc)
    }

    /// Allows a region only those of its modes that a row allows too.
    fn allow_only(
        &self,
        region: &mut Region,
        row: &Row,
        mut allowed: Vec<(String, String)>,
        place: &str,
    ) -> Result<(), Error> {
        let Some(choice) = allowed.first().map(|(choice, _)| choice.clone()) else { return Ok(()) };
        if region.modes.iter().any(|(own, _)| *own == choice) {
            allowed.retain(|mode| region.modes.contains(mode));
        }
        if allowed.is_empty() {
            let name = format!("the row `{}`", self.row_text(row));
            let help = "another row excludes the modes that it allows";
            return Err(ErrorKind::Misplaced { name, place: place.to_owned(), help }.into());
        }
        region.modes.retain(|(own, _)| *own != choice);
        region.modes.extend(allowed);
        Ok(())
    }

    /// The modes that a row like `(on + starting).equals(1.0)` allows.
    fn modes_of(
        &self,
        row: &Row,
        all: Coefficients,
        place: &str,
    ) -> Result<Vec<(String, String)>, Error> {
        let one_choice = all.modes.windows(2).all(|pair| pair[0].0 == pair[1].0);
        let units = all.modes.iter().all(|(_, _, factor)| *factor == 1.0);
        let rest = all.uses_start() || all.uses_predictions() || !all.constant.is_constant();
        let constant = row.expression().offset();
        let is_one = row.lower() - constant == 1.0 && row.upper() - constant >= 1.0;
        if !one_choice || !units || rest || !is_one {
            let name = format!("the row `{}`", self.row_text(row));
            let help = "modes are stated as `on.equals(1.0)`, or as a sum of modes of one choice \
                        that equals 1";
            return Err(ErrorKind::Misplaced { name, place: place.to_owned(), help }.into());
        }
        let named =
            |(choice, mode, _): (usize, String, f64)| (self.choices[choice].name.clone(), mode);
        Ok(all.modes.into_iter().map(named).collect())
    }

    /// A row as text, with its constant on the right: `v >= 0.4`.
    pub(super) fn row_text(&self, row: &Row) -> String {
        let constant = row.expression().offset();
        let left = (row.expression() - constant).text(&|variable| self.handle_name(variable));
        let [lower, upper] = [row.lower() - constant, row.upper() - constant];
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) if lower == upper => format!("{left} = {lower}"),
            (true, true) => format!("{lower} <= {left} <= {upper}"),
            (true, false) => format!("{left} >= {lower}"),
            _ => format!("{left} <= {upper}"),
        }
    }
}

/// The values of `x` with `lower <= factor x + constant <= upper`.
fn range((lower, upper): (f64, f64), factor: f64, constant: f64) -> Interval {
    let [lower, upper] = [lower, upper].map(|end| (end - constant) / factor);
    match factor > 0.0 {
        true => Interval::new(lower, upper),
        false => Interval::new(upper, lower),
    }
}
