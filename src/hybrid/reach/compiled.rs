//! A compiled hybrid system: blocks of unconnected states, and for each block the maps, generators
//! and limits of every transition.

use std::sync::Arc;

use faer::Mat;

use super::rounding::EPSILON;
use super::shape::{Map, Matrix, Shape};
use super::template::Template;
use crate::hybrid::system::{Halfspace, HybridSystem};
use crate::interval::Interval;
use crate::tolerance::margin_scale;

/// A block of connected states, which share one set.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// Numbers of the states, ascending.
    pub(super) states: Vec<usize>,
    /// Domains and limits at every sample.
    pub(super) limits: Vec<Cut>,
    /// The set within the limits.
    pub(super) domain: Shape,
    /// One per transition.
    pub(super) steps: Vec<Step>,
}

/// A half-space of a block, margin included.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    pub(super) name: String,
    pub(super) normal: Vec<f64>,
    pub(super) limit: f64,
    /// The original limit, for reports.
    pub(super) given: f64,
}

/// A transition within a block.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) before: Vec<Cut>,
    pub(super) flow: Map,
    /// Segments from `-g` to `g`, added by the inputs.
    pub(super) generators: Vec<Vec<f64>>,
    /// The possible rounding error of the inputs' midpoints.
    pub(super) slack: Vec<f64>,
    pub(super) after: Vec<Cut>,
    pub(super) reset: Option<Map>,
    /// The margin again after a reset, because the reset may shrink it and an accepted plan may
    /// also miss the reset itself.
    pub(super) reset_slack: Vec<f64>,
    /// A bounded set that holds every prediction.
    pub(super) predictions: Shape,
}

/// A hybrid system, compiled for one range of its inputs.
#[derive(Debug, Clone)]
pub(super) struct Compiled {
    pub(super) blocks: Vec<Block>,
    pub(super) states: Vec<(String, Interval)>,
    /// Name, and whether it is an event, of every transition.
    pub(super) transitions: Vec<(String, bool)>,
}

impl Compiled {
    /// Compiles a checked system.
    ///
    /// # Arguments
    ///
    /// * `inputs`: the ranges of the inputs.
    /// * `margin`: how much every limit is loosened, in proportion to magnitudes beyond 1000.
    /// * `sizes`: magnitudes of the states, for that scale.
    /// * `further`: template directions in addition to the axes and the normals of the limits.
    pub(super) fn new(
        system: &HybridSystem,
        inputs: &[Interval],
        margin: f64,
        sizes: &[f64],
        further: &[Vec<f64>],
    ) -> Self {
        let groups = groups(system);
        let blocks =
            groups.iter().map(|states| block(system, inputs, margin, sizes, further, states));
        let transitions = system.transitions().map(|t| (t.name.clone(), t.is_event));
        Compiled {
            blocks: blocks.collect(),
            states: system.states.clone(),
            transitions: transitions.collect(),
        }
    }
}

/// The connected components of the states under flows, resets, guards and limits. Inputs do not
/// connect states: if two blocks share an input, each chooses it separately, which can only enlarge
/// sets.
fn groups(system: &HybridSystem) -> Vec<Vec<usize>> {
    let n = system.states.len();
    let mut parent: Vec<usize> = (0..n).collect();
    fn root(parent: &[usize], mut k: usize) -> usize {
        while parent[k] != k {
            k = parent[k];
        }
        k
    }
    let mut link = |i: usize, j: usize| {
        let (i, j) = (root(&parent, i), root(&parent, j));
        parent[i.max(j)] = i.min(j);
    };
    let mut link_matrix = |matrix: &Mat<f64>| {
        for i in 0..n {
            for j in 0..n {
                if matrix[(i, j)] != 0.0 {
                    link(i, j);
                }
            }
        }
    };
    for transition in system.transitions() {
        link_matrix(transition.flow.a());
        if let Some(reset) = &transition.reset {
            link_matrix(&reset.matrix);
        }
    }
    let guards = system.transitions().flat_map(|t| t.guards.iter().chain(&t.prediction_guards));
    for halfspace in system.limits.iter().chain(guards) {
        let touched: Vec<usize> = (0..n).filter(|&i| halfspace.normal[i] != 0.0).collect();
        touched.windows(2).for_each(|pair| link(pair[0], pair[1]));
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); n];
    for state in 0..n {
        groups[root(&parent, state)].push(state);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

fn block(
    system: &HybridSystem,
    inputs: &[Interval],
    margin: f64,
    sizes: &[f64],
    further: &[Vec<f64>],
    states: &[usize],
) -> Block {
    let local = |normal: &[f64]| -> Vec<f64> { states.iter().map(|&i| normal[i]).collect() };
    let domains: Vec<Interval> = states.iter().map(|&i| system.states[i].1).collect();
    let cut = |halfspace: &Halfspace| -> Option<Cut> {
        let normal = local(&halfspace.normal);
        let terms = halfspace.normal.iter().zip(sizes).map(|(n, size)| (n * size).abs());
        let largest = terms.fold(0.0, f64::max);
        let given = halfspace.limit_at(0);
        let limit = given + margin * margin_scale(largest, given);
        let touches = normal.iter().any(|&n| n != 0.0);
        let name = halfspace.name.clone();
        touches.then_some(Cut { name, normal, limit, given })
    };
    let cuts = |halfspaces: &[Halfspace]| halfspaces.iter().filter_map(cut).collect::<Vec<_>>();

    let mut limits = Vec::new();
    for (k, &state) in states.iter().enumerate() {
        let (name, domain) = &system.states[state];
        for (sign, limit, word) in [(1.0, domain.upper, "upper"), (-1.0, -domain.lower, "lower")] {
            let mut normal = vec![0.0; states.len()];
            normal[k] = sign;
            let wide = limit + margin * margin_scale(sizes[state], limit);
            let name = format!("the {word} limit of {name}");
            limits.push(Cut { name, normal, limit: wide, given: limit });
        }
    }
    limits.extend(cuts(&system.limits));

    let template = template(system, further, states);
    let reach =
        |k: usize, d: &Interval| (-limits[2 * k + 1].limit, limits[2 * k].limit.max(d.lower));
    let (low, high): (Vec<f64>, Vec<f64>) =
        domains.iter().enumerate().map(|(k, d)| reach(k, d)).unzip();
    let mut domain = Shape::from_box(template.as_ref(), &low, &high);
    for cut in &limits[2 * states.len()..] {
        domain.clip(&cut.normal, cut.limit);
    }

    let steps = system.transitions().map(|transition| {
        let matrix = part(transition.flow.a(), states, states);
        let gains = part(transition.flow.b(), states, &(0..inputs.len()).collect::<Vec<_>>());
        let mut shift = local(transition.flow.c());
        let mut slack = vec![0.0; states.len()];
        let mut generators = Vec::new();
        for (j, range) in inputs.iter().enumerate() {
            let size = range.magnitude();
            let half = 0.5 * (range.upper - range.lower)
                + margin * margin_scale(size, 0.0)
                + 4.0 * EPSILON * size;
            let middle = 0.5 * range.lower + 0.5 * range.upper;
            let generator: Vec<f64> = gains.iter().map(|row| row[j] * half).collect();
            for (i, row) in gains.iter().enumerate() {
                shift[i] += row[j] * middle;
                slack[i] += 8.0 * EPSILON * (row[j].abs() * size + shift[i].abs());
            }
            if generator.iter().any(|&g| g != 0.0) {
                generators.push(generator);
            }
        }
        let flow = Map::new(matrix, shift, template.as_deref());
        let reset = transition.reset.as_ref().map(|reset| {
            Map::new(
                part(&reset.matrix, states, states),
                local(&reset.offset.get(0).cloned().unwrap_or_default()),
                template.as_deref(),
            )
        });
        let size = |&i: &usize| match transition.reset {
            Some(_) => margin * margin_scale(sizes[i], 0.0),
            None => 0.0,
        };
        let reset_slack = states.iter().map(size).collect();
        let mut predictions = domain.map(&flow).add_segments(&generators);
        predictions.widen(&slack);
        let (before, after) = (cuts(&transition.guards), cuts(&transition.prediction_guards));
        Step { before, flow, generators, slack, after, reset, reset_slack, predictions }
    });
    let steps = steps.collect();
    Block { states: states.to_vec(), limits, domain, steps }
}

/// `None`, which means exact polygons, for two states; otherwise a template of the axes, the limits'
/// normals, the user's directions and, in small blocks, the diagonals.
fn template(
    system: &HybridSystem,
    further: &[Vec<f64>],
    states: &[usize],
) -> Option<Arc<Template>> {
    if states.len() == 2 {
        return None;
    }
    let guards = system.transitions().flat_map(|t| t.guards.iter().chain(&t.prediction_guards));
    let own = system.limits.iter().chain(guards).map(|halfspace| &halfspace.normal);
    let local = |normal: &Vec<f64>| -> Vec<f64> { states.iter().map(|&i| normal[i]).collect() };
    let mut directions: Vec<Vec<f64>> = own.chain(further).map(local).collect();
    if states.len() <= 4 {
        for i in 0..states.len() {
            for j in i + 1..states.len() {
                for sign in [1.0, -1.0] {
                    let mut diagonal = vec![0.0; states.len()];
                    (diagonal[i], diagonal[j]) = (1.0, sign);
                    directions.push(diagonal);
                }
            }
        }
    }
    Some(Arc::new(Template::new(states.len(), &directions)))
}

fn part(matrix: &Mat<f64>, rows: &[usize], columns: &[usize]) -> Matrix {
    rows.iter().map(|&i| columns.iter().map(|&j| matrix[(i, j)]).collect()).collect()
}
