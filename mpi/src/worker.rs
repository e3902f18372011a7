//! A rank that searches what rank 0 hands to it.

use std::time::{Duration, Instant};

use carom::prelude::{Interrupt, Termination};
use carom::solver::{OpenNode, TreeExchange, TreePart};

use crate::channel::Channel;
use crate::error::Error;
use crate::message::{Orders, Status};
use crate::peer::BETWEEN_LOOKS;

/// Every rank between 1 and so many adds to the time between two statuses of a worker, so that rank
/// 0 hears a bounded number a second.
const STATUS_SHARE: Duration = Duration::from_micros(50);

/// The least time between two statuses of a worker.
const LEAST_WAIT: Duration = Duration::from_millis(10);

/// A worker's end of the protocol.
pub(crate) struct Worker<'a, C> {
    channel: &'a mut C,
    program: Option<u64>,
    /// Stops the solve of this rank once the whole search is over.
    interrupt: Interrupt,
    /// Whether a status waits for its orders.
    is_waiting: bool,
    /// Whether the last word about the present tree was said.
    has_ended: bool,
    /// Whether it was the last tree.
    is_over: bool,
    last_look: Option<Instant>,
    last_status: Option<Instant>,
    /// The value of the best point that rank 0 knows of.
    told: f64,
    given: Vec<OpenNode>,
    listing: bool,
    /// When the worker began to search nodes without a pause, and the time before that.
    busy: (Option<Instant>, Duration),
    pub(crate) error: Option<Error>,
}

impl<'a, C: Channel> Worker<'a, C> {
    pub(crate) fn new(channel: &'a mut C, interrupt: &Interrupt) -> Self {
        Worker {
            channel,
            program: None,
            interrupt: interrupt.clone(),
            is_waiting: false,
            has_ended: false,
            is_over: false,
            last_look: None,
            last_status: None,
            told: f64::INFINITY,
            given: Vec::new(),
            listing: false,
            busy: (None, Duration::ZERO),
            error: None,
        }
    }

    fn send(&mut self, status: &Status) {
        self.channel.send(0, &status.to_bytes());
        self.is_waiting = status.last.is_none();
        self.last_status = Some(Instant::now());
    }

    /// The orders that have come, if they have.
    fn orders(&mut self) -> Option<Orders> {
        let (rank, bytes) = self.channel.receive()?;
        self.is_waiting = false;
        let orders = Orders::from_bytes(&bytes);
        if orders.is_none() {
            self.error = Some(Error::Message { rank });
        }
        Some(orders.unwrap_or(Orders { ends: true, stop: true, ..Orders::default() }))
    }

    /// Takes part until rank 0 ends the search, once this rank's own search is over or has never
    /// begun.
    pub(crate) fn finish(&mut self) {
        while !self.is_over {
            if !self.is_waiting {
                let given = std::mem::take(&mut self.given);
                self.send(&Status { given, ..Status::empty() });
            }
            match self.orders() {
                Some(Orders { ends: true, stop, .. }) => {
                    self.is_over = stop;
                    self.send(&Status { last: Some(("null".into(), 0.0)), ..Status::empty() });
                }
                // Nodes that come too late go back.
                Some(orders) => self.given = orders.nodes,
                None => self.channel.pause(),
            }
        }
    }

    fn obey(&mut self, orders: Orders, part: &mut dyn TreePart) {
        // Rank 0 does not know of a better point that was found while its orders were on their way.
        if let Some(point) = orders.point
            && part.offer(point)
        {
            self.told = part.incumbent().map_or(f64::INFINITY, |(value, _)| value);
        }
        if !orders.nodes.is_empty() && !part.put(orders.nodes) {
            self.error = Some(Error::Message { rank: 0 });
            part.note_doubt();
        }
        self.given.extend(part.take(orders.give as usize));
        self.listing |= orders.list;
        if orders.ends {
            part.stop(Termination::Interrupted);
            self.has_ended = true;
            if orders.stop {
                self.interrupt.trigger();
                self.is_over = true;
            }
            let counts = serde_json::to_string(&part.statistics()).unwrap_or_default();
            let listing = Some(part.open_nodes());
            let last = Some((counts, self.busy().as_secs_f64()));
            let status = Status { listing, last, ..self.status(part) };
            self.send(&status);
        }
    }

    fn busy(&self) -> Duration {
        self.busy.1 + self.busy.0.map_or(Duration::ZERO, |since| since.elapsed())
    }

    /// The present status. Takes what is to be given.
    fn status(&mut self, part: &dyn TreePart) -> Status {
        let best = part.incumbent().filter(|(value, _)| *value < self.told);
        if let Some((value, _)) = best {
            self.told = value;
        }
        let state = part.state();
        Status {
            program: self.program.filter(|_| state.ended.is_none()),
            open: state.open as u64,
            floor: state.floor,
            closed: state.closed,
            stalled: state.stalled,
            nodes: state.nodes,
            is_doubtful: state.is_doubtful,
            point: best.map(|(_, point)| point),
            given: std::mem::take(&mut self.given),
            listing: std::mem::take(&mut self.listing).then(|| part.open_nodes()),
            last: None,
        }
    }
}

impl<C: Channel> TreeExchange for Worker<'_, C> {
    fn begin(&mut self, program: u64, _: bool) -> bool {
        self.program = Some(program);
        (self.told, self.has_ended, self.listing) = (f64::INFINITY, self.is_over, false);
        false
    }

    fn meet(&mut self, part: &mut dyn TreePart, is_idle: bool) -> bool {
        if !is_idle && self.last_look.is_some_and(|last| last.elapsed() < BETWEEN_LOOKS) {
            return true;
        }
        self.last_look = Some(Instant::now());
        match (is_idle, self.busy.0) {
            (true, Some(since)) => self.busy = (None, self.busy.1 + since.elapsed()),
            (false, None) => self.busy.0 = Some(Instant::now()),
            _ => {}
        }
        if self.has_ended {
            return false;
        }
        if let Some(orders) = self.is_waiting.then(|| self.orders()).flatten() {
            self.obey(orders, part);
            if self.has_ended {
                return false;
            }
        }
        let state = part.state();
        if state.ended.is_some() {
            self.given.extend(part.take_all());
        }
        let wait = LEAST_WAIT.max(STATUS_SHARE * self.channel.ranks() as u32);
        let is_due = self.last_status.is_none_or(|last| last.elapsed() >= wait);
        let has_news = part.incumbent().is_some_and(|(value, _)| value < self.told)
            || !self.given.is_empty()
            || self.listing
            || state.is_doubtful;
        let is_empty = is_idle && state.open == 0;
        if !self.is_waiting && (is_due || has_news || is_empty) {
            let status = self.status(part);
            self.send(&status);
        }
        if is_empty {
            self.channel.pause();
        }
        true
    }
}
