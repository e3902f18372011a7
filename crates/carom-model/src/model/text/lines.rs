//! The rows of a model as files hold them. Statements that no file can hold are refused.

use std::borrow::Cow;

use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::conic::StoredConic;
use crate::model::function::Function;
use crate::model::ids::Variable;
use crate::model::literal::Literal;
use crate::model::name::Name;
use crate::model::semicontinuous::with_zero;
use crate::model::{Model, VariableRef};

/// A row of a file: a linear row, the row of an indicator or a quadratic row.
pub(crate) struct FileLine<'a> {
    pub(crate) name: &'a Name,
    pub(crate) terms: Cow<'a, [(Variable, f64)]>,
    /// Products as [`Quadratic::products`](crate::model::Quadratic::products) gives them.
    pub(crate) products: Vec<(Variable, Variable, f64)>,
    pub(crate) limits: Interval,
    pub(crate) condition: Option<Literal>,
    /// A function that is added to the terms.
    pub(crate) function: Option<&'a Function>,
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
    // NL files have expressions for most of them.
    if let Some(function) = model.functions().next().filter(|_| format != "NL") {
        return Err(not_in_file("the function", function.name()));
    }
    model.variables().try_for_each(|variable| variable.name().check())?;
    model.special_ordered_sets().try_for_each(|set| set.name().check())?;
    let rows = model
        .constraints()
        .map(|row| Ok::<_, Error>(linear(row.name(), row.terms(), row.limits(), None)));
    let switched = model.indicators().map(|row| {
        let literal = row.condition().as_literal();
        let literal = literal.ok_or_else(|| not_in_file(COMPOUND, row.name()))?;
        Ok(linear(row.name(), row.terms(), row.limits(), Some(literal)))
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

/// The message about a condition that is no literal.
const COMPOUND: &str = "the compound condition of";

fn linear<'a>(
    name: &'a Name,
    terms: &'a [(Variable, f64)],
    limits: Interval,
    condition: Option<Literal>,
) -> FileLine<'a> {
    FileLine {
        name,
        terms: Cow::Borrowed(terms),
        products: Vec::new(),
        limits,
        condition,
        function: None,
    }
}

/// The quadratic rows of a model without norms, in the order of creation.
pub(crate) fn quadratic_lines<'a>(
    model: &'a Model,
    format: &'static str,
) -> Result<Vec<FileLine<'a>>, Error> {
    let mut lines = Vec::with_capacity(model.conic_constraint_count());
    for row in model.conic_constraints() {
        let name = row.name();
        let StoredConic::Quadratic { expression } = row.conic() else { continue };
        name.check()?;
        let condition = row.condition().map(|condition| {
            condition.as_literal().ok_or_else(|| {
                let name = name.to_string();
                Error::from(ErrorKind::NotInFile { format, what: COMPOUND, name })
            })
        });
        let affine = expression.affine();
        lines.push(FileLine {
            name,
            terms: Cow::Owned(affine.terms()),
            products: expression.products(),
            limits: Interval { lower: f64::NEG_INFINITY, upper: 0.0 - affine.offset() },
            condition: condition.transpose()?,
            function: None,
        });
    }
    Ok(lines)
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
