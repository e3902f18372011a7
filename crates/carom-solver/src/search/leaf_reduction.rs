//! The program of a leaf, in which columns that equations determine have the values that follow.

use super::context::Context;
use super::tree::Tree;
use crate::presolve::{DeterminedColumns, Reduced};
use crate::program::Program;
use crate::tolerance;

/// Reduces a program to the domain, whose integers are all fixed; `None` if that refutes it.
pub(super) fn reduce_leaf(ctx: &mut Context<'_>, program: &Program) -> Option<Reduced> {
    let mark = ctx.node.domain.mark();
    let reduced = match fix_determined(ctx) {
        true => ctx.cascade.reduce_leaf(program, &ctx.node.domain),
        false => None,
    };
    ctx.node.domain.undo_to(mark);
    reduced
}

/// Fixes columns that equations determine. Returns `false` if a value contradicts the bounds.
fn fix_determined(ctx: &mut Context<'_>) -> bool {
    let tree = ctx.tree.tree;
    let Some(determined) = determined(tree) else { return true };
    let domain = &mut ctx.node.domain;
    let values = determined.values(|j| domain.lower(j));
    for &column in determined.blocks().iter().flat_map(|block| &block.columns) {
        let ball = determined.value_of(&values, column);
        let (value, error) = (ball.value(), ball.error());
        let [lower, upper] = domain.bounds(column);
        let margin = error + tolerance::allowed_miss(tolerance::FEASIBILITY, value.abs());
        if value - margin > upper || value + margin < lower {
            return false;
        }
        // Farther out, products with the objective's curvature round visibly, which slack allows
        // for.
        if ball.is_sharp() && value.abs() <= tolerance::FREE_RADIUS {
            domain.apply(column, false, value);
            domain.apply(column, true, value);
        }
    }
    true
}

/// The columns that equations determine in leaves; `None` where none needs care.
pub(super) fn determined<'a>(tree: &'a Tree<'_>) -> Option<&'a DeterminedColumns> {
    let program = tree.task.exact.unwrap_or(tree.task.program);
    match tree.task.leaf_columns {
        Some((own, kept)) if std::ptr::eq(own, program) => kept.of(program),
        _ => tree.determined.of(program),
    }
}
