//! Names in MPS files: as they are, but for blanks, which free MPS has no place for.

use crate::model::name::Name;

/// The text of a name in a file: a blank is `%20`, and a percent sign that could begin such a code
/// is `%25`.
pub(super) fn write(name: &Name) -> String {
    let text = name.to_string();
    match text.contains(' ') || text.contains("%2") {
        true => text.replace("%2", "%252").replace(' ', "%20"),
        false => text,
    }
}

/// The name of a text in a file.
pub(super) fn read(text: &str) -> Name {
    if text.contains("%2") {
        let name = Name::from(text.replace("%20", " ").replace("%252", "%2"));
        if write(&name) == text && name.check().is_ok() {
            return name;
        }
    }
    Name::from(text)
}
