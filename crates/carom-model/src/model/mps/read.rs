//! Reading: from lines to rows and columns as the file lists them.

use std::collections::HashSet;

use super::bounds::MpsBounds;
use super::products::MpsMatrix;
use super::section::MpsSection;
use super::sets;
use crate::error::{Error, ErrorKind};
use crate::model::name::Name;
use crate::model::sense::Sense;
use crate::model::text::names::NameIndex;
use crate::model::text::read::Warning;
use crate::model::text::row_condition::RowCondition;
use crate::model::text::sets::Set;
use crate::model::text::token::{self, Token};

/// The contents of a file, from which [`build`](super::build) makes a model.
#[derive(Debug, Default)]
pub(super) struct MpsFile<'a> {
    pub(super) name: &'a str,
    pub(super) sense: Option<Sense>,
    pub(super) rows: Vec<MpsRow<'a>>,
    pub(super) columns: Vec<MpsColumn<'a>>,
    /// The column whose entries are being read.
    at_column: Option<usize>,
    /// Columns and rows of all entries, once a column has gone on in a second place.
    entries: Option<HashSet<(usize, usize)>>,
    pub(super) objective: Option<usize>,
    /// The products of the objective.
    pub(super) matrix: Option<MpsMatrix<'a>>,
    /// The row whose products are being read; `None` for those of the objective.
    pub(super) matrix_row: Option<usize>,
    pub(super) sets: Vec<Set<'a>>,
    pub(super) warnings: Vec<Warning>,
    /// The set of a marker 'SOSORG' that is still open.
    pub(super) open_set: Option<usize>,
    /// The row that OBJNAME names.
    chosen: Option<Token<'a>>,
    pub(super) row_names: NameIndex<'a>,
    pub(super) column_names: NameIndex<'a>,
    pub(super) right_set: Option<&'a str>,
    pub(super) range_set: Option<&'a str>,
    pub(super) bound_set: Option<&'a str>,
    /// The marker that opened a stretch of integer columns.
    integers: Option<Token<'a>>,
}

#[derive(Debug)]
pub(super) struct MpsRow<'a> {
    pub(super) name: Token<'a>,
    pub(super) kind: MpsRowKind,
    /// Columns by position, in increasing order.
    pub(super) terms: Vec<(usize, f64)>,
    pub(super) right: Option<Token<'a>>,
    pub(super) range: Option<Token<'a>>,
    pub(super) condition: Option<RowCondition<'a>>,
    pub(super) matrix: Option<MpsMatrix<'a>>,
    /// The last column with an entry here, to find duplicates.
    last_column: Option<usize>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum MpsRowKind {
    Objective,
    Ignored,
    AtMost,
    AtLeast,
    Equal,
}

#[derive(Debug)]
pub(super) struct MpsColumn<'a> {
    pub(super) name: Token<'a>,
    pub(super) integer: bool,
    pub(super) bounds: MpsBounds<'a>,
}

impl<'a> MpsFile<'a> {
    /// Goes through the lines up to ENDATA.
    pub(super) fn scan(text: &'a str) -> Result<MpsFile<'a>, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut file = MpsFile::default();
        let mut section = MpsSection::Start;
        let mut tokens = Vec::new();
        let mut last = ("", 1);
        for (line, number) in text.lines().zip(1..) {
            last = (line, number);
            if line.starts_with('*') {
                continue;
            }
            token::split(line, number, &mut tokens);
            let Some(first) = tokens.first() else { continue };
            let word = section == MpsSection::Objsense && direction(first).is_some();
            if line.starts_with(char::is_whitespace) || word {
                file.data(section, &tokens)?;
            } else if first.text.eq_ignore_ascii_case("ENDATA") {
                file.check_chosen()?;
                if file.entries.is_some() {
                    file.rows.iter_mut().for_each(|row| row.terms.sort_by_key(|term| term.0));
                }
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

    fn header(&mut self, line: &'a str, tokens: &[Token<'a>]) -> Result<MpsSection, Error> {
        let (head, rest) = (&tokens[0], &tokens[1..]);
        let section = MpsSection::named(head)?;
        match section {
            MpsSection::Start => {
                self.name = line[head.text.len()..].trim();
                if self.name.chars().any(|c| c.is_control() && c != '\t') {
                    return Err(head.error("the model's name has a control character"));
                }
                return Ok(section);
            }
            MpsSection::Objsense | MpsSection::Objname if !rest.is_empty() => {
                self.data(section, rest)?;
                return Ok(section);
            }
            MpsSection::Quadobj
            | MpsSection::Qmatrix
            | MpsSection::Qsection
            | MpsSection::Qcmatrix => {
                let named = matches!(section, MpsSection::Qsection | MpsSection::Qcmatrix);
                nothing_after(head, rest.get(usize::from(named)))?;
                self.begin_matrix(section, *head, rest.first())?;
            }
            _ => nothing_after(head, rest.first())?,
        }
        Ok(section)
    }

    fn data(&mut self, section: MpsSection, tokens: &[Token<'a>]) -> Result<(), Error> {
        let tokens = &tokens[..self.end_of_data(section, tokens)];
        match section {
            MpsSection::Start => Err(tokens[0].error("a data line before any section")),
            MpsSection::Objsense => self.objsense(&tokens[0]),
            MpsSection::Objname => {
                let [name] = expect(tokens, "the name of the objective row")?;
                self.chosen = Some(name);
                Ok(())
            }
            MpsSection::Rows => self.row(tokens),
            MpsSection::Columns => self.column(tokens),
            MpsSection::Rhs | MpsSection::Ranges => self.right_hand_side(section, tokens),
            MpsSection::Bounds => self.bound(tokens),
            MpsSection::Quadobj
            | MpsSection::Qmatrix
            | MpsSection::Qsection
            | MpsSection::Qcmatrix => self.product(expect(tokens, "two column names and a value")?),
            MpsSection::Indicators => self.indicator(tokens),
            MpsSection::Sets => self.set(tokens),
        }
    }

    /// Where a comment after the data of a line begins: at a word that begins with `$` or `*` and
    /// is no row or column.
    fn end_of_data(&mut self, section: MpsSection, tokens: &[Token<'a>]) -> usize {
        // The name of a set may look like a comment.
        let header = section == MpsSection::Sets && sets::kind(&tokens[0]).is_some();
        let first = if header { 3 } else { 2 };
        for (k, token) in tokens.iter().enumerate().skip(first) {
            let comment = token.text.starts_with(['$', '*']);
            if comment && self.row_names.find(token.text).is_none() && !self.is_column(token) {
                self.warnings.push(token.warning("taken as a comment from here on"));
                return k;
            }
        }
        tokens.len()
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
            "N" if self.objective.is_none() && chosen => MpsRowKind::Objective,
            "N" => {
                self.further_objective(&name);
                MpsRowKind::Ignored
            }
            "L" => MpsRowKind::AtMost,
            "G" => MpsRowKind::AtLeast,
            "E" => MpsRowKind::Equal,
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
        if kind == MpsRowKind::Objective {
            self.objective = Some(index);
        }
        self.rows.push(MpsRow {
            name,
            kind,
            terms: Vec::new(),
            right: None,
            range: None,
            condition: None,
            matrix: None,
            last_column: None,
        });
        Ok(())
    }

    /// Warns of an `N` row after the objective, unless OBJNAME has chosen between them.
    fn further_objective(&mut self, name: &Token<'a>) {
        if let (Some(objective), None) = (self.objective, self.chosen) {
            let (text, first) = (name.text, self.rows[objective].name.text);
            self.warnings.push(name.warning(format!(
                "row `{text}` is a further `N` row; it is ignored, because `{first}` is the objective"
            )));
        }
    }

    fn column(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        if let [.., marker, word] = tokens
            && marker.text.eq_ignore_ascii_case("'MARKER'")
            && ["'SOSORG'", "'SOSEND'"].iter().any(|known| word.text.eq_ignore_ascii_case(known))
        {
            return self.set_marker(tokens);
        }
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
        let index = match self.at_column {
            Some(at) if self.columns[at].name.text == name.text => at,
            _ => match self.column_names.find(name.text) {
                Some(known) => self.return_to(known, &name),
                None => self.new_column(name)?,
            },
        };
        self.at_column = Some(index);
        for entry in entries.chunks_exact(2) {
            let value = entry[1].finite()?;
            let Some(place) = self.find_row_or_warn(&entry[0]) else { continue };
            let row = &mut self.rows[place];
            let is_second = match &mut self.entries {
                Some(entries) => !entries.insert((index, place)),
                None => false,
            };
            if row.last_column.replace(index) == Some(index) || is_second {
                let (column, text) = (name.text, row.name.text);
                let message = format!("column `{column}` has a second entry in row `{text}`");
                match row.kind {
                    // Solvers disagree.
                    MpsRowKind::Objective => return Err(entry[0].error(message)),
                    _ => self.warnings.push(entry[0].warning(message + "; the first one counts")),
                }
                continue;
            }
            if value != 0.0 && row.kind != MpsRowKind::Ignored {
                row.terms.push((index, value));
            }
        }
        Ok(())
    }

    /// Goes on with a column whose entries stand in two places.
    fn return_to(&mut self, column: usize, name: &Token<'a>) -> usize {
        let (text, line) = (name.text, self.columns[column].name.line());
        self.warnings.push(name.warning(format!(
            "column `{text}` began in line {line} and goes on here; its entries are taken together"
        )));
        if self.entries.is_none() {
            let rows = self.rows.iter().enumerate();
            let entries = rows.flat_map(|(k, row)| row.terms.iter().map(move |&(j, _)| (j, k)));
            self.entries = Some(entries.collect());
        }
        column
    }

    fn new_column(&mut self, name: Token<'a>) -> Result<usize, Error> {
        check_name(&name)?;
        let index = self.column_names.declare(name.text).unwrap_or_else(|known| known);
        let integer = self.integers.is_some();
        self.columns.push(MpsColumn { name, integer, bounds: MpsBounds::default() });
        self.join_open_set(index);
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
        let condition = RowCondition { column: self.find_column(&column)?, on, place: column };
        let row = &mut self.rows[row];
        if matches!(row.kind, MpsRowKind::Objective | MpsRowKind::Ignored) {
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

    pub(super) fn find_row(&mut self, name: &Token<'a>) -> Result<usize, Error> {
        let found = self.row_names.find(name.text);
        found.ok_or_else(|| name.error(format!("row `{}` was not declared in ROWS", name.text)))
    }

    /// The position of a row, or a warning that the entry is ignored.
    pub(super) fn find_row_or_warn(&mut self, name: &Token<'a>) -> Option<usize> {
        let found = self.row_names.find(name.text);
        if found.is_none() {
            let text = name.text;
            let message = format!("row `{text}` was not declared in ROWS; the entry is ignored");
            self.warnings.push(name.warning(message));
        }
        found
    }

    pub(super) fn is_column(&mut self, name: &Token<'a>) -> bool {
        self.column_names.find(name.text).is_some()
    }

    pub(super) fn find_column(&mut self, name: &Token<'a>) -> Result<usize, Error> {
        let found = self.column_names.find(name.text);
        found.ok_or_else(|| name.error(format!("column `{}` is not in COLUMNS", name.text)))
    }
}

/// Refuses a word behind the name of a section.
fn nothing_after(head: &Token<'_>, extra: Option<&Token<'_>>) -> Result<(), Error> {
    match extra {
        Some(extra) => Err(extra.error(format!(
            "nothing can follow the section name `{}` (data lines begin with a space)",
            head.text
        ))),
        None => Ok(()),
    }
}

fn direction(word: &Token<'_>) -> Option<Sense> {
    match word.text.to_ascii_uppercase().as_str() {
        "MIN" | "MINIMIZE" | "MINIMISE" => Some(Sense::Minimize),
        "MAX" | "MAXIMIZE" | "MAXIMISE" => Some(Sense::Maximize),
        _ => None,
    }
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
