//! LP files in the format of CPLEX.

use super::lp_words::{SIGNS, Section, Token, section, tokens};
use super::model::{Indicator, Model, Products, Row, Statement};

/// Magnitudes from here on are infinite.
const INFINITE: f64 = 1e20;
pub(super) fn read(text: &str) -> Result<Model, String> {
    let mut model = Model::default();
    // All lines of a section are read together.
    let mut sections: Vec<(Section, String, Vec<&str>)> = Vec::new();
    for line in text.lines() {
        let line = line.split('\\').next().unwrap_or_default();
        match section(line) {
            Some((Section::End, _)) => break,
            Some((section, rest)) => sections.push((section, line.trim().to_string(), vec![rest])),
            None => sections.last_mut().into_iter().for_each(|section| section.2.push(line)),
        }
    }
    let (mut binaries, mut indicators) = (Vec::new(), Vec::new());
    for (section, title, lines) in sections {
        let tokens: Vec<Token<'_>> = lines.iter().flat_map(|line| tokens(line)).collect();
        let mut tokens = Tokens { all: &tokens, at: 0 };
        match section {
            Section::Objective => {
                model.is_maximisation = title.to_ascii_lowercase().starts_with("max");
                tokens.label();
                let form = tokens.form(&mut model)?;
                (model.linear, model.constant) = (form.linear, form.constant);
                for (i, j, value) in form.products {
                    // `1/2 x'Px` is `P_ii / 2` times a square, and `P_ij` times another product.
                    let value = if i == j { 2.0 * value } else { value };
                    model.triangle.push((i, j, value));
                }
            }
            Section::Rows => {
                while !tokens.is_done() {
                    tokens.row(&mut model, &mut indicators)?;
                }
            }
            Section::Bounds => {
                while !tokens.is_done() {
                    tokens.bound(&mut model)?;
                }
            }
            Section::General | Section::Binary => {
                for (name, _) in tokens.all {
                    let index = model.column(name);
                    if section == Section::Binary {
                        binaries.push(index);
                    }
                    if let Some(column) = model.column_mut(index) {
                        column.is_integral = true;
                    }
                }
            }
            Section::Semicontinuous => {
                for (name, _) in tokens.all {
                    let index = model.column(name);
                    model.leave_out(format!("semi-continuous column {name}"));
                    model.statements.push(Statement::Semicontinuous(index));
                }
            }
            Section::Sets => tokens.sets(&title, &mut model),
            Section::Other if tokens.is_done() => {}
            Section::Other => model.leave_out(format!("section {title}")),
            Section::End => {}
        }
    }
    for &index in &binaries {
        if let Some(column) = model.column_mut(index) {
            (column.lower, column.upper) = (column.lower.max(0.0), column.upper.min(1.0));
        }
    }
    // Bounds and binaries stand behind the rows.
    for indicator in std::mem::take(&mut indicators) {
        model.indicator(indicator);
    }
    Ok(model)
}

#[derive(Default)]
struct LinearForm {
    linear: Vec<(u32, f64)>,
    products: Vec<(u32, u32, f64)>,
    constant: f64,
}

impl LinearForm {
    fn is_constant(&self) -> bool {
        self.linear.is_empty() && self.products.is_empty()
    }
}

struct Tokens<'a> {
    all: &'a [Token<'a>],
    at: usize,
}

impl<'a> Tokens<'a> {
    fn is_done(&self) -> bool {
        self.at >= self.all.len()
    }

    fn peek(&self) -> &'a str {
        self.all.get(self.at).map_or("", |token| token.0)
    }

    fn take(&mut self, token: &str) -> bool {
        let is_there = !self.is_done() && self.peek() == token;
        self.at += usize::from(is_there);
        is_there
    }

    fn label(&mut self) -> Option<&'a str> {
        let label = self.peek();
        let is_label = self.all.get(self.at + 1).is_some_and(|token| token.0 == ":");
        is_label.then(|| {
            self.at += 2;
            label
        })
    }

    /// The number here, without a sign.
    fn number(&mut self) -> Option<f64> {
        let word = self.peek();
        let value = match word.to_ascii_lowercase().as_str() {
            "inf" | "infinity" => f64::INFINITY,
            _ if word.starts_with(|c: char| c.is_ascii_digit() || c == '.') => word.parse().ok()?,
            _ => return None,
        };
        self.at += 1;
        Some(if value >= INFINITE { f64::INFINITY } else { value })
    }

    /// The signs here: 1, -1, or none.
    fn sign(&mut self) -> Option<f64> {
        let mut sign = None;
        while ["+", "-"].contains(&self.peek()) {
            let one = if self.peek() == "-" { -1.0 } else { 1.0 };
            sign = Some(one * sign.unwrap_or(1.0));
            self.at += 1;
        }
        sign
    }

    fn limit(&mut self) -> Result<f64, String> {
        let sign = self.sign().unwrap_or(1.0);
        self.number().map(|value| sign * value).ok_or_else(|| self.unexpected("a number"))
    }

    /// `<`, `>` or `=`.
    fn relation(&mut self) -> Option<char> {
        let relation = match self.peek() {
            "<" | "<=" | "=<" => '<',
            ">" | ">=" | "=>" => '>',
            "=" | "==" => '=',
            _ => return None,
        };
        self.at += 1;
        Some(relation)
    }

    fn unexpected(&self, expected: &str) -> String {
        let near: Vec<&str> =
            self.all.iter().skip(self.at.saturating_sub(3)).take(6).map(|token| token.0).collect();
        format!("{expected} must be near `{}`", near.join(" "))
    }

    /// A name, which begins with neither a digit nor a sign.
    fn name(&mut self) -> Option<&'a str> {
        let word = self.peek();
        let is_name = !word.is_empty()
            && !word.starts_with(|c: char| SIGNS.contains(&c) || c.is_ascii_digit() || c == '.');
        is_name.then(|| {
            self.at += 1;
            word
        })
    }

    /// Terms up to what cannot go on: all but the first one begin with a sign.
    fn form(&mut self, model: &mut Model) -> Result<LinearForm, String> {
        let mut form = LinearForm::default();
        let mut is_first = true;
        loop {
            let sign = self.sign();
            let is_relation = self.peek().starts_with(['<', '>', '=']);
            if sign.is_none() && (!is_first || is_relation || self.is_done()) {
                return Ok(form);
            }
            let (sign, factor) = (sign.unwrap_or(1.0), self.number());
            self.take("*");
            let value = sign * factor.unwrap_or(1.0);
            if self.take("[") {
                let products = self.products(model)?;
                form.products.extend(products.iter().map(|&(i, j, entry)| (i, j, value * entry)));
            } else if let Some(name) = self.name_of_term() {
                form.linear.push((model.column(name), value));
            } else if factor.is_some() {
                form.constant += value;
            } else {
                return Err(self.unexpected("a term"));
            }
            is_first = false;
        }
    }

    /// The name of a term, which is on the line of its number unless a label follows it.
    fn name_of_term(&mut self) -> Option<&'a str> {
        let is_label = self.all.get(self.at + 1).is_some_and(|token| token.0 == ":");
        if is_label { None } else { self.name() }
    }

    /// Products up to `]`, and `/ 2`.
    fn products(&mut self, model: &mut Model) -> Result<Vec<(u32, u32, f64)>, String> {
        let mut products = Vec::new();
        while !self.take("]") {
            let sign = self.sign().unwrap_or(1.0);
            let value = sign * self.number().unwrap_or(1.0);
            self.take("*");
            let first = self.name().ok_or_else(|| self.unexpected("a variable"))?;
            let second = if self.take("^") {
                if self.number() != Some(2.0) {
                    return Err(self.unexpected("a 2"));
                }
                first
            } else if self.take("*") {
                self.name().ok_or_else(|| self.unexpected("a variable"))?
            } else {
                return Err(self.unexpected("`^ 2` or `*`"));
            };
            let (i, j) = (model.column(first), model.column(second));
            products.push((i.min(j), i.max(j), value));
        }
        if self.take("/") {
            let divisor = self.number().ok_or_else(|| self.unexpected("a number"))?;
            products.iter_mut().for_each(|product| product.2 /= divisor);
        }
        Ok(products)
    }

    /// Members of ordered sets, `name: S1:: x:1 y:2`.
    fn sets(&mut self, title: &str, model: &mut Model) {
        let of_title = if title.to_ascii_lowercase().ends_with('1') { 1 } else { 2 };
        let (mut most, mut members) = (of_title, Vec::new());
        while !self.is_done() {
            let word = self.peek();
            self.at += 1;
            let is_type = ["s1", "s2"].contains(&word.to_ascii_lowercase().as_str());
            let colons = self.all.iter().skip(self.at).take_while(|token| token.0 == ":").count();
            self.at += colons;
            let is_member = colons == 1 && {
                let start = self.at;
                let is_weight = self.limit().is_ok();
                self.at = if is_weight { self.at } else { start };
                is_weight
            };
            if is_member {
                members.push(model.column(word));
                continue;
            }
            // A set begins, by its name or its type.
            if !members.is_empty() {
                model.set(std::mem::take(&mut members), most);
            }
            if is_type && colons == 2 {
                most = if word.ends_with('1') { 1 } else { 2 };
            }
        }
        if !members.is_empty() {
            model.set(members, most);
        }
    }

    fn row(&mut self, model: &mut Model, indicators: &mut Vec<Indicator>) -> Result<(), String> {
        let place = model.rows.len() + 1;
        let name = self.label().map_or_else(|| format!("c{place}"), ToString::to_string);
        let (row, products) = self.line(name, model)?;
        if self.take("->") {
            let (own, squares) = self.line(row.name.clone(), model)?;
            match row.entries[..] {
                [(binary, _)] if squares.is_empty() && row.lower == row.upper => {
                    indicators.push(Indicator { binary, value: row.lower, row: own });
                }
                _ => model.leave_out(format!("indicator {}", row.name)),
            }
        } else if products.is_empty() {
            model.rows.push(row);
        } else {
            model.squares(row, &products);
        }
        Ok(())
    }

    /// A row without its name, and its products.
    fn line(&mut self, name: String, model: &mut Model) -> Result<(Row, Products), String> {
        let (mut lower, mut upper) = (f64::NEG_INFINITY, f64::INFINITY);
        let mut form = self.form(model)?;
        let mut relation = self.relation().ok_or_else(|| self.unexpected("a relation"))?;
        if form.is_constant() {
            let limit = form.constant;
            form = self.form(model)?;
            match relation {
                '<' => lower = limit,
                '>' => upper = limit,
                _ => (lower, upper) = (limit, limit),
            }
            match self.relation() {
                Some(second) => relation = second,
                None => relation = ' ',
            }
        }
        if relation != ' ' {
            let limit = self.limit()?;
            match relation {
                '<' => upper = limit,
                '>' => lower = limit,
                _ => (lower, upper) = (limit, limit),
            }
        }
        let (lower, upper) = (lower - form.constant, upper - form.constant);
        Ok((Row { name, lower, upper, entries: form.linear }, form.products))
    }

    fn bound(&mut self, model: &mut Model) -> Result<(), String> {
        let start = self.at;
        let before = match self.limit() {
            Ok(limit) => {
                Some((limit, self.relation().ok_or_else(|| self.unexpected("a relation"))?))
            }
            Err(_) => {
                self.at = start;
                None
            }
        };
        let name = self.name().ok_or_else(|| self.unexpected("a variable"))?;
        let index = model.column(name);
        let after = match self.relation() {
            Some(relation) => Some((self.limit()?, relation)),
            None => None,
        };
        let is_free = before.is_none() && after.is_none() && {
            let word = self.peek().to_ascii_lowercase();
            self.at += usize::from(word == "free");
            word == "free"
        };
        let Some(column) = model.column_mut(index) else { return Ok(()) };
        if is_free {
            (column.lower, column.upper) = (f64::NEG_INFINITY, f64::INFINITY);
        } else if before.is_none() && after.is_none() {
            return Err(self.unexpected("a bound"));
        }
        // A limit on the left means the contrary of one on the right.
        let before = before.map(|(limit, relation)| match relation {
            '<' => (limit, '>'),
            '>' => (limit, '<'),
            _ => (limit, '='),
        });
        for (limit, relation) in before.into_iter().chain(after) {
            match relation {
                '<' => column.upper = limit,
                '>' => column.lower = limit,
                _ => (column.lower, column.upper) = (limit, limit),
            }
        }
        Ok(())
    }
}
