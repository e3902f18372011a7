//! Reading: from lines to rows and columns as the file lists them.

use super::bounds::{self, Bounds};
use super::section::Section;
use crate::error::{Error, ErrorKind};
use crate::model::name::Name;
use crate::model::sense::Sense;
use crate::model::text::names::Names;
use crate::model::text::token::{self, Token};

/// The contents of a file, from which [`build`](super::build) makes a model.
#[derive(Debug, Default)]
pub(super) struct File<'a> {
    pub(super) name: &'a str,
    pub(super) sense: Option<Sense>,
    pub(super) rows: Vec<Row<'a>>,
    pub(super) columns: Vec<Column<'a>>,
    pub(super) objective: Option<usize>,
    pub(super) products: Vec<Product<'a>>,
    pub(super) mirrored: bool,
    /// The row that OBJNAME names.
    chosen: Option<Token<'a>>,
    row_names: Names<'a>,
    column_names: Names<'a>,
    right_set: Option<&'a str>,
    range_set: Option<&'a str>,
    bound_set: Option<&'a str>,
    /// The marker that opened a stretch of integer columns.
    integers: Option<Token<'a>>,
}

#[derive(Debug)]
pub(super) struct Row<'a> {
    pub(super) name: Token<'a>,
    pub(super) kind: RowKind,
    /// Columns by position, in increasing order.
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) right: Option<Token<'a>>,
    pub(super) range: Option<Token<'a>>,
    pub(super) condition: Option<Condition<'a>>,
    /// The last column with an entry here, to find duplicates.
    last_column: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RowKind {
    Objective,
    Ignored,
    AtMost,
    AtLeast,
    Equal,
}

#[derive(Debug)]
pub(super) struct Column<'a> {
    pub(super) name: Token<'a>,
    pub(super) integer: bool,
    pub(super) bounds: Bounds<'a>,
}

/// An entry of QUADOBJ or QMATRIX: two columns and a value.
#[derive(Debug)]
pub(super) struct Product<'a> {
    pub(super) first: usize,
    pub(super) second: usize,
    pub(super) value: f64,
    pub(super) place: Token<'a>,
}

/// The condition of a row: a column and its value.
#[derive(Debug, Clone, Copy)]
pub(super) struct Condition<'a> {
    pub(super) column: usize,
    pub(super) on: bool,
    pub(super) place: Token<'a>,
}

impl<'a> File<'a> {
    /// Goes through the lines up to ENDATA.
    pub(super) fn scan(text: &'a str) -> Result<File<'a>, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut file = File::default();
        let mut section = Section::Start;
        let mut tokens = Vec::new();
        let mut last = ("", 1);
        for (line, number) in text.lines().zip(1..) {
            last = (line, number);
            if line.starts_with('*') {
                continue;
            }
            token::split(line, number, &mut tokens);
            let Some(first) = tokens.first() else { continue };
            let word = section == Section::Objsense && direction(first).is_some();
            if line.starts_with(char::is_whitespace) || word {
                file.data(section, &tokens)?;
            } else if first.text.eq_ignore_ascii_case("ENDATA") {
                file.check_chosen()?;
                return Ok(file);
            } else {
                section = file.header(line, &tokens)?;
            }
        }
        Err(ErrorKind::Parse {
            line: last.1,
            column: last.0.chars().count() + 1,
            message: "the file ends without ENDATA; it may have been cut off".into(),
        }
        .into())
    }

    fn header(&mut self, line: &'a str, tokens: &[Token<'a>]) -> Result<Section, Error> {
        let (head, rest) = (&tokens[0], &tokens[1..]);
        let section = Section::named(head)?;
        match section {
            Section::Start => {
                self.name = line[head.text.len()..].trim();
                if self.name.chars().any(|c| c.is_control() && c != '\t') {
                    return Err(head.error("the model's name has a control character"));
                }
                return Ok(section);
            }
            Section::Objsense | Section::Objname if !rest.is_empty() => {
                self.data(section, rest)?;
                return Ok(section);
            }
            Section::Qsection if !rest.is_empty() => self.check_qsection(&rest[0])?,
            _ => {
                if let Some(extra) = rest.first() {
                    return Err(extra.error(format!(
                        "nothing can follow the section name `{}` (data lines begin with a space)",
                        head.text
                    )));
                }
            }
        }
        let mirrored = section == Section::Qmatrix;
        if mirrored || matches!(section, Section::Quadobj | Section::Qsection) {
            if !self.products.is_empty() && mirrored != self.mirrored {
                return Err(head.error("QUADOBJ and QMATRIX cannot both be given"));
            }
            self.mirrored = mirrored;
        }
        Ok(section)
    }

    fn data(&mut self, section: Section, tokens: &[Token<'a>]) -> Result<(), Error> {
        match section {
            Section::Start => Err(tokens[0].error("a data line before any section")),
            Section::Objsense => self.objsense(&tokens[0]),
            Section::Objname => {
                let [name] = expect(tokens, "the name of the objective row")?;
                self.chosen = Some(name);
                Ok(())
            }
            Section::Rows => self.row(tokens),
            Section::Columns => self.column(tokens),
            Section::Rhs | Section::Ranges => self.right_hand_side(section, tokens),
            Section::Bounds => self.bound(tokens),
            Section::Quadobj | Section::Qsection | Section::Qmatrix => self.product(tokens),
            Section::Indicators => self.indicator(tokens),
        }
    }

    fn objsense(&mut self, word: &Token<'a>) -> Result<(), Error> {
        let Some(sense) = direction(word) else {
            return Err(word.error(format!("expected MIN or MAX, found `{}`", word.text)));
        };
        if self.sense.is_some() {
            return Err(word.error("the direction of the objective is given twice"));
        }
        self.sense = Some(sense);
        Ok(())
    }

    fn row(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        let [kind, name] = expect(tokens, "a row kind (N, L, G or E) and a row name")?;
        let chosen = self.chosen.is_none_or(|chosen| chosen.text == name.text);
        let kind = match kind.text.to_ascii_uppercase().as_str() {
            "N" if self.objective.is_none() && chosen => RowKind::Objective,
            "N" => RowKind::Ignored,
            "L" => RowKind::AtMost,
            "G" => RowKind::AtLeast,
            "E" => RowKind::Equal,
            _ => {
                let kind_text = kind.text;
                let message = format!("row kind `{kind_text}` is not one of N, L, G and E");
                return Err(kind.error(message));
            }
        };
        check_name(&name)?;
        let index = self.row_names.declare(name.text).map_err(|first| {
            let (text, line) = (name.text, self.rows[first].name.line());
            name.error(format!("row `{text}` was already declared in line {line}"))
        })?;
        if kind == RowKind::Objective {
            self.objective = Some(index);
        }
        self.rows.push(Row {
            name,
            kind,
            terms: Vec::new(),
            right: None,
            range: None,
            condition: None,
            last_column: None,
        });
        Ok(())
    }

    fn column(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        if let [_, quoted, word, ..] = tokens
            && quoted.text.eq_ignore_ascii_case("'MARKER'")
            && word.text.starts_with('\'')
        {
            return self.marker(word);
        }
        let (name, entries) = (tokens[0], &tokens[1..]);
        if entries.is_empty() || entries.len() % 2 == 1 {
            return Err(tokens[tokens.len() - 1].error(
                "expected a column name and pairs of row name and value (names cannot contain \
                 spaces)",
            ));
        }
        let index = match self.columns.last() {
            Some(column) if column.name.text == name.text => self.columns.len() - 1,
            _ => self.new_column(name)?,
        };
        for entry in entries.chunks_exact(2) {
            let row = self.find_row(&entry[0])?;
            let value = entry[1].finite()?;
            let row = &mut self.rows[row];
            if row.last_column.replace(index) == Some(index) {
                let (column, row) = (name.text, row.name.text);
                return Err(
                    entry[0].error(format!("column `{column}` has a second entry in row `{row}`"))
                );
            }
            if value != 0.0 && row.kind != RowKind::Ignored {
                row.terms.push((index, value));
            }
        }
        Ok(())
    }

    fn new_column(&mut self, name: Token<'a>) -> Result<usize, Error> {
        check_name(&name)?;
        let index = self.column_names.declare(name.text).map_err(|first| {
            let (text, line) = (name.text, self.columns[first].name.line());
            name.error(format!(
                "column `{text}` already began in line {line}; its entries must stand together"
            ))
        })?;
        let integer = self.integers.is_some();
        self.columns.push(Column { name, integer, bounds: Bounds::default() });
        Ok(index)
    }

    fn marker(&mut self, word: &Token<'a>) -> Result<(), Error> {
        match (word.text.to_ascii_uppercase().as_str(), self.integers) {
            ("'INTORG'", None) => self.integers = Some(*word),
            ("'INTEND'", Some(_)) => self.integers = None,
            ("'INTORG'", Some(open)) => {
                let line = open.line();
                return Err(word.error(format!("'INTORG' of line {line} is still open")));
            }
            ("'INTEND'", None) => return Err(word.error("'INTEND' without 'INTORG'")),
            _ => {
                let message =
                    format!("marker {} is not known; expected 'INTORG' or 'INTEND'", word.text);
                return Err(word.error(message));
            }
        }
        Ok(())
    }

    fn right_hand_side(&mut self, section: Section, tokens: &[Token<'a>]) -> Result<(), Error> {
        let entries = match tokens.len() % 2 {
            0 => tokens,
            _ => {
                let set = match section {
                    Section::Ranges => &mut self.range_set,
                    _ => &mut self.right_set,
                };
                check_set(set, &tokens[0])?;
                &tokens[1..]
            }
        };
        if entries.is_empty() {
            return Err(tokens[0].error("expected pairs of row name and value"));
        }
        for entry in entries.chunks_exact(2) {
            let row = self.find_row(&entry[0])?;
            entry[1].number()?;
            let row = &mut self.rows[row];
            let (place, what) = match section {
                Section::Ranges => (&mut row.range, "range"),
                _ => (&mut row.right, "right-hand side"),
            };
            if let Some(earlier) = place.replace(entry[1]) {
                let (row, line) = (row.name.text, earlier.line());
                return Err(entry[0]
                    .error(format!("row `{row}` already has a {what}, given in line {line}")));
            }
        }
        Ok(())
    }

    fn bound(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        let (kind, rest) = (&tokens[0], &tokens[1..]);
        let with_value = bounds::has_value(kind)?;
        // The name of the bound set may be left out, and a value may follow kinds without one.
        let (set, column, value) = match rest {
            [set, column, value] => (Some(set), column, Some(value)),
            [column, value] if with_value => (None, column, Some(value)),
            [column, _] if self.is_bare(column, &rest[1]) => (None, column, None),
            [set, column] => (Some(set), column, None),
            [column] => (None, column, None),
            _ => {
                return Err(kind.error(
                    "expected a bound kind, an optional set name, a column name and a value",
                ));
            }
        };
        if let Some(set) = set {
            check_set(&mut self.bound_set, set)?;
        }
        let index = self.find_column(column)?;
        self.columns[index].bounds.take(kind, column, value)
    }

    /// Whether the first of two words after a kind without a value is the column.
    fn is_bare(&mut self, first: &Token<'a>, second: &Token<'a>) -> bool {
        self.column_names.find(second.text).is_none()
            && self.column_names.find(first.text).is_some()
    }

    fn product(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        let [first, second, value] = expect(tokens, "two column names and a value")?;
        let product = Product {
            first: self.find_column(&first)?,
            second: self.find_column(&second)?,
            value: value.raw()?,
            place: first,
        };
        // The objective is 1/2 x'Qx: a square's coefficient is half the entry.
        let half = if product.first == product.second { 0.5 } else { 1.0 };
        if token::or_infinite(half * product.value).is_infinite() {
            value.finite()?;
        }
        self.products.push(product);
        Ok(())
    }

    fn indicator(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        let [word, name, column, value] = expect(tokens, "IF, a row name, a column name, 0 or 1")?;
        if !word.text.eq_ignore_ascii_case("IF") {
            return Err(word.error(format!("expected IF, found `{}`", word.text)));
        }
        let row = self.find_row(&name)?;
        let on = match value.number()? {
            0.0 => false,
            1.0 => true,
            _ => return Err(value.error(format!("expected 0 or 1, found `{}`", value.text))),
        };
        let condition = Condition { column: self.find_column(&column)?, on, place: column };
        let row = &mut self.rows[row];
        if matches!(row.kind, RowKind::Objective | RowKind::Ignored) {
            return Err(name.error(format!(
                "row `{}` is an N row; only L, G and E rows can be switched",
                name.text
            )));
        }
        if let Some(earlier) = row.condition.replace(condition) {
            let line = earlier.place.line();
            return Err(name.error(format!(
                "row `{}` already has a condition, given in line {line}",
                name.text
            )));
        }
        Ok(())
    }

    /// OBJNAME must name an N row.
    fn check_chosen(&self) -> Result<(), Error> {
        match self.chosen {
            Some(chosen) if self.objective.is_none() => Err(chosen.error(format!(
                "OBJNAME says `{}`, but ROWS (after it) has no N row of that name",
                chosen.text
            ))),
            _ => Ok(()),
        }
    }

    /// QSECTION may name its row; only the objective can be quadratic.
    fn check_qsection(&mut self, name: &Token<'a>) -> Result<(), Error> {
        match self.find_row(name)? {
            row if self.objective == Some(row) => Ok(()),
            _ => Err(name.error(format!(
                "row `{}` is quadratic; only the objective can be, rows must be linear",
                name.text
            ))),
        }
    }

    fn find_row(&mut self, name: &Token<'a>) -> Result<usize, Error> {
        let found = self.row_names.find(name.text);
        found.ok_or_else(|| name.error(format!("row `{}` was not declared in ROWS", name.text)))
    }

    fn find_column(&mut self, name: &Token<'a>) -> Result<usize, Error> {
        let found = self.column_names.find(name.text);
        found.ok_or_else(|| name.error(format!("column `{}` is not in COLUMNS", name.text)))
    }
}

fn direction(word: &Token<'_>) -> Option<Sense> {
    match word.text.to_ascii_uppercase().as_str() {
        "MIN" | "MINIMIZE" | "MINIMISE" => Some(Sense::Minimize),
        "MAX" | "MAXIMIZE" | "MAXIMISE" => Some(Sense::Maximize),
        _ => None,
    }
}

/// A file may have only one set of right-hand sides, of ranges and of bounds.
fn check_set<'a>(set: &mut Option<&'a str>, name: &Token<'a>) -> Result<(), Error> {
    let first = *set.get_or_insert(name.text);
    if first == name.text {
        return Ok(());
    }
    let text = name.text;
    Err(name.error(format!("a second set `{text}` beside `{first}`; only one set can be read")))
}

/// The tokens of a line that must have exactly `N`.
fn expect<'a, const N: usize>(tokens: &[Token<'a>], what: &str) -> Result<[Token<'a>; N], Error> {
    <[Token<'a>; N]>::try_from(tokens).map_err(|_| {
        let place = tokens.get(N).unwrap_or(&tokens[tokens.len() - 1]);
        place.error(format!("expected {what}"))
    })
}

fn check_name(name: &Token<'_>) -> Result<(), Error> {
    Name::from(name.text).check().map_err(|error| name.error(error.to_string()))
}
