//! Choices, each with its name in files.

use crate::Value;

/// A choice among a few, each with a name in files.
pub trait Choice: Copy + PartialEq + 'static {
    /// Every choice with its name, in the order in which they are listed.
    const NAMES: &'static [(Self, &'static str)];

    /// Its name in files; without letters where [`NAMES`](Self::NAMES) does not have it.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(known, _)| *known == self).map_or("", |(_, name)| name)
    }
}

/// The choice that a value names; none where the table does not have it.
pub fn named<C: Copy>(names: &[(C, &'static str)], value: &Value) -> Option<C> {
    let Value::Text(text) = value else { return None };
    names.iter().find(|(_, name)| name == text).map(|(choice, _)| *choice)
}

/// A name is offered for an unknown one when it is at least this near (Jaro-Winkler, 0 to 1).
const NEAR: f64 = 0.8;

/// The name nearest to an unknown one; none where none is near.
pub fn nearest_name<'a>(unknown: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let unknown = unknown.to_lowercase();
    let nearness = |name: &'a str| (strsim::jaro_winkler(name, &unknown), name);
    let nearest = known.into_iter().map(nearness).max_by(|a, b| a.0.total_cmp(&b.0));
    nearest.filter(|(nearness, _)| *nearness >= NEAR).map(|(_, name)| name)
}
