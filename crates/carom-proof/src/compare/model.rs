//! A program as a file states it.

use super::polynomial::{Affine, Polynomial};
use crate::exact::Number;
use crate::program::{Column, Cone, Program};
use std::collections::{HashMap, HashSet};

/// A row as a file states it.
#[derive(Debug, Clone, Default)]
pub(super) struct Row {
    pub(super) name: String,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) entries: Vec<(u32, f64)>,
}

/// Products of two columns, with coefficients.
pub(super) type Products = Vec<(u32, u32, f64)>;

/// A row that holds if a binary has a value.
#[derive(Debug)]
pub(super) struct Indicator {
    pub(super) binary: u32,
    pub(super) value: f64,
    pub(super) row: Row,
}

/// A cone that is not one of single columns: all points have a polynomial of at least 0, and some
/// forms of at least 0.
#[derive(Debug, Clone)]
pub(super) struct StatedCone {
    /// In words.
    pub(super) what: String,
    pub(super) polynomial: Polynomial,
    pub(super) heads: Vec<Polynomial>,
}

/// A statement of a file that is no row.
#[derive(Debug)]
pub(super) enum Statement {
    Cone(StatedCone),
    Indicator(Indicator),
    /// Of the columns, so many neighbours are other than 0 at most.
    Set(Vec<u32>, u8),
    /// The column is 0 or within its bounds.
    Semicontinuous(u32),
}

impl StatedCone {
    /// The same with other numbers of columns.
    pub(super) fn renumbered(&self, at: &dyn Fn(u32) -> u32) -> Self {
        StatedCone {
            what: self.what.clone(),
            polynomial: self.polynomial.renumbered(at),
            heads: self.heads.iter().map(|head| head.renumbered(at)).collect(),
        }
    }
}

impl Statement {
    /// The columns that it mentions, perhaps several times.
    fn columns(&self) -> Vec<u32> {
        match self {
            Statement::Cone(own) => {
                own.heads.iter().chain([&own.polynomial]).flat_map(Polynomial::columns).collect()
            }
            Statement::Indicator(own) => {
                own.row.entries.iter().map(|entry| entry.0).chain([own.binary]).collect()
            }
            Statement::Set(members, _) => members.clone(),
            Statement::Semicontinuous(column) => vec![*column],
        }
    }

    fn renumber(&mut self, shift: &dyn Fn(&mut u32)) {
        match self {
            Statement::Cone(own) => {
                *own = own.renumbered(&|mut column| {
                    shift(&mut column);
                    column
                });
            }
            Statement::Indicator(own) => {
                own.row.entries.iter_mut().for_each(|entry| shift(&mut entry.0));
                shift(&mut own.binary);
            }
            Statement::Set(members, _) => members.iter_mut().for_each(shift),
            Statement::Semicontinuous(column) => shift(column),
        }
    }
}

/// Minimise or maximise `1/2 x'Px + linear x + constant` over columns with rows and cones.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub(super) is_maximisation: bool,
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<Row>,
    pub(super) cones: Vec<Cone>,
    pub(super) constant: f64,
    pub(super) linear: Vec<(u32, f64)>,
    /// Entries of `P` with row <= column.
    pub(super) triangle: Vec<(u32, u32, f64)>,
    pub(super) statements: Vec<Statement>,
    /// Statements that are not compared, in words.
    pub(super) left_out: Vec<String>,
    by_name: HashMap<String, u32>,
}

impl Model {
    /// The program of a log, with the objective in the sense of the model.
    pub(super) fn from_program(program: Program) -> Self {
        let mut model = Model { is_maximisation: program.is_maximisation, ..Model::default() };
        let sign = if program.is_maximisation { -1.0 } else { 1.0 };
        for (row, name) in program.rows.iter().zip(program.row_names) {
            let side = |side: &Option<crate::exact::Dyadic>| side.as_ref().map(|v| v.nearest());
            let entries = row.entries().filter_map(|(column, value)| match value {
                Number::Float(value) => Some((column, value)),
                // The numbers of a header are floats.
                Number::Exact(_) => None,
            });
            model.rows.push(Row {
                name,
                lower: side(&row.lower).unwrap_or(f64::NEG_INFINITY),
                upper: side(&row.upper).unwrap_or(f64::INFINITY),
                entries: entries.collect(),
            });
        }
        let objective = program.objective;
        model.constant = sign * objective.constant;
        model.linear = objective.linear.iter().map(|&(j, value)| (j, sign * value)).collect();
        model.triangle =
            objective.triangle.iter().map(|&(i, j, value)| (i, j, sign * value)).collect();
        model.cones = program.cones;
        for column in program.columns {
            model.add_column(column);
        }
        model
    }

    fn add_column(&mut self, column: Column) -> u32 {
        let index = self.columns.len() as u32;
        self.by_name.entry(column.name.clone()).or_insert(index);
        self.columns.push(column);
        index
    }

    /// The column of this name, which is a new one from 0 to infinity if there is none.
    pub(super) fn column(&mut self, name: &str) -> u32 {
        match self.by_name.get(name) {
            Some(&index) => index,
            None => self.add_column(Column {
                is_integral: false,
                lower: 0.0,
                upper: f64::INFINITY,
                name: name.to_string(),
            }),
        }
    }

    /// The column of this name.
    pub(super) fn find(&self, name: &str) -> Option<u32> {
        self.by_name.get(name).copied()
    }

    pub(super) fn column_mut(&mut self, index: u32) -> Option<&mut Column> {
        self.columns.get_mut(index as usize)
    }

    /// Notes a statement that is not compared.
    pub(super) fn leave_out(&mut self, statement: impl Into<String>) {
        self.left_out.push(statement.into());
    }

    /// The bounds of a column as they are stated.
    pub(super) fn bounds_of(&self, column: u32) -> (f64, f64) {
        let own = self.columns.get(column as usize);
        own.map_or((f64::NEG_INFINITY, f64::INFINITY), |own| (own.lower, own.upper))
    }

    /// The name of a column, for messages.
    pub(super) fn name_of(&self, column: u32) -> String {
        let named = self.columns.get(column as usize).map(|own| own.name.clone());
        named.filter(|name| name != "-").unwrap_or_else(|| column.to_string())
    }

    /// Adds an ordered set.
    pub(super) fn set(&mut self, members: Vec<u32>, most: u8) {
        self.leave_out("ordered sets");
        self.statements.push(Statement::Set(members, most));
    }

    /// Adds a row with products of columns.
    pub(super) fn squares(&mut self, row: Row, products: &[(u32, u32, f64)]) {
        let what = format!("the squares of row {}", row.name);
        let (limit, sign) = match (row.lower.is_finite(), row.upper.is_finite()) {
            (true, false) => (row.lower, -1.0),
            _ => (row.upper, 1.0),
        };
        let mut polynomial = Polynomial::default();
        products.iter().for_each(|&(i, j, value)| polynomial.add_square((i, j), -sign * value));
        if !polynomial.has_products() {
            self.rows.push(row);
            return;
        }
        if row.lower.is_finite() == row.upper.is_finite() {
            return self.leave_out(what);
        }
        polynomial.add_affine(-sign, &Affine { terms: row.entries, constant: -limit });
        self.statements.push(Statement::Cone(StatedCone { what, polynomial, heads: Vec::new() }));
    }

    /// Gives semi-continuous columns the bounds that include 0, as rows say the rest.
    pub(super) fn widen_semicontinuous(&mut self) {
        for statement in &self.statements {
            let Statement::Semicontinuous(column) = statement else { continue };
            if let Some(own) = self.columns.get_mut(*column as usize) {
                (own.lower, own.upper) = (own.lower.min(0.0), own.upper.max(0.0));
            }
        }
    }

    /// Adds an indicator; one whose binary is fixed is a row, or nothing.
    pub(super) fn indicator(&mut self, indicator: Indicator) {
        let Indicator { binary, value, mut row } = indicator;
        if self.bounds_of(binary) != (value, value) {
            if self.bounds_of(binary) != (1.0 - value, 1.0 - value) {
                self.statements.push(Statement::Indicator(Indicator { binary, value, row }));
            }
            return;
        }
        let own = row.entries.iter().filter(|entry| entry.0 == binary);
        let own: f64 = own.map(|entry| entry.1 * value).sum();
        row.entries.retain(|entry| entry.0 != binary);
        (row.lower, row.upper) = (row.lower - own, row.upper - own);
        self.rows.push(row);
    }

    /// A fixed column `Constant`, in the linear part of the objective alone and unknown to the log,
    /// is a constant: this is how LP files say it.
    pub(super) fn fold_constants(&mut self, log: &Model) {
        let Some(index) = self.find("Constant").filter(|_| log.find("Constant").is_none()) else {
            return;
        };
        let Some(&Column { lower, upper, .. }) = self.columns.get(index as usize) else { return };
        let is_used = self.rows.iter().any(|row| row.entries.iter().any(|e| e.0 == index))
            || self.triangle.iter().any(|entry| entry.0 == index || entry.1 == index)
            || self.cones.iter().any(|cone| is_in(cone, index))
            || self.statements.iter().any(|statement| statement.columns().contains(&index));
        if lower == upper && !is_used {
            let costs = self.linear.iter().filter(|entry| entry.0 == index);
            self.constant += costs.map(|entry| entry.1).sum::<f64>() * lower;
            self.remove(&HashSet::from([index]));
        }
    }

    /// Leaves the parts of cones out: columns `part` of no cost, in `part times >= entry^2` and
    /// `sum of parts <= head` alone. They say nothing but that there is a cone with this head,
    /// `times` (the head again if it is a norm) and these entries, if that cone is there:
    /// `part = entry^2 / times`.
    pub(super) fn fold_parts(&mut self) {
        let mut uses = vec![0_usize; self.columns.len()];
        let mut count =
            |column: u32| uses.get_mut(column as usize).into_iter().for_each(|u| *u += 1);
        self.rows.iter().flat_map(|row| &row.entries).for_each(|entry| count(entry.0));
        self.linear.iter().for_each(|entry| count(entry.0));
        self.triangle.iter().for_each(|entry| [entry.0, entry.1].into_iter().for_each(&mut count));
        for cone in &self.cones {
            cone.tail.iter().chain([&cone.head]).chain(&cone.second).for_each(|&j| count(j));
        }
        // The cone of each part.
        let mut parts: HashMap<u32, (u32, u32)> = HashMap::new();
        for cone in &self.cones {
            let Some(column) = self.columns.get(cone.head as usize) else { continue };
            let is_free =
                (column.is_integral, column.lower, column.upper) == (false, 0.0, f64::INFINITY);
            if let (Some(times), [entry]) = (cone.second, &cone.tail[..])
                && uses.get(cone.head as usize) == Some(&2)
                && is_free
            {
                parts.insert(cone.head, (times, *entry));
            }
        }
        let mut folded: HashSet<u32> = HashSet::new();
        self.rows.retain(|row| {
            let mut tail = Vec::new();
            let (mut head, mut times) = (None, None);
            for &(column, value) in &row.entries {
                match parts.get(&column) {
                    Some(&(own, entry)) if value == 1.0 && *times.get_or_insert(own) == own => {
                        tail.push(entry);
                    }
                    None if value == -1.0 && head.is_none() => head = Some(column),
                    _ => return true,
                }
            }
            let (Some(head), Some(times)) = (head, times) else { return true };
            tail.sort_unstable();
            let is_whole = |cone: &Cone| {
                let mut own = cone.tail.clone();
                own.sort_unstable();
                cone.head == head && cone.second.unwrap_or(head) == times && own == tail
            };
            let is_sum = (row.lower, row.upper) == (f64::NEG_INFINITY, 0.0);
            if !is_sum || !self.cones.iter().any(is_whole) {
                return true;
            }
            folded.extend(row.entries.iter().map(|entry| entry.0).filter(|&j| j != head));
            false
        });
        self.cones.retain(|cone| !folded.contains(&cone.head));
        self.remove(&folded);
    }

    /// Removes columns that nothing mentions.
    fn remove(&mut self, removed: &HashSet<u32>) {
        let mut places = Vec::new();
        let mut next = 0;
        for index in 0..self.columns.len() as u32 {
            places.push(next);
            next += u32::from(!removed.contains(&index));
        }
        let shift = |j: &mut u32| *j = places.get(*j as usize).copied().unwrap_or(u32::MAX);
        let mut index = 0..;
        self.columns.retain(|_| index.next().is_none_or(|j| !removed.contains(&j)));
        self.by_name.retain(|_, j| !removed.contains(j));
        self.by_name.values_mut().for_each(shift);
        self.linear.retain(|entry| !removed.contains(&entry.0));
        self.linear.iter_mut().for_each(|entry| shift(&mut entry.0));
        self.rows.iter_mut().flat_map(|row| &mut row.entries).for_each(|e| shift(&mut e.0));
        self.statements.iter_mut().for_each(|statement| statement.renumber(&shift));
        for entry in &mut self.triangle {
            shift(&mut entry.0);
            shift(&mut entry.1);
        }
        for cone in &mut self.cones {
            shift(&mut cone.head);
            cone.tail.iter_mut().chain(&mut cone.second).for_each(shift);
        }
    }

    /// Where each column is in the log: by name if all names are there, else by order.
    pub(super) fn order_in(&self, log: &Model) -> Vec<u32> {
        let by_name: Option<Vec<u32>> =
            self.columns.iter().map(|column| log.find(&column.name)).collect();
        let mut sorted = by_name.clone().unwrap_or_default();
        sorted.sort_unstable();
        sorted.dedup();
        match by_name {
            Some(order) if sorted.len() == order.len() => order,
            _ => (0..).take(self.columns.len()).collect(),
        }
    }
}

fn is_in(cone: &Cone, column: u32) -> bool {
    cone.head == column || cone.second == Some(column) || cone.tail.contains(&column)
}
