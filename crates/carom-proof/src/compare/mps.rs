//! MPS files, fixed or free: fields are what white space separates.

use super::decimal::moved;
use super::model::{Indicator, Model, Row, Statement};
use std::collections::{HashMap, HashSet};

/// Magnitudes from here on are infinite.
const INFINITE: f64 = 1e20;

#[derive(Default)]
struct Reader {
    model: Model,
    objective: Option<String>,
    /// The kind of each row, and its place; the objective and other free rows have none.
    rows: HashMap<String, Option<usize>>,
    kinds: Vec<char>,
    /// The right-hand side and the range of each row, as they stand there.
    right_sides: Vec<Option<String>>,
    ranges: Vec<Option<String>>,
    is_integral: bool,
    /// Columns with a bound.
    bounded: HashSet<u32>,
    /// Columns with a lower bound.
    has_lower: HashSet<u32>,
    /// Integral columns from markers.
    marked: Vec<u32>,
    /// The first name of a set in each section.
    sets: HashMap<String, String>,
    /// Rows with products of columns, and those that are conditional on a column with a value.
    squares: HashMap<String, Vec<(u32, u32, f64)>>,
    conditions: HashMap<String, (u32, f64)>,
    /// The kind of the last ordered set, and its members so far.
    set: Option<(u8, Vec<u32>)>,
}

pub(super) fn read(text: &str) -> Result<Model, String> {
    let mut reader = Reader::default();
    let (mut section, mut argument) = (String::new(), String::new());
    for (line, number) in text.lines().zip(1..) {
        if line.starts_with('*') || line.trim().is_empty() {
            continue;
        }
        // A word behind the name of a line that begins with $ or * begins a comment.
        let is_comment = |(k, word): &(usize, &str)| *k > 0 && word.starts_with(['$', '*']);
        let words = line.split_ascii_whitespace().enumerate();
        let fields: Vec<&str> = words.take_while(|word| !is_comment(word)).map(|w| w.1).collect();
        let is_section = !line.starts_with(|letter: char| letter.is_ascii_whitespace());
        if is_section {
            section = fields.first().map(|word| word.to_ascii_uppercase()).unwrap_or_default();
            argument = fields.get(1).map(ToString::to_string).unwrap_or_default();
        }
        let done = match (is_section, section.as_str()) {
            (true, "ENDATA") => return reader.finish(),
            (true, _) => reader.begin(&section, &argument),
            (false, _) => reader.line(&section, &argument, &fields),
        };
        done.map_err(|why| format!("line {number}: {why}"))?;
    }
    Err("there is no ENDATA".to_string())
}

impl Reader {
    fn begin(&mut self, section: &str, argument: &str) -> Result<(), String> {
        self.end_set();
        match section {
            "NAME" | "ROWS" | "COLUMNS" | "RHS" | "RANGES" | "BOUNDS" | "QUADOBJ" | "QMATRIX" => {}
            "OBJSENSE" => self.sense(argument),
            "OBJNAME" if argument.is_empty() => {}
            "OBJNAME" => self.objective = Some(argument.to_string()),
            "QSECTION" if self.is_objective(argument) => {}
            "QCMATRIX" | "QSECTION" => {
                self.squares.entry(argument.to_string()).or_default();
            }
            "SOS" | "SOS1" | "SOS2" | "SETS" | "INDICATORS" => {}
            _ => self.model.leave_out(format!("section {section}")),
        }
        Ok(())
    }

    fn sense(&mut self, word: &str) {
        self.model.is_maximisation |= word.to_ascii_uppercase().starts_with("MAX");
    }

    fn is_objective(&self, name: &str) -> bool {
        name.is_empty() || self.objective.as_deref() == Some(name)
    }

    fn line(&mut self, section: &str, argument: &str, fields: &[&str]) -> Result<(), String> {
        match (section, fields) {
            ("OBJSENSE", [word, ..]) => self.sense(word),
            ("OBJNAME", [word, ..]) => self.objective = Some((*word).to_string()),
            ("ROWS", [kind, name, ..]) => self.row(kind, name)?,
            ("COLUMNS", [_, marker, kind, ..]) if marker.trim_matches('\'') == "MARKER" => {
                self.is_integral = kind.trim_matches('\'') == "INTORG";
            }
            ("COLUMNS", [name, pairs @ ..]) => self.column(name, pairs)?,
            ("RHS" | "RANGES", fields) => {
                let (set, pairs) = fields.split_at(fields.len() % 2);
                if self.is_first(section, set.first().copied().unwrap_or_default()) {
                    self.sides(section, pairs)?;
                }
            }
            ("BOUNDS", fields) => self.bound(fields)?,
            ("QSECTION" | "QCMATRIX", [a, b, value]) if !self.is_objective(argument) => {
                let (a, b, value) = (self.known(a)?, self.known(b)?, number(value)?);
                // `x'Qx` with both orders of a pair; or `x'Qx / 2` with one of them.
                let halved = if section == "QSECTION" && a == b { 0.5 } else { 1.0 };
                let own = self.squares.entry(argument.to_string()).or_default();
                own.push((a.min(b), a.max(b), halved * value));
            }
            ("QUADOBJ" | "QMATRIX" | "QSECTION", [a, b, value]) => {
                let (a, b) = (self.known(a)?, self.known(b)?);
                let halved = if section == "QMATRIX" && a != b { 0.5 } else { 1.0 };
                self.model.triangle.push((a.min(b), a.max(b), halved * number(value)?));
            }
            ("INDICATORS", [_, row, binary, value]) => {
                let condition = (self.known(binary)?, number(value)?);
                self.conditions.insert((*row).to_string(), condition);
            }
            ("SOS" | "SOS1" | "SOS2" | "SETS", fields) => self.set(section, fields)?,
            _ => {}
        }
        Ok(())
    }

    fn known(&self, name: &str) -> Result<u32, String> {
        self.model.find(name).ok_or_else(|| format!("there is no column {name}"))
    }

    /// Whether a set is the first one of a section.
    fn is_first(&mut self, section: &str, set: &str) -> bool {
        self.sets.entry(section.to_string()).or_insert_with(|| set.to_string()) == set
    }

    fn row(&mut self, kind: &str, name: &str) -> Result<(), String> {
        let kind = match kind.to_ascii_uppercase().as_str() {
            "N" => {
                self.objective.get_or_insert_with(|| name.to_string());
                self.rows.insert(name.to_string(), None);
                return Ok(());
            }
            "L" => 'L',
            "G" => 'G',
            "E" => 'E',
            other => return Err(format!("there is no kind of rows {other}")),
        };
        self.rows.insert(name.to_string(), Some(self.kinds.len()));
        self.kinds.push(kind);
        self.right_sides.push(None);
        self.ranges.push(None);
        let (lower, upper) = (f64::NEG_INFINITY, f64::INFINITY);
        self.model.rows.push(Row { name: name.to_string(), lower, upper, entries: Vec::new() });
        Ok(())
    }

    fn column(&mut self, name: &str, pairs: &[&str]) -> Result<(), String> {
        let is_new = self.model.find(name).is_none();
        let column = self.model.column(name);
        if is_new && self.is_integral {
            self.marked.push(column);
            if let Some(column) = self.model.column_mut(column) {
                column.is_integral = true;
            }
        }
        for (row, value) in pairs_of(pairs)? {
            match self.rows.get(row) {
                Some(Some(place)) => {
                    if let Some(row) = self.model.rows.get_mut(*place) {
                        row.entries.push((column, value));
                    }
                }
                Some(None) if self.objective.as_deref() == Some(row) => {
                    self.model.linear.push((column, value));
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn sides(&mut self, section: &str, pairs: &[&str]) -> Result<(), String> {
        for (pair, (row, value)) in pairs.chunks_exact(2).zip(pairs_of(pairs)?) {
            let word = pair.last().map(ToString::to_string);
            match self.rows.get(row) {
                // Of several, the first one counts.
                Some(&Some(place)) => {
                    let of =
                        if section == "RHS" { &mut self.right_sides } else { &mut self.ranges };
                    if let Some(own) = of.get_mut(place).filter(|own| own.is_none()) {
                        *own = word;
                    }
                }
                Some(None) if section == "RHS" && self.objective.as_deref() == Some(row) => {
                    self.model.constant = 0.0 - value;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// A line of ordered sets: the kind of one, or a member.
    fn set(&mut self, section: &str, fields: &[&str]) -> Result<(), String> {
        let kind = fields.first().map(|word| word.to_ascii_uppercase()).unwrap_or_default();
        let is_head = ["S1", "S2"].contains(&kind.as_str());
        if is_head && (fields.len() < 2 || self.model.find(fields[0]).is_none()) {
            self.end_set();
            self.set = Some((if kind == "S1" { 1 } else { 2 }, Vec::new()));
            return Ok(());
        }
        // The name of the set may stand before the member.
        let name = match fields {
            [name, _] | [_, name, _] => name,
            _ => return Ok(()),
        };
        let member = self.known(name)?;
        let of_section = if section.ends_with('1') { 1 } else { 2 };
        self.set.get_or_insert((of_section, Vec::new())).1.push(member);
        Ok(())
    }

    fn end_set(&mut self) {
        if let Some((most, members)) = self.set.take().filter(|set| !set.1.is_empty()) {
            self.model.set(members, most);
        }
    }

    fn bound(&mut self, fields: &[&str]) -> Result<(), String> {
        let [kind, fields @ ..] = fields else { return Ok(()) };
        let kind = kind.to_ascii_uppercase();
        let has_value = !matches!(kind.as_str(), "FR" | "MI" | "PL" | "BV");
        let (set, name, value) = match (has_value, fields) {
            (true, [set, name, value, ..]) => (*set, *name, number(value)?),
            (true, [name, value]) => ("", *name, number(value)?),
            (false, [name]) => ("", *name, 0.0),
            (false, [set, name, ..]) => (*set, *name, 0.0),
            _ => return Err("a bound has too few fields".to_string()),
        };
        if !self.is_first("BOUNDS", set) {
            return Ok(());
        }
        let Some(index) = self.model.find(name) else { return Ok(()) };
        let has_lower = self.has_lower.contains(&index);
        self.bounded.insert(index);
        let Some(column) = self.model.column_mut(index) else { return Ok(()) };
        match kind.as_str() {
            "LO" | "LI" => column.lower = value,
            "UP" | "UI" => {
                column.upper = value;
                if value < 0.0 && !has_lower {
                    column.lower = f64::NEG_INFINITY;
                }
            }
            "FX" => (column.lower, column.upper) = (value, value),
            "FR" => (column.lower, column.upper) = (f64::NEG_INFINITY, f64::INFINITY),
            "MI" => column.lower = f64::NEG_INFINITY,
            "PL" => column.upper = f64::INFINITY,
            "BV" => (column.lower, column.upper) = (0.0, 1.0),
            "SC" | "SI" => {
                column.upper = value;
                column.is_integral |= kind == "SI";
                self.model.leave_out(format!("semi-continuous column {name}"));
                self.model.statements.push(Statement::Semicontinuous(index));
                return Ok(());
            }
            _ => return Err(format!("there is no kind of bounds {kind}")),
        }
        column.is_integral |= matches!(kind.as_str(), "LI" | "UI" | "BV");
        if matches!(kind.as_str(), "LO" | "LI" | "FX" | "FR" | "MI") {
            self.has_lower.insert(index);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Model, String> {
        self.end_set();
        for index in self.marked.iter().filter(|index| !self.bounded.contains(index)) {
            if let Some(column) = self.model.column_mut(*index) {
                column.upper = 1.0;
            }
        }
        let sides = self.kinds.iter().zip(&self.right_sides).zip(&self.ranges);
        for (row, ((kind, side), range)) in self.model.rows.iter_mut().zip(sides) {
            let word = side.as_deref().unwrap_or("0");
            let side = number(word)?;
            // Sums of decimals are rounded once.
            let other = |sign: i32| match range {
                None => Ok(side),
                Some(range) if side.is_infinite() => Ok(number(range).map(|_| side)?),
                Some(range) => {
                    let size = f64::from(sign) * number(range)?.abs();
                    let sum = moved(word, sign, range).unwrap_or(side + size);
                    Ok::<f64, String>(or_infinite(sum))
                }
            };
            let is_below = match range {
                Some(range) => number(range)? < 0.0,
                None => false,
            };
            (row.lower, row.upper) = match (kind, range) {
                ('L', None) => (f64::NEG_INFINITY, side),
                ('G', None) => (side, f64::INFINITY),
                ('L', Some(_)) => (other(-1)?, side),
                ('G', Some(_)) => (side, other(1)?),
                _ if is_below => (other(-1)?, side),
                _ => (side, other(1)?),
            };
        }
        for row in std::mem::take(&mut self.model.rows) {
            let squares = self.squares.get(&row.name);
            match (self.conditions.get(&row.name), squares) {
                (None, None) => self.model.rows.push(row),
                (None, Some(products)) => self.model.squares(row, products),
                (Some(&(binary, value)), None) => {
                    self.model.indicator(Indicator { binary, value, row });
                }
                _ => self.model.leave_out(format!("indicator {}", row.name)),
            }
        }
        Ok(self.model)
    }
}

/// Names and values by turns.
fn pairs_of<'a>(fields: &[&'a str]) -> Result<Vec<(&'a str, f64)>, String> {
    let pairs = fields.chunks_exact(2).map(|pair| match pair {
        [name, value] => Ok((*name, number(value)?)),
        _ => Err("a name without a value".to_string()),
    });
    pairs.collect()
}

fn number(word: &str) -> Result<f64, String> {
    let value: f64 =
        word.replace(['D', 'd'], "e").parse().map_err(|_| format!("`{word}` is no number"))?;
    if value.is_nan() {
        return Err(format!("`{word}` is no number"));
    }
    Ok(or_infinite(value))
}

fn or_infinite(value: f64) -> f64 {
    if value.abs() >= INFINITE { value.signum() * f64::INFINITY } else { value }
}
