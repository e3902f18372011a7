//! Joint transitions: what all choices of a step do together.
//!
//! A joint transition takes one transition of every choice. If there are too many of them, the last
//! choices are relaxed: what any of their transitions changes about the next state is in a box, and
//! the box is added to every joint transition. Their modes, dwell times and numbers of events are
//! not followed.

use crate::hybrid::system::HybridSystem;

/// The largest number of joint transitions; further choices are relaxed.
const MOST_JOINT_TRANSITIONS: usize = 64;

/// One transition of every choice that is followed.
#[derive(Debug, Clone)]
pub(super) struct JointTransition {
    /// Numbers of the transitions.
    pub(super) members: Vec<usize>,
    /// How many of them are events.
    pub(super) events: usize,
}

/// All joint transitions of a system.
#[derive(Debug, Clone)]
pub(super) struct JointTransitions {
    pub(super) list: Vec<JointTransition>,
    /// Number of choices that are followed, the first ones; the others are relaxed.
    pub(super) followed: usize,
    /// Numbers of the relaxed choices' transitions.
    pub(super) relaxed: Vec<usize>,
}

impl JointTransitions {
    /// The joint transitions of a system in which at most one choice of each group has an event.
    pub(super) fn new(system: &HybridSystem, exclusive: &[Vec<usize>]) -> Self {
        let mut list = vec![JointTransition { members: Vec::new(), events: 0 }];
        let mut followed = 0;
        for (c, choice) in system.choices.iter().enumerate() {
            let first = system.first_transition(c);
            let is_event = |taken: &JointTransition, other: usize| {
                other < c && {
                    let number = taken.members[other] - system.first_transition(other);
                    system.choices[other].transitions[number].is_event
                }
            };
            let groups = || exclusive.iter().filter(|group| group.contains(&c));
            let is_busy = |taken: &JointTransition| {
                groups().any(|group| group.iter().any(|&other| is_event(taken, other)))
            };
            let mut extended = Vec::new();
            for taken in &list {
                let is_busy = is_busy(taken);
                for (k, transition) in choice.transitions.iter().enumerate() {
                    if is_busy && transition.is_event {
                        continue;
                    }
                    let members = taken.members.iter().copied().chain([first + k]).collect();
                    let events = taken.events + usize::from(transition.is_event);
                    extended.push(JointTransition { members, events });
                }
            }
            if c > 0 && extended.len() > MOST_JOINT_TRANSITIONS {
                break;
            }
            list = extended;
            followed = c + 1;
        }
        let relaxed = match system.choices.get(followed) {
            Some(_) => (system.first_transition(followed)..system.transitions().count()).collect(),
            None => Vec::new(),
        };
        JointTransitions { list, followed, relaxed }
    }
}
