//! Widths and ranges as text that is read by people in a data sheet and evaluated by the program: `2^S - 1`.
//!
//! ```text
//! sum     = product { ('+' | '-') product }
//! product = power { ('*' | '/') power }
//! power   = atom [ '^' atom ]
//! atom    = number | name | '-' atom | '(' sum ')' | ('min' | 'max' | 'log2') '(' sum { ',' sum } ')'
//! ```
//! `/` rounds down, `log2` is the logarithm rounded up.

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("in the expression \"{text}\": {what}")]
pub struct ExpressionError {
    /// The expression.
    pub text: String,
    /// What is wrong.
    pub what: String,
}

/// The value of an expression, with names as `value_of` gives them.
///
/// # Errors
/// A text that is no expression, a name without a value, a division by 0, a value outside of 127 bits.
pub fn evaluate(text: &str, value_of: &impl Fn(&str) -> Option<i128>) -> Result<i128, ExpressionError> {
    let mut reader = Reader { rest: text, value_of };
    let value = reader.sum().and_then(|value| match reader.peek() {
        None => Ok(value),
        Some(letter) => Err(format!("\"{letter}\" is not expected")),
    });
    value.map_err(|what| ExpressionError { text: text.into(), what })
}

struct Reader<'a, F> {
    rest: &'a str,
    value_of: &'a F,
}

type Step = Result<i128, String>;

fn held(value: Option<i128>) -> Step {
    value.ok_or_else(|| "the value does not fit".to_owned())
}

impl<F: Fn(&str) -> Option<i128>> Reader<'_, F> {
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    fn take(&mut self, letter: char) -> bool {
        let found = self.peek() == Some(letter);
        if found {
            self.rest = &self.rest[letter.len_utf8()..];
        }
        found
    }

    fn expect(&mut self, letter: char) -> Result<(), String> {
        if self.take(letter) { Ok(()) } else { Err(format!("\"{letter}\" is missing")) }
    }

    fn sum(&mut self) -> Step {
        let mut value = self.product()?;
        loop {
            if self.take('+') {
                value = held(value.checked_add(self.product()?))?;
            } else if self.take('-') {
                value = held(value.checked_sub(self.product()?))?;
            } else {
                return Ok(value);
            }
        }
    }

    fn product(&mut self) -> Step {
        let mut value = self.power()?;
        loop {
            if self.take('*') {
                value = held(value.checked_mul(self.power()?))?;
            } else if self.take('/') {
                value = held(value.checked_div_euclid(self.power()?))?;
            } else {
                return Ok(value);
            }
        }
    }

    fn power(&mut self) -> Step {
        let base = self.atom()?;
        if !self.take('^') {
            return Ok(base);
        }
        let exponent = self.atom()?;
        held(u32::try_from(exponent).ok().and_then(|exponent| base.checked_pow(exponent)))
    }

    fn atom(&mut self) -> Step {
        if self.take('-') {
            return held(self.power()?.checked_neg());
        }
        if self.take('(') {
            let value = self.sum()?;
            self.expect(')')?;
            return Ok(value);
        }
        self.peek();
        let end = self.rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_')).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        if let Ok(number) = word.parse() {
            return Ok(number);
        }
        match word {
            "" => Err("a value is missing".into()),
            "min" | "max" | "log2" => self.function(word),
            name => (self.value_of)(name).ok_or_else(|| format!("\"{name}\" has no value")),
        }
    }

    fn function(&mut self, name: &str) -> Step {
        self.expect('(')?;
        let mut value = self.sum()?;
        while self.take(',') {
            let other = self.sum()?;
            value = if name == "min" { value.min(other) } else { value.max(other) };
        }
        self.expect(')')?;
        if name == "log2" {
            return Ok(i128::from(128 - (value.max(1) - 1).leading_zeros()));
        }
        Ok(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<i128, ExpressionError> {
        evaluate(text, &|name| (name == "S").then_some(16))
    }

    #[test]
    fn expressions_have_their_values() {
        let expected = [
            ("2^S - 1", 65535),
            ("-(2^S)", -65536),
            ("-2^3", -8),
            ("3 * S + 2 * (S - 1)", 78),
            ("max(S + 1 - 17, 0)", 0),
            ("min(3, S, 5)", 3),
            ("log2(8) + log2(9) + log2(1)", 7),
            ("7 / 2 - 1", 2),
            ("10 - 3 - 2", 5),
        ];
        for (text, number) in expected {
            assert_eq!(value(text), Ok(number), "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_told() {
        for (text, what) in [
            ("2 +", "a value is missing"),
            ("X", "\"X\" has no value"),
            ("(2", "\")\" is missing"),
            ("2 2", "\"2\" is not expected"),
            ("1 / 0", "the value does not fit"),
            ("2^200", "the value does not fit"),
        ] {
            assert_eq!(value(text).unwrap_err().what, what, "{text}");
        }
    }
}
