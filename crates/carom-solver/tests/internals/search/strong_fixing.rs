//! The credit of strong-branching fixings.

use carom_solver::internals::search::branching::FixingCredit;

#[test]
fn trials_end_where_they_find_nothing_and_come_back() {
    let trials = |account: &mut FixingCredit, fixed: bool| {
        let open = |_: &usize| {
            let may = account.may_try();
            if may {
                account.book(fixed);
            }
            may
        };
        (0..100).filter(open).count()
    };
    let mut account = FixingCredit::default();
    assert!(trials(&mut account, false) < 15);
    assert!(trials(&mut account, true) > 80);
    // The credit is at its most: 16 trials, and no part of a trial more.
    let paid = |account: &mut FixingCredit| account.may_try().then(|| account.book(false));
    assert!((0..16).all(|_| paid(&mut account).is_some()));
    assert!((0..20).all(|_| paid(&mut account).is_none()));
}
