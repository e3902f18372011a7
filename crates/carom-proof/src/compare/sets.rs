//! Rows that ordered sets and semi-continuous columns have become.

use super::further::{Further, ROUNDING};
use super::model::{Row, Statement};
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// A row that links a column to binaries.
type Link<'r> = (&'r Row, u32, BTreeSet<u32>);

impl Further<'_> {
    /// Checks the rows of ordered sets and semi-continuous columns: that for any values of the
    /// columns that the statements allow there are binaries with which the rows hold.
    pub(super) fn check_sets(&self, rows: &[Row]) -> Result<(), String> {
        let only = |row: &Row| format!("row {} is only in the log", row.name);
        let values = self.values();
        // Each row that links a column to binaries; and the sums of binaries.
        let (mut links, mut sums): (Vec<Link<'_>>, Vec<&Row>) = Default::default();
        for row in rows {
            let (known, binaries): (Vec<_>, Vec<_>) =
                row.entries.iter().copied().partition(|entry| self.is_known(entry.0));
            if !binaries.iter().all(|entry| self.is_binary(entry.0)) {
                return Err(only(row));
            }
            match known[..] {
                [own] if !is_sum(row) && !binaries.is_empty() => {
                    let range = values.get(&own.0).copied();
                    if !range.is_some_and(|range| allows(row, own, range, &binaries)) {
                        return Err(only(row));
                    }
                    links.push((row, own.0, binaries.iter().map(|entry| entry.0).collect()));
                }
                _ => sums.push(row),
            }
        }
        let mut pairs: BTreeSet<u32> = BTreeSet::new();
        for row in sums.iter().filter(|row| row.lower == 1.0) {
            if !is_sum(row) || !self.are_pairs(row, &links) {
                return Err(only(row));
            }
            pairs.extend(row.entries.iter().map(|entry| entry.0));
        }
        // Other binaries are 1 where their columns are not 0.
        let single = |link: &&Link<'_>| link.2.is_disjoint(&pairs);
        if let Some(link) = links.iter().filter(single).find(|link| link.2.len() != 1) {
            return Err(only(link.0));
        }
        let mut linked: BTreeMap<u32, BTreeSet<u32>> = BTreeMap::new();
        for (_, column, binaries) in links.iter().filter(single) {
            for &binary in binaries {
                linked.entry(binary).or_default().insert(*column);
            }
        }
        let is_of_set =
            |row: &&&Row| row.lower == 1.0 || (is_sum(row) && self.is_of_set(row, &linked));
        match sums.iter().find(|row| !is_of_set(row)) {
            Some(row) => Err(only(row)),
            None => Ok(()),
        }
    }

    /// By column of the log, the values besides 0 that an ordered set or being semi-continuous
    /// leaves it.
    fn values(&self) -> HashMap<u32, (f64, f64)> {
        let mut values: HashMap<u32, (f64, f64)> = HashMap::new();
        for statement in &self.model.statements {
            match statement {
                Statement::Set(members, _) => members.iter().for_each(|&column| {
                    values.insert(self.at(column), self.model.bounds_of(column));
                }),
                Statement::Semicontinuous(column) => {
                    values.insert(self.at(*column), self.model.bounds_of(*column));
                }
                _ => {}
            }
        }
        values
    }

    fn is_binary(&self, column: u32) -> bool {
        let own = self.log.columns.get(column as usize);
        own.is_some_and(|own| own.limits() == (true, 0.0, 1.0))
    }

    /// Whether a sum of binaries, each that of a column, is at most 1 because of a set.
    fn is_of_set(&self, row: &Row, linked: &BTreeMap<u32, BTreeSet<u32>>) -> bool {
        self.model.statements.iter().any(|statement| {
            let Statement::Set(members, 1) = statement else { return false };
            let own: BTreeSet<u32> = members.iter().map(|&column| self.at(column)).collect();
            let is_inside = |column: u32| match self.is_known(column) {
                true => self.is_binary(column) && own.contains(&column),
                false => linked.get(&column).is_some_and(|of| of.len() == 1 && of.is_subset(&own)),
            };
            row.entries.iter().all(|entry| is_inside(entry.0))
        })
    }

    /// Whether the binaries of a sum are the pairs of neighbours of a set, and link each member to
    /// its own pairs.
    fn are_pairs(&self, row: &Row, links: &[Link<'_>]) -> bool {
        let pairs: Vec<u32> = row.entries.iter().map(|entry| entry.0).collect();
        let all: BTreeSet<u32> = pairs.iter().copied().collect();
        self.model.statements.iter().any(|statement| {
            let Statement::Set(members, 2) = statement else { return false };
            let is_fit = |(_, column, binaries): &Link<'_>| {
                let Some(k) = members.iter().position(|&member| self.at(member) == *column) else {
                    return false;
                };
                let near = pairs.get(k.saturating_sub(1)..pairs.len().min(k + 1));
                *binaries == near.into_iter().flatten().copied().collect()
            };
            let mut touching = links.iter().filter(|link| !link.2.is_disjoint(&all));
            pairs.len() + 1 == members.len()
                && pairs.iter().all(|&pair| !self.is_known(pair))
                && touching.all(is_fit)
        })
    }
}

/// Whether a row lets a column be 0 while binaries are 0, and have any value of a range while one
/// of them is 1.
fn allows(
    row: &Row,
    (_, factor): (u32, f64),
    (lower, upper): (f64, f64),
    binaries: &[(u32, f64)],
) -> bool {
    [(1.0, row.upper), (-1.0, -row.lower)].into_iter().all(|(sign, limit)| {
        let holds = |binary: f64, value: f64| {
            let (term, one) = (sign * factor * value, sign * binary);
            term + one <= limit + ROUNDING * (term.abs() + one.abs() + limit.abs())
        };
        let at_one = |binary: &(u32, f64)| holds(binary.1, lower) && holds(binary.1, upper);
        limit == f64::INFINITY || (limit >= 0.0 && binaries.iter().all(at_one))
    })
}

/// Whether a row is a sum that is at most 1, or that is 1.
fn is_sum(row: &Row) -> bool {
    let is_limited = row.upper == 1.0 && (row.lower <= 0.0 || row.lower == 1.0);
    is_limited && row.entries.iter().all(|entry| entry.1 == 1.0)
}
