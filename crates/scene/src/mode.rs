//! How the samples along a ray become a pixel.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::SceneError;

/// How the samples along a ray become a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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
    pub const ALL: [Mode; 6] =
        [Mode::Composite, Mode::FirstOpaque, Mode::LastOpaque, Mode::Maximum, Mode::Minimum, Mode::WeightedSum];

    /// Every mode with its name in files and on the command line, in the same order.
    pub const NAMES: [(Mode, &'static str); 6] = [
        (Mode::Composite, "composite"),
        (Mode::FirstOpaque, "first-opaque"),
        (Mode::LastOpaque, "last-opaque"),
        (Mode::Maximum, "maximum"),
        (Mode::Minimum, "minimum"),
        (Mode::WeightedSum, "weighted-sum"),
    ];

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
    pub const fn name(self) -> &'static str {
        Mode::NAMES[self as usize].1
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Mode {
    type Err = SceneError;

    /// The mode called `name`, in kebab case.
    fn from_str(name: &str) -> Result<Self, SceneError> {
        Mode::ALL.into_iter().find(|mode| mode.name() == name).ok_or_else(|| {
            SceneError::at(
                "mode",
                format!("there is no mode `{name}`"),
                format!("give one of {}", Mode::ALL.map(Mode::name).join(", ")),
            )
        })
    }
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
