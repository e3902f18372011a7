//! Pictures of kept figures.

use std::fs;
use std::path::{Path, PathBuf};

use crate::{Said, example, file};

fn image(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/images").join(name)
}

#[test]
fn kept_figures_draw_the_kept_pictures() {
    for (name, words, figures, picture) in [
        ("growth", &["--draw"][..], "growth.csv", "growth.svg"),
        ("profile", &[], "away.csv", "away.svg"),
    ] {
        let drawn = file(picture, b"");
        let mut command = example(name);
        command.args(words).arg(image(figures)).arg(&drawn);
        let said = Said::new(command.output().unwrap());
        assert_eq!(said.code, Some(0), "{}", said.err);
        let kept = fs::read_to_string(image(picture)).unwrap();
        assert!(fs::read_to_string(&drawn).unwrap() == kept, "{picture} is not that of {figures}");
    }
}

#[test]
fn a_damaged_line_of_figures_is_named() {
    let damaged = file("damaged.csv", b"family,size\nunits,48,240,carom,optimal,fast,0,9.8\n");
    let drawn = damaged.with_extension("svg");
    let mut command = example("growth");
    command.arg("--draw").arg(&damaged).arg(drawn);
    let said = Said::new(command.output().unwrap());
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("`units,48,240,carom,optimal,fast,0,9.8` is not"), "{}", said.err);
}
