//! Which samples of a ray are drawn, and how much of the ray each stands for.

use crate::rays::Line;
use cube3_frame::{DiscreteRay, Geometry};
use cube3_reference::{Drawn, ON_FACE};
use cube3_scene::{Crop, Scene};

/// What rays are cut to.
pub(crate) struct Parts<'a> {
    geometry: &'a Geometry,
    /// Clips, and the volume itself where ends have parts of their own. A sample is drawn that lies in all of them, or beyond where its ray
    /// leaves one by no more than goes with it.
    drawn: Vec<(Drawn, f64)>,
    /// Every sample stands for a whole step.
    whole_steps: bool,
    /// Depth of the eye, where rays begin.
    eye: f64,
}

impl<'a> Parts<'a> {
    /// Of a scene in a volume of `dims` voxels, seen from an eye at the depth `eye` or from afar.
    pub fn new(scene: &Scene, dims: [usize; 3], geometry: &'a Geometry, whole_steps: bool, eye: Option<f64>) -> Self {
        let drawn = if !whole_steps {
            vec![(Drawn::new(scene, dims), ON_FACE)]
        } else if !scene.mode.adds_up() {
            vec![(Drawn::clips(scene), ON_FACE)]
        } else if eye.is_none() {
            // A sample that stands for the step behind it is not on a face where the ray leaves.
            vec![(Drawn::clips(scene), -ON_FACE)]
        } else {
            // From an eye rays may enter and leave by one face; by one across w they all do the same.
            let [across, others] = by_side(scene, geometry.axes.axis[2]);
            vec![(Drawn::clips(&across), -ON_FACE), (Drawn::clips(&others), ON_FACE)]
        };
        Parts { geometry, drawn, whole_steps, eye: eye.unwrap_or(f64::NEG_INFINITY) }
    }

    /// The part of a step that each sample of the rays of plane `v` stands for, ray by ray in order of depth; none where there is no sample
    /// in what is drawn.
    pub fn plane(&self, v: i64, width: usize) -> Vec<Option<f64>> {
        let depths = self.geometry.size[2];
        let first = self.geometry.first_ray().u;
        let mut parts = vec![None; width * depths];
        for k in 0..depths {
            for u in self.geometry.valid_columns(v, k) {
                parts[(u - first) as usize * depths + k] = Some(0.0);
            }
        }
        for (u, parts) in (first..).zip(parts.chunks_mut(depths)) {
            self.ray(DiscreteRay { u, v }, parts);
        }
        parts
    }

    /// Of the samples of a ray, those in what is drawn, and how much of the ray is nearer to each than to the others.
    fn ray(&self, ray: DiscreteRay, parts: &mut [Option<f64>]) {
        let Geometry { axes, size, .. } = self.geometry;
        let line = Line::new(self.geometry, ray);
        let [origin, ahead] = [0.0, 1.0].map(|depth| axes.voxel_position(*size, line.at(depth)));
        let along = [0, 1, 2].map(|i| ahead[i] - origin[i]);
        let stretches: Option<Vec<[f64; 3]>> = self
            .drawn
            .iter()
            .map(|(drawn, beyond)| drawn.span(origin, along).map(|[enter, leave]| [enter, leave, leave + beyond]))
            .collect();
        let Some(stretches) = stretches else {
            parts.fill(None);
            return;
        };
        let enter = stretches.iter().fold(self.eye, |most, stretch| most.max(stretch[0]));
        let [leave, last] = [1, 2].map(|end| stretches.iter().fold(f64::INFINITY, |least, of| least.min(of[end])));
        let depth = |k: usize| k as f64 + self.geometry.real_offset();
        let mut before: Option<usize> = None;
        for k in 0..parts.len() {
            if parts[k].is_none() || !(enter - ON_FACE..=last).contains(&depth(k)) {
                parts[k] = None;
                continue;
            }
            if self.whole_steps {
                parts[k] = Some(1.0);
                continue;
            }
            // All that is left, until there is another one behind.
            let mut from = enter;
            if let Some((before, part)) = before.and_then(|k| Some((k, parts[k].as_mut()?))) {
                from = f64::midpoint(depth(before), depth(k));
                *part -= leave - from;
            }
            parts[k] = Some(leave - from);
            before = Some(k);
        }
    }
}

/// A scene's clips across an axis, and all others.
fn by_side(scene: &Scene, axis: usize) -> [Scene; 2] {
    [true, false].map(|across| {
        let crop = scene.crop.as_ref().map(|crop| {
            let side =
                |of: [f64; 3], without: f64| [0, 1, 2].map(|i| if (i == axis) == across { of[i] } else { without });
            Crop { min_voxel: side(crop.min_voxel, f64::NEG_INFINITY), max_voxel: side(crop.max_voxel, f64::INFINITY) }
        });
        let is_across = |normal: [f64; 3]| (0..3).all(|i| i == axis || normal[i] == 0.0);
        let cuts = scene.cuts.iter().filter(|cut| is_across(cut.normal) == across).cloned().collect();
        Scene { crop, cuts, ..scene.clone() }
    })
}
