//! Files that are compressed by gzip: whole, in parts, damaged, and made to fill the memory.

use std::io::Write;

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::{LP, Said, file, solve};

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}

fn refused(bytes: &[u8], error: &str) -> Said {
    let said = solve(&["-"], bytes);
    assert_eq!((said.code, &*said.out), (Some(1), ""), "{said:?}");
    assert!(said.err.starts_with(&format!("solve: standard input: {error}")), "{said:?}");
    said
}

#[test]
fn compressed_files_are_read_and_written() {
    let whole = gzip(LP.as_bytes());
    let halves = LP.split_at(LP.len() / 2);
    let parts = [gzip(halves.0.as_bytes()), gzip(halves.1.as_bytes())].concat();
    for bytes in [&whole, &parts] {
        let said = solve(&["-"], bytes);
        assert_eq!((said.code, said.figure("objective")), (Some(0), "13"), "{said:?}");
    }
    // By its contents, whatever its name; the format by the extension before `.gz`, or the
    // contents.
    for name in ["a.lp.gz", "a.gz", "a.lp"] {
        let path = file(name, &whole);
        let said = solve(&[path.to_str().unwrap()], b"");
        assert_eq!((said.code, said.figure("objective")), (Some(0), "13"), "{name}: {said:?}");
    }
    let path = file("written.mps.gz", b"");
    let path = path.to_str().unwrap();
    let said = solve(&["-", "--write", path], LP.as_bytes());
    assert_eq!(said.code, Some(0), "{said:?}");
    assert!(std::fs::read(path).unwrap().starts_with(&[0x1f, 0x8b]));
    assert_eq!(solve(&[path], b"").figure("objective"), "13");
}

#[test]
fn damaged_files_are_refused() {
    let whole = gzip(LP.as_bytes());
    // Cut off anywhere, also within the head and the check at the end.
    for end in 2..whole.len() {
        if [2, 5, 10, 11, whole.len() / 2, whole.len() - 8, whole.len() - 1].contains(&end) {
            refused(&whole[..end], "the compressed data are damaged (");
        }
    }
    // A wrong check, a wrong byte, something else behind the end.
    for place in [whole.len() - 8, whole.len() - 1, whole.len() / 2] {
        let mut wrong = whole.clone();
        wrong[place] ^= 0x55;
        refused(&wrong, "the compressed data are damaged (");
    }
    refused(&[&whole[..], b"and more"].concat(), "the compressed data are damaged (");
    // No text behind it.
    refused(&gzip(b"ROWS\n\xff\xff"), "line 2, column 1: this is no text in UTF-8");
    for (first, name) in [
        (&b"BZh91AY&SY"[..], "bzip2"),
        (b"\xfd7zXZ\0", "xz"),
        (b"\x28\xb5\x2f\xfd\0", "zstd"),
        (b"PK\x03\x04\0", "zip"),
    ] {
        refused(first, &format!("it is compressed by {name}; only gzip is read, expand it first"));
    }
}

/// 100 kB that expand to 100 MB, and the same in one part that pretends to be a comment of a file.
#[test]
fn bombs_are_refused() {
    let bomb = gzip(&vec![0; 1 << 20]).repeat(100);
    let said = refused(&bomb, &format!("{} bytes expand to more than ", bomb.len()));
    assert!(said.err.contains("expand it with gunzip first"), "{said:?}");
    let comment = [b"* ".to_vec(), vec![b'-'; 1 << 20]].concat();
    refused(&gzip(&comment).repeat(100), "");
    // A long text of a usual kind is none.
    let long: String = (0..20_000).map(|k| format!(" r{k}: x + {k} y <= {}\n", k + 7)).collect();
    let long = format!("maximize\n obj: x\nsubject to\n{long}bounds\n x <= 3\n y <= 4\nend\n");
    let said = solve(&["-", "--quiet", "--time-limit", "0"], &gzip(long.as_bytes()));
    assert_eq!(said.code, Some(0), "{said:?}");
}
