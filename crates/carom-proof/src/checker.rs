//! The commands of a proof; those that open and close contexts are in `cases`, those about functions
//! in `terms`, declarations in `moves`.
//!
//! Context 0 assumes a point of the program, with an objective less than b if that is the bound of
//! the claim; most rules only use that it is at most b. A context holds bounds of columns, and
//! facts: rows that the point satisfies. Every command derives one more of them, opens a context
//! with one more assumption, or closes the one it stands in by a contradiction. Once context 0 is
//! closed, there is no such point.

use crate::bounds::{Bounds, Side};
use crate::cases::{Context, Kind};
use crate::exact::Plain;
use crate::linear_rules::{self, Sums};
use crate::moves::Moves;
use crate::program::{Claim, Program};
use crate::quadratic_rules::{self, Quadratic, ZeroProduct};
use crate::rows::Row;
use crate::text::{Refusal, Words, rejected, unreadable};
use std::collections::BTreeMap;

/// The deficits of a command `p`, and the columns of its factor so far.
type Convexity = (Vec<(u32, f64)>, Vec<Vec<(u32, f64)>>);

/// A proof up to some line.
#[derive(Debug)]
pub(crate) struct Checker {
    pub(crate) program: Program,
    pub(crate) facts: Vec<Row>,
    pub(crate) sums: Sums,
    pub(crate) objective: Quadratic,
    pub(crate) bounds: Bounds,
    pub(crate) moves: Moves,
    /// How many enclosures were assumed of each function that the checker does not know.
    pub(crate) assumed: BTreeMap<String, u64>,
    /// Whether nothing was derived, and whether the program has forgotten a part of it.
    pub(crate) is_plain: bool,
    pub(crate) has_forgotten: bool,
    /// Empty once the claim is proved.
    pub(crate) contexts: Vec<Context>,
    convexity: Option<Convexity>,
    steps: u64,
}

impl Checker {
    pub(crate) fn new(mut program: Program) -> Self {
        let mut bounds = Bounds::default();
        for column in &program.columns {
            bounds.push(column.lower, column.upper);
        }
        let moves = Moves::new(&program);
        let facts = std::mem::take(&mut program.rows);
        let root = Context { kind: Kind::Claim, facts: facts.len(), mark: 0 };
        Checker {
            objective: Quadratic::new(&program.objective, program.columns.len()),
            program,
            facts,
            sums: Sums::default(),
            bounds,
            moves,
            assumed: BTreeMap::new(),
            is_plain: true,
            has_forgotten: false,
            contexts: vec![root],
            convexity: None,
            steps: 0,
        }
    }

    /// Checks a command. At the last one, returns how many there were before it.
    pub(crate) fn step(&mut self, words: &mut Words<'_>) -> Result<Option<u64>, Refusal> {
        let command = words.word("a command")?;
        if command == "end" {
            return self.end(words).map(Some);
        }
        self.steps += 1;
        if self.contexts.is_empty() {
            return rejected("the claim is proved, so that only `end` can follow");
        }
        if self.convexity.is_some() && command != "l" {
            return rejected("`p` and its columns, up to `l 0`, must not be interrupted");
        }
        self.is_plain &= matches!(command, "p" | "l" | "u" | "v");
        match command {
            "b" => self.bound(words, self.is_root())?,
            "d" => self.empty_domain(words)?,
            "x" => self.contradiction(words)?,
            "k" => self.combination(words)?,
            "t" => self.tangent(words)?,
            "q" => self.cone(words)?,
            "e" => self.zero_products(words)?,
            "p" => self.deficits(words)?,
            "l" => self.factor(words)?,
            "w" => self.curvature_bounds(words)?,
            "s" => self.split_column(words)?,
            "f" => self.split_form(words)?,
            "c" => self.split_range(words)?,
            "n" => self.enclosure(words)?,
            "y" => self.inverse(words)?,
            "m" => self.lemma(words)?,
            "u" => self.round(words)?,
            "v" => self.shift(words)?,
            "i" => self.imply(words)?,
            _ => {
                let begin: String = command.chars().take(10).collect();
                return unreadable(format!("there is no command `{begin}`"));
            }
        }
        words.end()?;
        Ok(None)
    }

    fn end(&mut self, words: &mut Words<'_>) -> Result<u64, Refusal> {
        let said = words.word("the number of commands")?.parse::<u64>();
        words.end()?;
        let steps = self.steps;
        match said {
            Ok(said) if said == steps => {}
            _ => return rejected(format!("there are {steps} commands, other than `end` says")),
        }
        if let Some(depth) = self.contexts.len().checked_sub(1) {
            return rejected(format!("the claim is not proved: context {depth} is not closed"));
        }
        Ok(steps)
    }

    /// A point may stand at any place, also behind the proof, as long as the whole program is
    /// known.
    pub(crate) fn count_point(&mut self) -> Result<(), Refusal> {
        self.steps += 1;
        if self.has_forgotten {
            return rejected("a point must stand before `v`");
        }
        Ok(())
    }

    fn bound(&mut self, words: &mut Words<'_>, is_lasting: bool) -> Result<(), Refusal> {
        let column = words.index("column", self.bounds.len())?;
        let side = side(words)?;
        let value = words.number("the bound")?;
        let fact = words.index("fact", self.facts.len())?;
        if !self.bounds.is_tighter(column, side, value) {
            return Ok(());
        }
        let is_integral = self.is_integral(column);
        let Some(row) = self.facts.get(fact) else { return Ok(()) };
        let bound = (column, side, value);
        linear_rules::bound(row, bound, is_integral, &self.bounds, &mut self.sums)?;
        self.bounds.tighten(column, side, value, is_lasting);
        Ok(())
    }

    fn empty_domain(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let column = words.index("column", self.bounds.len())?;
        let (lower, upper) = self.bounds.of(column);
        if lower <= upper && !self.is_implied(column) {
            let name = self.name(column);
            return rejected(format!(
                "column {name} may be from {} to {}",
                Plain(lower),
                Plain(upper)
            ));
        }
        self.close()
    }

    fn contradiction(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let multipliers = linear_rules::multipliers(words, self.facts.len())?;
        let row = linear_rules::combination(&self.facts, &multipliers, &mut self.sums)?;
        linear_rules::contradiction(&row, &self.bounds, &mut self.sums)?;
        self.close()
    }

    fn combination(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let multipliers = linear_rules::multipliers(words, self.facts.len())?;
        let row = linear_rules::combination(&self.facts, &multipliers, &mut self.sums)?;
        self.facts.push(row);
        Ok(())
    }

    fn tangent(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let Claim::Bound(limit) = self.program.claim else {
            return rejected("without a bound to prove, nothing is known of the objective");
        };
        let point = words.entries(self.bounds.len())?;
        self.facts.push(self.objective.tangent(&point, limit, &self.bounds, &mut self.sums)?);
        Ok(())
    }

    fn cone(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let index = words.index("cone", self.program.cones.len())?;
        let Some(cone) = self.program.cones.get(index) else { return Ok(()) };
        let first = words.number("the weight of the head")?;
        let second = match cone.second {
            Some(_) => words.number("the weight of the second head")?,
            None => first,
        };
        let count = words.count("the number of entries")?;
        if count != cone.tail.len() {
            return rejected(format!("cone {index} has {} columns in its tail", cone.tail.len()));
        }
        let mut weights = Vec::new();
        for _ in 0..count {
            weights.push(words.number("a weight")?);
        }
        let sum = &mut self.sums.column;
        self.facts.push(quadratic_rules::cone_tangent(cone, (first, second), &weights, sum)?);
        Ok(())
    }

    /// Products of which one factor is 0 if a binary is off, by the bounds that follow, and the
    /// other if not.
    fn zero_products(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        if !self.is_root() || self.objective.deficits().is_some() {
            return rejected("`e` must stand in context 0, before `p`");
        }
        let mut products = Vec::new();
        for _ in 0..words.count("the number of products")? {
            let column = words.index("column", self.bounds.len())?;
            let value = words.number("the value")?;
            let binary = words.index("column", self.bounds.len())?;
            let off = words.index("side of a binary", 2)?;
            let factor = words.number("the factor")?;
            let (lower, upper) = self.bounds.of(binary);
            if !self.is_integral(binary) || lower < 0.0 || upper > 1.0 {
                return rejected(format!("column {} is no binary", self.name(binary)));
            }
            let mark = self.bounds.mark();
            self.bounds.tighten(binary, Side::Lower, off as f64, false);
            self.bounds.tighten(binary, Side::Upper, off as f64, false);
            for _ in 0..words.count("the number of bounds")? {
                self.bound(words, false)?;
            }
            if self.bounds.of(column) != (value, value) {
                let (name, binary) = (self.name(column), self.name(binary));
                return rejected(format!(
                    "column {name} may be other than {} while column {binary} is {off}",
                    Plain(value)
                ));
            }
            self.bounds.undo(mark);
            let (column, binary, is_off_at_one) = (column as u32, binary as u32, off == 1);
            products.push(ZeroProduct { column, value, binary, is_off_at_one, factor });
        }
        self.objective.add_zero(&products, &mut self.sums)
    }

    fn deficits(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let deficits = words.entries(self.bounds.len())?;
        if !self.is_root() {
            return rejected("`p` must stand in context 0");
        }
        self.convexity = Some((deficits, Vec::new()));
        Ok(())
    }

    fn factor(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let entries = words.entries(self.bounds.len())?;
        let Some((deficits, mut factor)) = self.convexity.take() else {
            return rejected("`l` without `p`");
        };
        if entries.is_empty() {
            return self.objective.prove(deficits, &factor, &mut self.sums);
        }
        factor.push(entries);
        self.convexity = Some((deficits, factor));
        Ok(())
    }

    fn curvature_bounds(&mut self, words: &mut Words<'_>) -> Result<(), Refusal> {
        let Claim::Bound(limit) = self.program.claim else {
            return rejected("without a bound to prove, nothing is known of the objective");
        };
        let point = words.entries(self.bounds.len())?;
        let falls = words.entries(self.bounds.len())?;
        let around = self.objective.around(point, falls, &self.bounds, &mut self.sums)?;
        let count = words.count("the number of bounds")?;
        for _ in 0..count {
            let column = words.index("column", self.bounds.len())?;
            let (side, value) = (side(words)?, words.number("the bound")?);
            let known = (limit, &self.bounds);
            if self.objective.is_beyond(&around, column, side, value, known, &mut self.sums)? {
                if self.bounds.is_tighter(column, side, value) {
                    self.tighten(column, side, value);
                }
            } else {
                let name = self.name(column);
                return rejected(format!(
                    "the curvature does not bound column {name} by {}",
                    Plain(value)
                ));
            }
        }
        Ok(())
    }

    pub(crate) fn tighten(&mut self, column: usize, side: Side, value: f64) {
        let is_lasting = self.is_root();
        self.bounds.tighten(column, side, value, is_lasting);
    }

    pub(crate) fn is_root(&self) -> bool {
        self.contexts.len() == 1
    }

    pub(crate) fn is_integral(&self, column: usize) -> bool {
        self.moves.whole.contains(&column)
    }

    pub(crate) fn name(&self, column: usize) -> String {
        match self.program.columns.get(column) {
            Some(found) if !found.name.is_empty() => format!("{column} ({})", found.name),
            _ => column.to_string(),
        }
    }
}

/// The side that a word names.
pub(crate) fn side(words: &mut Words<'_>) -> Result<Side, Refusal> {
    match words.word("`L` or `U`")? {
        "L" => Ok(Side::Lower),
        "U" => Ok(Side::Upper),
        _ => unreadable("a side is neither `L` nor `U`"),
    }
}
