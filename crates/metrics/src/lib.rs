//! How far a picture is from its reference, how far a gradient is from the true normal, and which
//! settings are worth their time.
//!
//! - [`compare`] measures two [`Picture`](cube3_picture::Picture)s, over the whole image and over the object's footprint;
//! - [`mean_angle_deg`] measures gradients;
//! - [`difference`] makes the magnified difference picture;
//! - [`front`] picks the points of a work-precision diagram that no other point beats.
//!
//! Every sum is compensated and taken in the order of the input, so a result depends on the input
//! alone: not on threads, and, but for the sign of a bias, not on which of two pictures comes first.

mod angle;
mod compensated;
mod difference;
mod error;
mod footprint;
mod front;
mod image_error;

pub use angle::{AngleError, mean_angle_deg};
pub use difference::{difference, suggested_factor};
pub use error::MetricsError;
pub use footprint::footprint;
pub use front::{WorkPrecision, front};
pub use image_error::{ImageComparison, ImageError, OFF_THRESHOLD, compare};
