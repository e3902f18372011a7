//! Boxes of the integers, each cut in one way for all cells.
//!
//! A box that a cell cannot close is cut where its relaxation is fractional. The cut is remembered,
//! so that cells with a common corner ask for the same relaxations there.

use std::collections::HashMap;
use std::sync::Arc;

use crate::form::ParametricForm;

/// A box of columns: all of their bounds.
#[derive(Debug)]
pub(crate) struct IntegerBox {
    pub(crate) lower: Vec<f64>,
    pub(crate) upper: Vec<f64>,
    key: Vec<i64>,
    /// The column, the largest value of the first half, and the halves.
    cut: Option<(usize, f64, [usize; 2])>,
}

/// The boxes, by number; the first one is the whole.
#[derive(Debug)]
pub(crate) struct IntegerTree {
    boxes: Vec<IntegerBox>,
    known: HashMap<Vec<i64>, usize>,
    integers: Vec<usize>,
    /// The cuts that were known before.
    earlier: Arc<KnownCuts>,
    /// The boxes that were cut since then.
    new: Vec<usize>,
}

/// Where boxes are cut, by the ends of their integers: the column, and the largest value of the
/// first half.
pub(crate) type KnownCuts = HashMap<Vec<i64>, (usize, f64)>;

/// How far from a whole number a value of a relaxation is fractional.
const FAR_FROM_WHOLE: f64 = 1e-6;

impl IntegerTree {
    /// The number of the whole.
    pub(crate) const WHOLE: usize = 0;

    pub(crate) fn new(form: &ParametricForm, earlier: &Arc<KnownCuts>) -> Self {
        let integers = (0..form.columns()).filter(|j| form.integral[*j]).collect();
        let (boxes, known, new) = (Vec::new(), HashMap::new(), Vec::new());
        let mut tree = IntegerTree { boxes, known, integers, earlier: Arc::clone(earlier), new };
        tree.number(form.lower.clone(), form.upper.clone());
        tree
    }

    /// The ends of the ranges of the integers in a box.
    pub(crate) fn key(&self, number: usize) -> &[i64] {
        &self.boxes[number].key
    }

    /// The box with these ends.
    pub(crate) fn of_key(&mut self, key: &[i64]) -> usize {
        let (mut lower, mut upper) = (self.boxes[0].lower.clone(), self.boxes[0].upper.clone());
        for (&j, ends) in self.integers.iter().zip(key.chunks(2)) {
            if let [least, most] = *ends {
                (lower[j], upper[j]) = (least as f64, most as f64);
            }
        }
        self.number(lower, upper)
    }

    fn number(&mut self, lower: Vec<f64>, upper: Vec<f64>) -> usize {
        let ends = |&j: &usize| [lower[j] as i64, upper[j] as i64];
        let key: Vec<i64> = self.integers.iter().flat_map(ends).collect();
        let boxes = &mut self.boxes;
        *self.known.entry(key.clone()).or_insert_with(|| {
            boxes.push(IntegerBox { lower, upper, key, cut: None });
            boxes.len() - 1
        })
    }

    /// The bounds of all columns in a box.
    pub(crate) fn sides(&self, number: usize) -> [&[f64]; 2] {
        let of = &self.boxes[number];
        [&of.lower, &of.upper]
    }

    /// Whether all integers have one value.
    pub(crate) fn is_point(&self, number: usize) -> bool {
        let of = &self.boxes[number];
        self.integers.iter().all(|&j| of.lower[j] >= of.upper[j])
    }

    /// Whether an integer of a point is fractional.
    pub(crate) fn is_fractional(&self, x: &[f64]) -> bool {
        self.integers.iter().any(|&j| (x[j] - x[j].round()).abs() > FAR_FROM_WHOLE)
    }

    /// The box of the integers of a point; `None` if one is fractional, or out of its range.
    pub(crate) fn point(&mut self, x: &[f64]) -> Option<usize> {
        let (mut lower, mut upper) = (self.boxes[0].lower.clone(), self.boxes[0].upper.clone());
        for &j in &self.integers {
            let whole = x[j].round();
            if (x[j] - whole).abs() > FAR_FROM_WHOLE || whole < lower[j] || whole > upper[j] {
                return None;
            }
            (lower[j], upper[j]) = (whole, whole);
        }
        Some(self.number(lower, upper))
    }

    /// Cuts a box, where it was cut before, or where a point is most fractional, or else at the
    /// first integer with several values. `None` if there is none.
    pub(crate) fn cut(
        &mut self,
        number: usize,
        x: Option<&[f64]>,
    ) -> Option<(usize, f64, [usize; 2])> {
        if let Some(cut) = self.boxes[number].cut {
            return Some(cut);
        }
        let known = self.earlier.get(&self.boxes[number].key).copied();
        let (column, value) = known.or_else(|| self.place_of_cut(number, x))?;
        let of = &self.boxes[number];
        let halves = [(of.lower.clone(), of.upper.clone()), (of.lower.clone(), of.upper.clone())];
        let [(lower, mut below), (mut above, upper)] = halves;
        (below[column], above[column]) = (value, value + 1.0);
        let halves = [self.number(lower, below), self.number(above, upper)];
        self.boxes[number].cut = Some((column, value, halves));
        self.new.push(number);
        self.boxes[number].cut
    }

    fn place_of_cut(&self, number: usize, x: Option<&[f64]>) -> Option<(usize, f64)> {
        let of = &self.boxes[number];
        let open = self.integers.iter().copied().filter(|&j| of.lower[j] < of.upper[j]);
        let far = |j: usize| x.map_or(0.0, |x| (x[j] - x[j].round()).abs());
        let mut best: Option<(usize, f64)> = None;
        for j in open {
            if best.is_none_or(|(_, most)| far(j) > most + FAR_FROM_WHOLE) {
                best = Some((j, far(j)));
            }
        }
        let (column, _) = best?;
        let middle = (0.5 * (of.lower[column] + of.upper[column])).floor();
        let value = x.map_or(middle, |x| (x[column] + FAR_FROM_WHOLE).floor());
        Some((column, value.clamp(of.lower[column], of.upper[column] - 1.0)))
    }

    /// The cuts since the tree is new.
    pub(crate) fn into_cuts(mut self) -> KnownCuts {
        let mut cuts = KnownCuts::new();
        for number in self.new {
            let of = &mut self.boxes[number];
            if let Some((column, value, _)) = of.cut {
                cuts.insert(std::mem::take(&mut of.key), (column, value));
            }
        }
        cuts
    }
}
