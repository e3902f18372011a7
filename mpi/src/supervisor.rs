//! Rank 0: it holds what is open anywhere, hands it out, and is the only one that concludes.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use carom::prelude::Termination;
use carom::solver::{Elsewhere, OpenNode, TreeExchange, TreePart};

use crate::channel::Channel;
use crate::checkpoint::{Checkpoint, TreeState};
use crate::error::Error;
use crate::message::{Orders, Status};
use crate::peer::{BETWEEN_LOOKS, Batch, Peer, RankCounts};

/// The least time between two nodes that a rank gets although it has some, because they are better
/// than its own: a node that moves loses the basis of its parent.
const BETWEEN_BETTER: Duration = Duration::from_millis(200);

/// The least time between two looks of rank 0 at its stock while it searches itself.
const BETWEEN: Duration = Duration::from_millis(5);

/// Where checkpoints go, and how often.
pub(crate) struct Checkpoints {
    pub(crate) path: PathBuf,
    pub(crate) every: Duration,
    pub(crate) model: u64,
}

/// The end of the protocol at rank 0.
pub(crate) struct Supervisor<'a, C> {
    channel: &'a mut C,
    program: Option<u64>,
    is_last: bool,
    /// The trees that are searched to their ends.
    searched: Vec<TreeState>,
    /// Whether rank 0 searches as well.
    works: bool,
    node_limit: Option<u64>,
    peers: Vec<Peer>,
    /// Open nodes that no rank has, by bound and age.
    pool: BTreeMap<(u64, u64), OpenNode>,
    serial: u64,
    /// The value of the best point, and how often it has changed.
    best: (f64, u64),
    /// The trees of a checkpoint, and the present one of them.
    resume: VecDeque<TreeState>,
    resumed: Option<TreeState>,
    checkpoints: Option<Checkpoints>,
    /// When the last checkpoint was begun. The first one is due as soon as there is a tree.
    last_checkpoint: Option<Instant>,
    /// The checkpoint that waits for lists of nodes.
    collecting: Option<Vec<OpenNode>>,
    last_look: Instant,
    last_share: Instant,
    batch: Batch,
    is_over: bool,
    own: RankCounts,
    /// Nodes of rank 0 in earlier trees.
    own_before: u64,
    busy_since: Option<Instant>,
    pub(crate) error: Option<Error>,
    /// Why the last checkpoint was not written.
    pub(crate) unwritten: Option<Error>,
}

/// An order of bounds as whole numbers.
fn order(bound: f64) -> u64 {
    let bits = bound.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

impl<'a, C: Channel> Supervisor<'a, C> {
    pub(crate) fn new(
        channel: &'a mut C,
        works: bool,
        node_limit: Option<u64>,
        checkpoints: Option<Checkpoints>,
        resume: Option<Checkpoint>,
    ) -> Self {
        let peers = (1..channel.ranks()).map(|_| Peer::new()).collect();
        Supervisor {
            channel,
            program: None,
            is_last: true,
            searched: Vec::new(),
            works,
            node_limit,
            peers,
            pool: BTreeMap::new(),
            serial: 0,
            best: (f64::INFINITY, 0),
            resume: resume.map(|checkpoint| checkpoint.trees.into()).unwrap_or_default(),
            resumed: None,
            checkpoints,
            last_checkpoint: None,
            collecting: None,
            last_look: Instant::now(),
            last_share: Instant::now(),
            batch: Batch::new(),
            is_over: false,
            own: RankCounts { rank: 0, nodes: 0, handed: 0, given: 0, busy: 0.0 },
            own_before: 0,
            busy_since: None,
            error: None,
            unwritten: None,
        }
    }

    /// Ends the search of all ranks where rank 0 has not searched, or has failed.
    pub(crate) fn finish(&mut self) {
        let is_over = |peer: &Peer| peer.told_stop && peer.has_ended;
        for peer in &mut self.peers {
            peer.is_waiting |= peer.early.take().is_some();
        }
        while !self.peers.iter().all(is_over) {
            while let Some((rank, status)) = self.next() {
                self.note_last(rank, &status);
            }
            self.end_waiting(true);
            self.channel.pause();
        }
        self.is_over = true;
    }

    /// The work of each rank.
    pub(crate) fn counts(&self) -> Vec<RankCounts> {
        let of = |(k, peer): (usize, &Peer)| RankCounts {
            rank: k + 1,
            nodes: peer.nodes_before + peer.nodes,
            handed: peer.handed,
            given: peer.given,
            busy: peer.busy,
        };
        std::iter::once(self.own).chain(self.peers.iter().enumerate().map(of)).collect()
    }

    fn next(&mut self) -> Option<(usize, Status)> {
        let (rank, bytes) = self.channel.receive()?;
        let status = Status::from_bytes(&bytes).unwrap_or_else(|| {
            self.error.get_or_insert(Error::Message { rank });
            Status::empty()
        });
        Some((rank, status))
    }

    /// The next status about the present tree: what came too early for the one before is first.
    fn next_status(&mut self) -> Option<(usize, Status)> {
        let early = self.peers.iter_mut().enumerate().filter(|(_, peer)| !peer.has_ended);
        let early = early.filter_map(|(k, peer)| Some((k + 1, peer.early.take()?))).next();
        early.or_else(|| self.next())
    }

    fn note_last(&mut self, rank: usize, status: &Status) {
        let peer = &mut self.peers[rank - 1];
        peer.is_waiting = status.last.is_none();
        if let Some((counts, busy)) = &status.last {
            peer.has_ended = true;
            (peer.counts, peer.busy) = (serde_json::from_str(counts).ok(), busy.max(peer.busy));
        }
    }

    /// Ends the tree of those that wait, or the run.
    fn end_waiting(&mut self, stop: bool) {
        for (k, peer) in self.peers.iter_mut().enumerate() {
            if std::mem::take(&mut peer.is_waiting) {
                (peer.told_end, peer.told_stop, peer.has_ended) = (true, stop, false);
                let orders = Orders { ends: true, stop, ..Orders::default() };
                self.channel.send(k + 1, &orders.to_bytes());
            }
        }
    }

    fn keep(&mut self, nodes: Vec<OpenNode>) {
        for node in nodes {
            self.serial += 1;
            self.pool.insert((order(node.bound), self.serial), node);
        }
    }

    /// The best nodes of the pool.
    fn pick(&mut self, count: usize) -> Vec<OpenNode> {
        let nodes = (0..count).map_while(|_| self.pool.pop_first());
        nodes.map(|(_, node)| node).collect()
    }

    fn pool_floor(&self) -> f64 {
        self.pool.first_key_value().map_or(f64::INFINITY, |(_, node)| node.bound)
    }

    /// Reads what workers have said.
    fn hear(&mut self, part: &mut dyn TreePart) {
        while let Some((rank, mut status)) = self.next_status() {
            if self.peers[rank - 1].has_ended {
                self.peers[rank - 1].early = Some(status);
                continue;
            }
            self.note_last(rank, &status);
            if status.program.is_some() && status.program != self.program {
                self.error.get_or_insert(Error::OtherProgram { rank });
                part.stop(Termination::Interrupted);
                status.program = None;
            }
            part.note_closed(status.closed, status.stalled);
            if status.is_doubtful {
                part.note_doubt();
            }
            if let Some(point) = status.point.take() {
                part.offer(point);
            }
            let peer = &mut self.peers[rank - 1];
            (peer.takes, peer.nodes) = (status.program.is_some(), status.nodes.max(peer.nodes));
            (peer.open, peer.floor) = (status.open as usize, status.floor);
            peer.given += status.given.len() as u64;
            let is_listed = peer.lists && (status.listing.is_some() || status.open == 0);
            if let Some(all) = self.collecting.as_mut().filter(|_| peer.lists) {
                all.extend(status.given.iter().cloned());
                all.extend(status.listing.iter().flatten().cloned());
            }
            if is_listed {
                (peer.lists, peer.told_to_list) = (false, false);
            }
            self.keep(status.given);
            if status.last.is_some() {
                let peer = &mut self.peers[rank - 1];
                (peer.open, peer.floor) = (0, f64::INFINITY);
                self.keep(status.listing.unwrap_or_default());
            }
        }
        if let Some((value, _)) = part.incumbent().filter(|(value, _)| *value < self.best.0) {
            self.best = (value, self.best.1 + 1);
        }
    }

    /// Closes what the best point has made superfluous.
    fn prune(&mut self, part: &mut dyn TreePart) {
        let cutoff = part.state().cutoff;
        while let Some(last) = self.pool.last_entry().filter(|last| last.get().bound >= cutoff) {
            part.note_closed(last.remove().bound, f64::INFINITY);
        }
    }

    /// Moves nodes between rank 0's own tree, the pool and the workers.
    fn share(&mut self, part: &mut dyn TreePart) {
        self.prune(part);
        let takers = self.peers.iter().filter(|peer| peer.takes).count();
        let idle = self.peers.iter().filter(|peer| peer.is_hungry()).count();
        if !self.works {
            let all = part.take_all();
            self.own.given += all.len() as u64;
            self.keep(all);
        } else {
            self.feed_itself(part, idle);
        }
        // The stock covers those that are idle and as many as may soon be.
        let batches = self.peers.iter().filter(|peer| peer.takes).map(|peer| peer.batch.size);
        let wanted = idle * 2 + batches.sum::<usize>();
        let short = wanted.saturating_sub(self.pool.len());
        if self.works && short > 0 {
            let spare = part.state().open.saturating_sub(1).div_ceil(2);
            let own = part.take(short.min(spare));
            self.own.given += own.len() as u64;
            self.keep(own);
        }
        let rich = self.peers.iter().filter(|peer| peer.open > 2).count().max(1);
        let wanted = wanted + if self.works { self.batch.size } else { 0 };
        let short = wanted.saturating_sub(self.pool.len()).div_ceil(rich);
        for peer in self.peers.iter_mut().filter(|peer| peer.open > 2) {
            peer.asked = short.min(peer.open / 2);
        }
        let share = (self.pool.len() / (takers + 1)).max(1);
        let point = part.incumbent();
        for k in 0..self.peers.len() {
            self.answer(k, share, point.as_ref().map(|(_, point)| point));
        }
    }

    /// Gives rank 0 itself nodes: when it has none, or when the pool has better ones.
    fn feed_itself(&mut self, part: &mut dyn TreePart, idle: usize) {
        let state = part.state();
        let count = match state.open {
            0 if self.pool.is_empty() => return,
            0 => {
                self.batch.adapt();
                (self.pool.len() / (idle + 1)).clamp(1, self.batch.size)
            }
            _ if self.pool_floor() < state.floor
                && idle == 0
                && self.batch.since.elapsed() >= BETWEEN_BETTER =>
            {
                1
            }
            _ => return,
        };
        self.batch.since = Instant::now();
        let nodes = self.pick(count);
        self.own.handed += nodes.len() as u64;
        if !part.put(nodes) {
            self.error.get_or_insert(Error::Message { rank: 0 });
            part.note_doubt();
        }
    }

    /// Answers a worker that waits, unless it is idle and there is nothing for it.
    fn answer(&mut self, k: usize, share: usize, point: Option<&Vec<f64>>) {
        let floor = self.pool_floor();
        let peer = &mut self.peers[k];
        let is_idle = peer.open == 0;
        if !peer.is_waiting || is_idle && (!peer.takes || self.pool.is_empty()) {
            return;
        }
        let count = match (peer.takes, is_idle) {
            (false, _) => 0,
            (true, true) => {
                peer.batch.adapt();
                share.min(peer.batch.size)
            }
            (true, false) => {
                let is_due = peer.batch.since.elapsed() >= BETWEEN_BETTER;
                usize::from(floor < peer.floor && is_due)
            }
        };
        let nodes = self.pick(count);
        let peer = &mut self.peers[k];
        if !nodes.is_empty() {
            peer.batch.since = Instant::now();
        }
        peer.handed += nodes.len() as u64;
        peer.open += nodes.len();
        peer.floor = nodes.iter().fold(peer.floor, |floor, node| floor.min(node.bound));
        let is_news = peer.version < self.best.1;
        let list = peer.lists && !peer.told_to_list;
        peer.told_to_list |= list;
        let orders = Orders {
            nodes,
            point: point.filter(|_| is_news).cloned(),
            give: std::mem::take(&mut peer.asked) as u64,
            list,
            ..Orders::default()
        };
        (peer.version, peer.is_waiting) = (self.best.1, false);
        self.channel.send(k + 1, &orders.to_bytes());
    }

    /// Begins a checkpoint when it is due, and writes it once all lists are there.
    fn save(&mut self, part: &mut dyn TreePart) {
        let Some(Checkpoints { every, .. }) = self.checkpoints else { return };
        let is_due = |last: Instant| last.elapsed() >= every;
        if self.collecting.is_none() && self.last_checkpoint.is_none_or(is_due) {
            self.last_checkpoint = Some(Instant::now());
            let pool = self.pool.values().cloned();
            self.collecting = Some(part.open_nodes().into_iter().chain(pool).collect());
            for peer in &mut self.peers {
                // Who waits with nothing at hand, or has not begun, has nothing to list.
                (peer.lists, peer.told_to_list) = (peer.open > 0, false);
            }
        }
        if self.peers.iter().any(|peer| peer.lists) {
            return;
        }
        if let Some(open) = self.collecting.take() {
            self.write(part, open);
        }
    }

    fn write(&mut self, part: &mut dyn TreePart, open: Vec<OpenNode>) {
        let (Some(checkpoints), Some(program)) = (&self.checkpoints, self.program) else { return };
        let state = part.state();
        let tree = TreeState {
            program,
            closed: state.closed,
            stalled: state.stalled,
            point: part.incumbent().map(|(_, point)| point),
            open,
        };
        self.searched.push(tree);
        let checkpoint =
            Checkpoint { model: checkpoints.model, trees: std::mem::take(&mut self.searched) };
        // A full disk ends no search.
        self.unwritten = checkpoint.write(&checkpoints.path).err();
        self.searched = checkpoint.trees;
        if !self.is_over {
            self.searched.pop();
        }
    }

    fn note_elsewhere(&self, part: &mut dyn TreePart) {
        let mut elsewhere = Elsewhere { floor: self.pool_floor(), open: self.pool.len(), nodes: 0 };
        for peer in &self.peers {
            elsewhere.floor = elsewhere.floor.min(peer.floor);
            elsewhere.open += peer.open;
            elsewhere.nodes += if peer.has_ended { 0 } else { peer.nodes };
        }
        part.note_elsewhere(elsewhere);
    }

    /// Ends the search of all ranks, and takes in what they had left.
    fn close(&mut self, part: &mut dyn TreePart) {
        self.collecting = None;
        while self.peers.iter().any(|peer| !(peer.told_end && peer.has_ended)) {
            self.hear(part);
            self.end_waiting(self.is_last);
            self.channel.pause();
        }
        self.is_over = true;
        for counts in self.peers.iter().filter_map(|peer| peer.counts.as_ref()) {
            part.add_statistics(counts);
        }
        self.prune(part);
        self.note_elsewhere(part);
        if self.checkpoints.is_some() && self.error.is_none() {
            let open = part.open_nodes().into_iter().chain(self.pool.values().cloned()).collect();
            self.write(part, open);
        }
    }

    /// Begins where a checkpoint ends.
    fn begin_again(&mut self, part: &mut dyn TreePart) {
        let Some(tree) = self.resumed.take() else { return };
        part.note_closed(tree.closed, tree.stalled);
        if let Some(point) = tree.point {
            part.offer(point);
        }
        self.keep(tree.open);
    }

    fn note_time(&mut self, is_idle: bool) {
        match (is_idle, self.busy_since) {
            (true, Some(since)) => {
                self.own.busy += since.elapsed().as_secs_f64();
                self.busy_since = None;
            }
            (false, None) => self.busy_since = Some(Instant::now()),
            _ => {}
        }
    }
}

impl<C: Channel> TreeExchange for Supervisor<'_, C> {
    fn begin(&mut self, program: u64, is_last: bool) -> bool {
        (self.program, self.is_last, self.is_over) = (Some(program), is_last, false);
        (self.best, self.own_before) = ((f64::INFINITY, 0), self.own.nodes);
        self.pool.clear();
        for peer in &mut self.peers {
            peer.begin();
        }
        self.resumed = self.resume.pop_front();
        if self.resumed.as_ref().is_some_and(|tree| tree.program != program) {
            let of = "another version or processor";
            let path = self.checkpoints.as_ref().map(|own| own.path.clone()).unwrap_or_default();
            self.error = Some(Error::Foreign { path, of });
        }
        self.resumed.is_none()
    }

    fn meet(&mut self, part: &mut dyn TreePart, is_idle: bool) -> bool {
        if self.is_over {
            return false;
        }
        if !is_idle && self.last_look.elapsed() < BETWEEN_LOOKS {
            return true;
        }
        self.last_look = Instant::now();
        self.note_time(is_idle);
        if self.error.is_none() {
            self.begin_again(part);
        }
        self.hear(part);
        let state = part.state();
        self.own.nodes = self.own_before + state.nodes;
        let nodes = self.counts().iter().map(|counts| counts.nodes).sum();
        if self.error.is_some() {
            part.stop(Termination::Interrupted);
        } else if self.node_limit.is_some_and(|limit: u64| limit <= nodes) {
            part.stop(Termination::NodeLimit);
        }
        if part.state().ended.is_some() {
            self.note_elsewhere(part);
            if is_idle {
                self.close(part);
            }
            return false;
        }
        let is_hungry = self.peers.iter().any(Peer::is_hungry);
        let is_due = is_idle || is_hungry || self.last_share.elapsed() >= BETWEEN;
        if is_due {
            self.last_share = Instant::now();
            self.share(part);
            self.save(part);
        }
        self.note_elsewhere(part);
        if is_idle && part.state().open == 0 && self.pool.is_empty() {
            if self.peers.iter().all(|peer| peer.open == 0) {
                self.close(part);
                return false;
            }
            self.channel.pause();
        }
        true
    }
}
