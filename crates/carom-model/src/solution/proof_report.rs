//! The report on a proof.

/// The report on a proof that was written for another program to check.
///
/// It says what was written, not that it is right: that is for the checker to say, see
/// the page on proofs of the guide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProofReport {
    /// Whether it covers the whole claim. Otherwise a limit came before its end, or a part of the
    /// tree could not be proved from the rows of the model, and the checker will reject it.
    pub is_complete: bool,
    /// Its commands.
    pub commands: u64,
    /// Its size (bytes).
    pub bytes: u64,
}

impl ProofReport {
    /// The report of a writer; the fields say what each part means.
    #[doc(hidden)]
    pub fn new(is_complete: bool, commands: u64, bytes: u64) -> Self {
        ProofReport { is_complete, commands, bytes }
    }
}
