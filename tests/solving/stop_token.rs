//! When a token is over, and for which reason.

use std::time::Duration;

use carom::solution::Termination;
use carom::solver::{Interrupt, StopToken};

/// Work after which a token looks at the clock.
const BETWEEN: usize = 10_000;

#[test]
fn once_over_it_stays_over() {
    let interrupt = Interrupt::new();
    let token = StopToken::new(None, &interrupt);
    assert!(!token.spend(usize::MAX) && !token.is_over() && token.left().is_none());
    interrupt.trigger();
    assert!(!token.spend(1), "too little work for a look");
    assert!(token.spend(BETWEEN));
    interrupt.reset();
    assert!(token.spend(0) && token.clone().is_over() && token.child(None).is_over());
    assert_eq!(token.ended(), Some(Termination::Interrupted));
}

#[test]
fn a_limit_of_nothing_is_over_at_once() {
    let interrupt = Interrupt::new();
    let token = StopToken::new(Some(Duration::ZERO), &interrupt);
    assert!(token.spend(BETWEEN) && token.child(Some(Duration::MAX)).is_over());
    assert_eq!(token.left(), Some(Duration::ZERO));
    interrupt.trigger();
    assert_eq!(token.ended(), Some(Termination::TimeLimit), "the first reason stands");
    assert!(!StopToken::new(Some(Duration::MAX), &Interrupt::new()).is_over());
    assert!(!StopToken::default().is_over());
}

#[test]
fn searches_inside_searches_end_with_the_outermost() {
    let user = Interrupt::new();
    let outer = StopToken::new(None, &user);
    let inner = outer.child(None);
    let innermost = inner.child(None);
    let late = outer.child(Some(Duration::ZERO));
    assert_eq!(late.ended(), Some(Termination::TimeLimit));
    assert!(!innermost.is_over());
    inner.stop();
    assert_eq!(innermost.ended(), Some(Termination::Interrupted));
    assert!(!outer.is_over() && !user.is_triggered());
    let other = outer.child(None);
    user.trigger();
    assert!(other.is_over() && outer.is_over());
    assert_eq!(late.ended(), Some(Termination::TimeLimit));
}
