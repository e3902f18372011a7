//! Sweeps whose cases run on the ranks of a run. Rank 0 hands out one case after the other and
//! appends the records to the file.

use carom::sweep::{Sweep, SweepCase, SweepRecord, SweepResults};

use crate::bytes::{Reader, Writer};
use crate::channel::Channel;
use crate::error::Error;

/// The message of a rank that asks for a case.
#[derive(Debug, PartialEq)]
enum Word {
    /// It has done nothing yet.
    Begin,
    /// The record of a case, as a line; `None` if the case was interrupted.
    Done(u64, Option<String>),
    /// A case failed.
    Failed(u64, String),
}

impl Word {
    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Writer::default();
        match self {
            Word::Begin => out.whole(0),
            Word::Done(case, line) => {
                out.whole(1);
                out.whole(*case);
                out.maybe(line.as_ref(), |out, line| out.text(line));
            }
            Word::Failed(case, text) => {
                out.whole(2);
                out.whole(*case);
                out.text(text);
            }
        }
        out.bytes
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let mut from = Reader::new(bytes);
        let word = match from.whole()? {
            0 => Word::Begin,
            1 => Word::Done(from.whole()?, from.maybe(Reader::text)?),
            2 => Word::Failed(from.whole()?, from.text()?),
            _ => return None,
        };
        from.end()?;
        Some(word)
    }
}

/// Runs the cases of a sweep on the ranks of an MPI communicator, one case a rank at a time. All
/// ranks call it with the same sweep; rank 0 alone opens the file, and runs no cases unless it is
/// alone.
///
/// # Errors
///
/// [`Error::Case`] for the first case that fails, and the errors of [`Sweep::run`], at rank 0.
#[cfg(feature = "mpi")]
pub fn sweep(
    sweep: &Sweep,
    world: &mpi::topology::SimpleCommunicator,
    answer: impl Fn(SweepCase<'_>) -> Result<Option<SweepRecord>, carom::Error> + Sync,
) -> Result<Option<SweepResults>, Error> {
    sweep_on(sweep, &mut crate::world::World::new(world), answer)
}

/// As [`sweep`](fn@crate::sweep), on the ranks of a channel.
///
/// # Errors
///
/// As for [`sweep`](fn@crate::sweep).
pub fn sweep_on<C: Channel>(
    sweep: &Sweep,
    channel: &mut C,
    answer: impl Fn(SweepCase<'_>) -> Result<Option<SweepRecord>, carom::Error> + Sync,
) -> Result<Option<SweepResults>, Error> {
    match (channel.rank(), channel.ranks()) {
        (0, 1) => Ok(Some(sweep.run(answer)?)),
        (0, _) => lead(sweep, channel).map(Some),
        _ => follow(sweep, channel, answer).map(|()| None),
    }
}

fn lead<C: Channel>(sweep: &Sweep, channel: &mut C) -> Result<SweepResults, Error> {
    let opened = sweep.open();
    let (mut file, mut failed) = match opened {
        Ok(file) => (Some(file), None),
        Err(error) => (None, Some(Error::from(error))),
    };
    let todo = file.as_ref().map_or(Vec::new(), |file| file.todo(sweep));
    let (mut todo, mut working) = (todo.into_iter(), channel.ranks() - 1);
    while working > 0 {
        let Some((rank, bytes)) = channel.receive() else {
            channel.pause();
            continue;
        };
        let note = match Word::from_bytes(&bytes) {
            Some(Word::Begin | Word::Done(_, None)) => Ok(()),
            Some(Word::Done(case, Some(line))) => {
                match (SweepRecord::from_line(&line), &mut file, usize::try_from(case)) {
                    (Some(record), Some(file), Ok(case)) if case < sweep.len() => {
                        file.append(sweep, case, record).map_err(Error::from)
                    }
                    _ => Err(Error::Message { rank }),
                }
            }
            Some(Word::Failed(case, text)) => Err(Error::Case { case: case as usize, rank, text }),
            None => Err(Error::Message { rank }),
        };
        failed = failed.or(note.err());
        let mut out = Writer::default();
        let next = if failed.is_none() { todo.next() } else { None };
        working -= usize::from(next.is_none());
        out.maybe(next.as_ref(), |out, &case| out.whole(case as u64));
        channel.send(rank, &out.bytes);
    }
    match (file, failed) {
        (Some(file), None) => Ok(file.into_results()),
        (_, Some(error)) => Err(error),
        (None, None) => Err(Error::Message { rank: 0 }),
    }
}

fn follow<C: Channel>(
    sweep: &Sweep,
    channel: &mut C,
    answer: impl Fn(SweepCase<'_>) -> Result<Option<SweepRecord>, carom::Error>,
) -> Result<(), Error> {
    let mut word = Word::Begin;
    loop {
        channel.send(0, &word.to_bytes());
        let (rank, bytes) = loop {
            match channel.receive() {
                Some(message) => break message,
                None => channel.pause(),
            }
        };
        let mut from = Reader::new(&bytes);
        match from.maybe(Reader::whole) {
            Some(Some(case)) if case < sweep.len() as u64 => {
                word = match answer(sweep.case(case as usize)) {
                    Ok(record) => Word::Done(case, record.map(|record| record.to_line())),
                    Err(error) => Word::Failed(case, error.to_string()),
                };
            }
            Some(None) => return Ok(()),
            _ => return Err(Error::Message { rank }),
        }
    }
}
