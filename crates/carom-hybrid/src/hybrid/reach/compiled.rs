//! A compiled hybrid system at one step: blocks of unconnected states, and for each block the maps,
//! generators and limits of every joint transition.

use std::ops::Range;
use std::sync::Arc;

use faer::Mat;

use super::functions::FunctionRanges;
use super::inputs::{Joint, tightened};
use super::joint_transitions::JointTransitions;
use super::law::{Context, Guard, Law, Prediction};
use super::margins::Margins;
use super::options::SetOptions;
use super::rounding::EPSILON;
use super::shape::{AffineMap, Matrix, Shape};
use super::template::Template;
use crate::hybrid::system::{Coordinates, HybridSystem, MODE, Region};
use crate::interval::Interval;
use crate::tolerance::margin_scale;
use crate::union_find::UnionFind;

/// A block of connected states, which share one set.
#[derive(Debug, Clone)]
pub(super) struct Block {
    /// Numbers of the states, ascending.
    pub(super) states: Vec<usize>,
    /// Domains and limits at the sample at which the step begins.
    pub(super) limits: Vec<Cut>,
    /// The set within the limits.
    pub(super) domain: Shape,
    /// One per joint transition.
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

/// A joint transition within a block.
#[derive(Debug, Clone)]
pub(super) struct Step {
    pub(super) before: Vec<Cut>,
    pub(super) flow: AffineMap,
    pub(super) push: Push,
    pub(super) after: Vec<Cut>,
    pub(super) reset: Option<AffineMap>,
    /// The margin again after a reset, because the reset may shrink it and an accepted plan may
    /// also miss the reset itself; and everything else that the next state may differ by.
    pub(super) loose: Vec<f64>,
    /// A bounded set that holds every prediction.
    pub(super) predictions: Shape,
    /// The flow's input matrix and constant part.
    pub(super) gains: Matrix,
    pub(super) constant: Vec<f64>,
}

/// The set that the inputs add to a flow.
#[derive(Debug, Clone)]
pub(super) struct Push {
    /// The constant part, with the inputs in the middle of their ranges.
    pub(super) shift: Vec<f64>,
    /// Segments from `-g` to `g`.
    pub(super) generators: Vec<Vec<f64>>,
    /// The possible rounding error of the inputs' midpoints.
    pub(super) slack: Vec<f64>,
}

/// A joint transition, over all blocks.
#[derive(Debug, Clone)]
pub(super) struct CompiledTransition {
    /// Numbers of its transitions.
    pub(super) members: Vec<usize>,
    /// How many of them are events.
    pub(super) events: usize,
    /// Whether the inputs have values.
    pub(super) is_possible: bool,
    /// Ranges of the inputs, margin included, tightened by the guards on inputs.
    pub(super) inputs: Vec<Interval>,
    /// Guards on inputs.
    pub(super) joint: Vec<Joint>,
    /// Those of its predictions.
    pub(super) margins: Margins,
    pub(super) predictions: Vec<(usize, Prediction)>,
}

/// A hybrid system, compiled for one step.
#[derive(Debug, Clone)]
pub(super) struct Compiled {
    pub(super) blocks: Vec<Block>,
    /// Of the states, in their own coordinates.
    pub(super) states: Vec<(String, Interval)>,
    /// The coordinates of states and inputs.
    pub(super) coordinates: Arc<Coordinates>,
    /// Name, and whether it is an event, of every transition.
    pub(super) transitions: Vec<(String, bool)>,
    /// Numbers of the transitions of each choice.
    pub(super) choices: Vec<Range<usize>>,
    pub(super) choice_names: Vec<String>,
    pub(super) joint_transitions: Vec<CompiledTransition>,
    /// Numbers of transitions of choices that are not followed.
    pub(super) relaxed: Vec<usize>,
    pub(super) margins: Margins,
    /// The functions of a step; `None` without any.
    pub(super) functions: Option<FunctionRanges>,
}

/// The data from which a step of a system is compiled.
pub(super) struct Source<'a> {
    pub(super) system: &'a HybridSystem,
    pub(super) coordinates: &'a Arc<Coordinates>,
    pub(super) joint_transitions: &'a JointTransitions,
    pub(super) step: usize,
    /// The ranges of the inputs, if they differ from the system's.
    pub(super) given: Option<&'a [Interval]>,
    pub(super) options: &'a SetOptions,
    /// The start and the goal.
    pub(super) ends: [&'a Region; 2],
    /// Magnitudes of the states, for the scale of the margin.
    pub(super) sizes: &'a [f64],
    pub(super) margins: &'a Margins,
}

impl Compiled {
    /// Compiles a checked system for one step. `like` is the system of another step, whose maps
    /// have the same matrices.
    pub(super) fn new(source: &Source, like: Option<&Compiled>) -> Self {
        let system = source.system;
        let followed = source.joint_transitions.followed;
        let context = Context {
            system,
            transitions: system.transitions().collect(),
            step: source.step,
            given: source.given,
            margin: source.options.margin,
            is_disturbed: source.options.disturbance,
            relaxed: system.choices.get(followed..).unwrap_or(&[]),
            relaxed_numbers: &source.joint_transitions.relaxed,
        };
        let laws: Vec<Law> = source.joint_transitions.list.iter().map(|m| context.law(m)).collect();
        let groups = match like {
            Some(like) => like.blocks.iter().map(|block| block.states.clone()).collect(),
            None => groups(system, &laws),
        };
        let blocks: Vec<Block> = groups
            .iter()
            .enumerate()
            .map(|(b, states)| source.block(&laws, states, like.map(|like| &like.blocks[b])))
            .collect();
        let compiled = source.joint_transitions.list.iter().zip(laws).map(|(taken, law)| {
            let joint: Vec<Joint> = law
                .before
                .iter()
                .filter(|guard| guard.is_joint() && guard.limit < f64::INFINITY)
                .map(|guard| source.joint(guard, &law.inputs, &blocks))
                .collect();
            let wide = law.inputs.iter().map(|range| source.wide(range)).collect();
            let domains: Vec<&Shape> = blocks.iter().map(|block| &block.domain).collect();
            let (inputs, is_possible) = match tightened(wide, &joint, &domains) {
                Ok(inputs) => (inputs, law.is_possible),
                Err(_) => (law.inputs.clone(), false),
            };
            CompiledTransition {
                members: taken.members.clone(),
                events: taken.events,
                is_possible,
                inputs,
                joint,
                margins: source.margins.after(&law.flow),
                predictions: law.predictions,
            }
        });
        Compiled {
            choice_names: system.choices.iter().map(|choice| choice.name.clone()).collect(),
            choices: system
                .choices
                .iter()
                .enumerate()
                .map(|(c, choice)| {
                    let first = system.first_transition(c);
                    first..first + choice.transitions.len()
                })
                .collect(),
            joint_transitions: compiled.collect(),
            blocks,
            states: system.states.clone(),
            coordinates: Arc::clone(source.coordinates),
            transitions: system.transitions().map(|t| (t.name.clone(), t.is_event)).collect(),
            relaxed: source.joint_transitions.relaxed.clone(),
            margins: source.margins.clone(),
            functions: system.is_nonlinear().then(|| {
                let known = like.and_then(|like| like.functions.as_ref());
                FunctionRanges {
                    functions: known.map_or_else(
                        || Arc::new(system.functions.clone()),
                        |known| Arc::clone(&known.functions),
                    ),
                    margin: source.step_margin(),
                }
            }),
        }
    }

    /// The names of the members, with the choices that they are of if choices are named.
    pub(super) fn name(&self, number: usize) -> String {
        let members = self.joint_transitions[number].members.iter();
        members.map(|&m| self.transition_name(m)).collect::<Vec<_>>().join(" and ")
    }

    /// The name of a transition, with its choice's.
    pub(super) fn transition_name(&self, number: usize) -> String {
        let name = &self.transitions[number].0;
        let own = self.choices.iter().position(|numbers| numbers.contains(&number));
        match own.map(|c| self.choice_names[c].as_str()) {
            Some(choice) if choice != MODE => format!("{name} of {choice}"),
            _ => name.clone(),
        }
    }
}

/// The set that inputs within ranges add to a flow.
pub(super) fn push(gains: &Matrix, constant: &[f64], inputs: &[Interval], margin: f64) -> Push {
    let mut shift = constant.to_vec();
    let mut slack = vec![0.0; constant.len()];
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
    Push { shift, generators, slack }
}

/// The connected components of the states under flows, resets, guards and limits. Inputs do not
/// connect states: if two blocks share an input, each chooses it separately, which can only enlarge
/// sets.
fn groups(system: &HybridSystem, laws: &[Law]) -> Vec<Vec<usize>> {
    let n = system.states.len();
    let mut sets = UnionFind::new(n);
    let link_matrix = |sets: &mut UnionFind, matrix: &Mat<f64>| {
        for i in 0..n {
            for j in 0..n {
                if matrix[(i, j)] != 0.0 {
                    sets.join(i, j);
                }
            }
        }
    };
    for law in laws {
        link_matrix(&mut sets, &Mat::from_fn(n, n, |i, j| law.flow[i].factors[j]));
        if let Some((matrix, _)) = &law.reset {
            link_matrix(&mut sets, matrix);
        }
    }
    let guards = laws.iter().flat_map(|law| law.before.iter().chain(&law.after));
    let limits = system.limits.iter().map(|limit| limit.parts(n).0);
    for normal in limits.chain(guards.map(|guard| guard.states.as_slice())) {
        let touched: Vec<usize> = (0..n).filter(|&i| normal[i] != 0.0).collect();
        touched.windows(2).for_each(|pair| sets.join(pair[0], pair[1]));
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); n];
    for state in 0..n {
        groups[sets.root(state)].push(state);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

impl Source<'_> {
    /// The margin of an input or a reset at the step.
    fn step_margin(&self) -> f64 {
        match self.given {
            Some(_) => self.margins.of_given(),
            None => self.margins.of_step(),
        }
    }

    /// The range of an input with its margin.
    fn wide(&self, range: &Interval) -> Interval {
        let size = range.magnitude();
        let slack = self.step_margin() * margin_scale(size, 0.0) + 4.0 * EPSILON * size;
        Interval::new(range.lower - slack, range.upper + slack)
    }

    fn joint(&self, guard: &Guard, inputs: &[Interval], blocks: &[Block]) -> Joint {
        let touches = |block: &Block| block.states.iter().any(|&i| guard.states[i] != 0.0);
        let block = blocks.iter().position(touches);
        let local = |block: usize| -> Vec<f64> {
            blocks[block].states.iter().map(|&i| guard.states[i]).collect()
        };
        let states = guard.states.iter().zip(self.sizes).map(|(n, size)| (n * size).abs());
        let pushes =
            guard.inputs.iter().zip(inputs).map(|(m, range)| (m * range.magnitude()).abs());
        let largest = states.chain(pushes).fold(0.0, f64::max);
        Joint {
            name: guard.name.clone(),
            block,
            normal: block.map(local).unwrap_or_default(),
            gains: guard.inputs.clone(),
            limit: guard.limit
                + self.margins.of_condition(&guard.states, &guard.inputs, largest, guard.limit),
            given: guard.limit,
        }
    }

    fn cut(
        &self,
        states: &[usize],
        name: &str,
        full: &[f64],
        given: f64,
        margins: &Margins,
    ) -> Option<Cut> {
        let normal: Vec<f64> = states.iter().map(|&i| full[i]).collect();
        let terms = full.iter().zip(self.sizes).map(|(n, size)| (n * size).abs());
        let largest = terms.fold(0.0, f64::max);
        let limit = given + margins.of_condition(full, &[], largest, given);
        let limits = given < f64::INFINITY && normal.iter().any(|&n| n != 0.0);
        limits.then(|| Cut { name: name.to_owned(), normal, limit, given })
    }

    /// The domains and limits of a block at the step's sample.
    fn limits(&self, states: &[usize]) -> Vec<Cut> {
        let mut limits = Vec::new();
        for (k, &state) in states.iter().enumerate() {
            let (name, domain) = &self.system.states[state];
            for (sign, limit, word) in
                [(1.0, domain.upper, "upper"), (-1.0, -domain.lower, "lower")]
            {
                let mut normal = vec![0.0; states.len()];
                normal[k] = sign;
                let wide = limit + self.margins.of_state(state, self.sizes[state], limit);
                let name = format!("the {word} limit of {name}");
                limits.push(Cut { name, normal, limit: wide, given: limit });
            }
        }
        let n = self.system.states.len();
        let own = self.system.limits.iter().filter(|limit| !limit.is_joint(n));
        limits.extend(own.filter_map(|limit| {
            let (normal, given) = (limit.parts(n).0, limit.limit_at(self.step));
            self.cut(states, &limit.name, normal, given, self.margins)
        }));
        limits
    }

    fn block(&self, laws: &[Law], states: &[usize], like: Option<&Block>) -> Block {
        let limits = self.limits(states);
        let template = match like {
            Some(like) => like.domain.template().cloned(),
            None => self.template(laws, states),
        };
        let reach =
            |k: usize, d: &Interval| (-limits[2 * k + 1].limit, limits[2 * k].limit.max(d.lower));
        let domains = states.iter().map(|&i| &self.system.states[i].1);
        let (low, high): (Vec<f64>, Vec<f64>) =
            domains.enumerate().map(|(k, d)| reach(k, d)).unzip();
        let mut domain = Shape::from_box(template.as_ref(), &low, &high);
        for cut in &limits[2 * states.len()..] {
            domain.clip(&cut.normal, cut.limit);
        }
        let mut maps = Maps { known: Vec::new(), template: template.as_deref() };
        for step in like.into_iter().flat_map(|like| &like.steps) {
            maps.known
                .extend([Some(&step.flow), step.reset.as_ref()].into_iter().flatten().cloned());
        }
        let steps = laws.iter().map(|law| self.step(law, states, &domain, &mut maps)).collect();
        Block { states: states.to_vec(), limits, domain, steps }
    }

    fn step(&self, law: &Law, states: &[usize], domain: &Shape, maps: &mut Maps) -> Step {
        let margin = self.step_margin();
        let local = |normal: &[f64]| -> Vec<f64> { states.iter().map(|&i| normal[i]).collect() };
        let cuts = |guards: &[Guard], margins: &Margins| -> Vec<Cut> {
            let guards = guards.iter().filter(|guard| !guard.is_joint());
            let cut = |g: &Guard| self.cut(states, &g.name, &g.states, g.limit, margins);
            guards.filter_map(cut).collect()
        };
        let n = self.system.states.len();
        let rows = || states.iter().map(|&i| &law.flow[i]);
        let gains: Matrix = rows().map(|row| row.factors[n..].to_vec()).collect();
        let constant: Vec<f64> = rows().map(|row| row.constant).collect();
        let push = push(&gains, &constant, &law.inputs, margin);
        let flow = rows().map(|row| local(&row.factors)).collect();
        let flow = maps.map(flow, push.shift.clone());
        let reset = law.reset.as_ref().map(|(matrix, offset)| {
            let row = |&i: &usize| states.iter().map(|&j| matrix[(i, j)]).collect();
            maps.map(states.iter().map(row).collect(), local(offset))
        });
        let loose = |&i: &usize| match law.resets {
            0 => law.loose[i],
            _ => law.loose[i] + law.resets as f64 * (margin * margin_scale(self.sizes[i], 0.0)),
        };
        let mut predictions = domain.map(&flow).add_segments(&push.generators);
        predictions.widen(&push.slack);
        if law.before.iter().any(Guard::is_joint) {
            // Beyond the rounding of guards on inputs, also where the flow has no width.
            let noise = 1e-9 * (1.0 + predictions.size());
            predictions.widen(&vec![noise; states.len()]);
        }
        Step {
            before: cuts(&law.before, self.margins),
            flow,
            after: cuts(&law.after, &self.margins.after(&law.flow)),
            reset,
            loose: states.iter().map(loose).collect(),
            predictions,
            push,
            gains,
            constant,
        }
    }

    /// `None`, which means exact polygons, for two states; otherwise a template of the axes, the
    /// limits' normals, the user's directions and, in small blocks, the diagonals.
    fn template(&self, laws: &[Law], states: &[usize]) -> Option<Arc<Template>> {
        if states.len() == 2 {
            return None;
        }
        let n = self.system.states.len();
        let guards = laws.iter().flat_map(|law| law.before.iter().chain(&law.after));
        let limits = self.system.limits.iter().map(|limit| limit.parts(n).0);
        let own = limits.chain(guards.map(|guard| guard.states.as_slice()));
        let ends = self.ends.iter().flat_map(|end| &end.halfspaces).map(|h| h.normal.as_slice());
        let given = self.options.directions.iter().map(|own| self.coordinates.factors(own));
        let given: Vec<Vec<f64>> = given.collect();
        let further = given.iter().map(Vec::as_slice).chain(ends);
        let local = |normal: &[f64]| -> Vec<f64> { states.iter().map(|&i| normal[i]).collect() };
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
}

/// Maps by their matrices, because combinations of template directions are found once for each.
struct Maps<'a> {
    known: Vec<AffineMap>,
    template: Option<&'a Template>,
}

impl Maps<'_> {
    fn map(&mut self, matrix: Matrix, offset: Vec<f64>) -> AffineMap {
        if let Some(known) = self.known.iter().find(|map| *map.matrix() == matrix) {
            return known.with_offset(offset);
        }
        let map = AffineMap::new(matrix, offset, self.template);
        self.known.push(map.clone());
        map
    }
}
