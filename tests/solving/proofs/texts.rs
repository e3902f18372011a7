//! Random model files with what readers and proofs find hard: integers without bounds, bounds that
//! are not whole, squares, quadratic rows, cones, indicators, odd names, repeated entries.

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

/// Products of a sum of squares of random forms, each at least 0: `row <= column`, in whole
/// numbers.
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
        (true, 2) => format!("x[{j},b]"),
        (true, 3) => format!("x{{{j}}}"),
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

/// A number with at most one digit behind the point.
fn number(r: &mut Random, low: i32, high: i32) -> String {
    match r.chance(0.5) {
        true => r.within(low, high).to_string(),
        false => format!("{}", f64::from(r.within(10 * low, 10 * high)) / 10.0),
    }
}

/// An MPS file with ranges in decimals, products, semi-continuous columns and ordered sets.
pub(super) fn mps(seed: u64) -> String {
    let r = &mut Random::new(seed);
    let (columns, rows) = (1 + r.below(4), 1 + r.below(4));
    let names: Vec<String> = (0..columns)
        .map(|j| if r.chance(0.5) { format!("x[{j},1]") } else { format!("x({j})") })
        .collect();
    let mut text = "NAME t\nROWS\n N cost\n".to_owned();
    for row in 0..rows {
        let _ = writeln!(text, " {} r{row}", ["L", "G", "L", "E"][r.below(4)]);
    }
    text += "COLUMNS\n";
    let mut is_marked = false;
    for (j, name) in names.iter().enumerate() {
        if r.chance(0.4) {
            is_marked = !is_marked;
            let _ =
                writeln!(text, " M{j} 'MARKER' '{}'", if is_marked { "INTORG" } else { "INTEND" });
        }
        let _ = writeln!(text, " {name} cost {}", number(r, -3, 3));
        for row in 0..rows {
            if r.chance(0.6) {
                let _ = writeln!(text, " {name} r{row} {}", number(r, -4, 4));
            }
        }
    }
    if is_marked {
        text += " M 'MARKER' 'INTEND'\n";
    }
    text += "RHS\n";
    for row in 0..rows {
        if r.chance(0.8) {
            let _ = writeln!(text, " RHS r{row} {}", number(r, -9, 9));
        }
    }
    text += "RANGES\n";
    for row in 0..rows {
        if r.chance(0.4) {
            let _ = writeln!(text, " R r{row} {}", f64::from(r.within(1, 999)) / 100.0);
        }
    }
    text += "BOUNDS\n";
    for name in &names {
        let (low, high) = (number(r, -9, 0), number(r, 1, 9));
        let _ = match r.below(6) {
            0 => writeln!(text, " FR B {name}"),
            1 => writeln!(text, " MI B {name}\n UP B {name} {high}"),
            2 => writeln!(text, " BV B {name}"),
            3 => writeln!(text, " SC B {name} {high}"),
            _ => writeln!(text, " LO B {name} {low}\n UP B {name} {high}"),
        };
    }
    for section in ["QUADOBJ", "QCMATRIX r0"] {
        if r.chance(0.3) {
            text = format!("{text}{section}\n");
            for name in &names {
                if r.chance(0.7) {
                    let _ = writeln!(text, " {name} {name} {}", r.within(1, 4));
                }
            }
        }
    }
    text + "ENDATA\n"
}

/// The sizes of cones for some entries.
fn cones(r: &mut Random, entries: usize) -> Vec<(&'static str, usize)> {
    let (mut all, mut left) = (Vec::new(), entries);
    while left > 0 {
        let size = 1 + r.below(left);
        let kind = ["F", "L+", "L-", "L=", "Q", "Q", "QR"][r.below(7)];
        all.push((if kind == "QR" && size < 2 { "L+" } else { kind }, size));
        left -= size;
    }
    all
}

/// A CBF file with cones of any size, of columns and of expressions.
pub(super) fn cbf(seed: u64) -> String {
    let r = &mut Random::new(seed);
    let (columns, rows) = (2 + r.below(5), 1 + r.below(6));
    let sense = if r.chance(0.5) { "MIN" } else { "MAX" };
    let mut text = format!("VER\n1\nOBJSENSE\n{sense}\n");
    for (section, entries) in [("VAR", columns), ("CON", rows)] {
        let all = cones(r, entries);
        let _ = writeln!(text, "{section}\n{entries} {}", all.len());
        all.iter().for_each(|(kind, size)| text += &format!("{kind} {size}\n"));
    }
    let whole: Vec<usize> = (0..columns).filter(|_| r.chance(0.3)).collect();
    let costs: Vec<String> = (0..columns).map(|j| format!("{j} {}", number(r, -3, 3))).collect();
    let mut entries = Vec::new();
    for row in 0..rows {
        for column in (0..columns).filter(|_| r.chance(0.35)).collect::<Vec<_>>() {
            let value = ["1", "1", "-1", "2", "0.5", "0.1", "-3"][r.below(7)];
            entries.push(format!("{row} {column} {value}"));
        }
    }
    let constants: Vec<String> = (0..rows)
        .filter(|_| r.chance(0.5))
        .collect::<Vec<_>>()
        .into_iter()
        .map(|row| format!("{row} {}", number(r, -4, 4)))
        .collect();
    let whole: Vec<String> = whole.iter().map(ToString::to_string).collect();
    for (section, lines) in
        [("INT", whole), ("OBJACOORD", costs), ("ACOORD", entries), ("BCOORD", constants)]
    {
        if !lines.is_empty() {
            let _ = writeln!(text, "{section}\n{}\n{}", lines.len(), lines.join("\n"));
        }
    }
    text
}
