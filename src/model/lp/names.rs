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

/// The text of a name in a file.
pub(super) fn write(name: &Name) -> String {
    let text = coded(name, false);
    let ambiguous = text.ends_with(AT_LEAST) || text.ends_with(AT_MOST) || decoded(&text) != *name;
    if ambiguous { coded(name, true) } else { text }
}

/// The name of a text in a file.
pub(super) fn read(text: &str) -> Name {
    let name = decoded(text);
    if write(&name) == text { name } else { Name::from(text) }
}

/// Encodes the characters that the format reserves; `all` also encodes those that codes consist of.
fn coded(name: &Name, all: bool) -> String {
    let family = name.family();
    let keyword = name.step().is_none() && is_keyword(family);
    let mut text = String::with_capacity(family.len());
    for (place, letter) in family.chars().enumerate() {
        let first = place == 0
            && (keyword || letter.is_ascii_digit() || ['.', '(', ')', ','].contains(&letter));
        let inside = OPERATORS.contains(&letter) || ['[', ']'].contains(&letter);
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

/// Decodes a name.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Names, and how they are written.
    const CASES: [(&str, &str); 16] = [
        ("x", "x"),
        ("x[17]", "x{17}"),
        ("x[1][2]", "x%5B1%5D{2}"),
        ("x[01]", "x%5B01%5D"),
        ("a-b", "a%2Db"),
        ("1st", "%31st"),
        ("Free", "%46ree"),
        ("free[0]", "free{0}"),
        ("x{3}", "x%7B3}"),
        ("50%", "%350%"),
        ("a%41", "a%2541"),
        ("r%ge", "r%25ge"),
        ("höhe", "höhe"),
        ("e1", "e1"),
        ("[3]", "%5B3%5D"),
        ("{3}", "%7B3}"),
    ];

    #[test]
    fn names_lead_back() {
        for (name, text) in CASES {
            assert_eq!(write(&Name::from(name)), text);
            assert_eq!(read(text), Name::from(name));
        }
    }

    #[test]
    fn foreign_names_are_kept() {
        for text in ["x(3)", "x[3]", "a%41", "r%ge", "100%", "x{03}", "a%2db", "%", "%€"] {
            assert_eq!(read(text), Name::from(text));
        }
    }
}
