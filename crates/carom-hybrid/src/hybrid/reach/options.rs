//! Options of reach sets.

use std::sync::Arc;

use super::words::Words;
use crate::error::{Error, check_finite, check_length};
#[cfg(doc)]
use crate::hybrid::system::HybridSystem;
use crate::setters::setters;
use crate::tolerance;

/// Options of reach sets.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SetOptions {
    /// Number of layers: states with different numbers of events so far (or to come) are in
    /// different layers, and states with this many or more events share the last layer; `0..=64`,
    /// default 3. A largest number of events of the system takes its place, up to 64.
    pub events: usize,
    /// Number of vertices of a polygon beyond which short edges are merged outward; at least 8,
    /// default 512.
    pub vertices: usize,
    /// The sets contain every plan that misses its start, its goal, its limits, guards and input
    /// ranges by at most this, in SI units; for numbers above 1000, times a thousandth of them, and
    /// for domains that are not of an ordinary size (some 0.02 to 2e6) in a unit of their size.
    /// From 0 to 1, default [`tolerance::REACH`].
    pub margin: f64,
    /// Number of sets of one sample: states that differ in their modes (of choices with memory),
    /// dwell times or numbers of events are in different sets, as long as there are no more than
    /// this; beyond that they share sets. At least 1, default 256.
    pub layers: usize,
    /// Whether each next state may be disturbed by the system's
    /// [disturbance](HybridSystem::disturbance). Then the sets are *robust*: forward sets hold
    /// every state to which any disturbance can lead, and backward sets every state from which some
    /// disturbance can lead to the goal. Undisturbed runs are always included; default no, as in
    /// programs.
    pub disturbance: bool,
    /// Template directions of sets with other than two states, in addition to the axes, the
    /// diagonals of small blocks and the normals of the limits; one coefficient per state.
    pub directions: Vec<Vec<f64>>,
    /// Groups of choices of which at most one has an event in a step, by their numbers. Programs
    /// must say so as well.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) exclusive: Vec<Vec<usize>>,
    /// The names of states, inputs and transitions in explanations.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(crate) words: Arc<Words>,
}

impl Default for SetOptions {
    fn default() -> Self {
        SetOptions {
            events: 3,
            vertices: 512,
            margin: tolerance::REACH,
            layers: 256,
            disturbance: false,
            directions: Vec::new(),
            exclusive: Vec::new(),
            words: Arc::default(),
        }
    }
}

impl SetOptions {
    setters! {
        /// Sets the number of events that are distinguished.
        with_events(events: usize) => events = events;
        /// Sets the number of vertices beyond which polygons are simplified.
        with_vertices(vertices: usize) => vertices = vertices;
        /// Sets the margin.
        with_margin(margin: f64) => margin = margin;
        /// Sets the number of sets of one sample.
        with_layers(layers: usize) => layers = layers;
        /// Sets whether next states are disturbed, for robust sets.
        with_disturbance(wanted: bool) => disturbance = wanted;
    }

    /// Adds a template direction.
    #[must_use]
    pub fn with_direction(mut self, direction: impl Into<Vec<f64>>) -> Self {
        self.directions.push(direction.into());
        self
    }

    pub(super) fn check(&self, states: usize) -> Result<(), Error> {
        let (events, vertices) = (self.events as f64, self.vertices as f64);
        let ranges = [
            ("number of events", events, 0.0..=64.0),
            ("number of vertices", vertices, 8.0..=f64::INFINITY),
            ("number of layers", self.layers as f64, 1.0..=f64::INFINITY),
            ("margin", self.margin, 0.0..=1.0),
        ];
        let wrong = ranges.into_iter().find(|(_, value, range)| !range.contains(value));
        if let Some((what, value, range)) = wrong {
            return Err(Error::out_of_range(format!("the {what} of reach sets"), value, range));
        }
        for direction in &self.directions {
            check_length("a template direction", direction.len(), states)?;
            check_finite("a template direction", "an entry", direction.iter().copied())?;
        }
        Ok(())
    }
}
