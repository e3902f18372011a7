//! The families of programs that grow.

use carom::prelude::*;

use crate::instances::generators::{boxes, boxes_among};
use crate::instances::random_miqp::Random;
use crate::instances::unit_commitment::unit_commitment;
use crate::robots::robots;

/// Programs of one kind in several sizes.
pub(crate) struct Family {
    pub(crate) name: &'static str,
    /// What its size counts.
    pub(crate) size: &'static str,
    pub(crate) heading: &'static str,
    sizes: &'static [usize],
    /// Further sizes, each of which takes longer.
    large: &'static [usize],
    program: fn(usize) -> Result<Model, Error>,
}

impl Family {
    pub(crate) fn named(name: &str) -> Option<&'static Family> {
        FAMILIES.iter().find(|family| family.name == name)
    }

    pub(crate) fn sizes(&self, with_large: bool) -> impl Iterator<Item = usize> {
        let large = if with_large { self.large } else { &[] };
        self.sizes.iter().chain(large).copied()
    }

    pub(crate) fn model(&self, size: usize) -> Result<Model, Error> {
        (self.program)(size)
    }
}

/// All families, in the order of the picture.
pub(crate) const FAMILIES: [Family; 4] = [
    Family {
        name: "units",
        size: "hours x units",
        heading: "Unit commitment",
        sizes: &[48, 96, 192, 384, 768, 1536],
        large: &[3072, 6144],
        program: hours_and_units,
    },
    Family {
        name: "horizon",
        size: "steps",
        heading: "A flight among four boxes",
        sizes: &[20, 40, 80, 160],
        large: &[320],
        program: |steps| Ok(boxes(steps, 4, false)),
    },
    Family {
        name: "robots",
        size: "robots",
        heading: "Robots of one mission",
        sizes: &[2, 4, 7, 10, 14],
        large: &[20, 28],
        program: |count| Ok(robots(count)?.0.model().clone()),
    },
    Family {
        name: "obstacles",
        size: "obstacles",
        heading: "A flight of 30 steps among obstacles",
        sizes: &[2, 4, 8, 16, 32, 64],
        large: &[128],
        program: |count| Ok(boxes_among(30, &obstacles(count), false)),
    },
];

/// Hours times units: 12 hours of up to 16 units, then 24 hours.
fn hours_and_units(size: usize) -> Result<Model, Error> {
    let hours = if size <= 192 { 12 } else { 24 };
    unit_commitment(hours, size / hours)
}

/// Boxes that cover an eighth of a room of 10 m by 10 m, one in each of as many cells of a grid, and
/// none in the corners of start and goal.
fn obstacles(count: usize) -> Vec<[f64; 4]> {
    let mut random = Random(count as u64);
    let cells = ((count + 2) as f64).sqrt().ceil() as usize;
    let (cell, side) = (10.0 / cells as f64, (12.5 / count as f64).sqrt());
    let mut free: Vec<usize> = (1..cells * cells - 1).collect();
    let mut boxes = Vec::new();
    for _ in 0..count {
        let place = free.swap_remove((random.uniform() * free.len() as f64) as usize);
        let mut corner = |at: usize| cell * at as f64 + random.uniform() * (cell - side).max(0.0);
        let (left, below) = (corner(place % cells), corner(place / cells));
        boxes.push([left, left + side, below, below + side]);
    }
    boxes
}
