//! A row of a table of parameters.

use crate::{Legal, Unfit, Value, ValueKind};

/// One parameter of `T`: a key of its files.
///
/// Its default is what [`get`](Self::get) gives of the default `T`.
#[derive(Debug)]
pub struct Parameter<T> {
    /// The dotted path in files; `[]` stands for every element of a list, and the value is then the list over the elements.
    pub key: &'static str,
    /// The kind of its values.
    pub kind: ValueKind,
    /// The unit of its values; empty where they are counts, names or parts of 1.
    pub unit: &'static str,
    /// What it is, in a sentence without its stop.
    pub about: &'static str,
    /// Where it, its default or its range is from.
    pub source: &'static str,
    /// Whether it may be absent.
    pub optional: bool,
    /// A value as TOML has it, of a parameter that is absent by default; else empty.
    pub example: &'static str,
    /// Why the range is what it is, where another parameter or more than the number's size sets it; else empty.
    pub because: &'static str,
    /// Which values are legal where the rest is as it is.
    pub legal: fn(&T) -> Legal,
    /// Its value.
    pub get: fn(&T) -> Value,
    /// Sets it, whether the value is legal or not.
    pub set: fn(&mut T, &Value) -> Result<(), Unfit>,
}

/// A row of a parameter that is a field: `parameter!(Machine, rays.grid, "unit", "what it is", "source")`. The key is the field's path. A
/// choice has the range of its names, other fields have none.
#[macro_export]
macro_rules! parameter {
    ($of:ty, $first:ident $(. $rest:ident)*, $unit:expr, $about:expr, $source:expr) => {
        $crate::Parameter {
            key: concat!(stringify!($first) $(, ".", stringify!($rest))*),
            kind: $crate::kind(|of: &$of| &of.$first $(. $rest)*),
            unit: $unit,
            about: $about,
            source: $source,
            optional: $crate::optional(|of: &$of| &of.$first $(. $rest)*),
            example: "",
            because: "",
            legal: |_| $crate::legal(|of: &$of| &of.$first $(. $rest)*),
            get: |of: &$of| $crate::Field::value(&of.$first $(. $rest)*),
            set: |of: &mut $of, value| $crate::assign(&mut of.$first $(. $rest)*, value),
        }
    };
}
