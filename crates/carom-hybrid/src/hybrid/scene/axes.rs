//! Axes by their names, and regions of positions and velocities along them.

use crate::error::Error;
use crate::hybrid::system::{HybridSystem, Region, State, SystemRow};
use crate::interval::Interval;

/// The names of the axes.
pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

/// The region of positions and velocities along some axes where rows of them hold.
pub(super) fn region_where<R: IntoIterator<Item: Into<SystemRow>>>(
    axes: usize,
    rows: impl FnOnce(&[State], &[State]) -> R,
) -> Result<Region, Error> {
    let mut system = HybridSystem::new(1.0);
    let mut states = Vec::new();
    for k in 0..2 * axes {
        let name = format!("{}{}", if k < axes { "" } else { "v" }, AXES[k % axes.min(AXES.len())]);
        system.states.push((name, Interval::REALS));
        states.push(system.handles.state(k));
    }
    let (positions, velocities) = states.split_at(axes);
    system.region(rows(positions, velocities))
}
