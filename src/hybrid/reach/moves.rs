//! Moves: what all choices of a step do together.
//!
//! A move takes one transition of every choice. If that makes too many moves, the last choices are
//! relaxed: what any of their transitions changes about the next state is enclosed in a box, which
//! is added to every move, and their modes, dwell times and numbers of events are not followed.

use crate::hybrid::system::HybridSystem;

/// The largest number of moves; further choices are relaxed.
const MOST_MOVES: usize = 64;

/// One transition of every choice that is followed.
#[derive(Debug, Clone)]
pub(super) struct Move {
    /// Numbers of the transitions.
    pub(super) members: Vec<usize>,
    /// How many of them are events.
    pub(super) events: usize,
}

/// All moves of a system.
#[derive(Debug, Clone)]
pub(super) struct Moves {
    pub(super) list: Vec<Move>,
    /// Number of choices that are followed, the first ones; the others are relaxed.
    pub(super) followed: usize,
    /// Numbers of the relaxed choices' transitions.
    pub(super) relaxed: Vec<usize>,
}

impl Moves {
    pub(super) fn new(system: &HybridSystem) -> Self {
        let mut list = vec![Move { members: Vec::new(), events: 0 }];
        let mut followed = 0;
        for (c, choice) in system.choices.iter().enumerate() {
            if c > 0 && list.len().saturating_mul(choice.transitions.len()) > MOST_MOVES {
                break;
            }
            let first = system.first_transition(c);
            let extended = |taken: &Move| {
                let taken = taken.clone();
                choice.transitions.iter().enumerate().map(move |(k, transition)| {
                    let mut members = taken.members.clone();
                    members.push(first + k);
                    Move { members, events: taken.events + usize::from(transition.is_event) }
                })
            };
            list = list.iter().flat_map(extended).collect();
            followed = c + 1;
        }
        let relaxed = match system.choices.get(followed) {
            Some(_) => (system.first_transition(followed)..system.transitions().count()).collect(),
            None => Vec::new(),
        };
        Moves { list, followed, relaxed }
    }
}
