//! Gradient, classification and shading of one sample. The definition.

mod counted;
mod gradient;
mod light;
mod normal;
mod sample;
mod tables;

pub use counted::{Counted, Neighbourhood};
pub use gradient::{Local, gradient, local_gradient, local_gradient_wires};
pub use light::{
    ReflectedLight, cued, cued_wires, halfway, lit, lit_wires, phong, phong_from, phong_wires, reflectance,
    reflectance_wires, view_vector,
};
pub(crate) use normal::magnitude;
pub use normal::{Normal, direction_index, direction_index_wires, normalise, normalise_wires};
pub use sample::{Shaded, Stages, behind_the_eye, shade, shade_wires};
pub use tables::{
    TableAddresses, class_of, classify, classify_in, classify_wires, end_class, in_place, opacity_class, reach,
    steps_to,
};
