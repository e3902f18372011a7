//! Facets of unions of polytopes that a relaxed point violates.
//!
//! A facet is found once, where the line from a centre of a union to the relaxed point leaves its
//! hull. Unions of the same shape take over its direction and its multipliers, in their own
//! columns, coefficients and limits: in a hybrid system these are the other steps of the horizon.
//! The largest value of the direction in each case of a union is proved by multipliers of the rows
//! of that case, rounded outward. If the cases exclude each other, these values are the
//! coefficients of their binaries, so a direction suits steps whose Ms differ.

use std::collections::BTreeMap;

use super::cut::Cut;
use super::hull_exit::HullExit;
use super::parameters::CUTS;
use super::unions::{CaseUnion, CaseUnions};
use crate::presolve::Domain;
use crate::program::Program;
use crate::relaxation::{CascadePool, MethodCascade, Purpose, RelaxationClaim};
use crate::solver::{Options, StopToken};

/// A facet of the unions of a shape.
struct FacetTemplate {
    shape: usize,
    exit: HullExit,
}

/// The facets that are known, and where to look for more.
pub(super) struct FacetPool {
    unions: CaseUnions,
    templates: Vec<FacetTemplate>,
    /// By union, a point within its hull, by column; empty if none is known.
    centres: Vec<Option<Vec<f64>>>,
    /// By shape, linear programs that found nothing since one did.
    failures: Vec<u32>,
    /// The union to look at next.
    next: usize,
}

/// The data that separation works with.
pub(super) struct FacetTools<'a> {
    pub(super) program: &'a Program,
    pub(super) domain: &'a Domain,
    pub(super) cascade: &'a mut MethodCascade,
    pub(super) options: &'a Options,
    pub(super) token: &'a StopToken,
    /// The work that facets have taken, iterations times rows, and the most of it.
    pub(super) work: [f64; 2],
}

impl FacetTools<'_> {
    /// Takes the work of a linear program that has so many rows.
    pub(super) fn take_work(&mut self, iterations_before: u64, rows: usize) {
        self.work[0] += (self.cascade.iterations() - iterations_before) as f64 * rows as f64;
    }

    fn is_over(&self) -> bool {
        self.token.is_over() || self.work[0] >= self.work[1]
    }
}

impl FacetPool {
    /// The unions of a program, without facets.
    pub(super) fn new(program: &Program, domain: &Domain) -> Self {
        let unions = CaseUnions::of(program, domain);
        let (centres, failures) = (vec![None; unions.all.len()], vec![0; unions.shapes]);
        FacetPool { unions, templates: Vec::new(), centres, failures, next: 0 }
    }

    /// Whether there is nothing to look at.
    pub(super) fn is_empty(&self) -> bool {
        self.unions.all.is_empty()
    }

    /// The number of unions.
    pub(super) fn union_count(&self) -> usize {
        self.unions.all.len()
    }

    /// The union and the direction of a facet that was found here.
    pub(super) fn origin(&self, cut: &Cut) -> Option<(CaseUnion, HullExit)> {
        let [union, place] = cut.facet?;
        Some((self.unions.all[union].clone(), self.templates[place].exit.clone()))
    }

    /// The number of shapes that have facets.
    #[cfg(feature = "tracing")]
    pub(super) fn shape_count(&self) -> usize {
        let mut shapes: Vec<usize> = self.templates.iter().map(|facet| facet.shape).collect();
        shapes.sort_unstable();
        shapes.dedup();
        shapes.len()
    }

    /// The facets that a point violates: those that are known, and new ones of unions for which
    /// there are none, or of all if the search is thorough. Whether all unions were looked at is
    /// the second value.
    pub(super) fn separate(
        &mut self,
        x: &[f64],
        is_thorough: bool,
        tools: &mut FacetTools<'_>,
    ) -> (Vec<Cut>, bool) {
        let mut cuts = Vec::new();
        let count = self.unions.all.len();
        let order = (0..count).map(|k| (k + self.next) % count);
        let open: Vec<usize> = order.filter(|&k| self.unions.all[k].is_undecided(x)).collect();
        let mut is_cut = vec![false; count];
        for (place, facet) in self.templates.iter().enumerate() {
            self.translate((place, facet), &open, x, tools, &mut is_cut, &mut cuts);
        }
        if is_thorough {
            is_cut.fill(false);
        }
        let mut programs = 0;
        for &k in &open {
            let shape = self.unions.all[k].shape;
            if is_cut[k] || self.failures[shape] >= CUTS.facet_failures {
                continue;
            }
            if programs == CUTS.facet_programs || tools.is_over() {
                self.next = k;
                return (cuts, false);
            }
            programs += 1;
            self.failures[shape] += 1;
            let Some(exit) = self.find(k, x, tools) else { continue };
            let (facet, before) = (FacetTemplate { shape, exit }, cuts.len());
            let place = self.templates.len();
            self.translate((place, &facet), &open, x, tools, &mut is_cut, &mut cuts);
            if cuts.len() > before {
                self.failures[shape] = 0;
                self.templates.push(facet);
            }
        }
        (cuts, true)
    }

    /// The cuts that a facet, with its place, is in the unions of its shape.
    fn translate(
        &self,
        (place, facet): (usize, &FacetTemplate),
        open: &[usize],
        x: &[f64],
        tools: &mut FacetTools<'_>,
        is_cut: &mut [bool],
        cuts: &mut Vec<Cut>,
    ) {
        for &k in open.iter().filter(|&&k| self.unions.all[k].shape == facet.shape) {
            let found = cut_of(&self.unions.all[k], &facet.exit, tools);
            let found = found.filter(|cut| cut.cuts_off(x));
            is_cut[k] |= found.is_some();
            cuts.extend(found.map(|cut| Cut { facet: Some([k, place]), ..cut }));
        }
    }

    fn find(&mut self, k: usize, x: &[f64], tools: &mut FacetTools<'_>) -> Option<HullExit> {
        let union = &self.unions.all[k];
        let centre = self.centres[k].get_or_insert_with(|| centre(union, tools));
        if centre.is_empty() {
            return None;
        }
        let own: Vec<f64> = union.columns.iter().map(|&j| x[j]).collect();
        HullExit::find(union, centre, &own, tools)
    }
}

/// The facets of unions of a program that a point violates.
pub fn facet_cuts(program: &Program, domain: &Domain, x: &[f64], options: &Options) -> Vec<Cut> {
    let token = &StopToken::default();
    let cascade = &mut CascadePool::new(options).take();
    let work = [0.0, f64::INFINITY];
    let mut tools = FacetTools { program, domain, cascade, options, token, work };
    FacetPool::new(program, domain).separate(x, true, &mut tools).0
}

/// A point within the hull of a union, the mean of points of its cases; empty if there is none.
fn centre(union: &CaseUnion, tools: &mut FacetTools<'_>) -> Vec<f64> {
    let rows = union.own_rows(tools.program);
    let n = union.columns.len();
    let (mut sum, mut count) = (vec![0.0; n], 0.0);
    for case in 0..union.cases.len() {
        let bounds = union.bounds(tools.domain, case);
        let polytope = CaseUnion::polytope(&rows, &bounds, vec![0.0; n]);
        let before = tools.cascade.iterations();
        let found = tools.cascade.solve_once(&polytope, Purpose::Separation, tools.token);
        tools.take_work(before, rows.len());
        if found.claim == RelaxationClaim::Solved {
            sum.iter_mut().zip(&found.x).for_each(|(sum, x)| *sum += x);
            count += 1.0;
        }
    }
    sum.iter_mut().for_each(|sum| *sum /= count);
    if sum.iter().all(|x| x.is_finite()) { sum } else { Vec::new() }
}

/// The cut of a facet in a union, if its limit can be proved.
///
/// Where the cases exclude each other, each has its own limit: what is added up over the cases,
/// each limit times the weight of its case, is a limit of the sum. So the coefficients of their
/// binaries are those of this union, and the other ones are the facet's.
pub(super) fn cut_of(
    union: &CaseUnion,
    exit: &HullExit,
    tools: &mut FacetTools<'_>,
) -> Option<Cut> {
    let rows = union.own_rows(tools.program);
    let weights = union.weights();
    let mut direction = exit.direction.clone();
    let decided = weights.iter().flatten().flat_map(|weight| &weight.0);
    decided.for_each(|&(k, _)| direction[k] = 0.0);
    let zeros = vec![0.0; union.columns.len()];
    let mut limits = Vec::with_capacity(exit.multipliers.len());
    for (case, multipliers) in exit.multipliers.iter().enumerate() {
        let bounds = union.bounds(tools.domain, case);
        let cost = direction.iter().map(|a| -a).collect();
        let polytope = CaseUnion::polytope(&rows, &bounds, cost);
        tools.work[0] += rows.len() as f64;
        limits.push(-tools.cascade.prover().lower_bound(&polytope, &zeros, multipliers));
    }
    // A case that is empty has no limit.
    let most = limits.iter().copied().filter(|limit| limit.is_finite()).reduce(f64::max)?;
    if limits.contains(&f64::INFINITY) {
        return None;
    }
    limits.iter_mut().filter(|limit| !limit.is_finite()).for_each(|limit| *limit = most);
    let mut limit = most;
    if let Some(weights) = weights {
        limit = limits.iter().zip(&weights).map(|(most, weight)| most * weight.1).sum();
        for (most, (terms, _)) in limits.iter().zip(&weights) {
            terms.iter().for_each(|&(k, a)| direction[k] -= most * a);
        }
    }
    let terms = union.columns.iter().copied().zip(direction).filter(|(_, a)| *a != 0.0);
    let cut = Cut::anywhere(terms.collect::<BTreeMap<_, _>>(), limit, 0.0, tools.domain)?;
    Some(Cut { cases: union.case_columns(), ..cut })
}
