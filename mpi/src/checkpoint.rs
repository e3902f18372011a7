//! Checkpoints: what is open of a tree, and the best point, in a file that is written whole or not at all.
//!
//! A file is a line of text, the numbers of the model and of the presolved program, the length of what
//! follows, the bounds, the best point and the open nodes, and a checksum of all of it.

use std::fs;
use std::io::{ErrorKind, Write};
use std::path::Path;

use carom::solver::OpenNode;

use crate::bytes::{Reader, Writer, checksum};
use crate::error::Error;

const FIRST_LINE: &[u8] = b"carom-mpi checkpoint 1\n";

/// Bytes before the content: the first line, two numbers, and the length.
const HEAD: usize = FIRST_LINE.len() + 24;

/// The state of a tree: with it, and the model, a search goes on.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Checkpoint {
    /// The number of the model and its options.
    pub(crate) model: u64,
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
    fn to_bytes(&self) -> Vec<u8> {
        let mut content = Writer::default();
        content.number(self.closed);
        content.number(self.stalled);
        content.maybe(self.point.as_ref(), |out, point| out.numbers(point));
        content.nodes(&self.open);
        let mut out = Writer { bytes: FIRST_LINE.to_vec() };
        out.whole(self.model);
        out.whole(self.program);
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
        let numbers = [head.whole(), head.whole(), head.whole()];
        let [Some(own), Some(program), Some(length)] = numbers else {
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
        let read = |from: &mut Reader<'_>| {
            Some(Checkpoint {
                model,
                program,
                closed: from.number()?,
                stalled: from.number()?,
                point: from.maybe(Reader::numbers)?,
                open: from.nodes()?,
            })
        };
        let checkpoint = read(&mut content);
        let whole = checkpoint.filter(|_| content.end().is_some());
        whole.map(Some).ok_or_else(|| corrupt("its content cannot be read"))
    }
}
