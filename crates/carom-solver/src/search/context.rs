//! The context in which a worker processes nodes.

use std::collections::BTreeSet;

use super::clock::{Activity, ActivityClock};
use super::cone_method::ConeRecord;
use super::cone_pool::ConePool;
use super::focus_node::FocusNode;
use super::node_cut_pool::NodeCutPool;
use super::root::Root;
use super::settled_binaries::SettledBinaries;
use super::task::SolveTask;
use super::tree_view::TreeView;
use crate::presolve::Propagator;
use crate::program::Program;
use crate::relaxation::MethodCascade;
use crate::solver::{Options, PoolMode, StopToken};

/// The cost of starting a relaxation from its parent's state, in the budgets of heuristics, in
/// iterations.
const WARM_START_ITERATIONS: u64 = 8;

/// The node in hand, and what a worker propagates and relaxes it with.
pub(super) struct Context<'a> {
    pub(super) tree: TreeView<'a>,
    pub(super) node: FocusNode,
    pub(super) propagator: Propagator,
    pub(super) cascade: MethodCascade,
    pub(super) cone_pool: ConePool,
    pub(super) cone_record: ConeRecord,
    pub(super) node_cuts: NodeCutPool,
    /// The binaries that may settle at nodes; none where the search is for more than one optimum.
    pub(super) settled: SettledBinaries,
    pub(super) clock: ActivityClock,
    /// This worker's own clone, which counts its work.
    pub(super) token: StopToken,
    /// Interior-point iterations of this worker, those of its nested searches included.
    pub(super) iterations: u64,
    /// Fingerprints of the integers that heuristics have solved as leaves.
    pub(super) assignments: BTreeSet<u64>,
}

impl<'a> Context<'a> {
    pub(super) fn new(tree: TreeView<'a>) -> Self {
        let (root, task) = (tree.tree.root, &tree.tree.task);
        Context {
            node: FocusNode::root(&root.domain),
            propagator: root.propagator.clone(),
            cascade: task.cascades.take(),
            cone_pool: ConePool::new(task.program.row_count(), tree.id, tree.workers()),
            cone_record: ConeRecord::default(),
            settled: match task.may_settle {
                true => SettledBinaries::new(task.program),
                false => SettledBinaries::default(),
            },
            node_cuts: NodeCutPool::new(task.program, task.options),
            clock: ActivityClock::new(),
            token: task.token.clone(),
            iterations: 0,
            assignments: BTreeSet::new(),
            tree,
        }
    }

    /// Gives the methods for relaxations back to the pool.
    pub(super) fn retire(self) {
        self.task().cascades.give_back(self.cascade);
    }

    /// The task of the search.
    pub(super) fn task(&self) -> &'a SolveTask<'a> {
        &self.tree.tree.task
    }

    pub(super) fn root(&self) -> &'a Root {
        self.tree.tree.root
    }

    pub(super) fn program(&self) -> &'a Program {
        self.task().program
    }

    pub(super) fn options(&self) -> &'a Options {
        self.task().options
    }

    /// Whether the best points of the model are searched for, which integers of the model tell
    /// apart.
    pub(super) fn wants_all(&self) -> bool {
        self.options().pool > 1 && self.options().pool_mode == PoolMode::Best
    }

    /// Whether nothing new can come from the node: it fixes all integers that tell points apart,
    /// and the pool has a point with these integers that is as good as any of the node.
    ///
    /// # Arguments
    ///
    /// * `x`: a point of the node.
    pub(super) fn is_in_pool(&self, x: &[f64], bound: f64) -> bool {
        let judge = self.task().judge;
        let is_open = |j: &usize| !self.node.domain.is_fixed(*j) && judge.tells_apart(*j);
        if !self.wants_all() || self.program().integers.iter().any(is_open) {
            return false;
        }
        let value = self.tree.value_of(&judge.key(x));
        value.is_some_and(|value| bound >= self.tree.tree.cutoff_at(value))
    }

    /// Whether all integers are fixed.
    pub(super) fn is_leaf(&self) -> bool {
        self.program().integers.iter().all(|&j| self.node.domain.is_fixed(j))
    }

    pub(super) fn is_integral(&self, point: &[f64]) -> bool {
        let integrality = self.options().integrality;
        let whole = |j: &usize| (point[*j] - point[*j].round()).abs() <= integrality;
        self.program().integers.iter().all(whole)
    }

    /// Whether a limit is reached. Loops may ask often, because the clock is read only once in a
    /// while.
    pub(super) fn is_late(&self) -> bool {
        self.token.spend(100)
    }

    /// Books the time and iterations of the cascade since the last call.
    pub(super) fn book_relaxations(&mut self) {
        let spent = self.cascade.take_spent();
        self.clock.transfer(Activity::Relaxation, spent.time);
        // Steps from a parent's state are few, and the start is most of the work.
        let warm_starts = spent.counts.dual_simplex + spent.counts.active_set;
        self.iterations += spent.iterations + WARM_START_ITERATIONS * warm_starts;
        self.tree.count(|s| spent.count(s));
    }
}
