//! Random model files with what readers and proofs find hard: integers without bounds, bounds that are not whole,
//! squares, quadratic rows, cones, indicators, odd names, repeated entries.

use std::fmt::Write as _;

use crate::torture::generator::Random;

/// A term of a text, with its sign in front.
fn term(coefficient: i32, name: &str) -> String {
    let sign = if coefficient < 0 { '-' } else { '+' };
    match coefficient.abs() {
        1 => format!(" {sign} {name}"),
        size => format!(" {sign} {size} {name}"),
    }
}

/// Products of a sum of squares of random forms, each at least 0: `row <= column`, in whole numbers.
fn squares(r: &mut Random, columns: usize) -> Vec<(usize, usize, i32)> {
    let mut matrix = vec![0; columns * columns];
    for _ in 0..1 + r.below(2) {
        let form: Vec<i32> =
            (0..columns).map(|_| if r.chance(0.5) { r.within(-4, 4) } else { 0 }).collect();
        for i in 0..columns {
            for j in 0..columns {
                matrix[i * columns + j] += form[i] * form[j];
            }
        }
    }
    let pairs = (0..columns).flat_map(|i| (i..columns).map(move |j| (i, j)));
    let entries = pairs.map(|(i, j)| (i, j, matrix[i * columns + j] * if i == j { 1 } else { 2 }));
    entries.filter(|entry| entry.2 != 0).collect()
}

/// Products in brackets.
fn bracket(products: &[(usize, usize, i32)], names: &[String]) -> String {
    let mut text = "[".to_owned();
    for &(i, j, value) in products {
        let name = if i == j {
            format!("{} ^2", names[i])
        } else {
            format!("{} * {}", names[i], names[j])
        };
        text += &term(value, &name);
    }
    text + " ]"
}

/// Random terms over some columns, at least one.
fn terms(r: &mut Random, names: &[String], repeats: bool) -> String {
    let mut text = String::new();
    for name in names {
        if r.chance(0.6) {
            text += &term(r.within(1, 4) * if r.chance(0.5) { 1 } else { -1 }, name);
        }
    }
    if text.is_empty() || (repeats && r.chance(0.2)) {
        text += &term(r.within(1, 3), &names[r.below(names.len())]);
    }
    text
}

/// An LP file. `is_odd`: with names in brackets and entries that are repeated.
pub(super) fn lp(seed: u64, is_odd: bool) -> String {
    let r = &mut Random::new(seed);
    let columns = 1 + r.below(4);
    let name = |j: usize| match (is_odd, j % 4) {
        (true, 1) => format!("x({j},a)"),
        (true, 2) => format!("x{{{j}}}.b"),
        (true, 3) => format!("x_{j}#c"),
        _ => format!("x{j}"),
    };
    let mut names: Vec<String> = (0..columns).map(name).collect();
    let has_binary = r.chance(0.4);
    if has_binary {
        names.push("b".to_owned());
    }
    let open = &names[..columns];
    let mut text = (if r.chance(0.8) { "Minimize\n obj:" } else { "Maximize\n obj:" }).to_owned();
    let is_maximised = text.starts_with("Max");
    text += &terms(r, &names, is_odd);
    if r.chance(0.6) {
        let mut products = squares(r, columns);
        if is_maximised {
            products.iter_mut().for_each(|product| product.2 = -product.2);
        }
        if !products.is_empty() {
            let _ = write!(text, " + {} / 2", bracket(&products, open));
        }
    }
    if r.chance(0.3) {
        let _ = write!(text, " + {}", r.within(0, 9));
    }
    text += "\nSubject To\n";
    for row in 0..1 + r.below(3) {
        let relation = ["<=", ">=", "="][r.below(3).min(r.below(3))];
        let (sum, limit) = (terms(r, &names, is_odd), r.within(-9, 9));
        let half = if r.chance(0.2) { ".5" } else { "" };
        let _ = writeln!(text, " r{row}:{sum} {relation} {limit}{half}");
    }
    if r.chance(0.25) {
        let products = squares(r, columns);
        if !products.is_empty() {
            let linear = if r.chance(0.4) { terms(r, open, false) } else { String::new() };
            let _ =
                writeln!(text, " q:{linear} + {} <= {}", bracket(&products, open), r.within(1, 40));
        }
    }
    text += "Bounds\n";
    let mut integral = Vec::new();
    for name in open {
        let (low, high) = (r.within(-6, 2), r.within(2, 8));
        let half = if r.chance(0.15) { ".5" } else { "" };
        let _ = match r.below(7) {
            0 => writeln!(text, " {name} free"),
            1 => writeln!(text, " {name} >= {low}{half}"),
            2 => writeln!(text, " -inf <= {name} <= {high}{half}"),
            3 => writeln!(text, " -1e16 <= {name} <= 1e17"),
            4 => Ok(()),
            _ => writeln!(text, " {low} <= {name} <= {high}{half}"),
        };
        if r.chance(0.6) {
            integral.push(name.clone());
        }
    }
    if !integral.is_empty() {
        let _ = writeln!(text, "General\n {}", integral.join(" "));
    }
    if has_binary {
        text += "Binary\n b\n";
        if r.chance(0.5) {
            // Over columns with bounds, or none, for which the lowering finds no M.
            let (name, relation) = (&open[r.below(columns)], ["<=", ">="][r.below(2)]);
            let row = format!(" i: b = {} -> {name} {relation} {}\n", r.below(2), r.within(-3, 3));
            text = text.replace("Bounds\n", &format!("{row}Bounds\n"));
        }
    }
    text + "End\n"
}
