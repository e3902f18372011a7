//! The binary form: the same file, item for item, in both orders of bytes.

use carom::ErrorKind;
use carom::model::nl;

use super::Sizes;

/// What a file consists of behind its header.
enum Item {
    Letter(char),
    Whole(i32),
    Short(i16),
    Number(f64),
    Name(&'static str),
}

use Item::{Letter, Name, Number, Short, Whole};

fn items() -> Vec<Item> {
    let mut items = vec![Letter('S'), Whole(4), Whole(1), Name("priority"), Whole(0), Number(2.5)];
    items.extend([Letter('F'), Whole(0), Whole(1), Whole(-1), Name("unused")]);
    items.extend([Letter('V'), Whole(3), Whole(1), Whole(0), Whole(1), Number(0.5)]);
    items.extend([Letter('n'), Number(-1.25)]);
    items.extend([Letter('C'), Whole(0), Letter('o'), Whole(54), Whole(3)]);
    items.extend([Letter('o'), Whole(5), Letter('v'), Whole(0), Letter('s'), Short(2)]);
    items.extend([Letter('o'), Whole(5), Letter('v'), Whole(3), Letter('n'), Number(2.0)]);
    items.extend([Letter('l'), Whole(-70_000)]);
    items.extend([Letter('C'), Whole(1), Letter('n'), Number(0.0)]);
    items.extend([Letter('O'), Whole(0), Whole(1), Letter('n'), Number(0.1)]);
    items.extend([Letter('x'), Whole(1), Whole(2), Number(1.0)]);
    items.extend([Letter('r'), Letter('1'), Number(4.0), Letter('0'), Number(-1.0), Number(6.5)]);
    items.extend([Letter('b'), Letter('3'), Letter('2'), Number(-4.0), Letter('0'), Number(0.0)]);
    items.extend([Number(1.0), Letter('k'), Whole(2), Whole(1), Whole(2)]);
    items.extend([Letter('J'), Whole(0), Whole(1), Whole(0), Number(0.0)]);
    items.extend([Letter('J'), Whole(1), Whole(2), Whole(1), Number(1e-3), Whole(2), Number(7.0)]);
    items.extend([Letter('G'), Whole(0), Whole(1), Whole(1), Number(-3.0)]);
    items
}

fn sizes() -> Sizes {
    let nonlinear = [2, 0, 0];
    let whole = [1, 0, 0, 0, 0];
    Sizes {
        nonlinear,
        whole,
        functions: 1,
        definitions: 1,
        nonzeros: [3, 1],
        ..Sizes::new(3, 2, 1)
    }
}

fn text() -> String {
    // In the text form, what is behind a letter that begins an expression stands next to it.
    let parts = items().iter().fold(String::new(), |text, item| match item {
        Letter(letter) => format!("{text}\n{letter}"),
        Whole(value) => format!("{text}{value} "),
        Short(value) => format!("{text}{value} "),
        Number(value) => format!("{text} {value:?} "),
        Name(name) => format!("{text}{name} "),
    });
    sizes().header("g3 1 1 0").trim_end().to_owned() + &parts + "\n"
}

fn binary(is_big: bool) -> Vec<u8> {
    let header = sizes().header("b3 1 1 0");
    let header = if is_big { header.replace(" 0 1 1 0\n", " 0 1 2 0\n") } else { header };
    let mut bytes = header.into_bytes();
    let whole = |value: i32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
    for item in items() {
        match item {
            Letter(letter) => bytes.push(u8::try_from(letter).unwrap()),
            Whole(value) => bytes.extend(whole(value)),
            Short(value) if is_big => bytes.extend(value.to_be_bytes()),
            Short(value) => bytes.extend(value.to_le_bytes()),
            Number(value) if is_big => bytes.extend(value.to_be_bytes()),
            Number(value) => bytes.extend(value.to_le_bytes()),
            Name(name) => {
                bytes.extend(whole(i32::try_from(name.len()).unwrap()));
                bytes.extend(name.bytes());
            }
        }
    }
    bytes
}

#[test]
fn the_same_program_in_all_forms() {
    let text = nl::read(text()).unwrap();
    assert_eq!((text.model.constraint_count(), text.model.conic_constraint_count()), (1, 1));
    for is_big in [false, true] {
        let read = nl::read(binary(is_big)).unwrap();
        assert_eq!(read.model.to_string(), text.model.to_string());
        let at = |start: &[(carom::model::Variable, f64)]| (start[0].0.index(), start[0].1);
        assert_eq!(at(&read.start), at(&text.start));
    }
}

#[test]
fn a_binary_file_that_is_cut_off_is_refused() {
    let whole = binary(false);
    let end = whole.len();
    for length in 0..end {
        let error = nl::read(&whole[..length]).unwrap_err();
        assert!(matches!(error.kind(), ErrorKind::Parse { .. }), "{length}: {error}");
    }
    // Places are counted in bytes, behind the header.
    let at = nl::read(&whole[..end - 4]).unwrap_err().to_string();
    let column = end - 4 - sizes().header("b3 1 1 0").len() + 1;
    assert_eq!(at, format!("line 11, column {column}: the file ends before a coefficient"));
    let mut other = binary(false);
    let flags = b" 0 1 1 0\n";
    let place = other.windows(flags.len()).position(|part| part == flags).unwrap();
    other[place + 5] = b'5';
    let error = nl::read(&other).unwrap_err().to_string();
    assert!(error.contains("the binary form 5 is not read; write the file as text"), "{error}");
}
