//! Decisions that a simulation is given, step by step.

use crate::hybrid::memory::Memory;

/// The decided part of some steps: the inputs, and the transitions where something chose them.
///
/// Lists of inputs leave the transitions open, as `&[[0.0]; 5]` does. A
/// [`ControlMove`](crate::hybrid::ControlMove) is a step with its transitions and with what the run
/// remembers.
pub trait Decisions {
    #[doc(hidden)]
    #[expect(private_interfaces, reason = "only types of the crate and lists implement it")]
    fn decided(&self) -> Decided<'_>;
}

/// Steps in numbers and names.
#[derive(Debug, Clone, Default)]
pub(crate) struct Decided<'a> {
    /// By step.
    pub(crate) inputs: Vec<&'a [f64]>,
    /// By step: choices with the transitions that they take.
    pub(crate) transitions: Vec<Vec<(&'a str, &'a str)>>,
    pub(crate) memory: Option<&'a Memory>,
    /// By how much conditions may be violated, because a solver decided.
    pub(crate) tolerance: f64,
    /// Whether they are about a state from which nothing is known to be allowed.
    pub(crate) is_beyond_limits: bool,
}

impl<'a> Decided<'a> {
    pub(super) fn transition(&self, step: usize, choice: &str) -> Option<&'a str> {
        let own = self.transitions.get(step)?.iter().find(|(own, _)| *own == choice);
        own.map(|(_, transition)| *transition)
    }
}

impl<U: AsRef<[f64]>> Decisions for [U] {
    #[expect(private_interfaces, reason = "as the trait")]
    fn decided(&self) -> Decided<'_> {
        Decided { inputs: self.iter().map(AsRef::as_ref).collect(), ..Decided::default() }
    }
}

impl<U: AsRef<[f64]>, const N: usize> Decisions for [U; N] {
    #[expect(private_interfaces, reason = "as the trait")]
    fn decided(&self) -> Decided<'_> {
        self[..].decided()
    }
}

impl<U: AsRef<[f64]>> Decisions for Vec<U> {
    #[expect(private_interfaces, reason = "as the trait")]
    fn decided(&self) -> Decided<'_> {
        self[..].decided()
    }
}

impl<D: Decisions + ?Sized> Decisions for &D {
    #[expect(private_interfaces, reason = "as the trait")]
    fn decided(&self) -> Decided<'_> {
        (**self).decided()
    }
}
