//! The bytes of a file, from which integers, numbers and names are taken: as text, or in one of the
//! two binary forms. Places are positions of bytes, which only messages turn into lines.

use std::str;

use crate::error::{Error, ErrorKind};
use crate::model::text::read::Warning;
use crate::model::text::token::or_infinite;

/// How the part behind the header is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    /// Integers and doubles as they lie in memory, from the smallest byte on.
    Little,
    /// The same, from the largest byte on.
    Big,
}

/// A position in a file.
#[derive(Debug, Clone)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(super) encoding: Encoding,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Cursor { bytes, at: 0, encoding: Encoding::Text }
    }

    /// The place of what comes next.
    pub(super) fn place(&mut self) -> usize {
        self.skip();
        self.at
    }

    /// Passes over white space and comments.
    fn skip(&mut self) {
        if self.encoding != Encoding::Text {
            return;
        }
        while let Some(&byte) = self.bytes.get(self.at) {
            match byte {
                b'#' => self.end_line(),
                _ if byte.is_ascii_whitespace() => self.at += 1,
                _ => return,
            }
        }
    }

    /// Passes over the rest of a line, which is returned.
    pub(super) fn rest_of_line(&mut self) -> &'a [u8] {
        let rest = &self.bytes[self.at..];
        let length = rest.iter().position(|&byte| byte == b'\n').unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    pub(super) fn end_line(&mut self) {
        self.rest_of_line();
        self.at = (self.at + 1).min(self.bytes.len());
    }

    /// The next letter or digit, or `None` at the end of the file.
    pub(super) fn letter(&mut self) -> Option<u8> {
        self.skip();
        let byte = self.bytes.get(self.at).copied();
        self.at += usize::from(byte.is_some());
        byte
    }

    /// The next `N` bytes.
    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], Error> {
        let part = self.bytes.get(self.at..self.at + N).and_then(|part| part.try_into().ok());
        let part = part.ok_or_else(|| self.ended(what))?;
        self.at += N;
        Ok(part)
    }

    fn word(&mut self, what: &str) -> Result<&'a str, Error> {
        let start = self.place();
        let is_end = |&byte: &u8| byte.is_ascii_whitespace() || byte == b'#';
        let rest = &self.bytes[start..];
        let length = rest.iter().position(is_end).unwrap_or(rest.len());
        if length == 0 {
            return Err(self.ended(what));
        }
        self.at += length;
        let text = str::from_utf8(&rest[..length]);
        text.map_err(|_| self.error(start, format!("expected {what}, found no text in UTF-8")))
    }

    /// An integer.
    pub(super) fn integer(&mut self, what: &str) -> Result<i64, Error> {
        match self.encoding {
            Encoding::Text => {
                let start = self.place();
                let word = self.word(what)?;
                word.parse()
                    .map_err(|_| self.error(start, format!("expected {what}, found `{word}`")))
            }
            Encoding::Little => Ok(i32::from_le_bytes(self.take(what)?).into()),
            Encoding::Big => Ok(i32::from_be_bytes(self.take(what)?).into()),
        }
    }

    /// An integer of two bytes in the binary forms.
    pub(super) fn short(&mut self, what: &str) -> Result<i64, Error> {
        match self.encoding {
            Encoding::Text => self.integer(what),
            Encoding::Little => Ok(i16::from_le_bytes(self.take(what)?).into()),
            Encoding::Big => Ok(i16::from_be_bytes(self.take(what)?).into()),
        }
    }

    /// A count or an index that is less than `end`.
    pub(super) fn below(&mut self, end: usize, what: &str) -> Result<usize, Error> {
        let start = self.place();
        let value = self.integer(what)?;
        let found = usize::try_from(value).ok().filter(|value| *value < end);
        found.ok_or_else(|| match end {
            0 => self.error(start, format!("expected {what}, found {value}, and there is none")),
            _ => self.error(start, format!("expected {what} from 0 to {}, found {value}", end - 1)),
        })
    }

    /// A number, possibly infinite.
    pub(super) fn number(&mut self, what: &str) -> Result<f64, Error> {
        let start = self.place();
        let value = match self.encoding {
            Encoding::Text => {
                let word = self.word(what)?;
                let value = word.parse::<f64>().ok();
                value.or_else(|| word.replace(['d', 'D'], "e").parse().ok()).unwrap_or(f64::NAN)
            }
            Encoding::Little => f64::from_le_bytes(self.take(what)?),
            Encoding::Big => f64::from_be_bytes(self.take(what)?),
        };
        match value.is_nan() {
            false => Ok(or_infinite(value)),
            true => Err(self.error(start, format!("{what} is not a number"))),
        }
    }

    /// A number that is not infinite.
    pub(super) fn finite(&mut self, what: &str) -> Result<f64, Error> {
        let start = self.place();
        let value = self.number(what)?;
        match value.is_finite() {
            true => Ok(value),
            false => Err(self.error(
                start,
                format!(
                    "{what} counts as infinite (1e20 and beyond do); a finite number is needed here"
                ),
            )),
        }
    }

    /// A name: a word of text, or a length and its bytes.
    pub(super) fn name(&mut self, what: &str) -> Result<String, Error> {
        if self.encoding == Encoding::Text {
            return Ok(self.word(what)?.to_owned());
        }
        let length = self.below(self.bytes.len() + 1, "the length of a name")?;
        let part = self.bytes.get(self.at..).and_then(|rest| rest.get(..length));
        let part = part.ok_or_else(|| self.ended(what))?;
        self.at += length;
        Ok(String::from_utf8_lossy(part).into_owned())
    }

    /// A number of things, of which each takes a byte at the least.
    pub(super) fn count(&mut self, what: &str) -> Result<usize, Error> {
        let start = self.place();
        match self.integer(what)? {
            count if count < 0 => Err(self.error(start, format!("{what} is {count}"))),
            count if count as usize > self.bytes.len() => {
                let text = format!("{what} is {count}, which is more than the file has bytes");
                Err(self.error(start, text))
            }
            count => Ok(count as usize),
        }
    }

    fn ended(&self, what: &str) -> Error {
        self.error(self.bytes.len(), format!("the file ends before {what}"))
    }

    /// The line and the column of a place. Behind the header of a binary file, all is one line.
    pub(super) fn line_and_column(&self, place: usize) -> (usize, usize) {
        let before = &self.bytes[..place.min(self.bytes.len())];
        let is_text = self.encoding == Encoding::Text;
        let mut ends = before.iter().enumerate().filter(|(_, byte)| **byte == b'\n');
        let (count, last) = match is_text {
            true => ends.fold((0, 0), |(count, _), (at, _)| (count + 1, at + 1)),
            false => ends.by_ref().take(10).fold((0, 0), |(count, _), (at, _)| (count + 1, at + 1)),
        };
        let column = match is_text {
            true => String::from_utf8_lossy(&before[last..]).chars().count(),
            false => before.len() - last,
        };
        (count + 1, column + 1)
    }

    pub(super) fn error(&self, place: usize, message: impl Into<String>) -> Error {
        let (line, column) = self.line_and_column(place);
        ErrorKind::Parse { line, column, message: message.into() }.into()
    }

    pub(super) fn warning(&self, place: usize, message: impl Into<String>) -> Warning {
        let (line, column) = self.line_and_column(place);
        Warning { line, column, message: message.into() }
    }
}
