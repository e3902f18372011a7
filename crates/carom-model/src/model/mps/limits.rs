//! The sections RHS, RANGES and BOUNDS.

use super::bounds;
use super::read::MpsFile;
use super::section::MpsSection;
use crate::error::Error;
use crate::model::text::read::Warning;
use crate::model::text::token::Token;

impl<'a> MpsFile<'a> {
    pub(super) fn right_hand_side(
        &mut self,
        section: MpsSection,
        tokens: &[Token<'a>],
    ) -> Result<(), Error> {
        let entries = match tokens.len() % 2 {
            0 => tokens,
            _ => {
                let set = match section {
                    MpsSection::Ranges => &mut self.range_set,
                    _ => &mut self.right_set,
                };
                if !is_first_set(set, &tokens[0], &mut self.warnings) {
                    return Ok(());
                }
                &tokens[1..]
            }
        };
        if entries.is_empty() {
            return Err(tokens[0].error("expected pairs of row name and value"));
        }
        for entry in entries.chunks_exact(2) {
            let value = entry[1].number()?;
            let Some(row) = self.find_row_or_warn(&entry[0]) else { continue };
            let row = &mut self.rows[row];
            let (place, what) = match section {
                MpsSection::Ranges => (&mut row.range, "range"),
                _ => (&mut row.right, "right-hand side"),
            };
            if let Some(earlier) = *place {
                let (row, line) = (row.name.text, earlier.line());
                let message = format!("row `{row}` already has a {what}, given in line {line}");
                // Solvers disagree about different right-hand sides.
                if section == MpsSection::Rhs && earlier.number()? != value {
                    return Err(entry[0].error(message));
                }
                self.warnings.push(entry[0].warning(message + "; the first one counts"));
                continue;
            }
            *place = Some(entry[1]);
        }
        Ok(())
    }

    pub(super) fn bound(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        let (kind, rest) = (&tokens[0], &tokens[1..]);
        let with_value = bounds::has_value(kind)?;
        // The name of the bound set may be left out, and a value may follow kinds without one.
        let (set, column, value) = match rest {
            [set, column, value] => (Some(set), column, Some(value)),
            [column, value] if with_value => (None, column, Some(value)),
            [column, _] if self.is_bare(column, &rest[1]) => (None, column, None),
            [set, column] => (Some(set), column, None),
            [column] => (None, column, None),
            _ => {
                return Err(kind.error(
                    "expected a bound kind, an optional set name, a column name and a value",
                ));
            }
        };
        if let Some(value) = value.filter(|_| with_value) {
            value.number()?;
        }
        if let Some(set) = set
            && !is_first_set(&mut self.bound_set, set, &mut self.warnings)
        {
            return Ok(());
        }
        let Some(index) = self.column_names.find(column.text) else {
            let text = column.text;
            let message = format!("column `{text}` is not in COLUMNS; its bound is ignored");
            self.warnings.push(column.warning(message));
            return Ok(());
        };
        self.columns[index].bounds.take(kind, column, value, &mut self.warnings)
    }

    /// Whether the first of two words after a kind without a value is the column.
    fn is_bare(&mut self, first: &Token<'a>, second: &Token<'a>) -> bool {
        self.column_names.find(second.text).is_none()
            && self.column_names.find(first.text).is_some()
    }
}

/// Whether an entry is in the first set of right-hand sides, of ranges or of bounds; others are
/// ignored with a warning.
fn is_first_set<'a>(
    set: &mut Option<&'a str>,
    name: &Token<'a>,
    warnings: &mut Vec<Warning>,
) -> bool {
    let first = *set.get_or_insert(name.text);
    if first != name.text {
        let text = name.text;
        let message = format!("a second set `{text}` beside `{first}` is ignored");
        warnings.push(name.warning(message));
    }
    first == name.text
}
