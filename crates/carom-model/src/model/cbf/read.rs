//! Reading: from lines to blocks and entries as the file lists them.

use super::cone_kind::ConeKind;
use crate::error::{Error, ErrorKind};
use crate::model::sense::Sense;
use crate::model::text::read::Warning;
use crate::model::text::token::{self, Token};

/// The contents of a file, from which [`build`](super::build) makes a model.
#[derive(Debug, Default)]
pub(super) struct CbfFile<'a> {
    pub(super) sense: Option<Sense>,
    pub(super) variables: Option<CbfBlocks<'a>>,
    pub(super) rows: Option<CbfBlocks<'a>>,
    pub(super) integers: Vec<Index<'a>>,
    pub(super) objective: Vec<(Index<'a>, f64)>,
    pub(super) constant: f64,
    /// Row, variable and value.
    pub(super) matrix: Vec<(Index<'a>, Index<'a>, f64)>,
    pub(super) offsets: Vec<(Index<'a>, f64)>,
    pub(super) warnings: Vec<Warning>,
}

/// VAR or CON: a number of entries in blocks.
#[derive(Debug)]
pub(super) struct CbfBlocks<'a> {
    pub(super) count: usize,
    pub(super) blocks: Vec<CbfBlock<'a>>,
    /// The count.
    pub(super) place: Token<'a>,
}

/// Consecutive entries in one cone.
#[derive(Debug, Clone, Copy)]
pub(super) struct CbfBlock<'a> {
    pub(super) kind: ConeKind,
    pub(super) size: usize,
    /// The name of the cone.
    pub(super) place: Token<'a>,
}

/// The index of a variable or row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Index<'a> {
    pub(super) index: usize,
    pub(super) place: Token<'a>,
}

/// The lines of a text that hold something.
struct Lines<'a> {
    lines: std::iter::Zip<std::str::Lines<'a>, std::ops::RangeFrom<usize>>,
    /// The end of the last line.
    end: (usize, usize),
    tokens: Vec<Token<'a>>,
}

/// A section and the number of its entries.
struct Section<'a> {
    name: Token<'a>,
    count: usize,
    /// The count.
    place: Token<'a>,
}

impl<'a> CbfFile<'a> {
    /// Goes through all lines.
    pub(super) fn scan(text: &'a str) -> Result<CbfFile<'a>, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut lines = Lines { lines: text.lines().zip(1..), end: (1, 1), tokens: Vec::new() };
        let mut file = CbfFile::default();
        let mut seen: Vec<Token<'a>> = Vec::new();
        let mut last: Option<Section<'a>> = None;
        while lines.next(&mut file.warnings) {
            let head = lines.tokens[0];
            if let Some(extra) = lines.tokens.get(1) {
                return Err(match last {
                    Some(section) if !is_section(head.text) => section.too_many(&head),
                    _ => extra.error(format!(
                        "nothing can follow `{}` in its line; its contents begin in the next one",
                        head.text
                    )),
                });
            }
            if seen.is_empty() && head.text != "VER" {
                return Err(head.error(format!(
                    "expected `VER`, with which a CBF file begins, found `{}`",
                    head.text
                )));
            }
            if let Some(first) = seen.iter().find(|name| name.text == head.text) {
                let (name, line) = (head.text, first.line());
                return Err(head.error(format!(
                    "a second section `{name}`; the first one is in line {line}, keep one of them"
                )));
            }
            if !is_section(head.text)
                && head.raw().is_ok()
                && let Some(section) = last
            {
                return Err(section.too_many(&head));
            }
            last = file.section(head, &mut lines)?;
            seen.push(head);
        }
        if seen.is_empty() {
            return Err(lines.cut_off("there is no section; a CBF file begins with `VER`"));
        }
        Ok(file)
    }

    /// Reads a section; returns it if it is a list.
    fn section(
        &mut self,
        name: Token<'a>,
        lines: &mut Lines<'a>,
    ) -> Result<Option<Section<'a>>, Error> {
        if self.value(name, lines)? {
            return Ok(None);
        }
        if matches!(name.text, "VAR" | "CON") {
            return self.blocks(name, lines).map(Some);
        }
        let warnings = &mut self.warnings;
        let entries = match name.text {
            "INT" | "OBJACOORD" | "ACOORD" | "BCOORD" => 1,
            other => match refused(other) {
                Some(_) => 0,
                None => {
                    return Err(name.error(format!(
                        "section `{other}` is not known; expected OBJSENSE, VAR, INT, CON, OBJACOORD, \
                         OBJBCOORD, ACOORD or BCOORD"
                    )));
                }
            },
        };
        if name.text == "CHANGE" {
            return Err(refusal(&name));
        }
        lines.expect_line(&name, "a number of entries", warnings)?;
        let place = lines.tokens[0];
        let section = Section { name, count: whole(&place)?, place };
        if entries == 0 {
            // A list without entries says nothing.
            return if section.count == 0 { Ok(Some(section)) } else { Err(refusal(&name)) };
        }
        if let Some(extra) = lines.tokens.get(1) {
            return Err(extra.error(format!(
                "expected a number of entries alone in the line below `{}`",
                name.text
            )));
        }
        for position in 1..=section.count {
            match name.text {
                "INT" => {
                    let [variable] = lines.entry(&section, position, "a variable", warnings)?;
                    self.integers.push(index(&variable)?);
                }
                "OBJACOORD" => {
                    let [variable, value] =
                        lines.entry(&section, position, "a variable and a value", warnings)?;
                    self.objective.push((index(&variable)?, value.finite()?));
                }
                "BCOORD" => {
                    let [row, value] =
                        lines.entry(&section, position, "a row and a value", warnings)?;
                    self.offsets.push((index(&row)?, value.finite()?));
                }
                _ => {
                    let [row, variable, value] = lines.entry(
                        &section,
                        position,
                        "a row, a variable and a value",
                        warnings,
                    )?;
                    self.matrix.push((index(&row)?, index(&variable)?, value.finite()?));
                }
            }
        }
        Ok(Some(section))
    }

    /// Reads a section with a single value, if it is one.
    fn value(&mut self, name: Token<'a>, lines: &mut Lines<'a>) -> Result<bool, Error> {
        let warnings = &mut self.warnings;
        match name.text {
            "VER" => {
                let [number] = lines.header(&name, "the number of the version", warnings)?;
                match whole(&number)? {
                    1..=3 => {}
                    0 => return Err(number.error("expected a version from 1 to 3, found 0")),
                    later => warnings.push(number.warning(format!(
                        "version {later} is read as far as it is that of version 3"
                    ))),
                }
            }
            "OBJSENSE" => {
                let [word] = lines.header(&name, "MIN or MAX", warnings)?;
                self.sense = Some(match word.text {
                    "MIN" => Sense::Minimize,
                    "MAX" => Sense::Maximize,
                    other => {
                        return Err(word.error(format!("expected MIN or MAX, found `{other}`")));
                    }
                });
            }
            "OBJBCOORD" => {
                let [value] = lines.header(&name, "the constant of the objective", warnings)?;
                self.constant = value.finite()?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn blocks(&mut self, name: Token<'a>, lines: &mut Lines<'a>) -> Result<Section<'a>, Error> {
        let what = "a number of entries and a number of cones";
        let [count, number] = lines.header(&name, what, &mut self.warnings)?;
        let section = Section { name, count: whole(&number)?, place: number };
        let mut blocks = Vec::new();
        for position in 1..=section.count {
            let [cone, size] =
                lines.entry(&section, position, "a cone and its size", &mut self.warnings)?;
            let block =
                CbfBlock { kind: ConeKind::named(&cone)?, size: whole(&size)?, place: cone };
            if let Some(least) = block.kind.heads().filter(|&least| block.size < least) {
                let (cone, found) = (cone.text, block.size);
                return Err(size.error(format!(
                    "a cone {cone} has at least {least} {}, found {found}",
                    if least == 1 { "entry" } else { "entries" }
                )));
            }
            blocks.push(block);
        }
        let blocks = CbfBlocks { count: whole(&count)?, blocks, place: count };
        let sum = blocks.blocks.iter().try_fold(0_usize, |sum, block| sum.checked_add(block.size));
        if sum != Some(blocks.count) {
            let sum = sum.map_or_else(|| "too many".into(), |sum| sum.to_string());
            return Err(count.error(format!(
                "{} has {} entries by its first number and {sum} by the sizes of its cones; correct \
                 one of them",
                name.text, blocks.count
            )));
        }
        match name.text {
            "VAR" => self.variables = Some(blocks),
            _ => self.rows = Some(blocks),
        }
        Ok(section)
    }
}

impl<'a> Lines<'a> {
    /// Goes to the next line that holds something.
    fn next(&mut self, warnings: &mut Vec<Warning>) -> bool {
        for (line, number) in &mut self.lines {
            self.end = (number, line.chars().count() + 1);
            token::split(line, number, &mut self.tokens);
            if self.tokens.first().is_none_or(|first| first.text.starts_with('#')) {
                continue;
            }
            if let Some(comment) = self.tokens.iter().position(|word| word.text.starts_with('#')) {
                let place = self.tokens[comment];
                warnings.push(place.warning("taken as a comment from here on"));
                self.tokens.truncate(comment);
            }
            return true;
        }
        false
    }

    /// Goes to the line below the name of a section.
    fn expect_line(
        &mut self,
        name: &Token<'a>,
        what: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<(), Error> {
        match self.next(warnings) {
            true => Ok(()),
            false => Err(self.cut_off(&format!(
                "the file ends before {what} below `{}`; it may have been cut off",
                name.text
            ))),
        }
    }

    /// The line below the name of a section.
    fn header<const N: usize>(
        &mut self,
        name: &Token<'a>,
        what: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<[Token<'a>; N], Error> {
        self.expect_line(name, what, warnings)?;
        self.words().map_err(|place| {
            place.error(format!("expected {what} below `{}`, alone in the line", name.text))
        })
    }

    /// The next entry of a list.
    fn entry<const N: usize>(
        &mut self,
        section: &Section<'a>,
        position: usize,
        what: &str,
        warnings: &mut Vec<Warning>,
    ) -> Result<[Token<'a>; N], Error> {
        let (name, count) = (section.name.text, section.count);
        if !self.next(warnings) {
            return Err(self.cut_off(&format!(
                "the file ends after {} of the {count} entries of {name}; it may have been cut off",
                position - 1
            )));
        }
        let first = self.tokens[0];
        if is_section(first.text) {
            let (line, found) = (section.place.line(), first.text);
            return Err(first.error(format!(
                "expected entry {position} of {count} of {name}, found `{found}`; correct the number \
                 of entries in line {line}, or add what is missing"
            )));
        }
        self.words().map_err(|place| place.error(format!("expected {what} as an entry of {name}")))
    }

    /// The words of the line, if there are `N`; otherwise the place where it goes wrong.
    fn words<const N: usize>(&self) -> Result<[Token<'a>; N], Token<'a>> {
        let words = <[Token<'a>; N]>::try_from(&self.tokens[..]);
        words.map_err(|_| *self.tokens.get(N).unwrap_or(&self.tokens[self.tokens.len() - 1]))
    }

    /// An error at the end of the file.
    fn cut_off(&self, message: &str) -> Error {
        let (line, column) = self.end;
        ErrorKind::Parse { line, column, message: message.into() }.into()
    }
}

impl Section<'_> {
    /// The error that a list goes on after its last entry.
    fn too_many(&self, found: &Token<'_>) -> Error {
        let (name, count, line) = (self.name.text, self.count, self.place.line());
        found.error(format!(
            "expected the name of a section after the {count} entries of {name}, found `{}`; correct \
             the number of entries in line {line}",
            found.text
        ))
    }
}

fn index<'a>(token: &Token<'a>) -> Result<Index<'a>, Error> {
    Ok(Index { index: whole(token)?, place: *token })
}

/// A number of things, or the index of one.
fn whole(token: &Token<'_>) -> Result<usize, Error> {
    let number = token.text.parse();
    number.map_err(|_| token.error(format!("expected a whole number, found `{}`", token.text)))
}

fn is_section(word: &str) -> bool {
    const KNOWN: [&str; 9] =
        ["VER", "OBJSENSE", "VAR", "INT", "CON", "OBJACOORD", "OBJBCOORD", "ACOORD", "BCOORD"];
    KNOWN.contains(&word) || refused(word).is_some()
}

/// The advice about a section that a model cannot hold; `None` for any other section.
fn refused(name: &str) -> Option<&'static str> {
    Some(match name {
        "PSDVAR" | "PSDCON" | "OBJFCOORD" | "FCOORD" | "HCOORD" | "DCOORD" => {
            "it is about semidefinite matrices, and a model has linear rows and second-order cones"
        }
        "POWCONES" | "POW*CONES" => {
            "it is about power cones, and a model has linear rows and second-order cones"
        }
        "CHANGE" => "a model is one program; keep the sections of one",
        _ => return None,
    })
}

fn refusal(name: &Token<'_>) -> Error {
    let help = refused(name.text).unwrap_or_default();
    name.error(format!("section `{}` cannot be read: {help}", name.text))
}
