//! Reading: from segments, each of which begins with a letter, to the parts of a program.

use super::cursor::Cursor;
use super::expression::{self, Known};
use super::header::NlHeader;
use super::operators::not_taken;
use super::polynomial::Polynomial;
use crate::error::Error;
use crate::interval::Interval;
use crate::model::sense::Sense;
use crate::model::text::read::Warning;

/// The contents of a file, from which [`build`](super::build) makes a model. Indices count from 0.
#[derive(Debug)]
pub(super) struct NlFile {
    pub(super) header: NlHeader,
    pub(super) rows: Vec<NlRow>,
    /// The first objective.
    pub(super) objective: NlRow,
    pub(super) sense: Sense,
    pub(super) bounds: Vec<Interval>,
    pub(super) sets: Vec<NlMember>,
    pub(super) start: Vec<(usize, f64)>,
    pub(super) warnings: Vec<Warning>,
}

/// A row or an objective: its linear part and the rest.
#[derive(Debug, Default)]
pub(super) struct NlRow {
    linear: Option<Vec<(usize, f64)>>,
    rest: Option<Polynomial>,
    pub(super) limits: Option<Interval>,
}

impl NlRow {
    pub(super) fn into_polynomial(self) -> Polynomial {
        let linear = self.linear.unwrap_or_default();
        let linear = Polynomial { linear, ..Polynomial::default() };
        linear.plus(self.rest.unwrap_or_default()).merged()
    }
}

/// Suffixes of a column: its set, and its weight in there.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct NlMember {
    pub(super) set: i64,
    pub(super) weight: Option<f64>,
    pub(super) place: usize,
}

/// The state of a scan.
struct Segments<'a> {
    cursor: Cursor<'a>,
    known: Known,
    objectives: Vec<NlRow>,
    senses: Vec<Sense>,
    has_bounds: bool,
    file: NlFile,
}

impl NlFile {
    /// Goes through all segments.
    pub(super) fn scan(bytes: &[u8]) -> Result<(NlFile, Cursor<'_>), Error> {
        let mut cursor = Cursor::new(bytes);
        let header = NlHeader::read(&mut cursor)?;
        let sizes = [
            (header.columns, "variables"),
            (header.rows, "constraints"),
            (header.objectives, "objectives"),
            (header.functions, "functions"),
            (header.definitions, "common expressions"),
        ];
        // Each of them has a line, or a byte at the least.
        if let Some((count, what)) = sizes.into_iter().find(|(count, _)| *count > bytes.len()) {
            return Err(cursor.error(
                0,
                format!("{count} {what} are more than the file has bytes; correct the header"),
            ));
        }
        let known = Known {
            columns: header.columns,
            functions: vec![None; header.functions],
            definitions: vec![None; header.definitions],
        };
        let many = |count: usize| (0..count).map(|_| NlRow::default()).collect();
        let mut segments = Segments {
            cursor,
            known,
            objectives: many(header.objectives),
            senses: vec![Sense::Minimize; header.objectives],
            has_bounds: false,
            file: NlFile {
                rows: many(header.rows),
                objective: NlRow::default(),
                sense: Sense::Minimize,
                bounds: Vec::new(),
                sets: vec![NlMember::default(); header.columns],
                start: Vec::new(),
                warnings: Vec::new(),
                header,
            },
        };
        while segments.segment()? {}
        segments.finished()
    }
}

impl<'a> Segments<'a> {
    /// Reads a segment; false at the end of the file.
    fn segment(&mut self) -> Result<bool, Error> {
        let place = self.cursor.place();
        let Some(letter) = self.cursor.letter() else { return Ok(false) };
        let rows = self.file.rows.len();
        match letter {
            b'C' => {
                let row = self.cursor.below(rows, "a constraint")?;
                self.rest(place, row, false)?;
            }
            b'O' => {
                let at = self.cursor.below(self.objectives.len(), "an objective")?;
                let sense = self.cursor.below(2, "0 to minimise or 1 to maximise")?;
                self.senses[at] = [Sense::Minimize, Sense::Maximize][sense];
                self.rest(place, at, true)?;
            }
            b'J' => {
                let row = self.cursor.below(rows, "a constraint")?;
                self.linear(place, row, false)?;
            }
            b'G' => {
                let at = self.cursor.below(self.objectives.len(), "an objective")?;
                self.linear(place, at, true)?;
            }
            b'V' => self.definition(place)?,
            b'b' => self.bounds(place)?,
            b'r' => self.limits()?,
            b'k' | b'K' => {
                let count = self.cursor.count("the number of columns")?;
                for _ in 0..count {
                    self.cursor.integer("a number of entries")?;
                }
            }
            b'x' => self.start()?,
            b'd' => {
                let count = self.cursor.count("the number of multipliers")?;
                for _ in 0..count {
                    self.cursor.below(rows, "a constraint")?;
                    self.cursor.number("a multiplier")?;
                }
            }
            b'S' => self.suffix()?,
            b'F' => self.function()?,
            b'L' => {
                let help = "logical constraints are not read: state it with binaries and linear rows, or in a \
                            `Model`";
                return Err(not_taken(&self.cursor, place, "a logical constraint", help));
            }
            other => {
                let other = char::from(other).escape_default();
                return Err(self.cursor.error(
                    place,
                    format!(
                        "expected a segment, which begins with one of the letters F, S, V, C, L, O, d, x, r, b, \
                         k, J and G, found `{other}`"
                    ),
                ));
            }
        }
        Ok(true)
    }

    fn row(&mut self, at: usize, is_objective: bool) -> &mut NlRow {
        if is_objective { &mut self.objectives[at] } else { &mut self.file.rows[at] }
    }

    /// The part of a row or an objective that is an expression.
    fn rest(&mut self, place: usize, at: usize, is_objective: bool) -> Result<(), Error> {
        // Behind the numbers of this line there may be a comment.
        let rest = expression::read(&mut self.cursor, &self.known)?;
        match self.row(at, is_objective).rest.replace(rest) {
            None => Ok(()),
            Some(_) => Err(self.cursor.error(place, "this segment is given twice; keep one")),
        }
    }

    /// Columns and coefficients, as many as the file says.
    fn terms(&mut self, count: usize) -> Result<Vec<(usize, f64)>, Error> {
        let columns = self.known.columns;
        let term = |_| {
            let column = self.cursor.below(columns, "a variable")?;
            Ok((column, self.cursor.finite("a coefficient")?))
        };
        (0..count).map(term).collect()
    }

    fn linear(&mut self, place: usize, at: usize, is_objective: bool) -> Result<(), Error> {
        let count = self.cursor.count("the number of coefficients")?;
        let terms = self.terms(count)?;
        match self.row(at, is_objective).linear.replace(terms) {
            None => Ok(()),
            Some(_) => Err(self.cursor.error(place, "this segment is given twice; keep one")),
        }
    }

    fn definition(&mut self, place: usize) -> Result<(), Error> {
        let (columns, count) = (self.known.columns, self.known.definitions.len());
        let index = self.cursor.below(columns + count, "a defined variable")?;
        let Some(at) = index.checked_sub(columns) else {
            return Err(self.cursor.error(place, format!("`V{index}` is no defined variable")));
        };
        let terms = self.cursor.count("the number of coefficients")?;
        self.cursor.integer("where the defined variable is used")?;
        let linear = Polynomial { linear: self.terms(terms)?, ..Polynomial::default() };
        let rest = expression::read(&mut self.cursor, &self.known)?;
        match self.known.definitions[at].replace(linear.plus(rest).merged()) {
            None => Ok(()),
            Some(_) => Err(self.cursor.error(place, "this segment is given twice; keep one")),
        }
    }

    fn bounds(&mut self, place: usize) -> Result<(), Error> {
        if self.has_bounds {
            return Err(self.cursor.error(place, "this segment is given twice; keep one"));
        }
        self.has_bounds = true;
        for _ in 0..self.known.columns {
            let bounds = self.interval("the bounds of a variable")?;
            self.file.bounds.push(bounds);
        }
        Ok(())
    }

    fn limits(&mut self) -> Result<(), Error> {
        for row in 0..self.file.rows.len() {
            self.file.rows[row].limits = Some(self.interval("the limits of a constraint")?);
        }
        Ok(())
    }

    /// A line of `r` or `b`.
    fn interval(&mut self, what: &str) -> Result<Interval, Error> {
        let place = self.cursor.place();
        let (lower, upper) = match self.cursor.letter() {
            Some(b'0') => (self.cursor.number("a limit")?, self.cursor.number("a limit")?),
            Some(b'1') => (f64::NEG_INFINITY, self.cursor.number("a limit")?),
            Some(b'2') => (self.cursor.number("a limit")?, f64::INFINITY),
            Some(b'3') => (f64::NEG_INFINITY, f64::INFINITY),
            Some(b'4') => {
                let value = self.cursor.finite("a limit")?;
                (value, value)
            }
            Some(b'5') => {
                let help =
                    "complementarity is not read: state it as a disjunction of rows, with a binary";
                return Err(not_taken(&self.cursor, place, "complements", help));
            }
            _ => {
                let text = format!("expected {what}: a digit from 0 to 4 and numbers");
                return Err(self.cursor.error(place, text));
            }
        };
        match lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY {
            true => Ok(Interval { lower, upper }),
            false => Err(self.cursor.error(place, format!("{what} are crossed"))),
        }
    }

    fn start(&mut self) -> Result<(), Error> {
        let count = self.cursor.count("the number of start values")?;
        for _ in 0..count {
            let column = self.cursor.below(self.known.columns, "a variable")?;
            let value = self.cursor.number("a start value")?;
            if value.is_finite() {
                self.file.start.push((column, value));
            }
        }
        Ok(())
    }

    /// Values of a suffix, of which `sosno` and `ref` of variables are ordered sets.
    fn suffix(&mut self) -> Result<(), Error> {
        let kind = self.cursor.integer("the kind of a suffix")?;
        let count = self.cursor.count("the number of values")?;
        let name = self.cursor.name("the name of a suffix")?;
        let of = match kind & 3 {
            0 => self.known.columns,
            1 => self.file.rows.len(),
            2 => self.objectives.len(),
            _ => 1,
        };
        for _ in 0..count {
            let index = self.cursor.below(of, "an index")?;
            let place = self.cursor.place();
            let value = match kind & 4 {
                0 => self.cursor.integer("a value")? as f64,
                _ => self.cursor.number("a value")?,
            };
            if kind & 3 != 0 {
                continue;
            }
            match name.as_str() {
                "sosno" if value.fract() != 0.0 || value.abs() > 1e15 => {
                    return Err(self.cursor.error(place, "the number of a set is not whole"));
                }
                "sosno" => {
                    let member = &mut self.file.sets[index];
                    (member.set, member.place) = (value as i64, place);
                }
                "ref" => self.file.sets[index].weight = Some(value),
                _ => {}
            }
        }
        Ok(())
    }

    fn function(&mut self) -> Result<(), Error> {
        let at = self.cursor.below(self.known.functions.len(), "a function")?;
        self.cursor.integer("the kind of a function")?;
        self.cursor.integer("the number of arguments")?;
        self.known.functions[at] = Some(self.cursor.name("the name of a function")?);
        Ok(())
    }

    /// The file that was read, and the place behind it; an error if a segment is missing.
    fn finished(mut self) -> Result<(NlFile, Cursor<'a>), Error> {
        let end = self.cursor.place();
        if self.known.columns > 0 && !self.has_bounds {
            return Err(self.cursor.error(end, "the file ends before the bounds (segment `b`)"));
        }
        if self.file.rows.iter().any(|row| row.limits.is_none()) {
            return Err(self.cursor.error(end, "the file ends before the limits (segment `r`)"));
        }
        for (rows, letter, said) in [
            (&self.file.rows, 'J', self.file.header.nonzeros[0]),
            (&self.objectives, 'G', self.file.header.nonzeros[1]),
        ] {
            let found: usize = rows.iter().filter_map(|row| Some(row.linear.as_ref()?.len())).sum();
            if found < said {
                let text = format!(
                    "the header counts {said} terms in segments `{letter}`, and there are {found}; the file may \
                     have been cut off"
                );
                return Err(self.cursor.error(end, text));
            }
        }
        let count = self.objectives.len();
        if count > 1 {
            let text = format!("there are {count} objectives; the first one counts");
            self.file.warnings.push(self.cursor.warning(0, text));
        }
        if let Some(first) = self.objectives.into_iter().next() {
            (self.file.objective, self.file.sense) = (first, self.senses[0]);
        }
        Ok((self.file, self.cursor))
    }
}
