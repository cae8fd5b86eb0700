//! Random volumes and scenes: steps, plateaus and thin shells in the transfer function, faint and dense, lit and not, layers of gradients,
//! cuts, thresholds, cues, labels, eyes in the volume, voxels that are far from cubes.

use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, Image, Layer, Light, Material, Mode, Perspective, Scene, Threshold, Transfer,
    View,
};
use cube3_volume::{Samples, Volume};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Numbers by a seed.
pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Dice {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    /// 0 to below `sides`.
    pub fn below(&mut self, sides: usize) -> usize {
        (self.0.next_u64() % sides as u64) as usize
    }

    /// Once in so many.
    pub fn once_in(&mut self, many: usize) -> bool {
        self.below(many) == 0
    }

    /// Between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    fn direction(&mut self) -> [f64; 3] {
        let free = [0; 3].map(|_| self.between(-1.0, 1.0));
        match self.below(6) {
            0 => self.one_of(&[[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]]),
            1 => self.one_of(&[[1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [1.0, 1.0, -1.0]]),
            _ => free,
        }
    }

    /// An opacity: clear, full, faint over 30 decades, near to full, or anything.
    fn opacity(&mut self) -> f64 {
        match self.below(8) {
            0 | 1 => 0.0,
            2 => 1.0,
            3 => 10_f64.powf(self.between(-30.0, 0.0)),
            4 => 1.0 - 10_f64.powf(self.between(-15.0, 0.0)),
            _ => self.between(0.0, 1.0),
        }
    }

    fn colour(&mut self) -> [f64; 3] {
        [0; 3].map(|_| if self.once_in(4) { self.one_of(&[0.0, 1.0]) } else { self.between(0.0, 1.0) })
    }

    /// Points of opacity over values of about −20 to 280.
    fn ramp(&mut self) -> Vec<[f64; 2]> {
        let count = 1 + self.below(6);
        let mut values: Vec<f64> = (0..count).map(|_| self.between(-20.0, 280.0).round()).collect();
        if count > 1 && self.once_in(2) {
            // A step, or a shell.
            values[1] = values[0] + self.one_of(&[0.0, 0.0, 1e-6, 0.5]);
        }
        values.sort_by(f64::total_cmp);
        values.into_iter().map(|value| [value, self.opacity()]).collect()
    }

    fn transfer(&mut self) -> Transfer {
        let colours = 1 + self.below(4);
        let mut colour: Vec<ColourPoint> =
            (0..colours).map(|_| ColourPoint { value: self.between(0.0, 255.0).round(), rgb: self.colour() }).collect();
        colour.sort_by(|a, b| a.value.total_cmp(&b.value));
        let mut transfer = Transfer { colour, opacity: self.ramp(), ..Transfer::default() };
        if self.once_in(6) {
            let mut gradients: Vec<f64> = (0..1 + self.below(3)).map(|_| self.between(0.0, 90.0)).collect();
            gradients.sort_by(f64::total_cmp);
            let layer = |gradient| Layer { gradient, opacity: self.ramp() };
            transfer.layers = gradients.into_iter().map(layer).collect();
            transfer.opacity.clear();
        }
        transfer
    }

    fn volume(&mut self) -> Volume {
        let dims = [0; 3].map(|_| 2 + self.below(6));
        let spacing = match self.below(4) {
            0 => [0; 3].map(|_| self.between(0.3, 3.0)),
            1 => self.one_of(&[[1.0, 1.0, 1000.0], [0.001, 1.0, 1.0], [1.0, 1.0, 2.0]]),
            _ => [1.0; 3],
        };
        let kind = self.below(5);
        let levels = [0.0, 80.0, 120.0, 255.0];
        let (slope, middle) = ([0; 3].map(|_| self.between(-60.0, 60.0)), self.between(0.0, 255.0));
        let value = |dice: &mut Dice, [x, y, z]: [usize; 3]| match kind {
            0 => dice.one_of(&levels),
            1 => middle + slope[0] * x as f64 + slope[1] * y as f64 + slope[2] * z as f64,
            2 => 255.0 / (1.0 + 0.3 * ((x as f64 - 2.2).powi(2) + (y as f64 - 1.9).powi(2) + (z as f64 - 2.6).powi(2))),
            3 => middle,
            _ => dice.between(0.0, 255.0),
        };
        let mut samples = Vec::new();
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    samples.push(value(self, [x, y, z]));
                }
            }
        }
        let samples = match self.below(3) {
            0 => Samples::U8(samples.iter().map(|v| v.round().clamp(0.0, 255.0) as u8).collect()),
            1 => Samples::F32(samples.iter().map(|v| *v as f32).collect()),
            _ => Samples::F64(samples),
        };
        Volume::new(dims, spacing, samples).unwrap()
    }

    fn material(&mut self) -> Material {
        Material {
            shaded: !self.once_in(4),
            ambient: self.between(0.0, 1.0),
            diffuse: self.between(0.0, 1.0),
            specular: if self.once_in(3) { 0.0 } else { self.between(0.0, 1.0) },
            shininess: self.one_of(&[10.0, 1.0, 2.0, 7.0, 0.6, 1.5, 33.3, 300.0]),
            two_sided: self.once_in(2),
        }
    }
}

/// A volume and a scene, of a seed, with a picture of so many pixels each way.
pub fn random(seed: u64, pixels: u32) -> (Volume, Scene) {
    let dice = &mut Dice::new(seed);
    let volume = dice.volume();
    let extent = |dice: &mut Dice| [0, 1, 2].map(|i| dice.between(0.0, (volume.dims[i] - 1) as f64));
    let mut view = View::from_direction(dice.direction(), None);
    if dice.once_in(3) {
        let eye_voxel = if dice.once_in(2) { Some(extent(dice)) } else { None };
        view.perspective = Some(Perspective { eye_voxel, ..Perspective::new(dice.one_of(&[0.01, 20.0, 60.0, 150.0])) });
    }
    let light = |dice: &mut Dice| Light {
        direction: if dice.once_in(2) { None } else { Some(dice.direction()) },
        colour: dice.colour(),
    };
    let mut scene = Scene {
        mode: if dice.once_in(6) { Mode::WeightedSum } else { Mode::Composite },
        background: dice.colour(),
        view,
        image: Image { width_px: pixels, height_px: pixels, pixel_size_voxel: None },
        transfer: dice.transfer(),
        material: dice.material(),
        ..Scene::default()
    };
    scene.lights = (0..dice.below(3)).map(|_| light(dice)).collect();
    if dice.once_in(2) {
        scene.lights = vec![Light::default()];
    }
    scene.volume.labels = dice.once_in(8);
    if dice.once_in(4) {
        scene.depth_cue = Some(DepthCue { front: dice.between(0.0, 1.0), back: dice.between(0.0, 1.0) });
    }
    if dice.once_in(5) {
        let [a, b] = [dice.between(0.0, 255.0).round(), dice.between(0.0, 255.0)];
        scene.threshold = Some(Threshold { low: Some(a.min(b)), high: Some(a.max(b)) });
    }
    if dice.once_in(5) {
        scene.cuts = vec![Cut { normal: dice.direction(), through_voxel: extent(dice) }];
    }
    if dice.once_in(5) {
        let [a, b] = [extent(dice), extent(dice)];
        let [min_voxel, max_voxel] = [f64::min, f64::max].map(|of| [0, 1, 2].map(|i| of(a[i], b[i])));
        scene.crop = Some(Crop { min_voxel, max_voxel });
    }
    (volume, scene)
}
