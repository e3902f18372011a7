//! Reads the certificate of a table, so that its build goes on in another process.
//!
//! Nothing is taken on trust: plans and proofs are computed again, in floats, and a cell of which
//! something does not hold is open.

use std::io::BufRead;
use std::str::FromStr;
use std::sync::Arc;

use carom_model::{Error, ErrorKind};

use crate::bounds::{self, Coefficients, CornerPlace, Evidence};
use crate::build::{CellLaw, PartitionCell, plans_cost};
use crate::certificate::statement_text;
use crate::form::{ParametricForm, refused};
use crate::partition::Partition;
use crate::proof_of_cell::{CellProof, CellStep, largest_difference};
use crate::relaxed::{CornerRelaxation, PLAN_TOLERANCE, RAY_MARGIN};
use crate::simplex_cell::{kuhn, midpoint, orders};

/// The lines of a certificate.
struct SavedLines<R> {
    input: R,
    number: usize,
}

/// The words of a line.
struct SavedWords {
    words: Vec<String>,
    next: usize,
    line: usize,
}

impl<R: BufRead> SavedLines<R> {
    fn text(&mut self) -> Result<String, Error> {
        let mut text = String::new();
        self.number += 1;
        let read = self.input.read_line(&mut text).map_err(|error| {
            let what = format!("line {} of a table cannot be read: {error}", self.number);
            Error::from(ErrorKind::Io { what, help: "check the file" })
        })?;
        match read {
            0 => Err(damaged(self.number, "the table ends early")),
            _ => Ok(text.trim_end().to_owned()),
        }
    }

    fn words(&mut self) -> Result<SavedWords, Error> {
        let text = self.text()?;
        let words = text.split(' ').map(str::to_owned).collect();
        Ok(SavedWords { words, next: 0, line: self.number })
    }
}

fn damaged(line: usize, message: &str) -> Error {
    ErrorKind::Parse { line, column: 1, message: message.to_owned() }.into()
}

impl SavedWords {
    fn word(&mut self) -> Result<&str, Error> {
        self.next += 1;
        match self.words.get(self.next - 1) {
            Some(word) => Ok(word),
            None => Err(damaged(self.line, "the line ends early")),
        }
    }

    fn value<T: FromStr>(&mut self) -> Result<T, Error> {
        let line = self.line;
        self.word()?.parse().map_err(|_| damaged(line, "a number is expected"))
    }

    /// A number below an end.
    fn index(&mut self, end: usize) -> Result<usize, Error> {
        let index = self.value()?;
        if index < end { Ok(index) } else { Err(damaged(self.line, "a number is too large")) }
    }

    fn expect(&mut self, keyword: &str) -> Result<(), Error> {
        let line = self.line;
        match self.word()? == keyword {
            true => Ok(()),
            false => Err(damaged(line, &format!("`{keyword}` is expected"))),
        }
    }

    /// Entries as a vector of so many numbers.
    fn dense(&mut self, length: usize) -> Result<Vec<f64>, Error> {
        let mut all = vec![0.0; length];
        for _ in 0..self.value::<usize>()? {
            let index = self.index(length)?;
            let value: f64 = self.value()?;
            if !value.is_finite() {
                return Err(damaged(self.line, "a number is not finite"));
            }
            all[index] = value;
        }
        Ok(all)
    }
}

/// The lists in which cells name entries by numbers.
struct SavedParts<'a> {
    form: &'a ParametricForm,
    plans: Vec<Vec<f64>>,
    /// Where a plan is used; known from its first use.
    used: Vec<Option<(Vec<i64>, Arc<CornerRelaxation>)>>,
    evidence: Vec<Arc<Evidence>>,
    /// Of the plans, which are not solved again.
    none: Arc<Evidence>,
}

/// The partition of a table of this form.
pub(crate) fn read_partition(
    form: &ParametricForm,
    input: impl BufRead,
) -> Result<Partition, Error> {
    let mut lines = SavedLines { input, number: 0 };
    for own in statement_text(form).lines() {
        if lines.text()? != own {
            let what = format!("a table of another program, from line {} on", lines.number);
            return Err(refused(what, "go on with a table of the same model and axes"));
        }
    }
    // Losses, inputs, loops and devices are those of the new table.
    let mut words = lines.words()?;
    while words.words[0] != "plans" {
        words = lines.words()?;
    }
    words.expect("plans")?;
    let (columns, rows) = (form.columns(), form.rows.len());
    let zero = |length: usize| vec![0.0; length];
    let none = Arc::new(Evidence::bound(form, zero(columns), zero(rows)));
    let (plans, used, evidence) = (Vec::new(), Vec::new(), Vec::new());
    let mut parts = SavedParts { form, plans, used, evidence, none };
    for _ in 0..words.value::<usize>()? {
        let mut words = lines.words()?;
        words.expect("x")?;
        parts.plans.push(words.dense(columns)?);
        parts.used.push(None);
    }
    let mut words = lines.words()?;
    words.expect("evidence")?;
    for _ in 0..words.value::<usize>()? {
        let mut words = lines.words()?;
        let is_ray = words.word()? == "f";
        let z = if is_ray { Vec::new() } else { words.dense(columns)? };
        let y = words.dense(rows)?;
        let own = if is_ray { Evidence::ray(form, &y) } else { Evidence::bound(form, z, y) };
        parts.evidence.push(Arc::new(own));
    }
    let mut words = lines.words()?;
    words.expect("cells")?;
    let count: usize = words.value()?;
    let roots = orders(form.axes.len());
    let mut places: Vec<Vec<Vec<i64>>> = roots.iter().map(|order| kuhn(order)).collect();
    let mut cells = Vec::new();
    for number in 0..count {
        let Some(corners) = places.get(number).cloned() else {
            return Err(damaged(lines.number, "a cell is no half of a cell before it"));
        };
        let mut words = lines.words()?;
        let keyword = words.word()?.to_owned();
        cells.push(match &keyword[..] {
            "cut" => {
                let edge = [words.index(corners.len())?, words.index(corners.len())?];
                let middle = midpoint(&corners[edge[0]], &corners[edge[1]]);
                let Some(middle) = middle.filter(|_| edge[0] != edge[1]) else {
                    return Err(damaged(lines.number, "an edge has no middle"));
                };
                let next = [places.len(), places.len() + 1];
                for replaced in [edge[1], edge[0]] {
                    let mut half = corners.clone();
                    half[replaced].clone_from(&middle);
                    places.push(half);
                }
                PartitionCell::Cut { edge, next }
            }
            "plan" | "none" => parts.leaf(&keyword, &mut words, &mut lines, &corners)?,
            _ => PartitionCell::Open,
        });
    }
    if cells.len() != places.len() {
        return Err(damaged(lines.number, "a half of a cell is not there"));
    }
    Ok(Partition { cells, orders: roots.len(), depth: 0 })
}

impl SavedParts<'_> {
    /// A cell with a plan, or without, or an open one if something of it does not hold.
    fn leaf<R: BufRead>(
        &mut self,
        keyword: &str,
        words: &mut SavedWords,
        lines: &mut SavedLines<R>,
        corners: &[Vec<i64>],
    ) -> Result<PartitionCell, Error> {
        let (mut loss, mut plans) = (f64::INFINITY, Vec::new());
        if keyword == "plan" {
            loss = words.value()?;
            for corner in corners {
                let number = words.index(self.plans.len())?;
                plans.extend(self.plan(number, corner));
            }
        }
        let mut steps = Vec::new();
        for _ in 0..words.value::<usize>()? {
            let mut words = lines.words()?;
            let keyword = words.word()?.to_owned();
            if keyword == "s" {
                let (column, value) = (words.index(self.form.columns())?, words.value()?);
                steps.push(CellStep::Cut { column, value });
                continue;
            }
            let mut own = Vec::new();
            for _ in corners {
                own.push(Arc::clone(&self.evidence[words.index(self.evidence.len())?]));
            }
            let is_ray = keyword == "f";
            steps.push(if is_ray { CellStep::Refuted(own) } else { CellStep::Bound(own) });
        }
        let place = |units: &Vec<i64>| CornerPlace::new(self.form, self.form.state(units));
        let places: Vec<CornerPlace> = corners.iter().map(place).collect();
        let places: Vec<&CornerPlace> = places.iter().collect();
        if keyword == "none" {
            let is_proved = proves(self.form, &steps, &places, None);
            let proof = CellProof { steps, loss: 0.0 };
            return Ok(if is_proved { PartitionCell::NoPlan(proof) } else { PartitionCell::Open });
        }
        if plans.len() != corners.len() || !have_same_integers(self.form, &plans) {
            return Ok(PartitionCell::Open);
        }
        let cost = plans_cost(self.form, &plans);
        if !loss.is_finite() || !proves(self.form, &steps, &places, Some((&cost, loss))) {
            (loss, steps) = (f64::INFINITY, Vec::new());
        }
        let proof = CellProof { steps, loss };
        Ok(PartitionCell::Plan(CellLaw { plans, loss, allowed: 0.0, proof }))
    }

    /// The plan of a number at a corner; `None` if it is none there.
    fn plan(&mut self, number: usize, corner: &[i64]) -> Option<Arc<CornerRelaxation>> {
        if let Some((units, plan)) = &self.used[number] {
            return (units == corner).then(|| Arc::clone(plan));
        }
        let form = self.form;
        let mut x = self.plans[number].clone();
        form.axes.iter().zip(form.state(corner)).for_each(|(&j, t)| x[j] = t);
        let is_within = (0..form.columns()).filter(|j| !form.is_axis[*j]).all(|j| {
            let slack = if form.integral[j] { 0.0 } else { PLAN_TOLERANCE };
            let is_whole = !form.integral[j] || x[j] == x[j].round();
            is_whole && form.lower[j] - slack <= x[j] && x[j] <= form.upper[j] + slack
        });
        if !is_within || form.violation(&x) > PLAN_TOLERANCE {
            return None;
        }
        let cost = bounds::cost(form, &[&x])[0];
        let evidence = Arc::clone(&self.none);
        let plan = Arc::new(CornerRelaxation::Solved { x, cost, evidence });
        self.used[number] = Some((corner.to_vec(), Arc::clone(&plan)));
        Some(plan)
    }
}

fn have_same_integers(form: &ParametricForm, plans: &[Arc<CornerRelaxation>]) -> bool {
    let integers = |plan: &Arc<CornerRelaxation>| match &**plan {
        CornerRelaxation::Solved { x, .. } => {
            let own = x.iter().zip(&form.integral).filter(|(_, whole)| **whole);
            own.map(|(x, _)| *x).collect()
        }
        _ => Vec::new(),
    };
    plans.windows(2).all(|pair| integers(&pair[0]) == integers(&pair[1]))
}

/// Whether steps prove that there is no plan, or that one of this cost loses at most so much.
fn proves(
    form: &ParametricForm,
    steps: &[CellStep],
    places: &[&CornerPlace],
    claim: Option<(&Coefficients, f64)>,
) -> bool {
    let mut parts = vec![(form.lower.clone(), form.upper.clone())];
    for step in steps {
        let Some((lower, upper)) = parts.pop() else { return false };
        let sides = [&lower[..], &upper[..]];
        let holds = match step {
            &CellStep::Cut { column: j, value } => {
                let is_between = lower[j] <= value && value + 1.0 <= upper[j];
                let (mut below, mut above) = (upper.clone(), lower.clone());
                (below[j], above[j]) = (value, value + 1.0);
                parts.extend([(above, upper), (lower, below)]);
                form.integral[j] && value == value.round() && is_between
            }
            CellStep::Refuted(own) => {
                own.iter().all(|one| one.is_ray)
                    && bounds::bound(form, own, places, sides).iter().all(|x| *x > RAY_MARGIN)
            }
            CellStep::Bound(own) => claim.is_some_and(|(cost, loss)| {
                let bound = bounds::bound(form, own, places, sides);
                !own.iter().any(|one| one.is_ray) && largest_difference(cost, &bound) <= loss
            }),
        };
        if !holds {
            return false;
        }
    }
    parts.is_empty()
}
