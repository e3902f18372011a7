//! A table of implications between binaries, which propagation follows.

use crate::solver::StopToken;

/// Implications between binaries; a literal `2 j + 1` is column `j` at 1, `2 j` is it at 0.
#[derive(Debug, Clone, Default)]
pub struct ImplicationGraph {
    /// By literal, where what it implies begins, and the end of all; empty when there is none at
    /// all.
    start: Vec<usize>,
    implied: Vec<usize>,
}

impl ImplicationGraph {
    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.implied.is_empty()
    }

    /// The literals that a literal implies.
    pub fn of(&self, literal: usize) -> &[usize] {
        match self.start.get(literal..=literal + 1) {
            Some(&[begin, end]) => &self.implied[begin..end],
            _ => &[],
        }
    }
}

/// The implications that probing has found, by literal.
pub(super) struct NotedImplications {
    /// By literal, the range of the literals that it implies; `None` if it was not probed.
    ranges: Vec<Option<[usize; 2]>>,
    implied: Vec<usize>,
}

impl NotedImplications {
    /// No implications yet, for so many literals.
    pub(super) fn new(literals: usize) -> Self {
        NotedImplications { ranges: vec![None; literals], implied: Vec::new() }
    }

    /// How many implications are noted.
    pub(super) fn count(&self) -> usize {
        self.implied.len()
    }

    /// Notes what a literal implies, sorted.
    pub(super) fn note(&mut self, literal: usize, implied: impl Iterator<Item = usize>) {
        let begin = self.implied.len();
        self.implied.extend(implied);
        self.ranges[literal] = Some([begin, self.implied.len()]);
    }

    fn of(&self, literal: usize) -> Option<&[usize]> {
        self.ranges[literal].map(|[begin, end]| &self.implied[begin..end])
    }

    /// The contrapositions that probing did not find by itself.
    pub(super) fn contrapositions(&self, token: &StopToken) -> ImplicationGraph {
        let mut pairs = Vec::new();
        for literal in 0..self.ranges.len() {
            let Some(implied) = self.of(literal) else { continue };
            if token.is_over() {
                break;
            }
            // `literal` implies `other`, so "not other" implies "not literal".
            let contraposed = implied.iter().map(|other| (other ^ 1, literal ^ 1));
            pairs.extend(contraposed.filter(|(from, to)| {
                self.of(*from).is_some_and(|known| known.binary_search(to).is_err())
            }));
        }
        let mut start = vec![0; self.ranges.len() + 1];
        pairs.iter().for_each(|(from, _)| start[from + 1] += 1);
        (0..self.ranges.len()).for_each(|k| start[k + 1] += start[k]);
        pairs.sort_by_key(|(from, _)| *from);
        ImplicationGraph { start, implied: pairs.into_iter().map(|(_, to)| to).collect() }
    }
}
