//! The words about handles.

/// The text for a handle of something else.
pub(super) fn foreign(kind: &str, index: usize, place: &str, name: Option<&str>) -> String {
    match name {
        Some(name) => format!(
            "`{name}`, used in `{place}`, is a handle of a system and no variable of the model; take \
             handles of a system at a sample with `at`, such as `program.at({name}, 0)?`"
        ),
        None => format!(
            "{kind} number {index} used in `{place}` belongs to another model or system; use a handle \
             only with the one that created it (or a clone of it), and take handles of a system at a \
             sample with `at`"
        ),
    }
}
