//! The program `carom-proof` on several logs at once.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const CAP: &str = include_str!("../logs/cap.proof");
const BOWL: &str = include_str!("../logs/bowl.proof");

/// Checks paths. Returns the exit code, the output and the errors.
fn check(paths: &[&Path]) -> (Option<i32>, String, String) {
    let program = env!("CARGO_BIN_EXE_carom-proof");
    let said = Command::new(program).arg("check").args(paths).output().expect("the program");
    let text = |bytes| String::from_utf8(bytes).expect("text");
    (said.status.code(), text(said.stdout), text(said.stderr))
}

/// A new folder with logs in it and in a folder below, and a file that is no log.
fn folder(name: &str, logs: &[(&str, &str)]) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::remove_dir_all(&folder).ok();
    fs::create_dir_all(folder.join("below")).expect("a folder");
    fs::write(folder.join("notes.txt"), "no log").expect("a file");
    for (path, log) in logs {
        fs::write(folder.join(path), log).expect("a file");
    }
    folder
}

#[test]
fn a_folder_is_a_line_for_each_log_in_it() {
    let folder = folder("all", &[("b.proof", CAP), ("a.proof", BOWL), ("below/c.proof", CAP)]);
    let (code, out, _) = check(&[&folder]);
    assert_eq!(code, Some(0), "{out}");
    let lines: Vec<&str> = out.lines().filter(|line| line.contains(": proved: ")).collect();
    let names = ["a.proof", "b.proof", "below/c.proof"];
    assert_eq!(lines.len(), names.len(), "{out}");
    for (line, name) in lines.iter().zip(names) {
        assert!(line.starts_with(&format!("{}: ", folder.join(name).display())), "{line}");
    }
    // A single log has its line alone, and twice the same one is two lines.
    let one = folder.join("b.proof");
    let (code, out, _) = check(&[&one]);
    assert!(code == Some(0) && out.starts_with("proved: "), "{out}");
    let (code, out, _) = check(&[&one, &one]);
    assert_eq!((code, out.lines().count()), (Some(0), 2), "{out}");
}

#[test]
fn the_worst_log_decides() {
    let rejected = CAP.replace("claim bound -1.25", "claim bound -0.9");
    let short: String = CAP.lines().take(15).map(|line| format!("{line}\n")).collect();
    let cases = [(&rejected[..], 1), (&short[..], 1), ("no log", 2)];
    for (k, (log, code)) in cases.into_iter().enumerate() {
        let folder = folder(&format!("worst_{k}"), &[("a.proof", log), ("b.proof", BOWL)]);
        let (said, out, _) = check(&[&folder]);
        assert_eq!(said, Some(code), "{k}: {out}");
        assert!(out.contains("b.proof: proved: "), "those behind it are checked: {out}");
    }
}

#[test]
fn folders_without_logs_and_missing_files_are_unreadable() {
    let empty = folder("empty", &[]);
    let (code, _, error) = check(&[&empty]);
    assert_eq!(code, Some(2));
    assert!(
        error.ends_with("there is no file in it that ends in .proof or .proof.gz\n"),
        "{error}"
    );
    let log = folder("missing", &[("a.proof", CAP)]).join("a.proof");
    let (code, out, error) = check(&[&empty.join("nothing.proof"), &log]);
    assert_eq!(code, Some(2));
    assert!(out.contains("a.proof: proved: "), "{out}");
    assert!(error.contains("nothing.proof: "), "{error}");
}
