//! The change of velocities by a hit: restitution along the normal, and the law along the surface.
//!
//! A law is linear in the relative velocity `r` of the centres and, in the plane, in the speed `s`
//! at which spin moves the surfaces of the bodies past each other, so that the touching points
//! slide with `u = t . r + s`, for the normal turned left, t. An impulse along the surface changes
//! u by `k` times as much as `t . r`, where k is the
//! [mobility](super::contact::ContactPair::mobility), 1 without spin.

use std::f64::consts::PI;

use super::contact::ContactFace;
use super::geometry::{around, tangents};
use super::surface::Tangential;

/// A linear function of the relative velocity, and after its entries of s, that must be at most 0:
/// its factors, and a name.
#[derive(Clone)]
pub(super) struct Guard {
    pub(super) name: &'static str,
    pub(super) factors: Vec<f64>,
    /// The same of the relative velocity at the start of the step; 0 in mirrored hits.
    pub(super) at_start: Vec<f64>,
}

/// A law of a hit: the change `(M - 1) r` of the relative velocity r, and when it applies. In the
/// plane, rows have an entry for s after those of r.
#[derive(Clone)]
pub(super) struct Law {
    pub(super) name: String,
    /// M - 1 without a rebound, by rows.
    pub(super) change: Vec<Vec<f64>>,
    /// The part that the rebound adds to it: `-e n n'`.
    pub(super) rebound: Vec<Vec<f64>>,
    /// The factors of the relative velocity at the start of the step in the change; 0 in mirrored
    /// hits.
    pub(super) at_start: Vec<Vec<f64>>,
    /// In the plane, the change along the normal turned left, of which spins take their part; and
    /// its factors of the relative velocity at the start of the step.
    pub(super) along: [Vec<f64>; 2],
    pub(super) guards: Vec<Guard>,
    /// Functions of which the length of the first ones is at most the last one; empty if there is
    /// no cone.
    pub(super) cone: Vec<Guard>,
}

impl Law {
    /// A hit without friction.
    fn smooth(n: &[f64], e: f64, start: f64) -> Self {
        Law {
            name: "hit".into(),
            change: rebound(n, 1.0),
            rebound: rebound(n, e),
            at_start: rebound(n, start),
            along: [vec![0.0; n.len() + 1], vec![0.0; n.len() + 1]],
            guards: Vec::new(),
            cone: Vec::new(),
        }
    }

    /// Adds `factor b . (r, s)` along a direction d of the surface, which is `sign` times the
    /// normal turned left in the plane.
    fn add(&mut self, factor: f64, (d, sign): (&[f64], f64), b: &[f64]) {
        add(&mut self.change, factor, d, b);
        self.along[0].iter_mut().zip(b).for_each(|(a, b)| *a += sign * factor * b);
    }

    /// As [`add`](Self::add), of the velocity at the start of the step.
    fn add_at_start(&mut self, factor: f64, (d, sign): (&[f64], f64), b: &[f64]) {
        add(&mut self.at_start, factor, d, b);
        self.along[1].iter_mut().zip(b).for_each(|(a, b)| *a += sign * factor * b);
    }
}

/// `-factor n n'`, as rows, with an entry for s.
pub(super) fn rebound(n: &[f64], factor: f64) -> Vec<Vec<f64>> {
    let row = |a: &f64| n.iter().map(|b| -factor * a * b).chain([0.0]).collect();
    n.iter().map(row).collect()
}

/// Adds `factor a b'`.
fn add(change: &mut [Vec<f64>], factor: f64, a: &[f64], b: &[f64]) {
    for (row, a) in change.iter_mut().zip(a) {
        row.iter_mut().zip(b).for_each(|(c, b)| *c += factor * a * b);
    }
}

/// A direction with a factor of s.
fn with_spin(direction: &[f64], factor: f64) -> Vec<f64> {
    direction.iter().copied().chain([factor]).collect()
}

/// The laws of a face: one, or those of sticking and slipping. The velocity along the normal
/// changes by `1 + e` times the approach at the end of the step and `start` times that at its
/// start.
pub(super) fn laws(face: &ContactFace, mobility: f64, e: f64, start: f64) -> Vec<Law> {
    let (n, end) = (&face.normal, 1.0 + e);
    let smooth = || Law::smooth(n, e, start);
    let tangents = tangents(n);
    let in_plane = tangents.len() == 1;
    let slide = |tangent: &[f64]| with_spin(tangent, f64::from(u8::from(in_plane)));
    match face.surface.tangential {
        _ if tangents.is_empty() || face.surface.is_frictionless() => vec![smooth()],
        Tangential::Frictionless => vec![smooth()],
        Tangential::Linear { keep, from_normal } => {
            let mut law = smooth();
            for tangent in &tangents {
                law.add((keep - 1.0) / mobility, (tangent, 1.0), &slide(tangent));
                // The impact speed is -n . r.
                law.add(-from_normal / mobility, (tangent, 1.0), n);
            }
            vec![law]
        }
        Tangential::Coulomb { coefficient, directions } => {
            // The pyramid lies inside the cone.
            let inside = if in_plane { 1.0 } else { (PI / directions as f64).cos() };
            let bound = coefficient * inside;
            let ways: Vec<Vec<f64>> = around(n, directions).collect();
            let side = |k: usize| if k == 0 { 1.0 } else { -1.0 };
            let mut stick = Law { name: "stick".into(), ..smooth() };
            for tangent in &tangents {
                stick.add(-1.0 / mobility, (tangent, 1.0), &slide(tangent));
            }
            // d . u <= k bound j, where the normal impulse is j = -end n . r - start n . r(start).
            let exceeds = |name: &'static str, way: usize, sign: f64| -> Guard {
                let most = bound * mobility;
                let along = ways[way].iter().zip(n).map(|(d, n)| sign * (d + most * end * n));
                let spin = if in_plane { sign * side(way) } else { 0.0 };
                let at_start = n.iter().map(|n| sign * most * start * n).collect();
                Guard { name, factors: along.chain([spin]).collect(), at_start }
            };
            match in_plane {
                true => stick.guards = [0, 1].map(|way| exceeds("sticks", way, 1.0)).into(),
                // In space the cone itself.
                false => {
                    let along = |d: &Vec<f64>| Guard {
                        name: "sticks",
                        factors: d.clone(),
                        at_start: vec![0.0; n.len()],
                    };
                    let most = |share: f64| n.iter().map(|n| -coefficient * share * n).collect();
                    let bound = Guard { name: "sticks", factors: most(end), at_start: most(start) };
                    stick.cone = tangents.iter().map(along).chain([bound]).collect();
                }
            }
            let mut laws = vec![stick];
            for (k, d) in ways.iter().enumerate() {
                let name = match (in_plane, k) {
                    (true, 0) => "slip left".to_owned(),
                    (true, _) => "slip right".to_owned(),
                    (false, k) => format!("slip {k} at"),
                };
                let mut law = Law { name, ..smooth() };
                // The impulse -bound j d.
                law.add(bound * end, (d, side(k)), n);
                law.add_at_start(bound * start, (d, side(k)), n);
                law.guards.push(exceeds("slips", k, -1.0));
                if !in_plane {
                    // Within the sector: nearer to d than to its neighbours.
                    for other in [k + 1, k + ways.len() - 1] {
                        let other = &ways[other % ways.len()];
                        let factors = other.iter().zip(d).map(|(o, d)| o - d).collect();
                        let at_start = vec![0.0; n.len()];
                        law.guards.push(Guard { name: "sector", factors, at_start });
                    }
                }
                laws.push(law);
            }
            laws
        }
    }
}
