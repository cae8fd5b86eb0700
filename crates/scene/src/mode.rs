//! How the samples along a ray become a pixel.

use serde::{Deserialize, Serialize};
use strum::{Display, EnumString, IntoStaticStr, VariantArray};

use crate::SceneError;

/// How the samples along a ray become a pixel.
#[derive(
    Debug,
    Clone,
    Copy,
    PartialEq,
    Eq,
    Hash,
    Default,
    Serialize,
    Deserialize,
    Display,
    EnumString,
    IntoStaticStr,
    VariantArray,
)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case", parse_err_ty = SceneError, parse_err_fn = unknown)]
pub enum Mode {
    /// Front-to-back compositing of shaded, semi-transparent samples.
    #[default]
    Composite,
    /// The first sample whose opacity reaches `transfer.opaque_alpha`.
    FirstOpaque,
    /// The last sample whose opacity reaches `transfer.opaque_alpha`.
    LastOpaque,
    /// The sample of the largest value: maximum intensity projection.
    Maximum,
    /// The sample of the smallest value.
    Minimum,
    /// The sum of all samples, each weighted by its opacity: X-ray-like.
    WeightedSum,
}

impl Mode {
    /// Every mode, in the order of their declaration.
    pub const ALL: [Mode; Mode::VARIANTS.len()] = *Mode::VARIANTS.first_chunk().unwrap();

    /// The number of the mode in registers and vectors: its place in [`Mode::ALL`].
    pub const fn code(self) -> u32 {
        self as u32
    }

    /// Whether a pixel adds up what lies along its ray, so that each sample stands for a length.
    pub const fn adds_up(self) -> bool {
        matches!(self, Mode::Composite | Mode::WeightedSum)
    }

    /// Whether a pixel shows the largest or the smallest value along its ray.
    pub const fn chooses_a_value(self) -> bool {
        matches!(self, Mode::Maximum | Mode::Minimum)
    }

    /// The name of the mode in files and on the command line.
    pub fn name(self) -> &'static str {
        self.into()
    }
}

fn unknown(name: &str) -> SceneError {
    let known = Mode::ALL.map(Mode::name).join(", ");
    SceneError::at("mode", format!("there is no mode `{name}`"), format!("give one of {known}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_has_one_name_in_files_on_the_command_line_and_in_print() {
        for (code, mode) in Mode::ALL.into_iter().enumerate() {
            assert_eq!(mode.code() as usize, code);
            assert_eq!(mode.to_string().parse::<Mode>().unwrap(), mode);
            assert_eq!(serde_json::to_string(&mode).unwrap(), format!("\"{mode}\""));
        }
    }

    #[test]
    fn an_unknown_mode_names_the_known_ones() {
        let message = "mip".parse::<Mode>().unwrap_err().to_string();
        assert!(message.contains("`mip`") && message.contains("weighted-sum"), "{message}");
    }
}
