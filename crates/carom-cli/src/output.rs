//! `print!` and `println!` for tools whose output is often cut off, as in `solve FILE | head -1`:
//! if nobody reads on, the program ends quietly instead of panicking.

use std::fmt::Arguments;
use std::io::{ErrorKind, Write, stdout};
use std::process::exit;

#[allow(unused_macros)] // not every tool prints parts of lines
macro_rules! print {
    ($($text:tt)*) => { $crate::output::write(format_args!($($text)*)) };
}

macro_rules! println {
    () => { $crate::output::write(format_args!("\n")) };
    ($($text:tt)*) => { $crate::output::write(format_args!("{}\n", format_args!($($text)*))) };
}

pub(crate) fn write(text: Arguments<'_>) {
    if let Err(error) = stdout().write_fmt(text).and_then(|()| stdout().flush()) {
        if error.kind() == ErrorKind::BrokenPipe {
            exit(0);
        }
        eprintln!("cannot write: {error}");
        exit(1);
    }
}
