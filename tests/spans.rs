//! What a subscriber of the `tracing` crate sees: `cargo test --features tracing --test spans`.

use std::sync::{Arc, Mutex};

use carom::prelude::*;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// Collects the names of spans as they begin, with those around them, and of events.
#[derive(Clone, Default)]
struct Collector {
    seen: Arc<Mutex<Seen>>,
}

#[derive(Default)]
struct Seen {
    names: Vec<&'static str>,
    open: Vec<u64>,
    paths: Vec<String>,
    /// With the path of the span around.
    events: Vec<(String, String)>,
}

impl Seen {
    /// The names of the open spans.
    fn path(&self) -> String {
        let names: Vec<_> = self.open.iter().map(|&id| self.names[id as usize - 1]).collect();
        names.join("/")
    }
}

impl Subscriber for Collector {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.target().starts_with("carom")
    }

    fn new_span(&self, span: &Attributes<'_>) -> Id {
        let mut seen = self.seen.lock().unwrap();
        seen.names.push(span.metadata().name());
        Id::from_u64(seen.names.len() as u64)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, event: &Event<'_>) {
        let fields = event.fields().map(|field| field.name()).collect::<Vec<_>>().join(" ");
        let mut seen = self.seen.lock().unwrap();
        let path = seen.path();
        seen.events.push((path, fields));
    }

    fn enter(&self, span: &Id) {
        let mut seen = self.seen.lock().unwrap();
        seen.open.push(span.into_u64());
        let path = seen.path();
        seen.paths.push(path);
    }

    fn exit(&self, span: &Id) {
        let mut seen = self.seen.lock().unwrap();
        assert_eq!(seen.open.pop(), Some(span.into_u64()), "spans are nested");
    }
}

#[test]
fn a_solve_is_a_tree_of_spans() {
    let mut model = Model::new("m");
    let v = model.binary_family("v", 12).unwrap();
    let weight = |k: usize| ((7 * k) % 5 + 3) as f64;
    let load: Affine = v.iter().enumerate().map(|(k, v)| weight(k) * v).sum();
    model.add("load", load.le(20.0)).unwrap();
    model
        .maximize(
            v.iter().enumerate().map(|(k, v)| (weight(k) + 0.1 * k as f64) * v).sum::<Affine>(),
        )
        .unwrap();
    let collector = Collector::default();
    let solution = tracing::subscriber::with_default(collector.clone(), || {
        BranchAndBound::default().solve(&model).unwrap()
    });
    let seen = collector.seen.lock().unwrap();
    assert!(seen.open.is_empty());
    let count = |path: &str| seen.paths.iter().filter(|p| *p == path).count() as u64;
    assert_eq!(count("solve"), 1);
    assert_eq!(count("solve/search"), 1);
    assert_eq!(count("solve/search/node"), solution.statistics().nodes);
    assert!(count("solve/search/node/heuristic") > 0);
    // The pilot search has its own.
    let events = |field: &str| {
        let own = seen.events.iter().filter(|(path, _)| !path.starts_with("solve/pilot"));
        own.filter(|(_, fields)| fields.contains(field)).count() as u64
    };
    assert_eq!(events("found_by"), solution.statistics().incumbents);
    assert!(seen.events.last().unwrap().1.contains("termination"));
}
