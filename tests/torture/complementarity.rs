//! Convex quadratic programs over whole numbers, solved exactly.
//!
//! The optimality conditions of `min 1/2 x'Qx + c'x, Ax >= b, x >= 0` are a linear complementarity
//! problem, and Lemke's method ends on it after finitely many pivots: with a point, or with a ray
//! that proves that there is none (Cottle, Pane, Stone 1992, chapter 4). Ties are broken
//! lexicographically, and the tableau holds whole numbers over one denominator (Bareiss 1968), so
//! that nothing is rounded however badly the rows are scaled. Numbers are 128 bits wide while they
//! fit, and as wide as they need to be otherwise.

use std::cmp::Ordering;

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// A program in whole numbers.
#[derive(Debug, Clone, Default)]
pub(crate) struct Whole {
    /// `Q`, symmetric and positive semidefinite.
    pub(crate) curvature: Vec<Vec<i128>>,
    pub(crate) cost: Vec<i128>,
    /// Rows of `A`, each with its `b`.
    pub(crate) rows: Vec<(Vec<i128>, i128)>,
}

/// The exact answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Answer {
    Infeasible,
    Unbounded,
    /// The least value of `1/2 x'Qx + c'x`, and where.
    Least(BigRational, Vec<BigRational>),
}

/// What the pivots need of a number.
trait Number: Clone {
    fn whole(value: i128) -> Self;
    fn sign(&self) -> Ordering;
    /// `(a * d - b * c) / divisor` where this is whole; `None` where it does not fit.
    fn cross(a: &Self, d: &Self, b: &Self, c: &Self, divisor: &Self) -> Option<Self>;
    /// The order of `a * d` and `b * c`.
    fn compare(a: &Self, d: &Self, b: &Self, c: &Self) -> Option<Ordering>;
    fn negated(&self) -> Self;
    fn minus(&self, other: &Self) -> Option<Self>;
    fn wide(&self) -> BigInt;
}

impl Number for i128 {
    fn whole(value: i128) -> Self {
        value
    }

    fn sign(&self) -> Ordering {
        self.cmp(&0)
    }

    fn cross(a: &Self, d: &Self, b: &Self, c: &Self, divisor: &Self) -> Option<Self> {
        Some(a.checked_mul(*d)?.checked_sub(b.checked_mul(*c)?)? / divisor)
    }

    fn compare(a: &Self, d: &Self, b: &Self, c: &Self) -> Option<Ordering> {
        Some(a.checked_mul(*d)?.cmp(&b.checked_mul(*c)?))
    }

    fn negated(&self) -> Self {
        -self
    }

    fn minus(&self, other: &Self) -> Option<Self> {
        self.checked_sub(*other)
    }

    fn wide(&self) -> BigInt {
        BigInt::from(*self)
    }
}

impl Number for BigInt {
    fn whole(value: i128) -> Self {
        BigInt::from(value)
    }

    fn sign(&self) -> Ordering {
        self.cmp(&BigInt::zero())
    }

    fn cross(a: &Self, d: &Self, b: &Self, c: &Self, divisor: &Self) -> Option<Self> {
        Some((a * d - b * c) / divisor)
    }

    fn compare(a: &Self, d: &Self, b: &Self, c: &Self) -> Option<Ordering> {
        Some((a * d).cmp(&(b * c)))
    }

    fn negated(&self) -> Self {
        -self
    }

    fn minus(&self, other: &Self) -> Option<Self> {
        Some(self - other)
    }

    fn wide(&self) -> BigInt {
        self.clone()
    }
}

impl Whole {
    /// The exact answer.
    pub(crate) fn solve(&self) -> Answer {
        if let Some(point) = self.stationary() {
            return Answer::Least(self.value(&point), point);
        }
        // Without a cost every feasible point is stationary.
        let n = self.cost.len();
        let feasible =
            Whole { curvature: vec![vec![0; n]; n], cost: vec![0; n], rows: self.rows.clone() };
        match feasible.stationary() {
            Some(_) => Answer::Unbounded,
            None => Answer::Infeasible,
        }
    }

    fn value(&self, x: &[BigRational]) -> BigRational {
        let number = |value: i128| BigRational::from_integer(BigInt::from(value));
        let mut value = BigRational::zero();
        for (i, xi) in x.iter().enumerate() {
            let mut slope = number(0);
            for (j, xj) in x.iter().enumerate() {
                slope += number(self.curvature[i][j]) * xj;
            }
            value += (slope / number(2) + number(self.cost[i])) * xi;
        }
        value
    }

    /// A point of the optimality conditions.
    fn stationary(&self) -> Option<Vec<BigRational>> {
        let narrow = Tableau::<i128>::of(self).and_then(Tableau::run);
        let Some(ended) = narrow else {
            let wide = Tableau::<BigInt>::of(self).and_then(Tableau::run);
            return wide.expect("as wide as needed");
        };
        ended
    }
}

/// `w - M z - 1 s = q` with columns `w`, `z`, the covering variable `s`, `q`; the true entries are
/// these over `divisor`, which is positive.
struct Tableau<T> {
    rows: Vec<Vec<T>>,
    basis: Vec<usize>,
    divisor: T,
    order: usize,
    columns: usize,
}

impl<T: Number> Tableau<T> {
    fn of(program: &Whole) -> Option<Self> {
        let (n, m) = (program.cost.len(), program.rows.len());
        let order = n + m;
        let rows = (0..order).map(|i| {
            let mut row = vec![T::whole(0); 2 * order + 2];
            row[i] = T::whole(1);
            let mut set = |j: usize, value: i128| row[j] = T::whole(value);
            if i < n {
                for j in 0..n {
                    set(order + j, -program.curvature[i][j]);
                }
                for (k, (a, _)) in program.rows.iter().enumerate() {
                    set(order + n + k, a[i]);
                }
                set(2 * order + 1, program.cost[i]);
            } else {
                let (a, b) = &program.rows[i - n];
                for (j, &a) in a.iter().enumerate() {
                    set(order + j, -a);
                }
                set(2 * order + 1, -b);
            }
            set(2 * order, -1);
            row
        });
        let (rows, basis) = (rows.collect(), (0..order).collect());
        Some(Tableau { rows, basis, divisor: T::whole(1), order, columns: n })
    }

    /// The values of `x`, `None` inside for a ray, `None` outside where numbers do not fit.
    #[allow(clippy::option_option)]
    fn run(mut self) -> Option<Option<Vec<BigRational>>> {
        let (cover, right) = (2 * self.order, 2 * self.order + 1);
        let mut least: Option<usize> = None;
        for i in 0..self.order {
            let q = &self.rows[i][right];
            let lower = match least {
                None => q.sign() == Ordering::Less,
                Some(k) => q.minus(&self.rows[k][right])?.sign() != Ordering::Greater,
            };
            if lower {
                least = Some(i);
            }
        }
        let Some(first) = least else {
            return Some(Some(self.point()));
        };
        // The covering variable enters where `q` is least: rows minus this row, this row negated.
        let pivot = self.rows[first].clone();
        for (i, row) in self.rows.iter_mut().enumerate() {
            for (entry, pivot) in row.iter_mut().zip(&pivot) {
                *entry = if i == first { pivot.negated() } else { entry.minus(pivot)? };
            }
        }
        let mut left = std::mem::replace(&mut self.basis[first], cover);
        loop {
            let entering = if left < self.order { left + self.order } else { left - self.order };
            let Some(row) = self.leaving(entering)? else {
                return Some(None);
            };
            self.pivot(row, entering)?;
            left = std::mem::replace(&mut self.basis[row], entering);
            if left == cover {
                return Some(Some(self.point()));
            }
        }
    }

    /// The row of the least ratio, ties by the rows of the inverse; the covering variable first.
    fn leaving(&self, entering: usize) -> Option<Option<usize>> {
        let right = 2 * self.order + 1;
        let mut best: Option<usize> = None;
        for i in 0..self.order {
            let entry = &self.rows[i][entering];
            if entry.sign() != Ordering::Greater {
                continue;
            }
            let Some(k) = best else {
                best = Some(i);
                continue;
            };
            let other = &self.rows[k][entering];
            let mut order = T::compare(&self.rows[i][right], other, &self.rows[k][right], entry)?;
            if order == Ordering::Equal && self.basis[k] == 2 * self.order {
                continue;
            }
            if order == Ordering::Equal && self.basis[i] == 2 * self.order {
                order = Ordering::Less;
            }
            for j in 0..self.order {
                if order != Ordering::Equal {
                    break;
                }
                order = T::compare(&self.rows[i][j], other, &self.rows[k][j], entry)?;
            }
            if order == Ordering::Less {
                best = Some(i);
            }
        }
        Some(best)
    }

    fn pivot(&mut self, at: usize, column: usize) -> Option<()> {
        let pivot = std::mem::take(&mut self.rows[at]);
        for row in self.rows.iter_mut().filter(|row| !row.is_empty()) {
            let factor = row[column].clone();
            for (entry, other) in row.iter_mut().zip(&pivot) {
                if entry.sign() == Ordering::Equal
                    && (factor.sign() == Ordering::Equal || other.sign() == Ordering::Equal)
                {
                    continue;
                }
                *entry = T::cross(entry, &pivot[column], &factor, other, &self.divisor)?;
            }
        }
        self.divisor = pivot[column].clone();
        self.rows[at] = pivot;
        Some(())
    }

    fn point(&self) -> Vec<BigRational> {
        let mut x = vec![BigRational::zero(); self.columns];
        for (row, &basic) in self.rows.iter().zip(&self.basis) {
            if (self.order..self.order + self.columns).contains(&basic) {
                let value = row[2 * self.order + 1].wide();
                x[basic - self.order] = BigRational::new(value, self.divisor.wide());
            }
        }
        x
    }
}

/// The nearest double.
pub(crate) fn double(value: &BigRational) -> f64 {
    let nearest = value.to_f64();
    nearest.unwrap_or(if value.is_negative() { f64::NEG_INFINITY } else { f64::INFINITY })
}

#[test]
fn answers_by_hand() {
    let rational = |n: i128, d: i128| BigRational::new(BigInt::from(n), BigInt::from(d));
    // min x^2 - 2 x y + 2 y^2 - 2 y over x + y >= 4.
    let program = Whole {
        curvature: vec![vec![2, -2], vec![-2, 4]],
        cost: vec![0, -2],
        rows: vec![(vec![1, 1], 4)],
    };
    let point = vec![rational(11, 5), rational(9, 5)];
    assert_eq!(program.solve(), Answer::Least(rational(-1, 5), point));
    // max x over 3 x <= 2; over x >= 1; over x >= 1 and x <= 0.
    let program = |rows: &[(i128, i128)]| Whole {
        curvature: vec![vec![0]],
        cost: vec![-1],
        rows: rows.iter().map(|&(a, b)| (vec![a], b)).collect(),
    };
    assert_eq!(program(&[(-3, -2)]).solve(), Answer::Least(rational(-2, 3), vec![rational(2, 3)]));
    assert_eq!(program(&[(1, 1)]).solve(), Answer::Unbounded);
    assert_eq!(program(&[(1, 1), (-1, 0)]).solve(), Answer::Infeasible);
    // The same with numbers that do not fit into 128 bits after a few pivots.
    let large = 1_i128 << 90;
    let wide = Whole {
        curvature: vec![vec![0; 3]; 3],
        cost: vec![1, 1, 1],
        rows: vec![
            (vec![large, 1, 0], large),
            (vec![1, large, 1], large),
            (vec![0, 1, large], large),
        ],
    };
    let Answer::Least(value, _) = wide.solve() else { panic!("it has an optimum") };
    assert!((double(&value) - 3.0).abs() < 1e-9);
}
