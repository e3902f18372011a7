//! The programs of the suite.

use carom_model::error::Error;

use super::answer::Case;
use super::{conic, hybrid, linear, mixed};

/// The programs of the suite with their answers, for other tests (files, lowering, ...).
///
/// # Errors
///
/// The errors of building a model; none in practice.
pub fn answers() -> Result<Vec<Case>, Error> {
    let mut cases = linear::cases()?;
    cases.extend(mixed::cases()?);
    cases.extend(conic::cases()?);
    cases.extend(hybrid::cases()?);
    Ok(cases)
}
