//! The fields that rows read and set: how a type of Rust becomes a [`Value`] and back.

use crate::{Choice, Legal, Value, named, names};
use std::fmt;
use std::path::PathBuf;

/// What kind of value a parameter has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueKind {
    /// True or false.
    Flag,
    /// A whole number.
    Whole,
    /// A number.
    Real,
    /// One of a few names.
    Choice,
    /// Text.
    Text,
    /// Several of a kind.
    List(&'static ValueKind),
}

impl fmt::Display for ValueKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ValueKind::Flag => "flag",
            ValueKind::Whole => "whole number",
            ValueKind::Real => "number",
            ValueKind::Choice => "name",
            ValueKind::Text => "text",
            ValueKind::List(of) => return write!(f, "list: {of}"),
        })
    }
}

/// A value that a field cannot hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{value} is no {kind}{}", if *optional { ", and not absent" } else { "" })]
pub struct Unfit {
    /// The value.
    pub value: Value,
    /// What the field holds.
    pub kind: ValueKind,
    /// Whether it may be absent.
    pub optional: bool,
}

/// A type of a field.
pub trait Field: Sized {
    /// The kind of its values.
    const KIND: ValueKind;
    /// Whether it may be absent.
    const OPTIONAL: bool = false;
    /// What of its kind is legal, whatever it is a field of: of a choice, its names.
    fn legal() -> Legal {
        Legal::Anything
    }
    /// The value of a field.
    fn value(&self) -> Value;
    /// The field of a value; none where the type cannot hold it.
    fn of(value: &Value) -> Option<Self>;
}

/// Sets a field.
///
/// # Errors
/// A value that it cannot hold.
pub fn assign<F: Field>(field: &mut F, value: &Value) -> Result<(), Unfit> {
    let unfit = || Unfit { value: value.clone(), kind: F::KIND, optional: F::OPTIONAL };
    *field = F::of(value).ok_or_else(unfit)?;
    Ok(())
}

/// One field of every element of a list, as a list.
pub fn each<E, F: Field>(elements: &[E], field: fn(&E) -> &F) -> Value {
    Value::List(elements.iter().map(|element| field(element).value()).collect())
}

/// Sets one field of every element of a list.
///
/// # Errors
/// A list of another length, and values that the field cannot hold. Then nothing is set behind the first of these.
pub fn assign_each<E, F: Field>(elements: &mut [E], field: fn(&mut E) -> &mut F, value: &Value) -> Result<(), Unfit> {
    match value {
        Value::List(values) if values.len() == elements.len() => {
            elements.iter_mut().zip(values).try_for_each(|(element, value)| assign(field(element), value))
        }
        _ => Err(Unfit { value: value.clone(), kind: ValueKind::List(&F::KIND), optional: false }),
    }
}

/// The kind of the field that a function gives.
pub const fn kind<T, F: Field>(_: fn(&T) -> &F) -> ValueKind {
    F::KIND
}

/// The kind of the list of the field that a function gives, over elements.
pub const fn kind_of_each<E, F: Field>(_: fn(&E) -> &F) -> ValueKind {
    ValueKind::List(&F::KIND)
}

/// Whether the field that a function gives may be absent.
pub const fn optional<T, F: Field>(_: fn(&T) -> &F) -> bool {
    F::OPTIONAL
}

/// What is legal for the field that a function gives, whatever it is a field of.
pub fn legal<T, F: Field>(_: fn(&T) -> &F) -> Legal {
    F::legal()
}

macro_rules! whole {
    ($($type:ty),+) => {$(
        impl Field for $type {
            const KIND: ValueKind = ValueKind::Whole;
            fn value(&self) -> Value {
                Value::Whole(*self as i128)
            }
            fn of(value: &Value) -> Option<Self> {
                match value {
                    Value::Whole(whole) => (*whole).try_into().ok(),
                    _ => None,
                }
            }
        }
    )+};
}

whole!(u32, u64, usize, i64);

impl Field for f64 {
    const KIND: ValueKind = ValueKind::Real;
    fn value(&self) -> Value {
        Value::Real(*self)
    }
    fn of(value: &Value) -> Option<Self> {
        value.number()
    }
}

impl Field for bool {
    const KIND: ValueKind = ValueKind::Flag;
    fn value(&self) -> Value {
        Value::Flag(*self)
    }
    fn of(value: &Value) -> Option<Self> {
        match value {
            Value::Flag(flag) => Some(*flag),
            _ => None,
        }
    }
}

impl Field for String {
    const KIND: ValueKind = ValueKind::Text;
    fn value(&self) -> Value {
        Value::Text(self.clone())
    }
    fn of(value: &Value) -> Option<Self> {
        match value {
            Value::Text(text) => Some(text.clone()),
            _ => None,
        }
    }
}

impl Field for PathBuf {
    const KIND: ValueKind = ValueKind::Text;
    /// What of the path is not Unicode is replaced.
    fn value(&self) -> Value {
        Value::Text(self.to_string_lossy().into_owned())
    }
    fn of(value: &Value) -> Option<Self> {
        String::of(value).map(PathBuf::from)
    }
}

impl<C: Choice> Field for C {
    const KIND: ValueKind = ValueKind::Choice;
    fn legal() -> Legal {
        Legal::names(names::<C>())
    }
    fn value(&self) -> Value {
        Value::Text(self.name().to_owned())
    }
    fn of(value: &Value) -> Option<Self> {
        named(value)
    }
}

impl<F: Field> Field for Option<F> {
    const KIND: ValueKind = F::KIND;
    const OPTIONAL: bool = true;
    fn legal() -> Legal {
        F::legal()
    }
    fn value(&self) -> Value {
        self.as_ref().map_or(Value::Absent, Field::value)
    }
    fn of(value: &Value) -> Option<Self> {
        if *value == Value::Absent { Some(None) } else { F::of(value).map(Some) }
    }
}

impl<F: Field + 'static> Field for Vec<F> {
    const KIND: ValueKind = ValueKind::List(&F::KIND);
    fn value(&self) -> Value {
        each(self, |element| element)
    }
    fn of(value: &Value) -> Option<Self> {
        match value {
            Value::List(values) => values.iter().map(F::of).collect(),
            _ => None,
        }
    }
}

impl<F: Field + 'static, const N: usize> Field for [F; N] {
    const KIND: ValueKind = ValueKind::List(&F::KIND);
    fn value(&self) -> Value {
        each(self, |element| element)
    }
    fn of(value: &Value) -> Option<Self> {
        Vec::of(value)?.try_into().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_takes_what_it_gives_and_refuses_what_it_cannot_hold() {
        let mut skew = [1_i64, -2, 3];
        let value = skew.value();
        assert_eq!(value, Value::List([1, -2, 3].map(Value::Whole).to_vec()));
        assign(&mut skew, &Value::List([4, 5, 6].map(Value::Whole).to_vec())).unwrap();
        assert_eq!(skew, [4, 5, 6]);
        assert!(assign(&mut skew, &Value::List(vec![Value::Whole(1)])).is_err());
        let mut count = 1_u32;
        assert_eq!(assign(&mut count, &Value::Whole(-1)).unwrap_err().to_string(), "-1 is no whole number");
        assert!(assign(&mut count, &Value::Absent).is_err());
        let mut clock = Some(3.0);
        assign(&mut clock, &Value::Absent).unwrap();
        assert_eq!(clock, None);
        assign(&mut clock, &Value::Whole(2)).unwrap();
        assert_eq!(clock, Some(2.0));
    }

    #[test]
    fn a_field_of_every_element_is_a_list_of_as_many() {
        let mut points = [[1.0, 2.0], [3.0, 4.0]];
        assert_eq!(each(&points, |point: &[f64; 2]| &point[1]), [2.0, 4.0].value());
        assign_each(&mut points, |point| &mut point[1], &[5.0, 6.0].value()).unwrap();
        assert_eq!(points, [[1.0, 5.0], [3.0, 6.0]]);
        assert!(assign_each(&mut points, |point| &mut point[1], &[5.0].value()).is_err());
    }
}
