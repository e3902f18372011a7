//! CBF files: linear cones, and second-order cones of single variables.

use super::model::{Model, Row};
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
                self.cone(&kind, columns)?;
            }
        }
        Ok(())
    }

    fn cone(&mut self, kind: &str, columns: Vec<u32>) -> Result<(), String> {
        match (kind, columns.split_first()) {
            ("Q", Some((&head, tail))) => {
                self.model.cones.push(Cone { head, second: None, tail: tail.to_vec() });
                Ok(())
            }
            ("QR", _) => {
                self.model.leave_out("a cone QR", None);
                for column in columns {
                    self.model
                        .unequal_columns
                        .get_mut(column as usize)
                        .into_iter()
                        .for_each(|c| *c = true);
                }
                Ok(())
            }
            _ => Err(format!("cone `{kind}` is not read")),
        }
    }

    fn finish(mut self) -> Result<Model, String> {
        let (cones, mut number) = (std::mem::take(&mut self.cones), 0);
        for (kind, size) in cones {
            let mut members = Vec::new();
            for _ in 0..size {
                let (entries, constant) = self.rows.get(number).cloned().unwrap_or_default();
                if let Some((lower, upper)) = sides(&kind) {
                    let (lower, upper) = (lower - constant, upper - constant);
                    let name = format!("c[{number}]");
                    self.model.rows.push(Row { name, lower, upper, entries });
                } else {
                    members.push(match entries[..] {
                        [(column, 1.0)] if constant == 0.0 => Some(column),
                        _ => None,
                    });
                }
                number += 1;
            }
            match members.into_iter().collect::<Option<Vec<u32>>>() {
                _ if sides(&kind).is_some() => {}
                Some(columns) => self.cone(&kind, columns)?,
                None => self.model.leave_out(format!("a cone {kind} of expressions"), None),
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
