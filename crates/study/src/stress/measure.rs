//! A method's picture of a subject against the truth, pixel by pixel, with the bound of each pixel.

use super::subject::{Subject, WINDOW};
use cube3_bound::{Grains, Walk};
use cube3_converged::{ConvergedOptions, ConvergedRendering, Range, converged, enclosure};
use cube3_host::PictureFrames;
use cube3_inputs::{InputError, LoadedVolume};
use cube3_method::{Choice, Method, RenderError};
use cube3_picture::Picture;
use cube3_scene::Scene;
use std::time::Instant;

/// Tolerance of the truth.
const TOLERANCE: f64 = 1e-9;

/// What rounding of 64-bit reals adds to a bound.
const REALS: f64 = 1e-9;

/// Full scale: the bound of a picture of which nothing else is proved.
const FULL: f64 = 1.0;

/// Why a subject has no measure.
#[derive(Debug, thiserror::Error)]
pub enum StressError {
    /// The volume.
    #[error(transparent)]
    Input(#[from] InputError),
    /// The method, or the machine.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// The truth.
    #[error(transparent)]
    Truth(#[from] cube3_reference::RaycastError),
}

/// What pictures of a subject are held against.
pub struct Truth {
    /// The scene in the grid of the volume.
    pub scene: Scene,
    /// The volume.
    pub volume: LoadedVolume,
    /// The integral, where the mode is one.
    integral: Option<ConvergedRendering>,
    /// The machine's frames.
    frames: Option<PictureFrames>,
}

/// How far a picture is from the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The worst error of a channel, of full scale; none where the truth is not known.
    pub error: Option<f64>,
    /// The bound of that pixel.
    pub bound: f64,
    /// Whether every pixel is within its bound.
    pub kept: bool,
    /// Whether every channel is a number.
    pub finite: bool,
    /// Whether every channel is from 0 to 1.
    pub in_range: bool,
    /// Seconds that the picture took.
    pub seconds: f64,
}

impl Truth {
    /// Of a subject.
    ///
    /// # Errors
    /// A volume or a scene that is refused.
    pub fn new(subject: &Subject) -> Result<Truth, StressError> {
        let volume = subject.load()?;
        let scene = subject.scene.thickened(volume.single).into_owned();
        let integral = match scene.mode.adds_up() {
            true => {
                let options = ConvergedOptions { tolerance: TOLERANCE, border: volume.words.window[0], every: 1 };
                Some(converged(&volume.data, &scene, &options, None)?)
            }
            false => None,
        };
        let frames = cube3_host::picture_setup(&scene, &subject.machine, &volume.info(), true).ok();
        Ok(Truth { scene, volume, integral, frames })
    }

    /// The picture of a method, measured; [`Measure::error`] is none in the modes that choose a sample.
    ///
    /// # Errors
    /// What the method refuses.
    pub fn measure(&self, method: &'static Method, subject: &Subject) -> Result<Measure, StressError> {
        Ok(self.picture(method, subject)?.0)
    }

    /// As [`Truth::measure`], with the picture.
    ///
    /// # Errors
    /// What the method refuses.
    pub fn picture(&self, method: &'static Method, subject: &Subject) -> Result<(Measure, Picture), StressError> {
        let start = Instant::now();
        let of = cube3_method::Subject::new(&self.scene, &subject.machine, &self.volume);
        let rendering = Choice::of(method).render(&of, &|_, _, _| {})?;
        let seconds = start.elapsed().as_secs_f64();
        let picture = &rendering.picture;
        let channels = || picture.pixels.iter().flatten();
        let finite = channels().all(|c| c.is_finite());
        let in_range = channels().all(|c| (0.0..=1.0).contains(c));
        let mut measure = Measure { error: None, bound: FULL, kept: true, finite, in_range, seconds };
        if let Some(truth) = self.integral.as_ref().filter(|_| finite) {
            let bounds = match &rendering.bound {
                Some(own) => own.clone(),
                None => self.bounds(method, subject, &truth.picture),
            };
            measure.judge(picture, truth, &bounds);
        }
        Ok((measure, rendering.picture))
    }

    /// The most that each pixel of a method that takes samples may be from the integral: how far the ends of its enclosure are, and what words add.
    fn bounds(&self, method: &'static Method, subject: &Subject, integral: &Picture) -> Vec<f64> {
        let pixels = integral.pixels.len();
        let Ok(ranges) = enclosure(&self.volume.data, &self.scene, method.about.reach_voxel) else {
            return vec![FULL; pixels];
        };
        let words = if method.about.in_words { self.words(subject) } else { 0.0 };
        let reach = |(range, pixel): (&Range, &[f64; 3])| {
            let of = |i: usize| (pixel[i] - range[i][0]).max(range[i][1] - pixel[i]);
            (of(0).max(of(1)).max(of(2)) + words + REALS).min(FULL)
        };
        ranges.iter().zip(&integral.pixels).map(reach).collect()
    }

    /// The most that words add to a pixel: twice the widest interval of a base plane's channels, for colour and for what is seen behind it.
    fn words(&self, subject: &Subject) -> f64 {
        // The walk is of interpolated values and parallel rays.
        let Some(frames) = self.frames.as_ref().filter(|_| !self.scene.volume.labels) else { return FULL };
        let widest = |setup: &cube3_frame::FrameSetup| {
            let method = setup.gradient.map_or(subject.machine.abc.gradient, |gradient| gradient.method);
            let grains = Grains::of(setup, WINDOW);
            let plane = Walk::new(&self.scene, setup, &self.volume.data, WINDOW, method, grains).base_plane();
            plane.iter().flatten().fold(0.0_f64, |most, ends| most.max(ends.high - ends.low))
        };
        2.0 * frames.setups.iter().map(|setup| widest(setup)).fold(0.0, f64::max)
    }
}

impl Measure {
    /// Holds every pixel against the truth.
    fn judge(&mut self, picture: &Picture, truth: &ConvergedRendering, bounds: &[f64]) {
        let mut worst = (0.0, 0.0);
        for (i, (pixel, expected)) in picture.pixels.iter().zip(&truth.picture.pixels).enumerate() {
            let error = (0..3).fold(0.0_f64, |most, k| most.max((pixel[k] - expected[k]).abs()));
            let bound = bounds[i] + truth.bounds[i];
            self.kept &= error <= bound;
            if error >= worst.0 {
                worst = (error, bound);
            }
        }
        (self.error, self.bound) = (Some(worst.0), worst.1);
    }
}
