//! Settled binaries: values that some optimum of a node has, whatever the other columns are.
//!
//! From one value of a binary to the other, a quadratic objective changes by a linear function of
//! the other columns. If that has one sign within the bounds of the node, and the rows let the
//! binary go there, it is fixed (persistency: Hammer, Hansen and Simeone, Roof duality,
//! complementation and persistency in quadratic 0-1 optimization, Mathematical Programming 28,
//! 1984). The root's presolve does the same; below, the bounds are closer.

use super::context::Context;
use crate::activity::term_ends;
use crate::presolve::Domain;
use crate::program::Program;

/// Most passes over the binaries at a node.
const MOST_SETTLING_PASSES: usize = 4;

/// The rounding of a change of the objective, relative to the magnitudes of its terms (no unit).
const ROUNDING: f64 = 1e-13;

/// A binary with products, and where all rows let it go.
#[derive(Debug, Clone, Copy)]
struct FreeBinary {
    column: usize,
    may_fall: bool,
    may_rise: bool,
}

/// The binaries of a program that may settle.
#[derive(Debug, Clone, Default)]
pub(super) struct SettledBinaries {
    binaries: Vec<FreeBinary>,
}

impl SettledBinaries {
    /// Those of a program whose points may be replaced by better ones.
    pub(super) fn new(program: &Program) -> Self {
        let of = |&column: &usize| {
            let has_two_values = program.upper[column] - program.lower[column] == 1.0;
            let is_linked = program.quadratic_column(column).0.iter().any(|&k| k != column);
            if !has_two_values || !is_linked || program.is_in_cone(column) {
                return None;
            }
            let (rows, values) = program.column(column);
            let (mut may_fall, mut may_rise) = (true, true);
            for (&row, &a) in rows.iter().zip(values).filter(|(_, a)| **a != 0.0) {
                let is_open = [
                    program.row_lower[row] == f64::NEG_INFINITY,
                    program.row_upper[row] == f64::INFINITY,
                ];
                may_fall &= is_open[usize::from(a < 0.0)];
                may_rise &= is_open[usize::from(a > 0.0)];
            }
            (may_fall || may_rise).then_some(FreeBinary { column, may_fall, may_rise })
        };
        SettledBinaries { binaries: program.integers.iter().filter_map(of).collect() }
    }

    /// The binary's value, if it is settled within a domain.
    fn value(program: &Program, domain: &Domain, binary: FreeBinary) -> Option<f64> {
        let FreeBinary { column, may_fall, may_rise } = binary;
        let [lower, upper] = domain.bounds(column);
        let cost = program.linear[column];
        let (mut least, mut most, mut size) = (cost, cost, cost.abs());
        let (others, values) = program.quadratic_column(column);
        for (&other, &p) in others.iter().zip(values) {
            let ends = match other == column {
                true => [0.5 * (lower + upper); 2],
                false => domain.bounds(other),
            };
            let [low, high] = term_ends(p, ends);
            (least, most) = (least + low, most + high);
            size += low.abs().max(high.abs());
        }
        let margin = ROUNDING * size;
        match () {
            () if may_fall && least >= margin => Some(lower),
            () if may_rise && most <= -margin => Some(upper),
            () => None,
        }
    }
}

/// Fixes what is settled in the domain of the focus node.
pub(super) fn settle_binaries(ctx: &mut Context<'_>) {
    let program = ctx.program();
    for _ in 0..MOST_SETTLING_PASSES {
        let mut has_changed = false;
        for &binary in &ctx.settled.binaries {
            if ctx.node.domain.is_fixed(binary.column) {
                continue;
            }
            if let Some(value) = SettledBinaries::value(program, &ctx.node.domain, binary) {
                ctx.node.fix(binary.column, value);
                has_changed = true;
            }
        }
        if !has_changed {
            break;
        }
    }
}
