//! Numbers as bytes in the machine's order, which is what numpy's `tobytes` gives and `frombuffer`
//! takes.

use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes};

/// Numbers of 8 bytes each.
const SIZE: usize = 8;

/// Numbers of the type `float64`.
#[derive(Debug, Clone)]
pub(crate) struct Floats(pub(crate) Vec<f64>);

/// Numbers of the type `int64`; negative ones count as 0.
#[derive(Debug, Clone)]
pub(crate) struct Places(pub(crate) Vec<usize>);

/// The words of 8 bytes of an object of Python's type `bytes`; a rest is left out.
fn words(object: Borrowed<'_, '_, PyAny>) -> PyResult<Vec<[u8; SIZE]>> {
    let bytes = object.cast::<PyBytes>()?;
    Ok(bytes.as_bytes().as_chunks::<SIZE>().0.to_vec())
}

impl<'a, 'py> FromPyObject<'a, 'py> for Floats {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Floats(words(object)?.into_iter().map(f64::from_ne_bytes).collect()))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Places {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let place = |word| usize::try_from(i64::from_ne_bytes(word)).unwrap_or(0);
        Ok(Places(words(object)?.into_iter().map(place).collect()))
    }
}

/// Numbers as bytes that numpy can write to, without a -0.
pub(crate) fn bytes<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyByteArray> {
    let mut bytes = Vec::with_capacity(SIZE * numbers.len());
    numbers.iter().for_each(|number| bytes.extend((number + 0.0).to_ne_bytes()));
    PyByteArray::new(py, &bytes)
}
