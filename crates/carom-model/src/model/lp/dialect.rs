//! Files of lp_solve, whose format has the same name and another syntax.

use crate::error::Error;
use crate::model::text::token::Token;

const HELP: &str = "this is the LP format of lp_solve, with `max:` and `;`, and not that of CPLEX, \
                    which is read here; `lp_solve -S1 -parse FILE -wfmps OUT.mps` writes such a file \
                    as MPS";

/// The error for a text that cannot be read; `None` unless it is a file of lp_solve.
pub(super) fn hint(text: &str) -> Option<Error> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut in_comment = false;
    let mut first = None;
    let mut ends_statement = false;
    for (line, number) in text.lines().zip(1..) {
        let code = code(line, &mut in_comment);
        if first.is_none() && !line.trim().is_empty() {
            let start = line.len() - line.trim_start().len();
            first = Some(Token::new(line, number, start, 0));
        }
        ends_statement |= code.trim_end().ends_with(';');
    }
    first.filter(|_| ends_statement).map(|place| place.error(HELP))
}

/// A line without comments of either format.
fn code(line: &str, in_comment: &mut bool) -> String {
    let mut code = String::new();
    let mut rest = line.split('\\').next().unwrap_or(line);
    loop {
        if *in_comment {
            let Some(end) = rest.find("*/") else { return code };
            rest = &rest[end + 2..];
            *in_comment = false;
        }
        let line_comment = rest.find("//").unwrap_or(rest.len());
        match rest[..line_comment].find("/*") {
            Some(start) => {
                code.push_str(&rest[..start]);
                rest = &rest[start + 2..];
                *in_comment = true;
            }
            None => {
                code.push_str(&rest[..line_comment]);
                return code;
            }
        }
    }
}
