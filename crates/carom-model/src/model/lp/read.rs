//! Reading: from tokens to objective, rows and columns as the file lists them.

use super::expression::Expression;
use super::function::LpFunction;
use super::lexer::{self, TokenKind, TypedToken};
use super::rows::LpRow;
use super::section::{self, LpSection};
use crate::error::Error;
use crate::model::name::Name;
use crate::model::sense::Sense;
use crate::model::text::ends::FileBounds;
use crate::model::text::names::NameIndex;
use crate::model::text::read::Warning;
use crate::model::text::sets::Set;
use crate::model::text::token::Token;

/// The contents of a file, from which [`build`](super::build) makes a model.
#[derive(Debug)]
pub(super) struct LpFile<'a> {
    pub(super) name: &'a str,
    pub(super) sense: Sense,
    pub(super) objective: Expression<'a>,
    pub(super) columns: Vec<LpColumn<'a>>,
    pub(super) rows: Vec<LpRow<'a>>,
    pub(super) sets: Vec<Set<'a>>,
    pub(super) functions: Vec<LpFunction<'a>>,
    pub(super) warnings: Vec<Warning>,
    names: NameIndex<'a>,
    pieces: Vec<TypedToken<'a>>,
    /// The next token.
    at: usize,
}

#[derive(Debug)]
pub(super) struct LpColumn<'a> {
    pub(super) name: Token<'a>,
    pub(super) integer: bool,
    pub(super) binary: bool,
    pub(super) semicontinuous: bool,
    pub(super) ends: FileBounds<'a>,
}

impl<'a> LpFile<'a> {
    /// Goes through the sections up to `End`.
    pub(super) fn scan(text: &'a str) -> Result<LpFile<'a>, Error> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let pieces = lexer::pieces(text)?;
        let mut file = LpFile {
            name: problem_name(text)?,
            sense: Sense::Minimize,
            objective: Expression::default(),
            columns: Vec::new(),
            rows: Vec::new(),
            sets: Vec::new(),
            functions: Vec::new(),
            warnings: Vec::new(),
            names: NameIndex::default(),
            pieces,
            at: 0,
        };
        file.sense = match file.section() {
            Some((LpSection::Minimize, _)) => Sense::Minimize,
            Some((LpSection::Maximize, _)) => Sense::Maximize,
            _ => return Err(file.unexpected("`Minimize` or `Maximize`")),
        };
        file.at += 1;
        file.read_objective()?;
        loop {
            let Some((section, length)) = file.section() else {
                if file.kind() != TokenKind::End {
                    return Err(
                        file.unexpected("a section such as `Subject To`, `Bounds` or `End`")
                    );
                }
                file.warnings.push(file.token().warning(CUT_OFF));
                return Ok(file);
            };
            let place = file.token();
            file.at += length;
            match section {
                LpSection::End => return Ok(file),
                LpSection::Rows => file.read_rows()?,
                LpSection::Bounds => file.read_bounds()?,
                LpSection::Integers => file.read_kinds(|column| column.integer = true)?,
                LpSection::Binaries => file.read_kinds(|column| column.binary = true)?,
                LpSection::SemiContinuous => {
                    file.read_kinds(|column| column.semicontinuous = true)?
                }
                LpSection::Sets(kind) => file.read_sets(kind)?,
                LpSection::Functions => file.read_functions()?,
                LpSection::Minimize | LpSection::Maximize => {
                    return Err(place.error("a second objective; a model has one, keep one"));
                }
                LpSection::Refused(help) => {
                    if file.section().is_none() && file.kind() != TokenKind::End {
                        let name = place.text;
                        return Err(place.error(format!("section `{name}` cannot be read: {help}")));
                    }
                }
            }
        }
    }

    fn read_objective(&mut self) -> Result<(), Error> {
        self.label();
        if let Some((LpSection::Refused(help), _)) = self.section() {
            return Err(self.token().error(help));
        }
        self.objective = self.expression(true)?;
        if let Some(constant) = self.objective.infinite() {
            return Err(constant.error("the objective must be finite"));
        }
        if self.label().is_some() {
            self.at -= 2;
            return Err(self.token().error("a second objective; a model has one, keep one"));
        }
        Ok(())
    }

    /// A list of names; each is marked.
    fn read_kinds(&mut self, mark: impl Fn(&mut LpColumn<'a>)) -> Result<(), Error> {
        while self.section().is_none() && self.kind() != TokenKind::End {
            if self.kind() != TokenKind::Word {
                return Err(self.unexpected("the name of a variable"));
            }
            let column = self.known_column()?;
            mark(&mut self.columns[column]);
        }
        Ok(())
    }

    // -- pieces ---------------------------------------------------------------------------------

    /// Whether the next pieces are of these kinds.
    pub(super) fn at_kinds(&self, kinds: &[TokenKind]) -> bool {
        let next = self.pieces.iter().skip(self.at).map(|piece| &piece.kind);
        next.take(kinds.len()).eq(kinds)
    }

    pub(super) fn kind(&self) -> TokenKind {
        self.pieces[self.at].kind
    }

    pub(super) fn token(&self) -> Token<'a> {
        self.pieces[self.at].token
    }

    /// Skips a token, but never the end.
    pub(super) fn step(&mut self) -> Token<'a> {
        let token = self.token();
        if self.kind() != TokenKind::End {
            self.at += 1;
        }
        token
    }

    /// Skips a token of this kind, if it is next.
    pub(super) fn accept(&mut self, kind: TokenKind) -> bool {
        let found = self.kind() == kind;
        if found {
            self.step();
        }
        found
    }

    /// The section that begins here, and the number of tokens in its name.
    pub(super) fn section(&self) -> Option<(LpSection, usize)> {
        section::section(&self.pieces[self.at..])
    }

    /// The line of the previous token.
    pub(super) fn last_line(&self) -> Option<usize> {
        Some(self.pieces.get(self.at.checked_sub(1)?)?.token.line())
    }

    /// Whether a name with a colon is next.
    pub(super) fn at_label(&self) -> bool {
        let next = self.pieces.get(self.at + 1).map(|piece| piece.kind);
        self.kind() == TokenKind::Word && next == Some(TokenKind::Colon)
    }

    /// Skips a name with a colon, if it is next.
    pub(super) fn label(&mut self) -> Option<Token<'a>> {
        let token = self.at_label().then(|| self.token())?;
        self.at += 2;
        Some(token)
    }

    /// Skips the name of a row with its colon, if it is next. It may have signs in it, as other
    /// programs write it, if there is no blank.
    pub(super) fn row_label(&mut self) -> Option<Token<'a>> {
        let pieces = &self.pieces[self.at..];
        let joined = pieces.windows(2).take_while(|pair| {
            let is_part = !matches!(
                pair[0].kind,
                TokenKind::AtMost | TokenKind::AtLeast | TokenKind::Equal | TokenKind::Colon
            );
            is_part && pair[0].token.joins(&pair[1].token)
        });
        let length = joined.count();
        let begins = matches!(self.kind(), TokenKind::Word | TokenKind::Number);
        if length < 2 || !begins || pieces[length].kind != TokenKind::Colon {
            return self.label();
        }
        let label = pieces[0].token.through(&pieces[length - 1].token);
        self.at += length + 1;
        Some(label)
    }

    /// The error about a number with a decimal comma, if what follows it is the rest of one.
    pub(super) fn check_decimal_point(&self, number: Token<'a>) -> Result<(), Error> {
        let next = self.token();
        let is_rest = |rest: &str| rest.starts_with(|digit: char| digit.is_ascii_digit());
        match next.text.strip_prefix(',').filter(|rest| is_rest(rest)) {
            Some(rest) if number.joins(&next) => {
                let (whole, digits) =
                    (number.text, rest.trim_end_matches(|c: char| !c.is_ascii_digit()));
                Err(number.error(format!(
                    "`{whole},{digits}` has a decimal comma; numbers have a decimal point, as \
                     `{whole}.{digits}`"
                )))
            }
            _ => Ok(()),
        }
    }

    /// Whether the name of a variable is next.
    pub(super) fn at_name(&self) -> bool {
        self.kind() == TokenKind::Word
            && !self.at_label()
            && !is_infinity(self.token().text)
            && self.section().is_none()
    }

    /// The column of the next name, added with a warning if it is new.
    pub(super) fn known_column(&mut self) -> Result<usize, Error> {
        let (name, count) = (self.token(), self.columns.len());
        let column = self.column()?;
        if column >= count {
            let text = name.text;
            let message = format!("`{text}` is neither in the objective nor in a row before");
            self.warnings.push(name.warning(message));
        }
        Ok(column)
    }

    /// The column of the next name, added if it is new.
    pub(super) fn column(&mut self) -> Result<usize, Error> {
        let name = self.step();
        self.column_of(name)
    }

    /// The column of a name, added if it is new.
    pub(super) fn column_of(&mut self, name: Token<'a>) -> Result<usize, Error> {
        if let Some(column) = self.names.find(name.text) {
            return Ok(column);
        }
        Name::from(name.text).check().map_err(|error| name.error(error.to_string()))?;
        let column = self.names.declare(name.text).unwrap_or_else(|known| known);
        let (integer, binary, semicontinuous) = (false, false, false);
        let ends = FileBounds::default();
        self.columns.push(LpColumn { name, integer, binary, semicontinuous, ends });
        Ok(column)
    }

    /// `+1` or `-1` for the signs that are next, if any.
    pub(super) fn sign(&mut self) -> Option<f64> {
        let mut sign = None;
        loop {
            match self.kind() {
                TokenKind::Plus => sign = Some(sign.unwrap_or(1.0)),
                TokenKind::Minus => sign = Some(-sign.unwrap_or(1.0)),
                _ => return sign,
            }
            self.step();
        }
    }

    /// A number or infinity with its sign, and its position.
    pub(super) fn value(&mut self) -> Result<(f64, Token<'a>), Error> {
        let sign = self.sign().unwrap_or(1.0);
        let token = self.token();
        match self.kind() {
            TokenKind::Number => {}
            TokenKind::Word if is_infinity(token.text) => {}
            _ => return Err(self.unexpected("a number")),
        }
        self.step();
        self.check_decimal_point(token)?;
        Ok((sign * token.number()?, token))
    }

    /// The error that something else was expected here.
    pub(super) fn unexpected(&self, expected: &str) -> Error {
        let token = self.token();
        match self.kind() {
            TokenKind::End => self.cut_off(),
            TokenKind::Times | TokenKind::Power | TokenKind::Open | TokenKind::Over => token.error(format!(
                "expected {expected}, found `{}`; products and squares stand on the left in brackets, \
                 as `[ x ^2 + 2 x * y ]`, in the objective with `/ 2` behind",
                token.text
            )),
            _ => token.error(format!("expected {expected}, found `{}`", token.text)),
        }
    }

    fn cut_off(&self) -> Error {
        self.token().error(CUT_OFF)
    }
}

/// The message about a file without an end.
const CUT_OFF: &str = "the file ends without `End`; it may have been cut off";

/// Whether a word means infinity.
pub(super) fn is_infinity(text: &str) -> bool {
    ["inf", "infinity"].iter().any(|word| text.eq_ignore_ascii_case(word))
}

/// The model's name, from the comment `Problem name:` before the objective.
fn problem_name(text: &str) -> Result<&str, Error> {
    const NAME_HEADING: &str = "Problem name";
    for (line, number) in text.lines().zip(1..) {
        let Some(comment) = line.trim_start().strip_prefix('\\') else {
            match line.trim().is_empty() {
                true => continue,
                false => break,
            }
        };
        let comment = comment.trim();
        if let Some(words) = comment.get(..NAME_HEADING.len())
            && words.eq_ignore_ascii_case(NAME_HEADING)
            && let Some(name) = comment[NAME_HEADING.len()..].trim_start().strip_prefix(':')
        {
            if name.chars().any(|c| c.is_control() && c != '\t') {
                let place = Token::new(line, number, line.len() - line.trim_start().len(), 0);
                return Err(place.error("the model's name has a control character"));
            }
            return Ok(name.trim());
        }
    }
    Ok("")
}
