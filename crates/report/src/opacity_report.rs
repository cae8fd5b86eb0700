//! How far the opacity table is from the transfer function that it stands for.

use serde::{Deserialize, Serialize};

use crate::ReportError;
use crate::error::finite;
use crate::fact::Fact;
use crate::quantity::{number, percentage};

/// The opacities of the machine's table against those of the scene, both corrected to the same step length, for the words that
/// voxels have. Samples between voxels take other entries too, which are not looked at. Fractions are of all voxels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct OpacityReport {
    /// Data values that one entry of the table covers.
    pub entry_width: f64,
    /// The least opacity above 0 that comes through the machine's words.
    pub smallest_opacity: f64,
    /// Voxels that the scene shows: with an opacity above 0, in modes of surfaces one that is opaque.
    pub shown_fraction: f64,
    /// Of these, voxels that the table does not show.
    pub lost_fraction: f64,
    /// Voxels whose opacity in the table is off by more than a tenth of the scene's.
    pub off_fraction: f64,
    /// Those of them that the word has more part in: the table against the scene in the middle of an entry.
    pub rounding: OpacityChange,
    /// Those that the width of entries has more part in: the scene in the middle of an entry against the scene at the voxel's value.
    /// The sums of a ray are over voxels that lie flat, with both neighbours along two axes in the same entry: elsewhere samples
    /// pass through an entry and the next ones, and what one loses another gains.
    pub entries: OpacityChange,
}

/// How far opacities that are off by more than a tenth are off.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct OpacityChange {
    /// Voxels with such an opacity, as a fraction of all voxels.
    pub fraction: f64,
    /// What the opacities of a mean ray through the volume miss in sum; in a weighted sum of its mean.
    pub ray_less: f64,
    /// What they have too much, likewise.
    pub ray_more: f64,
}

impl OpacityChange {
    /// The larger of what a mean ray misses and what it has too much.
    pub fn of_a_ray(&self) -> f64 {
        self.ray_less.max(self.ray_more)
    }
}

impl OpacityReport {
    pub(crate) fn check(&self) -> Result<(), ReportError> {
        let Self { rounding, entries, .. } = self;
        for (key, value) in [
            ("words.opacity.entry_width", self.entry_width),
            ("words.opacity.smallest_opacity", self.smallest_opacity),
            ("words.opacity.shown_fraction", self.shown_fraction),
            ("words.opacity.lost_fraction", self.lost_fraction),
            ("words.opacity.off_fraction", self.off_fraction),
            ("words.opacity.rounding.fraction", rounding.fraction),
            ("words.opacity.rounding.ray_less", rounding.ray_less),
            ("words.opacity.rounding.ray_more", rounding.ray_more),
            ("words.opacity.entries.fraction", entries.fraction),
            ("words.opacity.entries.ray_less", entries.ray_less),
            ("words.opacity.entries.ray_more", entries.ray_more),
        ] {
            finite(key, value)?;
        }
        Ok(())
    }

    /// The table in a line.
    pub(crate) fn fact(&self) -> Fact {
        let off = match self.off_fraction {
            0.0 => "none off by more than a tenth".into(),
            off => format!("{} off by more than a tenth, {} lost", percentage(off), percentage(self.lost_fraction)),
        };
        let (shown, wide) = (percentage(self.shown_fraction), number(self.entry_width));
        ("Opacity table", format!("{wide} data values an entry; {shown} of the voxels shown, {off}"))
    }
}
