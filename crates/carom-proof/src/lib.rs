//! Checks the proofs that `carom` writes, in exact arithmetic and without a line of carom.
//!
//! A log states a program, claims a bound of its objective or that it has no point, and proves that
//! in small steps. Rules and format are on the page "Proofs" of carom's guide (`docs/proofs.md`).
//!
//! To read the checker in an order: [`exact`] (numbers and sums), `rows` (combinations),
//! `linear_rules`, `quadratic_rules`, `curvature` and `moves` (each rule with its reason),
//! `functions` and `terms` (functions that are neither affine nor piecewise affine), `bounds`, `cases` (contexts), `checker` (commands); `text`, `program` and `point` read and judge
//! what is beside the proof. [`compare`] is another tool, which none of these knows.

mod bounds;
mod cases;
mod checker;
pub mod compare;
mod curvature;
pub mod exact;
mod functions;
mod linear_rules;
mod moves;
mod point;
mod program;
mod quadratic_rules;
mod rows;
mod table;
mod terms;
mod text;

pub use point::Point;
pub use program::Claim;
pub use table::{ProvedPrograms, ProvedTable, check_table};
pub use text::Failure;

use checker::Checker;
use exact::Plain;
use program::Program;
use std::collections::BTreeMap;
use std::fmt;
use std::io::BufRead;
use text::{Lines, Refusal, rejected, unreadable};

/// The result of checking a log that is a proof.
#[derive(Debug, Clone)]
pub struct Proved {
    /// The claim, which holds at every point that satisfies the program exactly.
    pub claim: Claim,
    /// Whether the model maximises; the claim is that of the minimisation in the log.
    pub is_maximisation: bool,
    /// The number of commands.
    pub steps: u64,
    /// The points of the log, judged.
    pub points: Vec<Point>,
    /// How many enclosures were assumed, by the name of a function that the checker does not know.
    pub assumed: BTreeMap<String, u64>,
}

impl fmt::Display for Proved {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "proved")?;
        for (k, (name, count)) in self.assumed.iter().enumerate() {
            let ending = if *count == 1 { "" } else { "s" };
            match k {
                0 => write!(f, " under {count} assumed enclosure{ending} of {name}")?,
                _ => write!(f, " and {count} of {name}")?,
            }
        }
        write!(f, ": ")?;
        match self.claim {
            Claim::Infeasible => write!(f, "no point")?,
            Claim::Bound(bound) if self.is_maximisation => {
                write!(f, "objective <= {}", Plain(0.0 - bound))?;
            }
            Claim::Bound(bound) => write!(f, "objective >= {}", Plain(bound))?,
        }
        write!(f, " ({} step{})", self.steps, if self.steps == 1 { "" } else { "s" })
    }
}

/// Checks a log, line by line.
///
/// # Errors
///
/// A [`Failure`] names the first line that is not valid, and why.
pub fn check(log: impl BufRead) -> Result<Proved, Failure> {
    let mut lines = Lines::new(log);
    check_lines(&mut lines).map_err(|refusal| lines.at_line(refusal))
}

fn check_lines<R: BufRead>(lines: &mut Lines<R>) -> Result<Proved, Refusal> {
    let program = Program::read(lines)?;
    let rows = program.rows.len();
    let mut checker = Checker::new(program);
    let mut points = Vec::new();
    loop {
        let Some(mut words) = lines.next()? else {
            return rejected("the log ends without a line `end`");
        };
        if words.is_at("a") {
            words.word("a")?;
            checker.count_point()?;
            let entries = words.entries(checker.program.columns.len())?;
            words.end()?;
            points.push(Point::judge(&entries, rows, &mut checker)?);
        } else if let Some(steps) = checker.step(&mut words)? {
            if lines.next()?.is_some() {
                return unreadable("the log goes on behind `end`");
            }
            let Program { claim, is_maximisation, .. } = checker.program;
            let assumed = checker.assumed;
            return Ok(Proved { claim, is_maximisation, steps, points, assumed });
        }
    }
}
