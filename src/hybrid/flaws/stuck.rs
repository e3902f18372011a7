//! States from which every way out leads out of the domain, whatever the inputs.
//!
//! A move takes one transition of every choice. The states from which a move can end in the domain
//! are a polyhedron: the inputs are eliminated from its conditions (Fourier and Motzkin). A state
//! outside all of these polyhedra, at which some move is possible, is stuck.

use super::piece::{AffineMap, Facet, Piece, combined, common};
use super::programs::{Found, gap, is_empty_at};
use super::{Flaw, Search, Step};
use crate::error::Error;
use crate::hybrid::system::HybridSystem;

/// The most moves, and the most half-spaces of a projection, that are looked at.
const MOST_MOVES: usize = 64;
const MOST_FACETS: usize = 400;

/// A step of all choices: the positions of their transitions, and what it means.
struct Move {
    taken: Vec<usize>,
    /// The modes in which it begins, in choices with memory.
    modes: Vec<(String, String)>,
    /// Its conditions, over states and inputs.
    piece: Piece,
    /// The conditions, and that the next state lies in the domain.
    inside: Piece,
}

impl Search<'_> {
    /// Reports, for each combination of modes, a state from which no move stays in the domain.
    pub(super) fn stuck(&mut self, step: &Step) -> Result<(), Error> {
        let system = self.system;
        if system.choices.iter().any(|choice| choice.may_end) {
            return Ok(());
        }
        let Some(moves) = moves(system, step) else { return Ok(()) };
        let mut combinations: Vec<&Vec<(String, String)>> =
            moves.iter().map(|m| &m.modes).collect();
        combinations.dedup();
        for (k, modes) in combinations.iter().enumerate() {
            let key = format!("{modes:?}");
            if combinations[..k].contains(modes) || !self.is_new("stuck", &key, "") {
                continue;
            }
            let own: Vec<&Move> = moves.iter().filter(|m| m.modes == **modes).collect();
            if let Some(Found { point, margin }) = self.stuck_among(step, &own)? {
                let mut witness = self.witness(step, &point);
                witness.input.clear();
                let flaw = Flaw::Stuck { modes: modes.to_vec(), witness, margin };
                self.report("stuck", &key, "", flaw);
            }
        }
        Ok(())
    }

    /// A state at which one of the moves is possible, but none stays in the domain.
    fn stuck_among(&mut self, step: &Step, moves: &[&Move]) -> Result<Option<Found>, Error> {
        let n = self.system.states.len();
        let project = |piece: &Piece| projected(&joined(&[piece, &step.base]), n, step.size());
        let inside: Option<Vec<Piece>> = moves.iter().map(|m| project(&m.inside)).collect();
        let Some(inside) = inside else { return Ok(None) };
        let inside: Vec<&Piece> = inside.iter().collect();
        for own in moves {
            let possible = project(&own.piece).filter(|_| !self.is_reported(step, own));
            let Some(possible) = possible else { continue };
            let Some(mut found) = gap(&possible, &inside, step.size(), self.solver)? else {
                continue;
            };
            // By programs over the inputs, in case that the elimination lost too much by rounding.
            let mut is_stuck = true;
            for other in moves {
                let piece = joined(&[&other.inside, &step.base]);
                is_stuck &= is_empty_at(&piece, &found.point[..n], step.size(), self.solver)?;
            }
            let piece = joined(&[&own.piece, &step.base]);
            if is_stuck && !is_empty_at(&piece, &found.point[..n], step.size(), self.solver)? {
                found.point.truncate(n);
                found.point.resize(step.size(), 0.0);
                return Ok(Some(found));
            }
        }
        Ok(None)
    }

    /// Whether a move of a single choice has been looked at: no input acts on it, or its reset leads
    /// out of the domain.
    fn is_reported(&self, step: &Step, own: &Move) -> bool {
        let ([choice], [j]) = (&self.system.choices[..], &own.taken[..]) else { return false };
        let n = self.system.states.len();
        let acts = |map: &AffineMap| map.factors[n..].iter().any(|&factor| factor != 0.0);
        let leaves = |i| !self.is_new("leaves", &choice.name, &format!("{j}, {i}"));
        !step.next[0][*j].iter().any(acts) || (0..n).any(leaves)
    }
}

/// All moves; `None` if there are too many.
fn moves(system: &HybridSystem, step: &Step) -> Option<Vec<Move>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for choice in &system.choices {
        let count = choice.transitions.len();
        if all.len() * count > MOST_MOVES {
            return None;
        }
        let longer = |taken: &Vec<usize>| -> Vec<Vec<usize>> {
            (0..count).map(|j| [&taken[..], &[j]].concat()).collect()
        };
        all = all.iter().flat_map(longer).collect();
    }
    let common = common(system);
    let of = |taken: Vec<usize>| {
        let chosen = || system.choices.iter().zip(&taken).enumerate();
        let pieces: Vec<&Piece> = chosen().map(|(c, (_, &j))| &step.pieces[c][j]).collect();
        let piece = joined(&pieces);
        let mut inside = piece.clone();
        for (i, (_, domain)) in system.states.iter().enumerate() {
            let maps: Vec<AffineMap> =
                chosen().map(|(c, (_, &j))| step.next[c][j][i].clone()).collect();
            let mut next = combined(&vec![1.0; maps.len()], &maps, 0.0);
            if let Some(common) = common.as_ref().filter(|_| maps.len() > 1) {
                let extra = 1.0 - maps.len() as f64;
                next = combined(&[1.0, extra], &[next, common[i].clone()], 0.0);
            }
            for (sign, end) in [(1.0, domain.upper), (-1.0, -domain.lower)] {
                let factors = next.factors.iter().map(|factor| sign * factor).collect();
                let map = AffineMap { factors, constant: sign * next.constant };
                inside.cut(&step.units, &map, end, false);
            }
        }
        let modes = chosen().filter_map(|(_, (choice, &j))| {
            let (from, _) = choice.transitions[j].modes.as_ref()?;
            Some((choice.name.clone(), from.clone()))
        });
        Move { modes: modes.collect(), taken: taken.clone(), piece, inside }
    };
    Some(all.into_iter().map(of).collect())
}

/// The intersection of pieces, without limits for the planner.
fn joined(pieces: &[&Piece]) -> Piece {
    let mut all = Piece::default();
    for piece in pieces {
        all.add(piece);
    }
    all
}

/// The points of the first `n` coordinates that some others in the unit box complete to a point of
/// the piece; `None` if that takes too many half-spaces.
fn projected(piece: &Piece, n: usize, size: usize) -> Option<Piece> {
    if piece.is_empty(false) {
        return Some(piece.clone());
    }
    let mut rows: Vec<(Vec<f64>, f64)> =
        piece.facets(false).map(|facet| (facet.normal.clone(), facet.limit)).collect();
    for k in (n..size).rev() {
        let unit = |sign: f64| (0..size).map(|j| if j == k { sign } else { 0.0 }).collect();
        rows.extend([(unit(1.0), 1.0), (unit(-1.0), 0.0)]);
        let (with, mut left): (Vec<_>, Vec<_>) =
            rows.into_iter().partition(|(normal, _)| normal[k].abs() > 1e-12);
        let (above, below): (Vec<_>, Vec<_>) =
            with.into_iter().partition(|(normal, _)| normal[k] > 0.0);
        for (a, b) in above.iter().flat_map(|a| below.iter().map(move |b| (a, b))) {
            let (s, t) = (1.0 / a.0[k], -1.0 / b.0[k]);
            let mut normal: Vec<f64> = a.0.iter().zip(&b.0).map(|(a, b)| s * a + t * b).collect();
            normal[k] = 0.0;
            left.push((normal, s * a.1 + t * b.1));
        }
        rows = pruned(left);
        if rows.len() > MOST_FACETS {
            return None;
        }
    }
    let mut all = Piece::default();
    for (normal, limit) in rows {
        all.add_facet(Facet { normal, limit, is_limit: false });
    }
    Some(all)
}

/// The rows with normals of length 1, without those that hold in the whole unit box and those that
/// are there twice.
fn pruned(rows: Vec<(Vec<f64>, f64)>) -> Vec<(Vec<f64>, f64)> {
    let mut kept: Vec<(Vec<f64>, f64)> = Vec::new();
    for (mut normal, mut limit) in rows {
        let length = normal.iter().map(|a| a * a).sum::<f64>().sqrt();
        if length > 1e-12 {
            normal.iter_mut().for_each(|a| *a /= length);
            limit /= length;
        } else if limit >= -1e-9 {
            continue;
        }
        if normal.iter().map(|a| a.max(0.0)).sum::<f64>() <= limit {
            continue;
        }
        let same = |(own, _): &&mut (Vec<f64>, f64)| {
            own.iter().zip(&normal).all(|(a, b)| (a - b).abs() <= 1e-12)
        };
        match kept.iter_mut().find(same) {
            Some((_, own)) => *own = own.min(limit),
            None => kept.push((normal, limit)),
        }
    }
    kept
}
