//! Points in `.sol` files, as MIP starts: lines `name value` or `name = value`, of this crate's
//! `solve --solution` and of other solvers. Comments, headings and rows are passed over.

use carom::model::nl::SolFile;
use carom::prelude::*;

/// The values of a model's integers in a file. Such files leave out zeros, so an integer that is
/// not named is 0.
pub(crate) fn integers(model: &Model, text: &str) -> Result<Vec<(Variable, f64)>, String> {
    let mut values = vec![None; model.variable_count()];
    for line in text.lines().map(str::trim).take_while(|line| !line.starts_with("# Rows")) {
        if let Some((variable, value)) = entry(model, line) {
            values[variable.index()] = Some(value);
        }
    }
    if values.iter().all(Option::is_none) {
        return Err("no line is the name of a variable of the model and its value".into());
    }
    let integral = model.variables().filter(|variable| variable.kind().is_integral());
    Ok(integral.map(|v| (v.id(), values[v.id().index()].unwrap_or(0.0).round())).collect())
}

/// The values of a model's integers in an answer to its NL file.
pub(crate) fn of_answer(model: &Model, text: &str) -> Option<Vec<(Variable, f64)>> {
    let answer = SolFile::read(text).ok()?;
    // Variables of functions come after those of the file.
    let is_whole = answer.values.len() <= model.variable_count();
    let values = model.variables().zip(answer.values).filter(|(own, _)| own.kind().is_integral());
    is_whole.then(|| values.map(|(own, value)| (own.id(), value.round())).collect())
}

/// The variable and the value of a line; some solvers number their lines.
fn entry(model: &Model, line: &str) -> Option<(Variable, f64)> {
    let words: Vec<&str> = line.split_whitespace().filter(|&word| word != "=").collect();
    let at = |first: usize| {
        let variable = model.variable_by_name(*words.get(first)?).ok()?;
        Some((
            variable,
            words.get(first + 1)?.parse().ok().filter(|value: &f64| value.is_finite())?,
        ))
    };
    // Names may have blanks.
    let whole = || {
        let (value, name) = words.split_last()?;
        let value = value.parse().ok().filter(|value: &f64| value.is_finite())?;
        Some((model.variable_by_name(name.join(" ")).ok()?, value))
    };
    let numbered = || words.first()?.parse::<usize>().ok().and_then(|_| at(1));
    at(0).or_else(numbered).or_else(whole)
}
