//! Texts as QPLIB files: they are read or refused, and what is read survives every format.

#![no_main]

#[path = "../../tests/files/there_and_back.rs"]
mod there_and_back;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(read) = carom::model::qplib::read(text) {
        there_and_back::through_files(&read.model);
    }
});
