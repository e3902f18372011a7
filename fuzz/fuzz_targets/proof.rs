//! Bytes as proofs and as model files: the checker and the readers of its package answer any of
//! them.

#![no_main]

use carom_proof::compare::{Format, compare};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = carom_proof::check(bytes);
    if let Ok(text) = std::str::from_utf8(bytes) {
        for format in [Format::Mps, Format::Lp, Format::Cbf] {
            let _ = compare(text, format, bytes);
        }
    }
});
