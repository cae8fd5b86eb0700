//! The lights.

use serde::{Deserialize, Serialize};

use crate::check::{self, Checked};

/// The most lights in a scene.
pub const MOST_LIGHTS: usize = 8;

/// A light so far away that it has one direction everywhere, or one at the eye.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Light {
    /// Towards the light, in world coordinates, of any length but 0; `None` puts it at the eye, where
    /// it stays as the view turns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Red, green and blue, 0 to 1.
    pub colour: [f64; 3],
}

impl Default for Light {
    /// White, at the eye.
    fn default() -> Self {
        Light { direction: None, colour: [1.0; 3] }
    }
}

impl Light {
    pub(crate) fn validate(&self, index: usize) -> Checked {
        let key = format!("light[{index}].direction");
        self.direction.map_or(Ok(()), |direction| check::direction(&key, direction))
    }
}
