//! Methods that always give up are asked less often.

use carom_solver::internals::relaxation::Record;

/// How often a method is asked that gives up, or not, at each of so many programs.
fn asked(record: &mut Record, programs: usize, gives_up: bool) -> usize {
    let ask = |_: &usize| {
        let asked = record.asks();
        if asked {
            record.note(gives_up);
        }
        asked
    };
    (0..programs).filter(ask).count()
}

#[test]
fn a_method_that_always_gives_up_is_asked_now_and_then() {
    let mut record = Record::default();
    assert_eq!(asked(&mut record, 16, true), 16);
    assert_eq!(asked(&mut record, 80, true), 10);
    // One that succeeds is asked again, always.
    asked(&mut record, 8, false);
    assert_eq!(asked(&mut record, 50, false), 50);
}

#[test]
fn a_method_that_succeeds_now_and_then_is_always_asked() {
    let mut record = Record::default();
    for _ in 0..10 {
        assert_eq!(asked(&mut record, 15, true), 15);
        assert_eq!(asked(&mut record, 1, false), 1);
    }
}
