//! Rows of norms and squares of a system's handles, as norm limits.

use super::HybridSystem;
use super::coefficients::Coefficients;
use super::handles::Meaning;
use super::norm_limit::{NormEntry, NormLimit};
use crate::error::{Error, ErrorKind};
use crate::hybrid::step::Moment;
use crate::interval::Interval;
use crate::model::{Affine, ConicRow, Model, Name, Variable};

impl HybridSystem {
    /// A conic row as a norm limit, and when it holds.
    ///
    /// # Arguments
    ///
    /// * `name`: of the row, and whether it could be dropped; without it, the row's text.
    pub(super) fn norm_limit(
        &self,
        name: Option<(&str, bool)>,
        row: &ConicRow,
        place: &str,
    ) -> Result<(Moment, NormLimit), Error> {
        let text = name.map_or("a norm", |(name, _)| name);
        let (entries, bound) = self.as_norm(row, text, place)?;
        let parts = entries.iter().chain([&bound]);
        let parts = parts.map(|part| self.plain_coefficients(part, place));
        let parts: Vec<Coefficients> = parts.collect::<Result<_, Error>>()?;
        let text = match name {
            Some((name, _)) => name.to_owned(),
            None => self.norm_text(&entries, &bound),
        };
        let starts = parts.iter().any(Coefficients::uses_start);
        let moment = match (starts, parts.iter().any(Coefficients::uses_predictions)) {
            (true, true) => {
                let (name, place) = (format!("the row `{text}`"), place.to_owned());
                let help = "state it of the start of the step alone or of the prediction alone";
                return Err(ErrorKind::Misplaced { name, place, help }.into());
            }
            (_, true) => Moment::Prediction,
            (true, false) => Moment::Start,
            (false, false) => return Err(ErrorKind::EmptyRow { name: text }.into()),
        };
        let is_joint = parts.iter().any(Coefficients::uses_inputs);
        let entry = |part: Coefficients| {
            let factors = match moment {
                Moment::Prediction => part.predictions,
                Moment::Start if is_joint => [part.states, part.inputs].concat(),
                Moment::Start => part.states,
            };
            NormEntry { factors, constant: part.constant }
        };
        let mut entries: Vec<NormEntry> = parts.into_iter().map(entry).collect();
        let bound =
            entries.pop().unwrap_or(NormEntry { factors: Vec::new(), constant: 0.0.into() });
        let is_limit = name.is_some_and(|(_, is_limit)| is_limit);
        Ok((moment, NormLimit { name: text, entries, bound, is_limit }))
    }

    /// `|(vx, vy)| <= 3`.
    fn norm_text(&self, entries: &[Affine], bound: &Affine) -> String {
        let text = |part: &Affine| part.text(&|variable| self.handle_name(variable));
        let entries: Vec<String> = entries.iter().map(text).collect();
        format!("|({})| <= {}", entries.join(", "), text(bound))
    }

    /// The entries and the bound of the norm that a conic row is, by a model with a variable for
    /// each handle: there it is checked, and squares are recognised within domains and ranges.
    fn as_norm(
        &self,
        row: &ConicRow,
        name: &str,
        place: &str,
    ) -> Result<(Vec<Affine>, Affine), Error> {
        let mut handles: Vec<Variable> = Vec::new();
        row.stored().for_each_variable(&mut |handle| {
            if !handles.contains(&handle) {
                handles.push(handle);
            }
        });
        let mut model = Model::new("norms");
        let mut variables = Vec::with_capacity(handles.len());
        for &handle in &handles {
            let range = self.range_of(self.meaning(handle, place)?);
            let name = self.handle_name(handle);
            variables.push(model.continuous(name.as_str(), range.lower, range.upper)?);
        }
        let replaced = |expression: &Affine, from: &[Variable], to: &[Variable]| {
            let mut sum = Affine::constant(expression.offset());
            for &(variable, factor) in expression.raw_terms() {
                if let Some(k) = from.iter().position(|own| *own == variable) {
                    sum.add_term(factor, to[k]);
                }
            }
            sum
        };
        let own = row.try_map(&mut |expression| Ok(replaced(expression, &handles, &variables)))?;
        let name: Name = name.into();
        let conic = own.checked(&model, &name)?;
        let cone = model.standard_cone(&conic, &name)?;
        let back = |expression: &Affine| replaced(expression, &variables, &handles);
        let tail: Vec<Affine> = cone.tail.iter().map(back).collect();
        Ok(match &cone.head[..] {
            // |tail|^2 <= first second.
            [first, second] if first.terms().is_empty() && second.terms().is_empty() => {
                let most = (first.offset() * second.offset()).max(0.0).sqrt();
                (tail, Affine::constant(most))
            }
            [first, second] => {
                let (first, second) = (back(first), back(second));
                let mut entries: Vec<Affine> = tail.into_iter().map(|entry| 2.0 * entry).collect();
                entries.push(&first - &second);
                (entries, first + second)
            }
            heads => (tail, heads.first().map_or(Affine::zero(), back)),
        })
    }

    /// The values that a handle can have.
    fn range_of(&self, meaning: &Meaning) -> Interval {
        let hull =
            |all: Option<Interval>, range: Interval| Some(all.map_or(range, |all| all.hull(range)));
        match meaning {
            Meaning::State(i) => self.states[*i].1,
            Meaning::Input(u) => {
                let all = self.inputs[*u].1.values().copied().fold(None, hull);
                all.unwrap_or(Interval::REALS)
            }
            Meaning::Series(_, values) => {
                let all = values.values().map(|&value| Interval::point(value)).fold(None, hull);
                all.unwrap_or(Interval::REALS)
            }
            _ => Interval::REALS,
        }
    }
}
