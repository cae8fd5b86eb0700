//! Errors of pictures in levels of an 8-bit display.

use serde::Serialize;

/// Levels of an 8-bit display: errors of pictures are in 1/255.
pub const LEVELS: f64 = 255.0;

/// Error of a picture in levels of 1/255.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct ImageLevels {
    /// Mean distance in RGB over √3.
    pub mean: f64,
    /// Root of the mean square difference of a channel.
    pub rms: f64,
    /// Largest difference of a channel.
    pub max: f64,
}
