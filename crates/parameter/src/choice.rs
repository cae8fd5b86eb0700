//! Choices, each with its name in files.

use crate::Value;
use strum::VariantArray;

/// A choice among a few, each with a name in files: what it is made into as text.
pub trait Choice: VariantArray + Into<&'static str> + Copy + 'static {
    /// Its name in files.
    fn name(self) -> &'static str {
        self.into()
    }
}

/// The names of every choice, in the order in which they are listed.
pub fn names<C: VariantArray + Into<&'static str> + Copy>() -> impl Iterator<Item = &'static str> {
    C::VARIANTS.iter().map(|&choice| choice.into())
}

/// The choice that a value names; none where there is no such name.
pub fn named<C: VariantArray + Into<&'static str> + Copy>(value: &Value) -> Option<C> {
    let Value::Text(text) = value else { return None };
    C::VARIANTS.iter().copied().find(|&choice| choice.into() == *text)
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
