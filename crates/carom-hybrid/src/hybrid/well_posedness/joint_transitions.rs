//! Joint transitions: what all choices do together in a step, one transition of each.

use super::Step;
use super::piece::Piece;
use crate::hybrid::step::{
    self, AffineForm, CartesianProduct, ConditionMaps, Moment, StepCondition,
};
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
    let counts = system.choices.iter().map(|choice| choice.transitions.len());
    let all = CartesianProduct::at_most(MOST_JOINT_PIECES, counts)?;
    let width = step.units.size();
    let common = system.flow.as_ref().map(step::flow);
    let of = |taken: Vec<usize>| {
        let piece = joined(step.pieces.iter().zip(&taken).map(|(own, &j)| &own[j]));
        let parts = step.dynamics.iter().zip(&taken).map(|(own, &j)| &own[j].next[..]);
        let next = step::sum(common.as_deref(), &parts.collect::<Vec<&[AffineForm]>>());
        let mut inside = piece.clone();
        for (next, (_, domain)) in next.iter().zip(&system.states) {
            for (sign, end) in [(1.0, domain.upper), (-1.0, -domain.lower)] {
                let mut beyond = next.scaled(sign);
                beyond.constant -= end;
                inside.cut(&step.units, &beyond, false);
            }
        }
        for limit in system.limits_of(false) {
            let after = StepCondition { moment: Moment::Prediction, ..limit };
            let after = after.maps(&next, width, step.number + 1);
            if let Some(ConditionMaps::HalfSpace(map)) = after {
                inside.cut(&step.units, &map, true);
            }
        }
        let modes = system.choices.iter().zip(&taken).filter_map(|(choice, &j)| {
            let (from, _) = choice.transitions[j].modes.as_ref()?;
            Some((choice.name.clone(), from.clone()))
        });
        JointPiece { modes: modes.collect(), taken, piece, inside }
    };
    Some(all.map(of).collect())
}

/// The intersection of pieces.
pub(super) fn joined<'a>(pieces: impl IntoIterator<Item = &'a Piece>) -> Piece {
    let mut all = Piece::default();
    pieces.into_iter().for_each(|piece| all.add(piece));
    all
}
