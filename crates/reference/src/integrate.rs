//! From the samples of a ray to its pixel: what is cut away, classification, shading, depth cueing and the
//! six modes. The same for all casters: what the scene says, in reals.

use crate::cue::LinearCue;
use cube3_scene::{
    Mode, ResolvedLight, Scene, Transfer, ViewFrame, corrected_opacity, phong, turn_lights, unit_vector,
};
use cube3_volume::Volume;
use glam::DVec3;

/// What may be asked of a sample beside its value; asked only where the pixel depends on it.
pub trait SamplePoint {
    /// Its position in voxels, x, y, z.
    fn position(&self) -> [f64; 3];
    /// The gradient in values per smallest voxel spacing, in the frame that the lights are given in.
    fn gradient(&self) -> [f64; 3];
}

/// How one whole step of a ray counts.
#[derive(Clone, Copy, Debug)]
pub struct StepWeights {
    /// Its length in the smallest voxel spacing, for the correction of opacity.
    pub length: f64,
    /// What a sample that stands for it weighs in a weighted sum.
    pub sum: f64,
    /// Transmittance below which the ray stops, 0 for never.
    pub stop_below: f64,
}

/// Adds samples to rays. Cheap to clone: one for each thread.
#[derive(Clone)]
pub struct Integrator<'a> {
    scene: &'a Scene,
    lights: Vec<ResolvedLight>,
    weights: StepWeights,
    cue: Option<LinearCue<'a>>,
    /// Values below are clear whatever the gradient.
    clear_below: f64,
    corrects: bool,
    /// The last opacity that was corrected to a whole step, and to what: transfer functions have plateaus.
    corrected: (f64, f64),
}

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    colour: [f64; 3],
    /// Sum of the opacities, each as it reaches the eye.
    alpha: f64,
    /// What is left of the light from behind.
    transmittance: f64,
    /// The sample that gives the pixel in the modes that choose one, and its value.
    chosen: Option<(usize, f64)>,
    /// Whether no later sample can change the pixel.
    pub done: bool,
}

impl Ray {
    /// At its front: nothing is seen yet.
    pub const START: Ray = Ray { colour: [0.0; 3], alpha: 0.0, transmittance: 1.0, chosen: None, done: false };

    /// Front to back.
    #[inline]
    fn composite(&mut self, colour: [f64; 3], alpha: f64, stop_below: f64) {
        let weight = self.transmittance * alpha;
        for (sum, c) in self.colour.iter_mut().zip(colour) {
            *sum += weight * c;
        }
        self.alpha += weight;
        self.transmittance *= 1.0 - alpha;
        let left = self.transmittance;
        // Nothing that is still to come adds more than `left` to a channel; where that much rounds away, less does.
        let exactly_done = left < f64::EPSILON / 4.0 && self.colour.iter().all(|c| c + left == *c);
        self.done = left == 0.0 || left < stop_below || exactly_done;
    }

    /// The composited opacity: by its sum while thin and by what is left when dense, so that neither loses digits.
    fn composited_alpha(&self) -> f64 {
        if self.transmittance < 0.5 { 1.0 - self.transmittance } else { self.alpha }
    }
}

impl<'a> Integrator<'a> {
    /// For the scene of a volume, seen in the frame `view`; `lights` are in the frame of the gradients.
    pub fn new(
        scene: &'a Scene,
        volume: &Volume,
        view: &ViewFrame,
        lights: Vec<ResolvedLight>,
        weights: StepWeights,
    ) -> Self {
        Integrator {
            scene,
            lights,
            weights,
            cue: scene.depth_cue.as_ref().map(|cue| LinearCue::new(cue, volume, view)),
            clear_below: clear_below(&scene.transfer),
            corrects: scene.transfer.opacity_correction,
            corrected: (0.0, 0.0),
        }
    }

    /// Whether pixels of this scene depend on gradients.
    pub fn reads_gradients(scene: &Scene) -> bool {
        let lit = matches!(scene.mode, Mode::Composite | Mode::FirstOpaque | Mode::LastOpaque);
        scene.transfer.is_two_dimensional() || lit && scene.material.shaded
    }

    /// The samples to come are those of a perspective view's ray along `direction`, of unit length, in the world, which
    /// must be the frame of the gradients; in a weighted sum each weighs `sum`.
    pub fn start(&mut self, direction: DVec3, sum: f64) {
        turn_lights(self.scene, direction, &mut self.lights);
        self.weights.sum = sum;
    }

    /// Adds sample `index` of a ray, the next one from the front, which stands for the `part` of a step. It lies in what is drawn:
    /// crop box and cuts are in the ray's length.
    #[inline]
    pub fn add(&mut self, ray: &mut Ray, index: usize, value: f64, part: f64, point: &impl SamplePoint) {
        match self.scene.mode {
            Mode::Composite => {
                let (alpha, gradient) = self.visible_opacity(value, point);
                if alpha > 0.0 {
                    let alpha = self.correct(alpha, part);
                    let colour = self.lit_colour(value, gradient, point);
                    ray.composite(colour, alpha, self.weights.stop_below);
                }
            }
            Mode::WeightedSum => {
                let (alpha, _) = self.visible_opacity(value, point);
                if alpha > 0.0 {
                    let colour = self.plain_colour(value, point);
                    let weight = alpha * part * self.weights.sum;
                    for (sum, c) in ray.colour.iter_mut().zip(colour) {
                        *sum += c * weight;
                    }
                    ray.alpha += weight;
                }
            }
            Mode::FirstOpaque | Mode::LastOpaque => {
                if self.visible_opacity(value, point).0 >= self.scene.transfer.opaque_alpha {
                    ray.chosen = Some((index, value));
                    ray.done = self.scene.mode == Mode::FirstOpaque;
                }
            }
            Mode::Maximum => self.choose(ray, index, value, |best| value > best),
            Mode::Minimum => self.choose(ray, index, value, |best| value < best),
        }
    }

    /// Takes the sample if it is `better` than the best so far; the one in front stays at ties.
    #[inline]
    fn choose(&self, ray: &mut Ray, index: usize, value: f64, better: impl Fn(f64) -> bool) {
        if ray.chosen.is_none_or(|(_, best)| better(best)) && !self.removed(value) {
            ray.chosen = Some((index, value));
        }
    }

    /// The pixel of a ray, opacity-weighted: `point(index)` finds a sample again.
    pub fn finish<P: SamplePoint>(&self, ray: &Ray, point: impl Fn(usize) -> P) -> [f64; 4] {
        let with_alpha = |[r, g, b]: [f64; 3], alpha: f64| [r, g, b, alpha];
        match (self.scene.mode, ray.chosen) {
            (Mode::Composite, _) => with_alpha(ray.colour, ray.composited_alpha()),
            (Mode::WeightedSum, _) => with_alpha(ray.colour.map(|c| c.min(1.0)), ray.alpha.min(1.0)),
            (_, None) => [0.0; 4],
            (Mode::FirstOpaque | Mode::LastOpaque, Some((index, value))) => {
                with_alpha(self.lit_colour(value, None, &point(index)), 1.0)
            }
            (Mode::Maximum | Mode::Minimum, Some((index, value))) => {
                let point = point(index);
                let (alpha, _) = self.opacity(value, &point);
                with_alpha(self.plain_colour(value, &point).map(|c| c * alpha), alpha)
            }
        }
    }

    /// The opacity of a unit length, 0 for what is removed; and the gradient if it had to be read.
    #[inline]
    fn visible_opacity(&self, value: f64, point: &impl SamplePoint) -> (f64, Option<[f64; 3]>) {
        if value < self.clear_below || self.removed(value) { (0.0, None) } else { self.opacity(value, point) }
    }

    fn opacity(&self, value: f64, point: &impl SamplePoint) -> (f64, Option<[f64; 3]>) {
        let transfer = &self.scene.transfer;
        let gradient = transfer.is_two_dimensional().then(|| point.gradient());
        let magnitude = gradient.map_or(0.0, |gradient| DVec3::from(gradient).length());
        (transfer.opacity_at(value, magnitude), gradient)
    }

    #[inline]
    fn removed(&self, value: f64) -> bool {
        self.scene.threshold.as_ref().is_some_and(|threshold| threshold.removes(value))
    }

    /// The opacity of the part of a step; without the correction a whole step has the opacity of a unit length.
    #[inline]
    fn correct(&mut self, alpha: f64, part: f64) -> f64 {
        let step = if self.corrects { self.weights.length } else { 1.0 };
        if part != 1.0 {
            return corrected_opacity(alpha, step * part);
        }
        if self.corrected.0 != alpha {
            self.corrected = (alpha, corrected_opacity(alpha, step));
        }
        self.corrected.1
    }

    fn lit_colour(&self, value: f64, gradient: Option<[f64; 3]>, point: &impl SamplePoint) -> [f64; 3] {
        let rgb = self.scene.transfer.colour_at(value);
        let material = &self.scene.material;
        let normal = if material.shaded { normal(gradient.unwrap_or_else(|| point.gradient())) } else { None };
        self.cued(phong(material, &self.lights, normal, rgb), point)
    }

    fn plain_colour(&self, value: f64, point: &impl SamplePoint) -> [f64; 3] {
        self.cued(self.scene.transfer.colour_at(value), point)
    }

    fn cued(&self, colour: [f64; 3], point: &impl SamplePoint) -> [f64; 3] {
        let Some(cue) = &self.cue else { return colour };
        let factor = cue.at(point.position());
        colour.map(|c| c * factor)
    }
}

/// Away from the material: −∇f/|∇f|; `None` where the gradient vanishes.
fn normal(gradient: [f64; 3]) -> Option<DVec3> {
    unit_vector(DVec3::from(gradient)).map(|unit| -unit)
}

/// The value below which a transfer function is clear at every gradient: a fast way to the 0 that it would give.
fn clear_below(transfer: &Transfer) -> f64 {
    let of_points = |points: &[[f64; 2]]| {
        let clear = points.iter().take_while(|point| point[1] == 0.0).count();
        match clear {
            0 => f64::NEG_INFINITY,
            _ if clear == points.len() => f64::INFINITY,
            _ => points[clear - 1][0],
        }
    };
    if transfer.is_two_dimensional() {
        transfer.layers.iter().map(|layer| of_points(&layer.opacity)).fold(f64::INFINITY, f64::min)
    } else {
        of_points(&transfer.opacity)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn values_below_clear_below_are_clear(
            mut points in prop::collection::vec((-4_i32..5, prop::bool::ANY), 1..6), value in -6.0..6.0_f64,
        ) {
            points.sort();
            let opacity = points.iter().map(|&(v, full)| [f64::from(v), f64::from(u8::from(full))]).collect();
            let transfer = Transfer { opacity, ..Transfer::default() };
            let bound = clear_below(&transfer);
            if value < bound {
                prop_assert_eq!(transfer.opacity_at(value, 0.0), 0.0);
            }
            // It is the largest such bound, but for steps that fall back to clear.
            if bound.is_finite() {
                let above = points.iter().map(|p| f64::from(p.0)).find(|v| *v > bound).unwrap_or(bound);
                prop_assert!(transfer.opacity_at(f64::midpoint(bound, above), 0.0) > 0.0);
            }
        }
    }

    #[test]
    fn nothing_changes_a_bit_of_a_ray_that_is_done() {
        for alpha in [0.05, 0.3, 0.75, 0.999] {
            let mut ray = Ray::START;
            let mut samples = 0;
            while !ray.done {
                ray.composite([0.9, 0.5, 0.1], alpha, 0.0);
                samples += 1;
            }
            assert!(samples < 1200, "{samples} samples of {alpha} are still seen through");
            let mut more = ray;
            for _ in 0..1000 {
                more.composite([1.0; 3], 0.01, 0.0);
                more.composite([1.0; 3], 1.0, 0.0);
            }
            assert_eq!(more.colour, ray.colour);
            assert_eq!(more.composited_alpha(), ray.composited_alpha());
        }
    }

    #[test]
    fn thin_and_dense_opacity_keep_their_digits() {
        let mut thin = Ray::START;
        for _ in 0..512 {
            thin.composite([1.0; 3], 1e-17, 0.0);
        }
        assert!((thin.composited_alpha() / 512e-17 - 1.0).abs() < 1e-12);
        let mut full = Ray::START;
        full.composite([0.25; 3], 0.3, 0.0);
        full.composite([0.5; 3], 1.0, 0.0);
        assert!(full.done && full.composited_alpha() == 1.0);
    }
}
