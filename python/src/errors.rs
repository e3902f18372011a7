//! Errors as exceptions: what users can change is a `ValueError`, files are an `OSError`, and what
//! broke is a `RuntimeError`.

use carom::{Error, ErrorKind};
use pyo3::PyErr;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};

/// The exception for an error.
pub(crate) fn exception(error: &Error) -> PyErr {
    let text = format!("{error:#}");
    match error.kind() {
        ErrorKind::Io { .. } => PyOSError::new_err(text),
        ErrorKind::Backend { .. } | ErrorKind::Other => PyRuntimeError::new_err(text),
        _ => PyValueError::new_err(text),
    }
}

/// The exception for a solve whose thread has ended without an answer.
pub(crate) fn broken() -> PyErr {
    PyRuntimeError::new_err(
        "the solve broke off inside carom, which is a fault of carom; please report it with the \
         program (`Model.write` writes it to a file)",
    )
}
