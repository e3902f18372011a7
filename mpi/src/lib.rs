//! One search tree of [`carom`] on the ranks of an MPI run.
//!
//! ```no_run
//! use carom::prelude::*;
//!
//! # #[cfg(feature = "mpi")]
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let universe = mpi::initialize().expect("MPI");
//! let mut model = Model::new("m");
//! let x = model.integer("x", 0.0, 10.0)?;
//! model.add("odd", (2.0 * x).within(3.0, 9.0))?;
//! model.maximize(x)?;
//! let answer = carom_mpi::solve(&model, &Options::default(), &universe.world())?;
//! if let Some(solution) = answer.solution {
//!     println!("{}: {:?}", solution.termination(), solution.objective());
//! }
//! # Ok(())
//! # }
//! # #[cfg(not(feature = "mpi"))]
//! # fn main() {}
//! ```
//!
//! Every rank presolves the model by itself and comes to the same program, so what is sent is
//! small: a node is a list of decisions over columns of that program, with its bound. Rank 0 holds
//! the nodes that no rank has, hands them out with the best bound first, and asks ranks that have
//! many for some of theirs before others are idle. It verifies every point against the model, and
//! its bound is the least of all that is open anywhere; it concludes only when nothing is.
//!
//! * `message` - what ranks say to each other; `bytes` - numbers and nodes as bytes
//! * `channel` - carries messages between threads, `world` by MPI
//! * `supervisor` - rank 0; `worker` - the others
//! * `checkpoint` - files from which a run goes on
//! * `solve` - a run from start to end; `sweep` - many cases on the same ranks

mod bytes;
mod channel;
mod checkpoint;
mod error;
mod message;
mod peer;
mod solve;
mod supervisor;
mod sweep;
mod worker;
#[cfg(feature = "mpi")]
mod world;

pub use channel::{Channel, ThreadChannel};
pub use error::Error;
pub use peer::RankCounts;
pub use solve::{Answer, Run};
#[cfg(feature = "mpi")]
pub use sweep::sweep;
pub use sweep::sweep_on;

/// Solves a model on the ranks of an MPI communicator. All ranks call it with the same model and
/// options. [`Run`] has checkpoints and a log.
///
/// # Errors
///
/// As for [`Run::solve`].
#[cfg(feature = "mpi")]
pub fn solve(
    model: &carom::model::Model,
    options: &carom::solver::Options,
    world: &mpi::topology::SimpleCommunicator,
) -> Result<Answer, Error> {
    Run::new(options).solve(model, world)
}
