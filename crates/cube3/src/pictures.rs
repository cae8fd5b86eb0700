//! The pictures of a run, and how far they are from a reference.

use crate::{Error, Outcome, gradient_error};
use cube3_frame::{BasePlane, Geometry};
use cube3_host::{PictureFrames, warp_passes};
use cube3_inputs::LoadedVolume;
use cube3_method::Choice;
use cube3_metrics::{ImageError, compare, difference, footprint, suggested_factor};
use cube3_picture::{Picture, Rendering};
use cube3_report::{DigestReport, ErrorReport, sha256_hex};
use cube3_scene::Scene;

/// The pictures of a run; those that were not made are missing.
#[derive(Clone, Debug, Default)]
pub struct Pictures {
    /// The warped picture.
    pub image: Option<Picture>,
    /// The base plane over the background.
    pub base_plane: Option<Picture>,
    /// The reference.
    pub reference: Option<Picture>,
    /// Absolute difference, magnified.
    pub difference: Option<Picture>,
}

/// The picture and the base planes over the background, and their digests.
pub(crate) fn show(
    bases: &[BasePlane],
    frames: &PictureFrames,
    scene: &Scene,
    volume: &LoadedVolume,
) -> Outcome<(Pictures, DigestReport)> {
    let passes: Vec<(&BasePlane, &Geometry)> =
        bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
    let image = warp_passes(&passes, &frames.plane, volume.words.spacing, scene.background);
    let image = Picture::new(frames.plane.width, frames.plane.height, image)?;
    let digest = DigestReport {
        base_plane: Some(sha256_hex(&bases.iter().flat_map(bytes).collect::<Vec<u8>>())),
        image: Some(sha256_hex(&cube3_report::to_rgb8(&image))),
    };
    let base_plane = side_by_side(bases, scene.background)?;
    Ok((Pictures { image: Some(image), base_plane, ..Pictures::default() }, digest))
}

/// Columns of background between base planes.
const GAP: usize = 4;

/// All base planes in one picture, side by side over the background; none where there are none.
fn side_by_side(bases: &[BasePlane], background: [f64; 3]) -> Outcome<Option<Picture>> {
    let Some(height) = bases.iter().map(|base| base.height).max() else {
        return Ok(None);
    };
    let width = bases.iter().map(|base| base.width).sum::<usize>() + GAP * (bases.len() - 1);
    let mut pixels = vec![background; width * height];
    let mut left = 0;
    for base in bases {
        for (row, line) in base.over(background).chunks(base.width).enumerate() {
            pixels[row * width + left..][..base.width].copy_from_slice(line);
        }
        left += base.width + GAP;
    }
    Ok(Some(Picture::new(width, height, pixels)?))
}

/// Raw pixels of a base plane: each word as 32 bits, little-endian.
fn bytes(base: &BasePlane) -> Vec<u8> {
    base.pixels.iter().flatten().flat_map(|word| word.to_le_bytes()).collect()
}

/// The picture against its reference; both and their difference are then among the pictures.
pub(crate) fn measure(
    reference: &Choice,
    scene: &Scene,
    frames: &PictureFrames,
    volume: &LoadedVolume,
    rendering: Rendering,
    pictures: &mut Pictures,
) -> Outcome<ErrorReport> {
    let Rendering { picture, bound, .. } = rendering;
    let Some(image) = &pictures.image else {
        return Err(Error::NoPicture);
    };
    let object = footprint(image, &picture, scene.background)?;
    let comparison = compare(image, &picture, Some(&object))?;
    let factor = suggested_factor(comparison.whole.max);
    pictures.difference = Some(difference(image, &picture, f64::from(factor))?);
    pictures.reference = Some(picture);
    let mut error = ErrorReport::new(reference.to_string(), &comparison, f64::from(factor));
    error.reference_bound = bound.map(|bound| bound.into_iter().fold(0.0, f64::max));
    error.gradient_mean_deg = gradient_error::mean_angle_deg(&frames.setups, &volume.words);
    Ok(error)
}

/// The errors of a sequence's frame over the whole picture and over the object; none where neither picture shows one.
pub(crate) fn frame_errors(
    shown: &Pictures,
    reference: &Picture,
    background: [f64; 3],
) -> Outcome<[Option<ImageError>; 2]> {
    let image = shown.image.as_ref().ok_or(Error::NoPicture)?;
    let object = footprint(image, reference, background)?;
    let comparison = compare(image, reference, Some(&object))?;
    Ok([comparison.footprint.and(Some(comparison.whole)), comparison.footprint])
}
