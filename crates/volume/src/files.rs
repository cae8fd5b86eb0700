//! Voxels in several files: the list or the pattern of a header.

use std::path::PathBuf;

use crate::VolumeError;
use crate::place::Place;
use crate::text::{Field, HeaderLines, clip};

/// Most data files of a volume.
const FILES_LIMIT: usize = 1 << 16;

/// The names that stand on the lines behind a header that ends with a list.
pub(crate) fn listed(lines: &mut HeaderLines) -> Result<Vec<String>, VolumeError> {
    let mut names = Vec::new();
    while let Some(line) = lines.next()? {
        if !line.trim().is_empty() {
            names.push(line.trim().to_owned());
        }
    }
    Ok(names)
}

/// The files of `LIST [axes]` or of `pattern first last [step [axes]]`; `None` where the field names one file. `sizes` are those of
/// the whole grid.
pub(crate) fn several(
    field: &Field,
    list: &[String],
    sizes: &[usize],
    place: &Place,
) -> Result<Option<Vec<PathBuf>>, VolumeError> {
    let words: Vec<&str> = field.value.split_whitespace().collect();
    let number = |at: usize| words.get(at).and_then(|w| w.trim_end_matches(['D', 'd']).parse::<i64>().ok());
    let (names, axes) = match words.as_slice() {
        ["LIST", ..] => (list.to_vec(), number(1)),
        [pattern, _, _, ..] if pattern.contains('%') && number(1).is_some() && number(2).is_some() => {
            let (first, last, step) = (number(1).unwrap_or(0), number(2).unwrap_or(0), number(3).unwrap_or(1));
            let wrong = |reason: String| {
                field.wrong(reason, "write the pattern as name%03d.raw, the first number, the last and the step")
            };
            if step == 0 || (last.saturating_sub(first)).signum() == -step.signum() {
                return Err(wrong(format!("no way from {first} to {last} in steps of {step}")));
            }
            let count = (last - first) / step + 1;
            if count > FILES_LIMIT as i64 {
                return Err(wrong(format!("{count} files, of {FILES_LIMIT} at most")));
            }
            let name = |i: i64| {
                numbered(pattern, first + i * step)
                    .ok_or_else(|| wrong(format!("'{}' has no place for one whole number", clip(pattern))))
            };
            ((0..count).map(name).collect::<Result<_, _>>()?, number(4))
        }
        _ => return Ok(None),
    };
    if names.is_empty() {
        return Err(field.wrong("an empty list", "name one file on each line behind it"));
    }
    // Each file holds the faster axes; with as many axes as the grid the slowest is divided among them.
    let axes = axes.unwrap_or(sizes.len() as i64 - 1);
    let fits = match usize::try_from(axes) {
        Ok(axes) if axes >= 1 && axes < sizes.len() => sizes[axes..].iter().product::<usize>() == names.len(),
        Ok(axes) if axes == sizes.len() => sizes[axes - 1].is_multiple_of(names.len()),
        _ => false,
    };
    if !fits {
        let grid = crate::error::show_dims(sizes);
        return Err(field.wrong(
            format!("{} files of {axes} axes for a grid of {grid}", names.len()),
            "name one file for each step along the axes that a file does not hold",
        ));
    }
    Ok(Some(names.iter().map(|name| place.beside(name)).collect::<Result<_, _>>()?))
}

/// A C format with one whole number, such as `slice%03d.raw`, with the number put in.
fn numbered(pattern: &str, number: i64) -> Option<String> {
    let (before, rest) = pattern.split_once('%')?;
    let end = rest.find(|c: char| !c.is_ascii_digit())?;
    let (width, after) = rest.split_at(end);
    let after = after.strip_prefix(['d', 'i', 'u'])?;
    let digits: usize = if width.is_empty() { 0 } else { width.parse().ok().filter(|&w| w <= 20)? };
    let number = if width.starts_with('0') { format!("{number:0digits$}") } else { format!("{number:digits$}") };
    (!after.contains('%')).then(|| format!("{before}{number}{after}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_put_in_as_c_does() {
        assert_eq!(numbered("s%03d.raw", 7).unwrap(), "s007.raw");
        assert_eq!(numbered("s%3d", 7).unwrap(), "s  7");
        assert_eq!(numbered("%d.gz", -1).unwrap(), "-1.gz");
        assert_eq!(numbered("%i", 12).unwrap(), "12");
        for wrong in ["s.raw", "s%", "s%f", "s%d%d", "%99d"] {
            assert_eq!(numbered(wrong, 1), None, "{wrong}");
        }
    }
}
