//! The rows of a model as files hold them. Statements that no file can hold are refused.

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::ids::Variable;
use crate::model::literal::Literal;
use crate::model::name::Name;
use crate::model::semicontinuous::with_zero;
use crate::model::{Model, VariableRef};

/// A row of a file: a linear row or the row of an indicator.
pub(crate) struct FileLine<'a> {
    pub(crate) name: &'a Name,
    pub(crate) terms: &'a [(Variable, f64)],
    pub(crate) limits: Interval,
    pub(crate) condition: Option<Literal>,
}

/// The linear rows and then the indicators, in the order of creation.
///
/// Names and limits are checked again, because a deserialised model may hold any.
pub(crate) fn lines<'a>(
    model: &'a Model,
    format: &'static str,
) -> Result<Vec<FileLine<'a>>, Error> {
    if model.name().chars().any(|c| c.is_control() && c != '\t') {
        return Err(ErrorKind::InvalidName { name: model.name().to_owned() }.into());
    }
    let not_in_file = |what, name: &Name| {
        Error::from(ErrorKind::NotInFile { format, what, name: name.to_string() })
    };
    if let Some(disjunction) = model.disjunctions().next() {
        return Err(not_in_file("the disjunction", disjunction.name()));
    }
    if let Some(logical) = model.logical_constraints().next() {
        return Err(not_in_file("the logic of", logical.name()));
    }
    if let Some(function) = model.functions().next() {
        return Err(not_in_file("the function", function.name()));
    }
    model.variables().try_for_each(|variable| variable.name().check())?;
    model.special_ordered_sets().try_for_each(|set| set.name().check())?;
    let rows = model.constraints().map(|row| {
        let (name, terms, limits) = (row.name(), row.terms(), row.limits());
        Ok::<_, Error>(FileLine { name, terms, limits, condition: None })
    });
    let switched = model.indicators().map(|row| {
        let (name, terms, limits) = (row.name(), row.terms(), row.limits());
        let literal = row.condition().as_literal();
        let literal = literal.ok_or_else(|| not_in_file("the compound condition of", name))?;
        Ok(FileLine { name, terms, limits, condition: Some(literal) })
    });
    rows.chain(switched)
        .map(|line| {
            let line: FileLine<'_> = line?;
            line.name.check()?;
            if line.limits.lower.is_infinite() && line.limits.upper.is_infinite() {
                return Err(ErrorKind::UnlimitedRow { name: line.name.to_string() }.into());
            }
            Ok(line)
        })
        .collect()
}

/// The bounds of a variable as files hold them, and whether it is semi-continuous: then they are
/// those of its values other than 0.
pub(crate) fn file_bounds(
    variable: &VariableRef<'_>,
    format: &'static str,
) -> Result<(Interval, bool), Error> {
    let bounds = variable.bounds();
    let Some(values) = variable.semicontinuous() else { return Ok((bounds, false)) };
    if bounds == with_zero(values) {
        return Ok((values, true));
    }
    let (zero, inside) = (bounds.contains(0.0), bounds.intersection(values));
    match (zero, inside.lower <= inside.upper) {
        (zero, true) => Ok((inside, zero)),
        (true, false) => Ok((Interval::point(0.0), false)),
        (false, false) => {
            let what = "that there is no value for";
            let name = variable.name().to_string();
            Err(ErrorKind::NotInFile { format, what, name }.into())
        }
    }
}

/// A name for the objective row that no other row has.
pub(crate) fn objective_name(lines: &[FileLine<'_>]) -> String {
    let mut name = "obj".to_owned();
    while lines.iter().any(|line| line.name.step().is_none() && line.name.family() == name) {
        name.push('_');
    }
    name
}

/// The shortest text that reads back as the same double.
pub(crate) fn number(value: f64) -> String {
    let mut text = format!("{value:?}");
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
    text
}
