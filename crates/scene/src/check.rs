//! The checks that several parts of a scene share, each naming the key at fault.

use crate::SceneError;

/// Nothing, or the first thing that is wrong.
pub(crate) type Checked = Result<(), SceneError>;

/// `value` is neither NaN nor infinite.
pub(crate) fn finite(key: &str, value: f64) -> Checked {
    if value.is_finite() {
        return Ok(());
    }
    Err(SceneError::at(key, format!("{value} is not a finite number"), "give a finite number"))
}

/// Each component of `point` is finite.
pub(crate) fn point(key: &str, point: [f64; 3]) -> Checked {
    (0..3).try_for_each(|i| finite(&format!("{key}[{i}]"), point[i]))
}

/// `vector` is finite and not zero, so that it has a direction.
pub(crate) fn direction(key: &str, vector: [f64; 3]) -> Checked {
    point(key, vector)?;
    if vector == [0.0; 3] {
        return Err(SceneError::at(
            key,
            "a vector of length zero has no direction",
            "give three numbers that are not all 0",
        ));
    }
    Ok(())
}

/// `values` never go down; `key` names the list's i-th element.
pub(crate) fn ascending(values: impl IntoIterator<Item = f64>, key: impl Fn(usize) -> String) -> Checked {
    let mut last = f64::NEG_INFINITY;
    for (i, value) in values.into_iter().enumerate() {
        if value < last {
            return Err(SceneError::at(
                key(i),
                format!("{value} comes after {last}"),
                "give the points in ascending order",
            ));
        }
        last = value;
    }
    Ok(())
}

/// A list of `len` entries has at most `most`.
pub(crate) fn at_most(key: &str, len: usize, most: usize) -> Checked {
    if len <= most {
        return Ok(());
    }
    Err(SceneError::at(format!("{key}[{most}]"), format!("there are {len} of them"), format!("give at most {most}")))
}
