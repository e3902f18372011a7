//! The text of a file or of the standard input, plain or compressed by gzip.

use std::io::{self, Read, Write};

use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;

/// The name that stands for the standard input.
pub(crate) const STANDARD_INPUT: &str = "-";

/// The first bytes of compressed files.
const GZIP: &[u8] = &[0x1f, 0x8b];
const OTHERS: [(&[u8], &str); 4] =
    [(b"BZh", "bzip2"), (b"\xfd7zXZ", "xz"), (b"\x28\xb5\x2f\xfd", "zstd"), (b"PK\x03\x04", "zip")];

/// Models as text become some tens of times smaller. What is much smaller is no model, and might
/// fill the memory.
const MOST_EXPANSION: u64 = 500;
/// Up to so many bytes, a text may expand as it likes.
const HARMLESS: u64 = 1 << 24;
/// No text has more bytes.
const MOST_BYTES: u64 = 1 << 32;

/// The text of a file. If it is not text, the error says where.
pub(crate) fn text(path: &str) -> Result<String, String> {
    decoded(path, contents(path)?)
}

/// The bytes of a file, expanded if they are compressed.
pub(crate) fn contents(path: &str) -> Result<Vec<u8>, String> {
    let name = name(path);
    let bytes = bytes(path).map_err(|error| format!("{name}: {error}"))?;
    if let Some((_, format)) = OTHERS.iter().find(|(first, _)| bytes.starts_with(first)) {
        return Err(format!(
            "{name}: it is compressed by {format}; only gzip is read, expand it first"
        ));
    }
    if bytes.starts_with(GZIP) { expanded(&bytes, name) } else { Ok(bytes) }
}

/// The name of a file in messages.
pub(crate) fn name(path: &str) -> &str {
    if path == STANDARD_INPUT { "standard input" } else { path }
}

/// The bytes of a file as text.
pub(crate) fn decoded(path: &str, bytes: Vec<u8>) -> Result<String, String> {
    let name = name(path);
    String::from_utf8(bytes).map_err(|error| {
        let before = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let before = String::from_utf8_lossy(before);
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
        format!("{name}: line {line}, column {column}: this is no text in UTF-8; save it as UTF-8")
    })
}

fn bytes(path: &str) -> io::Result<Vec<u8>> {
    if path != STANDARD_INPUT {
        return std::fs::read(path);
    }
    let mut bytes = Vec::new();
    io::stdin().lock().read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a file that gzip has compressed, which may have several parts.
fn expanded(bytes: &[u8], name: &str) -> Result<Vec<u8>, String> {
    let most = (bytes.len() as u64).saturating_mul(MOST_EXPANSION).clamp(HARMLESS, MOST_BYTES);
    let mut text = Vec::new();
    match MultiGzDecoder::new(bytes).take(most + 1).read_to_end(&mut text) {
        Err(error) => {
            Err(format!("{name}: the compressed data are damaged ({error}); fetch the file again"))
        }
        Ok(count) if count as u64 > most => Err(format!(
            "{name}: {} bytes expand to more than {most}, which no model does; if it is one, expand \
             it with gunzip first",
            bytes.len()
        )),
        Ok(_) => Ok(text),
    }
}

/// A text, compressed by gzip.
pub(crate) fn compressed(text: &str) -> io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(text.as_bytes())?;
    encoder.finish()
}
