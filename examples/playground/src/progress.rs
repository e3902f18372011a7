//! What the page is told while a search runs.

use carom::hybrid::{HorizonEvent, HorizonVerdict};
use serde::Serialize;

/// Receives news as JSON.
pub type Tell<'a> = dyn FnMut(&str) + 'a;

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

/// Tells how many horizons the search of a side has refuted: each of them, in ascending order.
pub fn refuted<'a>(side: &'a str, tell: &'a mut Tell<'_>) -> impl FnMut(&HorizonEvent) + 'a {
    let mut told = 0;
    move |event| {
        let refuted = match event {
            HorizonEvent::Started { refuted, .. } => *refuted,
            HorizonEvent::Decided(attempt) => match attempt.verdict {
                HorizonVerdict::Refuted(_) if attempt.steps == told + 1 => attempt.steps,
                _ => return,
            },
            _ => return,
        };
        if refuted > told {
            told = refuted;
            send(&News::<()> { side, refuted, found: None }, tell);
        }
    }
}

/// Tells the answer of a side.
pub fn found<S: Serialize>(side: &str, refuted: usize, found: &S, tell: &mut Tell<'_>) {
    send(&News { side, refuted, found: Some(found) }, tell);
}

fn send(news: &impl Serialize, tell: &mut Tell<'_>) {
    if let Ok(text) = serde_json::to_string(news) {
        tell(&text);
    }
}
