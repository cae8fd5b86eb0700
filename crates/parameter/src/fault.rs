//! A value that is not legal, and what to say of it.

use crate::locate::value_of;
use crate::{Legal, Parameter, Value};
use serde::de::DeserializeOwned;
use std::fmt;
use toml::de::DeTable;

/// A parameter whose value is not legal.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The key, with the places in the lists that the value is in.
    pub key: String,
    /// The value.
    pub value: Value,
    /// What would be legal.
    pub legal: Legal,
    /// The legal value that is nearest.
    pub nearest: Value,
    /// The unit of value and range; may be empty.
    pub unit: &'static str,
    /// Why the range is what it is; may be empty.
    pub because: &'static str,
}

impl std::error::Error for Fault {}

/// Whether the values of all rows are legal.
///
/// # Errors
/// The first that is not.
pub fn check<T>(table: &[Parameter<T>], of: &T) -> Result<(), Box<Fault>> {
    table.iter().try_for_each(|row| row.check(of))
}

/// What is wrong with a number that its field cannot hold, such as one below 0: that it is out of range, in the `T` that the text makes
/// without it. None where it is no number, or in range.
pub fn number_fault<T: DeserializeOwned + Default>(
    table: &[Parameter<T>],
    text: &str,
    document: &DeTable,
    key: &str,
) -> Option<Fault> {
    let row = table.iter().find(|row| key.split('[').next() == Some(row.key))?;
    let value = Value::of_toml(value_of(document, row.key)?)?;
    value.number()?;
    let of = without(text, row.key).unwrap_or_default();
    check(table, &of).ok()?;
    row.fault(&of, &value)
}

/// What a text makes without one of its keys.
fn without<T: DeserializeOwned>(text: &str, key: &str) -> Option<T> {
    let mut rest: toml::Table = text.parse().ok()?;
    let (sections, name) = key.rsplit_once('.').unwrap_or(("", key));
    let mut sections = sections.split('.').filter(|section| !section.is_empty());
    sections.try_fold(&mut rest, |table, section| table.get_mut(section)?.as_table_mut())?.remove(name);
    T::deserialize(rest).ok()
}

impl<T> Parameter<T> {
    /// Whether the value is legal.
    ///
    /// # Errors
    /// The value, or the first of a list, that is not.
    pub fn check(&self, of: &T) -> Result<(), Box<Fault>> {
        self.fault(of, &(self.get)(of)).map_or(Ok(()), |fault| Err(Box::new(fault)))
    }

    /// What is wrong with a value of this parameter, where the rest is as it is; none where it is legal.
    pub fn fault(&self, of: &T, value: &Value) -> Option<Fault> {
        let legal = (self.legal)(of);
        let (path, value) = legal.first_outside(value)?;
        let (key, value, nearest) = (place(self.key, &path), value.clone(), legal.nearest(value));
        Some(Fault { key, value, legal, nearest, unit: self.unit, because: self.because })
    }
}

/// A key with places in its lists: first for each `[]`, the rest behind it.
fn place(key: &str, path: &[usize]) -> String {
    let mut path = path.iter();
    let mut parts = key.split("[]");
    let mut place = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        place += &path.next().map_or_else(|| "[]".to_owned(), |i| format!("[{i}]"));
        place += part;
    }
    path.fold(place, |place, i| format!("{place}[{i}]"))
}

impl Fault {
    /// What is wrong: `0 is outside 1 to 4096`.
    pub fn reason(&self) -> String {
        let Fault { value, legal, because, .. } = self;
        let because = if because.is_empty() { String::new() } else { format!(" ({because})") };
        let range = legal.of(self.unit);
        let reason = match legal {
            Legal::OneOf(values) if values.is_empty() => format!("{value} cannot be chosen here"),
            Legal::OneOf(values) if values.len() == 1 => format!("{value} is not {}", values[0]),
            Legal::Whole { low, high } if low == high => format!("{value} is not {low}"),
            Legal::Whole { .. } if !matches!(value, Value::Whole(_)) => {
                format!("{value} is not a whole number, {range}")
            }
            Legal::OneOf(_) | Legal::Real { open: [true, _], .. } => format!("{value} is not {range}"),
            Legal::Real { low, high, .. } if *low == f64::MIN || *high == f64::MAX => format!("{value} is not {range}"),
            _ => format!("{value} is outside {range}"),
        };
        reason + &because
    }

    /// What would be right: `the nearest legal value is 1`.
    pub fn remedy(&self) -> String {
        match (&self.nearest, &self.legal) {
            (Value::Absent, _) => "leave it out".to_owned(),
            _ if matches!(self.value, Value::Real(value) if value.is_nan()) => "give a number".to_owned(),
            (Value::Real(nearest), _) if nearest.abs() == f64::MAX => "give a finite number".to_owned(),
            (Value::Real(nearest), Legal::Real { low, open: [true, _], .. }) if *nearest == low.next_up() => {
                format!("the nearest legal value is just above {low}")
            }
            (Value::Real(nearest), Legal::Real { high, open: [_, true], .. }) if *nearest == high.next_down() => {
                format!("the nearest legal value is just below {high}")
            }
            (nearest, _) => format!("the nearest legal value is {nearest}"),
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {}; {}", self.key, self.reason(), self.remedy())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{each, parameter};

    struct Shop {
        lamps: u32,
        height: f64,
        rows: Vec<[f64; 2]>,
    }

    const TABLE: [Parameter<Shop>; 3] = [
        Parameter {
            because: "as many as `rows` has",
            legal: |shop| Legal::whole(0, shop.rows.len() as i128),
            ..parameter!(Shop, lamps, "", "lamps", "ours")
        },
        Parameter { legal: |_| Legal::above(0.0, 4.0), ..parameter!(Shop, height, "metres", "height", "ours") },
        Parameter {
            key: "row[].light",
            legal: |_| Legal::real(0.0, 1.0),
            get: |shop| each(&shop.rows, |row| row),
            ..parameter!(Shop, height, "", "light", "ours")
        },
    ];

    #[test]
    fn a_fault_names_key_value_range_reason_and_the_nearest() {
        let shop = |lamps, height, light| Shop { lamps, height, rows: vec![[0.5, 0.5], [0.5, light]] };
        check(&TABLE, &shop(2, 4.0, 1.0)).unwrap();
        let message = |shop: Shop| check(&TABLE, &shop).unwrap_err().to_string();
        assert_eq!(
            message(shop(3, 1.0, 0.0)),
            "lamps = 3 is outside 0 to 2 (as many as `rows` has); the nearest legal value is 2"
        );
        assert_eq!(
            message(shop(0, 0.0, 0.0)),
            "height = 0.0 is not above 0 and at most 4 metres; the nearest legal value is just above 0"
        );
        assert_eq!(
            message(shop(0, 5.0, 0.0)),
            "height = 5.0 is not above 0 and at most 4 metres; the nearest legal value is 4.0"
        );
        assert_eq!(
            message(shop(0, 1.0, 1.5)),
            "row[1].light[1] = 1.5 is outside 0 to 1; the nearest legal value is 1.0"
        );
    }

    #[test]
    fn a_fault_says_what_kind_of_range_it_is() {
        let reason = |legal: Legal, value: Value| {
            let nearest = legal.nearest(&value);
            Fault { key: "key".into(), value, legal, nearest, unit: "metres", because: "" }.reason()
        };
        let one_of = |values: &[i128]| Legal::OneOf(values.iter().copied().map(Value::Whole).collect());
        for (legal, value, expected) in [
            (Legal::whole(1, 9), Value::Whole(0), "0 is outside 1 to 9 metres"),
            (Legal::whole(1, 9), Value::Real(2.5), "2.5 is not a whole number, 1 to 9 metres"),
            (Legal::whole(1, 1), Value::Whole(2), "2 is not 1"),
            (one_of(&[1, 2]), Value::Whole(3), "3 is not one of 1, 2 metres"),
            (one_of(&[1]), Value::Whole(3), "3 is not 1"),
            (one_of(&[]), Value::Whole(3), "3 cannot be chosen here"),
            (Legal::finite(), Value::Real(f64::INFINITY), "inf is not a finite number of metres"),
            (Legal::above(0.0, f64::MAX), Value::Real(0.0), "0.0 is not a finite number of metres above 0"),
        ] {
            assert_eq!(reason(legal, value), expected);
        }
    }
}
