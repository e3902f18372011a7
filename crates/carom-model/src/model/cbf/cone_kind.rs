//! The cones of CBF by name: those that are read, and why others are not.

use crate::error::Error;
use crate::model::text::token::Token;

/// A cone of a block.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ConeKind {
    Free,
    Zero,
    AtLeast,
    AtMost,
    /// `first >= |others|`.
    Norm,
    /// `2 first second >= |others|^2`, both at least 0.
    Rotated,
}

impl ConeKind {
    /// The cone of a name.
    pub(super) fn named(word: &Token<'_>) -> Result<ConeKind, Error> {
        Ok(match word.text {
            "F" => ConeKind::Free,
            "L=" => ConeKind::Zero,
            "L+" => ConeKind::AtLeast,
            "L-" => ConeKind::AtMost,
            "Q" => ConeKind::Norm,
            "QR" => ConeKind::Rotated,
            other => {
                let name = other.rsplit(':').next().unwrap_or(other).trim_end_matches('*');
                let family = match name {
                    "EXP" => Some("an exponential cone"),
                    "POW" => Some("a power cone"),
                    "GMEANABS" | "GMEAN" => Some("a cone of geometric means"),
                    "SVECPSD" => Some("a semidefinite cone"),
                    _ => None,
                };
                return Err(word.error(match family {
                    Some(family) => format!(
                        "cone `{other}` cannot be read: it is {family}, and a model has linear rows \
                         and second-order cones (F, L=, L+, L-, Q and QR); write it with these"
                    ),
                    None => format!(
                        "cone `{other}` is not known; expected F, L=, L+, L-, Q or QR (in these \
                         letters)"
                    ),
                }));
            }
        })
    }

    /// The name.
    pub(super) fn name(self) -> &'static str {
        match self {
            ConeKind::Free => "F",
            ConeKind::Zero => "L=",
            ConeKind::AtLeast => "L+",
            ConeKind::AtMost => "L-",
            ConeKind::Norm => "Q",
            ConeKind::Rotated => "QR",
        }
    }

    /// The number of entries before those whose length is limited; `None` for linear cones.
    pub(super) fn heads(self) -> Option<usize> {
        match self {
            ConeKind::Norm => Some(1),
            ConeKind::Rotated => Some(2),
            _ => None,
        }
    }

    /// The interval of each entry of a linear cone; of others that of their heads.
    pub(super) fn limits(self) -> (f64, f64) {
        match self {
            ConeKind::Free => (f64::NEG_INFINITY, f64::INFINITY),
            ConeKind::Zero => (0.0, 0.0),
            ConeKind::AtMost => (f64::NEG_INFINITY, 0.0),
            ConeKind::AtLeast | ConeKind::Norm | ConeKind::Rotated => (0.0, f64::INFINITY),
        }
    }
}
