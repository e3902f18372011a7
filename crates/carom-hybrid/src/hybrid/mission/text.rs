//! The text of a mission: written and read.

use std::fmt;

use super::formula::{MAX_DEPTH, Mission, MissionNode, Predicate};
use super::window::Window;
use crate::error::{Error, ErrorKind};

/// Words that are operators or constants.
const RESERVED: [&str; 7] = ["F", "G", "X", "U", "R", "true", "false"];

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_' || c == '.'
}

/// Whether a name can stand without quotes.
fn is_plain(name: &str) -> bool {
    let is_good =
        |word: &str| !word.is_empty() && word.chars().all(is_word) && !RESERVED.contains(&word);
    name.split(' ').all(is_good)
}

impl fmt::Display for Mission {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.node {
            MissionNode::Holds(Predicate { name, .. }) if is_plain(name) => f.write_str(name),
            MissionNode::Holds(Predicate { name, .. }) => {
                write!(f, "`{}`", name.replace('`', "``"))
            }
            MissionNode::Not(of) => write!(f, "!{}", Operand(of)),
            MissionNode::And(of) => list(f, of, " & ", "true"),
            MissionNode::Or(of) => list(f, of, " | ", "false"),
            MissionNode::Always(Window::Steps(1, Some(1)), of) => write!(f, "X {}", Operand(of)),
            MissionNode::Always(window, of) => write!(f, "G{window} {}", Operand(of)),
            MissionNode::Eventually(window, of) => write!(f, "F{window} {}", Operand(of)),
            MissionNode::Until(window, a, b) => {
                write!(f, "{} U{window} {}", Operand(a), Operand(b))
            }
            MissionNode::Release(window, a, b) => {
                write!(f, "{} R{window} {}", Operand(a), Operand(b))
            }
            MissionNode::TooDeep => f.write_str("..."),
        }
    }
}

fn list(f: &mut fmt::Formatter<'_>, of: &[Mission], operator: &str, empty: &str) -> fmt::Result {
    if of.is_empty() {
        return f.write_str(empty);
    }
    for (k, part) in of.iter().enumerate() {
        if k > 0 {
            f.write_str(operator)?;
        }
        write!(f, "{}", Operand(part))?;
    }
    Ok(())
}

/// A mission inside another one.
struct Operand<'a>(&'a Mission);

impl fmt::Display for Operand<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.node {
            MissionNode::And(of) | MissionNode::Or(of) if !of.is_empty() => {
                write!(f, "({})", self.0)
            }
            MissionNode::Until(..) | MissionNode::Release(..) => write!(f, "({})", self.0),
            _ => write!(f, "{}", self.0),
        }
    }
}

impl Mission {
    /// Reads a mission from its text. Operators bind in the order of the table above, `!`, `G`, `F`
    /// and `X` most and `->` least; a window that is left out is `[0,]`.
    ///
    /// # Arguments
    ///
    /// * `predicates`: missions in which each name of the text stands for [rows](Mission::holds).
    ///
    /// ```
    /// use carom::hybrid::Mission;
    /// use carom::prelude::*;
    ///
    /// let mut cart = HybridSystem::new(0.5); // s
    /// let x = cart.state("x", -9.0, 9.0)?; // m
    /// let places = [Mission::holds("in A", [x.ge(3.0)]), Mission::holds("in D", [x.le(0.0)])];
    /// let mission = Mission::parse("F[0,10s](in A) & G !(in D)", places)?;
    /// assert_eq!(mission.to_string(), "F[0,10s] in A & G[0,] !in D");
    /// # Ok::<(), carom::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`ErrorKind::Parse`] with the place; [`ErrorKind::UnknownName`] for a name without rows.
    pub fn parse(
        text: &str,
        predicates: impl IntoIterator<Item = Mission>,
    ) -> Result<Mission, Error> {
        let known: Vec<Mission> = predicates.into_iter().collect();
        let mut parser = Parser { text, at: 0, known: &known, depth: 0 };
        let mission = parser.implication()?;
        match parser.peek() {
            None => Ok(mission),
            Some(_) => Err(parser.error("an operator (`&`, `|`, `->`, `U`, `R`) or the end")),
        }
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    known: &'a [Mission],
    depth: u32,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn peek(&mut self) -> Option<char> {
        self.at += self.rest().len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    /// Goes over a symbol, if it comes next.
    fn takes(&mut self, symbol: &str) -> bool {
        let found = self.peek().is_some() && self.rest().starts_with(symbol);
        self.at += if found { symbol.len() } else { 0 };
        found
    }

    /// The word that comes next, without going over it.
    fn word(&mut self) -> &str {
        self.peek();
        let rest = self.rest();
        &rest[..rest.find(|c| !is_word(c)).unwrap_or(rest.len())]
    }

    fn takes_word(&mut self, word: &str) -> bool {
        let found = self.word() == word;
        self.at += if found { word.len() } else { 0 };
        found
    }

    fn error(&self, expected: &str) -> Error {
        let before = &self.text[..self.at];
        let line = 1 + before.matches('\n').count();
        let column = 1 + before.rsplit('\n').next().unwrap_or("").chars().count();
        let found = match self.rest().chars().next() {
            Some(c) => format!("`{c}`"),
            None => "the end".to_owned(),
        };
        let message = format!("found {found} in the mission, where {expected} was expected");
        ErrorKind::Parse { line, column, message }.into()
    }

    fn implication(&mut self) -> Result<Mission, Error> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error(&format!("a mission of at most {MAX_DEPTH} levels")));
        }
        let left = self.chain("|")?;
        let mission = match self.takes("->") {
            true => left.implies(self.implication()?),
            false => left,
        };
        self.depth -= 1;
        Ok(mission)
    }

    /// Operands with the same operator between them.
    fn chain(&mut self, operator: &str) -> Result<Mission, Error> {
        let operand = |parser: &mut Self| match operator {
            "|" => parser.chain("&"),
            _ => parser.until(),
        };
        let mut of = vec![operand(self)?];
        while self.takes(operator) {
            of.push(operand(self)?);
        }
        match (of.len(), operator) {
            (1, _) => Ok(of.remove(0)),
            (_, "|") => Ok(Mission::any(of)),
            _ => Ok(Mission::all(of)),
        }
    }

    fn until(&mut self) -> Result<Mission, Error> {
        let left = self.unary()?;
        if self.takes_word("U") {
            let window = self.window()?;
            return Ok(left.until(window, self.unary()?));
        }
        if self.takes_word("R") {
            let window = self.window()?;
            return Ok(left.release(window, self.unary()?));
        }
        Ok(left)
    }

    fn unary(&mut self) -> Result<Mission, Error> {
        // From the innermost operator outwards, so that a long chain of them is no recursion.
        let mut operators: Vec<(char, Window)> = Vec::new();
        loop {
            if self.takes("!") {
                operators.push(('!', Window::Steps(0, None)));
            } else if self.takes_word("X") {
                operators.push(('G', Window::Steps(1, Some(1))));
            } else if self.takes_word("G") {
                operators.push(('G', self.window()?));
            } else if self.takes_word("F") {
                operators.push(('F', self.window()?));
            } else {
                break;
            }
        }
        if operators.len() > MAX_DEPTH as usize {
            return Err(self.error(&format!("a mission of at most {MAX_DEPTH} levels")));
        }
        let mut mission = self.operand()?;
        for (operator, window) in operators.into_iter().rev() {
            mission = match operator {
                '!' => !mission,
                'G' => mission.always(window),
                _ => mission.eventually(window),
            };
        }
        Ok(mission)
    }

    fn operand(&mut self) -> Result<Mission, Error> {
        if self.takes("(") {
            let mission = self.implication()?;
            return match self.takes(")") {
                true => Ok(mission),
                false => Err(self.error("`)`")),
            };
        }
        if self.takes_word("true") {
            return Ok(Mission::all([]));
        }
        if self.takes_word("false") {
            return Ok(Mission::any([]));
        }
        let name = self.name()?;
        let mut found = None;
        for mission in self.known {
            mission.visit(&mut |part| match &part.node {
                MissionNode::Holds(own) if own.name == name => found = found.or(Some(part)),
                _ => {}
            });
        }
        let found = found.cloned();
        found.ok_or_else(|| Error::unknown_name(&name, "predicate"))
    }

    fn name(&mut self) -> Result<String, Error> {
        if self.takes("`") {
            let mut name = String::new();
            while let Some(c) = self.rest().chars().next() {
                self.at += c.len_utf8();
                match c {
                    '`' if self.rest().starts_with('`') => self.at += 1,
                    '`' => return Ok(name),
                    _ => {}
                }
                name.push(c);
            }
            return Err(self.error("a closing backtick"));
        }
        let mut name = String::new();
        loop {
            let word = self.word().to_owned();
            if word.is_empty() || RESERVED.contains(&word.as_str()) {
                break;
            }
            self.at += word.len();
            name += if name.is_empty() { "" } else { " " };
            name += &word;
        }
        match name.is_empty() {
            true => Err(self.error("a name, `(`, or one of `!`, `G`, `F`, `X`")),
            false => Ok(name),
        }
    }

    /// `[0,5]`, `[0,2.5s]`, `[2,]`, `[1s,]`, or nothing.
    fn window(&mut self) -> Result<Window, Error> {
        if !self.takes("[") {
            return Ok(Window::Steps(0, None));
        }
        let begin = self.bound()?;
        if !self.takes(",") {
            return Err(self.error("`,`"));
        }
        let end = if self.peek() == Some(']') { None } else { Some(self.bound()?) };
        if !self.takes("]") {
            return Err(self.error("`]`"));
        }
        let (first, in_seconds) = begin;
        let steps = |value: f64, parser: &Self| match value.fract() == 0.0 && value < 1e15 {
            true => Ok(value as usize),
            false => Err(parser.error("a window of whole steps, or of seconds as in `[0,2.5s]`,")),
        };
        match end {
            Some((last, true)) => Ok(Window::Seconds(first, Some(last))),
            None if in_seconds => Ok(Window::Seconds(first, None)),
            Some((_, false)) if in_seconds => {
                Err(self.error("an end in seconds, as in `[1s,2s]`,"))
            }
            Some((last, _)) => Ok(Window::Steps(steps(first, self)?, Some(steps(last, self)?))),
            None => Ok(Window::Steps(steps(first, self)?, None)),
        }
    }

    /// A number of a window, and whether it is in seconds.
    fn bound(&mut self) -> Result<(f64, bool), Error> {
        self.peek();
        let rest = self.rest();
        let is_part = |(k, c): &(usize, char)| {
            let after = rest[..*k].ends_with(['e', 'E']);
            c.is_ascii_digit() || *c == '.' || (*k > 0 && "eE".contains(*c)) || (after && *c == '-')
        };
        let length = rest.char_indices().find(|part| !is_part(part)).map_or(rest.len(), |c| c.0);
        match rest[..length].parse::<f64>() {
            Ok(value) if value.is_finite() => {
                self.at += length;
                Ok((value, self.takes_word("s")))
            }
            _ => Err(self.error("a number that is at least 0")),
        }
    }
}
