//! The result of a case, and its line of text.

use std::fmt::Write as _;

/// The result of a case of a [`Sweep`](super::Sweep): named numbers and texts.
#[derive(Debug, Clone, PartialEq, Default)]
#[must_use]
pub struct SweepRecord {
    fields: Vec<(String, Field)>,
}

/// A value of a line.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Field {
    Nothing,
    Flag(bool),
    Number(f64),
    Text(String),
}

impl SweepRecord {
    /// An empty record.
    pub fn new() -> Self {
        SweepRecord::default()
    }

    /// Adds a number, or the word that there is none. A number of this name is replaced.
    pub fn with_number(self, name: &str, value: impl Into<Option<f64>>) -> Self {
        self.with(name, value.into().map_or(Field::Nothing, Field::Number))
    }

    /// Adds a text. One of this name is replaced.
    pub fn with_text(self, name: &str, text: &str) -> Self {
        self.with(name, Field::Text(text.to_owned()))
    }

    pub(super) fn with(mut self, name: &str, field: Field) -> Self {
        self.fields.retain(|(other, _)| other != name);
        self.fields.push((name.to_owned(), field));
        self
    }

    /// A number; `None` if there is none of this name.
    pub fn number(&self, name: &str) -> Option<f64> {
        match self.field(name)? {
            Field::Number(value) => Some(*value),
            // JSON has no numbers that are not finite.
            Field::Text(text) if ["inf", "-inf", "NaN"].contains(&&**text) => text.parse().ok(),
            _ => None,
        }
    }

    /// A text; `None` if there is none of this name.
    pub fn text(&self, name: &str) -> Option<&str> {
        match self.field(name)? {
            Field::Text(text) => Some(text),
            _ => None,
        }
    }

    fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|(other, _)| other == name).map(|(_, field)| field)
    }

    /// Takes a field out.
    pub(super) fn take(&mut self, name: &str) -> Option<Field> {
        let place = self.fields.iter().position(|(other, _)| other == name)?;
        Some(self.fields.remove(place).1)
    }

    /// Adds the fields of another record.
    pub(super) fn and(mut self, other: &SweepRecord) -> Self {
        self.fields.extend(other.fields.iter().cloned());
        self
    }

    /// The record as a line of JSON, without the end of the line.
    #[doc(hidden)]
    pub fn to_line(&self) -> String {
        let mut line = String::from("{");
        for (k, (name, field)) in self.fields.iter().enumerate() {
            line += if k == 0 { "" } else { "," };
            write_text(&mut line, name);
            line += ":";
            let _ = match field {
                Field::Nothing => write!(line, "null"),
                Field::Flag(value) => write!(line, "{value}"),
                Field::Number(value) if value.is_finite() => write!(line, "{value}"),
                Field::Number(value) => write!(line, "\"{value}\""),
                Field::Text(text) => {
                    write_text(&mut line, text);
                    Ok(())
                }
            };
        }
        line + "}"
    }

    /// The record of a line; `None` if the line is not a whole object of numbers and texts.
    #[doc(hidden)]
    pub fn from_line(line: &str) -> Option<Self> {
        let mut rest = line.trim().strip_prefix('{')?;
        let mut record = SweepRecord::default();
        loop {
            rest = rest.trim_start();
            if let Some(end) = rest.strip_prefix('}') {
                return end.trim().is_empty().then_some(record);
            }
            if !record.fields.is_empty() {
                rest = rest.strip_prefix(',')?.trim_start();
            }
            let (name, after) = read_text(rest)?;
            let (field, after) = read_field(after.trim_start().strip_prefix(':')?.trim_start())?;
            record.fields.push((name, field));
            rest = after;
        }
    }
}

fn write_text(line: &mut String, text: &str) {
    line.push('"');
    for letter in text.chars() {
        match letter {
            '"' | '\\' => line.extend(['\\', letter]),
            _ if letter.is_control() => {
                let _ = write!(line, "\\u{:04x}", letter as u32);
            }
            _ => line.push(letter),
        }
    }
    line.push('"');
}

fn read_field(text: &str) -> Option<(Field, &str)> {
    if text.starts_with('"') {
        let (text, rest) = read_text(text)?;
        return Some((Field::Text(text), rest));
    }
    let end = text.find([',', '}'])?;
    let (word, rest) = (text[..end].trim_end(), &text[end..]);
    let field = match word {
        "null" => Field::Nothing,
        "true" => Field::Flag(true),
        "false" => Field::Flag(false),
        _ if word.starts_with(|c: char| c == '-' || c.is_ascii_digit()) => {
            Field::Number(word.parse().ok().filter(|value: &f64| value.is_finite())?)
        }
        _ => return None,
    };
    Some((field, rest))
}

/// The text between quotes at the beginning, and what follows.
fn read_text(text: &str) -> Option<(String, &str)> {
    let inside = text.strip_prefix('"')?;
    let mut read = String::new();
    let mut letters = inside.char_indices();
    while let Some((place, letter)) = letters.next() {
        match letter {
            '"' => return Some((read, &inside[place + 1..])),
            '\\' => match letters.next()?.1 {
                'n' => read.push('\n'),
                't' => read.push('\t'),
                'r' => read.push('\r'),
                'b' => read.push('\u{8}'),
                'f' => read.push('\u{c}'),
                'u' => {
                    let mut code = read_code(&mut letters)?;
                    if (0xd800..0xdc00).contains(&code) {
                        let is_pair = letters.next()?.1 == '\\' && letters.next()?.1 == 'u';
                        let low = is_pair.then(|| read_code(&mut letters))??.checked_sub(0xdc00)?;
                        code = 0x1_0000 + ((code - 0xd800) << 10) + (low & 0x3ff);
                    }
                    read.push(char::from_u32(code)?);
                }
                other @ ('"' | '\\' | '/') => read.push(other),
                _ => return None,
            },
            _ => read.push(letter),
        }
    }
    None
}

fn read_code(letters: &mut std::str::CharIndices<'_>) -> Option<u32> {
    (0..4).try_fold(0, |code, _| Some(16 * code + letters.next()?.1.to_digit(16)?))
}
