//! The parameters of the cuts at the root.

/// The parameters of the cuts at the root.
#[derive(Debug)]
pub(super) struct CutParameters {
    /// Most rounds of relaxing and cutting.
    pub(super) most_rounds: usize,
    /// Most cuts of a round.
    pub(super) most_cuts: usize,
    /// Least lift of the bound by a round that is not idle, relative to the bound.
    pub(super) idle_lift: f64,
    /// Least lift of the bound by a round that is not idle, as a share of the lift by all rounds.
    pub(super) idle_share: f64,
    /// Idle rounds in a row that end the rounds.
    pub(super) idle_rounds: usize,
    /// Least lift of the bound by the first round, relative to the bound: under a linear objective,
    /// whose relaxed optimum is a corner, and under a curved one, where it rarely is.
    pub(super) first_lift: [f64; 2],
    /// Least lift of the bound by all rounds, relative to the bound, under a linear and a curved
    /// objective.
    pub(super) total_lift: [f64; 2],
    /// Least lift of the bound, relative to the bound, where the share of the gap that is closed
    /// decides: an objective may have a large constant part.
    pub(super) slight_lift: f64,
    /// Least share of the gap to a point found by rounding that the first round, and all rounds,
    /// must close.
    pub(super) closed_share: [f64; 2],
    /// Number of further rounds, each with the lift of the last one, after which the least lift of
    /// all rounds must be reached for rounds to go on: the first rounds lift the most.
    pub(super) rounds_ahead: f64,
    /// Least factor by which cut sets must increase the lift of a round to stay.
    pub(super) set_factor: f64,
    /// Largest cosine of the angle between two cuts of a round.
    pub(super) most_cosine: f64,
    /// Rounds for which a cut may be slack before it leaves: the point is inside the face of all
    /// optima, and the next round may move it back.
    pub(super) slack_rounds: u32,
    /// Largest room of a binding cut, relative to its terms.
    pub(super) binding: f64,
    /// Least distance of a point to a cut that it violates.
    pub(super) least_depth: f64,
    /// Largest quotient of two coefficients of a cut; smaller ones are taken out at the column's
    /// bound.
    pub(super) dynamism: f64,
    /// Margin by which limits are loosened, relative to the size of the terms: rounding must not
    /// cut a whole point off.
    pub(super) limit_margin: f64,
    /// Most entries of the sum of rows of a cut set.
    pub(super) set_entries: usize,
    /// Least value of the binary of an arc that is contracted.
    pub(super) open_arc: f64,
    /// Most entries of an aggregate of rows.
    pub(super) aggregate_entries: usize,
    /// Most entries of a row of a tableau that is rounded.
    pub(super) tableau_entries: usize,
    /// The rest of terms that cancel, relative to their magnitudes.
    pub(super) cancelled: f64,
    /// Most rows from which aggregates are started.
    pub(super) start_rows: usize,
    /// Largest slack of a row that starts an aggregate of several, relative to its largest
    /// coefficient.
    pub(super) start_slack: f64,
    /// Least distance from its bounds at which a column is worth eliminating.
    pub(super) bound_distance: f64,
    /// Accuracy to which the coefficients of a row are taken to be known, relative to its largest.
    pub(super) row_accuracy: f64,
    /// Fractions of the right side that are rounded.
    pub(super) right_fractions: std::ops::RangeInclusive<f64>,
    /// The least fraction where a binary switches a continuous column of the aggregate: its bound
    /// is as wide as the largest flow, of which the right side may be a small part.
    pub(super) least_switched_fraction: f64,
    /// Least distance to the next multiple of the divisor, relative to the aggregate's size: more
    /// than tolerances of rows sum up to.
    pub(super) least_missing: f64,
    /// Least quotient of a divisor and the noise of the coefficients.
    pub(super) divisor_noise: f64,
    /// Most divisors that are tried.
    pub(super) most_divisors: usize,
    /// Most columns whose direction is tried both ways.
    pub(super) most_flips: usize,
    /// Share of an aggregate's size that counts for the margin of its cut: rounding, and no more.
    pub(super) margin_share: f64,
    /// Most unions of a program.
    pub(super) most_unions: usize,
    /// Numbers of binaries of a row whose cases are a union.
    pub(super) case_counts: std::ops::RangeInclusive<usize>,
    /// Most columns and rows of a union, and the longest of these.
    pub(super) region_columns: usize,
    pub(super) region_rows: usize,
    pub(super) longest_region_row: usize,
    /// By pass that adds rows to a union, most further columns of a row.
    pub(super) region_growth: [usize; 8],
    /// Distance from a whole number up to which a binary counts as decided.
    pub(super) least_fraction: f64,
    /// Most linear programs of a round.
    pub(super) facet_programs: usize,
    /// Linear programs in a row without a facet after which a shape is left alone.
    pub(super) facet_failures: u32,
    /// Most rounds of facets.
    pub(super) facet_rounds: u32,
    /// The share of the work of a search that facets may take before they have lifted its root.
    pub(super) facet_share: f64,
    /// The share, relative to the part of the way to the bound of the search that they have lifted
    /// the root.
    pub(super) share_growth: f64,
    /// How far above the bound of a search facets have to lift its root, relative to its own lift.
    pub(super) facet_margin: f64,
    /// Most of the gap between root and incumbent that a search has closed which facets help.
    pub(super) facet_gap: f64,
    /// Most cosine of two facets: those of a union may be near to each other.
    pub(super) most_facet_cosine: f64,
    /// The part of what is to be lifted that a round lifts at least.
    pub(super) idle_facets: f64,
    /// The lift that all later rounds may have, relative to that of the last one.
    pub(super) further_gains: f64,
    /// How far the centre of a union may be off, relative to its size.
    pub(super) centre_room: f64,
    /// Coefficients below this, relative to the largest, are left out of a direction.
    pub(super) slight_coefficient: f64,
}

pub(super) const CUTS: CutParameters = CutParameters {
    most_rounds: 40,
    most_cuts: 300,
    idle_lift: 1e-3,
    idle_share: 0.03,
    idle_rounds: 3,
    first_lift: [1e-5, 5e-3],
    total_lift: [5e-3, 1e-2],
    slight_lift: 1e-5,
    closed_share: [0.05, 0.1],
    rounds_ahead: 2.0,
    set_factor: 1.5,
    most_cosine: 0.7,
    slack_rounds: 2,
    binding: 1e-6,
    least_depth: 1e-5,
    dynamism: 1e6,
    limit_margin: 1e-9,
    set_entries: 1000,
    open_arc: 1e-6,
    aggregate_entries: 300,
    tableau_entries: 1000,
    cancelled: 1e-11,
    start_rows: 2000,
    start_slack: 0.05,
    bound_distance: 1e-6,
    row_accuracy: 1e-10,
    right_fractions: 0.02..=0.98,
    least_switched_fraction: 1e-3,
    least_missing: 1e-6,
    divisor_noise: 1e5,
    most_divisors: 12,
    most_flips: 12,
    margin_share: 1e-3,
    most_unions: 2000,
    case_counts: 2..=8,
    region_columns: 40,
    region_rows: 60,
    longest_region_row: 14,
    region_growth: [0, 1, 0, 1, 2, 0, 1, 0],
    least_fraction: 1e-6,
    facet_programs: 60,
    facet_failures: 6,
    facet_rounds: 12,
    facet_share: 0.1,
    share_growth: 2.0,
    facet_margin: 0.2,
    facet_gap: 0.33,
    most_facet_cosine: 0.99,
    idle_facets: 0.01,
    further_gains: 5.0,
    centre_room: 1e-6,
    slight_coefficient: 1e-7,
};
