//! Which values are legal.

use crate::value::is_long;
use crate::{Value, nearest_name};
use serde::ser::{Serialize, SerializeMap, Serializer};
use std::fmt;

/// Which values a parameter can have where the others are as they are. Of a list, each element; what is absent is legal.
#[derive(Clone, Debug, PartialEq)]
pub enum Legal {
    /// Any.
    Anything,
    /// Whole numbers from `low` to `high`.
    Whole {
        /// The smallest.
        low: i128,
        /// The largest.
        high: i128,
    },
    /// Finite numbers from `low` to `high`.
    Real {
        /// The lower end.
        low: f64,
        /// The upper end.
        high: f64,
        /// Whether the lower and the upper end are not in it.
        open: [bool; 2],
    },
    /// One of a few; none of a kind that cannot be had here.
    OneOf(Vec<Value>),
}

impl Legal {
    /// Whole numbers from `low` to `high`.
    pub const fn whole(low: i128, high: i128) -> Legal {
        Legal::Whole { low, high }
    }

    /// Numbers from `low` to `high`.
    pub const fn real(low: f64, high: f64) -> Legal {
        Legal::Real { low, high, open: [false; 2] }
    }

    /// Numbers above `low`, and `high` at most.
    pub const fn above(low: f64, high: f64) -> Legal {
        Legal::Real { low, high, open: [true, false] }
    }

    /// Numbers from `low`, and below `high`.
    pub const fn below(low: f64, high: f64) -> Legal {
        Legal::Real { low, high, open: [false, true] }
    }

    /// Finite numbers.
    pub const fn finite() -> Legal {
        Legal::real(f64::MIN, f64::MAX)
    }

    /// One of some names.
    pub fn names<'a>(names: impl IntoIterator<Item = &'a str>) -> Legal {
        Legal::OneOf(names.into_iter().map(|name| Value::Text(name.to_owned())).collect())
    }

    /// The range in words with its unit, which a single value does not have.
    pub fn of(&self, unit: &str) -> String {
        let range = self.to_string();
        match self {
            _ if unit.is_empty() => range,
            Legal::Whole { low, high } if low == high => range,
            Legal::OneOf(values) if values.len() < 2 => range,
            Legal::Anything => range,
            Legal::Real { .. } if range.starts_with(FINITE) => {
                range.replacen(FINITE, &format!("{FINITE} of {unit}"), 1)
            }
            _ => format!("{range} {unit}"),
        }
    }

    /// Whether a value is legal.
    pub fn contains(&self, value: &Value) -> bool {
        self.first_outside(value).is_none()
    }

    /// The first value that is not legal, with its place in the lists that it is in.
    pub fn first_outside<'a>(&self, value: &'a Value) -> Option<(Vec<usize>, &'a Value)> {
        if let Value::List(values) = value {
            return values.iter().enumerate().find_map(|(i, value)| {
                let (mut path, value) = self.first_outside(value)?;
                path.insert(0, i);
                Some((path, value))
            });
        }
        let legal = match (self, value) {
            (Legal::Anything, _) | (_, Value::Absent) => true,
            (Legal::Whole { low, high }, Value::Whole(whole)) => (low..=high).contains(&whole),
            (Legal::Whole { .. }, _) => false,
            (&Legal::Real { low, high, open }, _) => value.number().is_some_and(|number| {
                (low..=high).contains(&number) && !(open[0] && number == low) && !(open[1] && number == high)
            }),
            (Legal::OneOf(values), _) => values.contains(value),
        };
        (!legal).then(|| (Vec::new(), value))
    }

    /// The legal value nearest to a value; absent where none is legal.
    pub fn nearest(&self, value: &Value) -> Value {
        if let Value::List(values) = value {
            return Value::List(values.iter().map(|value| self.nearest(value)).collect());
        }
        if self.contains(value) {
            return value.clone();
        }
        match self {
            Legal::Anything => value.clone(),
            &Legal::Whole { low, high } => Value::Whole(match value {
                Value::Whole(whole) => (*whole).clamp(low, high),
                // A number that is not whole is no farther from its floor's neighbours than from other whole numbers.
                other => (other.number().unwrap_or_default().round() as i128).clamp(low, high),
            }),
            &Legal::Real { low, high, open } => {
                let first = if open[0] { low.next_up() } else { low };
                let last = if open[1] { high.next_down() } else { high };
                let number = value.number().filter(|number| !number.is_nan()).unwrap_or_default();
                Value::Real(number.clamp(first, last))
            }
            Legal::OneOf(values) => nearest_of(values, value),
        }
    }
}

/// The nearest of some values: by distance of numbers, by likeness of names, else the first.
fn nearest_of(values: &[Value], value: &Value) -> Value {
    let texts =
        values.iter().filter_map(|known| if let Value::Text(text) = known { Some(text.as_str()) } else { None });
    let nearest = match value {
        Value::Text(unknown) => nearest_name(unknown, texts).map(|name| Value::Text(name.to_owned())),
        _ => value.number().and_then(|number| {
            let distance = |known: &&Value| known.number().map_or(f64::INFINITY, |known| (known - number).abs());
            values.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).cloned()
        }),
    };
    nearest.or_else(|| values.first().cloned()).unwrap_or(Value::Absent)
}

/// What a range without one of its ends is called.
const FINITE: &str = "a finite number";

/// A number as short as can be.
fn short(number: f64) -> String {
    if is_long(number) { format!("{number:e}") } else { number.to_string() }
}

impl fmt::Display for Legal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Legal::Anything => f.write_str("anything"),
            Legal::Whole { low, high } if low == high => write!(f, "only {low}"),
            Legal::Whole { low, high } if *high == i64::MAX.into() => write!(f, "{low} and up"),
            Legal::Whole { low, high } => write!(f, "{low} to {high}"),
            &Legal::Real { low, high, open } => match (low == f64::MIN, high == f64::MAX) {
                (true, true) => f.write_str(FINITE),
                (true, false) => {
                    write!(f, "{FINITE} {} {}", if open[1] { "below" } else { "up to" }, short(high))
                }
                (false, true) if open[0] => write!(f, "{FINITE} above {}", short(low)),
                (false, true) => write!(f, "{FINITE} from {} up", short(low)),
                (false, false) => {
                    let low = short(low);
                    let low = if open[0] { format!("above {low} and") } else { low };
                    let to = match open {
                        [false, false] => "to",
                        [false, true] => "to below",
                        [true, false] => "at most",
                        [true, true] => "below",
                    };
                    write!(f, "{low} {to} {}", short(high))
                }
            },
            Legal::OneOf(values) if values.is_empty() => f.write_str("none"),
            Legal::OneOf(values) if values.len() == 1 => write!(f, "only {}", values[0]),
            Legal::OneOf(values) => {
                let values: Vec<String> = values.iter().map(Value::to_string).collect();
                write!(f, "one of {}", values.join(", "))
            }
        }
    }
}

impl Serialize for Legal {
    /// An object: `low` and `high` with `low_open` and `high_open` of numbers, `one_of` of choices, nothing where anything is legal.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        match self {
            Legal::Anything => {}
            Legal::Whole { low, high } => {
                map.serialize_entry("low", low)?;
                map.serialize_entry("high", high)?;
            }
            Legal::Real { low, high, open } => {
                map.serialize_entry("low", low)?;
                map.serialize_entry("high", high)?;
                map.serialize_entry("low_open", &open[0])?;
                map.serialize_entry("high_open", &open[1])?;
            }
            Legal::OneOf(values) => map.serialize_entry("one_of", values)?,
        }
        map.end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Field;

    #[test]
    fn ends_are_in_or_out_as_they_say() {
        let whole = Legal::whole(1, 4096);
        assert!([1, 2, 4096].iter().all(|&n| whole.contains(&Value::Whole(n))));
        assert!([0, 4097].iter().all(|&n| !whole.contains(&Value::Whole(n))));
        for (legal, low, high) in [
            (Legal::real(0.0, 1.0), true, true),
            (Legal::above(0.0, 1.0), false, true),
            (Legal::below(0.0, 1.0), true, false),
        ] {
            let at = |number: f64| legal.contains(&Value::Real(number));
            assert_eq!((at(0.0), at(1.0)), (low, high), "{legal}");
            assert!(at(0.5) && !at(-1e-300) && !at(1_f64.next_up()) && !at(f64::NAN), "{legal}");
        }
        assert!(!Legal::finite().contains(&Value::Real(f64::INFINITY)));
    }

    #[test]
    fn the_nearest_is_legal_and_no_other_is_nearer() {
        let near = |legal: &Legal, value: Value| {
            let nearest = legal.nearest(&value);
            assert!(legal.contains(&nearest), "{nearest} in {legal}");
            nearest
        };
        let whole = Legal::whole(-3, 7);
        assert_eq!([-9, -3, 2, 8].map(|n| near(&whole, Value::Whole(n))), [-3, -3, 2, 7].map(Value::Whole));
        assert_eq!(near(&whole, Value::Real(2.6)), Value::Whole(3));
        let half_open = Legal::below(0.0, 1.0);
        assert_eq!(
            [-1.0, 0.3, 1.0].map(|x| near(&half_open, x.value())),
            [0.0, 0.3, 1_f64.next_down()].map(Value::Real)
        );
        assert_eq!(near(&Legal::above(0.0, 1.0), 0.0.value()), Value::Real(0_f64.next_up()));
        let bursts = Legal::OneOf([1, 2, 4, 8].map(Value::Whole).to_vec());
        assert_eq!([0, 3, 7, 99].map(|n| near(&bursts, Value::Whole(n))), [1, 2, 8, 8].map(Value::Whole));
        let names = Legal::names(["rows", "blocks"]);
        assert_eq!(
            ["row", "Block", "qqq"].map(|n| near(&names, n.to_owned().value())),
            ["rows", "blocks", "rows"].map(|n| n.to_owned().value())
        );
        assert_eq!(near(&Legal::OneOf(vec![]), Value::Whole(3)), Value::Absent);
        assert_eq!(near(&half_open, [-1.0, 0.5].value()), [0.0, 0.5].value());
    }

    #[test]
    fn ranges_are_short() {
        for (legal, text) in [
            (Legal::whole(1, 4096), "1 to 4096"),
            (Legal::whole(1, 1), "only 1"),
            (Legal::whole(0, i64::MAX.into()), "0 and up"),
            (Legal::below(0.0, 1.0), "0 to below 1"),
            (Legal::above(0.0, 1000.0), "above 0 and at most 1000"),
            (Legal::above(0.0, f64::MAX), "a finite number above 0"),
            (Legal::real(1.0, 1e15), "1 to 1e15"),
            (Legal::real(0.0, f64::MAX), "a finite number from 0 up"),
            (Legal::finite(), "a finite number"),
            (Legal::OneOf([1, 2, 4, 8].map(Value::Whole).to_vec()), "one of 1, 2, 4, 8"),
            (Legal::OneOf(vec![Value::Whole(16)]), "only 16"),
            (Legal::OneOf(vec![]), "none"),
        ] {
            assert_eq!(legal.to_string(), text);
        }
    }
}
