//! Proofs of true claims are accepted. Whatever is done to a log: what is accepted is true.

use crate::enumeration::{Product, Row, Small, Writer};
use proptest::prelude::*;
use proptest::sample::Index;

fn small() -> impl Strategy<Value = Small> {
    (1_usize..4).prop_flat_map(|n| {
        let bounds = prop::collection::vec((-2_i64..2, 0_i64..3).prop_map(|(l, w)| (l, l + w)), n);
        let side = || prop::option::of(-4_i64..5);
        let row = (side(), side(), prop::collection::vec(-3_i64..4, n)).prop_map(order);
        let rows = prop::collection::vec(row, 0..4);
        let cone =
            prop::option::of((0..n, prop::option::of(0..n), prop::collection::vec(0..n, 1..3)));
        let linear = prop::collection::vec(-3_i64..4, n);
        let squares = prop::collection::vec(0_i64..3, n);
        (bounds, rows, cone, linear, squares).prop_map(|(bounds, rows, cone, linear, squares)| {
            Small { bounds, rows, cone, linear, squares, claim: None }
        })
    })
}

fn order((lower, upper, row): Row) -> Row {
    match (lower, upper) {
        (Some(lower), Some(upper)) if lower > upper => (Some(upper), Some(lower), row),
        _ => (lower, upper, row),
    }
}

/// A change: which line, which word, and what happens to it.
type Change = (Index, Index, Index, u8);

fn changes() -> impl Strategy<Value = Vec<Change>> {
    prop::collection::vec((any::<Index>(), any::<Index>(), any::<Index>(), 0_u8..12), 1..4)
}

/// Makes one change in the lines of a proof.
fn change(lines: &mut Vec<String>, (line, word, other, what): &Change) {
    const WORDS: [&str; 24] = [
        "0", "1", "-1", "2", "-2", "3", "0.5", "-0.5", "1e-9", "L", "U", "b", "d", "x", "k", "m",
        "s", "f", "t", "e", "inf", "u", "v", "i",
    ];
    if lines.is_empty() {
        return;
    }
    let (at, from) = (line.index(lines.len()), other.index(lines.len()));
    let mut words: Vec<String> = lines[at].split(' ').map(String::from).collect();
    let place = word.index(words.len());
    match what {
        0 => {
            lines.remove(at);
        }
        1 => lines.insert(at, lines[from].clone()),
        2 => lines.swap(at, from),
        3 => lines.truncate(at),
        4 => {
            words.remove(place);
            lines[at] = words.join(" ");
        }
        5 | 6 => {
            words[place] = WORDS[other.index(WORDS.len())].to_string();
            lines[at] = words.join(" ");
        }
        7 => {
            let donor: Vec<&str> = lines[from].split(' ').collect();
            words[place] = donor[other.index(donor.len())].to_string();
            lines[at] = words.join(" ");
        }
        _ => {
            if let Ok(value) = words[place].parse::<f64>() {
                let step = [1.0, -1.0, 0.5, -2.0 * value][usize::from(what % 4)];
                words[place] = (value + step).to_string();
            }
            lines[at] = words.join(" ");
        }
    }
}

/// The log of these steps, with the right count at the end.
fn log(small: &Small, steps: &[String]) -> String {
    let steps: Vec<&str> =
        steps.iter().map(String::as_str).filter(|line| !line.starts_with("end")).collect();
    let count = steps.len();
    small.header() + &steps.join("\n") + &format!("\nend {count}\n")
}

fn is_proved(log: &str) -> bool {
    carom_proof::check(log.as_bytes()).is_ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn what_is_accepted_is_true(
        mut small in small(),
        choices in prop::collection::vec(any::<u8>(), 1..20),
        changes in prop::collection::vec(changes(), 30),
        numbers in prop::collection::vec((any::<Index>(), any::<Index>(), -3_i64..4), 10),
        excess in prop_oneof![Just(0.0), Just(0.5), Just(1.0), Just(7.0)],
    ) {
        // A true claim is proved.
        let best = small.best();
        small.claim = best.map(|best| best as f64 - 0.5);
        let steps = Writer::new(&small, &choices).lines;
        let proof = log(&small, &steps);
        let said = carom_proof::check(proof.as_bytes());
        prop_assert!(said.is_ok(), "{}\n{proof}", said.unwrap_err());

        // Neither is a false one, nor that there is no point, with any change in the proof.
        for claim in [best.map(|best| best as f64 + excess), None] {
            let claimed = Small { claim, ..small.clone() };
            let own = Writer::new(&claimed, &choices).lines;
            for steps in [&steps, &own] {
                let proof = log(&claimed, steps);
                prop_assert!(!is_proved(&proof) || claimed.is_true(), "{proof}");
                for changes in &changes {
                    let mut steps = steps.clone();
                    changes.iter().for_each(|one| change(&mut steps, one));
                    let proof = log(&claimed, &steps);
                    prop_assert!(!is_proved(&proof) || claimed.is_true(), "{proof}");
                }
            }
        }

        // A proof of another program does not prove what is false of this one.
        for (row, place, value) in &numbers {
            let mut other = small.clone();
            match (row.index(4), other.rows.len()) {
                (0, _) => {
                    let place = place.index(other.linear.len());
                    other.linear[place] += value;
                }
                (1, _) => {
                    let place = place.index(other.bounds.len());
                    other.bounds[place].1 += value.abs();
                }
                (_, 0) => other.claim = other.claim.map(|bound| bound + *value as f64),
                (k, many) => {
                    let (lower, upper, row) = &mut other.rows[row.index(many)];
                    let place = place.index(row.len());
                    match k {
                        2 => row[place] += value,
                        _ => {
                            *lower = lower.map(|side| side - value.abs());
                            *upper = upper.map(|side| side + value.abs());
                        }
                    }
                }
            }
            let proof = log(&other, &steps);
            prop_assert!(!is_proved(&proof) || other.is_true(), "{proof}");
        }
    }

    /// Products of any columns, values and sides, most of which are not 0.
    #[test]
    fn products_that_are_not_zero_prove_nothing_false(
        mut small in small(),
        choices in prop::collection::vec(any::<u8>(), 1..20),
        wild in prop::collection::vec(prop::collection::vec(wild_product(), 1..3), 20),
    ) {
        let Some(best) = small.best() else { return Ok(()) };
        small.claim = Some(best as f64 + 0.5);
        let many = small.bounds.len();
        for wild in &wild {
            let products: Vec<Product> = wild
                .iter()
                .map(|&(column, value, binary, off)| {
                    (column % many, value, binary % many, off, Vec::new())
                })
                .collect();
            let proof = log(&small, &Writer::with_products(&small, &choices, &products).lines);
            prop_assert!(!is_proved(&proof), "{proof}");
        }
    }
}

fn wild_product() -> impl Strategy<Value = (usize, i64, usize, i64)> {
    (0_usize..3, -2_i64..3, 0_usize..3, 0_i64..2)
}
