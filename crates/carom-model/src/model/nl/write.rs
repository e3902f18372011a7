//! Writing, as text: every number in its shortest exact form, with the comments that are usual.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::functions::{arguments, function, function_lines};
use super::order::{Class, Order};
use crate::error::{Error, ErrorKind};
use crate::interval::Interval;
use crate::model::Model;
use crate::model::ids::Variable;
use crate::model::name::Name;
use crate::model::sense::Sense;
use crate::model::text::lines::{FileLine, lines, number, quadratic_lines};
use crate::model::text::quadratic_rows::with_quadratic_rows;

/// Products of columns, the first one first, and their factors.
type Products = BTreeMap<(usize, usize), f64>;

/// The text of a model.
pub(super) fn text(model: &Model) -> Result<String, Error> {
    let model = &*with_quadratic_rows(model)?;
    let rows = rows(model)?;
    let sets = sets(model)?;
    let order = Order::new(model, &rows);
    let objective = model.objective();
    let (affine, products) = (objective.affine(), placed(&objective.products(), &order));
    let row_products: Vec<Products> =
        rows.iter().map(|row| placed(&row.products, &order)).collect();
    let parts = rows.iter().zip(&row_products);
    let entries: Vec<BTreeMap<usize, f64>> = parts
        .map(|(row, products)| {
            let mut own = entries(&row.terms, products, &order);
            for variable in row.function.into_iter().flat_map(arguments) {
                own.entry(order.position(variable)).or_insert(0.0);
            }
            own
        })
        .collect();
    let gradient = self::entries(&affine.terms(), &products, &order);
    let mut text = String::new();
    header(&mut text, model, &rows, &order, [&entries[..], std::slice::from_ref(&gradient)]);
    write_sets(&mut text, &sets, &order);
    for (k, (row, products)) in rows.iter().zip(&row_products).enumerate() {
        put(&mut text, format_args!("C{k}\n"));
        match row.function {
            Some(own) => function(&mut text, own, &|variable| order.position(variable)),
            None => expression(&mut text, products, 0.0),
        }
    }
    let sense = u8::from(model.sense() == Sense::Maximize);
    put(&mut text, format_args!("O0 {sense}\n"));
    expression(&mut text, &products, affine.offset());
    if !rows.is_empty() {
        text.push_str("r\n");
        rows.iter().for_each(|row| limits(&mut text, row.limits));
    }
    if !order.columns.is_empty() {
        text.push_str("b\n");
        for &column in &order.columns {
            limits(&mut text, model.variable_ref(column)?.bounds());
        }
    }
    column_starts(&mut text, &entries, order.columns.len());
    entries.iter().enumerate().for_each(|(k, row)| terms(&mut text, 'J', k, row));
    terms(&mut text, 'G', 0, &gradient);
    Ok(text)
}

/// The rows: those with products first.
pub(super) fn rows(model: &Model) -> Result<Vec<FileLine<'_>>, Error> {
    let linear = lines(model, "NL")?;
    let mut rows = function_lines(model)?;
    rows.extend(quadratic_lines(model, "NL")?);
    rows.extend(linear);
    let refuse = |what, name: &Name| {
        Err(ErrorKind::NotInFile { format: "NL", what, name: name.to_string() }.into())
    };
    if let Some(row) = rows.iter().find(|row| row.condition.is_some()) {
        return refuse("the condition of", row.name);
    }
    if let Some(x) = model.variables().find(|variable| variable.semicontinuous().is_some()) {
        return refuse("the semi-continuous variable", x.name());
    }
    Ok(rows)
}

/// By variable in an ordered set, its number and its weight.
fn sets(model: &Model) -> Result<BTreeMap<Variable, (i64, f64)>, Error> {
    let mut members = BTreeMap::new();
    for (set, k) in model.special_ordered_sets().zip(1_i64..) {
        let k = if set.most() == 2 { -k } else { k };
        for &(member, weight) in set.members() {
            if members.insert(member, (k, weight)).is_some() {
                let what = "a variable that is in another ordered set and in";
                let name = set.name().to_string();
                return Err(ErrorKind::NotInFile { format: "NL", what, name }.into());
            }
        }
    }
    Ok(members)
}

/// Products by columns.
fn placed(products: &[(Variable, Variable, f64)], order: &Order) -> Products {
    let pair = |a: usize, b: usize| (a.min(b), a.max(b));
    let placed = |&(a, b, q)| (pair(order.position(a), order.position(b)), q);
    products.iter().map(placed).collect()
}

/// Columns and coefficients of a row, with a 0 where a column stands in products alone.
fn entries(terms: &[(Variable, f64)], products: &Products, order: &Order) -> BTreeMap<usize, f64> {
    let both = products.keys().flat_map(|&(a, b)| [a, b]);
    let mut entries: BTreeMap<usize, f64> = both.map(|column| (column, 0.0)).collect();
    entries.extend(terms.iter().map(|&(v, a)| (order.position(v), a)));
    entries
}

fn header(
    text: &mut String,
    model: &Model,
    rows: &[FileLine<'_>],
    order: &Order,
    [entries, gradient]: [&[BTreeMap<usize, f64>]; 2],
) {
    let nonzeros = |of: &[BTreeMap<usize, f64>]| of.iter().map(BTreeMap::len).sum::<usize>();
    let is = |of: fn(Interval) -> bool| rows.iter().filter(|row| of(row.limits)).count();
    let ranges =
        is(|limits| limits.lower.is_finite() && limits.upper.is_finite() && !is_point(limits));
    let [both, both_whole, in_rows, rows_whole, costs, costs_whole] = [
        Class::Both,
        Class::BothInteger,
        Class::Constraints,
        Class::ConstraintsInteger,
        Class::Objective,
        Class::ObjectiveInteger,
    ]
    .map(|class| order.count(class));
    let in_both = both + both_whole;
    let in_rows = in_both + in_rows + rows_whole;
    let in_objective = match costs + costs_whole {
        0 => in_both,
        alone => in_rows + alone,
    };
    let name = if model.name().trim().is_empty() { "unknown" } else { model.name().trim() };
    let is_nonlinear = |row: &&FileLine<'_>| !row.products.is_empty() || row.function.is_some();
    let with_products = rows.iter().filter(is_nonlinear).count();
    let objectives = usize::from(!model.objective().products().is_empty());
    put(text, format_args!("g3 1 1 0\t# problem {name}\n"));
    let mut line = |numbers: &[usize], what: &str| {
        let numbers: Vec<String> = numbers.iter().map(usize::to_string).collect();
        put(text, format_args!(" {}\t# {what}\n", numbers.join(" ")));
    };
    line(
        &[model.variable_count(), rows.len(), 1, ranges, is(is_point)],
        "vars, constraints, objectives, ranges, eqns",
    );
    line(&[with_products, objectives], "nonlinear constraints, objectives");
    line(&[0, 0], "network constraints: nonlinear, linear");
    line(&[in_rows, in_objective, in_both], "nonlinear vars in constraints, objectives, both");
    line(&[0, 0, 0, 1], "linear network variables; functions; arith, flags");
    let (binaries, integers) = (order.count(Class::Binary), order.count(Class::Integer));
    line(
        &[binaries, integers, both_whole, rows_whole, costs_whole],
        "discrete variables: binary, integer, nonlinear (b,c,o)",
    );
    line(&[nonzeros(entries), nonzeros(gradient)], "nonzeros in Jacobian, gradients");
    line(&[0, 0], "max name lengths: constraints, variables");
    line(&[0, 0, 0, 0, 0], "common exprs: b,c,o,c1,o1");
}

fn write_sets(text: &mut String, sets: &BTreeMap<Variable, (i64, f64)>, order: &Order) {
    if sets.is_empty() {
        return;
    }
    let members: BTreeMap<usize, (i64, f64)> =
        sets.iter().map(|(member, set)| (order.position(*member), *set)).collect();
    put(text, format_args!("S0 {} sosno\n", members.len()));
    members.iter().for_each(|(column, (set, _))| put(text, format_args!("{column} {set}\n")));
    put(text, format_args!("S4 {} ref\n", members.len()));
    for (column, (_, weight)) in members {
        put(text, format_args!("{column} {}\n", number(weight)));
    }
}

/// A sum of products and a constant.
fn expression(text: &mut String, products: &Products, constant: f64) {
    // A constant of 0 may have a sign.
    let has_constant = constant.to_bits() != 0 || products.is_empty();
    match products.len() + usize::from(has_constant) {
        1 => {}
        2 => text.push_str("o0\n"),
        count => put(text, format_args!("o54\n{count}\n")),
    }
    for (&(a, b), &factor) in products {
        if factor != 1.0 {
            put(text, format_args!("o2\nn{}\n", number(factor)));
        }
        match a == b {
            true => put(text, format_args!("o5\nv{a}\nn2\n")),
            false => put(text, format_args!("o2\nv{a}\nv{b}\n")),
        }
    }
    if has_constant {
        put(text, format_args!("n{}\n", number(constant)));
    }
}

fn is_point(limits: Interval) -> bool {
    limits.lower.to_bits() == limits.upper.to_bits()
}

/// A line of `r` or `b`.
fn limits(text: &mut String, limits: Interval) {
    let (lower, upper) = (number(limits.lower), number(limits.upper));
    match (limits.lower.is_finite(), limits.upper.is_finite()) {
        _ if is_point(limits) => put(text, format_args!("4 {lower}\n")),
        (true, true) => put(text, format_args!("0 {lower} {upper}\n")),
        (false, true) => put(text, format_args!("1 {upper}\n")),
        (true, false) => put(text, format_args!("2 {lower}\n")),
        (false, false) => text.push_str("3\n"),
    }
}

/// For each column but the last, how many entries it and those before it have.
fn column_starts(text: &mut String, rows: &[BTreeMap<usize, f64>], columns: usize) {
    if columns == 0 {
        return;
    }
    let mut counts = vec![0_usize; columns];
    rows.iter().flat_map(BTreeMap::keys).for_each(|column| counts[*column] += 1);
    put(text, format_args!("k{}\n", columns - 1));
    let mut sum = 0;
    for count in &counts[..columns - 1] {
        sum += count;
        put(text, format_args!("{sum}\n"));
    }
}

/// The linear part of a row or of the objective.
fn terms(text: &mut String, letter: char, k: usize, entries: &BTreeMap<usize, f64>) {
    if !entries.is_empty() {
        put(text, format_args!("{letter}{k} {}\n", entries.len()));
        entries.iter().for_each(|(at, a)| put(text, format_args!("{at} {}\n", number(*a))));
    }
}

fn put(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    // Writing into a string cannot fail.
    let _ = text.write_fmt(arguments);
}
