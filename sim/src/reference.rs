//! What a picture is measured against, and how far that itself is from the truth.

use crate::inputs::LoadedVolume;
use crate::problem::{Outcome, Problem};
use crate::progress::Progress;
use cube3_host::PictureFrames;
use cube3_machine::MachineSpec;
use cube3_metrics::{Picture, compare, footprint};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_report::{ErrorReport, ReferenceError};
use cube3_scene::Scene;
use cube3_twin::{DiscreteOptions, sheared, true_3d};
use std::str::FromStr;

/// What the picture is measured against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// Rays from image pixels, steps of one length, exact interpolation.
    ImageOrder {
        /// The length of a step, in units of the smallest voxel spacing.
        step_voxel: f64,
    },
    /// The machine's sample positions, exact interpolation.
    True,
    /// The machine's interpolation in reals.
    Sheared,
    /// Nothing.
    None,
}

/// Half a voxel: on the default head the reference's own error is then a tenth of the distance that it measures; at a voxel it is a third.
const STEP_VOXEL: f64 = 0.5;

/// Steps that can be asked for: shorter ones take minutes, and longer ones skip what they are to measure, also at half the step.
const STEPS: [f64; 2] = [0.002, 8.0];

impl Default for Reference {
    /// Image order in steps of half a voxel.
    fn default() -> Self {
        Reference::ImageOrder { step_voxel: STEP_VOXEL }
    }
}

impl Reference {
    /// The name on the command line and in reports; the step is in it where it is not half a voxel.
    pub fn name(self) -> String {
        match self {
            Reference::ImageOrder { step_voxel: STEP_VOXEL } => "image-order".into(),
            Reference::ImageOrder { step_voxel } => format!("image-order:{step_voxel}"),
            Reference::True => "true".into(),
            Reference::Sheared => "sheared".into(),
            Reference::None => "none".into(),
        }
    }
}

impl FromStr for Reference {
    type Err = String;

    /// The name, image-order with a step behind a colon.
    fn from_str(text: &str) -> Result<Self, String> {
        let (name, step) = text.split_once(':').map_or((text, None), |(name, step)| (name, Some(step)));
        let reference = match name {
            "image-order" => Reference::default(),
            "true" => Reference::True,
            "sheared" => Reference::Sheared,
            "none" => Reference::None,
            _ => return Err("known are image-order, image-order:STEP, true, sheared and none".into()),
        };
        match (reference, step) {
            (_, None) => Ok(reference),
            (Reference::ImageOrder { .. }, Some(step)) => match step.parse() {
                Ok(step_voxel) if (STEPS[0]..=STEPS[1]).contains(&step_voxel) => {
                    Ok(Reference::ImageOrder { step_voxel })
                }
                _ => Err(format!(
                    "'{step}' is no step for a reference: give {} to {} voxels, e.g. image-order:0.25",
                    STEPS[0], STEPS[1]
                )),
            },
            (_, Some(step)) => Err(format!("{name} takes no step; leave ':{step}' out")),
        }
    }
}

/// The references that take the machine's own sample positions know parallel ones only.
pub(crate) fn check_reference(reference: Reference, frames: &PictureFrames) -> Outcome<()> {
    match reference {
        Reference::True | Reference::Sheared if frames.eye_voxel.is_some() => Err(Problem::new(format!(
            "the reference \"{}\" is for parallel views; in perspective give \"image-order\" or \"none\"",
            reference.name()
        ))),
        _ => Ok(()),
    }
}

/// The reference's picture of a scene in the volume's own voxels, thickened. With `whole_steps` each sample at the machine's positions
/// stands for a whole step, as in the published machine.
pub(crate) fn reference_picture(
    reference: Reference,
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    frames: &PictureFrames,
    whole_steps: bool,
    progress: &Progress,
) -> Outcome<Picture> {
    let border = volume.words.window[0];
    let plane = &frames.plane;
    let geometry = frames.setups.first().map(|setup| &setup.geometry);
    let rows = match (reference, geometry) {
        (Reference::True | Reference::Sheared, Some(geometry)) => geometry.base_plane_size()[1],
        _ => plane.height,
    } as u64;
    let report = |done: u64| progress.set(done, rows);
    let discrete = DiscreteOptions { gradient: machine.abc.gradient, border, whole_steps };
    let (base, geometry) = match (reference, geometry) {
        (Reference::True, Some(geometry)) => {
            (true_3d(&volume.data, scene, geometry, &discrete, Some(&report))?, geometry)
        }
        (Reference::Sheared, Some(geometry)) => {
            (sheared(&volume.data, scene, geometry, &discrete, Some(&report))?, geometry)
        }
        (Reference::ImageOrder { step_voxel }, _) => {
            let options = ImageOrderOptions { step_voxel, border, ..ImageOrderOptions::default() };
            let rendering = image_order(&volume.data, scene, &options, Some(&report))?;
            return Ok(Picture::new(rendering.width, rendering.height, rendering.pixels)?);
        }
        _ => return Err(Problem::new("there is no frame to measure")),
    };
    let pixels = base.warp(geometry, plane, volume.data.spacing, scene.background);
    Ok(Picture::new(plane.width, plane.height, pixels)?)
}

/// Pixels each way of which one is cast at half the step.
const EVERY: usize = 4;

/// How far image order is from itself at half the step, over the object, on every fourth pixel each way; none for the other references,
/// whose samples are the machine's by definition, and where no such pixel shows the object.
pub(crate) fn reference_error(
    reference: Reference,
    scene: &Scene,
    volume: &LoadedVolume,
    picture: &Picture,
) -> Outcome<Option<ReferenceError>> {
    let Reference::ImageOrder { step_voxel } = reference else {
        return Ok(None);
    };
    let border = volume.words.window[0];
    let options = ImageOrderOptions { step_voxel: step_voxel / 2.0, border, every: EVERY, ..Default::default() };
    let half = image_order(&volume.data, scene, &options, None)?;
    let rows = picture.pixels.chunks(picture.width).step_by(EVERY);
    let some = rows.flat_map(|row| row.iter().step_by(EVERY).copied()).collect();
    let some = Picture::new(half.width, half.height, some)?;
    let half = Picture::new(half.width, half.height, half.pixels)?;
    let object = footprint(&some, &half, scene.background)?;
    let comparison = compare(&some, &half, Some(&object))?;
    Ok(comparison.footprint.map(|error| ReferenceError {
        step_voxel,
        against_step_voxel: step_voxel / 2.0,
        error,
        pixels: comparison.footprint_pixels,
    }))
}

/// The part of the distance between machine and reference from which on the reference's own error is not small beside it.
const SMALL: f64 = 0.25;

/// An error of the reference that nobody need know of: a tenth of a level of 255.
const NOTHING: f64 = 0.1 / 255.0;

/// What to say where the reference's own error is not small beside the distance that is measured with it.
pub(crate) fn note(own: Option<&ReferenceError>, measured: &ErrorReport) -> Option<String> {
    let distance = measured.footprint.error?.mean_relative;
    let own = own.filter(|own| own.error.mean_relative > (SMALL * distance).max(NOTHING))?;
    Some(format!(
        "the reference itself is {:.2} % from the same at half its step, over the object, and the picture is {:.2} % from the reference: \
         give --reference image-order:{}",
        100.0 * own.error.mean_relative,
        100.0 * distance,
        own.step_voxel / 4.0
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn references_have_names_and_image_order_a_step() {
        for (text, reference) in [
            ("image-order", Reference::ImageOrder { step_voxel: 0.5 }),
            ("image-order:1", Reference::ImageOrder { step_voxel: 1.0 }),
            ("image-order:0.25", Reference::ImageOrder { step_voxel: 0.25 }),
            ("true", Reference::True),
            ("sheared", Reference::Sheared),
            ("none", Reference::None),
        ] {
            assert_eq!(text.parse(), Ok(reference));
            assert_eq!(reference.name(), text);
        }
        for (text, message) in [
            ("image", "known are"),
            ("image-order:0", "give 0.002 to 8 voxels"),
            ("image-order:", "give 0.002 to 8 voxels"),
            ("image-order:inf", "give 0.002 to 8 voxels"),
            ("image-order:1000", "give 0.002 to 8 voxels"),
            ("true:0.5", "leave ':0.5' out"),
            ("none:1", "leave ':1' out"),
        ] {
            assert!(text.parse::<Reference>().unwrap_err().contains(message), "{text}");
        }
    }
}
