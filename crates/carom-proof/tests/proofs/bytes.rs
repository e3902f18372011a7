//! Any bytes are answered, without a panic.

use crate::enumeration::{Small, Writer};
use proptest::prelude::*;
use proptest::sample::Index;

/// A proof in which most commands occur.
fn proof() -> String {
    let small = Small {
        bounds: vec![(-1, 2), (0, 2)],
        rows: vec![(Some(1), None, vec![2, -1]), (None, Some(3), vec![1, 2])],
        cone: Some((0, None, vec![1])),
        linear: vec![-1, 2],
        squares: vec![1, 0],
        claim: None,
    };
    let claim = small.best().map(|best| best as f64 - 0.5);
    let small = Small { claim, ..small };
    small.header() + &Writer::new(&small, &[3, 1, 4, 1, 5, 9, 2, 6]).lines.join("\n") + "\n"
}

#[test]
fn a_truncated_log_proves_nothing() {
    let proof = proof();
    assert!(carom_proof::check(proof.as_bytes()).is_ok());
    for length in 0..proof.len() - 1 {
        assert!(carom_proof::check(&proof.as_bytes()[..length]).is_err(), "{length} bytes");
    }
}

fn word() -> impl Strategy<Value = String> {
    prop_oneof![
        "[a-z]",
        "-?[0-9]{1,3}",
        "-?[0-9]{1,2}(\\.[0-9]{1,3})?(e-?[0-9]{1,3})?",
        Just("inf".to_string()),
        Just("4294967295".to_string()),
        Just("9007199254740993".to_string()),
        Just("L".to_string()),
        "\\PC{0,5}",
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = carom_proof::check(&bytes[..]);
        let header = proof();
        let header = header.split_inclusive("proof\n").take(2).collect::<String>();
        let _ = carom_proof::check(&[header.as_bytes(), &bytes[..]].concat()[..]);
    }

    #[test]
    fn words(lines in prop::collection::vec(prop::collection::vec(word(), 1..8), 1..10)) {
        let lines: Vec<String> = lines.iter().map(|words| words.join(" ")).collect();
        let header = proof();
        let header = header.split_inclusive("proof\n").take(2).collect::<String>();
        let _ = carom_proof::check((header + &lines.join("\n")).as_bytes());
    }

    #[test]
    fn changed_bytes(changes in prop::collection::vec((any::<Index>(), any::<u8>()), 1..6)) {
        let mut bytes = proof().into_bytes();
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        let _ = carom_proof::check(&bytes[..]);
    }
}
