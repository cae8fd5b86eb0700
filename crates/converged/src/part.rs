//! A part of a ray's piece, as polynomials of ζ from −1 to 1.

use crate::cell::Piece;
use crate::disc::Disc;
use crate::polynomial::{self, Cubic};
use glam::DVec3;

/// The polynomials of a part of a piece, in ζ from −1 to 1.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    /// Half its length.
    pub half: f64,
    pub value: Cubic,
    /// What rounding moves the value by.
    pub slack: f64,
    pub gradient: Option<PartGradient>,
    /// The factor of the depth cue in the middle, and half of its growth.
    pub cue: [f64; 2],
}

/// The gradient of a part.
#[derive(Clone, Debug)]
pub(crate) struct PartGradient {
    /// Divided by `scale`.
    pub along: [Cubic; 3],
    pub scale: f64,
    /// What rounding moves each component of the scaled gradient by.
    pub slack: [f64; 3],
    /// Its squared magnitude.
    pub square: [f64; 7],
}

impl PartGradient {
    fn new(along: [Cubic; 3], scale: f64, slack: [f64; 3]) -> PartGradient {
        let mut square = [0.0; 7];
        for component in &along {
            for (i, a) in component.iter().enumerate() {
                for (j, b) in component.iter().enumerate() {
                    square[i + j] += a * b;
                }
            }
        }
        PartGradient { along, scale, slack, square }
    }

    pub fn at(&self, x: f64) -> DVec3 {
        DVec3::from(self.along.map(|component| polynomial::at(&component, x)))
    }

    /// −g·d, what a light or a halfway vector meets before division by the magnitude.
    pub fn against(&self, direction: DVec3) -> Cubic {
        [0, 1, 2, 3].map(|k| -(0..3).map(|i| self.along[i][k] * direction[i]).sum::<f64>())
    }

    /// What rounding moves that product by.
    pub fn slack_against(&self, direction: DVec3) -> f64 {
        (0..3).map(|i| self.slack[i] * direction[i].abs()).sum::<f64>()
            + 4.0
                * f64::EPSILON
                * (0..3).map(|i| direction[i].abs() * self.along[i].iter().map(|c| c.abs()).sum::<f64>()).sum::<f64>()
    }

    /// What rounding moves the scaled gradient by, as a vector.
    pub fn moved(&self) -> f64 {
        self.slack.iter().sum()
    }

    /// Zero along the whole part.
    pub fn is_flat(&self) -> bool {
        self.square[0] == 0.0 && self.along.iter().flatten().all(|c| *c == 0.0)
    }

    /// The least and the largest magnitude of the scaled gradient, rounding counted.
    pub fn magnitudes(&self) -> [f64; 2] {
        let square = Disc::of_polynomial(&self.square, 1.0);
        let slack = 16.0 * f64::EPSILON * square.largest();
        let least = (square.mid - square.radius - slack).max(0.0).sqrt() - self.moved();
        [least.max(0.0), (square.largest() + slack).sqrt() + self.moved()]
    }
}

impl Part {
    /// The part of a piece between two places of it.
    pub fn of(piece: &Piece, [from, to]: [f64; 2]) -> Part {
        let (mid, half) = (f64::midpoint(from, to), (to - from) / 2.0);
        let gradient = piece.gradient.as_ref().map(|g| {
            PartGradient::new(g.along.map(|component| polynomial::about(&component, mid, half)), g.scale, g.slack)
        });
        let value = polynomial::about(&piece.value, mid, half);
        Part {
            half,
            slack: piece.slack + polynomial::slack(&value),
            value,
            gradient,
            cue: [piece.cue[0] + piece.cue[1] * mid, piece.cue[1] * half],
        }
    }

    /// Its length.
    pub fn length(&self) -> f64 {
        2.0 * self.half
    }
}
