//! How the surface of the material answers to light.

use serde::{Deserialize, Serialize};

/// The coefficients of the [`phong`](crate::phong()) model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Material {
    /// Whether samples are lit at all; if not, they have the colour of the transfer function.
    pub shaded: bool,
    /// The part of the sample's colour that needs no light, 0 to 1.
    pub ambient: f64,
    /// The part that is scattered evenly, 0 to 1.
    pub diffuse: f64,
    /// The part of the light that is mirrored, 0 to 1; it has the light's colour.
    pub specular: f64,
    /// The Phong exponent of the highlight: narrower as it grows; above 0, at most 1000.
    pub shininess: f64,
    /// Whether the back of a surface is lit as its front is.
    pub two_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Material { shaded: true, ambient: 0.1, diffuse: 0.7, specular: 0.2, shininess: 10.0, two_sided: true }
    }
}
