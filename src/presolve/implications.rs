//! A table of implications between binaries, which propagation follows.

use crate::solver::StopToken;

/// Implications between binaries; a literal `2 j + 1` is column `j` at 1, `2 j` is it at 0.
#[derive(Debug, Clone, Default)]
pub struct Implications {
    /// By literal: what it implies; empty when there is none at all.
    by_literal: Vec<Vec<usize>>,
    count: usize,
}

impl Implications {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// What a literal implies.
    pub fn of(&self, literal: usize) -> &[usize] {
        self.by_literal.get(literal).map_or(&[], Vec::as_slice)
    }

    /// The contrapositions that probing did not find by itself.
    pub(super) fn contraposed(noted: &[Option<Vec<usize>>], token: &StopToken) -> Implications {
        let mut table = Implications { by_literal: vec![Vec::new(); noted.len()], count: 0 };
        for (literal, implied) in noted.iter().enumerate() {
            if implied.is_some() && token.is_over() {
                break;
            }
            for &other in implied.iter().flatten() {
                // `literal` implies `other`, so "not other" implies "not literal".
                let (from, to) = (other ^ 1, literal ^ 1);
                if noted[from].as_ref().is_some_and(|known| known.binary_search(&to).is_err()) {
                    table.by_literal[from].push(to);
                    table.count += 1;
                }
            }
        }
        table
    }
}
