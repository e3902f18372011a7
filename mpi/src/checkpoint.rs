//! Checkpoints: what is open of a tree, and the best point, in a file that is written whole or not
//! at all.
//!
//! A file is a line of text, the number of the model, the length of what follows, the trees, and a
//! checksum of all of it. A tree is the number of its presolved program, its bounds, its best point
//! and its open nodes.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;

use carom::solver::OpenNode;

use crate::bytes::{Reader, Writer, checksum};
use crate::error::Error;

const FIRST_LINE: &[u8] = b"carom-mpi checkpoint 2\n";

/// Bytes before the content: the first line, the number of the model, and the length.
const HEAD: usize = FIRST_LINE.len() + 16;

/// The state of a run: with it, and the model, it goes on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Checkpoint {
    /// The number of the model and its options.
    pub(crate) model: u64,
    /// The trees that were searched, and the one that is.
    pub(crate) trees: Vec<TreeState>,
}

/// The state of a tree.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TreeState {
    /// The number of the presolved program, to whose columns the rest belongs.
    pub(crate) program: u64,
    /// The smallest bound of what was closed without being infeasible.
    pub(crate) closed: f64,
    /// The smallest bound of what could be neither finished nor split.
    pub(crate) stalled: f64,
    /// The best point.
    pub(crate) point: Option<Vec<f64>>,
    /// Nodes that cover all that is not closed.
    pub(crate) open: Vec<OpenNode>,
}

impl Checkpoint {
    /// The open nodes of all trees.
    pub(crate) fn open_nodes(&self) -> usize {
        self.trees.iter().map(|tree| tree.open.len()).sum()
    }

    fn to_bytes(&self) -> Vec<u8> {
        let mut content = Writer::default();
        content.whole(self.trees.len() as u64);
        for tree in &self.trees {
            content.whole(tree.program);
            content.number(tree.closed);
            content.number(tree.stalled);
            content.maybe(tree.point.as_ref(), |out, point| out.numbers(point));
            content.nodes(&tree.open);
        }
        let mut out = Writer { bytes: FIRST_LINE.to_vec() };
        out.whole(self.model);
        out.whole(content.bytes.len() as u64);
        out.bytes.extend(content.bytes);
        let sum = checksum(&out.bytes);
        out.whole(sum);
        out.bytes
    }

    /// Writes the file: first another one beside it, which then takes its name.
    pub(crate) fn write(&self, path: &Path) -> Result<(), Error> {
        let failed = |source| Error::io(path, source);
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        let mut file =
            tempfile::NamedTempFile::new_in(folder.unwrap_or(Path::new("."))).map_err(failed)?;
        file.write_all(&self.to_bytes()).map_err(failed)?;
        file.as_file().sync_all().map_err(failed)?;
        file.persist(path).map_err(|error| failed(error.error))?;
        Ok(())
    }

    /// Reads a file; `None` if there is none.
    ///
    /// # Arguments
    ///
    /// * `model`: the number that the file must have.
    pub(crate) fn read(path: &Path, model: u64) -> Result<Option<Self>, Error> {
        let bytes = match fs::read(path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(Error::io(path, error)),
        };
        let corrupt = |what| Error::Corrupt { path: path.to_owned(), what };
        let truncated =
            |expected| Error::Truncated { path: path.to_owned(), found: bytes.len(), expected };
        let begins = &FIRST_LINE[..FIRST_LINE.len().min(bytes.len())];
        if !bytes.starts_with(begins) {
            return Err(corrupt("the first line is not that of a checkpoint"));
        }
        if bytes.len() < HEAD + 8 {
            return Err(truncated(HEAD + 8));
        }
        let mut head = Reader::new(&bytes[FIRST_LINE.len()..]);
        let [Some(own), Some(length)] = [head.whole(), head.whole()] else {
            return Err(corrupt("the numbers of the head cannot be read"));
        };
        let end = usize::try_from(length).ok().and_then(|length| length.checked_add(HEAD));
        let end = end.filter(|end| end.checked_add(8).is_some());
        let Some(end) = end else { return Err(corrupt("its length is impossible")) };
        if bytes.len() < end + 8 {
            return Err(truncated(end + 8));
        }
        if bytes.len() > end + 8 {
            return Err(corrupt("it goes on after its end"));
        }
        if Reader::new(&bytes[end..]).whole() != Some(checksum(&bytes[..end])) {
            return Err(corrupt("the checksum differs"));
        }
        if own != model {
            return Err(Error::Foreign {
                path: path.to_owned(),
                of: "another model, or to this one with other options",
            });
        }
        let mut content = Reader::new(&bytes[HEAD..end]);
        let trees = content.whole().and_then(|count| {
            let tree = |_| TreeState::read(&mut content);
            (0..count).map(tree).collect::<Option<Vec<_>>>()
        });
        match trees.filter(|_| content.end().is_some()) {
            Some(trees) => Ok(Some(Checkpoint { model, trees })),
            None => Err(corrupt("its content cannot be read")),
        }
    }
}

impl TreeState {
    fn read(from: &mut Reader<'_>) -> Option<Self> {
        Some(TreeState {
            program: from.whole()?,
            closed: from.number()?,
            stalled: from.number()?,
            point: from.maybe(Reader::numbers)?,
            open: from.nodes()?,
        })
    }
}
