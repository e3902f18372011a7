//! No-goods and their propagation.

use carom::internals::presolve::{Domain, Literal, NoGoods, Reason};
use carom::internals::program::Program;
use carom::model::Model;

/// Most no-goods that are kept at a time.
const MOST: usize = 2000;

/// Binaries alone.
fn domain(columns: usize) -> Domain {
    let mut model = Model::new("binaries");
    model.binary_family("v", columns).expect("a family");
    Domain::new(&Program::assemble(&model).expect("a program"))
}

fn at_one(column: usize) -> Literal {
    Literal { column, is_upper: false, value: 1.0 }
}

/// Decides a column at 1 and follows all that changed.
fn decide(
    no_goods: &mut NoGoods,
    domain: &mut Domain,
    column: usize,
    cutoff: f64,
) -> Result<(), u32> {
    let mut next = domain.mark();
    domain.apply(column, false, 1.0);
    while next < domain.mark() {
        let (column, is_upper) = domain.changed_since(next).next().expect("a change");
        next += 1;
        no_goods.follow(domain, column, is_upper, cutoff)?;
    }
    Ok(())
}

#[test]
fn a_literal_denies_exactly_what_it_says() {
    let literal = Literal { column: 0, is_upper: true, value: 2.0 };
    for lower in 0..4 {
        for upper in lower..4 {
            let bounds = [f64::from(lower), f64::from(upper)];
            assert_eq!(literal.holds(bounds), upper <= 2);
            assert_eq!(literal.fails(bounds), lower >= 3);
            assert_eq!(literal.denial().holds(bounds), literal.fails(bounds));
            assert_eq!(literal.denial().fails(bounds), literal.holds(bounds));
        }
    }
}

#[test]
fn the_last_literal_is_denied_in_any_order_and_after_undoing() {
    let orders = [[0, 1, 2, 3], [3, 2, 1, 0], [1, 3, 0, 2], [2, 0, 3, 1]];
    let mut domain = domain(4);
    let mut no_goods = NoGoods::new(4);
    let number = no_goods.add((0..4).map(at_one).collect(), f64::INFINITY);
    for order in orders.iter().cycle().take(20) {
        for (k, &column) in order[..3].iter().enumerate() {
            decide(&mut no_goods, &mut domain, column, 0.0).expect("no contradiction");
            let last = domain.bounds(order[3]);
            assert_eq!(last, if k == 2 { [0.0, 0.0] } else { [0.0, 1.0] });
        }
        let change = domain.change(domain.mark() - 1);
        assert_eq!(change.reason, Reason::NoGood(number));
        domain.undo_to(0);
    }
    assert_eq!((no_goods.counts().fixed, no_goods.counts().refuted), (20, 0));
}

#[test]
fn what_holds_up_to_a_cutoff_says_nothing_beyond_it() {
    let mut domain = domain(2);
    let mut no_goods = NoGoods::new(2);
    no_goods.add(vec![at_one(0), at_one(1)], 5.0);
    decide(&mut no_goods, &mut domain, 0, 6.0).expect("no contradiction");
    assert_eq!(domain.bounds(1), [0.0, 1.0]);
    domain.undo_to(0);
    decide(&mut no_goods, &mut domain, 0, 5.0).expect("no contradiction");
    assert_eq!(domain.bounds(1), [0.0, 0.0]);
}

#[test]
fn single_literals_are_denied_at_once() {
    let mut domain = domain(2);
    let mut no_goods = NoGoods::new(2);
    let number = no_goods.add(vec![at_one(1)], f64::INFINITY);
    no_goods.deny_single(&mut domain, 0.0).expect("no contradiction");
    assert_eq!(domain.bounds(1), [0.0, 0.0]);
    domain.undo_to(0);
    domain.apply(1, false, 1.0);
    assert_eq!(no_goods.deny_single(&mut domain, 0.0), Err(number));
}

#[test]
fn the_store_is_bounded_and_keeps_what_is_used() {
    let (mut domain, mut no_goods) = (domain(2), NoGoods::new(2));
    no_goods.add(vec![at_one(0), at_one(1)], f64::INFINITY);
    for _ in 1..MOST {
        no_goods.add(vec![at_one(1), at_one(0)], f64::NEG_INFINITY);
    }
    assert!(no_goods.is_full());
    for _ in 0..3 {
        for _ in 0..600 {
            decide(&mut no_goods, &mut domain, 0, 0.0).expect("no contradiction");
            assert_eq!(domain.bounds(1), [0.0, 0.0]);
            domain.undo_to(0);
        }
        no_goods.tidy(false);
        assert!(!no_goods.is_full() && !no_goods.is_empty());
    }
    no_goods.tidy(true);
    assert_eq!(no_goods.iter().count(), 1);
}
