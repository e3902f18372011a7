//! A program as a file states it.

use crate::exact::Number;
use crate::program::{Column, Cone, Program};
use std::collections::HashMap;

/// A row as a file states it.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) name: String,
    pub(super) lower: f64,
    pub(super) upper: f64,
    pub(super) entries: Vec<(u32, f64)>,
}

/// Minimise or maximise `1/2 x'Px + linear x + constant` over columns with rows and cones.
#[derive(Debug, Default)]
pub(super) struct Model {
    pub(super) is_maximisation: bool,
    pub(super) columns: Vec<Column>,
    /// Of each column, whether its bounds are not compared.
    pub(super) unequal_columns: Vec<bool>,
    pub(super) rows: Vec<Row>,
    pub(super) cones: Vec<Cone>,
    pub(super) constant: f64,
    pub(super) linear: Vec<(u32, f64)>,
    /// Entries of `P` with row <= column.
    pub(super) triangle: Vec<(u32, u32, f64)>,
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
        self.unequal_columns.push(false);
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

    /// Notes a statement of this kind, with one column or none whose bounds are not compared.
    pub(super) fn leave_out(&mut self, statement: impl Into<String>, column: Option<u32>) {
        self.left_out.push(statement.into());
        if let Some(skipped) = column.and_then(|j| self.unequal_columns.get_mut(j as usize)) {
            *skipped = true;
        }
    }

    /// A fixed column `Constant`, in the linear part of the objective alone and unknown to the log, is
    /// a constant: this is how LP files say it.
    pub(super) fn fold_constants(&mut self, log: &Model) {
        let Some(index) = self.find("Constant").filter(|_| log.find("Constant").is_none()) else {
            return;
        };
        let Some(&Column { lower, upper, .. }) = self.columns.get(index as usize) else { return };
        let is_used = self.rows.iter().any(|row| row.entries.iter().any(|e| e.0 == index))
            || self.triangle.iter().any(|entry| entry.0 == index || entry.1 == index)
            || self.cones.iter().any(|cone| cone.head == index || cone.tail.contains(&index));
        if lower == upper && !is_used {
            let costs = self.linear.iter().filter(|entry| entry.0 == index);
            self.constant += costs.map(|entry| entry.1).sum::<f64>() * lower;
            self.remove(index);
        }
    }

    fn remove(&mut self, index: u32) {
        let shift = |j: &mut u32| *j -= u32::from(*j > index);
        self.columns.remove(index as usize);
        self.unequal_columns.remove(index as usize);
        self.linear.retain(|entry| entry.0 != index);
        self.linear.iter_mut().for_each(|entry| shift(&mut entry.0));
        self.rows.iter_mut().flat_map(|row| &mut row.entries).for_each(|e| shift(&mut e.0));
        for entry in &mut self.triangle {
            shift(&mut entry.0);
            shift(&mut entry.1);
        }
        for cone in &mut self.cones {
            shift(&mut cone.head);
            cone.tail.iter_mut().for_each(shift);
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
