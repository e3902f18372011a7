//! Errors.

use std::path::{Path, PathBuf};

/// An error of a run on several ranks.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The model or the options cannot be solved, on one rank or on many.
    #[error(transparent)]
    Carom(#[from] carom::Error),
    /// A checkpoint cannot be read or written.
    #[error("checkpoint `{path}`: {source}; check the folder and the rights")]
    Io {
        /// The file.
        path: PathBuf,
        /// The reason that the system gives.
        source: std::io::Error,
    },
    /// There is a checkpoint already, and the run does not go on from it.
    #[error("checkpoint `{path}` exists; resume from it, remove it, or choose another file")]
    Exists {
        /// The file.
        path: PathBuf,
    },
    /// A file ends before the checkpoint does.
    #[error("checkpoint `{path}` is truncated: {found} bytes of {expected}; begin without it")]
    Truncated {
        /// The file.
        path: PathBuf,
        /// Its length, in bytes.
        found: usize,
        /// The least length of such a file, in bytes.
        expected: usize,
    },
    /// A file is no checkpoint, or its bytes are not those that were written.
    #[error("checkpoint `{path}` is corrupt: {what}; begin without it")]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// The fault.
        what: &'static str,
    },
    /// A checkpoint is about another model, or about the same model with other options or on
    /// another version.
    #[error("checkpoint `{path}` belongs to {of}; resume with what it was written for")]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Of which the checkpoint is.
        of: &'static str,
    },
    /// A rank has another presolved program than rank 0, so nodes cannot be exchanged with it.
    #[error(
        "rank {rank} has another presolved program than rank 0; run all ranks with the same build, \
         model and options, on the same kind of processor"
    )]
    OtherProgram {
        /// The rank.
        rank: usize,
    },
    /// A rank has sent something that is no message.
    #[error("rank {rank} has sent a message that cannot be read; run the same build on all ranks")]
    Message {
        /// The rank.
        rank: usize,
    },
    /// A case of a sweep failed on a rank.
    #[error("case {case} failed on rank {rank}: {text}")]
    Case {
        /// The number of the case.
        case: usize,
        /// The rank.
        rank: usize,
        /// Its words.
        text: String,
    },
}

impl Error {
    pub(crate) fn io(path: &Path, source: std::io::Error) -> Self {
        Error::Io { path: path.to_owned(), source }
    }
}
