//! Contact laws: the motion where the vehicle meets the wall.

/// The law of the wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum ContactLaw {
    /// If the free flight of a step ends behind the wall, the step is reflected at the wall, and
    /// the rebound is scaled by the restitution. The vehicle never ends a step inside the wall.
    #[default]
    Reflecting,
    /// The paper's equations (8)-(13) with their errata corrected: while the vehicle is inside the
    /// wall, its acceleration is `-(1+e) v/Δt`.
    ///
    /// This law never pays off. It reverses the velocity, but during that step the vehicle moves
    /// another `Δt |v| (1-e)/2` into the wall, where the law applies again. The shortest plans
    /// under it are collision-free. It is here for comparison with the paper.
    Literal,
    /// Collisions are forbidden, but the vehicle may touch the wall at a sample.
    Forbidden,
}
