//! Tokens of a line with their positions in the file, and the numbers in them.

use super::read::Warning;
use crate::error::{Error, ErrorKind};
use crate::tolerance;

/// Variables or rows that a file may have without mentioning them, whatever its length.
pub(crate) const UNMENTIONED: usize = 100_000;

/// A token of a line, between white space.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Token<'a> {
    pub(crate) text: &'a str,
    line_text: &'a str,
    line: usize,
    /// Position of the first byte in the line.
    start: usize,
}

impl<'a> Token<'a> {
    /// The token of a line (counted from 1) that starts at a byte and has a length.
    pub(crate) fn new(line_text: &'a str, line: usize, start: usize, length: usize) -> Self {
        Token { text: &line_text[start..start + length], line_text, line, start }
    }

    /// Whether another token of the line begins where this one ends.
    pub(crate) fn joins(&self, next: &Token<'_>) -> bool {
        self.line == next.line && self.start + self.text.len() == next.start
    }

    /// The text from this token to the end of a later one in the same line.
    pub(crate) fn through(&self, last: &Token<'a>) -> Token<'a> {
        let length = last.start + last.text.len() - self.start;
        Token::new(self.line_text, self.line, self.start, length)
    }

    /// The bytes of the token from `start` on, `length` of them.
    pub(crate) fn part(&self, start: usize, length: usize) -> Token<'a> {
        Token::new(self.line_text, self.line, self.start + start, length)
    }

    pub(crate) fn error(&self, message: impl Into<String>) -> Error {
        self.parse_error(message).into()
    }

    /// A warning about this token. Its column counts bytes until [`in_characters`] has counted all
    /// of a file.
    pub(crate) fn warning(&self, message: impl Into<String>) -> Warning {
        Warning { line: self.line, column: self.start + 1, message: message.into() }
    }

    fn parse_error(&self, message: impl Into<String>) -> ErrorKind {
        ErrorKind::Parse { line: self.line, column: self.column(), message: message.into() }
    }

    fn column(&self) -> usize {
        self.line_text[..self.start].chars().count() + 1
    }

    /// The line of the token, from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// A number, possibly infinite, with an exponent marked by `E` or `D`.
    pub(crate) fn raw(&self) -> Result<f64, Error> {
        let fortran = |_| self.text.replace(['d', 'D'], "e").parse();
        let not_a_number = || self.parse_error(format!("`{}` is not a number", self.text));
        match self.text.parse::<f64>().or_else(fortran) {
            Ok(value) if value.is_nan() => Err(not_a_number().into()),
            Ok(value) => Ok(value),
            Err(source) => Err(Error::with_source(not_a_number(), source)),
        }
    }

    /// A number, with 1e20 and beyond (also `Infinity`, `1e30`) as infinity.
    pub(crate) fn number(&self) -> Result<f64, Error> {
        self.raw().map(or_infinite)
    }

    /// A number that is not infinite.
    pub(crate) fn finite(&self) -> Result<f64, Error> {
        let value = self.number()?;
        if value.is_infinite() {
            let text = self.text;
            return Err(self.error(format!(
                "`{text}` counts as infinite (1e20 and beyond do); a finite number is needed here"
            )));
        }
        Ok(value)
    }
}

/// Counts the columns of the warnings about a text in characters, reading each line once.
pub(crate) fn in_characters(text: &str, warnings: &mut [Warning]) {
    let mut places: Vec<&mut Warning> = warnings.iter_mut().collect();
    places.sort_by_key(|warning| (warning.line, warning.column));
    let (mut lines, mut skipped) = (text.lines(), 0);
    let (mut line, mut bytes, mut characters) = ("", 0, 0);
    for warning in places {
        if warning.line > skipped {
            line = lines.nth(warning.line - skipped - 1).unwrap_or_default();
            (skipped, bytes, characters) = (warning.line, 0, 0);
        }
        let end = (warning.column - 1).min(line.len());
        characters += line[bytes..end].chars().count();
        bytes = end;
        warning.column = characters + 1;
    }
}

/// Replaces magnitudes from 1e20 on by infinity.
pub(crate) fn or_infinite(value: f64) -> f64 {
    if value.abs() < tolerance::INFINITE { value } else { f64::INFINITY.copysign(value) }
}

/// Splits a line (counted from 1) at white space.
pub(crate) fn split<'a>(line_text: &'a str, line: usize, tokens: &mut Vec<Token<'a>>) {
    tokens.clear();
    let mut rest = line_text;
    loop {
        rest = rest.trim_start();
        let start = line_text.len() - rest.len();
        let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
        if end == 0 {
            return;
        }
        tokens.push(Token { text: &rest[..end], line_text, line, start });
        rest = &rest[end..];
    }
}
