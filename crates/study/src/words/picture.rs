//! What words do to the picture and the gradients of a scene, against the same samples in reals; and to the cone alone.

use super::cost::{Cost, cost};
use super::levels::{ImageLevels, LEVELS};
use super::thin::ThinCase;
use super::wire::{Design, Order};
use crate::StudyError;
use crate::error::Outcome;
use cube3_abc::golden::normalise;
use cube3_definition::Definition;
use cube3_frame::{DiscreteRay, FrameSetup};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{Basis, PictureFrames, VolumeInfo, picture_setup, step_length, warp_passes};
use cube3_inputs::LoadedVolume;
use cube3_machine::{MachineSpec, RayEnds};
use cube3_method::{Choice, METHODS, SHEARED, Subject};
use cube3_metrics::{compare, footprint, mean_angle_deg};
use cube3_picture::Picture;
use cube3_scene::{Scene, corrected_opacity};
use cube3_twin::{RealSamples, SampleCell};
use cube3_volume::{NonFiniteRule, VoxelWords, WordConversion, WordRounding};
use cube3_word::Rounding;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::hash::Hash;

/// Most rays whose gradients are looked at: a grid of them, if there are more.
const MOST_RAYS: usize = 4096;

/// Gradients below this part of the window for each voxel are none in reals either: a 16-bit word.
const FLAT: f64 = 1.0 / 65535.0;

/// Angles between directions in words and in reals, in degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Angles {
    /// Mean.
    pub mean_deg: f64,
    /// No more than this for 99 of 100.
    pub p99_deg: f64,
    /// Largest.
    pub max_deg: f64,
}

/// Errors of the gradients at the samples that a picture shows most of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct GradientError {
    /// Of the gradient word.
    pub gradient: Angles,
    /// Of the normalised gradient, where the machine has one.
    pub normal: Option<Angles>,
    /// Part of the samples whose gradient word is 0 and has no direction: they are counted with 90 degrees.
    pub lost_fraction: f64,
    /// Samples.
    pub samples: usize,
}

/// Errors and cost of a design.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Measured {
    /// Over the object: the pixels where picture or reference is not background.
    pub image: ImageLevels,
    /// Where the scene has gradients.
    pub gradient: Option<GradientError>,
    /// Of rays of thin opacity through the cone alone.
    pub thin: ImageLevels,
    /// Cost of the machine.
    pub cost: Cost,
}

/// Which error a design is judged by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aim {
    /// The picture of the scene.
    Picture,
    /// The worse of the picture and of rays of thin opacity, so that words serve both.
    PictureAndThin,
}

impl Aim {
    /// Both.
    pub const ALL: [Aim; 2] = [Aim::Picture, Aim::PictureAndThin];
}

impl Measured {
    /// The mean error that a design is judged by, in levels of 1/255.
    pub fn error(&self, aim: Aim) -> f64 {
        match aim {
            Aim::Picture => self.image.mean,
            Aim::PictureAndThin => self.image.mean.max(self.thin.mean),
        }
    }
}

/// What all designs with the same samples are measured against.
struct Ideal {
    picture: Picture,
    points: Vec<Point>,
}

/// A sample and its gradient in reals, in the world.
#[derive(Clone, Copy)]
struct Point {
    ray: DiscreteRay,
    k: usize,
    gradient: [f64; 3],
}

/// Voxel words as a design has them.
type VoxelKey = (u32, Rounding);

/// What the gradient depends on: voxel, weight, sample fraction, gradient and normal bits, fine tables, rounding.
type GradientKey = ([u32; 5], bool, Rounding);

/// What rays of thin opacity depend on: colour, opacity and accumulator bits, order, rounding.
type ThinKey = ([u32; 3], Order, Rounding);

/// A scene, its volume and a machine whose words are varied; and what has been measured.
pub struct SceneCase<'a> {
    scene: &'a Scene,
    machine: &'a MachineSpec,
    volume: &'a LoadedVolume,
    /// The largest value of the data.
    largest: f64,
    /// By weight bits, on which the positions of the samples depend.
    ideals: BTreeMap<u32, Ideal>,
    gradients: HashMap<GradientKey, Option<GradientError>>,
    rays: ThinCase,
    thin: HashMap<ThinKey, ImageLevels>,
    measured: HashMap<Design, Measured>,
}

impl<'a> SceneCase<'a> {
    /// A scene to be measured on designs of a machine. Of the volume its data count; voxel words are made of them.
    ///
    /// # Errors
    /// A perspective view: its frames have words of their own.
    pub fn new(scene: &'a Scene, machine: &'a MachineSpec, volume: &'a LoadedVolume) -> Outcome<SceneCase<'a>> {
        SHEARED.check(scene)?;
        if scene.view.perspective.is_some() {
            return Err(StudyError::ManyFrames);
        }
        Ok(SceneCase {
            scene,
            machine,
            volume,
            largest: volume.data.finite_range().0.1,
            ideals: BTreeMap::new(),
            gradients: HashMap::new(),
            rays: ThinCase::new(),
            thin: HashMap::new(),
            measured: HashMap::new(),
        })
    }

    /// Designs that have been measured so far.
    pub fn count(&self) -> usize {
        self.measured.len()
    }

    /// Measures designs, each only once.
    ///
    /// # Errors
    /// A scene that the machine cannot be set up for.
    pub fn measure(&mut self, designs: &[Design]) -> Outcome<Vec<Measured>> {
        let mut new = firsts(designs, &self.measured, |design| *design);
        self.find_ideals(&new)?;
        let thin = firsts(&new, &self.thin, thin_key);
        let found: Vec<ImageLevels> =
            thin.par_iter().map(|design| self.rays.measure(&design.words, design.order)).collect();
        self.thin.extend(thin.iter().map(thin_key).zip(found));
        let key = |design: &Design| -> VoxelKey { (design.words.voxel_bits, design.words.rounding) };
        while let Some(first) = new.first().map(key) {
            let (now, later): (Vec<Design>, Vec<Design>) = new.into_iter().partition(|design| key(design) == first);
            self.measure_voxels(first, &now)?;
            new = later;
        }
        designs.iter().map(|design| self.measured.get(design).copied().ok_or_else(|| StudyError::NotMeasured)).collect()
    }

    /// The window of voxel words of so many bits: the data's, and of labels their own, where what has no word becomes the largest.
    fn window(&self, bits: u32) -> [f64; 2] {
        let own = self.volume.words.window;
        if !self.scene.volume.labels {
            return own;
        }
        WordConversion::labels(self.largest, bits, self.machine.words.table_bits).window.unwrap_or(own)
    }

    fn frames(&self, design: &Design) -> Outcome<PictureFrames> {
        let info = VolumeInfo { window: self.window(design.words.voxel_bits), ..self.volume.info() };
        Ok(picture_setup(self.scene, &design.machine(self.machine), &info, true)?)
    }

    fn find_ideals(&mut self, designs: &[Design]) -> Outcome<()> {
        for design in designs {
            let weight_bits = design.words.weight_bits;
            if self.ideals.contains_key(&weight_bits) {
                continue;
            }
            let frames = self.frames(design)?;
            let ends = if self.machine.rays.ends == RayEnds::Published { "published" } else { "exact" };
            let choice = Choice::parse(METHODS, &format!("sheared:{ends}"))?;
            let subject = Subject { frames: Some(&frames), ..Subject::new(self.scene, self.machine, self.volume) };
            let picture = choice.render(&subject, &|_, _, _| {})?.picture;
            let points = match frames.setups.first() {
                Some(setup) if setup.gradient.is_some() => points(self.scene, self.machine, self.volume, setup)?,
                _ => Vec::new(),
            };
            self.ideals.insert(weight_bits, Ideal { picture, points });
        }
        Ok(())
    }

    /// Measures designs whose voxel words are the same.
    fn measure_voxels(&mut self, (bits, rounding): VoxelKey, designs: &[Design]) -> Outcome<()> {
        let conversion = WordConversion {
            window: Some(self.window(bits)),
            rounding: match rounding {
                Rounding::Nearest => WordRounding::Nearest,
                Rounding::Truncate => WordRounding::Truncate,
            },
            non_finite: NonFiniteRule::Refuse,
        };
        let (words, _) = self.volume.data.to_words(bits, &conversion)?;
        let axes = designs.first().map(|design| self.frames(design)).transpose()?;
        let axes = axes.as_ref().and_then(|frames| frames.setups.first()).map(|setup| setup.geometry.axes);
        let Some(axes) = axes else {
            return Err(StudyError::NoFrame);
        };
        let turned = CanonicalVolume::new(&axes, words.dims, &words.words);
        let new = firsts(designs, &self.gradients, gradient_key);
        let found: Outcome<Vec<_>> = new.par_iter().map(|design| self.gradient_error(design, &words)).collect();
        self.gradients.extend(new.iter().map(gradient_key).zip(found?));
        let found: Outcome<Vec<Measured>> = designs
            .par_iter()
            .map(|design| {
                let frames = self.frames(design)?;
                let [setup] = frames.setups.as_slice() else {
                    return Err(StudyError::ManyFrames);
                };
                Ok(Measured {
                    image: self.image_error(design, &frames, setup, &turned)?,
                    gradient: self.gradients.get(&gradient_key(design)).copied().flatten(),
                    thin: self.thin.get(&thin_key(design)).copied().unwrap_or_default(),
                    cost: cost(&design.machine(self.machine), words.dims, setup),
                })
            })
            .collect();
        self.measured.extend(designs.iter().copied().zip(found?));
        Ok(())
    }

    fn ideal(&self, design: &Design) -> Outcome<&Ideal> {
        self.ideals.get(&design.words.weight_bits).ok_or_else(|| StudyError::NotMeasured)
    }

    fn image_error(
        &self,
        design: &Design,
        frames: &PictureFrames,
        setup: &FrameSetup,
        turned: &CanonicalVolume<'_>,
    ) -> Outcome<ImageLevels> {
        let base = render(setup, turned, true, &|_, _| {}).base;
        let (plane, background) = (&frames.plane, self.scene.background);
        let pixels = warp_passes(&[(&base, &setup.geometry)], plane, self.volume.words.spacing, background);
        let picture = Picture::new(plane.width, plane.height, pixels)?;
        let ideal = &self.ideal(design)?.picture;
        let object = footprint(&picture, ideal, background)?;
        let Some(error) = compare(&picture, ideal, Some(&object))?.footprint else {
            return Err(StudyError::NothingShown);
        };
        Ok(ImageLevels { mean: LEVELS * error.mean_relative, rms: LEVELS * error.rms, max: LEVELS * error.max })
    }

    fn gradient_error(&self, design: &Design, words: &VoxelWords) -> Outcome<Option<GradientError>> {
        let frames = self.frames(design)?;
        let points = &self.ideal(design)?.points;
        let Some(setup) = frames.setups.first().filter(|_| !points.is_empty()) else {
            return Ok(None);
        };
        let Some(registers) = &setup.gradient else {
            return Ok(None);
        };
        let basis = Basis::new(&setup.geometry, words.spacing, registers.method);
        let world = |components: [i32; 3]| basis.world(&setup.geometry.axes, components.map(f64::from)).to_array();
        let defined = Definition::new(setup, &words.words);
        let mut lost = 0;
        let (mut of_gradient, mut of_normal) = (Vec::new(), Vec::new());
        for point in points {
            let word = defined.gradient(point.ray, point.k as i64).unwrap_or_default();
            lost += usize::from(word == [0; 3]);
            of_gradient.push(angle_deg(world(word), point.gradient)?);
            if let Some(table) = &setup.normaliser {
                of_normal.push(angle_deg(world(normalise(word, table, &setup.words).direction), point.gradient)?);
            }
        }
        Ok(Some(GradientError {
            gradient: angles(of_gradient),
            normal: setup.normaliser.as_ref().map(|_| angles(of_normal)),
            lost_fraction: lost as f64 / points.len() as f64,
            samples: points.len(),
        }))
    }
}

/// The first design with each key that is not known yet.
fn firsts<K: Eq + Hash, V>(designs: &[Design], known: &HashMap<K, V>, key: impl Fn(&Design) -> K) -> Vec<Design> {
    let mut seen: HashSet<K> = HashSet::new();
    let new = |design: &&Design| !known.contains_key(&key(design)) && seen.insert(key(design));
    designs.iter().filter(new).copied().collect()
}

fn thin_key(design: &Design) -> ThinKey {
    let words = &design.words;
    ([words.colour_bits, words.opacity_bits, words.accumulator_bits], design.order, words.rounding)
}

fn gradient_key(design: &Design) -> GradientKey {
    let words = &design.words;
    let lengths =
        [words.voxel_bits, words.weight_bits, words.sample_fraction_bits, words.gradient_bits, words.normal_bits];
    (lengths, design.fine_tables, words.rounding)
}

/// The angle between two directions; 90 degrees where the first has none.
fn angle_deg(word: [f64; 3], real: [f64; 3]) -> Outcome<f64> {
    Ok(mean_angle_deg([(word, real)])?.mean_deg.unwrap_or(90.0))
}

/// Mean, 99th percentile and largest.
fn angles(mut found: Vec<f64>) -> Angles {
    let mean_deg = found.iter().sum::<f64>() / found.len().max(1) as f64;
    found.sort_by(f64::total_cmp);
    let rank = (found.len() * 99).div_ceil(100).max(1) - 1;
    let at = |rank: usize| found.get(rank).copied().unwrap_or(0.0);
    Angles { mean_deg, p99_deg: at(rank), max_deg: at(found.len().max(1) - 1) }
}

/// On each ray of a grid the sample that gives most light to its pixel, in reals; rays that see nothing, and samples without a
/// gradient, are left out.
fn points(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume, setup: &FrameSetup) -> Outcome<Vec<Point>> {
    let (geometry, method) = (&setup.geometry, machine.abc.gradient);
    let [low, high] = volume.words.window;
    let samples = RealSamples::new(&volume.data, geometry, SampleCell::Sheared, low)?;
    let length = if scene.transfer.opacity_correction { step_length(geometry, volume.data.spacing) } else { 1.0 };
    let bounds = scene.threshold.as_ref().map_or((None, None), |threshold| (threshold.low, threshold.high));
    let opacity = |ray: DiscreteRay, k: usize| {
        let place = [ray.u, ray.v, k as i64];
        let clipped = setup.clips.iter().any(|clip| geometry.evaluate(&clip.distance, place) < 0);
        let Some(value) = samples.sample(ray, k as i64).filter(|_| !clipped) else {
            return 0.0;
        };
        if bounds.0.is_some_and(|low| value < low) || bounds.1.is_some_and(|high| value > high) {
            return 0.0;
        }
        let magnitude = match scene.transfer.is_two_dimensional() {
            true => samples.gradient(ray, k as i64, method).iter().map(|c| c * c).sum::<f64>().sqrt(),
            false => 0.0,
        };
        corrected_opacity(scene.transfer.opacity_at(value, magnitude), length)
    };
    let [width, height] = geometry.base_plane_size();
    let stride = (1..).find(|&stride| width.div_ceil(stride) * height.div_ceil(stride) <= MOST_RAYS).unwrap_or(1);
    let first = geometry.first_ray();
    let flat = FLAT * (high - low);
    let row = |row: usize| {
        let point = |column: usize| {
            let ray = DiscreteRay { u: first.u + column as i64, v: first.v + row as i64 };
            let (mut through, mut most) = (1.0, (0.0, 0));
            for k in 0..geometry.size[2] {
                let alpha = opacity(ray, k);
                if through * alpha > most.0 {
                    most = (through * alpha, k);
                }
                through *= 1.0 - alpha;
            }
            let gradient = samples.world_gradient(ray, most.1 as i64, method);
            let shown = most.0 > 0.0 && gradient.length() >= flat;
            shown.then(|| Point { ray, k: most.1, gradient: gradient.to_array() })
        };
        (0..width).step_by(stride).filter_map(point).collect::<Vec<Point>>()
    };
    let rows: Vec<usize> = (0..height).step_by(stride).collect();
    Ok(rows.into_par_iter().flat_map_iter(row).collect())
}
