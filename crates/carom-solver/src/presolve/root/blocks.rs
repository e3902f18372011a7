//! Independent blocks: parts of a program that no row, no product and no cone links.
//!
//! Takes a program; leaves one program for each part with integers, and one for everything else
//! (Gamrath, Koch, Martin, Miltenberger and Weninger, Progress in presolving for mixed integer
//! programming, Mathematical Programming Computation 7, 2015).
//!
//! Examples are two vehicles without a common row, or decoupled axes. The tree of the whole is the
//! product of the trees of its blocks; searching them one after the other makes it their sum.

use std::sync::OnceLock;

use faer::sparse::{SparseColMat, SparseRowMat, Triplet};

use crate::program::Program;
use crate::union_find::UnionFind;

/// A part of a program, with an offset of 0.
#[derive(Debug, Clone)]
pub struct ProgramBlock {
    /// The program's column of each of its columns.
    pub columns: Vec<usize>,
    /// Its rows and its share of the objective.
    pub program: Program,
}

impl ProgramBlock {
    /// Writes values of the block's columns into a point of the program.
    pub(crate) fn scatter(&self, values: &[f64], point: &mut [f64]) {
        self.columns.iter().zip(values).for_each(|(&j, &value)| point[j] = value);
    }
}

/// The blocks of a program, those with the fewest integers first; empty if it is a single one.
///
/// Everything without integers is one block. Rows without columns, which may be false, belong to
/// the first block.
pub fn blocks(program: &Program) -> Vec<ProgramBlock> {
    let n = program.column_count();
    let mut parts = UnionFind::new(n);
    for row in 0..program.row_count() {
        let columns = program.row(row).0;
        columns.windows(2).for_each(|pair| parts.join(pair[0], pair[1]));
    }
    for j in 0..n {
        program.quadratic_column(j).0.iter().for_each(|&i| parts.join(i, j));
    }
    for cone in &program.cones {
        cone.columns.windows(2).for_each(|pair| parts.join(pair[0], pair[1]));
    }
    for j in 0..n {
        let is_alone = program.column(j).0.is_empty() && !program.is_in_cone(j);
        if program.lower[j] == program.upper[j] && is_alone {
            parts.join(0, j);
        }
    }
    // Parts without integers are joined with the first of them.
    let mut has_integers = vec![false; n];
    program.integers.iter().for_each(|&j| has_integers[parts.root(j)] = true);
    let mut first = None;
    for j in 0..n {
        let root = parts.root(j);
        if !has_integers[root] {
            parts.join(*first.get_or_insert(root), root);
        }
    }
    let (mut number, mut columns) = (vec![usize::MAX; n], Vec::<Vec<usize>>::new());
    let mut block_of = vec![0; n];
    for (j, block_of) in block_of.iter_mut().enumerate() {
        let root = parts.root(j);
        if number[root] == usize::MAX {
            number[root] = columns.len();
            columns.push(Vec::new());
        }
        *block_of = number[root];
        columns[number[root]].push(j);
    }
    if columns.len() < 2 {
        return Vec::new();
    }
    let mut rows = vec![Vec::new(); columns.len()];
    for row in 0..program.row_count() {
        rows[program.row(row).0.first().map_or(0, |&j| block_of[j])].push(row);
    }
    let mut cones = vec![Vec::new(); columns.len()];
    for (k, cone) in program.cones.iter().enumerate() {
        cones[cone.columns.first().map_or(0, |&j| block_of[j])].push(k);
    }
    let mut position = vec![0; n];
    columns.iter().for_each(|c| c.iter().enumerate().for_each(|(k, &j)| position[j] = k));
    let parts = columns.into_iter().zip(rows).zip(cones);
    let mut blocks: Vec<ProgramBlock> = Vec::new();
    for ((columns, rows), cones) in parts {
        match extract(program, columns, [&rows, &cones], &position) {
            Some(block) => blocks.push(block),
            None => return Vec::new(),
        }
    }
    blocks.sort_by_key(|block| (block.program.integers.len(), block.columns[0]));
    blocks
}

fn pick_widened(from: &[f64], which: &[usize]) -> Vec<f64> {
    which.iter().filter_map(|&k| from.get(k).copied()).collect()
}

/// The part of a program over some columns and all of their rows and cones; `position` tells where
/// a column is in its block. `None` if the matrices cannot be allocated.
fn extract(
    program: &Program,
    columns: Vec<usize>,
    [rows, cones]: [&[usize]; 2],
    position: &[usize],
) -> Option<ProgramBlock> {
    let (m, n) = (rows.len(), columns.len());
    let (mut entries, mut products) = (Vec::new(), Vec::new());
    for (k, &row) in rows.iter().enumerate() {
        let (inside, values) = program.row(row);
        entries.extend(inside.iter().zip(values).map(|(&j, &a)| Triplet::new(k, position[j], a)));
    }
    for (k, &j) in columns.iter().enumerate() {
        let (inside, values) = program.quadratic_column(j);
        products.extend(inside.iter().zip(values).map(|(&i, &p)| Triplet::new(position[i], k, p)));
    }
    let pick = |from: &[f64], which: &[usize]| which.iter().map(|&k| from[k]).collect();
    let cones = cones.iter().map(|&k| program.cones[k].renumbered(|j| position[j])).collect();
    let integral: Vec<bool> = columns.iter().map(|&j| program.integral[j]).collect();
    let program = Program {
        quadratic: SparseColMat::try_new_from_triplets(n, n, &products).ok()?,
        linear: pick(&program.linear, &columns),
        offset: 0.0,
        constant: 0.0,
        sign: program.sign,
        rows: SparseRowMat::try_new_from_triplets(m, n, &entries).ok()?,
        columns: SparseColMat::try_new_from_triplets(m, n, &entries).ok()?,
        row_lower: pick(&program.row_lower, rows),
        row_upper: pick(&program.row_upper, rows),
        lower: pick(&program.lower, &columns),
        upper: pick(&program.upper, &columns),
        integers: (0..n).filter(|&k| integral[k]).collect(),
        integral,
        cones,
        conic: OnceLock::new(),
        cone_cuts: program.cone_cuts.clone(),
        step: columns.iter().map(|&j| program.step[j]).collect(),
        spread: program.spread,
        steepness: OnceLock::new(),
        squared: OnceLock::new(),
        widened: [
            pick_widened(&program.widened[0], rows),
            pick_widened(&program.widened[1], &columns),
        ],
    };
    Some(ProgramBlock { columns, program })
}
