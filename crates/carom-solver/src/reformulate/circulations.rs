//! Bounds of flows in networks, whose rows alone leave them unbounded because flow may circulate.
//!
//! Takes the balances of the nodes of networks; leaves upper bounds of flows that have none.
//!
//! If less flow never harms (it costs no more, and no statement but the balances of the nodes
//! limits a flow from below), every point has another one that is at least as good, with the same
//! values of all other variables, in which no flow runs in a circle. Its flows are sums of paths
//! from sources to sinks (Ford and Fulkerson, Flows in Networks, Princeton University Press, 1962),
//! so none is larger than all that enters and leaves the network. The bounds hold for that point,
//! not for all. They are taken only for continuous variables, so that none of the values of
//! integers is lost.

use super::direction::Harm;
use super::implied_bounds::{MAX_IMPLIED_BOUND, loosened};
use super::linear_program::Maximizer;
use crate::interval::{Interval, add_up};
use crate::model::{ConstraintRef, Model, Variable, VariableKind};
use crate::tolerance;
use crate::union_find::UnionFind;

/// A node of a network: a row that needs its flows, as `sum of flows in - sum of flows out`.
struct NetworkNode {
    /// The largest amounts that enter and leave here, in the flows' unit; infinite without a limit.
    enters: f64,
    leaves: f64,
}

/// The nodes that a flow comes from and goes to; `None` is outside.
#[derive(Clone, Copy, Default)]
struct NetworkArc {
    from: Option<usize>,
    to: Option<usize>,
}

/// Upper bounds of flows that have none.
pub(super) fn flows(model: &Model, known: &Maximizer<'_>) -> Vec<(Variable, f64)> {
    let candidates = candidates(model, known);
    if !candidates.contains(&true) {
        return Vec::new();
    }
    let is_flow = |v: Variable| candidates[v.index()];
    // Balances: rows in which less of some flow may harm.
    let harms = |a: f64, limits: Interval| match a > 0.0 {
        true => limits.lower.is_finite(),
        false => limits.upper.is_finite(),
    };
    let is_balance = |row: &ConstraintRef<'_>| {
        row.terms().iter().any(|&(v, a)| is_flow(v) && harms(a, row.limits()))
    };
    let balances: Vec<ConstraintRef<'_>> = model.constraints().filter(is_balance).collect();
    let (arcs, is_arc) = arcs(&balances, &candidates);
    let nodes: Vec<NetworkNode> =
        balances.iter().map(|row| node(model, row, &is_arc, known)).collect();
    let mut networks = UnionFind::new(nodes.len());
    let variables: Vec<Variable> =
        model.variables().map(|v| v.id()).filter(|v| is_arc[v.index()]).collect();
    for &v in &variables {
        if let NetworkArc { from: Some(from), to: Some(to) } = arcs[v.index()] {
            networks.join(from, to);
        }
    }
    // Networks with flows from or to outside.
    let mut is_open = vec![false; nodes.len()];
    for &v in &variables {
        if let NetworkArc { from: Some(node), to: None }
        | NetworkArc { from: None, to: Some(node) } = arcs[v.index()]
        {
            is_open[networks.root(node)] = true;
        }
    }
    let (mut enters, mut leaves) = (vec![0.0; nodes.len()], vec![0.0; nodes.len()]);
    for (k, node) in nodes.iter().enumerate() {
        let network = networks.root(k);
        enters[network] = add_up(enters[network], node.enters);
        leaves[network] = add_up(leaves[network], node.leaves);
    }
    let mut found = Vec::new();
    for v in variables {
        let lower = known.bounds(v).lower;
        let NetworkArc { from, to } = arcs[v.index()];
        // A variable without a balance is no flow.
        let Some(node) = from.or(to) else { continue };
        let network = networks.root(node);
        // Paths may begin or end outside, but not both.
        let total = match is_open[network] {
            true => add_up(enters[network], leaves[network]),
            false => enters[network].min(leaves[network]),
        };
        let most = add_up(lower, total * (1.0 + tolerance::PROPAGATION_SLACK));
        let most = most + tolerance::FEASIBILITY;
        if most <= MAX_IMPLIED_BOUND {
            found.push((v, most));
        }
    }
    found
}

/// The variables that may be flows: continuous, bounded from below but not from above, and such
/// that only rows force them to be large.
fn candidates(model: &Model, known: &Maximizer<'_>) -> Vec<bool> {
    let mut harm = Harm::without_rows(model);
    for function in model.functions() {
        harm.any(function.result());
        function.function().factor().into_iter().for_each(|v| harm.any(v));
        let expressions = function.function().expressions();
        expressions.iter().flat_map(|e| e.terms()).for_each(|(v, _)| harm.any(v));
    }
    let candidate = model.variables().map(|variable| {
        let bounds = known.bounds(variable.id());
        variable.kind() == VariableKind::Continuous
            && variable.semicontinuous().is_none()
            && !harm.lowering[variable.id().index()]
            && variable.bounds().lower.abs() < MAX_IMPLIED_BOUND
            && bounds.upper.is_infinite()
    });
    candidate.collect()
}

/// The ends of all candidates, and which of them are flows: in at most two balances, with opposite
/// signs and coefficients as large as those of all others.
fn arcs(balances: &[ConstraintRef<'_>], candidates: &[bool]) -> (Vec<NetworkArc>, Vec<bool>) {
    let mut arcs = vec![NetworkArc::default(); candidates.len()];
    let mut is_arc = candidates.to_vec();
    for (k, row) in balances.iter().enumerate() {
        for &(v, a) in row.terms().iter().filter(|(v, _)| candidates[v.index()]) {
            let arc = &mut arcs[v.index()];
            let end = if a > 0.0 { &mut arc.to } else { &mut arc.from };
            is_arc[v.index()] &= a.abs() == 1.0 && end.replace(k).is_none();
        }
    }
    (arcs, is_arc)
}

/// The amounts that may enter and leave at a balance: its limits less all terms that are no flows.
fn node(
    model: &Model,
    row: &ConstraintRef<'_>,
    is_arc: &[bool],
    known: &Maximizer<'_>,
) -> NetworkNode {
    let [lower, upper] = loosened(model, row.terms(), row.limits());
    let mut net = Interval::new(lower, upper);
    for &(v, a) in row.terms() {
        let bounds = known.bounds(v);
        let other = match is_arc[v.index()] {
            true => Interval::point(bounds.lower),
            false => bounds,
        };
        net = net + other * -a;
    }
    let positive = |end: f64| if end.is_nan() { f64::INFINITY } else { end.max(0.0) };
    NetworkNode { enters: positive(-net.lower), leaves: positive(net.upper) }
}
