//! A solve on several ranks.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use carom::model::Model;
use carom::solution::Solution;
use carom::solver::{Control, Interrupt, Log, Options, Solver};
use carom::{BranchAndBound, ErrorKind};

use crate::bytes::checksum;
use crate::channel::Channel;
use crate::checkpoint::Checkpoint;
use crate::error::Error;
use crate::peer::RankCounts;
use crate::supervisor::{Checkpoints, Supervisor};
use crate::worker::Worker;

/// The most ranks of which rank 0 searches as well. Among more it only hands out nodes.
const MOST_WITH_WORKING_ROOT: usize = 8;

/// How a model is solved on several ranks: limits, checkpoints, log. All ranks make the same one.
#[derive(Debug, Clone, Default)]
#[must_use]
pub struct Run {
    options: Options,
    interrupt: Interrupt,
    checkpoint: Option<(PathBuf, Duration)>,
    resumes: bool,
    logs: bool,
    works: Option<bool>,
}

/// The answer of a run.
#[derive(Debug)]
#[non_exhaustive]
pub struct Answer {
    /// The verified solution, at rank 0; `None` at other ranks.
    pub solution: Option<Solution>,
    /// The work of each rank, at rank 0; empty at other ranks.
    pub ranks: Vec<RankCounts>,
    /// Why the last checkpoint could not be written, if it could not.
    pub unwritten: Option<Error>,
    /// The open nodes of the checkpoint that the run went on from; `None` if it began anew.
    pub resumed: Option<usize>,
}

impl Run {
    /// A run with these options. Each rank searches on one thread; limits count for all ranks
    /// together.
    pub fn new(options: &Options) -> Self {
        Run { options: options.clone(), ..Run::default() }
    }

    /// Writes the open nodes and the best point to a file: every so often and at the end.
    pub fn with_checkpoint(mut self, path: impl Into<PathBuf>, every: Duration) -> Self {
        self.checkpoint = Some((path.into(), every));
        self
    }

    /// Goes on from the checkpoint, if there is one. The number of ranks may be another one.
    pub fn with_resume(mut self, resumes: bool) -> Self {
        self.resumes = resumes;
        self
    }

    /// Writes the log of the search to standard error, at rank 0.
    pub fn with_log(mut self, logs: bool) -> Self {
        self.logs = logs;
        self
    }

    /// Stops the run when the handle is triggered at rank 0.
    pub fn with_interrupt(mut self, interrupt: &Interrupt) -> Self {
        self.interrupt = interrupt.clone();
        self
    }

    /// Sets whether rank 0 searches as well; default: among at most 8 ranks.
    pub fn with_working_root(mut self, works: bool) -> Self {
        self.works = Some(works);
        self
    }

    /// Solves a model on the ranks of an MPI communicator. All ranks call it with the same model.
    ///
    /// # Errors
    ///
    /// [`Error::Carom`] on all ranks for errors of the model or the options; the others at rank 0.
    #[cfg(feature = "mpi")]
    pub fn solve(
        &self,
        model: &Model,
        world: &mpi::topology::SimpleCommunicator,
    ) -> Result<Answer, Error> {
        self.solve_on(model, &mut crate::world::World::new(world))
    }

    /// Solves a model on the ranks of a channel.
    ///
    /// # Errors
    ///
    /// As for [`solve`](Self::solve).
    pub fn solve_on<C: Channel>(&self, model: &Model, channel: &mut C) -> Result<Answer, Error> {
        if self.options.pool > 1 {
            return Err(carom::Error::from(ErrorKind::Unsupported {
                solver: "carom-mpi".to_owned(),
                what: "a pool of several points".to_owned(),
                help: "ask for one point, or solve on one process".to_owned(),
            })
            .into());
        }
        if channel.rank() == 0 { self.lead(model, channel) } else { self.follow(model, channel) }
    }

    fn follow<C: Channel>(&self, model: &Model, channel: &mut C) -> Result<Answer, Error> {
        let interrupt = Interrupt::new();
        let mut worker = Worker::new(channel, &interrupt);
        let mut options = self.options.clone();
        options.node_limit = None;
        let mut solver = BranchAndBound::new(options);
        let mut control = Control::default().with_interrupt(&interrupt).with_exchange(&mut worker);
        let solved = solver.solve_with(model, &mut control);
        drop(control);
        worker.finish();
        match worker.error {
            Some(error) => Err(error),
            None => {
                solved.map(drop)?;
                Ok(Answer { solution: None, ranks: Vec::new(), unwritten: None, resumed: None })
            }
        }
    }

    fn lead<C: Channel>(&self, model: &Model, channel: &mut C) -> Result<Answer, Error> {
        let model_number = self.number(model);
        let resume = self.read(model_number);
        let works =
            channel.ranks() == 1 || self.works.unwrap_or(channel.ranks() <= MOST_WITH_WORKING_ROOT);
        let checkpoints = self.checkpoint.clone();
        let checkpoints =
            checkpoints.map(|(path, every)| Checkpoints { path, every, model: model_number });
        let node_limit = self.options.node_limit;
        let (resume, failed) = match resume {
            Ok(resume) => (resume, None),
            Err(error) => (None, Some(error)),
        };
        let resumed = resume.as_ref().map(Checkpoint::open_nodes);
        if let Some(open) = resumed.filter(|_| self.logs) {
            let nodes = if open == 1 { "open node" } else { "open nodes" };
            // A log that nobody reads is no error.
            let _ = writeln!(std::io::stderr(), "resumed with {open} {nodes}");
        }
        let mut supervisor = Supervisor::new(channel, works, node_limit, checkpoints, resume);
        if let Some(error) = failed {
            supervisor.finish();
            return Err(error);
        }
        let mut log = self.logs.then(|| Log::new(std::io::stderr()));
        let mut write = |event: &carom::solver::Event| {
            if let Some(log) = &mut log {
                log.record(event);
            }
        };
        let mut solver = BranchAndBound::new(self.options.clone());
        let mut control = Control::default()
            .with_interrupt(&self.interrupt)
            .with_progress(&mut write)
            .with_exchange(&mut supervisor);
        let solved = solver.solve_with(model, &mut control);
        drop(control);
        supervisor.finish();
        if let Some(error) = supervisor.error {
            return Err(error);
        }
        let (ranks, unwritten) = (supervisor.counts(), supervisor.unwritten);
        Ok(Answer { solution: Some(solved?), ranks, unwritten, resumed })
    }

    /// The number of a model with these options, for checkpoints: limits and threads do not count.
    fn number(&self, model: &Model) -> u64 {
        let mut options = self.options.clone().with_threads(1).with_deterministic(false);
        (options.time_limit, options.node_limit, options.memory_limit) = (None, None, None);
        checksum(format!("{model}\n{options:?}").as_bytes())
    }

    /// The checkpoint to go on from, if there is one.
    fn read(&self, model: u64) -> Result<Option<Checkpoint>, Error> {
        let Some((path, _)) = &self.checkpoint else { return Ok(None) };
        if !self.resumes && Path::exists(path) {
            return Err(Error::Exists { path: path.clone() });
        }
        if self.resumes { Checkpoint::read(path, model) } else { Ok(None) }
    }
}
