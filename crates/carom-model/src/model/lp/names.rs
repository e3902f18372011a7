//! Names in LP files: most unchanged, the others percent-encoded.
//!
//! Names are written so that common readers accept them, and every written name decodes to the
//! original. Text that no name is encoded as is read unchanged, so names in foreign files are kept.

use super::lexer::OPERATORS;
use super::section::is_keyword;
use crate::model::name::Name;

/// Suffixes of the two rows that represent one row with two limits.
pub(super) const AT_LEAST: &str = "%ge";
pub(super) const AT_MOST: &str = "%le";

/// The column, fixed to 1, whose cost is the constant of the objective. All common readers take it
/// so; a plain number there is a column for some.
pub(super) const CONSTANT: &str = "Constant";

/// The text of a name in a file.
pub fn write(name: &Name) -> String {
    let text = coded(name, false);
    let ambiguous = text.ends_with(AT_LEAST) || text.ends_with(AT_MOST) || decoded(&text) != *name;
    if ambiguous { coded(name, true) } else { text }
}

/// The name of a text in a file.
pub fn read(text: &str) -> Name {
    let name = decoded(text);
    if write(&name) == text && name.check().is_ok() { name } else { Name::from(text) }
}

/// Encodes the characters that the format reserves; `all` also encodes those that codes consist of.
fn coded(name: &Name, all: bool) -> String {
    let family = name.family();
    let keyword = name.step().is_none() && (is_keyword(family) || family == CONSTANT);
    let mut text = String::with_capacity(family.len());
    for (place, letter) in family.chars().enumerate() {
        let first = place == 0
            && (keyword || letter.is_ascii_digit() || ['.', '(', ')', ','].contains(&letter));
        let inside = OPERATORS.contains(&letter) || ['[', ']', ' '].contains(&letter);
        if first && letter.is_ascii() || inside || all && ['%', '{'].contains(&letter) {
            text.push_str(&format!("%{:02X}", u32::from(letter)));
        } else {
            text.push(letter);
        }
    }
    if let Some(step) = name.step() {
        text.push_str(&format!("{{{step}}}"));
    }
    text
}

fn decoded(text: &str) -> Name {
    let step = text.strip_suffix('}').and_then(|text| {
        let (family, step) = text.rsplit_once('{')?;
        Some((family, step.parse().ok()?))
    });
    let (family, step) = step.map_or((text, None), |(family, step)| (family, Some(step)));
    let mut name = String::with_capacity(family.len());
    let mut rest = family;
    while let Some(place) = rest.find('%') {
        let code =
            rest.get(place + 1..place + 3).and_then(|code| u8::from_str_radix(code, 16).ok());
        let code = code.filter(u8::is_ascii);
        name.push_str(&rest[..place]);
        name.push(code.map_or('%', char::from));
        rest = &rest[place + if code.is_some() { 3 } else { 1 }..];
    }
    name.push_str(rest);
    match step {
        Some(step) => Name::from((name, step)),
        None => Name::from(name),
    }
}
