//! The lexer: numbers, words and symbols, each with its position.

use crate::error::Error;
use crate::model::text::token::Token;

/// A token.
#[derive(Debug, Clone, Copy)]
pub(super) struct TypedToken<'a> {
    pub(super) token: Token<'a>,
    pub(super) kind: TokenKind,
}

/// The kind of a token.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TokenKind {
    Number,
    /// A name or a keyword.
    Word,
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Colon,
    Open,
    Close,
    AtMost,
    AtLeast,
    Equal,
    /// `->`
    Arrow,
    /// After the last token.
    End,
}

/// Characters that end a word.
pub(super) const OPERATORS: [char; 10] = ['+', '-', '*', '/', '^', ':', '<', '>', '=', '\\'];

/// All tokens of a text, followed by one of kind [`TokenKind::End`].
pub(super) fn pieces(text: &str) -> Result<Vec<TypedToken<'_>>, Error> {
    let mut pieces = Vec::new();
    let mut last = ("", 1);
    for (line, number) in text.lines().zip(1..) {
        last = (line, number);
        let mut start = 0;
        while let Some(letter) = line[start..].chars().next() {
            let rest = &line[start..];
            if letter.is_whitespace() {
                start += letter.len_utf8();
                continue;
            }
            if letter == '\\' {
                break;
            }
            let place = |length| Token::new(line, number, start, length);
            let (kind, length) = piece(rest).map_err(|message| place(1).error(message))?;
            pieces.push(TypedToken { token: place(length), kind });
            start += length;
        }
    }
    let (line, number) = last;
    pieces
        .push(TypedToken { token: Token::new(line, number, line.len(), 0), kind: TokenKind::End });
    Ok(pieces)
}

/// The kind and the length of the token that a text begins with.
fn piece(text: &str) -> Result<(TokenKind, usize), &'static str> {
    const SYMBOLS: [(&str, TokenKind); 17] = [
        ("<=", TokenKind::AtMost),
        ("=<", TokenKind::AtMost),
        (">=", TokenKind::AtLeast),
        ("=>", TokenKind::AtLeast),
        ("->", TokenKind::Arrow),
        ("==", TokenKind::Equal),
        ("<", TokenKind::AtMost),
        (">", TokenKind::AtLeast),
        ("=", TokenKind::Equal),
        ("+", TokenKind::Plus),
        ("-", TokenKind::Minus),
        ("*", TokenKind::Times),
        ("/", TokenKind::Over),
        ("^", TokenKind::Power),
        (":", TokenKind::Colon),
        ("[", TokenKind::Open),
        ("]", TokenKind::Close),
    ];
    if text.starts_with("<->") {
        return Err("`<->` cannot be read; write an indicator for each direction (`->`)");
    }
    if let Some(&(symbol, kind)) = SYMBOLS.iter().find(|(symbol, _)| text.starts_with(symbol)) {
        return Ok((kind, symbol.len()));
    }
    let number = number_length(text);
    Ok(if number > 0 { (TokenKind::Number, number) } else { (TokenKind::Word, word_length(text)) })
}

/// The length of the number that a text begins with, 0 for none.
pub(super) fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let whole = digits(0);
    let mut end = whole;
    if text[end..].starts_with('.') {
        let fraction = digits(end + 1);
        if whole + fraction == 0 {
            return 0;
        }
        end += 1 + fraction;
    }
    if end > 0 && text[end..].starts_with(['e', 'E']) {
        let sign = usize::from(text[end + 1..].starts_with(['+', '-']));
        let exponent = digits(end + 1 + sign);
        if exponent > 0 {
            end += 1 + sign + exponent;
        }
    }
    end
}

/// The length of the word that a text begins with, including matching brackets.
fn word_length(text: &str) -> usize {
    let mut depth = 0_usize;
    for (place, letter) in text.char_indices() {
        match letter {
            '[' => depth += 1,
            ']' if depth == 0 => return place,
            ']' => depth -= 1,
            _ if letter.is_whitespace() || OPERATORS.contains(&letter) => return place,
            _ => {}
        }
    }
    text.len()
}
