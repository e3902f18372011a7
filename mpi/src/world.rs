//! Messages by MPI.

use mpi::Rank;
use mpi::topology::SimpleCommunicator;
use mpi::traits::{Communicator, Destination, MatchedReceiveVec, Source};

use crate::channel::Channel;

/// An end of an MPI communicator.
pub(crate) struct World<'a> {
    world: &'a SimpleCommunicator,
}

impl<'a> World<'a> {
    pub(crate) fn new(world: &'a SimpleCommunicator) -> Self {
        World { world }
    }
}

impl Channel for World<'_> {
    fn rank(&self) -> usize {
        self.world.rank() as usize
    }

    fn ranks(&self) -> usize {
        self.world.size() as usize
    }

    fn send(&mut self, to: usize, bytes: &[u8]) {
        self.world.process_at_rank(to as Rank).send(bytes);
    }

    fn receive(&mut self) -> Option<(usize, Vec<u8>)> {
        let found = self.world.any_process().immediate_matched_probe()?;
        let (bytes, status) = found.matched_receive_vec::<u8>();
        Some((status.source_rank() as usize, bytes))
    }
}
