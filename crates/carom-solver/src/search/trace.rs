//! Spans and events for the feature `tracing`; empty without it.

/// A span until the end of the block.
macro_rules! span {
    ($level:ident, $name:literal $(, $field:ident = $value:expr)* $(,)?) => {
        #[cfg(feature = "tracing")]
        let _span = tracing::span!(tracing::Level::$level, $name $(, $field = $value)*).entered();
    };
}

/// An event in the present span.
macro_rules! event {
    ($level:ident, $($what:tt)*) => {
        #[cfg(feature = "tracing")]
        tracing::event!(tracing::Level::$level, $($what)*);
    };
}

pub(super) use {event, span};

/// The span that surrounds the start of a thread, to be entered on it; WebAssembly starts none.
#[cfg(feature = "tracing")]
#[cfg_attr(target_family = "wasm", allow(dead_code))]
pub(super) struct Around(tracing::Span);

#[cfg(feature = "tracing")]
#[cfg_attr(target_family = "wasm", allow(dead_code))]
impl Around {
    pub(super) fn current() -> Self {
        Around(tracing::Span::current())
    }

    pub(super) fn enter(&self) -> impl Drop + '_ {
        self.0.enter()
    }
}

#[cfg(not(feature = "tracing"))]
#[cfg_attr(target_family = "wasm", allow(dead_code))]
pub(super) struct Around;

#[cfg(not(feature = "tracing"))]
#[cfg_attr(target_family = "wasm", allow(dead_code))]
impl Around {
    pub(super) fn current() -> Self {
        Around
    }

    pub(super) fn enter(&self) -> Self {
        Around
    }
}
