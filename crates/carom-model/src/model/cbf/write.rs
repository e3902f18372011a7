//! Writing: the bounds at 0 as cones of variables, everything else as rows, every number in its
//! shortest exact form.

use std::fmt::Write as _;

use super::cone_kind::ConeKind;
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::affine::Affine;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::sense::Sense;
use crate::model::text::lines::{lines, number};
use crate::model::{Model, Quadratic};

/// Rows that lie in cones.
#[derive(Default)]
struct ConicLines {
    blocks: Vec<(ConeKind, usize)>,
    rows: Vec<(Vec<(Variable, f64)>, f64)>,
}

/// The text of a model as CBF.
pub(super) fn text(model: &Model) -> Result<String, Error> {
    match model.objective().products().is_empty() {
        true => linear(model),
        false => linear(&with_linear_objective(model)?),
    }
}

/// The model with a variable for the quadratic part of its objective, and a cone.
fn with_linear_objective(model: &Model) -> Result<Model, Error> {
    let mut model = model.clone();
    let mut name = "objective".to_owned();
    while model.variable_by_name(&name).is_ok() || model.has_statement(&Name::from(&name)) {
        name.push('_');
    }
    let part = model.continuous(&name, f64::NEG_INFINITY, f64::INFINITY)?;
    let mut products = Quadratic::zero();
    for (first, second, value) in model.objective().products() {
        products.add_product(value, first, second);
    }
    let row = match model.sense() {
        Sense::Minimize => products.le(part),
        Sense::Maximize => products.ge(part),
    };
    model.add(&name, row)?;
    let objective = model.objective().affine() + part;
    model.set_objective(model.sense(), objective)?;
    Ok(model)
}

/// The text of a model whose objective is linear.
fn linear(model: &Model) -> Result<String, Error> {
    let mut text = String::new();
    let rows = rows(model)?;
    if !model.name().trim().is_empty() {
        put(&mut text, format_args!("# {}\n", model.name().trim()));
    }
    put(&mut text, format_args!("VER\n1\n\nOBJSENSE\n{}\n", sense(model.sense())));
    let domains = model.variables().map(|variable| domain(variable.bounds()));
    write_blocks(&mut text, "VAR", domains.map(|kind| (kind, 1)));
    let integers = model.variables().filter(|variable| variable.kind().is_integral());
    let integers: Vec<_> = integers.map(|variable| variable.id().index().to_string()).collect();
    list(&mut text, "INT", &integers);
    write_blocks(&mut text, "CON", rows.blocks.iter().copied());
    let objective = model.objective().affine();
    let terms = objective.terms().into_iter();
    let terms: Vec<_> = terms.map(|(x, a)| format!("{} {}", x.index(), number(a))).collect();
    list(&mut text, "OBJACOORD", &terms);
    if objective.offset() != 0.0 {
        put(&mut text, format_args!("\nOBJBCOORD\n{}\n", number(objective.offset())));
    }
    let rows = rows.rows.iter().enumerate();
    let terms = rows.clone().flat_map(|(at, (terms, _))| {
        terms.iter().map(move |&(x, a)| format!("{at} {} {}", x.index(), number(a)))
    });
    list(&mut text, "ACOORD", &terms.collect::<Vec<_>>());
    let offsets = rows.filter(|(_, (_, offset))| *offset != 0.0);
    let offsets = offsets.map(|(at, (_, offset))| format!("{at} {}", number(*offset)));
    list(&mut text, "BCOORD", &offsets.collect::<Vec<_>>());
    Ok(text)
}

/// All that is no bound at 0.
fn rows(model: &Model) -> Result<ConicLines, Error> {
    let refuse = |what, name: &Name| {
        Err(ErrorKind::NotInFile { format: "CBF", what, name: name.to_string() }.into())
    };
    let lines = lines(model, "CBF")?;
    if let Some(set) = model.special_ordered_sets().next() {
        return refuse("the ordered set", set.name());
    }
    if let Some(x) = model.variables().find(|variable| variable.semicontinuous().is_some()) {
        return refuse("the semi-continuous variable", x.name());
    }
    if let Some(line) = lines.iter().find(|line| line.condition.is_some()) {
        return refuse("the indicator", line.name);
    }
    let mut rows = ConicLines::default();
    for variable in model.variables() {
        let (at_zero, Interval { lower, upper }) = (domain(variable.bounds()), variable.bounds());
        let is_done = |bound: f64| bound.is_infinite() || bound == 0.0 && at_zero != ConeKind::Free;
        let limits = Interval {
            lower: if is_done(lower) { f64::NEG_INFINITY } else { lower },
            upper: if is_done(upper) { f64::INFINITY } else { upper },
        };
        rows.within(&[(variable.id(), 1.0)], limits);
    }
    lines.iter().for_each(|line| rows.within(&line.terms, line.limits));
    for conic in model.conic_constraints() {
        if conic.condition().is_some() {
            return refuse("the condition of", conic.name());
        }
        let cone = model.standard_cone(conic.conic(), conic.name())?;
        let (kind, factor) = match cone.head.len() {
            1 => (ConeKind::Norm, 1.0),
            // The product of the heads is twice as large in the file.
            _ => (ConeKind::Rotated, 0.5),
        };
        rows.blocks.push((kind, cone.head.len() + cone.tail.len()));
        for (position, entry) in cone.head.into_iter().chain(cone.tail).enumerate() {
            let entry: Affine = if position == 0 { factor * entry } else { entry };
            rows.rows.push(entry.into_parts());
        }
    }
    Ok(rows)
}

impl ConicLines {
    /// Adds a row with its limits.
    fn within(&mut self, terms: &[(Variable, f64)], Interval { lower, upper }: Interval) {
        let mut add = |kind, limit: f64| {
            self.blocks.push((kind, 1));
            self.rows.push((terms.to_vec(), -limit));
        };
        if lower == upper {
            return add(ConeKind::Zero, lower);
        }
        if lower.is_finite() {
            add(ConeKind::AtLeast, lower);
        }
        if upper.is_finite() {
            add(ConeKind::AtMost, upper);
        }
    }
}

/// The cone that bounds at 0 are.
fn domain(bounds: Interval) -> ConeKind {
    match (bounds.lower == 0.0, bounds.upper == 0.0) {
        (true, true) => ConeKind::Zero,
        (true, false) => ConeKind::AtLeast,
        (false, true) => ConeKind::AtMost,
        (false, false) => ConeKind::Free,
    }
}

fn sense(sense: Sense) -> &'static str {
    match sense {
        Sense::Minimize => "MIN",
        Sense::Maximize => "MAX",
    }
}

/// Writes cones with their sizes, those of neighbours with the same linear cone together.
fn write_blocks(text: &mut String, name: &str, blocks: impl Iterator<Item = (ConeKind, usize)>) {
    let mut merged: Vec<(ConeKind, usize)> = Vec::new();
    for (kind, size) in blocks {
        match merged.last_mut() {
            Some((last, sum)) if *last == kind && kind.heads().is_none() => *sum += size,
            _ => merged.push((kind, size)),
        }
    }
    let count: usize = merged.iter().map(|(_, size)| size).sum();
    if count == 0 && name == "CON" {
        return;
    }
    put(text, format_args!("\n{name}\n{count} {}\n", merged.len()));
    for (kind, size) in merged {
        put(text, format_args!("{} {size}\n", kind.name()));
    }
}

/// Writes a section with its number of entries, if it has any.
fn list(text: &mut String, name: &str, entries: &[String]) {
    if !entries.is_empty() {
        put(text, format_args!("\n{name}\n{}\n{}\n", entries.len(), entries.join("\n")));
    }
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = text.write_fmt(arguments);
}
