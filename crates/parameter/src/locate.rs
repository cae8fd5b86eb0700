//! Which line of a TOML text a key is on, and which key a place in the text belongs to.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The number of the line, from 1, that holds byte `offset` of `text`.
pub fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// The line of the key of this path, such as `cfb.skew`; none where the text does not have it.
pub fn line_of(text: &str, document: &DeTable, key: &str) -> Option<usize> {
    let (span, whole) = walk(document, key)?;
    whole.then(|| line_at(text, span.start))
}

/// The value of this path; none where the text does not have it.
pub fn value_of<'a, 'b>(document: &'a DeTable<'b>, key: &str) -> Option<&'a DeValue<'b>> {
    let mut parts = key.split('.');
    let first = document.get(parts.next()?)?.get_ref();
    parts.try_fold(first, |value, part| match value {
        DeValue::Table(table) => table.get(part).map(Spanned::get_ref),
        _ => None,
    })
}

/// The bytes of the value called `key`, such as `transfer.opacity[2]`, or of the innermost part of
/// that path that the document has. `None` if it has none.
pub fn span_of(document: &DeTable, key: &str) -> Option<Range<usize>> {
    walk(document, key).map(|(span, _)| span)
}

/// The bytes of the innermost part of a path that the document has, and whether that is the whole path.
fn walk(document: &DeTable, key: &str) -> Option<(Range<usize>, bool)> {
    let mut span = None;
    let mut value: Option<&Spanned<DeValue>> = None;
    for part in key.split(['.', '[']) {
        let next = match value.map(Spanned::get_ref) {
            None => document.get_key_value(part),
            Some(DeValue::Table(table)) => table.get_key_value(part),
            Some(DeValue::Array(array)) => {
                let index = part.trim_end_matches(']').parse::<usize>().ok();
                let Some(element) = index.and_then(|index| array.get(index)) else {
                    return span.map(|span| (span, false));
                };
                span = Some(element.span());
                value = Some(element);
                continue;
            }
            Some(_) => None,
        };
        let Some((name, found)) = next else { return span.map(|span| (span, false)) };
        span = Some(name.span());
        value = Some(found);
    }
    span.map(|span| (span, true))
}

/// The path of the innermost key of the document whose name or value holds byte `offset`; empty if there
/// is none.
pub fn key_at(document: &DeTable, offset: usize) -> String {
    let mut innermost = (usize::MAX, String::new());
    search_table(document, "", offset, &mut innermost);
    innermost.1
}

fn search_table(table: &DeTable, path: &str, offset: usize, innermost: &mut (usize, String)) {
    for (name, value) in table {
        let dot = if path.is_empty() { "" } else { "." };
        let path = format!("{path}{dot}{}", name.get_ref());
        offer(name.span(), &path, offset, innermost);
        search_value(value, &path, offset, innermost);
    }
}

fn search_value(value: &Spanned<DeValue>, path: &str, offset: usize, innermost: &mut (usize, String)) {
    offer(value.span(), path, offset, innermost);
    match value.get_ref() {
        DeValue::Table(table) => search_table(table, path, offset, innermost),
        DeValue::Array(array) => {
            for (i, element) in array.iter().enumerate() {
                search_value(element, &format!("{path}[{i}]"), offset, innermost);
            }
        }
        _ => {}
    }
}

/// Keeps `path` if `span` holds `offset` and is no longer than what has been kept.
fn offer(span: Range<usize>, path: &str, offset: usize, innermost: &mut (usize, String)) {
    if span.contains(&offset) && span.len() <= innermost.0 {
        *innermost = (span.len(), path.to_owned());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "a = 1\n[b]\nc = [\n  [1, 2],\n  [3, 4],\n]\n[[d]]\nx = 1\n[[d]]\ny = 2\n";

    fn line_of(key: &str) -> Option<usize> {
        let document = DeTable::parse(TEXT).unwrap();
        span_of(document.get_ref(), key).map(|span| line_at(TEXT, span.start))
    }

    #[test]
    fn a_key_has_the_line_of_its_innermost_part() {
        assert_eq!(line_of("a"), Some(1));
        assert_eq!(line_of("b.c"), Some(3));
        assert_eq!(line_of("b.c[1][0]"), Some(5));
        assert_eq!(line_of("b.missing"), Some(2));
        assert_eq!(line_of("b.c[9]"), Some(3));
        assert_eq!(line_of("d[1].y"), Some(10));
        assert_eq!(line_of("d[1].missing"), Some(9));
        assert_eq!(line_of("a.too.deep"), Some(1));
        assert_eq!(line_of("missing"), None);
        assert_eq!(line_of(""), None);
    }

    #[test]
    fn a_line_is_that_of_the_whole_key_alone() {
        let document = DeTable::parse(TEXT).unwrap();
        let line = |key| super::line_of(TEXT, document.get_ref(), key);
        assert_eq!(["a", "b.c", "b.c[1][0]", "d[1].y"].map(line), [Some(1), Some(3), Some(5), Some(10)]);
        assert_eq!(["b.missing", "b.c[9]", "d[1].missing", "a.too.deep", "missing"].map(line), [None; 5]);
        assert!(value_of(document.get_ref(), "b.c").is_some_and(DeValue::is_array));
        assert!(value_of(document.get_ref(), "b.d").is_none());
    }

    #[test]
    fn a_place_has_its_innermost_key() {
        let document = DeTable::parse(TEXT).unwrap();
        let key = |what: &str| key_at(document.get_ref(), TEXT.find(what).unwrap());
        assert_eq!(key("a"), "a");
        assert_eq!(key("4"), "b.c[1][1]");
        assert_eq!(key("y"), "d[1].y");
        assert_eq!(key("b"), "b");
        assert_eq!(key_at(document.get_ref(), TEXT.len()), "");
    }
}
