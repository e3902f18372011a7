//! Facets that a search of a prepared model leaves for the next one.
//!
//! Other values of the parameters change bounds and coefficients, so a facet is kept as a direction
//! with its multipliers, and its limits are proved anew. A union whose columns, rows or cases are
//! others now has none. The order stays, so that the multipliers of the rows of an earlier tree
//! belong to the same facets.

use std::collections::BTreeSet;

use super::facets::{FacetTools, cut_of};
use super::hull_exit::HullExit;
use super::parameters::CUTS;
use super::unions::{CaseUnion, CaseUnions};
use super::{Cut, with_cuts};
use crate::program::Program;
use crate::relaxation::MethodCascade;
use crate::search::root::Root;
use crate::search::root_point::{RootPoint, Strengthened};
use crate::solution::FacetCounts;
use crate::solver::{Options, StopToken};

/// The facets of a search that has begun again with them.
#[derive(Debug, Clone)]
pub(crate) struct KeptFacets {
    /// The union and the direction of each, in the order of their rows.
    pub(super) all: Vec<(CaseUnion, HullExit)>,
}

impl KeptFacets {
    /// These, and those that were found with these among the rows.
    pub(crate) fn with(&self, found: KeptFacets) -> KeptFacets {
        KeptFacets { all: self.all.iter().cloned().chain(found.all).collect() }
    }

    /// The program with the facets, and what is told of them; `None` if they do not lift its
    /// relaxed root now. The root becomes that of the new program.
    ///
    /// # Arguments
    ///
    /// * `begun`: the program before it was cut, as in the search that has found them.
    pub(crate) fn strengthen(
        &self,
        [begun, program]: [&Program; 2],
        root: &mut Root,
        options: &Options,
        token: &StopToken,
        cascade: &mut MethodCascade,
    ) -> Option<(Strengthened, FacetCounts)> {
        if root.conflict.is_some() || token.is_over() {
            return None;
        }
        let domain = &root.domain;
        let unions = CaseUnions::of(begun, domain);
        let present: BTreeSet<_> = unions.all.iter().map(CaseUnion::content).collect();
        let work = [0.0, f64::INFINITY];
        let mut tools = FacetTools { program: begun, domain, cascade, options, token, work };
        let kept = self.all.iter().filter(|(union, _)| present.contains(&union.content()));
        let cuts: Vec<_> =
            kept.filter_map(|(union, exit)| cut_of(union, exit, &mut tools)).collect();
        let mut relax = |program: &Program, warm| {
            RootPoint::new(program, domain, cascade, options, token, warm)
        };
        let first = root.point.clone().or_else(|| relax(program, None))?;
        let more = with_cuts(program, &cuts)?;
        let warm = first.warm.as_ref().filter(|_| first.is_vertex);
        let last = relax(&more, warm)?;
        if !first.is_lifted_by(CUTS.slight_lift, last.value) {
            root.point = Some(first);
            return None;
        }
        let values = [first.value, last.value];
        let counts = facet_counts(program, &cuts, unions.all.len(), values);
        root.point = Some(last.with_bound(first.bound));
        root.carry_over(&more, token);
        Some((Strengthened { program: more, values, cuts }, counts))
    }
}

/// The counts of the facets of a program that has some unions.
pub(super) fn facet_counts(
    program: &Program,
    cuts: &[Cut],
    unions: usize,
    values: [f64; 2],
) -> FacetCounts {
    let own: BTreeSet<&Vec<usize>> = cuts.iter().map(|cut| &cut.cases).collect();
    let mut counts = FacetCounts::default();
    (counts.facets, counts.unions) = (cuts.len() as u64, own.len() as u64);
    counts.all_unions = unions as u64;
    [counts.root_before, counts.root_after] = values.map(|value| program.sign * value);
    counts
}
