//! CBF files: linear cones, and second-order cones of single variables.

use super::model::{Model, Row, StatedCone, Statement};
use super::polynomial::{Affine, Polynomial};
use crate::program::Cone;

/// Most entries of a cone.
const MOST_ROWS: usize = 10_000_000;

/// If the entries of a cone are rows, the lower and the upper side of each.
fn sides(cone: &str) -> Option<(f64, f64)> {
    match cone {
        "F" => Some((f64::NEG_INFINITY, f64::INFINITY)),
        "L=" => Some((0.0, 0.0)),
        "L+" => Some((0.0, f64::INFINITY)),
        "L-" => Some((f64::NEG_INFINITY, 0.0)),
        _ => None,
    }
}

/// The entries of a row, and its constant.
type Entries = (Vec<(u32, f64)>, f64);

#[derive(Default)]
struct Reader {
    model: Model,
    /// The cones of rows, and their sizes.
    cones: Vec<(String, usize)>,
    rows: Vec<Entries>,
}

pub(super) fn read(text: &str) -> Result<Model, String> {
    let mut reader = Reader::default();
    let lines = text.lines().zip(1..).map(|(line, number)| (line.trim(), number));
    let mut lines = lines.filter(|(line, _)| !line.is_empty() && !line.starts_with('#'));
    while let Some((section, number)) = lines.next() {
        let mut next = || {
            let (line, number) = lines.next().ok_or("the file ends in a section")?;
            let fields: Vec<&str> = line.split_ascii_whitespace().collect();
            Ok::<_, String>((fields, number))
        };
        reader
            .section(section, &mut next)
            .map_err(|why| format!("section of line {number}: {why}"))?;
    }
    reader.finish()
}

type Next<'a, 'b> = dyn FnMut() -> Result<(Vec<&'a str>, usize), String> + 'b;

impl Reader {
    fn section(&mut self, section: &str, next: &mut Next<'_, '_>) -> Result<(), String> {
        match section {
            "VER" => drop(next()?),
            "OBJSENSE" => self.model.is_maximisation = next()?.0 == ["MAX"],
            "VAR" => self.variables(next)?,
            "CON" => {
                let (many, cones) = counts(next)?;
                for _ in 0..cones {
                    self.cones.push(cone(next)?);
                }
                let sizes: usize = self.cones.iter().map(|cone| cone.1).sum();
                if sizes != many {
                    return Err("the sizes of the cones do not add up".to_string());
                }
            }
            "INT" => {
                for _ in 0..count(next)? {
                    let index = parse(next()?.0.first())?;
                    let column = self.model.column_mut(index).ok_or("there is no such variable")?;
                    column.is_integral = true;
                }
            }
            "OBJACOORD" => {
                for _ in 0..count(next)? {
                    let fields = next()?.0;
                    self.model.linear.push((parse(fields.first())?, parse(fields.get(1))?));
                }
            }
            "OBJBCOORD" => self.model.constant = parse(next()?.0.first())?,
            "ACOORD" => {
                for _ in 0..count(next)? {
                    let fields = next()?.0;
                    let row: usize = parse(fields.first())?;
                    let entry = (parse(fields.get(1))?, parse(fields.get(2))?);
                    self.row(row)?.0.push(entry);
                }
            }
            "BCOORD" => {
                for _ in 0..count(next)? {
                    let fields = next()?.0;
                    let row: usize = parse(fields.first())?;
                    self.row(row)?.1 = parse(fields.get(1))?;
                }
            }
            _ => return Err(format!("`{section}` is not read")),
        }
        Ok(())
    }

    /// The entries and the constant of a row.
    fn row(&mut self, row: usize) -> Result<&mut Entries, String> {
        if row >= self.rows.len() {
            if row >= self.cones.iter().map(|cone| cone.1).sum() {
                return Err(format!("there is no row {row}"));
            }
            self.rows.resize(row + 1, (Vec::new(), 0.0));
        }
        self.rows.get_mut(row).ok_or_else(|| format!("there is no row {row}"))
    }

    fn variables(&mut self, next: &mut Next<'_, '_>) -> Result<(), String> {
        let (_, cones) = counts(next)?;
        for _ in 0..cones {
            let (kind, size) = cone(next)?;
            let (lower, upper) = sides(&kind).unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
            let mut columns = Vec::new();
            for _ in 0..size {
                let index = self.model.column(&format!("x[{}]", self.model.columns.len()));
                columns.push(index);
                if let Some(column) = self.model.column_mut(index) {
                    (column.lower, column.upper) = (lower, upper);
                }
            }
            if sides(&kind).is_none() {
                let entries = columns.into_iter().map(Affine::column).collect();
                self.cone(&kind, entries, &kind.clone())?;
            }
        }
        Ok(())
    }

    /// Adds a cone of expressions.
    fn cone(&mut self, kind: &str, entries: Vec<Affine>, name: &str) -> Result<(), String> {
        let heads = match kind {
            "Q" => 1,
            "QR" => 2,
            _ => return Err(format!("cone `{kind}` is not read")),
        };
        if entries.len() < heads {
            return Err(format!("a cone {kind} with too few entries"));
        }
        let (head, tail) = entries.split_at(heads);
        let is_constant = |form: &Affine| form.terms.is_empty();
        let tail: Vec<&Affine> =
            tail.iter().filter(|form| !is_constant(form) || form.constant != 0.0).collect();
        // A head that is a multiple of a column bounds it.
        for form in head {
            if let [(column, factor)] = form.terms[..]
                && factor > 0.0
                && form.constant == 0.0
                && let Some(own) = self.model.column_mut(column).filter(|own| own.upper >= 0.0)
            {
                own.lower = own.lower.max(0.0);
            }
        }
        let is_closed = head.iter().any(|form| is_constant(form) && form.constant <= 0.0);
        if is_closed || tail.is_empty() {
            head.iter().for_each(|form| self.side(form, f64::INFINITY, name));
            tail.iter().for_each(|form| self.side(form, 0.0, name));
            return Ok(());
        }
        if head.iter().all(is_constant) && tail.iter().all(|form| is_constant(form)) {
            let limit = match head {
                [first, second] => (2.0 * first.constant).sqrt() * second.constant.sqrt(),
                _ => head.iter().map(|form| form.constant).sum(),
            };
            let length = tail.iter().fold(0.0_f64, |length, form| length.hypot(form.constant));
            if length > limit + 1e-12 * limit {
                let (lower, upper, entries) = (length - limit, f64::INFINITY, Vec::new());
                self.model.rows.push(Row { name: name.to_string(), lower, upper, entries });
            }
            return Ok(());
        }
        let column = |form: &Affine| match form.terms[..] {
            [(column, 1.0)] if form.constant == 0.0 => Some(column),
            _ => None,
        };
        let columns: Option<Vec<u32>> =
            head.iter().chain(tail.iter().copied()).map(column).collect();
        if let ("Q", Some([first, rest @ ..])) = (kind, columns.as_deref()) {
            let mut all = columns.clone().unwrap_or_default();
            all.sort_unstable();
            all.dedup();
            if all.len() == rest.len() + 1 {
                self.model.cones.push(Cone { head: *first, second: None, tail: rest.to_vec() });
                return Ok(());
            }
        }
        let mut polynomial = Polynomial::default();
        match head {
            [first, second] => polynomial.add_product(2.0, first, second),
            _ => head.iter().for_each(|form| polynomial.add_product(1.0, form, form)),
        }
        tail.iter().for_each(|form| polynomial.add_product(-1.0, form, form));
        let of = if columns.is_some() { "columns" } else { "expressions" };
        let what = format!("a cone {kind} of {of}");
        let heads = head.iter().map(Polynomial::of).collect();
        self.model.statements.push(Statement::Cone(StatedCone { what, polynomial, heads }));
        Ok(())
    }

    /// Adds the row that an expression is at least 0, and at most something.
    fn side(&mut self, form: &Affine, most: f64, name: &str) {
        // A constant that is at least 0, and a column that its bound keeps there, need no row.
        let is_kept = match form.terms[..] {
            [] => form.constant >= 0.0,
            [(column, factor)] => {
                factor > 0.0 && form.constant == 0.0 && self.model.bounds_of(column).0 >= 0.0
            }
            _ => false,
        };
        if is_kept && most == f64::INFINITY {
            return;
        }
        let limit = 0.0 - form.constant;
        let upper = if most == f64::INFINITY { most } else { limit };
        let entries = form.terms.clone();
        self.model.rows.push(Row { name: name.to_string(), lower: limit, upper, entries });
    }

    fn finish(mut self) -> Result<Model, String> {
        let (cones, mut number) = (std::mem::take(&mut self.cones), 0);
        for (kind, size) in cones {
            let (first, mut members) = (number, Vec::new());
            for _ in 0..size {
                let (entries, constant) = self.rows.get(number).cloned().unwrap_or_default();
                if let Some((lower, upper)) = sides(&kind) {
                    let (lower, upper) = (lower - constant, upper - constant);
                    let name = format!("c[{number}]");
                    self.model.rows.push(Row { name, lower, upper, entries });
                } else {
                    let mut terms = entries;
                    terms.sort_by_key(|term| term.0);
                    terms.retain(|term| term.1 != 0.0);
                    members.push(Affine { terms, constant });
                }
                number += 1;
            }
            if sides(&kind).is_none() {
                self.cone(&kind, members, &format!("c[{first}]"))?;
            }
        }
        Ok(self.model)
    }
}

fn cone(next: &mut Next<'_, '_>) -> Result<(String, usize), String> {
    let fields = next()?.0;
    let size = parse(fields.get(1))?;
    if size > MOST_ROWS {
        return Err(format!("a cone with {size} entries"));
    }
    Ok((fields.first().ok_or("a cone without a kind")?.to_string(), size))
}

fn count(next: &mut Next<'_, '_>) -> Result<usize, String> {
    parse(next()?.0.first())
}

fn counts(next: &mut Next<'_, '_>) -> Result<(usize, usize), String> {
    let fields = next()?.0;
    Ok((parse(fields.first())?, parse(fields.get(1))?))
}

fn parse<T: std::str::FromStr>(word: Option<&&str>) -> Result<T, String> {
    let word = word.ok_or("a number is missing")?;
    word.parse().map_err(|_| format!("`{word}` is no number of this kind"))
}
