//! Special ordered sets: the section SOS, and markers in COLUMNS.

use super::read::MpsFile;
use crate::error::Error;
use crate::model::text::sets::Set;
use crate::model::text::token::Token;

impl<'a> MpsFile<'a> {
    /// A line of SOS: `S1 name` begins a set, `column weight` adds a member. A word for the section
    /// may stand before the name and before the column, and a priority after the name.
    pub(super) fn set(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        if let (Some(most), false) = (kind(&tokens[0]), self.is_member(tokens)) {
            let name = match tokens {
                [_, name] => name,
                [_, name, last] if last.raw().is_ok() => name,
                [_, _, name] | [_, _, name, _] => {
                    let text = name.text;
                    self.warnings.push(name.warning(format!(
                        "read as the name `{text}` of a set; some solvers know only `S1 {text}`, and \
                         drop the set"
                    )));
                    name
                }
                _ => return Err(tokens[0].error("expected `S1` or `S2` and the name of a set")),
            };
            self.sets.push(Set { place: *name, is_named: true, most, members: Vec::new() });
            return Ok(());
        }
        let (column, weight) = match tokens {
            [column] => (column, None),
            [column, weight] | [_, column, weight] => (column, Some(weight.finite()?)),
            _ => return Err(tokens[0].error("expected a column and its weight")),
        };
        let column = self.find_column(column)?;
        let Some(set) = self.sets.last_mut() else {
            return Err(tokens[0].error("expected `S1` or `S2` and the name of a set"));
        };
        let weight = weight.unwrap_or_else(|| {
            let text = "no weight; the weights are 1, 2, ... in the order of the file";
            self.warnings.push(tokens[0].warning(text));
            set.members.len() as f64 + 1.0
        });
        set.members.push((column, weight));
        Ok(())
    }

    /// Whether a line that begins with `S1` or `S2` is about a column of that name.
    fn is_member(&mut self, tokens: &[Token<'a>]) -> bool {
        let [column, weight] = tokens else { return false };
        !self.sets.is_empty() && weight.raw().is_ok() && self.is_column(column)
    }

    /// `S1 name 'MARKER' 'SOSORG'` in COLUMNS: the columns up to 'SOSEND' are a set.
    pub(super) fn set_marker(&mut self, tokens: &[Token<'a>]) -> Result<(), Error> {
        let (first, word) = (&tokens[0], &tokens[tokens.len() - 1]);
        if word.text.eq_ignore_ascii_case("'SOSEND'") {
            let open = self.open_set.take();
            return open.map(|_| ()).ok_or_else(|| word.error("'SOSEND' without 'SOSORG'"));
        }
        let (Some(most), [_, name, _, _]) = (kind(first), tokens) else {
            return Err(first.error("expected `S1` or `S2` and a name before 'MARKER'"));
        };
        if self.open_set.is_some() {
            return Err(word.error("the 'SOSORG' before is still open"));
        }
        self.open_set = Some(self.sets.len());
        self.sets.push(Set { place: *name, is_named: true, most, members: Vec::new() });
        Ok(())
    }

    /// Adds a new column to the set of the marker before it.
    pub(super) fn join_open_set(&mut self, column: usize) {
        if let Some(open) = self.open_set {
            let members = &mut self.sets[open].members;
            members.push((column, members.len() as f64 + 1.0));
        }
    }
}

pub(super) fn kind(word: &Token<'_>) -> Option<u8> {
    match word.text {
        "S1" | "s1" => Some(1),
        "S2" | "s2" => Some(2),
        _ => None,
    }
}
