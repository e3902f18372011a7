//! Corners of cells, and what has been found there.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::{Rc, Weak};
use std::sync::{Arc, Mutex, PoisonError};

use crate::bounds::CornerPlace;
use crate::form::ParametricForm;
use crate::integer_tree::{IntegerTree, KnownCuts};
use crate::relaxed::{CornerRelaxation, CornerRelaxer};

/// The best integers of a corner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CornerOptimum {
    /// The box of these integers alone.
    Best(usize),
    /// There is no plan.
    NoPlan,
    /// The search has ended before, or has not found out.
    Unknown,
}

/// A corner with the relaxations that any job has solved there, by the ranges of the integers. They
/// do not depend on who solves them.
#[derive(Debug)]
pub(crate) struct SharedCorner {
    pub(crate) units: Vec<i64>,
    place: CornerPlace,
    relaxed: Mutex<HashMap<Vec<i64>, Arc<CornerRelaxation>>>,
}

/// The corners of all jobs.
#[derive(Debug, Default)]
pub(crate) struct SharedCorners {
    known: Mutex<HashMap<Vec<i64>, Arc<SharedCorner>>>,
}

impl SharedCorners {
    /// The corner of these units.
    pub(crate) fn corner(&self, form: &ParametricForm, units: Vec<i64>) -> Arc<SharedCorner> {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(corner) = known.get(&units) {
            return Arc::clone(corner);
        }
        let place = CornerPlace::new(form, form.state(&units));
        let corner = SharedCorner { units: units.clone(), place, relaxed: Mutex::default() };
        let corner = Arc::new(corner);
        known.insert(units, Arc::clone(&corner));
        corner
    }

    /// Forgets corners that no cell has that waits. Not within a level: what one job has finished
    /// is beside what another one has not begun.
    pub(crate) fn sweep(&self) {
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        known.retain(|_, corner| Arc::strong_count(corner) > 1);
    }
}

/// A corner of cells of a job.
#[derive(Debug)]
pub(crate) struct Corner {
    pub(crate) shared: Arc<SharedCorner>,
    relaxed: RefCell<HashMap<usize, Arc<CornerRelaxation>>>,
    optimum: RefCell<Option<CornerOptimum>>,
}

impl Corner {
    pub(crate) fn units(&self) -> &[i64] {
        &self.shared.units
    }

    pub(crate) fn place(&self) -> &CornerPlace {
        &self.shared.place
    }

    /// Whether a relaxation is known.
    pub(crate) fn knows(&self, number: usize) -> bool {
        self.relaxed.borrow().contains_key(&number)
    }
}

/// The largest number of boxes that the search at a corner looks at.
const MOST_BOXES: usize = 100_000;

/// The corners of the cells of a job, its boxes of integers, and the methods.
pub(crate) struct Workshop<'a> {
    pub(crate) form: &'a ParametricForm,
    pub(crate) tree: IntegerTree,
    relaxer: CornerRelaxer,
    shared: &'a SharedCorners,
    corners: HashMap<Vec<i64>, Weak<Corner>>,
    /// Relaxations that were needed.
    pub(crate) needed: u64,
}

impl<'a> Workshop<'a> {
    pub(crate) fn new(
        form: &'a ParametricForm,
        shared: &'a SharedCorners,
        cuts: &Arc<KnownCuts>,
        relaxer: CornerRelaxer,
    ) -> Self {
        let tree = IntegerTree::new(form, cuts);
        Workshop { form, tree, relaxer, shared, corners: HashMap::new(), needed: 0 }
    }

    /// The corner of these units.
    pub(crate) fn corner(&mut self, units: Vec<i64>) -> Rc<Corner> {
        if let Some(corner) = self.corners.get(&units).and_then(Weak::upgrade) {
            return corner;
        }
        let shared = self.shared.corner(self.form, units.clone());
        let (relaxed, optimum) = (RefCell::default(), RefCell::default());
        let corner = Rc::new(Corner { shared, relaxed, optimum });
        self.corners.insert(units, Rc::downgrade(&corner));
        corner
    }

    /// Whether the build is to end.
    pub(crate) fn is_over(&self) -> bool {
        self.relaxer.is_over()
    }

    /// The relaxation of a box of integers at a corner.
    pub(crate) fn relaxed(&mut self, corner: &Corner, number: usize) -> Arc<CornerRelaxation> {
        if let Some(known) = corner.relaxed.borrow().get(&number) {
            return Arc::clone(known);
        }
        self.needed += 1;
        let key = self.tree.key(number);
        let lock = || corner.shared.relaxed.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().get(key).cloned();
        let found = known.unwrap_or_else(|| {
            let sides = self.tree.sides(number);
            let found = Arc::new(self.relaxer.solve(self.form, corner.place(), sides));
            // Not what a limit has cut short. Of two that are solved at once, one is kept, so that
            // certificates name what is shared alike.
            match self.relaxer.is_over() {
                true => found,
                false => Arc::clone(lock().entry(key.to_vec()).or_insert(found)),
            }
        });
        corner.relaxed.borrow_mut().insert(number, Arc::clone(&found));
        found
    }

    /// The best integers of a corner, by branch and bound.
    pub(crate) fn optimum(&mut self, corner: &Corner) -> CornerOptimum {
        if let Some(known) = *corner.optimum.borrow() {
            return known;
        }
        let found = self.search(corner);
        *corner.optimum.borrow_mut() = Some(found);
        found
    }

    fn search(&mut self, corner: &Corner) -> CornerOptimum {
        let mut best: Option<(f64, usize)> = None;
        let mut is_complete = true;
        let mut waiting = vec![IntegerTree::WHOLE];
        for _ in 0..MOST_BOXES {
            if self.is_over() {
                break;
            }
            let Some(number) = waiting.pop() else {
                return match best {
                    Some((_, number)) => CornerOptimum::Best(number),
                    None if is_complete => CornerOptimum::NoPlan,
                    None => CornerOptimum::Unknown,
                };
            };
            let relaxed = self.relaxed(corner, number);
            let x = match &*relaxed {
                CornerRelaxation::Refuted(_) => continue,
                CornerRelaxation::Unknown => None,
                CornerRelaxation::Solved { cost, .. }
                    if best.is_some_and(|(least, _)| *cost >= least) =>
                {
                    continue;
                }
                CornerRelaxation::Solved { x, .. } => Some(&x[..]),
            };
            if let Some(point) = x.and_then(|x| self.tree.point(x))
                && let CornerRelaxation::Solved { cost, .. } = &*self.relaxed(corner, point)
            {
                if best.is_none_or(|(least, _)| *cost < least) {
                    best = Some((*cost, point));
                }
                continue;
            }
            match self.tree.cut(number, x) {
                Some((column, value, [below, above])) => {
                    // The nearer half is looked at first.
                    let up = x.is_some_and(|x| x[column] > value + 0.5);
                    waiting.extend(if up { [below, above] } else { [above, below] });
                }
                None => is_complete = false,
            }
        }
        best.map_or(CornerOptimum::Unknown, |(_, number)| CornerOptimum::Best(number))
    }
}
