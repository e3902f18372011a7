//! The section `SOS`.

use super::lexer::TokenKind;
use super::read::LpFile;
use crate::error::Error;
use crate::model::text::sets::Set;

/// `S1::`
const TYPE: [TokenKind; 3] = [TokenKind::Word, TokenKind::Colon, TokenKind::Colon];

impl LpFile<'_> {
    /// Reads sets `name: S1:: x:1 y:2`; `kind` is that of sets that do not say it.
    pub(super) fn read_sets(&mut self, kind: Option<u8>) -> Result<(), Error> {
        while self.section().is_none() && self.kind() != TokenKind::End {
            let place = self.token();
            let label = if self.at_kinds(&TYPE) || self.at_member() { None } else { self.label() };
            let most = match kind {
                _ if self.at_kinds(&TYPE) => {
                    let word = self.step();
                    self.step();
                    self.step();
                    match word.text.to_ascii_lowercase().as_str() {
                        "s1" => 1,
                        "s2" => 2,
                        _ => {
                            let text = word.text;
                            let message = format!("expected `S1` or `S2`, found `{text}`");
                            return Err(word.error(message));
                        }
                    }
                }
                Some(most) => most,
                None => return Err(self.unexpected("`S1::` or `S2::`")),
            };
            let mut members = Vec::new();
            while self.at_member() {
                let column = self.known_column()?;
                self.step();
                let (weight, token) = self.value()?;
                token.finite()?;
                members.push((column, weight));
            }
            if members.is_empty() {
                return Err(self.unexpected("a member and its weight, such as `x:1`"));
            }
            let (is_named, place) = (label.is_some(), label.unwrap_or(place));
            self.sets.push(Set { place, is_named, most, members });
        }
        Ok(())
    }

    /// Whether a name, a colon and a number are next.
    fn at_member(&self) -> bool {
        let after = [TokenKind::Number, TokenKind::Plus, TokenKind::Minus];
        after.into_iter().any(|kind| self.at_kinds(&[TokenKind::Word, TokenKind::Colon, kind]))
    }
}
