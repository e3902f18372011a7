//! Fixed columns, which allow names with blanks.
//!
//! Fixed MPS holds a kind in columns 2-3, names in 5-12, 15-22 and 40-47, numbers in 25-36 and
//! 50-61, and blanks between them. If no name has a blank, splitting at white space finds the same
//! tokens, so only files that cannot be read that way get here.

use std::ops::Range;

const KIND_FIELD: Range<usize> = 1..3;
const NAME_FIELDS: [Range<usize>; 3] = [4..12, 14..22, 39..47];
const NUMBER_FIELDS: [Range<usize>; 2] = [24..36, 49..61];

/// The same text with an underscore for every blank inside a name, or `None` if the text is not in
/// fixed columns or has no such name. Every character keeps its position.
pub(super) fn without_blanks(text: &str) -> Option<String> {
    let mut result = String::with_capacity(text.len());
    let (mut data, mut changed) = (false, false);
    for whole in text.split_inclusive('\n') {
        let line = whole.trim_end();
        let header = !line.starts_with(char::is_whitespace);
        if line.is_empty() || line.starts_with('*') || header {
            if header && !line.is_empty() && !line.starts_with('*') {
                let word = line.split_whitespace().next().unwrap_or("");
                data = !["NAME", "OBJSENSE", "OBJNAME"]
                    .iter()
                    .any(|name| word.eq_ignore_ascii_case(name));
                // The name of a row follows.
                if ["QCMATRIX", "QSECTION"].iter().any(|name| word.eq_ignore_ascii_case(name)) {
                    let (head, rest) = line.split_at(word.len());
                    let name = rest.trim_start();
                    let (gap, plain) = (&rest[..rest.len() - name.len()], name.replace(' ', "_"));
                    changed |= plain != name;
                    result.extend([head, gap, plain.as_str(), &whole[line.len()..]]);
                    continue;
                }
            }
            result.push_str(whole);
            continue;
        }
        if !data {
            result.push_str(whole);
            continue;
        }
        let mut bytes = line.as_bytes().to_vec();
        if !is_fixed(&bytes) {
            return None;
        }
        for field in NAME_FIELDS {
            let field = field.start.min(bytes.len())..field.end.min(bytes.len());
            let inside = bytes[field.clone()].trim_ascii().len();
            let start = bytes[field.clone()].iter().take_while(|&&b| b == b' ').count();
            for byte in &mut bytes[field][start..start + inside] {
                if *byte == b' ' {
                    (*byte, changed) = (b'_', true);
                }
            }
        }
        // Only blanks became underscores, so this is still text.
        result.push_str(std::str::from_utf8(&bytes).ok()?);
        result.push_str(&whole[line.len()..]);
    }
    changed.then_some(result)
}

/// Whether a line has only blanks outside the fields, single words in kinds and numbers.
fn is_fixed(line: &[u8]) -> bool {
    let fields = || NAME_FIELDS.iter().chain(&NUMBER_FIELDS).chain([&KIND_FIELD]);
    let single = |field: &Range<usize>| {
        let end = field.end.min(line.len());
        let word = line[field.start.min(end)..end].trim_ascii();
        !word.contains(&b' ')
    };
    let blank = |(column, &byte): (usize, &u8)| {
        byte == b' ' || fields().any(|field| field.contains(&column))
    };
    line.is_ascii()
        && !line.contains(&b'\t')
        && line.iter().enumerate().all(blank)
        && single(&KIND_FIELD)
        && NUMBER_FIELDS.iter().all(single)
}
