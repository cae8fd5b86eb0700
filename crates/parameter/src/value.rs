//! The values of parameters.

use serde::{Serialize, Serializer};
use std::fmt;
use toml::de::DeValue;

/// A value, as a file holds it.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Nothing: the key is left out.
    Absent,
    /// True or false.
    Flag(bool),
    /// A whole number.
    Whole(i128),
    /// A number.
    Real(f64),
    /// Text, or the name of a choice.
    Text(String),
    /// Several of them.
    List(Vec<Value>),
}

impl Value {
    /// The value as a number; none where it is not one.
    pub fn number(&self) -> Option<f64> {
        match self {
            Value::Whole(whole) => Some(*whole as f64),
            Value::Real(real) => Some(*real),
            _ => None,
        }
    }

    /// The value of a TOML text; none of tables, dates and lists with these.
    pub fn of_toml(value: &DeValue) -> Option<Value> {
        match value {
            DeValue::Integer(integer) => i128::from_str_radix(integer.as_str(), integer.radix()).ok().map(Value::Whole),
            DeValue::Float(float) => float.as_str().parse().ok().map(Value::Real),
            DeValue::Boolean(flag) => Some(Value::Flag(*flag)),
            DeValue::String(text) => Some(Value::Text(text.to_string())),
            DeValue::Array(values) => {
                values.iter().map(|value| Value::of_toml(value.get_ref())).collect::<Option<_>>().map(Value::List)
            }
            DeValue::Table(_) | DeValue::Datetime(_) => None,
        }
    }
}

impl fmt::Display for Value {
    /// As TOML has it; `absent` where there is nothing.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Value::Absent => f.write_str("absent"),
            Value::Flag(flag) => write!(f, "{flag}"),
            Value::Whole(whole) => write!(f, "{whole}"),
            Value::Real(real) if real.is_nan() => f.write_str("nan"),
            Value::Real(real) if real.is_finite() && is_long(*real) => write!(f, "{real:e}"),
            Value::Real(real) => write!(f, "{real:?}"),
            Value::Text(text) => write!(f, "{text:?}"),
            Value::List(values) => {
                let values: Vec<String> = values.iter().map(Value::to_string).collect();
                write!(f, "[{}]", values.join(", "))
            }
        }
    }
}

/// Whether a number is shorter with an exponent.
pub(crate) fn is_long(real: f64) -> bool {
    real != 0.0 && !(1e-4..1e6).contains(&real.abs())
}

impl Serialize for Value {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Value::Absent => serializer.serialize_none(),
            Value::Flag(flag) => flag.serialize(serializer),
            Value::Whole(whole) => whole.serialize(serializer),
            Value::Real(real) => real.serialize(serializer),
            Value::Text(text) => text.serialize(serializer),
            Value::List(values) => values.serialize(serializer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_read_as_toml_does() {
        let text = r#"v = [true, -3, 0.5, 8e6, 1.33e8, 2e-5, 1.0, "a\"b", [[1, 2.0]], inf, nan]"#;
        let document = toml::de::DeTable::parse(text).unwrap();
        let value = Value::of_toml(document.get_ref()["v"].get_ref()).unwrap();
        assert_eq!(format!("v = {value}"), text);
        assert_eq!(Value::Absent.to_string(), "absent");
    }
}
