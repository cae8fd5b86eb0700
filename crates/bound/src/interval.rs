//! The values that a quantity may have.

use std::ops::{Add, Mul, Neg, Sub};

/// All values from `low` to `high`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The least.
    pub low: f64,
    /// The most.
    pub high: f64,
}

impl Interval {
    /// One value.
    pub const fn point(value: f64) -> Interval {
        Interval { low: value, high: value }
    }

    /// So much to either side of a value.
    pub fn around(value: f64, by: f64) -> Interval {
        Interval { low: value - by, high: value + by }
    }

    /// Whether there is one value.
    pub fn is_point(self) -> bool {
        self.low == self.high
    }

    /// The one in the middle.
    pub fn middle(self) -> f64 {
        f64::midpoint(self.low, self.high)
    }

    /// How far the ends are from the middle.
    pub fn radius(self) -> f64 {
        (self.high - self.low) / 2.0
    }

    /// So much more to either side.
    pub fn wider(self, by: f64) -> Interval {
        Interval { low: self.low - by, high: self.high + by }
    }

    /// The values of either, and all between.
    pub fn or(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.max(other.high) }
    }

    /// The least of a value of each.
    pub fn least(self, other: Interval) -> Interval {
        Interval { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    /// The most of a value of each.
    pub fn most(self, other: Interval) -> Interval {
        Interval { low: self.low.max(other.low), high: self.high.max(other.high) }
    }

    /// Each held between two ends.
    pub fn held(self, low: f64, high: f64) -> Interval {
        self.rising(|value| value.clamp(low, high))
    }

    /// A function that nowhere falls.
    pub fn rising(self, function: impl Fn(f64) -> f64) -> Interval {
        Interval { low: function(self.low), high: function(self.high) }
    }

    /// The magnitudes.
    pub fn magnitude(self) -> Interval {
        let low = if self.low <= 0.0 && self.high >= 0.0 { 0.0 } else { self.low.abs().min(self.high.abs()) };
        Interval { low, high: self.low.abs().max(self.high.abs()) }
    }

    /// Whether a value is one of them, or beyond an end by no more than `slack`.
    pub fn holds(self, value: f64, slack: f64) -> bool {
        (self.low - slack..=self.high + slack).contains(&value)
    }

    /// How far the farthest is from a value.
    pub fn reach(self, value: f64) -> f64 {
        (self.high - value).max(value - self.low)
    }

    /// `near·(1 − weight) + far·weight` for weights 0 to 1: linear in each, so its ends are at ends.
    pub fn between(near: Interval, far: Interval, weight: Interval) -> Interval {
        let [first, second] = [weight.low, weight.high].map(|weight| Interval {
            low: near.low + weight * (far.low - near.low),
            high: near.high + weight * (far.high - near.high),
        });
        first.or(second)
    }
}

impl Add for Interval {
    type Output = Interval;

    fn add(self, other: Interval) -> Interval {
        Interval { low: self.low + other.low, high: self.high + other.high }
    }
}

impl Neg for Interval {
    type Output = Interval;

    fn neg(self) -> Interval {
        Interval { low: -self.high, high: -self.low }
    }
}

impl Sub for Interval {
    type Output = Interval;

    fn sub(self, other: Interval) -> Interval {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Interval;

    fn mul(self, other: Interval) -> Interval {
        let products = [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        let [first, rest @ ..] = products.map(Interval::point);
        rest.into_iter().fold(first, Interval::or)
    }
}

impl Mul<f64> for Interval {
    type Output = Interval;

    fn mul(self, factor: f64) -> Interval {
        self * Interval::point(factor)
    }
}
