//! The order of binaries in time, from the rows alone.
//!
//! The rows of a horizon link the columns of one step with those of the next, so the graph of
//! columns that share a row is long and thin, and the distance from one of its ends is the step.
//! Names and the order of columns do not matter.

use crate::program::Program;

/// Rows with more columns than this link everything with everything (budgets, sums over time) and
/// say nothing about the order.
const LONG_ROW: usize = 16;

/// Fewest steps of a chain.
const STEPS: usize = 8;

/// Binaries of one step at most, as a share of all: a graph that is as wide as it is long is none.
const WIDEST: usize = 4;

/// The binaries of a program in the order of time, where its rows are a chain. Which end is the
/// late one is decided by the order of the columns.
pub fn in_time(program: &Program) -> Option<Vec<usize>> {
    let binary = |&j: &usize| program.lower[j] >= 0.0 && program.upper[j] <= 1.0;
    let mut binaries: Vec<usize> = program.integers.iter().copied().filter(binary).collect();
    let &first = binaries.first()?;
    // The farthest from anywhere is an end; the farthest from there is the other one.
    let end = farthest(&distances(program, first))?;
    let distance = distances(program, end);
    let mut steps: Vec<usize> = Vec::with_capacity(binaries.len());
    for &j in &binaries {
        steps.push(distance[j]?);
    }
    let rising = steps.windows(2).filter(|pair| pair[0] < pair[1]).count();
    let falling = steps.windows(2).filter(|pair| pair[0] > pair[1]).count();
    let step = |j: &usize| distance[*j].unwrap_or(0);
    binaries.sort_by_key(|j| (step(j), *j));
    let (mut count, mut widest, mut wide) = (0, 0, 0);
    for (k, j) in binaries.iter().enumerate() {
        let same = k > 0 && step(&binaries[k - 1]) == step(j);
        (count, wide) = if same { (count, wide + 1) } else { (count + 1, 1) };
        widest = widest.max(wide);
    }
    if falling > rising {
        binaries.reverse();
    }
    (count >= STEPS && WIDEST * widest <= binaries.len()).then_some(binaries)
}

/// Distances of all columns from one, in shared rows; `None` for those that are not linked.
fn distances(program: &Program, start: usize) -> Vec<Option<usize>> {
    let mut distance = vec![None; program.column_count()];
    let mut seen = vec![false; program.row_count()];
    let mut queue = std::collections::VecDeque::from([start]);
    distance[start] = Some(0);
    while let Some(j) = queue.pop_front() {
        let next = distance[j].map(|d| d + 1);
        for &row in program.column(j).0 {
            let columns = program.row(row).0;
            if std::mem::replace(&mut seen[row], true) || columns.len() > LONG_ROW {
                continue;
            }
            for &k in columns.iter().filter(|&&k| distance[k].is_none()).collect::<Vec<_>>() {
                distance[k] = next;
                queue.push_back(k);
            }
        }
    }
    distance
}

fn farthest(distance: &[Option<usize>]) -> Option<usize> {
    (0..distance.len()).filter(|&j| distance[j].is_some()).max_by_key(|&j| (distance[j], j))
}
