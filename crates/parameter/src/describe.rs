//! A row in words and numbers, for lists of parameters.

use crate::{Legal, Parameter, Value, ValueKind};
use serde::{Serialize, Serializer};

/// What a list of parameters says of one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Description {
    /// The key.
    pub key: &'static str,
    /// The kind of its values.
    #[serde(serialize_with = "in_words")]
    pub kind: ValueKind,
    /// The unit; may be empty.
    pub unit: &'static str,
    /// What is legal where the rest is as it is by default.
    pub legal: Legal,
    /// Why, where more than the number's size sets it.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub because: &'static str,
    /// The default.
    pub default: Value,
    /// Whether it may be absent.
    pub optional: bool,
    /// What it is.
    pub about: &'static str,
    /// Where it is from.
    pub source: &'static str,
}

impl Description {
    /// The innermost table of the file that it is in, `cfb` of `cfb.skew`; empty at the top.
    pub fn section(&self) -> &'static str {
        self.key.rsplit_once('.').map_or("", |(section, _)| section)
    }

    /// The key without its table.
    pub fn name(&self) -> &'static str {
        self.key.rsplit_once('.').map_or(self.key, |(_, name)| name)
    }
}

fn in_words<S: Serializer>(kind: &ValueKind, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(kind)
}

impl<T> Parameter<T> {
    /// What a list says of it, where `default` is the default `T`.
    pub fn describe(&self, default: &T) -> Description {
        let &Parameter { key, kind, unit, because, optional, about, source, .. } = self;
        let (legal, default) = ((self.legal)(default), (self.get)(default));
        Description { key, kind, unit, legal, because, default, optional, about, source }
    }
}
