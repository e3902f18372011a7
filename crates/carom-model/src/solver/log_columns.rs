//! The columns of a log, as many as fit on a line.

use std::fmt::Write as _;

use super::progress::Progress;
use crate::number::{percent, rounded};

/// Numbers below this part of the largest one of the log are shown as 0 (no unit), and below this
/// where there are no larger ones (objective's unit): rounding leaves such remainders of 0.
const SHOWN_AS_ZERO: f64 = 1e-12;

/// The least width of lines whose objectives have all digits.
const WIDE: usize = 60;

/// A column of the lines about a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum LogColumn {
    Nodes,
    Open,
    Depth,
    Iterations,
    Incumbent,
    Bound,
    Gap,
    Explored,
    Seconds,
}

impl LogColumn {
    /// All columns, from the left to the right.
    const ALL: [LogColumn; 9] = [
        LogColumn::Nodes,
        LogColumn::Open,
        LogColumn::Depth,
        LogColumn::Iterations,
        LogColumn::Incumbent,
        LogColumn::Bound,
        LogColumn::Gap,
        LogColumn::Explored,
        LogColumn::Seconds,
    ];

    /// All columns, those first that are left out last.
    const BY_WORTH: [LogColumn; 9] = [
        LogColumn::Bound,
        LogColumn::Incumbent,
        LogColumn::Seconds,
        LogColumn::Gap,
        LogColumn::Nodes,
        LogColumn::Explored,
        LogColumn::Open,
        LogColumn::Depth,
        LogColumn::Iterations,
    ];

    fn title(self) -> &'static str {
        match self {
            LogColumn::Nodes => "nodes",
            LogColumn::Open => "open",
            LogColumn::Depth => "depth",
            LogColumn::Iterations => "iterations",
            LogColumn::Incumbent => "incumbent",
            LogColumn::Bound => "bound",
            LogColumn::Gap => "gap %",
            LogColumn::Explored => "tree %",
            LogColumn::Seconds => "seconds",
        }
    }
}

/// The columns of the lines about a search.
#[derive(Debug)]
pub(super) struct LogColumns {
    shown: Vec<LogColumn>,
    is_wide: bool,
    /// The largest magnitude of an objective or a bound so far.
    largest: f64,
}

impl LogColumns {
    /// The columns of lines that have less than so many characters.
    pub(super) fn new(width: usize) -> Self {
        let mut columns = LogColumns { shown: Vec::new(), is_wide: width >= WIDE, largest: 0.0 };
        let mut left = width.saturating_sub(2);
        for column in LogColumn::BY_WORTH {
            let Some(rest) = left.checked_sub(1 + columns.width(column)) else { break };
            left = rest;
            columns.shown.push(column);
        }
        columns.shown.sort_by_key(|column| LogColumn::ALL.iter().position(|own| own == column));
        columns
    }

    fn width(&self, column: LogColumn) -> usize {
        match column {
            LogColumn::Nodes => 9,
            LogColumn::Open | LogColumn::Gap | LogColumn::Seconds => 8,
            LogColumn::Depth | LogColumn::Explored => 6,
            LogColumn::Iterations => 10,
            LogColumn::Incumbent | LogColumn::Bound => {
                if self.is_wide {
                    16
                } else {
                    12
                }
            }
        }
    }

    /// The heading.
    pub(super) fn heading(&self) -> String {
        self.line(' ', |column| column.title().to_owned())
    }

    /// Whether the estimate of the tree has a column.
    pub(super) fn shows_explored(&self) -> bool {
        self.shown.contains(&LogColumn::Explored)
    }

    /// The line of a state of a search, which begins with a mark.
    pub(super) fn row(&mut self, mark: char, progress: &Progress) -> String {
        let incumbent = progress.incumbent.map_or("-".to_owned(), |value| self.number(value));
        let bound = self.number(progress.bound);
        let explored = progress.explored.map(|part| format!("{:.1}", 100.0 * part));
        self.line(mark, |column| match column {
            LogColumn::Nodes => progress.nodes.to_string(),
            LogColumn::Open => progress.open.to_string(),
            LogColumn::Depth => progress.depth.to_string(),
            LogColumn::Iterations => progress.iterations.to_string(),
            LogColumn::Incumbent => incumbent.clone(),
            LogColumn::Bound => bound.clone(),
            LogColumn::Gap => percent(progress.relative_gap()),
            LogColumn::Explored => explored.clone().unwrap_or("-".to_owned()),
            LogColumn::Seconds => format!("{:.2}", progress.elapsed.as_secs_f64()),
        })
    }

    fn line(&self, mark: char, text: impl Fn(LogColumn) -> String) -> String {
        let mut line = mark.to_string();
        for &column in &self.shown {
            // Writing to a string cannot fail.
            let _ = write!(line, " {:>1$}", text(column), self.width(column));
        }
        line
    }

    /// Ten significant digits, or eight where that is too long for a column; six in narrow ones.
    /// The rest that rounding leaves of a 0 is printed as 0.
    pub(super) fn number(&mut self, value: f64) -> String {
        if value.is_finite() {
            self.largest = self.largest.max(value.abs());
        }
        let least =
            if self.largest < SHOWN_AS_ZERO { SHOWN_AS_ZERO } else { SHOWN_AS_ZERO * self.largest };
        match (value.abs() < least, self.is_wide) {
            (true, _) => "0".to_owned(),
            (false, true) => short(value, [10, 8], 16),
            (false, false) => short(value, [6, 6], 12),
        }
    }
}

/// Significant digits as they are, or fewer with an exponent where that is too long.
fn short(value: f64, [plain, less]: [usize; 2], most: usize) -> String {
    let text = rounded(value, plain);
    if text.len() <= most { text } else { format!("{value:.*e}", less - 1) }
}
