//! Second-order cones over the columns of a program.

use super::Program;

/// The largest tail of a norm that is cut off as it is; longer ones are split into parts.
pub(crate) const LONGEST_TAIL: usize = 2;

/// A second-order cone over columns of a program, each of them there once.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Cone {
    /// The shape.
    pub shape: ConeShape,
    /// The columns: first those of the head (see [`ConeShape`]), then the tail.
    pub columns: Vec<usize>,
    /// The part that it plays beside other cones.
    pub role: ConeRole,
}

/// The shape of a second-order cone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeShape {
    /// `|tail| <= head`; the head is one column.
    Norm,
    /// `|tail|^2 <= first * second`, both at least 0; the head is two columns.
    Rotated,
}

impl ConeShape {
    /// The number of columns of the head.
    pub fn head(self) -> usize {
        match self {
            ConeShape::Norm => 1,
            ConeShape::Rotated => 2,
        }
    }
}

/// The part that a cone plays beside others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ConeRole {
    /// It stands for itself.
    Single,
    /// It is split into parts with further columns. The parts together say the same.
    Whole,
    /// Its first column stands in the objective, and nowhere else, for the square of its only
    /// entry; the second column is 1 wherever the entry may differ from 0.
    Square,
    /// A part of the last [whole](Self::Whole) cone before it: the square of one entry of its tail
    /// is at most its first column, which no other cone has, times the head of the whole.
    Part,
}

impl Cone {
    /// The columns of the head.
    pub fn head(&self) -> &[usize] {
        &self.columns[..self.shape.head()]
    }

    /// The columns of the tail.
    pub fn tail(&self) -> &[usize] {
        &self.columns[self.shape.head()..]
    }

    /// The cone with other numbers for its columns.
    pub(crate) fn renumbered(&self, number: impl Fn(usize) -> usize) -> Cone {
        let columns = self.columns.iter().map(|&j| number(j)).collect();
        Cone { shape: self.shape, columns, role: self.role }
    }

    /// Sets the first column of a part to the least value that the point allows, but for rounding:
    /// a head that is nearly 0 must not make it larger than the sum of all parts, `most`.
    pub(crate) fn complete(&self, x: &mut [f64], most: f64) {
        let [part, times, entry] = self.columns[..] else { return };
        let square = x[entry] * x[entry];
        let least = if square == 0.0 { 0.0 } else { square / x[times].max(f64::MIN_POSITIVE) };
        x[part] = least.min(most.max(0.0));
    }

    /// By how much a point misses the cone, in the unit of the head: the distance of the head from
    /// the least one that the tail allows (of a rotated cone, in the direction in which both grow
    /// alike).
    pub fn miss(&self, x: &[f64]) -> f64 {
        let value = |j: &usize| x[*j];
        let length = |values: &mut dyn Iterator<Item = f64>| {
            values.fold(0.0_f64, |length, value| length.hypot(value))
        };
        match self.shape {
            ConeShape::Norm => length(&mut self.tail().iter().map(value)) - x[self.columns[0]],
            ConeShape::Rotated => {
                let (first, second) = (x[self.columns[0]], x[self.columns[1]]);
                let tail = self.tail().iter().map(|j| 2.0 * x[*j]);
                let all = length(&mut tail.chain([first - second]));
                0.5 * (all - (first + second))
            }
        }
    }
}

/// Which of so many columns are in cones.
pub(crate) fn conic_columns(cones: &[Cone], columns: usize) -> Vec<bool> {
    let mut conic = vec![false; columns];
    cones.iter().flat_map(|cone| &cone.columns).for_each(|&j| conic[j] = true);
    conic
}

impl Program {
    /// The program with squares in the objective in place of the cones that stand for them, if it
    /// has such cones. Its points with whole integers are those of the program, and their values
    /// are the same.
    pub(crate) fn with_squares(&self) -> &Program {
        let squared = self.squared.get_or_init(|| {
            let is_square = |cone: &&Cone| cone.role == ConeRole::Square;
            if !self.cones.iter().any(|cone| is_square(&cone)) {
                return None;
            }
            let mut squared = self.clone();
            let (mut linear, mut products) = (self.linear.clone(), Vec::new());
            products.extend(self.quadratic_entries());
            for cone in self.cones.iter().filter(is_square) {
                if let [square, _, entry] = cone.columns[..] {
                    products.push((entry, entry, 2.0 * std::mem::take(&mut linear[square])));
                }
            }
            squared.rewrite_objective(linear, &products, self.offset)?;
            squared.set_cones(self.cones.iter().filter(|cone| !is_square(cone)).cloned().collect());
            Some(Box::new(squared))
        });
        squared.as_deref().unwrap_or(self)
    }

    /// Sets the columns of parts and of squares to the least values that the point allows.
    pub(crate) fn complete_parts(&self, x: &mut [f64]) {
        let mut sum = None;
        for cone in &self.cones {
            match cone.role {
                ConeRole::Single => {}
                ConeRole::Square => {
                    if let [square, _, entry] = cone.columns[..] {
                        x[square] = x[entry] * x[entry];
                    }
                }
                ConeRole::Whole => sum = cone.columns.first(),
                ConeRole::Part => cone.complete(x, sum.map_or(f64::INFINITY, |&j| x[j])),
            }
        }
    }
}
