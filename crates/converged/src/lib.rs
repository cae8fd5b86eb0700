//! The ray integral itself, to a tolerance that is asked for, with a proven bound for each pixel.
//!
//! What [`image_order`](cube3_reference::image_order()) comes to as its steps become short: the ground that every error stands on. Inside of a cell a
//! trilinear field is a cubic along the ray, and so is each component of the gradient; between the places where anything bends the integrand
//! is analytic, and Gauss and Legendre's rule has an error that a bound on it in the complex plane gives.
//!
//! ```text
//!   pixel ─► ray ─► pieces, one a cell ─► parts, split where anything bends ─► discs ─► rule with a bound ─► sum, bound
//!                       cell                  stretches, polynomial           disc, optics    gauss            ray
//! ```
//! The derivation stands in the book, page *Converged*.

#![warn(missing_docs)]

mod cell;
mod converged;
mod disc;
mod enclosure;
mod gauss;
mod known;
mod method;
mod optics;
mod part;
mod polynomial;
mod quadrature;
mod ray;
mod stretches;

pub use converged::{ConvergedOptions, ConvergedRendering, TOLERANCES, converged};
pub use enclosure::{Range, enclosure};
pub use method::{CONVERGED, TOLERANCE};
