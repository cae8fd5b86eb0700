//! From a ray's samples to its pixel.

use crate::ends::{Drawn, Region};
use crate::grains::{Grains, component_value};
use crate::interval::Interval;
use crate::samples::Samples;
use crate::shade::{Normals, SeenLight, colours, lengths, lit, opacities};
use cube3_frame::{DiscreteRay, FrameSetup, Geometry, SLOPE_FRACTION_BITS};
use cube3_machine::GradientMethod;
use cube3_scene::{
    DepthCue, Mode, ResolvedLight, Scene, ViewFrame, corrected_opacity, depth_range, resolve_lights, smallest_spacing,
    turn_lights,
};
use cube3_twin::Basis;
use cube3_volume::Volume;
use glam::DVec3;

/// A walk over a frame in reals.
pub struct Walk<'a> {
    scene: &'a Scene,
    setup: &'a FrameSetup,
    spacing: [f64; 3],
    grains: Grains,
    /// The data value of voxel word 0, which is what is beyond the volume.
    border: f64,
    /// Data values for each smallest voxel spacing that a difference of two samples is.
    steepness: f64,
    /// The difference that a word of a gradient's component is, 0 where words are reals.
    word: f64,
    method: GradientMethod,
    basis: Basis,
    view: ViewFrame,
    exact: bool,
    values: Vec<f64>,
}

/// A sample that may count.
struct Seen {
    drawn: Drawn,
    value: Interval,
    opacity: Interval,
    colour: [Interval; 3],
    /// Steps that it stands for.
    part: Interval,
}

/// Red, green, blue and opacity, opacity-weighted.
pub type Pixel = [Interval; 4];

const CLEAR: Pixel = [Interval::point(0.0); 4];

impl<'a> Walk<'a> {
    /// Over a frame of a scene and a volume whose data has the `window` of the voxel words, with the frame's estimator.
    pub fn new(
        scene: &'a Scene,
        setup: &'a FrameSetup,
        volume: &Volume,
        window: [f64; 2],
        method: GradientMethod,
        grains: Grains,
    ) -> Walk<'a> {
        let basis = Basis::new(&setup.geometry, volume.spacing, method);
        let smallest = smallest_spacing(volume.spacing);
        let shortest = basis.lengths.into_iter().fold(f64::INFINITY, f64::min);
        let word = if grains == Grains::none() { 0.0 } else { component_value(setup, window) };
        Walk {
            scene,
            setup,
            spacing: volume.spacing,
            grains,
            border: window[0],
            steepness: 0.5 * smallest / shortest,
            word,
            method,
            basis,
            view: scene.view.frame().unwrap_or_else(|error| panic!("{error}")),
            exact: setup.ends.is_some(),
            values: (0..volume.samples.len()).map(|i| volume.samples.value(i)).collect(),
        }
    }

    /// Every pixel of the base plane.
    pub fn base_plane(&self) -> Vec<Pixel> {
        let geometry = &self.setup.geometry;
        let samples = Samples::new(geometry, &self.grains, &self.values);
        let region = Region::new(self.scene, geometry, &self.grains, self.exact);
        samples.rays().map(|ray| self.pixel(ray, &samples, &region)).collect()
    }

    fn pixel(&self, ray: DiscreteRay, samples: &Samples<'_>, region: &Region<'_>) -> Pixel {
        let geometry = &self.setup.geometry;
        let step = step(geometry, ray);
        let depths = geometry.size[2];
        let place = |k: usize| geometry.has_sample(ray, k as i64).then(|| geometry.sample_position(ray, k));
        let places: Vec<_> = (0..depths).map(place).collect();
        let lights = self.lights(step);
        let seen = region.parts(&places, step).into_iter().enumerate().filter_map(|(k, (drawn, part))| {
            let (value, place) = (samples.sample(ray, k as i64)?, places[k]?);
            let drawn = self.visible(drawn, value);
            if drawn == Drawn::No {
                return None;
            }
            let gradient = || samples.gradient(ray, k, self.method, &self.basis, self.border);
            let gradient = self.reads_gradients().then(gradient);
            let opacity = self.opacity(value, gradient);
            let colour = self.colour(value, gradient, &lights, place);
            Some(Seen { drawn, value, opacity, colour, part })
        });
        let seen: Vec<Seen> = seen.collect();
        let length = self.length(step);
        let node = 2.0 * depths as f64 * self.grains.node;
        self.combined(&seen, length).map(|channel| channel.wider(node).held(0.0, 1.0))
    }

    /// A sample of a value in the threshold.
    fn visible(&self, drawn: Drawn, value: Interval) -> Drawn {
        let Some(threshold) = &self.scene.threshold else { return drawn };
        let low = threshold.low.unwrap_or(f64::NEG_INFINITY);
        let high = threshold.high.unwrap_or(f64::INFINITY);
        match drawn {
            _ if value.high < low || value.low > high => Drawn::No,
            _ if value.low < low || value.high > high => {
                if drawn == Drawn::No {
                    Drawn::No
                } else {
                    Drawn::Maybe
                }
            }
            _ => drawn,
        }
    }

    fn reads_gradients(&self) -> bool {
        let lit = matches!(self.scene.mode, Mode::Composite | Mode::FirstOpaque | Mode::LastOpaque);
        self.scene.transfer.is_two_dimensional() || lit && self.scene.material.shaded
    }

    /// The opacities of a unit length, before they are rounded to a word.
    fn opacity(&self, value: Interval, gradient: Option<[Interval; 3]>) -> Interval {
        let transfer = &self.scene.transfer;
        let values = value.wider(self.grains.entry);
        let magnitude = match gradient {
            Some(gradient) if transfer.is_two_dimensional() => self.magnitude(gradient),
            _ => Interval::point(0.0),
        };
        opacities(transfer, values, magnitude)
    }

    /// The magnitudes of a gradient, and those that its row of the table stands for.
    fn magnitude(&self, gradient: [Interval; 3]) -> Interval {
        let length = lengths(gradient);
        let off = self.grains.magnitude * length.high + 0.5 * self.word;
        let row = length.wider(off + self.grains.row * self.word).held(0.0, f64::INFINITY);
        let last = self.grains.last_row * if self.word > 0.0 { self.word } else { 1.0 };
        length.or(row.rising(|magnitude| magnitude.min(last))) * self.steepness
    }

    /// The colours that go into the cone.
    fn colour(
        &self,
        value: Interval,
        gradient: Option<[Interval; 3]>,
        lights: &[SeenLight],
        place: [f64; 3],
    ) -> [Interval; 3] {
        let Scene { transfer, material, mode, .. } = self.scene;
        let plain = colours(transfer, value.wider(self.grains.entry))
            .map(|channel| channel.wider(self.grains.colour).held(0.0, 1.0));
        let lights_matter = matches!(mode, Mode::Composite | Mode::FirstOpaque | Mode::LastOpaque);
        let shaded = match gradient {
            Some(gradient) if material.shaded && lights_matter => {
                lit(material, lights, &Normals::against(gradient, &self.grains), plain, &self.grains)
            }
            _ => plain,
        };
        let Some(cue) = &self.scene.depth_cue else { return shaded };
        let factor = self.cue(cue, place);
        shaded.map(|channel| (channel * factor).wider(self.grains.light))
    }

    /// The depth cue's factors at a canonical place.
    fn cue(&self, cue: &DepthCue, place: [f64; 3]) -> Interval {
        let geometry = &self.setup.geometry;
        let [near, far] = depth_range(&self.view, geometry.dims(), self.spacing);
        let position = geometry.axes.voxel_position(geometry.size, place);
        let depth: f64 = (0..3).map(|i| self.view.direction[i] * self.spacing[i] * position[i]).sum();
        let depth = if far > near { (depth - near) / (far - near) } else { 0.0 };
        let factor = cue.factor_at(depth);
        let rate = self.grains.cue_rate * (8.0 + place.iter().map(|x| x.abs()).sum::<f64>()) + 3.0 * self.grains.place;
        Interval { low: factor - self.grains.cue - rate, high: factor + rate }.held(0.0, 1.0)
    }

    /// The lights in the frame of the gradients, as a ray of a step sees them.
    fn lights(&self, step: [f64; 3]) -> Vec<SeenLight> {
        let geometry = &self.setup.geometry;
        let mut lights = resolve_lights(self.scene, &self.view);
        let word = 3_f64.sqrt() * self.grains.towards;
        let mut off = vec![[word; 2]; lights.len()];
        if geometry.perspective.is_some() {
            let spacing = geometry.axes.permute(self.spacing);
            let along = geometry.axes.to_world([0, 1, 2].map(|i| step[i] * spacing[i])).normalize();
            turn_lights(self.scene, along, &mut lights);
            for (off, light) in off.iter_mut().zip(&lights) {
                // Twice the error of a sum of two unit vectors, over its length.
                let sum = (light.direction - along).length();
                off[1] = (3.0 * word / sum.max(1e-3) + word).min(2.0);
            }
        }
        let in_frame = |vector: DVec3| DVec3::from(self.basis.components(&geometry.axes, vector));
        lights
            .into_iter()
            .zip(off)
            .map(|(light, off)| SeenLight {
                light: ResolvedLight {
                    direction: in_frame(light.direction),
                    halfway: in_frame(light.halfway),
                    colour: light.colour,
                },
                off: [0, 1].map(|i| if [light.direction, light.halfway][i] == DVec3::ZERO { 0.0 } else { off[i] }),
            })
            .collect()
    }

    /// The lengths that opacity is corrected to for a whole step of a ray, and the longest of the frame, in the smallest voxel spacing.
    fn length(&self, along: [f64; 3]) -> (Interval, f64) {
        if !(self.scene.mode == Mode::Composite && self.scene.transfer.opacity_correction) {
            return (Interval::point(1.0), 1.0);
        }
        let geometry = &self.setup.geometry;
        let spacing = geometry.axes.permute(self.spacing);
        let smallest = smallest_spacing(spacing);
        let square = |step: [f64; 3]| (0..3).map(|i| (step[i] * spacing[i] / smallest).powi(2)).sum::<f64>();
        let here = square(along);
        let Some(pass) = &geometry.perspective else {
            return (Interval::point(here.sqrt()), here.sqrt());
        };
        let all = |slopes: &[i64], axis: usize| {
            let mut along = [0.0; 3];
            let squares = slopes.iter().map(|&slope| {
                along[axis] = real(slope);
                square(along)
            });
            let squares: Vec<f64> = squares.collect();
            let least = squares.iter().copied().fold(f64::INFINITY, f64::min);
            (least, squares.into_iter().fold(0.0, f64::max))
        };
        let (u, v) = (all(&pass.u.slopes, 0), all(&pass.v.slopes, 1));
        let ahead = square([0.0, 0.0, 1.0]);
        let [least, most] = [u.0 + v.0 + ahead, u.1 + v.1 + ahead];
        let off = self.grains.length * (most - least);
        (Interval::around(here, off).held(least.min(here), most.max(here)).rising(f64::sqrt), most.sqrt())
    }

    /// The pixel of samples from the front on.
    fn combined(&self, seen: &[Seen], (length, longest): (Interval, f64)) -> Pixel {
        let whole = Interval::point(1.0);
        let part_of = |sample: &Seen| {
            let part = sample.part * length;
            if sample.part == whole { part } else { part.wider(self.grains.end[1] * longest).held(0.0, f64::INFINITY) }
        };
        let word = |opacity: Interval| opacity.wider(self.grains.opacity).held(0.0, 1.0);
        match self.scene.mode {
            Mode::Composite => seen.iter().rev().fold(CLEAR, |behind, sample| {
                let part = part_of(sample);
                let opacity = Interval {
                    low: corrected_opacity(sample.opacity.low, part.low),
                    high: corrected_opacity(sample.opacity.high, part.high),
                };
                let opacity = held_out(sample.drawn, word(opacity));
                over(sample.colour, opacity, behind)
            }),
            Mode::WeightedSum => {
                let steps =
                    if self.exact { self.setup.geometry.bounding_planes() - 1 } else { self.setup.geometry.size[2] };
                let sum = seen.iter().fold(CLEAR, |sum, sample| {
                    let opacity = (sample.opacity * part_of(sample)).wider(self.grains.opacity);
                    let weight = held_out(sample.drawn, opacity.held(0.0, f64::INFINITY)) * (1.0 / steps as f64);
                    let [r, g, b] = sample.colour.map(|channel| channel * weight);
                    let added = [r, g, b, weight];
                    [0, 1, 2, 3].map(|i| sum[i] + added[i])
                });
                sum.map(|channel| channel.wider(self.grains.sum * (1.0 + channel.high)))
            }
            Mode::FirstOpaque => self.first_opaque(seen.iter()),
            Mode::LastOpaque => self.first_opaque(seen.iter().rev()),
            Mode::Maximum => chosen(seen, word, |value| value),
            Mode::Minimum => chosen(seen, word, |value| -value),
        }
    }

    /// The first opaque sample; each that may be it.
    fn first_opaque<'s>(&self, seen: impl Iterator<Item = &'s Seen>) -> Pixel {
        let opaque = self.scene.transfer.opaque_alpha;
        let mut pixels = None;
        for sample in seen.filter(|sample| sample.opacity.high >= opaque - self.grains.opaque) {
            let [r, g, b] = sample.colour;
            pixels = either(pixels, [r, g, b, Interval::point(1.0)]);
            if sample.drawn == Drawn::Yes && sample.opacity.low >= opaque {
                return pixels.unwrap_or(CLEAR);
            }
        }
        either(pixels, CLEAR).unwrap_or(CLEAR)
    }
}

/// The sample that is most by `rank`, which rises or falls; each that may be it.
fn chosen(seen: &[Seen], word: impl Fn(Interval) -> Interval, rank: fn(Interval) -> Interval) -> Pixel {
    let certain = seen.iter().filter(|sample| sample.drawn == Drawn::Yes).map(|sample| rank(sample.value).low);
    let least = certain.fold(f64::NEG_INFINITY, f64::max);
    let candidates = seen.iter().filter(|sample| rank(sample.value).high >= least).map(|sample| {
        let opacity = word(sample.opacity);
        let [r, g, b] = sample.colour.map(|channel| channel * opacity);
        [r, g, b, opacity]
    });
    let none = (least == f64::NEG_INFINITY).then_some(CLEAR);
    candidates.fold(none, either).unwrap_or(CLEAR)
}

fn either(pixels: Option<Pixel>, other: Pixel) -> Option<Pixel> {
    Some(pixels.map_or(other, |pixels| [0, 1, 2, 3].map(|i| pixels[i].or(other[i]))))
}

/// What may not be drawn may have no opacity.
fn held_out(drawn: Drawn, opacity: Interval) -> Interval {
    if drawn == Drawn::Yes { opacity } else { opacity.or(Interval::point(0.0)) }
}

/// A sample over what is behind it: linear in its opacity, and rising in both colours.
fn over(colour: [Interval; 3], opacity: Interval, behind: Pixel) -> Pixel {
    let [r, g, b] = colour;
    let front = [r, g, b, Interval::point(1.0)];
    [0, 1, 2, 3].map(|i| Interval::between(behind[i], front[i], opacity))
}

fn real(slope: i64) -> f64 {
    slope as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS)
}

/// How far a ray moves from a sample to the next, canonical, in voxels.
fn step(geometry: &Geometry, ray: DiscreteRay) -> [f64; 3] {
    let Some(pass) = &geometry.perspective else {
        let [u, v] = geometry.real_slopes();
        return [u, v, 1.0];
    };
    let [row, column] = geometry.slot_of(ray);
    [real(pass.u.slopes[column]), real(pass.v.slopes[row]), 1.0]
}
