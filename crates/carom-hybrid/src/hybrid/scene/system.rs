//! A scene as a hybrid system.

use faer::Mat;

use super::axes::AXES;
use super::body::{Body, Spin};
use super::contact::{ContactPair, at, contacts};
use super::forced_flight::ForcedFlight;
use super::geometry::minus;
use super::law::Writer;
use super::statement::Scene;
use super::units::SceneUnits;
use crate::error::Error;
use crate::hybrid::linear::LinearSystem;
use crate::hybrid::system::{
    Choice, Coordinates, Halfspace, HybridSystem, Measure, NormLimit, Region, Restated, Schedule,
    Transition,
};
use crate::interval::Interval;

/// A checked scene with its contacts and its hybrid system.
#[derive(Debug, Clone)]
pub(super) struct Stated {
    /// The scene as the user stated it.
    pub(super) source: Scene,
    pub(super) units: SceneUnits,
    /// In these units, with the rest.
    pub(super) scene: Scene,
    pub(super) contacts: Vec<ContactPair>,
    pub(super) system: HybridSystem,
    pub(super) coordinates: Coordinates,
}

impl Stated {
    /// The system in the user's units.
    pub(super) fn user_system(&self) -> Result<HybridSystem, Error> {
        self.coordinates.inverse().system(&self.system)
    }

    /// The system in the scene's units.
    pub(super) fn restated(&self) -> Restated {
        Restated { system: self.system.clone(), coordinates: self.coordinates.clone() }
    }
}

impl Scene {
    /// The scene as a hybrid system. For a body `puck` in the plane, its states are `puck x`,
    /// `puck y` (m), `puck vx` and `puck vy` (m/s), its inputs `puck ax` and `puck ay` (m/s²); its
    /// choices are the contacts, such as `puck at wall`, and `a and b` for two bodies. After those
    /// of all bodies, a body with spin has the state `puck spin` (rad/s) and the input
    /// `puck torque` (N m), and one with a heading the state `puck heading` (rad).
    ///
    /// A convex obstacle has a transition `beyond k` for each face k, in front of which the whole
    /// step stays, and `hit k`, or `stick k` and `slip ... k`, for each face to bounce off. With a
    /// single face they are `clear`, `hit`, `stick`, `slip ...`. A surface with rest adds `settle`
    /// and `rest`, or with friction `settle, stick`, `rest, slip ...` and so on.
    ///
    /// # Errors
    ///
    /// [`SceneError`](super::SceneError) and others for a scene that contradicts itself.
    pub fn hybrid_system(&self) -> Result<HybridSystem, Error> {
        self.stated()?.user_system()
    }

    /// Checks the scene and states its system.
    pub(super) fn stated(&self) -> Result<Stated, Error> {
        let (scene, units) = self.in_units()?;
        let mut contacts = contacts(&scene);
        let mut coordinates = units.coordinates(&scene);
        let mut flow = scene.flow()?;
        let forced = self.forced_flight(self.bare(&scene), &coordinates, &flow)?;
        if let Some(forced) = &forced {
            flow = forced.flow.clone();
        }
        let mut system = HybridSystem::new(scene.time_step);
        system.handles = scene.declared();
        let mut limits = Vec::new();
        let mut domains = scene.domains();
        for contact in &contacts {
            limits.extend(outside(&scene, contact, &flow, &mut domains));
        }
        for (name, domain) in scene.state_names().into_iter().zip(domains) {
            system = system.with_state(name, domain);
        }
        for (name, range) in scene.input_ranges() {
            system = system.with_input(name, range);
        }
        if let Some(ForcedFlight { user, .. }) = forced {
            let known = system.inputs.len();
            if !coordinates.is_plain() {
                let functions = user.inputs.len() - known;
                coordinates.measures.extend(vec![Measure::PLAIN; functions]);
            }
            system.inputs.extend(user.inputs.into_iter().skip(known));
            (system.functions, system.handles) = (user.functions, user.handles);
        }
        system = limits.into_iter().fold(system, HybridSystem::with_limit);
        system.norms.extend(scene.balls(&flow));
        if scene.bodies.iter().any(|body| !body.pushes.is_empty()) {
            let none = vec![Interval::point(0.0); scene.axes()];
            let pushes = scene.bodies.iter().flat_map(|body| match body.pushes.is_empty() {
                true => [&none[..], &none].concat(),
                false => [&none[..], &body.pushes].concat(),
            });
            system.disturbance = pushes.collect();
            // Nothing pushes spins and headings.
            system.disturbance.resize(flow.states(), Interval::point(0.0));
        }
        for contact in &mut contacts {
            let writer = Writer { scene: &scene, contact, flow: &flow };
            let (transitions, modes) = writer.transitions()?;
            let choice = Choice::new(contact.name.clone());
            system =
                system.with_choice(transitions.into_iter().fold(choice, Choice::with_transition));
            contact.modes = modes;
        }
        if contacts.is_empty() {
            system = system.with_transition(Transition::new("flight", flow.clone()));
        }
        if contacts.len() > 1 {
            system = system.with_flow(flow);
        }
        system.check()?;
        let source = self.clone();
        Ok(Stated { source, units, scene, contacts, system, coordinates })
    }

    /// The names of the states: for each body, positions and then velocities; then spins.
    pub(super) fn state_names(&self) -> Vec<String> {
        let axes = &AXES[..self.axes()];
        let of = |name: &String| -> Vec<String> {
            let positions = axes.iter().map(|axis| format!("{name} {axis}"));
            positions.chain(axes.iter().map(|axis| format!("{name} v{axis}"))).collect()
        };
        let spins = self.spins().map(|(b, _)| format!("{} spin", self.bodies[b].name));
        let headings = self.headings().map(|(b, _)| format!("{} heading", self.bodies[b].name));
        let all = self.bodies.iter().flat_map(|body| of(&body.name));
        all.chain(spins).chain(headings).collect()
    }

    /// The domains of the states.
    fn domains(&self) -> Vec<Interval> {
        let of = |body: &Body| -> Vec<Interval> {
            let speed = Interval::new(-body.max_speed, body.max_speed);
            body.domain.iter().copied().chain(body.domain.iter().map(|_| speed)).collect()
        };
        let spins = self.spins().map(|(_, spin)| spin.rates());
        let headings = self.headings().map(|(_, range)| range);
        self.bodies.iter().flat_map(of).chain(spins).chain(headings).collect()
    }

    /// The inputs with their ranges: those along the axes of each body, and then torques.
    fn input_ranges(&self) -> Vec<(String, Interval)> {
        let of = |body: &Body| -> Vec<(String, Interval)> {
            let axes = AXES.iter().map(|axis| format!("{} a{axis}", body.name));
            axes.zip(body.acceleration.iter().copied()).collect()
        };
        let torques = self
            .spins()
            .map(|(b, spin)| (format!("{} torque", self.bodies[b].name), spin.torques()));
        self.bodies.iter().flat_map(of).chain(torques).collect()
    }

    /// The states and inputs of the scene as the user stated it, with the handles of a checked one.
    fn bare(&self, checked: &Scene) -> HybridSystem {
        let mut user = HybridSystem::new(self.time_step);
        user.handles = checked.declared();
        user.states = self.state_names().into_iter().zip(self.domains()).collect();
        let inputs = self.input_ranges().into_iter();
        user.inputs = inputs.map(|(name, range)| (name, Schedule::from(range))).collect();
        user
    }

    /// Free flight of all bodies.
    fn flow(&self) -> Result<LinearSystem, Error> {
        let flows = self.bodies.iter().map(|body| body.flow(self.time_step));
        let flows: Vec<LinearSystem> = flows.collect::<Result<_, _>>()?;
        let spins: Vec<Spin> = self.spins().map(|(_, spin)| spin).collect();
        let (d, count) = (self.axes(), flows.len());
        let width = |size: usize| size * count + spins.len();
        let states = width(2 * d) + self.headings().count();
        // On the diagonal: a block for each body, and an entry for each spin.
        let diagonal = |columns: usize,
                        size: usize,
                        of: &dyn Fn(&LinearSystem, usize, usize) -> f64,
                        of_spin: &dyn Fn(&Spin) -> f64| {
            Mat::from_fn(states, columns, |i, j| {
                match (i.checked_sub(2 * d * count), j.checked_sub(size * count)) {
                    (Some(own), Some(other)) if own == other => spins.get(own).map_or(0.0, of_spin),
                    (None, None) if i / (2 * d) == j / size => {
                        of(&flows[j / size], i % (2 * d), j % size)
                    }
                    _ => 0.0,
                }
            })
        };
        let dt = self.time_step;
        let mut a = diagonal(states, 2 * d, &|flow, i, j| flow.a()[(i, j)], &|_| 1.0);
        let mut b =
            diagonal(width(d), d, &|flow, i, j| flow.b()[(i, j)], &|spin| dt / spin.inertia);
        for (body, _) in self.headings() {
            let (heading, rate) = (self.heading_state(body), self.spin_state(body));
            let (Some(i), Some(j), Some(spin)) = (heading, rate, self.bodies[body].spin) else {
                continue;
            };
            (a[(i, i)], a[(i, j)]) = (1.0, dt);
            b[(i, j - d * count)] = 0.5 * dt * dt / spin.inertia;
        }
        let mut c: Vec<f64> = flows.iter().flat_map(|flow| flow.c().to_vec()).collect();
        c.resize(states, 0.0);
        LinearSystem::new(a, b, c)
    }

    /// The limits of the lengths of velocities and inputs.
    fn balls(&self, flow: &LinearSystem) -> Vec<NormLimit> {
        let (d, states) = (self.axes(), flow.states());
        let mut balls = Vec::new();
        for (b, body) in self.bodies.iter().enumerate() {
            if body.is_speed_ball {
                let name = format!("speed of {}", body.name);
                let first = 2 * d * b + d;
                balls.push(NormLimit::ball(name, first..first + d, states, body.max_speed));
            }
            if let Some(most) = body.acceleration_ball {
                let name = format!("acceleration of {}", body.name);
                let (first, width) = (states + d * b, states + flow.inputs());
                balls.push(NormLimit::ball(name, first..first + d, width, most));
            }
        }
        balls
    }

    /// Starts or goals of all bodies as one region.
    pub(super) fn ends(&self, system: &HybridSystem, is_start: bool) -> Region {
        let block = 2 * self.axes();
        let (mut ranges, mut spins, mut headings) = (Vec::new(), Vec::new(), Vec::new());
        let (mut halfspaces, mut norms) = (Vec::new(), Vec::new());
        for (b, body) in self.bodies.iter().enumerate() {
            let region = if is_start { &body.start } else { &body.goal };
            let spin = self.spin_state(b);
            let own = region.as_ref().and_then(|region| region.ranges.get(block));
            spins.extend(spin.map(|_| own.copied().unwrap_or(Interval::REALS)));
            let heading = self.heading_state(b);
            let own = region.as_ref().and_then(|region| region.ranges.get(block + 1));
            headings.extend(heading.map(|_| own.copied().unwrap_or(Interval::REALS)));
            match region {
                None => ranges.extend(vec![Interval::REALS; block]),
                Some(region) => {
                    ranges.extend(&region.ranges[..block]);
                    let place = |factors: &[f64]| {
                        let mut wide = vec![0.0; system.states.len()];
                        wide[block * b..block * (b + 1)].copy_from_slice(&factors[..block]);
                        if let (Some(spin), Some(factor)) = (spin, factors.get(block)) {
                            wide[spin] = *factor;
                        }
                        if let (Some(heading), Some(factor)) = (heading, factors.get(block + 1)) {
                            wide[heading] = *factor;
                        }
                        wide
                    };
                    norms.extend(region.norms.iter().map(|disc| disc.placed(place)));
                    halfspaces.extend(region.halfspaces.iter().map(|halfspace| {
                        let mut wide = halfspace.clone();
                        wide.normal = place(&halfspace.normal);
                        wide
                    }));
                }
            }
        }
        ranges.extend(spins);
        ranges.extend(headings);
        let region = halfspaces.into_iter().fold(Region::from(ranges), Region::with_halfspace);
        Region { norms, ..region }
    }
}

/// A contact with a single face holds its body outside at every sample: by its domain if that can
/// say it, otherwise by a limit.
fn outside(
    scene: &Scene,
    contact: &ContactPair,
    flow: &LinearSystem,
    domains: &mut [Interval],
) -> Option<Halfspace> {
    let [face] = &contact.faces[..] else { return None };
    let axis = face.normal.iter().position(|n| n.abs() == 1.0);
    if let (Some(axis), None, 1) = (axis, contact.other, face.limit.len()) {
        let domain = &mut domains[2 * scene.axes() * contact.body + axis];
        let at = face.normal[axis] * at(&face.limit, 0);
        if face.normal[axis] > 0.0 {
            domain.lower = domain.lower.max(at);
        } else {
            domain.upper = domain.upper.min(at);
        }
        return None;
    }
    let back = minus(&face.normal);
    let writer = Writer { scene, contact, flow };
    let limits = minus(&face.limit);
    Some(Halfspace::new(format!("outside {}", contact.name), writer.position(&back), limits))
}
