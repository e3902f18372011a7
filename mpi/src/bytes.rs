//! Numbers, nodes and texts as bytes, for messages and checkpoints. Little-endian.

use carom::solver::OpenNode;

/// The checksum of bytes (FNV-1a).
pub(crate) fn checksum(bytes: &[u8]) -> u64 {
    let step = |hash: u64, &byte: &u8| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, step)
}

/// Writes values one after the other.
#[derive(Default)]
pub(crate) struct Writer {
    pub(crate) bytes: Vec<u8>,
}

impl Writer {
    pub(crate) fn whole(&mut self, value: u64) {
        self.bytes.extend(value.to_le_bytes());
    }

    pub(crate) fn number(&mut self, value: f64) {
        self.whole(value.to_bits());
    }

    pub(crate) fn flag(&mut self, value: bool) {
        self.bytes.push(u8::from(value));
    }

    pub(crate) fn text(&mut self, text: &str) {
        self.whole(text.len() as u64);
        self.bytes.extend(text.bytes());
    }

    /// A value that may be missing.
    pub(crate) fn maybe<T>(&mut self, value: Option<&T>, write: impl FnOnce(&mut Self, &T)) {
        self.flag(value.is_some());
        if let Some(value) = value {
            write(self, value);
        }
    }

    pub(crate) fn numbers(&mut self, values: &[f64]) {
        self.whole(values.len() as u64);
        values.iter().for_each(|&value| self.number(value));
    }

    pub(crate) fn nodes(&mut self, nodes: &[OpenNode]) {
        self.whole(nodes.len() as u64);
        for node in nodes {
            self.number(node.bound);
            self.whole(node.decisions.len() as u64);
            for &(column, is_upper, value) in &node.decisions {
                self.whole(2 * u64::from(column) + u64::from(is_upper));
                self.number(value);
            }
        }
    }
}

/// Reads what a [`Writer`] wrote; `None` where the bytes are something else.
pub(crate) struct Reader<'a> {
    rest: &'a [u8],
}

impl<'a> Reader<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Reader { rest: bytes }
    }

    pub(crate) fn whole(&mut self) -> Option<u64> {
        let (first, rest) = self.rest.split_first_chunk()?;
        self.rest = rest;
        Some(u64::from_le_bytes(*first))
    }

    pub(crate) fn number(&mut self) -> Option<f64> {
        self.whole().map(f64::from_bits)
    }

    pub(crate) fn flag(&mut self) -> Option<bool> {
        let (&first, rest) = self.rest.split_first()?;
        self.rest = rest;
        (first <= 1).then_some(first == 1)
    }

    /// A count of things of at least so many bytes each.
    fn count(&mut self, bytes: usize) -> Option<usize> {
        let count = usize::try_from(self.whole()?).ok()?;
        (count.checked_mul(bytes)? <= self.rest.len()).then_some(count)
    }

    pub(crate) fn text(&mut self) -> Option<String> {
        let length = self.count(1)?;
        let (text, rest) = self.rest.split_at(length);
        self.rest = rest;
        String::from_utf8(text.to_vec()).ok()
    }

    pub(crate) fn maybe<T>(
        &mut self,
        read: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<Option<T>> {
        if self.flag()? { read(self).map(Some) } else { Some(None) }
    }

    pub(crate) fn numbers(&mut self) -> Option<Vec<f64>> {
        let count = self.count(8)?;
        (0..count).map(|_| self.number()).collect()
    }

    pub(crate) fn nodes(&mut self) -> Option<Vec<OpenNode>> {
        let count = self.count(16)?;
        (0..count).map(|_| self.node()).collect()
    }

    fn node(&mut self) -> Option<OpenNode> {
        let bound = self.number()?;
        let count = self.count(16)?;
        let decision = |reader: &mut Self| {
            let (code, value) = (reader.whole()?, reader.number()?);
            Some((u32::try_from(code / 2).ok()?, code % 2 == 1, value))
        };
        let decisions = (0..count).map(|_| decision(self)).collect::<Option<_>>()?;
        Some(OpenNode { bound, decisions })
    }

    /// `None` unless everything was read.
    pub(crate) fn end(self) -> Option<()> {
        self.rest.is_empty().then_some(())
    }
}
