//! The phases before cuts: big-Ms become smaller, and the root is propagated and probed.

use std::borrow::Cow;

use crate::presolve::{tighten_big_ms, tighten_by_disjunctions};
use crate::program::Program;
use crate::search::Root;
use crate::solver::{Options, StopToken};

/// Largest share of the remaining time that each way of tightening big-Ms may take (no unit): a
/// relaxation without them is better than none.
const TIME_SHARE_OF_TIGHTENING: f64 = 0.05;

/// A program with smaller big-Ms, and its root.
#[derive(Debug, Clone)]
pub(super) struct Tightened<'a> {
    pub(super) program: Cow<'a, Program>,
    pub(super) root: Root,
}

impl<'a> Tightened<'a> {
    /// Tightens a program, and propagates and probes its root. What is concluded holds for all
    /// bounds within its own.
    pub(super) fn new(program: &'a Program, options: &Options, token: &StopToken) -> Self {
        let program = tighten(program, options, token);
        let root = Root::new(&program, token, options.parts().probing);
        Tightened { program, root }
    }

    /// The program, whose bounds may have become tighter, and its root for these bounds.
    pub(super) fn within_bounds(&self, options: &Options, token: &StopToken) -> Tightened<'_> {
        let program = &*self.program;
        let root = self.root.within(program, token, options.parts().probing);
        Tightened { program: Cow::Borrowed(program), root }
    }

    pub(super) fn into_owned(self) -> Tightened<'static> {
        Tightened { program: Cow::Owned(self.program.into_owned()), root: self.root }
    }
}

/// A program with smaller big-Ms. The program stays as it is if leaves are kept, because they speak
/// of it.
fn tighten<'a>(program: &'a Program, options: &Options, token: &StopToken) -> Cow<'a, Program> {
    let mut tight = Cow::Borrowed(program);
    if options.parts().keep_leaves {
        return tight;
    }
    let share = || token.child(token.left().map(|left| left.mul_f64(TIME_SHARE_OF_TIGHTENING)));
    if options.parts().disjunctive_tightening {
        tight = tighten_by_disjunctions(&tight, &share()).map_or(tight, Cow::Owned);
    }
    if options.parts().big_m_tightening {
        tight = tighten_big_ms(&tight, &share()).map_or(tight, Cow::Owned);
    }
    tight
}
