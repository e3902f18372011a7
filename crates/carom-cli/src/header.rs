//! The lines about the program that is solved: its size, and how large and small its numbers are.

use carom::prelude::Model;

use crate::answer::counted;

/// The first line of the output.
pub(crate) fn counts(model: &Model) -> String {
    let [rows, columns, integers, nonzeros, cones] = size(model);
    let cones = if cones > 0 { format!(" cones={cones}") } else { String::new() };
    format!("rows={rows} columns={columns} integers={integers} nonzeros={nonzeros}{cones}")
}

/// The lines for people.
pub(crate) fn header(model: &Model) -> String {
    let [rows, columns, integers, nonzeros, cones] = size(model);
    let further = [
        (cones, "cone"),
        (model.disjunctions().len(), "disjunction"),
        (model.logical_constraint_count(), "logical statement"),
    ];
    let further: String = further
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| format!(", {}", counted(count, what)))
        .collect();
    format!(
        "carom {}\n{}, {} ({integers} integral), {}{further}\n{}",
        env!("CARGO_PKG_VERSION"),
        counted(rows, "row"),
        counted(columns, "column"),
        counted(nonzeros, "nonzero"),
        coefficients(model)
    )
}

/// Rows (with those of indicators), columns, integers, nonzeros, cones.
fn size(model: &Model) -> [usize; 5] {
    let rows = model.constraint_count() + model.indicator_count();
    let integers = model.variables().filter(|variable| variable.kind().is_integral()).count();
    let linear: usize = model.constraints().map(|row| row.terms().len()).sum();
    let switched: usize = model.indicators().map(|row| row.terms().len()).sum();
    [rows, model.variable_count(), integers, linear + switched, model.conic_constraint_count()]
}

/// The ranges of the magnitudes of all numbers but 0: programs whose numbers differ by many powers
/// of ten are solved less reliably.
fn coefficients(model: &Model) -> String {
    let rows = || model.constraints().map(|row| (row.terms(), row.limits()));
    let switched = || model.indicators().map(|row| (row.terms(), row.limits()));
    let all = || rows().chain(switched());
    let matrix = range(all().flat_map(|(terms, _)| terms.iter().map(|(_, a)| *a)));
    let objective = model.objective();
    let linear = objective.affine().terms().into_iter().map(|(_, c)| c);
    let objective = range(linear.chain(objective.products().into_iter().map(|(_, _, q)| q)));
    let bounds = model.variables().map(|variable| variable.bounds());
    let bounds = range(bounds.flat_map(|of| [of.lower, of.upper]));
    let right_sides = range(all().flat_map(|(_, limits)| [limits.lower, limits.upper]));
    format!(
        "magnitudes: matrix {matrix}, objective {objective}, bounds {bounds}, right sides \
         {right_sides}"
    )
}

/// The least and the largest magnitude.
fn range(values: impl Iterator<Item = f64>) -> String {
    let sizes = values.map(f64::abs).filter(|size| *size > 0.0 && size.is_finite());
    let (least, most) = sizes
        .fold((f64::INFINITY, 0.0_f64), |(least, most), size| (least.min(size), most.max(size)));
    match least.is_finite() {
        false => "none".into(),
        true if least == most => short(least),
        true => format!("{} to {}", short(least), short(most)),
    }
}

/// Three significant digits.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    if (1e-4..1e6).contains(&rounded) { format!("{rounded}") } else { format!("{rounded:e}") }
}
