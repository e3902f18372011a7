//! Joint transitions: what all choices do together in a step, one transition of each.

use super::Step;
use super::piece::Piece;
use crate::hybrid::affine::{self, AffineForm, excess};
use crate::hybrid::system::HybridSystem;

/// The most joint transitions that are looked at.
const MOST_JOINT_PIECES: usize = 64;

/// A joint transition with the pieces of the state space that its conditions leave.
pub(super) struct JointPiece {
    /// The positions of the transitions.
    pub(super) taken: Vec<usize>,
    /// The modes in which it begins, in choices with memory.
    pub(super) modes: Vec<(String, String)>,
    /// Its conditions, over states and inputs.
    pub(super) piece: Piece,
    /// The conditions, and that the next state lies in the domain and, as limits for the planner,
    /// within the limits on states.
    pub(super) inside: Piece,
}

/// All joint transitions of a step; `None` if there are too many.
pub(super) fn joint_transitions(system: &HybridSystem, step: &Step) -> Option<Vec<JointPiece>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for choice in &system.choices {
        let count = choice.transitions.len();
        if all.len() * count > MOST_JOINT_PIECES {
            return None;
        }
        let longer = |taken: &Vec<usize>| -> Vec<Vec<usize>> {
            (0..count).map(|j| [&taken[..], &[j]].concat()).collect()
        };
        all = all.iter().flat_map(longer).collect();
    }
    let width = step.units.size();
    let common = system.flow.as_ref().map(affine::flow);
    let of = |taken: Vec<usize>| {
        let piece = joined(step.pieces.iter().zip(&taken).map(|(own, &j)| &own[j]));
        let parts = step.dynamics.iter().zip(&taken).map(|(own, &j)| &own[j].next[..]);
        let next = affine::sum(common.as_deref(), &parts.collect::<Vec<&[AffineForm]>>());
        let mut inside = piece.clone();
        for (next, (_, domain)) in next.iter().zip(&system.states) {
            for (sign, end) in [(1.0, domain.upper), (-1.0, -domain.lower)] {
                let mut beyond = next.scaled(sign);
                beyond.constant -= end;
                inside.cut(&step.units, &beyond, false);
            }
        }
        for limit in system.limits.iter().filter(|limit| !limit.is_joint(next.len())) {
            let Some(AffineForm { factors, constant }) = excess(limit, width, step.number + 1)
            else {
                continue;
            };
            let after = affine::combine(factors, &next, width, constant);
            inside.cut(&step.units, &after, true);
        }
        let modes = system.choices.iter().zip(&taken).filter_map(|(choice, &j)| {
            let (from, _) = choice.transitions[j].modes.as_ref()?;
            Some((choice.name.clone(), from.clone()))
        });
        JointPiece { modes: modes.collect(), taken, piece, inside }
    };
    Some(all.into_iter().map(of).collect())
}

/// The intersection of pieces.
pub(super) fn joined<'a>(pieces: impl IntoIterator<Item = &'a Piece>) -> Piece {
    let mut all = Piece::default();
    pieces.into_iter().for_each(|piece| all.add(piece));
    all
}
