//! Messages between ranks, as the protocol needs them: by MPI, or between threads.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;
use std::time::Duration;

/// How long a rank with nothing to do waits between two looks at its messages.
const PAUSE: Duration = Duration::from_micros(200);

/// A rank's end of the messages between all ranks. Messages from one rank to another keep their
/// order.
pub trait Channel {
    /// The rank of this process, from 0.
    fn rank(&self) -> usize;

    /// The number of ranks.
    fn ranks(&self) -> usize;

    /// Sends bytes to a rank; may wait until that rank looks at its messages.
    fn send(&mut self, to: usize, bytes: &[u8]);

    /// The next message, with the rank that sent it; `None` if there is none now.
    fn receive(&mut self) -> Option<(usize, Vec<u8>)>;

    /// Waits a little, because there is nothing to do.
    fn pause(&mut self) {
        thread::sleep(PAUSE);
    }
}

/// The end of a channel whose ranks are threads of one process.
#[derive(Debug)]
pub struct ThreadChannel {
    rank: usize,
    to: Vec<Sender<(usize, Vec<u8>)>>,
    from: Receiver<(usize, Vec<u8>)>,
}

impl ThreadChannel {
    /// The ends of a channel of so many ranks, by rank.
    pub fn ends(ranks: usize) -> Vec<ThreadChannel> {
        let (to, from): (Vec<_>, Vec<_>) = (0..ranks).map(|_| channel()).unzip();
        let end = |(rank, from)| ThreadChannel { rank, to: to.clone(), from };
        from.into_iter().enumerate().map(end).collect()
    }
}

impl Channel for ThreadChannel {
    fn rank(&self) -> usize {
        self.rank
    }

    fn ranks(&self) -> usize {
        self.to.len()
    }

    fn send(&mut self, to: usize, bytes: &[u8]) {
        // A thread that has ended hears nothing more.
        let _ = self.to[to].send((self.rank, bytes.to_vec()));
    }

    fn receive(&mut self) -> Option<(usize, Vec<u8>)> {
        self.from.try_recv().ok()
    }
}
