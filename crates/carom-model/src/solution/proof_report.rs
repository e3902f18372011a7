//! The report on a proof.

/// The report on a proof that was written for another program to check.
///
/// It says what was written, not that it is right: that is for the checker to say, see
/// the page on proofs of the guide.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ProofReport {
    /// Whether it covers the whole claim. Otherwise a limit came before its end, a part of the
    /// tree could not be proved from the rows of the model, or it could not be written; the checker
    /// will reject it.
    pub is_complete: bool,
    /// Its commands.
    pub commands: u64,
    /// Its size (bytes).
    pub bytes: u64,
    /// The bound that it claims, in the model's own sense and unit: no objective is better. It is
    /// looser than that of the solution by the gap at which the search may stop. `None` of a claim
    /// that there is no point.
    #[cfg_attr(feature = "serde", serde(default))]
    pub bound: Option<f64>,
    /// Why it could not be written to its end, with the path and the reason that the system gives;
    /// `None` if it was.
    #[cfg_attr(feature = "serde", serde(default))]
    pub failure: Option<String>,
}

impl ProofReport {
    /// The report of a writer; the fields say what each part means.
    #[doc(hidden)]
    pub fn new(is_complete: bool, commands: u64, bytes: u64) -> Self {
        ProofReport { is_complete, commands, bytes, bound: None, failure: None }
    }

    /// The report on a proof that could not be written to its end.
    #[doc(hidden)]
    pub fn failed(failure: String) -> Self {
        ProofReport { failure: Some(failure), ..ProofReport::new(false, 0, 0) }
    }
}
