//! Variables that are functions of others, from the entries of a file to statements of the model.

use super::build::at;
use super::function::{LpArgument, LpFunction, LpFunctionKind};
use super::names;
use super::read::{LpColumn, LpFile};
use crate::error::Error;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::logic::Logic;
use crate::model::name::Name;
use crate::model::piecewise::PiecewiseAffine;
use crate::model::store::Model;
use crate::model::variable::VariableKind;

/// The functions whose result the model can define as the function itself: continuous columns that
/// are no earlier function's result, each with its first function.
pub(super) fn definitions<'a, 'b>(
    file: &'b LpFile<'a>,
    is_plain: impl Fn(&LpColumn<'a>, usize) -> bool,
) -> Vec<Option<&'b LpFunction<'a>>> {
    let mut definitions = vec![None; file.columns.len()];
    for function in &file.functions {
        let (result, kind) = (function.result, function.kind);
        let is_logic = matches!(kind, LpFunctionKind::And | LpFunctionKind::Or);
        let is_sum = kind == LpFunctionKind::OneNorm && function.arguments.len() > 1;
        if !is_logic && !is_sum && is_plain(&file.columns[result], result) {
            definitions[result].get_or_insert(function);
        }
    }
    // A function depends on older variables only.
    let mut is_made: Vec<bool> = definitions.iter().map(Option::is_none).collect();
    loop {
        let is_ready = |function: &&LpFunction<'_>| columns(function).all(|column| is_made[column]);
        let open = definitions.iter().enumerate().filter(|(j, _)| !is_made[*j]);
        let ready: Vec<usize> =
            open.filter(|(_, f)| f.as_ref().is_some_and(is_ready)).map(|(j, _)| j).collect();
        if ready.is_empty() {
            break;
        }
        ready.into_iter().for_each(|j| is_made[j] = true);
    }
    for (definition, is_made) in definitions.iter_mut().zip(is_made) {
        if !is_made {
            *definition = None;
        }
    }
    definitions
}

/// The columns that a function depends on.
pub(super) fn columns<'b>(function: &'b LpFunction<'_>) -> impl Iterator<Item = usize> + 'b {
    function.arguments.iter().filter_map(|argument| match argument {
        LpArgument::Column(column) => Some(*column),
        LpArgument::Number(_) => None,
    })
}

/// Adds a variable that equals a function; it has all its arguments.
pub(super) fn define(
    model: &mut Model,
    name: Name,
    function: &LpFunction<'_>,
    variable: impl Fn(usize) -> Variable,
) -> Result<Variable, Error> {
    let of = |argument: &LpArgument| match *argument {
        LpArgument::Column(column) => Affine::from(variable(column)),
        LpArgument::Number(value) => Affine::constant(value),
    };
    let of: Vec<Affine> = function.arguments.iter().map(of).collect();
    let added = match function.kind {
        LpFunctionKind::Minimum => model.minimum(name, of),
        LpFunctionKind::LargestNorm => {
            let both = of.into_iter().flat_map(|e| [-&e, e]);
            model.maximum(name, both.collect::<Vec<Affine>>())
        }
        LpFunctionKind::Absolute | LpFunctionKind::OneNorm => {
            model.absolute(name, of.into_iter().next().unwrap_or_default())
        }
        LpFunctionKind::Piecewise => {
            let of = of.into_iter().next().unwrap_or_default();
            let graph = graph(model, function, &of)?;
            model.piecewise(name, of, &graph)
        }
        _ => model.maximum(name, of),
    };
    added.map_err(|error| at(function.place, &error))
}

/// The points of a piecewise function, whose first and last pieces go on over the bounds of its
/// argument.
fn graph(model: &Model, function: &LpFunction<'_>, of: &Affine) -> Result<PiecewiseAffine, Error> {
    let failed = |error: Error| at(function.place, &error);
    let graph = PiecewiseAffine::new(function.points.iter().copied()).map_err(failed)?;
    let range = model.range(of).map_err(failed)?;
    if range.is_bounded() {
        return graph.extended(range.lower, range.upper).map_err(failed);
    }
    let name = of.terms().first().map_or(String::new(), |(v, _)| model.name_of(*v).to_string());
    Err(function.place.error(format!(
        "the function goes on behind its points, so `{name}` needs finite bounds; give them"
    )))
}

/// Adds a function whose result is a variable of its own.
pub(super) fn add(
    model: &mut Model,
    function: &LpFunction<'_>,
    position: usize,
    variables: &[Variable],
) -> Result<(), Error> {
    let wanted = match function.is_named {
        true => names::read(function.place.text),
        false => Name::from(format!("gc{position}")),
    };
    let failed = |error: Error| at(function.place, &error);
    let name = wanted.free(|name| model.has_statement(name));
    let result = variables[function.result];
    let variable = |column: usize| variables[column];
    match function.kind {
        LpFunctionKind::And | LpFunctionKind::Or => {
            let of: Vec<Variable> = columns(function).map(variable).collect();
            for &v in of.iter().chain([&result]) {
                let own = model.variable_ref(v).map_err(failed)?;
                if own.kind() != VariableKind::Binary {
                    let (name, text) = (own.name(), "is not listed under `Binary`");
                    let message = format!("`{name}` stands in `AND` or `OR` and {text}");
                    return Err(function.place.error(message));
                }
            }
            let of = match function.kind {
                LpFunctionKind::And => Logic::all(&of),
                _ => Logic::any(&of),
            };
            model.add(name, result.iff(of)).map_err(failed)?;
        }
        LpFunctionKind::OneNorm => {
            let mut sum = Affine::from(result);
            for argument in &function.arguments {
                let LpArgument::Column(column) = *argument else { continue };
                let own = model.name_of(variables[column]).to_string();
                let own = Name::from(format!("{name}_{own}"));
                let own = own.free(|own| model.variable_by_name(own.clone()).is_ok());
                let part = model.absolute(own, variables[column]).map_err(failed)?;
                sum.add_term(-1.0, part);
            }
            model.add(name, sum.equals(0.0)).map_err(failed)?;
        }
        _ => {
            let own = name.free(|own| model.variable_by_name(own.clone()).is_ok());
            let value = define(model, own, function, variable)?;
            model.add(name, (result - value).equals(0.0)).map_err(failed)?;
        }
    }
    Ok(())
}
