//! Words and signs of LP files, and where sections begin.

/// Signs that end a word.
pub(super) const SIGNS: &[char] = &['+', '-', '*', '/', '^', ':', '<', '>', '=', '[', ']'];

/// The kind of section that a line begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Section {
    Objective,
    Rows,
    Bounds,
    General,
    Binary,
    Semicontinuous,
    Sets,
    /// Statements that are not compared.
    Other,
    End,
}

/// The section that a line begins, and what follows on the line.
pub(super) fn section(line: &str) -> Option<(Section, &str)> {
    let lower = line.trim().to_ascii_lowercase();
    let rest = |length: usize| line.trim().get(length..).unwrap_or_default();
    for word in ["minimize", "minimise", "minimum", "maximize", "maximise", "maximum", "min", "max"]
    {
        let follows = lower.strip_prefix(word);
        if follows.is_some_and(|rest| rest.is_empty() || rest.starts_with([' ', '\t'])) {
            return Some((Section::Objective, rest(word.len())));
        }
    }
    for word in ["subject to", "such that"] {
        if lower.starts_with(word) {
            return Some((Section::Rows, rest(word.len())));
        }
    }
    let section = match lower.trim_end_matches(':') {
        "st" | "s.t." | "st." => Section::Rows,
        "bounds" | "bound" => Section::Bounds,
        "general" | "generals" | "gen" | "integer" | "integers" | "int" => Section::General,
        "binary" | "binaries" | "bin" => Section::Binary,
        "semi-continuous" | "semis" | "semi" => Section::Semicontinuous,
        "sos" | "sos1" | "sos2" => Section::Sets,
        "lazy constraints" | "user cuts" | "general constraints" | "gencons" | "pwlobj" => {
            Section::Other
        }
        "end" => Section::End,
        _ => return None,
    };
    Some((section, ""))
}

/// A word or a sign, and whether it begins a line.
pub(super) type Token<'a> = (&'a str, bool);

/// The words and signs of a line.
pub(super) fn tokens(line: &str) -> Vec<Token<'_>> {
    let (mut tokens, mut rest) = (Vec::new(), line.trim_start());
    while let Some(first) = rest.chars().next() {
        let two = ["<=", "=<", ">=", "=>", "==", "->"].iter().find(|sign| rest.starts_with(**sign));
        let length = match two {
            Some(sign) => sign.len(),
            None if SIGNS.contains(&first) => first.len_utf8(),
            None => word_length(rest),
        };
        let (token, further) = rest.split_at(length);
        tokens.push((token, tokens.is_empty()));
        rest = further.trim_start();
    }
    tokens
}

/// The length of the number or the name at the beginning of a text. Brackets within a name belong
/// to it, such as `x[1,2]`.
fn word_length(text: &str) -> usize {
    let mut depth = 0_usize;
    let ends = |c: char| {
        match c {
            '[' => depth += 1,
            ']' if depth > 0 => depth -= 1,
            _ => return c.is_whitespace() || SIGNS.contains(&c),
        }
        false
    };
    let end = text.find(ends).unwrap_or(text.len());
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    if !text.starts_with(is_digit) {
        return end;
    }
    // A number may have an exponent with a sign, and a name may follow without a blank.
    let digits = text.find(|c: char| !is_digit(c)).unwrap_or(text.len());
    let exponent = text.get(digits..).unwrap_or_default();
    let Some(power) = exponent.strip_prefix(['e', 'E']) else { return digits };
    let unsigned = power.strip_prefix(['+', '-']).unwrap_or(power);
    let length = unsigned.find(|c: char| !c.is_ascii_digit()).unwrap_or(unsigned.len());
    if length == 0 { digits } else { digits + exponent.len() - unsigned.len() + length }
}
