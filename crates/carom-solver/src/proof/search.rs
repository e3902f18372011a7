//! A search inside a proof, for splits that close a context.

use super::bounds::Bounds;
use super::claim::Claim;
use super::guide::Guide;
use super::relaxed::Relaxer;
use super::tree::Limit;
use crate::search::{SolveTask, search};
use crate::solver::{Control, Heuristics};

impl Relaxer<'_> {
    /// Searches a context as it is, without what would make its relaxation tighter. Returns the
    /// splits; there are none if the search has closed the context by probing it, or has found
    /// nothing.
    ///
    /// # Arguments
    ///
    /// * `most`: its limit of nodes.
    pub(super) fn search(&mut self, bounds: &Bounds, most: u64) -> Result<Guide, Limit> {
        for j in 0..self.program.column_count() {
            [self.within.lower[j], self.within.upper[j]] = self.range(bounds, j);
        }
        let options = self.options.nested().with_proof("").with_node_limit(most);
        let options = options.with_cuts(false).with_heuristics(Heuristics::none());
        let accepts = |_: &[f64]| true;
        let mut task = SolveTask::new(&self.within, &accepts, self.cascades, &options, self.token);
        if let Claim::Bound(bound) = self.claim {
            task.cutoff = bound;
        }
        let found = search(task, &mut Control::default(), None);
        if self.token.is_over() {
            return Err(Limit);
        }
        Ok(Guide { is_plain: true, ..Guide::new(found.splits, None, usize::MAX, None) })
    }
}
