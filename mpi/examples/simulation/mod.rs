//! Events in their order: nodes that end, and messages that arrive at supervisors and at ranks.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, VecDeque};

/// Time of a message on its way, in s.
const LATENCY: f64 = 5e-6;

/// Time of a supervisor for a message, and for each node in it, in s: assumed, as is the time
/// on its way.
const HANDLING: f64 = 10e-6;
const PER_NODE: f64 = 1e-6;

/// The protocol of the crate: the time between two statuses of a rank is at least this, and this
/// share a rank, in s; most nodes in a message.
const STATUS: f64 = 10e-3;
const STATUS_SHARE: f64 = 50e-6;
const BATCH: usize = 16;

/// Ranks below a supervisor of the second level.
const GROUP: usize = 64;

/// Nodes a rank, about.
const NODES: u64 = 1000;

/// Who decides where nodes go.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Protocol {
    /// Ranks get each node from rank 0 and give its children back.
    NodeByNode,
    /// Ranks keep what they find; rank 0 keeps a stock and moves batches.
    Batches,
    /// The same, with a supervisor for each group of ranks.
    TwoLevels,
}

/// What is simulated.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub(crate) protocol: Protocol,
    pub(crate) ranks: usize,
    /// Times of nodes, in s, all equally likely.
    pub(crate) times: &'a [f64],
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    /// A node of a rank ends.
    End { rank: usize },
    /// A rank's nodes, and perhaps its wish for some, are handled by its supervisor.
    Handled { supervisor: usize, from: usize, nodes: usize, wants: bool },
    /// Nodes arrive at a rank, or at a supervisor from the one above.
    Arrive { at: usize, nodes: usize },
    /// A rank, or a supervisor, is asked for nodes.
    Asked { at: usize, nodes: usize },
}

/// A rank, or a supervisor.
#[derive(Default, Clone)]
struct Actor {
    open: usize,
    is_busy: bool,
    has_asked: bool,
    last_status: f64,
    busy: f64,
    /// For supervisors: until when messages are handled, who waits, and who was asked.
    until: f64,
    monotonicity: VecDeque<usize>,
    awaited: usize,
    members: Vec<usize>,
}

struct Simulation<'a> {
    setting: Setting<'a>,
    /// Ranks, then supervisors; the last one is rank 0.
    actors: Vec<Actor>,
    events: BinaryHeap<Reverse<(u64, u64, What)>>,
    serial: u64,
    created: u64,
    random: u64,
    now: f64,
}

/// The share of time in which ranks have a node.
pub(crate) fn efficiency(setting: Setting<'_>) -> f64 {
    let ranks = setting.ranks;
    let groups = if setting.protocol == Protocol::TwoLevels { ranks / GROUP } else { 0 };
    let mut actors = vec![Actor::default(); ranks + groups + 1];
    let root = ranks + groups;
    for rank in 0..ranks {
        let above = if groups > 0 { ranks + rank / GROUP } else { root };
        actors[above].members.push(rank);
    }
    if groups > 0 {
        actors[root].members = (ranks..root).collect();
    }
    actors[root].open = 1;
    let mut simulation = Simulation {
        setting,
        actors,
        events: BinaryHeap::new(),
        serial: 0,
        created: 1,
        random: 20_261_126,
        now: 0.0,
    };
    for rank in 0..ranks {
        simulation.tell(rank, 0, true);
    }
    while let Some(Reverse((time, _, what))) = simulation.events.pop() {
        simulation.now = f64::from_bits(time);
        simulation.act(what);
    }
    let busy: f64 = simulation.actors[..ranks].iter().map(|actor| actor.busy).sum();
    busy / (ranks as f64 * simulation.now)
}

impl Simulation<'_> {
    fn random(&mut self) -> f64 {
        self.random = self.random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (self.random >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn at(&mut self, time: f64, what: What) {
        self.serial += 1;
        self.events.push(Reverse((time.to_bits(), self.serial, what)));
    }

    fn above(&self, actor: usize) -> usize {
        let (ranks, root) = (self.setting.ranks, self.actors.len() - 1);
        if actor < ranks && self.setting.protocol == Protocol::TwoLevels && root > ranks {
            ranks + actor / GROUP
        } else {
            root
        }
    }

    /// A message to the supervisor, which handles it after those before.
    fn tell(&mut self, from: usize, nodes: usize, wants: bool) {
        let supervisor = self.above(from);
        let cost = HANDLING + PER_NODE * nodes as f64;
        let until = &mut self.actors[supervisor].until;
        *until = until.max(self.now + LATENCY) + cost;
        let time = *until;
        self.actors[from].has_asked |= wants;
        self.at(time, What::Handled { supervisor, from, nodes, wants });
    }

    fn act(&mut self, what: What) {
        match what {
            What::End { rank } => self.end(rank),
            What::Handled { supervisor, from, nodes, wants } => {
                if wants {
                    self.actors[supervisor].monotonicity.push_back(from);
                }
                if nodes > 0 {
                    let awaited = &mut self.actors[supervisor].awaited;
                    *awaited = awaited.saturating_sub(nodes);
                }
                self.actors[supervisor].open += nodes;
                self.share(supervisor);
                if !wants && self.setting.protocol != Protocol::NodeByNode {
                    self.ask(supervisor, from);
                }
                // A group speaks to rank 0 as a rank speaks to its group.
                let actor = &self.actors[supervisor];
                if supervisor + 1 < self.actors.len() && self.now - actor.last_status >= STATUS {
                    self.actors[supervisor].last_status = self.now;
                    self.tell(supervisor, 0, false);
                }
            }
            What::Arrive { at, nodes } => {
                self.actors[at].has_asked = false;
                self.actors[at].open += nodes;
                if at < self.setting.ranks { self.begin(at) } else { self.share(at) }
            }
            What::Asked { at, nodes } => {
                let given = nodes.min(self.actors[at].open / 2);
                self.actors[at].open -= given;
                let above = self.above(at);
                let awaited = &mut self.actors[above].awaited;
                *awaited = awaited.saturating_sub(nodes - given);
                if given > 0 {
                    self.tell(at, given, false);
                }
            }
        }
    }

    fn begin(&mut self, rank: usize) {
        if self.actors[rank].is_busy || self.actors[rank].open == 0 {
            return;
        }
        let pick = (self.random() * self.setting.times.len() as f64) as usize;
        let time = self.setting.times[pick];
        let actor = &mut self.actors[rank];
        (actor.is_busy, actor.open) = (true, actor.open - 1);
        actor.busy += time;
        self.at(self.now + time, What::End { rank });
    }

    fn end(&mut self, rank: usize) {
        let goal = NODES * self.setting.ranks as u64;
        let splits = if self.created < goal { 0.6 } else { 0.3 };
        // Trees of programs do not end at their top.
        let children = if self.created < 64 || self.random() < splits { 2 } else { 0 };
        self.created += children as u64;
        self.actors[rank].is_busy = false;
        if self.setting.protocol == Protocol::NodeByNode {
            return self.tell(rank, children, true);
        }
        let members = self.actors[self.above(rank)].members.len();
        let wait = STATUS.max(STATUS_SHARE * members as f64);
        let actor = &mut self.actors[rank];
        actor.open += children;
        if actor.open == 0 && !actor.has_asked {
            self.tell(rank, 0, true);
        } else if self.now - actor.last_status >= wait {
            actor.last_status = self.now;
            self.tell(rank, 0, false);
        }
        self.begin(rank);
    }

    /// Hands out what a supervisor has, and asks the one above where its ranks have too little.
    fn share(&mut self, supervisor: usize) {
        while let Some(to) = self.actors[supervisor].monotonicity.pop_front() {
            let (open, monotonicity) =
                (self.actors[supervisor].open, self.actors[supervisor].monotonicity.len());
            if open == 0 {
                self.actors[supervisor].monotonicity.push_front(to);
                break;
            }
            let most = if to < self.setting.ranks { BATCH } else { GROUP * BATCH };
            let nodes = match self.setting.protocol {
                Protocol::NodeByNode => 1,
                _ => (open / (monotonicity + 1)).clamp(1, most),
            };
            self.actors[supervisor].open -= nodes;
            let until = self.actors[supervisor].until.max(self.now) + PER_NODE * nodes as f64;
            self.actors[supervisor].until = until;
            self.at(until + LATENCY, What::Arrive { at: to, nodes });
        }
        let is_group = supervisor + 1 < self.actors.len();
        let actor = &self.actors[supervisor];
        let poor = !actor.monotonicity.is_empty()
            && actor.members.iter().all(|&member| self.actors[member].open < 2);
        if is_group && poor && !actor.has_asked {
            self.tell(supervisor, 0, true);
        }
        if !is_group && !self.actors[supervisor].monotonicity.is_empty() {
            // Groups are few, so rank 0 asks all that have nodes.
            let (members, ranks) = (self.actors[supervisor].members.clone(), self.setting.ranks);
            for group in members.into_iter().filter(|&member| member >= ranks) {
                self.ask(supervisor, group);
            }
        }
    }

    /// Asks a rank or a group that has spoken for nodes, if the stock is short.
    fn ask(&mut self, supervisor: usize, from: usize) {
        let actor = &self.actors[supervisor];
        let wanted = 2 * actor.monotonicity.len() + actor.members.len();
        // A group has a stock for others too, and rank 0 moves as many nodes as a group needs.
        let is_group = supervisor + 1 < self.actors.len();
        let wanted = match (is_group, from < self.setting.ranks) {
            (true, _) => 4 * wanted,
            (false, true) => wanted,
            (false, false) => GROUP * wanted,
        };
        let short = wanted.saturating_sub(actor.open + actor.awaited);
        let most = if from < self.setting.ranks { BATCH } else { GROUP * BATCH };
        let nodes = short.min(self.actors[from].open / 2).min(most);
        if nodes > 0 {
            self.actors[supervisor].awaited += nodes;
            self.at(self.now + LATENCY, What::Asked { at: from, nodes });
        }
    }
}
