//! Lines of a log, their words, and why a log is refused.

use std::fmt;
use std::io::{self, BufRead, Read};

/// Longest line in bytes.
const LONGEST_LINE: u64 = 1 << 28;

/// Why a log is no proof.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Failure {
    /// Whether the text can be read as a log, with a step in it that is not valid.
    pub is_readable: bool,
    /// The line, counted from 1.
    pub line: u64,
    /// Why, in words.
    pub reason: String,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.is_readable { "rejected" } else { "unreadable" };
        write!(f, "{kind} at line {}: {}", self.line, self.reason)
    }
}

impl std::error::Error for Failure {}

/// A failure whose line is known to the caller.
#[derive(Debug)]
pub(crate) struct Refusal {
    pub(crate) is_readable: bool,
    pub(crate) reason: String,
}

/// A step that is well-formed but not valid.
pub(crate) fn rejected<T>(reason: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal { is_readable: true, reason: reason.into() })
}

/// A text that does not follow the format.
pub(crate) fn unreadable<T>(reason: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal { is_readable: false, reason: reason.into() })
}

impl From<crate::exact::OutOfRange> for Refusal {
    fn from(_: crate::exact::OutOfRange) -> Self {
        let reason = "the numbers are too large or too fine for this checker".to_string();
        Refusal { is_readable: true, reason }
    }
}

/// The lines of a log that say something: neither blank ones nor comments.
pub(crate) struct Lines<R> {
    input: R,
    buffer: Vec<u8>,
    number: u64,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(input: R) -> Self {
        Lines { input, buffer: Vec::new(), number: 0 }
    }

    /// The words of the next line; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Words<'_>>, Refusal> {
        loop {
            self.buffer.clear();
            self.number += 1;
            let mut input = self.input.by_ref().take(LONGEST_LINE);
            match input.read_until(b'\n', &mut self.buffer) {
                Ok(0) => return Ok(None),
                Ok(_) if input.limit() == 0 => return unreadable("the line is too long"),
                Ok(_) => {}
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Err(error) => return unreadable(format!("the log cannot be read: {error}")),
            }
            let line = self.buffer.trim_ascii();
            if !line.is_empty() && !line.starts_with(b"#") {
                break;
            }
        }
        match std::str::from_utf8(&self.buffer) {
            Ok(line) => Ok(Some(Words { rest: line.trim_ascii() })),
            Err(_) => unreadable("the line is not UTF-8"),
        }
    }

    /// The next line, whose first word must be `keyword`.
    pub(crate) fn expect(&mut self, keyword: &str) -> Result<Words<'_>, Refusal> {
        self.expect_any(&[keyword]).map(|(words, _)| words)
    }

    /// The next line, whose first word must be one of these, and that word.
    pub(crate) fn expect_any<'k>(
        &mut self,
        keywords: &[&'k str],
    ) -> Result<(Words<'_>, &'k str), Refusal> {
        let keyword = || keywords.join("` or `");
        let Some(mut words) = self.next()? else {
            return unreadable(format!("the log ends where a line `{}` must be", keyword()));
        };
        let found = words.word("a keyword")?;
        match keywords.iter().find(|keyword| **keyword == found) {
            Some(keyword) => Ok((words, keyword)),
            None => {
                let found = shortened(found);
                unreadable(format!("there is `{found}` instead of `{}`", keyword()))
            }
        }
    }

    pub(crate) fn at_line(&self, refusal: Refusal) -> Failure {
        Failure { is_readable: refusal.is_readable, line: self.number, reason: refusal.reason }
    }
}

/// The words of a line that are not read yet.
#[derive(Debug)]
pub(crate) struct Words<'a> {
    rest: &'a str,
}

impl<'a> Words<'a> {
    /// Whether the next word is `word`.
    pub(crate) fn is_at(&self, word: &str) -> bool {
        self.rest.split_ascii_whitespace().next() == Some(word)
    }

    /// The next word, which is what `meaning` says.
    pub(crate) fn word(&mut self, meaning: &str) -> Result<&'a str, Refusal> {
        if self.rest.is_empty() {
            return unreadable(format!("the line ends where {meaning} must be"));
        }
        let end = self.rest.find(|letter: char| letter.is_ascii_whitespace());
        let (word, rest) = self.rest.split_at(end.unwrap_or(self.rest.len()));
        self.rest = rest.trim_ascii_start();
        Ok(word)
    }

    /// The rest of the line: a name, which may be empty.
    pub(crate) fn name(&mut self) -> String {
        std::mem::take(&mut self.rest).to_string()
    }

    /// The line must end here.
    pub(crate) fn end(&self) -> Result<(), Refusal> {
        if self.rest.is_empty() {
            return Ok(());
        }
        unreadable(format!("the line goes on with `{}` where it must end", shortened(self.rest)))
    }

    /// A number, or an infinity.
    pub(crate) fn limit(&mut self, meaning: &str) -> Result<f64, Refusal> {
        let word = self.word(meaning)?;
        match word {
            "inf" => return Ok(f64::INFINITY),
            "-inf" => return Ok(f64::NEG_INFINITY),
            _ => {}
        }
        let is_plain = word.bytes().all(|b| b.is_ascii_digit() || b"+-.eE".contains(&b));
        match word.parse::<f64>() {
            Ok(value) if is_plain && value.is_finite() => Ok(value),
            Ok(_) if is_plain => {
                unreadable(format!("{meaning}, `{}`, is too large", shortened(word)))
            }
            _ => unreadable(format!("{meaning}, `{}`, is no number", shortened(word))),
        }
    }

    /// A finite number.
    pub(crate) fn number(&mut self, meaning: &str) -> Result<f64, Refusal> {
        let value = self.limit(meaning)?;
        if value.is_finite() { Ok(value) } else { unreadable(format!("{meaning} is infinite")) }
    }

    /// A count, or a number of something that there are at most 2^32 of.
    pub(crate) fn count(&mut self, meaning: &str) -> Result<usize, Refusal> {
        let word = self.word(meaning)?;
        let is_plain = word.bytes().all(|b| b.is_ascii_digit());
        match word.parse::<u32>() {
            Ok(count) if is_plain => Ok(count as usize),
            _ => unreadable(format!("{meaning}, `{}`, is no whole number", shortened(word))),
        }
    }

    /// The index of one of `many` things.
    pub(crate) fn index(&mut self, what: &str, many: usize) -> Result<usize, Refusal> {
        let index = self.count(&format!("the {what}"))?;
        if index < many {
            return Ok(index);
        }
        rejected(format!("there is no {what} {index}; their number is {many}"))
    }

    /// A count of entries, and the entries: a column below `many` and a number each, no column
    /// twice.
    pub(crate) fn entries(&mut self, many: usize) -> Result<Vec<(u32, f64)>, Refusal> {
        let count = self.count("the number of entries")?;
        let mut entries = Vec::new();
        for _ in 0..count {
            let column = self.index("column", many)? as u32;
            entries.push((column, self.number("a value")?));
        }
        if !entries.is_sorted_by(|a, b| a.0 < b.0) {
            entries.sort_by_key(|entry| entry.0);
            let mut same = entries.chunk_by(|a, b| a.0 == b.0);
            if let Some([(column, _), ..]) = same.find(|same| same.len() > 1) {
                return unreadable(format!("column {column} is listed twice"));
            }
        }
        Ok(entries)
    }
}

/// The beginning of a text, for messages.
fn shortened(text: &str) -> String {
    text.chars().take(30).collect()
}
