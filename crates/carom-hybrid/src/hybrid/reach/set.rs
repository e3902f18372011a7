//! Sets of states: support, containment, intersection, bounding box, outline.

use std::sync::Arc;

use super::compiled::{Block, Compiled, Cut};
use super::rounding::EPSILON;
use super::shape::Shape;
use crate::error::{Error, ErrorKind, check_length};
use crate::hybrid::system::{Region, check_ends};
use crate::interval::Interval;

/// A set of states: the product of its blocks' sets.
///
/// The set is closed and contains every state of the exact set, and possibly a little more; see
/// [`SetOptions`](super::SetOptions) for the margin, and the module page for what is exact.
#[derive(Debug, Clone)]
pub struct ReachSet {
    pub(super) system: Arc<Compiled>,
    /// One per block, none of them empty.
    pub(super) shapes: Vec<Shape>,
    pub(super) label: Label,
}

/// The sets of one sample, by node and number of events; the last layer of a node is "this many or
/// more".
pub(super) type Layers = Vec<Option<ReachSet>>;

/// Which states a set holds.
#[derive(Debug, Clone, Default)]
pub(super) struct Label {
    pub(super) events: usize,
    /// Names of choices with memory and of their modes.
    pub(super) modes: Option<Arc<Vec<(String, String)>>>,
}

/// The limit that emptied a set: the first one that no state satisfies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Emptied {
    pub(super) block: usize,
    pub(super) place: Place,
    /// The smallest value of the limit's left side.
    pub(super) nearest: f64,
}

/// Which list of limits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Place {
    Limit(usize),
    Guard(usize, usize),
    Prediction(usize, usize),
    /// A guard on inputs of a joint transition.
    Joint(usize, usize),
    /// A half-space of the start or the goal.
    End(usize),
    /// The shape of the set itself.
    Shape,
}

impl ReachSet {
    /// A region within the system's limits, or the limit that excludes it.
    pub(super) fn from_region(
        system: &Arc<Compiled>,
        region: &Region,
        sizes: &[f64],
        is_start: bool,
    ) -> Result<Self, Emptied> {
        let (ranges, margins) = (closed(&system.states, region), &system.margins);
        let wide = |i: &usize| {
            let range = ranges[*i];
            let margin = match is_start {
                true => margins.of_start(range),
                false => margins.of_state(*i, range.magnitude(), 0.0),
            };
            (range.lower - margin, range.upper + margin)
        };
        let mut shapes = Vec::with_capacity(system.blocks.len());
        for (b, block) in system.blocks.iter().enumerate() {
            let (low, high): (Vec<f64>, Vec<f64>) = block.states.iter().map(wide).unzip();
            let mut shape = block.domain.boxed(&low, &high);
            cut(&mut shape, &block.limits, b, Place::Limit)?;
            shapes.push(shape);
        }
        let mut set = ReachSet { system: Arc::clone(system), shapes, label: Label::default() };
        for (k, halfspace) in region.halfspaces.iter().enumerate() {
            let terms = halfspace.normal.iter().zip(sizes).map(|(n, size)| (n * size).abs());
            let given = halfspace.limit_at(0);
            let largest = terms.fold(0.0, f64::max);
            let limit = given + margins.of_condition(&halfspace.normal, &[], largest, given);
            set.keep_below(&halfspace.normal, limit, Place::End(k))?;
        }
        Ok(set)
    }

    /// Cuts with a half-space, whose part in other blocks than the one that is cut has its smallest
    /// value.
    fn keep_below(&mut self, normal: &[f64], limit: f64, place: Place) -> Result<(), Emptied> {
        if limit == f64::INFINITY {
            return Ok(());
        }
        let local =
            |block: &Block| -> Vec<f64> { block.states.iter().map(|&i| normal[i]).collect() };
        let system = Arc::clone(&self.system);
        let normals: Vec<Vec<f64>> = system.blocks.iter().map(local).collect();
        let lowest: Vec<f64> =
            self.shapes.iter().zip(&normals).map(|(shape, normal)| shape.lowest(normal)).collect();
        for (b, shape) in self.shapes.iter_mut().enumerate() {
            let touched = normals[b].iter().any(|&n| n != 0.0);
            let others = || lowest.iter().enumerate().filter(|(other, _)| *other != b);
            let sum: f64 = others().map(|(_, low)| low).sum();
            let size: f64 = others().map(|(_, low)| low.abs()).sum();
            let limit = limit - sum + 8.0 * EPSILON * (size + limit.abs());
            if touched && let Some(nearest) = shape.clip(&normals[b], limit) {
                return Err(Emptied { block: b, place, nearest: nearest + sum });
            }
            shape.settle();
            if shape.is_empty() {
                return Err(Emptied { block: b, place: Place::Shape, nearest: f64::NAN });
            }
        }
        Ok(())
    }

    /// The number of events on the way from the start to these states, or, for a backward set, on
    /// the way to the goal. If it is the largest number that is told apart, there may be more.
    pub fn events(&self) -> usize {
        self.label.events
    }

    /// The choices with memory whose mode is the same in all states of the set, each with that
    /// mode.
    pub fn modes(&self) -> &[(String, String)] {
        self.label.modes.as_deref().map_or(&[], Vec::as_slice)
    }

    /// Restricts one state to a range; `false` if the set becomes empty.
    pub(super) fn keep(&mut self, state: usize, range: Interval) -> bool {
        for (block, shape) in self.system.blocks.iter().zip(&mut self.shapes) {
            let Some(k) = block.states.iter().position(|&i| i == state) else { continue };
            for (sign, limit) in [(1.0, range.upper), (-1.0, -range.lower)] {
                let mut normal = vec![0.0; block.states.len()];
                normal[k] = sign;
                if shape.clip(&normal, limit).is_some() {
                    return false;
                }
            }
        }
        true
    }

    /// Largest value of `direction . state` over the set, rounded up, in the product's unit.
    ///
    /// # Arguments
    ///
    /// * `direction`: one coefficient per state.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`].
    pub fn support(&self, direction: &[f64]) -> Result<f64, Error> {
        self.check_length("the direction", direction.len())?;
        let coordinates = &self.system.coordinates;
        let own = coordinates.factors(direction);
        let blocks = self.system.blocks.iter().zip(&self.shapes);
        let support = blocks
            .map(|(block, shape)| {
                let local: Vec<f64> = block.states.iter().map(|&i| own[i]).collect();
                shape.support(&local)
            })
            .fold(0.0, crate::interval::add_up);
        Ok(match coordinates.shifted(direction, 0.0) {
            0.0 => support,
            shift => crate::interval::add_up(support, shift.next_up()),
        })
    }

    /// Whether a state lies in the set. States outside the exact set but within its margin may
    /// count as members.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Length`]; [`ErrorKind::NotFinite`] for a state that is not finite.
    pub fn contains(&self, state: &[f64]) -> Result<bool, Error> {
        self.check_length("the state", state.len())?;
        for ((name, _), &value) in self.system.states.iter().zip(state) {
            check_ends(name, Interval::point(value))?;
        }
        let state = self.system.coordinates.inward(state);
        Ok(self.system.blocks.iter().zip(&self.shapes).all(|(block, shape)| {
            let point: Vec<f64> = block.states.iter().map(|&i| state[i]).collect();
            shape.separation(&shape.boxed(&point, &point)).is_none()
        }))
    }

    /// Whether the sets may have a common state; `false` is a proof that they have none.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Shape`] for sets of systems with different blocks.
    pub fn intersects(&self, other: &ReachSet) -> Result<bool, Error> {
        let blocks = |set: &ReachSet| -> Vec<Vec<usize>> {
            set.system.blocks.iter().map(|block| block.states.clone()).collect()
        };
        let coordinates = |set: &ReachSet| Arc::clone(&set.system.coordinates);
        if blocks(self) != blocks(other) || coordinates(self) != coordinates(other) {
            let (rows, columns) = (other.system.states.len(), other.system.blocks.len());
            let expected = "the states and blocks of the first set".into();
            return Err(ErrorKind::Shape { what: "the second set", rows, columns, expected }.into());
        }
        Ok(self.meets(other))
    }

    /// Same as [`intersects`](ReachSet::intersects), for sets of one system.
    pub(super) fn meets(&self, other: &ReachSet) -> bool {
        self.shapes.iter().zip(&other.shapes).all(|(a, b)| a.separation(b).is_none())
    }

    /// Whether every state of this set certainly lies in another one of the same system.
    pub(super) fn lies_in(&self, other: &ReachSet) -> bool {
        self.shapes.iter().zip(&other.shapes).all(|(inner, outer)| match (inner, outer) {
            (Shape::Planar(inner), Shape::Planar(outer)) => outer.covers(inner),
            (Shape::Template(inner), Shape::Template(outer)) => {
                inner.limits.iter().zip(&outer.limits).all(|(a, b)| a <= b)
            }
            _ => false,
        })
    }

    /// The smallest box around the set: one interval per state, rounded outward.
    pub fn bounding_box(&self) -> Vec<Interval> {
        self.system.stated_ranges(&self.own_box())
    }

    /// The same in the coordinates of the set.
    pub(super) fn own_box(&self) -> Vec<Interval> {
        bounding_box(&self.system, &self.shapes)
    }

    /// How far rounding may have enlarged the set along each state, in the state's unit. This is
    /// known for states in blocks of two; template limits already include their rounding.
    pub fn margin(&self) -> Vec<f64> {
        let mut margin = vec![0.0; self.system.states.len()];
        for (block, shape) in self.system.blocks.iter().zip(&self.shapes) {
            if let Shape::Planar(polygon) = shape {
                for (k, &state) in block.states.iter().enumerate() {
                    let scale = self.system.coordinates.state(state).scale;
                    margin[state] = scale * polygon.margin()[k];
                }
            }
        }
        margin
    }

    /// The corners of the set's projection on two states, counter-clockwise, in the states' units:
    /// the exact polygon if the two states form a block, otherwise their bounding box. One corner
    /// is a point, two are a segment.
    ///
    /// # Errors
    ///
    /// [`ErrorKind::OutOfRange`] for states that do not exist or are the same.
    pub fn outline(&self, first: usize, second: usize) -> Result<Vec<[f64; 2]>, Error> {
        let n = self.system.states.len();
        for state in [first, second] {
            if state >= n || first == second {
                let range = format!("two different ones below {n}");
                let (what, value) = ("the number of a state to draw", state as f64);
                return Err(Error::out_of_range_in_words(what, value, ..n as f64, range));
            }
        }
        for (block, shape) in self.system.blocks.iter().zip(&self.shapes) {
            if let Shape::Planar(polygon) = shape {
                let measures = [first, second].map(|state| self.system.coordinates.state(state));
                let stated = |v: [f64; 2]| [measures[0].outward(v[0]), measures[1].outward(v[1])];
                if block.states == [first, second] {
                    return Ok(polygon.vertices().iter().map(|v| stated(*v)).collect());
                }
                if block.states == [second, first] {
                    let swapped = polygon.vertices().iter().rev().map(|v| stated([v[1], v[0]]));
                    return Ok(swapped.collect());
                }
            }
        }
        let ranges = self.bounding_box();
        let (x, y) = (ranges[first], ranges[second]);
        Ok(vec![[x.lower, y.lower], [x.upper, y.lower], [x.upper, y.upper], [x.lower, y.upper]])
    }

    /// The smallest set of its kind that contains both.
    pub(super) fn join(&self, other: &ReachSet) -> ReachSet {
        let shapes = self.shapes.iter().zip(&other.shapes).map(|(a, b)| a.join(b)).collect();
        ReachSet { system: Arc::clone(&self.system), shapes, label: self.label.clone() }
    }

    pub(super) fn simplify(&mut self, most: usize) {
        self.shapes.iter_mut().for_each(|shape| shape.simplify(most));
    }

    fn check_length(&self, what: &'static str, found: usize) -> Result<(), Error> {
        check_length(what, found, self.system.states.len())
    }
}

impl Compiled {
    /// Ranges of all states in the user's units.
    pub(super) fn stated_ranges(&self, own: &[Interval]) -> Vec<Interval> {
        let ranges = own.iter().enumerate();
        ranges.map(|(i, range)| self.coordinates.state(i).outward_range(*range)).collect()
    }
}

/// The smallest box around a product of shapes.
pub(super) fn bounding_box(system: &Compiled, shapes: &[Shape]) -> Vec<Interval> {
    let mut ranges = vec![Interval::REALS; system.states.len()];
    for (block, shape) in system.blocks.iter().zip(shapes) {
        for (k, &state) in block.states.iter().enumerate() {
            let mut axis = vec![0.0; block.states.len()];
            axis[k] = 1.0;
            let upper = shape.support(&axis);
            axis[k] = -1.0;
            ranges[state] = Interval::new(-shape.support(&axis), upper);
        }
    }
    ranges
}

/// Applies limits one by one.
pub(super) fn cut(
    shape: &mut Shape,
    cuts: &[Cut],
    block: usize,
    place: impl Fn(usize) -> Place,
) -> Result<(), Emptied> {
    for (k, cut) in cuts.iter().enumerate() {
        if let Some(nearest) = shape.clip(&cut.normal, cut.limit) {
            return Err(Emptied { block, place: place(k), nearest });
        }
    }
    Ok(())
}

/// The ranges of a region, with the ends of the domains instead of infinite ones.
pub(super) fn closed(states: &[(String, Interval)], region: &Region) -> Vec<Interval> {
    let ends = states.iter().zip(&region.ranges).map(|((_, domain), range)| {
        let lower = if range.lower.is_finite() { range.lower } else { domain.lower };
        let upper = if range.upper.is_finite() { range.upper } else { domain.upper };
        Interval::new(lower.min(upper), upper.max(lower))
    });
    ends.collect()
}
