//! Writing: only what all common readers accept, every number in its shortest exact form.

use std::fmt::Write as _;

use super::names;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::ids::Variable;
use crate::model::literal::Literal;
use crate::model::sense::Sense;
use crate::model::text::lines::{
    FileLine, file_bounds, lines, number, objective_name, quadratic_lines,
};
use crate::model::text::quadratic_rows::with_quadratic_rows;
use crate::model::variable::VariableKind;
use crate::model::{Model, VariableRef};

/// Lines are broken before a term that would exceed this length.
const WIDTH: usize = 100;

/// The text of a model in the LP format.
pub(super) fn text(model: &Model) -> Result<String, Error> {
    let model = &*with_quadratic_rows(model)?;
    let mut lines = lines(model, "LP")?;
    lines.extend(quadratic_lines(model, "LP")?);
    let columns: Vec<String> = model.variables().map(|v| names::write(v.name())).collect();
    let mut page = Page { text: String::new(), line: 0 };
    let title = model.name().trim();
    if !title.is_empty() {
        page.word(&format!("\\ Problem name: {title}"));
        page.end();
    }
    page.word(match model.sense() {
        Sense::Minimize => "Minimize",
        Sense::Maximize => "Maximize",
    });
    page.end();
    write_objective(&mut page, model, &lines, &columns);
    page.text.push_str("Subject To\n");
    for line in &lines {
        write_row(&mut page, line, &columns);
    }
    page.text.push_str("Bounds\n");
    let mut semicontinuous = Vec::new();
    for (variable, column) in model.variables().zip(&columns) {
        let (bounds, semi) = file_bounds(&variable, "LP")?;
        if semi {
            semicontinuous.push(column);
        }
        if let Some(bound) = bound(&variable, bounds, column) {
            page.word(&format!(" {bound}"));
            page.end();
        }
    }
    if constant(model).is_some() {
        page.word(&format!(" {} = 1", names::CONSTANT));
        page.end();
    }
    for (title, kind) in [("General", VariableKind::Integer), ("Binary", VariableKind::Binary)] {
        let members = model.variables().zip(&columns).filter(|(v, _)| v.kind() == kind);
        write_names(&mut page, title, members.map(|(_, column)| column));
    }
    write_names(&mut page, "Semi-Continuous", semicontinuous);
    write_sets(&mut page, model, &columns);
    page.text.push_str("End\n");
    Ok(page.text)
}

/// Text with lines of limited length.
struct Page {
    text: String,
    /// Characters in the last line.
    line: usize,
}

impl Page {
    /// Appends to the line without breaking it.
    fn word(&mut self, word: &str) {
        self.text.push_str(word);
        self.line += word.chars().count();
    }

    /// Appends a part with a space before it, on a new line if this one is full.
    fn part(&mut self, part: &str) {
        if self.line + 1 + part.chars().count() > WIDTH {
            self.end();
            self.word(" ");
        }
        self.word(" ");
        self.word(part);
    }

    fn end(&mut self) {
        self.text.push('\n');
        self.line = 0;
    }

    /// Appends terms; the first one without a plus.
    fn terms<'a>(&mut self, first: bool, terms: impl IntoIterator<Item = (f64, &'a str)>) {
        for (k, (coefficient, what)) in terms.into_iter().enumerate() {
            self.part(&term(first && k == 0, coefficient, what));
        }
    }
}

/// `+ 2 x`, without a coefficient of 1.
fn term(first: bool, coefficient: f64, what: &str) -> String {
    let mut text = String::new();
    match (coefficient.is_sign_negative(), first) {
        (true, _) => text.push_str("- "),
        (false, false) => text.push_str("+ "),
        (false, true) => {}
    }
    match coefficient.abs() {
        1.0 => text.push_str(what),
        // Writing into a string cannot fail.
        size => _ = write!(text, "{} {what}", number(size)),
    }
    text
}

fn write_objective(page: &mut Page, model: &Model, lines: &[FileLine<'_>], columns: &[String]) {
    page.word(&format!(" {}:", objective_name(lines)));
    let (terms, products) = (model.objective().affine().terms(), model.objective().products());
    // A column is known from its first appearance, so the order may need some zeros.
    let mut coefficients = vec![None; columns.len()];
    terms.iter().for_each(|&(variable, value)| coefficients[variable.index()] = Some(value));
    if !is_natural(&terms, &products, lines, columns.len()) {
        coefficients.iter_mut().for_each(|value| *value = value.or(Some(0.0)));
    }
    let affine = coefficients.iter().zip(columns);
    let affine = affine.filter_map(|(value, name)| Some(((*value)?, name.as_str())));
    let constant = constant(model).map(|value| (value, names::CONSTANT));
    let mut affine = affine.chain(constant).peekable();
    let empty = affine.peek().is_none();
    page.terms(true, affine);
    if !products.is_empty() {
        // All coefficients are doubled, because readers want the `/ 2`.
        write_products(page, empty, &products, 2.0, columns);
        page.part("/ 2");
    }
    page.end();
}

/// Writes `[ ... ]`, all coefficients times a factor.
fn write_products(
    page: &mut Page,
    first: bool,
    products: &[(Variable, Variable, f64)],
    factor: f64,
    columns: &[String],
) {
    page.part(if first { "[" } else { "+ [" });
    for (k, &(first, second, value)) in products.iter().enumerate() {
        let (a, b) = (&columns[first.index()], &columns[second.index()]);
        // Some readers want this spacing.
        let what = if first == second { format!("{a} ^2") } else { format!("{a} * {b}") };
        page.terms(k == 0, [(factor * value, what.as_str())]);
    }
    page.part("]");
}

/// The constant of the objective, if it has one.
fn constant(model: &Model) -> Option<f64> {
    let constant = model.objective().affine().offset();
    (constant.to_bits() != 0).then_some(constant)
}

fn write_names<'a>(page: &mut Page, title: &str, names: impl IntoIterator<Item = &'a String>) {
    let mut names = names.into_iter();
    if let Some(first) = names.next() {
        page.word(title);
        page.end();
        page.word(&format!(" {first}"));
        names.for_each(|name| page.part(name));
        page.end();
    }
}

fn write_sets(page: &mut Page, model: &Model, columns: &[String]) {
    for (k, set) in model.special_ordered_sets().enumerate() {
        if k == 0 {
            page.word("SOS");
            page.end();
        }
        page.word(&format!(" {}: S{}::", names::write(set.name()), set.most()));
        for &(member, weight) in set.members() {
            page.part(&format!("{}:{}", columns[member.index()], number(weight)));
        }
        page.end();
    }
}

/// Whether all columns appear, and for the first time in their order.
fn is_natural(
    terms: &[(Variable, f64)],
    products: &[(Variable, Variable, f64)],
    lines: &[FileLine<'_>],
    count: usize,
) -> bool {
    let products = products.iter().flat_map(|&(a, b, _)| [a, b]);
    let rows = lines.iter().flat_map(|line| {
        let condition = line.condition.map(Literal::variable);
        let products = line.products.iter().flat_map(|&(a, b, _)| [a, b]);
        condition.into_iter().chain(line.terms.iter().map(|&(v, _)| v)).chain(products)
    });
    let mut known = 0;
    for variable in terms.iter().map(|&(v, _)| v).chain(products).chain(rows) {
        match variable.index() {
            index if index > known => return false,
            index if index == known => known += 1,
            _ => {}
        }
    }
    known == count
}

fn write_row(page: &mut Page, line: &FileLine<'_>, columns: &[String]) {
    let Interval { lower, upper } = line.limits;
    let name = names::write(line.name);
    match (lower.is_finite(), upper.is_finite()) {
        (false, _) => write_half(page, &name, line, ("<=", upper), columns),
        (true, false) => write_half(page, &name, line, (">=", lower), columns),
        _ if lower.to_bits() == upper.to_bits() => {
            write_half(page, &name, line, ("=", lower), columns);
        }
        // Few readers take two limits in one row.
        (true, true) => {
            write_half(page, &(name.clone() + names::AT_LEAST), line, (">=", lower), columns);
            write_half(page, &(name + names::AT_MOST), line, ("<=", upper), columns);
        }
    }
}

fn write_half(
    page: &mut Page,
    name: &str,
    line: &FileLine<'_>,
    (relation, limit): (&str, f64),
    columns: &[String],
) {
    page.word(&format!(" {name}:"));
    if let Some(literal) = line.condition {
        let column = &columns[literal.variable().index()];
        page.part(&format!("{column} = {} ->", u8::from(literal.is_on())));
    }
    let terms = line.terms.iter().map(|&(v, a)| (a, columns[v.index()].as_str()));
    page.terms(true, terms);
    if !line.products.is_empty() {
        write_products(page, line.terms.is_empty(), &line.products, 1.0, columns);
    } else if line.terms.is_empty() {
        // Readers want a variable on the left.
        page.part(&columns.first().map_or("0".into(), |column| format!("0 {column}")));
    }
    page.word(&format!(" {relation} {}", number(limit)));
    page.end();
}

/// The entry of a variable in the bounds section, unless its kind implies it.
fn bound(variable: &VariableRef<'_>, bounds: Interval, column: &str) -> Option<String> {
    let Interval { lower, upper } = bounds;
    let top = if variable.kind() == VariableKind::Binary { 1.0 } else { f64::INFINITY };
    let low = lower.to_bits() != 0;
    let (lower_text, upper_text) = (number(lower), number(upper));
    match (lower.is_finite(), upper.is_finite()) {
        (false, false) => Some(format!("{column} free")),
        _ if lower.to_bits() == upper.to_bits() => Some(format!("{column} = {lower_text}")),
        (false, true) => Some(format!("-inf <= {column} <= {upper_text}")),
        (true, true) if low && upper != top => {
            Some(format!("{lower_text} <= {column} <= {upper_text}"))
        }
        (true, true) if upper != top => Some(format!("0 <= {column} <= {upper_text}")),
        _ if low => Some(format!("{column} >= {lower_text}")),
        _ => None,
    }
}
