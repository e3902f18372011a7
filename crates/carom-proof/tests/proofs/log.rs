//! Logs written by hand: a header from its parts, steps that are counted, and one change in them.

/// A program; what is not said is empty.
#[derive(Default)]
pub(crate) struct Header {
    pub(crate) columns: &'static [&'static str],
    pub(crate) rows: &'static [&'static str],
    pub(crate) cones: &'static [&'static str],
    pub(crate) linear: &'static str,
    pub(crate) squares: &'static str,
    pub(crate) claim: &'static str,
}

impl Header {
    /// The log with these steps, a line each.
    pub(crate) fn log(&self, steps: &str) -> String {
        let mut log = String::from("carom proof 1\nsense min\n");
        for (name, keyword, lines) in
            [("columns", "c ", self.columns), ("rows", "r ", self.rows), ("cones", "", self.cones)]
        {
            log += &format!("{name} {}\n", lines.len());
            for line in lines {
                log += &format!("{keyword}{line}\n");
            }
        }
        let or_none = |text: &'static str| if text.is_empty() { "0" } else { text };
        let (linear, squares) = (or_none(self.linear), or_none(self.squares));
        log += &format!("objective 0\ng {linear}\nh {squares}\nclaim {}\nproof\n", self.claim);
        let steps: Vec<&str> =
            steps.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        for step in &steps {
            log += &format!("{step}\n");
        }
        log + &format!("end {}\n", steps.len())
    }
}

/// What the checker says, without the line.
pub(crate) fn verdict(log: &str) -> String {
    match carom_proof::check(log.as_bytes()) {
        Ok(proved) => proved.to_string(),
        Err(failure) => {
            let text = failure.to_string();
            let line = format!(" at line {}", failure.line);
            text.replacen(&line, "", 1)
        }
    }
}

/// The log is accepted as it is. With the one occurrence of `from` replaced by `to`, it is not, and
/// the checker says why.
#[track_caller]
pub(crate) fn assert_broken(log: &str, changes: &[(&str, &str, &str)]) {
    let proved = verdict(log);
    assert!(proved.starts_with("proved: "), "{proved}\n{log}");
    for (from, to, reason) in changes {
        assert_eq!(log.matches(from).count(), 1, "`{from}` must be there once:\n{log}");
        assert_eq!(verdict(&log.replace(from, to)), *reason, "`{from}` to `{to}`");
    }
}
