//! Bytes as NL files, text or binary, and as answers to them: they are read or refused, and what is
//! read survives every format.

#![no_main]

#[path = "../../tests/files/there_and_back.rs"]
mod there_and_back;

use carom::model::nl::{self, SolFile};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(read) = nl::read(bytes) {
        there_and_back::through_files(&read.model);
    }
    if let Ok(answer) =
        std::str::from_utf8(bytes).map_err(drop).and_then(|text| SolFile::read(text).map_err(drop))
    {
        let text = answer.to_string();
        let again = SolFile::read(&text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert_eq!(again.to_string(), text);
    }
});
