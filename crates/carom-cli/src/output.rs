//! `print!`, `println!` and `eprintln!` for tools whose output is often cut off, as in `solve FILE
//! | head -1`: if nobody reads on, the program ends quietly instead of panicking. If nobody reads
//! the standard error, it goes on without it.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stderr, stdout};
use std::process::exit;

#[allow(unused_macros)] // not every tool prints parts of lines
macro_rules! print {
    ($($text:tt)*) => { $crate::output::write(format_args!($($text)*)) };
}

macro_rules! println {
    () => { $crate::output::write(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::write(format_args!("{}\n", format_args!($($text)*))) };
}

#[allow(unused_macros)] // not every tool has something to say aside
macro_rules! eprintln {
    ($($text:tt)*) => { $crate::output::say(format_args!("{}\n", format_args!($($text)*))) };
}

/// Writes to the standard error, as far as that can be written.
pub(crate) fn say(text: Arguments<'_>) {
    // A line at once, so that lines of other threads do not mix with it.
    let _ = stderr().write_all(text.to_string().as_bytes());
}

pub(crate) fn write(text: Arguments<'_>) {
    if let Err(error) = stdout().write_fmt(text).and_then(|()| stdout().flush()) {
        if error.kind() == ErrorKind::BrokenPipe {
            exit(0);
        }
        say(format_args!("cannot write: {error}\n"));
        exit(1);
    }
}
