//! Contexts: cases, lemmas, and what follows once one of them is closed.

use crate::bounds::Side;
use crate::checker::{Checker, side};
use crate::exact::{Dyadic, Plain};
use crate::rows::Row;
use crate::text::{Refusal, Words, rejected};

/// A form with whole coefficients over integral columns, or a single column.
#[derive(Debug)]
pub(crate) enum Form {
    Column(usize),
    Entries(Vec<(u32, f64)>),
}

/// The consequence of closing a context.
#[derive(Debug)]
pub(crate) enum Kind {
    /// The claim.
    Claim,
    /// The other side of the split, `form >= value + 1`.
    FirstSide(Form, f64),
    /// The other side of the split of a range, `column >= value`.
    FirstPart(usize, f64),
    /// The context around it is closed as well.
    SecondSide,
    /// The row is a fact of the context around it.
    Lemma(Row),
    /// The column is integral.
    Whole(usize),
}

#[derive(Debug)]
pub(crate) struct Context {
    pub(crate) kind: Kind,
    /// How many facts, and changes of bounds, there were when it was opened.
    pub(crate) facts: usize,
    pub(crate) mark: usize,
}

impl Checker {
    pub(crate) fn split_column(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let column = words.index("column", self.bounds.len())?;
        let value = words.number("the value")?;
        if !self.is_integral(column) {
            return rejected(format!("column {} is not integral", self.name(column)));
        }
        self.split(Form::Column(column), value)
    }

    /// A column is at most a value, or at least it.
    pub(crate) fn split_range(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let column = words.index("column", self.bounds.len())?;
        let value = words.number("the value")?;
        self.open(Kind::FirstPart(column, value));
        self.tighten(column, Side::Upper, value);
        Ok(())
    }

    pub(crate) fn split_form(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let value = words.number("the value")?;
        let entries = words.entries(self.program.columns.len())?;
        if !self.is_whole(&entries) {
            return rejected("the form is not whole: its columns or its coefficients");
        }
        self.split(Form::Entries(entries), value)
    }

    /// Opens the first side of a split, `form <= value`.
    fn split(&mut self, form: Form, value: f64) -> Result<(), Refusal> {
        if !is_whole(value) {
            return rejected(format!("{} is not whole, or too large", Plain(value)));
        }
        match &form {
            Form::Column(column) => {
                let column = *column;
                self.open(Kind::FirstSide(form, value));
                self.tighten(column, Side::Upper, value);
            }
            Form::Entries(entries) => {
                let row = Row::new(entries.clone(), None, Some(Dyadic::from_f64(value)));
                self.open(Kind::FirstSide(form, value));
                self.facts.push(row);
            }
        }
        Ok(())
    }

    pub(crate) fn lemma(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let side = side(words)?;
        let value = words.number("the value")?;
        let entries = words.entries(self.bounds.len())?;
        // Not to hold means to be beyond the value, or at least at it; whole numbers are beyond the
        // next one, or at least at it.
        let next = match side {
            _ if !self.is_whole(&entries) || !is_whole(value) => 0.0,
            Side::Lower => -1.0,
            Side::Upper => 1.0,
        };
        let beyond = Dyadic::from_f64(value + next);
        let value = Dyadic::from_f64(value);
        let (row, negation) = match side {
            Side::Lower => (
                Row::new(entries.clone(), Some(value), None),
                Row::new(entries, None, Some(beyond)),
            ),
            Side::Upper => (
                Row::new(entries.clone(), None, Some(value)),
                Row::new(entries, Some(beyond), None),
            ),
        };
        self.open(Kind::Lemma(row));
        self.facts.push(negation);
        Ok(())
    }

    pub(crate) fn open(&mut self, kind: Kind) {
        let (facts, mark) = (self.facts.len(), self.bounds.mark());
        self.contexts.push(Context { kind, facts, mark });
    }

    /// Closes the context, and all that are closed by that; opens the other side of a split.
    pub(crate) fn close(&mut self) -> Result<(), Refusal> {
        while let Some(context) = self.contexts.pop() {
            if !matches!(context.kind, Kind::Claim) {
                self.facts.truncate(context.facts);
                self.bounds.undo(context.mark);
            }
            match context.kind {
                Kind::Claim | Kind::SecondSide => {}
                Kind::FirstSide(Form::Column(column), value) => {
                    self.open(Kind::SecondSide);
                    self.tighten(column, Side::Lower, value + 1.0);
                    break;
                }
                Kind::FirstPart(column, value) => {
                    self.open(Kind::SecondSide);
                    self.tighten(column, Side::Lower, value);
                    break;
                }
                Kind::FirstSide(Form::Entries(entries), value) => {
                    self.open(Kind::SecondSide);
                    let value = Dyadic::from_f64(value + 1.0);
                    self.facts.push(Row::new(entries, Some(value), None));
                    break;
                }
                Kind::Lemma(row) => {
                    self.facts.push(row);
                    break;
                }
                Kind::Whole(column) => {
                    self.moves.whole.insert(column);
                    break;
                }
            }
        }
        Ok(())
    }

    /// Whether a form is a whole number at every point.
    fn is_whole(&self, entries: &[(u32, f64)]) -> bool {
        let mut terms = entries.iter().filter(|entry| entry.1 != 0.0);
        terms.all(|&(column, value)| self.is_integral(column as usize) && value.fract() == 0.0)
    }
}

/// Whether a number is whole, and so are its neighbours.
fn is_whole(value: f64) -> bool {
    value.fract() == 0.0 && value.abs() < 9_007_199_254_740_991.0
}
