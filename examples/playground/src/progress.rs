//! What the page is told while a search runs.

use std::cell::RefCell;

use carom::hybrid::{HorizonEvent, HorizonVerdict};
use serde::Serialize;

thread_local! {
    /// Who is told the news of the search at work.
    static LISTENER: RefCell<Option<Box<dyn FnMut(&str)>>> = const { RefCell::new(None) };
}

/// Runs a search whose news go to `tell`, as JSON.
pub fn told<T>(tell: impl FnMut(&str) + 'static, search: impl FnOnce() -> T) -> T {
    LISTENER.with_borrow_mut(|listener| *listener = Some(Box::new(tell)));
    let result = search();
    LISTENER.take();
    result
}

/// How far the search of one side is.
#[derive(Debug, Serialize)]
struct News<'a, S> {
    /// `free` or `tolerant`.
    side: &'a str,
    /// Every horizon up to this one is impossible, in steps.
    refuted: usize,
    /// The answer of this side, once it is known.
    found: Option<&'a S>,
}

/// Tells how many horizons the search of a side has refuted: each of them, in ascending order, and
/// again during a long solve, because the page leaves out news that come too often.
pub fn refuted(side: &'static str) -> impl FnMut(&HorizonEvent) {
    let mut told = 0;
    move |event| {
        let refuted = match event {
            HorizonEvent::Started { refuted, .. } => *refuted,
            HorizonEvent::Decided(attempt) => match attempt.verdict {
                HorizonVerdict::Refuted(_) if attempt.steps == told + 1 => attempt.steps,
                _ => return,
            },
            HorizonEvent::Solving { .. } => told,
            _ => return,
        };
        if refuted > told || matches!(event, HorizonEvent::Solving { .. }) {
            told = refuted;
            send(&News::<()> { side, refuted, found: None });
        }
    }
}

/// Tells the answer of a side.
pub fn found<S: Serialize>(side: &str, refuted: usize, found: &S) {
    send(&News { side, refuted, found: Some(found) });
}

fn send(news: &impl Serialize) {
    if let Ok(text) = serde_json::to_string(news) {
        LISTENER.with_borrow_mut(|listener| listener.iter_mut().for_each(|tell| tell(&text)));
    }
}
