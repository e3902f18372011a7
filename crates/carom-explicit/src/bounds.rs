//! Bounds over a cell at multipliers that are interpolated between its corners.
//!
//! With `x = sum l_v x_v` and multipliers likewise, the cost of the plan and the dual bound of a
//! part of the integers are quadratic forms of the barycentric coordinates `l`. Their coefficients
//! for pairs of corners bound the forms over the cell, because the products `l_v l_w` are weights:
//! no mean of coefficients is larger than the largest one (the Bernstein form of a polynomial over
//! a simplex). A part is closed if each coefficient of `cost - bound` is at most the loss.
//!
//! The bound at a state `t`, for any `z` and multipliers `y` of rows, linearises the cost at `z`:
//!
//! `c(t) - 1/2 z'Pz - sum max(y u, y l) + t'A_t'y + min over the box (Pz + q + P_xt t + A_x'y)'x`.

use std::sync::Arc;

use crate::form::ParametricForm;

/// Multipliers of rows and the point at which the cost is linearised; or, for a proof that there is
/// no point, multipliers alone.
#[derive(Debug, Clone)]
pub(crate) struct Evidence {
    pub(crate) is_ray: bool,
    pub(crate) z: Vec<f64>,
    pub(crate) y: Vec<f64>,
    /// `P z`, without the axes.
    pz: Vec<f64>,
    /// `P z + q + A'y`, or `A'y` for a ray. For axes, `A'y` alone.
    residual: Vec<f64>,
    /// `sum max(y_i u_i, y_i l_i)`.
    limits: f64,
}

impl Evidence {
    /// Evidence for a bound. `z` counts for columns that are no axes.
    pub(crate) fn bound(form: &ParametricForm, mut z: Vec<f64>, y: Vec<f64>) -> Self {
        for (j, z) in z.iter_mut().enumerate() {
            *z = if form.is_axis[j] { 0.0 } else { z.clamp(form.lower[j], form.upper[j]) };
        }
        let mut pz = form.times_quadratic(&z);
        form.axes.iter().for_each(|&j| pz[j] = 0.0);
        let own = |(j, (a, q)): (usize, (&f64, &f64))| if form.is_axis[j] { 0.0 } else { a + q };
        let residual = pz.iter().zip(&form.linear).enumerate().map(own).collect();
        Evidence { is_ray: false, z, y, pz, residual, limits: 0.0 }.with_rows(form)
    }

    /// Evidence that there is no point, scaled to a largest multiplier of 1.
    pub(crate) fn ray(form: &ParametricForm, y: &[f64]) -> Self {
        let zero = vec![0.0; form.columns()];
        let largest = y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
        let y = y.iter().map(|y| if largest > 0.0 { y / largest } else { 0.0 }).collect();
        let (z, pz, residual) = (zero.clone(), zero.clone(), zero);
        Evidence { is_ray: true, z, y, pz, residual, limits: 0.0 }.with_rows(form)
    }

    fn with_rows(mut self, form: &ParametricForm) -> Self {
        for (row, y) in form.rows.iter().zip(&mut self.y) {
            let limit = if *y > 0.0 { row.upper } else { row.lower };
            match limit.is_finite() && *y != 0.0 {
                true => self.limits += *y * limit,
                false => *y = 0.0,
            }
        }
        form.add_transposed(&self.y, &mut self.residual);
        self
    }

    /// The part of the bound that is affine along the cell, at a corner.
    fn base(&self, form: &ParametricForm, place: &CornerPlace, [lower, upper]: [&[f64]; 2]) -> f64 {
        let mut sum = -self.limits;
        for j in (0..form.columns()).filter(|j| !form.is_axis[*j]) {
            let r = self.residual[j] + if self.is_ray { 0.0 } else { place.tilt[j] };
            sum += (r * lower[j]).min(r * upper[j]);
        }
        sum
    }

    fn along(&self, form: &ParametricForm, at: &[f64]) -> f64 {
        form.axes.iter().zip(at).map(|(&j, t)| self.residual[j] * t).sum()
    }

    /// The bound at a corner, or how far a ray is above 0 there.
    pub(crate) fn value(
        &self,
        form: &ParametricForm,
        place: &CornerPlace,
        sides: [&[f64]; 2],
    ) -> f64 {
        let own = self.base(form, place, sides) + self.along(form, &place.at);
        if self.is_ray {
            own
        } else {
            own + place.cost - form.lacked - 0.5 * dot(&self.z, &self.pz)
        }
    }
}

/// The numbers of a corner that all evidence shares.
#[derive(Debug, Clone)]
pub(crate) struct CornerPlace {
    /// The state, an entry an axis.
    pub(crate) at: Vec<f64>,
    /// `P_xt t`, by column.
    tilt: Vec<f64>,
    /// `1/2 t'P_tt t + q_t't`, and the offset of the cost.
    cost: f64,
    /// `P_tt t`, an entry an axis.
    curved: Vec<f64>,
    /// `q_t't`.
    linear: f64,
}

impl CornerPlace {
    pub(crate) fn new(form: &ParametricForm, at: Vec<f64>) -> Self {
        let mut t = vec![0.0; form.columns()];
        form.axes.iter().zip(&at).for_each(|(&j, &value)| t[j] = value);
        let mut tilt = form.times_quadratic(&t);
        let curved: Vec<f64> = form.axes.iter().map(|&j| tilt[j]).collect();
        form.axes.iter().for_each(|&j| tilt[j] = 0.0);
        let linear = form.linear_cost(&t);
        let cost = 0.5 * dot(&curved, &at) + linear + form.offset;
        CornerPlace { at, tilt, cost, curved, linear }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// A quadratic form over the corners of a cell: a coefficient for each pair, in the order (0, 0),
/// (1, 0), (1, 1), (2, 0), ...
pub(crate) type Coefficients = Vec<f64>;

fn pairs(n: usize, mut entry: impl FnMut(usize, usize) -> f64) -> Coefficients {
    (0..n).flat_map(|v| (0..=v).map(move |w| (v, w))).map(|(v, w)| entry(v, w)).collect()
}

/// The cost of interpolated points, all columns.
pub(crate) fn cost(form: &ParametricForm, points: &[&[f64]]) -> Coefficients {
    let products: Vec<Vec<f64>> = points.iter().map(|x| form.times_quadratic(x)).collect();
    let linear: Vec<f64> = points.iter().map(|x| form.linear_cost(x)).collect();
    pairs(points.len(), |v, w| {
        0.5 * dot(points[v], &products[w]) + 0.5 * (linear[v] + linear[w]) + form.offset
    })
}

/// The dual bound at interpolated evidence, or how far rays are above 0.
pub(crate) fn bound(
    form: &ParametricForm,
    evidence: &[Arc<Evidence>],
    places: &[&CornerPlace],
    sides: [&[f64]; 2],
) -> Coefficients {
    let base = |(e, place): (&Arc<Evidence>, &&CornerPlace)| e.base(form, place, sides);
    let base: Vec<f64> = evidence.iter().zip(places).map(base).collect();
    pairs(evidence.len(), |v, w| {
        let (e, f) = (&evidence[v], &evidence[w]);
        let along = e.along(form, &places[w].at) + f.along(form, &places[v].at);
        let own = 0.5 * (base[v] + base[w] + along);
        if e.is_ray {
            return own;
        }
        let state = dot(&places[v].curved, &places[w].at) + places[v].linear + places[w].linear;
        own - 0.5 * dot(&e.z, &f.pz) + 0.5 * state + form.offset - form.lacked
    })
}
