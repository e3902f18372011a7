//! Corners of cells, and what has been found there.

use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::{Rc, Weak};

use crate::bounds::CornerPlace;
use crate::form::ParametricForm;
use crate::integer_tree::IntegerTree;
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

/// A corner of cells. It is dropped with the last cell that waits.
#[derive(Debug)]
pub(crate) struct Corner {
    pub(crate) units: Vec<i64>,
    pub(crate) place: CornerPlace,
    relaxed: RefCell<HashMap<usize, Rc<CornerRelaxation>>>,
    optimum: RefCell<Option<CornerOptimum>>,
}

impl Corner {
    /// Whether a relaxation is known.
    pub(crate) fn knows(&self, number: usize) -> bool {
        self.relaxed.borrow().contains_key(&number)
    }
}

/// The largest number of boxes that the search at a corner looks at.
const MOST_BOXES: usize = 100_000;

/// The corners of all cells that wait, the boxes of integers, and the methods.
pub(crate) struct Workshop {
    pub(crate) form: ParametricForm,
    pub(crate) tree: IntegerTree,
    relaxer: CornerRelaxer,
    corners: HashMap<Vec<i64>, Weak<Corner>>,
    /// Relaxations that were solved.
    pub(crate) solved: u64,
}

impl Workshop {
    pub(crate) fn new(form: ParametricForm, relaxer: CornerRelaxer) -> Self {
        let tree = IntegerTree::new(&form);
        Workshop { form, tree, relaxer, corners: HashMap::new(), solved: 0 }
    }

    /// The corner of these units.
    pub(crate) fn corner(&mut self, units: Vec<i64>) -> Rc<Corner> {
        if let Some(corner) = self.corners.get(&units).and_then(Weak::upgrade) {
            return corner;
        }
        let form = &self.form;
        let at = form.state(&units);
        let corner = Rc::new(Corner {
            units: units.clone(),
            place: CornerPlace::new(form, at),
            relaxed: RefCell::default(),
            optimum: RefCell::default(),
        });
        self.corners.insert(units, Rc::downgrade(&corner));
        corner
    }

    /// Whether the build is to end.
    pub(crate) fn is_over(&self) -> bool {
        self.relaxer.is_over()
    }

    /// Forgets corners that no cell has.
    pub(crate) fn sweep(&mut self) {
        self.corners.retain(|_, corner| corner.strong_count() > 0);
    }

    /// The relaxation of a box of integers at a corner.
    pub(crate) fn relaxed(&mut self, corner: &Corner, number: usize) -> Rc<CornerRelaxation> {
        if let Some(known) = corner.relaxed.borrow().get(&number) {
            return Rc::clone(known);
        }
        self.solved += 1;
        let sides = self.tree.sides(number);
        let found = Rc::new(self.relaxer.solve(&self.form, &corner.place, sides));
        corner.relaxed.borrow_mut().insert(number, Rc::clone(&found));
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
