//! The files of `tests/corpus`, which are also what fuzzing begins with, and what it has found:
//! nothing panics, every error has a text, and what is read survives every format.

use std::fs;
use std::path::Path;

use carom::model::{cbf, lp, mps, nl, qplib};
use carom::prelude::*;

use crate::there_and_back::through_files;

/// Calls `visit` with each text of a folder of the corpus, and returns how many could be read.
fn each(folder: &str, visit: impl Fn(&str) -> Result<Model, String>) -> usize {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus").join(folder);
    let mut paths: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let read = paths.iter().filter(|path| {
        let bytes = fs::read(path).unwrap();
        match visit(&String::from_utf8_lossy(&bytes)) {
            Ok(model) => {
                through_files(&model);
                true
            }
            Err(text) => {
                assert!(!text.is_empty(), "{}", path.display());
                false
            }
        }
    });
    read.count()
}

#[test]
fn lp_files() {
    let read = |text: &str| lp::read(text).map(|read| read.model).map_err(|e| e.to_string());
    assert!(each("lp", read) >= 9);
    // What is meant for others is refused, not misread.
    each("mps", read);
    each("json", read);
}

#[test]
fn mps_files() {
    let read = |text: &str| mps::read(text).map(|read| read.model).map_err(|e| e.to_string());
    assert!(each("mps", read) >= 7);
    each("lp", read);
    each("json", read);
}

#[test]
fn cbf_files() {
    let read = |text: &str| cbf::read(text).map(|read| read.model).map_err(|e| e.to_string());
    assert!(each("cbf", read) >= 2);
    each("lp", read);
    each("mps", read);
}

#[test]
fn qplib_files() {
    let read = |text: &str| qplib::read(text).map(|read| read.model).map_err(|e| e.to_string());
    assert!(each("qplib", read) >= 2);
    each("lp", read);
    each("cbf", read);
}

#[test]
fn nl_files() {
    let read = |text: &str| nl::read(text).map(|read| read.model).map_err(|e| e.to_string());
    assert!(each("nl", read) >= 3);
    each("lp", read);
    each("qplib", read);
}

#[cfg(feature = "serde")]
#[test]
fn json_files() {
    let read = |text: &str| serde_json::from_str::<Model>(text).map_err(|e| e.to_string());
    assert!(each("json", read) >= 3);
    each("lp", read);
    each("mps", read);
}
