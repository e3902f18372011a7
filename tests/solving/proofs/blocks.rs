//! Proofs of programs of independent blocks: one lemma for each.

use carom::model::Model;
use carom::prelude::*;
use carom_proof::check;

use super::{file, is_proved};

/// Pseudo-random numbers.
struct Numbers(u64);

impl Numbers {
    /// A whole number below `most`.
    fn below(&mut self, most: u64) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) % most) as f64
    }
}

/// A random program of blocks; with `is_linked`, a fixed column and a row that cannot fail are in
/// all of them.
fn blocks(numbers: &mut Numbers, is_linked: bool, has_point: bool) -> Result<Model, Error> {
    let mut model = Model::new("blocks");
    let count = 2 + numbers.below(3) as usize;
    let one = model.continuous("one", 1.0, 1.0)?;
    let mut cost = Affine::from(numbers.below(20) - 10.0);
    let mut all = Affine::from(0.0);
    let is_whole = numbers.below(2) < 1.0;
    for block in 0..count {
        let (mut integers, mut form) = (Vec::new(), Affine::from(0.0));
        for k in 0..2 + numbers.below(3) as usize {
            let n = model.integer(format!("n[{block}][{k}]"), 0.0, 4.0 + numbers.below(5))?;
            form += n * (2.0 + numbers.below(7));
            cost += n * (1.0 + numbers.below(9) * if is_whole { 1.0 } else { 0.37 });
            integers.push(n);
        }
        let x = model.continuous(format!("x[{block}]"), 0.0, 6.0)?;
        if !is_whole {
            cost += x * (0.5 + 0.25 * numbers.below(9));
        }
        let least = 5.0 + numbers.below(30) * 0.5;
        let shift = if is_linked { one * 0.75 } else { Affine::from(0.75) };
        model.add(format!("row[{block}]"), (form + x * 0.3 - shift).ge(least))?;
        for n in integers {
            all += n * 1.0;
        }
        if !has_point && block == 1 {
            let [a, b] =
                [("a", 9.0), ("b", 7.0)].map(|(name, most)| model.integer(name, 0.0, most));
            let (a, b) = (a?, b?);
            model.add("parity", (a * 6.0 + b * 10.0).within(30.5, 31.5))?;
            cost += a * 1.0;
        }
    }
    if is_linked {
        model.add("all", all.le(1000.0))?;
    }
    model.minimize(cost)?;
    Ok(model)
}

/// Random programs of blocks: each log is complete, and the answer is that of a solve of the whole.
#[test]
fn blocks_are_proved_one_by_one() -> Result<(), Error> {
    let mut numbers = Numbers(11);
    let mut split = 0;
    for case in 0..60 {
        let (is_linked, has_point) = (case % 2 == 1, case % 5 != 0);
        let model = blocks(&mut numbers, is_linked, has_point)?;
        let solution = is_proved(&model, &format!("blocks_{case}"));
        let whole = BranchAndBound::new(Options::default().with_blocks(false)).solve(&model)?;
        assert_eq!(solution.is_infeasible(), !has_point, "{case}");
        let value = |solution: &Solution| solution.objective().unwrap_or(0.0);
        let size = value(&whole).abs().max(1.0);
        assert!((value(&solution) - value(&whole)).abs() <= 1e-5 * size, "{case}");
        split += u32::from(solution.statistics().blocks > 1);
    }
    assert!(split > 30, "{split}");
    Ok(())
}

/// A false lemma of a block is rejected, although the others and their sum are right.
#[test]
fn a_false_lemma_of_a_block_is_rejected() -> Result<(), Error> {
    let mut numbers = Numbers(5);
    let mut damaged = 0;
    for case in 0..10 {
        let model = blocks(&mut numbers, false, true)?;
        let name = format!("false_block_{case}");
        let _ = is_proved(&model, &name);
        let log = std::fs::read_to_string(file(&name)).expect("a log");
        let lines: Vec<&str> = log.lines().collect();
        for (k, line) in lines.iter().enumerate().filter(|(_, line)| line.starts_with("m L ")) {
            let mut words: Vec<String> = line.split(' ').map(String::from).collect();
            let value: f64 = words[2].parse().expect("a number");
            words[2] = format!("{}", value + 8.0 + value.abs());
            let mut other: Vec<String> = lines.iter().map(|line| line.to_string()).collect();
            other[k] = words.join(" ");
            assert!(check(other.join("\n").as_bytes()).is_err(), "{case}: {line}");
            damaged += 1;
        }
    }
    assert!(damaged > 10, "{damaged}");
    Ok(())
}

/// Squares in several blocks are searched and proved as a whole.
#[test]
fn squares_are_proved_as_a_whole() -> Result<(), Error> {
    let mut model = Model::new("squares in blocks");
    let mut cost = Affine::from(0.0);
    let mut squares = Vec::new();
    for k in 0..3 {
        let n = model.integer(format!("n[{k}]"), 0.0, 9.0)?;
        let x = model.continuous(format!("x[{k}]"), -4.0, 4.0)?;
        model.add(format!("row[{k}]"), (n * 2.0 + x).ge(3.3 + k as f64))?;
        squares.push((x - 0.5 * k as f64).square());
        cost += n * 0.7;
    }
    let squares = squares.into_iter().reduce(|a, b| a + b).expect("squares");
    model.minimize(squares + cost)?;
    let solution = is_proved(&model, "squares_in_blocks");
    assert!(solution.is_optimal());
    Ok(())
}
