//! Inputs that take some values only, as integers and rows.

use super::constant_rows::constant;
use super::names::Names;
use super::program::SystemVariables;
use crate::error::Error;
use crate::hybrid::system::{HybridSystem, InputValues};
use crate::model::{Affine, Family, Model, Variable};

/// By how much values may differ from equal distances, relative to the largest, so that a number
/// counts them.
const EVEN_VALUES: f64 = 1e-13;

/// How the values of an input are written.
#[derive(Debug, Clone)]
pub(super) enum Levels {
    /// The input is an integer itself.
    Whole,
    /// The input is `first + distance * number`.
    Even { first: f64, distance: f64, numbers: Family },
    /// One of these, with a binary each.
    Each { values: Vec<f64>, chosen: Vec<Family> },
}

/// Whether an input is an integer itself: it takes all whole numbers of its range.
pub(super) fn is_whole(values: &InputValues) -> bool {
    match values {
        InputValues::Whole => true,
        InputValues::Listed(list) => {
            let steps = list.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
            steps && list[0].fract() == 0.0 && list[0].abs() < 1e9
        }
    }
}

/// The variables by which the values of an input are counted over some steps.
pub(super) fn variables(
    system: &HybridSystem,
    input: usize,
    model: &mut Model,
    names: &mut Names,
    steps: usize,
) -> Result<Option<Levels>, Error> {
    let Some(values) = system.values_of_input(input) else { return Ok(None) };
    let list = match values {
        _ if is_whole(values) => return Ok(Some(Levels::Whole)),
        InputValues::Listed(list) => list,
        InputValues::Whole => return Ok(Some(Levels::Whole)),
    };
    let (first, last) = (list[0], list[list.len() - 1]);
    if first == last {
        return Ok(None);
    }
    let name = &system.inputs[input].0;
    let distance = (last - first) / (list.len() - 1) as f64;
    let size = first.abs().max(last.abs());
    let off = |(k, value): (usize, &f64)| (value - (first + distance * k as f64)).abs();
    let number = names.family(&[name, "level"]);
    if list.len() == 2 {
        let numbers = model.binary_family(&number, steps)?;
        return Ok(Some(Levels::Even { first, distance, numbers }));
    }
    if list.iter().enumerate().map(off).all(|off| off <= EVEN_VALUES * size) {
        let numbers = model.integer_family(&number, steps, 0.0, (list.len() - 1) as f64)?;
        return Ok(Some(Levels::Even { first, distance, numbers }));
    }
    let family = |k: usize| model.binary_family(&format!("{number}_{k}"), steps);
    let chosen = (0..list.len()).map(family).collect::<Result<_, Error>>()?;
    Ok(Some(Levels::Each { values: list.clone(), chosen }))
}

/// Adds the rows that link an input to its values; returns their families.
pub(super) fn add(
    model: &mut Model,
    names: &mut Names,
    program: &SystemVariables,
    input: usize,
) -> Result<Vec<String>, Error> {
    let name = &program.system.inputs[input].0;
    let steps = program.horizon.steps();
    let family = &program.inputs[input];
    match &program.levels[input] {
        None | Some(Levels::Whole) => Ok(Vec::new()),
        Some(Levels::Even { first, distance, numbers }) => {
            let own = names.family(&[name, "takes"]);
            for t in 0..steps {
                let value: Affine = family[t] - *distance * numbers[t];
                model.add((own.as_str(), t), value.equals(*first))?;
            }
            Ok(vec![own])
        }
        Some(Levels::Each { values, chosen }) => {
            let [own, one] = ["takes", "takes_one"].map(|end| names.family(&[name, end]));
            for t in 0..steps {
                let sum: Affine = chosen.iter().map(|of| Affine::from(of[t])).sum();
                model.add((one.as_str(), t), sum.equals(1.0))?;
                let parts = values.iter().zip(chosen).map(|(value, of)| *value * of[t]);
                let row = (parts.sum::<Affine>() - family[t]).equals(0.0);
                if constant(&row).is_none() {
                    model.add((own.as_str(), t), row)?;
                }
            }
            Ok(vec![own, one])
        }
    }
}

impl Levels {
    /// The values of the counting variables for a value of the input in a step.
    pub(super) fn assign(&self, value: f64, step: usize, into: &mut Vec<(Variable, f64)>) {
        match self {
            Levels::Whole => {}
            Levels::Even { first, distance, numbers } => {
                let number = ((value - first) / distance).round();
                into.extend(numbers.get(step).map(|variable| (variable, number)));
            }
            Levels::Each { values, chosen } => {
                let distance = |k: &usize| (values[*k] - value).abs();
                let nearest = (0..values.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                for (k, family) in chosen.iter().enumerate() {
                    let on = if Some(k) == nearest { 1.0 } else { 0.0 };
                    into.extend(family.get(step).map(|variable| (variable, on)));
                }
            }
        }
    }
}

impl SystemVariables {
    /// The value of an input that a solver's number stands for.
    pub(crate) fn of_level(&self, input: usize, value: f64) -> f64 {
        self.system.values_of_input(input).map_or(value, |values| values.nearest(value))
    }
}
