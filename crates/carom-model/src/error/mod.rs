//! The one error type: what went wrong, with the name of the thing and what to do about it.
//!
//! *Infeasible*, *unbounded* and *stopped by a limit* are not errors; they are statuses of a
//! [`Solution`](crate::solution::Solution).

pub(crate) mod checks;
mod code;
mod condition;
mod dead_end;
mod handle;
mod kind;
pub(crate) mod range;
mod robust;
mod run;
mod scene;
mod terminal;

use std::error::Error as StdError;
use std::fmt;
use std::ops::RangeBounds;
use std::sync::Arc;

pub(crate) use checks::{check_finite, check_length};
pub use condition::Condition;
pub use dead_end::{DeadEnd, TransitionCandidate};
pub use kind::ErrorKind;
pub(crate) use range::FINITE_POSITIVE;
pub use robust::RobustError;
pub use run::RunError;
pub use scene::SceneError;
pub use terminal::TerminalError;

/// An error in writing, lowering, solving or reading a model.
///
/// [`kind`](Self::kind) is what programs match on. The text is for people: what is wrong, then what
/// to do. [`source`](StdError::source) is the error underneath, if there is one: of the operating
/// system, of reading a number, of a solver outside the crate.
///
/// `{}` prints the text alone, and `{:#}` appends the sources, separated by colons. `{:?}` appends
/// the [`code`](Self::code) to that, by which the guide's page "Help" is searched.
///
/// ```
/// use carom::prelude::*;
/// use carom::ErrorKind;
///
/// let mut model = Model::new("m");
/// let error = model.continuous("x", 2.0, 1.0).unwrap_err();
/// assert!(matches!(error.kind(), ErrorKind::CrossedBounds { name, .. } if name == "x"));
/// assert_eq!(error.to_string(), "bounds of `x` are crossed: 2 > 1; swap or relax them");
/// ```
#[derive(Clone)]
pub struct Error {
    // Shared, because errors of the operating system cannot be cloned; one word wide, because
    // nearly every function of the crate returns it.
    inner: Arc<Inner>,
}

struct Inner {
    kind: ErrorKind,
    source: Option<Box<dyn StdError + Send + Sync>>,
}

impl Error {
    /// An error of a kind, with the error that caused it.
    ///
    /// An error without a cause is made from its kind alone, by [`From`].
    pub fn with_source(
        kind: ErrorKind,
        source: impl Into<Box<dyn StdError + Send + Sync>>,
    ) -> Self {
        Error { inner: Arc::new(Inner { kind, source: Some(source.into()) }) }
    }

    /// An error that the crate has no kind for, of the kind [`ErrorKind::Other`].
    ///
    /// Its text is the text of `source`. A [`Solver`](crate::solver::Solver) outside the crate
    /// returns its own errors in this way.
    pub fn other(source: impl Into<Box<dyn StdError + Send + Sync>>) -> Self {
        Error::with_source(ErrorKind::Other, source)
    }

    /// [`ErrorKind::OutOfRange`]. The words are made from the range: "at least 1", "below 5",
    /// "within [0, 1]", "finite and positive".
    #[doc(hidden)]
    pub fn out_of_range(what: impl Into<String>, value: f64, range: impl RangeBounds<f64>) -> Self {
        Error::out_of_range_with(what, value, range, "")
    }

    /// [`ErrorKind::OutOfRange`], with words that follow those of the range.
    #[doc(hidden)]
    pub fn out_of_range_with(
        what: impl Into<String>,
        value: f64,
        range: impl RangeBounds<f64>,
        more: &str,
    ) -> Self {
        let words = format!("{}{more}", range::words(&range));
        Error::out_of_range_in_words(what, value, range, words)
    }

    /// [`ErrorKind::OutOfRange`], with words that say more than the range.
    #[doc(hidden)]
    pub fn out_of_range_in_words(
        what: impl Into<String>,
        value: f64,
        range: impl RangeBounds<f64>,
        words: impl Into<String>,
    ) -> Self {
        let (lower, upper) = range::limits(&range);
        let (what, range) = (what.into(), words.into());
        ErrorKind::OutOfRange { what, value, lower, upper, range }.into()
    }

    /// [`ErrorKind::UnknownName`].
    #[doc(hidden)]
    pub fn unknown_name(name: &str, kind: &'static str) -> Self {
        ErrorKind::UnknownName { name: name.to_owned(), kind }.into()
    }

    /// [`ErrorKind::DuplicateName`].
    #[doc(hidden)]
    pub fn duplicate_name(name: &str, kind: &'static str) -> Self {
        ErrorKind::DuplicateName { name: name.to_owned(), kind }.into()
    }

    /// The kind of the error.
    pub fn kind(&self) -> &ErrorKind {
        &self.inner.kind
    }
}

impl From<ErrorKind> for Error {
    fn from(kind: ErrorKind) -> Self {
        Error { inner: Arc::new(Inner { kind, source: None }) }
    }
}

macro_rules! from_own {
    ($($own:ident: $kind:ident,)*) => {$(
        impl From<$own> for Error {
            fn from(error: $own) -> Self {
                ErrorKind::$kind(error).into()
            }
        }
    )*};
}

from_own! {
    SceneError: Scene,
    RunError: Run,
    RobustError: Robust,
    TerminalError: Terminal,
    DeadEnd: DeadEnd,
}

impl StdError for Error {
    fn source(&self) -> Option<&(dyn StdError + 'static)> {
        self.inner.source.as_ref().map(|source| &**source as &(dyn StdError + 'static))
    }
}

/// Equal kinds, and sources with equal texts.
impl PartialEq for Error {
    fn eq(&self, other: &Self) -> bool {
        self.kind() == other.kind() && format!("{self:#}") == format!("{other:#}")
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut source = self.source();
        match (self.kind(), source) {
            (ErrorKind::Other, Some(other)) => {
                write!(f, "{other}")?;
                source = other.source();
            }
            (kind, _) => write!(f, "{kind}")?,
        }
        while let Some(error) = source.filter(|_| f.alternate()) {
            write!(f, ": {error}")?;
            source = error.source();
        }
        Ok(())
    }
}

/// The text, the sources and the code: what `main` prints, and what a failed `unwrap` prints.
impl fmt::Debug for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{self:#} [{}]", self.code())
    }
}
