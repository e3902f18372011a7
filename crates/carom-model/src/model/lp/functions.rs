//! The section `General Constraints`: variables that are functions of others.

use super::function::{LpArgument, LpFunction, LpFunctionKind};
use super::lexer::{TokenKind, number_length};
use super::read::LpFile;
use crate::error::Error;
use crate::model::text::token::Token;

/// A word without the brackets and commas around it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mark {
    Open,
    Close,
    Comma,
    Colon,
    Plus,
    Minus,
    Word,
    Number,
}

const SMOOTH_HELP: &str = "it is not piecewise affine; write it as `PWL ( x ) : ( x1 , y1 ) ( x2 , y2 ) ...` with \
                           points close enough for you";

impl<'a> LpFile<'a> {
    pub(super) fn read_functions(&mut self) -> Result<(), Error> {
        while self.section().is_none() && self.kind() != TokenKind::End {
            let place = self.token();
            let label = self.row_label();
            if !self.at_name() {
                return Err(self.unexpected("the name of a variable"));
            }
            let result = self.column()?;
            if !self.accept(TokenKind::Equal) {
                return Err(self.unexpected("`=` and a function, such as `MAX ( x , y , 3 )`"));
            }
            let function = self.function(label.unwrap_or(place), label.is_some(), result)?;
            self.functions.push(function);
        }
        Ok(())
    }

    fn function(
        &mut self,
        place: Token<'a>,
        is_named: bool,
        result: usize,
    ) -> Result<LpFunction<'a>, Error> {
        let marks = self.marks();
        let mut rest = Marks { marks: &marks, end: self.token() };
        let (mark, word) = rest.next();
        if mark != Some(Mark::Word) {
            return Err(rest.expected(word, "a function, such as `MAX ( x , y , 3 )`"));
        }
        let mut kind = match word.text.to_ascii_uppercase().as_str() {
            "MAX" => LpFunctionKind::Maximum,
            "MIN" => LpFunctionKind::Minimum,
            "ABS" => LpFunctionKind::Absolute,
            "AND" => LpFunctionKind::And,
            "OR" => LpFunctionKind::Or,
            "NORM" => LpFunctionKind::OneNorm,
            "PWL" => LpFunctionKind::Piecewise,
            "EXP" | "EXPA" | "LOG" | "LOGA" | "LOG_A" | "LOGISTIC" | "SIN" | "COS" | "TAN"
            | "POW" | "POLY" | "SIGNPOW" | "TANH" => {
                let text = word.text;
                return Err(word.error(format!("`{text}` cannot be read: {SMOOTH_HELP}")));
            }
            _ => {
                return Err(
                    rest.expected(word, "`MAX`, `MIN`, `ABS`, `AND`, `OR`, `NORM` or `PWL`")
                );
            }
        };
        if word.text.eq_ignore_ascii_case("NORM") {
            kind = norm(&mut rest)?;
        }
        let mut arguments = Vec::new();
        rest.take(Mark::Open, "`(`")?;
        loop {
            let at = rest.peek();
            match at.0 {
                Some(Mark::Word) if !is_infinity(at.1.text) => {
                    rest.next();
                    arguments.push(LpArgument::Column(self.column_of(at.1)?));
                }
                _ => arguments.push(LpArgument::Number(rest.number()?)),
            }
            match rest.next() {
                (Some(Mark::Comma), _) => {}
                (Some(Mark::Close), _) => break,
                (_, other) => return Err(rest.expected(other, "`,` or `)`")),
            }
        }
        let is_single = matches!(kind, LpFunctionKind::Absolute | LpFunctionKind::Piecewise);
        let are_columns = arguments.iter().all(|a| matches!(a, LpArgument::Column(_)));
        let may_have_numbers = matches!(kind, LpFunctionKind::Maximum | LpFunctionKind::Minimum);
        if is_single && arguments.len() != 1 || !are_columns && !may_have_numbers {
            let (text, what) = (word.text, if is_single { "one variable" } else { "variables" });
            return Err(word.error(format!("`{text}` is a function of {what} alone")));
        }
        let mut points = Vec::new();
        if kind == LpFunctionKind::Piecewise {
            rest.take(Mark::Colon, "`:` and points, such as `: ( 0 , 0 ) ( 1 , 2 )`")?;
            while rest.peek().0 == Some(Mark::Open) {
                rest.next();
                let x = rest.number()?;
                rest.take(Mark::Comma, "`,`")?;
                let y = rest.number()?;
                rest.take(Mark::Close, "`)`")?;
                points.push((x, y));
            }
        }
        match rest.next() {
            (None, _) => Ok(LpFunction { place, is_named, result, kind, arguments, points }),
            (Some(_), other) => Err(rest.expected(other, "a label or a section")),
        }
    }

    /// The words up to the next statement or section.
    fn marks(&mut self) -> Vec<(Mark, Token<'a>)> {
        let mut marks = Vec::new();
        // A closing bracket may stand before the colon of a piecewise function.
        let mut is_first = true;
        while self.kind() != TokenKind::End {
            let is_bracket = self.token().text.ends_with(')') && !is_balanced(self.token().text);
            // The functions have the names of sections.
            if !is_first && (self.at_label() && !is_bracket || self.section().is_some()) {
                break;
            }
            is_first = false;
            let (kind, token) = (self.kind(), self.step());
            match kind {
                TokenKind::Word => split(token, &mut marks),
                TokenKind::Number => marks.push((Mark::Number, token)),
                TokenKind::Colon => marks.push((Mark::Colon, token)),
                TokenKind::Plus => marks.push((Mark::Plus, token)),
                TokenKind::Minus => marks.push((Mark::Minus, token)),
                // Nothing that can be read has another sign.
                _ => marks.push((Mark::Word, token)),
            }
        }
        marks
    }
}

/// `( 1 )` or `( INF )` behind `NORM`.
fn norm(rest: &mut Marks<'_, '_>) -> Result<LpFunctionKind, Error> {
    rest.take(Mark::Open, "`(`")?;
    let (_, order) = rest.next();
    let kind = match order.text.to_ascii_uppercase().as_str() {
        "1" => LpFunctionKind::OneNorm,
        "INF" | "INFINITY" => LpFunctionKind::LargestNorm,
        "2" => {
            return Err(order.error(
                "that a variable equals a Euclidean norm is not convex; write a quadratic row, such as \
                 `[ x ^2 + y ^2 - r ^2 ] <= 0`, which bounds the norm by the variable",
            ));
        }
        _ => return Err(rest.expected(order, "the order 1, 2 or INF of a norm")),
    };
    rest.take(Mark::Close, "`)`")?;
    Ok(kind)
}

/// The words of a function that are left.
struct Marks<'a, 'b> {
    marks: &'b [(Mark, Token<'a>)],
    /// The token behind them.
    end: Token<'a>,
}

impl<'a> Marks<'a, '_> {
    fn peek(&self) -> (Option<Mark>, Token<'a>) {
        self.marks.first().map_or((None, self.end), |&(mark, token)| (Some(mark), token))
    }

    fn next(&mut self) -> (Option<Mark>, Token<'a>) {
        let next = self.peek();
        self.marks = self.marks.get(1..).unwrap_or_default();
        next
    }

    fn take(&mut self, mark: Mark, expected: &str) -> Result<(), Error> {
        match self.next() {
            (found, _) if found == Some(mark) => Ok(()),
            (_, token) => Err(self.expected(token, expected)),
        }
    }

    /// A finite number with its sign.
    fn number(&mut self) -> Result<f64, Error> {
        let mut sign = 1.0;
        loop {
            match self.next() {
                (Some(Mark::Plus), _) => {}
                (Some(Mark::Minus), _) => sign = -sign,
                (Some(Mark::Number), token) => return Ok(sign * token.finite()?),
                (_, token) => return Err(self.expected(token, "a finite number or a name")),
            }
        }
    }

    fn expected(&self, token: Token<'a>, expected: &str) -> Error {
        match token.text {
            "" => token.error(format!("expected {expected}, found the end of the file")),
            text => token.error(format!("expected {expected}, found `{text}`")),
        }
    }
}

fn is_infinity(text: &str) -> bool {
    super::read::is_infinity(text)
}

/// Whether each bracket of a word is closed in it.
fn is_balanced(text: &str) -> bool {
    let mut depth = 0_i64;
    let is_open = text.chars().all(|letter| {
        depth += i64::from(letter == '(') - i64::from(letter == ')');
        depth >= 0
    });
    is_open && depth == 0
}

/// Splits a word at brackets and commas that are not parts of a name, such as `x(1,2)` or `y[a,b]`.
fn split<'a>(word: Token<'a>, marks: &mut Vec<(Mark, Token<'a>)>) {
    let mut start = 0;
    let (mut depth, mut index) = (0_usize, 0_usize);
    let end_word = |start: usize, end: usize, marks: &mut Vec<(Mark, Token<'a>)>| {
        if start < end {
            let token = word.part(start, end - start);
            let is_number = number_length(token.text) == token.text.len();
            marks.push((if is_number { Mark::Number } else { Mark::Word }, token));
        }
    };
    for (place, letter) in word.text.char_indices() {
        match letter {
            '[' => index += 1,
            ']' => index = index.saturating_sub(1),
            _ if index > 0 => {}
            // The first word is a function, which may stand at its bracket.
            '(' if start < place && !marks.is_empty() => depth += 1,
            ')' if depth > 0 => depth -= 1,
            '(' | ')' => {
                end_word(start, place, marks);
                let mark = if letter == '(' { Mark::Open } else { Mark::Close };
                marks.push((mark, word.part(place, 1)));
                start = place + 1;
            }
            ',' if depth == 0 => {
                end_word(start, place, marks);
                marks.push((Mark::Comma, word.part(place, 1)));
                start = place + 1;
            }
            _ => {}
        }
    }
    end_word(start, word.text.len(), marks);
}
