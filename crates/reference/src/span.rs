//! How long a ray is: the stretch of a line inside of what is drawn.

use cube3_scene::Scene;

/// A direction's component below this is none: over any ray it moves by less than rounding does.
const PARALLEL: f64 = 1e-12;

/// How far outside of a face, in voxels, a line along it still counts as in it: what rounding moves it by.
pub const ON_FACE: f64 = 1e-9;

/// How far beyond the outermost voxel centres a scene's volume reaches, in voxels: labels fill their voxels.
pub fn margin(scene: &Scene) -> f64 {
    if scene.volume.labels { 0.5 } else { 0.0 }
}

/// What is drawn of a volume: the box of its voxel centres, [0, n−1] along each axis, inside of the crop box and of the cut planes. A voxel
/// of labels is a box that is filled with its label, so theirs is [−½, n−½].
///
/// It is convex, so a line has one stretch in it. But for labels every axis has two voxels at least (see
/// [`Volume::thickened`](cube3_volume::Volume::thickened)).
#[derive(Clone, Debug)]
pub struct Drawn {
    low: [f64; 3],
    high: [f64; 3],
    /// Normals, which point at what is removed, and a point on each plane, in voxels.
    cuts: Vec<([f64; 3], [f64; 3])>,
}

impl Drawn {
    /// Of a volume of `dims` voxels.
    pub fn new(scene: &Scene, dims: [usize; 3]) -> Drawn {
        let margin = margin(scene);
        let (mut low, mut high) = ([-margin; 3], dims.map(|n| (n - 1) as f64 + margin));
        if let Some(crop) = &scene.crop {
            low = [0, 1, 2].map(|i| low[i].max(crop.min_voxel[i]));
            high = [0, 1, 2].map(|i| high[i].min(crop.max_voxel[i]));
        }
        let unit = |normal: [f64; 3]| {
            let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            normal.map(|x| x / largest)
        };
        let cuts = scene.cuts.iter().map(|cut| (unit(cut.normal), cut.through_voxel)).collect();
        Drawn { low, high, cuts }
    }

    /// Crop box and cut planes alone, whatever the volume.
    pub fn clips(scene: &Scene) -> Drawn {
        let unbounded = Drawn { low: [f64::NEG_INFINITY; 3], high: [f64::INFINITY; 3], cuts: Vec::new() };
        let Drawn { cuts, .. } = Drawn::new(scene, [2; 3]);
        let Some(crop) = &scene.crop else {
            return Drawn { cuts, ..unbounded };
        };
        Drawn { low: crop.min_voxel, high: crop.max_voxel, cuts }
    }

    /// The parameters at which the line `origin + t·direction`, in voxels, enters and leaves; none where it does not meet what is drawn.
    pub fn span(&self, origin: [f64; 3], direction: [f64; 3]) -> Option<[f64; 2]> {
        let [mut enter, mut leave] = [f64::NEG_INFINITY, f64::INFINITY];
        for i in 0..3 {
            let (low, high) = (self.low[i], self.high[i]);
            if low > high {
                return None;
            }
            if direction[i].abs() < PARALLEL {
                if origin[i] < low - ON_FACE || origin[i] > high + ON_FACE {
                    return None;
                }
                continue;
            }
            let (a, b) = ((low - origin[i]) / direction[i], (high - origin[i]) / direction[i]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        for (normal, through) in &self.cuts {
            let rate: f64 = (0..3).map(|i| normal[i] * direction[i]).sum();
            let outside: f64 = (0..3).map(|i| normal[i] * (origin[i] - through[i])).sum();
            if rate.abs() < PARALLEL {
                if outside > ON_FACE {
                    return None;
                }
            } else if rate > 0.0 {
                leave = leave.min(-outside / rate);
            } else {
                enter = enter.max(-outside / rate);
            }
        }
        (enter <= leave).then_some([enter, leave])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use cube3_scene::{Crop, Cut};
    use proptest::prelude::*;

    #[test]
    fn a_line_is_as_long_as_the_box_of_voxel_centres_inside_crop_and_cuts() {
        let whole = Scene::default();
        let span = |scene: &Scene, origin, direction| Drawn::new(scene, [16, 9, 5]).span(origin, direction);
        assert_eq!(span(&whole, [-3.0, 2.0, 2.0], [1.0, 0.0, 0.0]), Some([3.0, 18.0]));
        assert_eq!(span(&whole, [-3.0, 8.5, 2.0], [1.0, 0.0, 0.0]), None);
        let crop = Crop { min_voxel: [2.0, -9.0, 1.5], max_voxel: [4.0, 99.0, 3.5] };
        let cropped = Scene { crop: Some(crop), ..whole.clone() };
        assert_eq!(span(&cropped, [0.0, 0.0, 2.0], [0.5, 0.5, 0.0]), Some([4.0, 8.0]));
        assert_eq!(span(&cropped, [0.0, 0.0, 1.0], [0.5, 0.5, 0.0]), None);
        let beside = Crop { min_voxel: [16.0, 0.0, 0.0], max_voxel: [20.0, 9.0, 9.0] };
        assert_eq!(span(&Scene { crop: Some(beside), ..whole.clone() }, [0.0, 2.0, 2.0], [1.0, 0.0, 0.0]), None);
        let cut = Cut { normal: [2.0, 2.0, 0.0], through_voxel: [3.0, 1.0, 0.0] };
        let cut_too = Scene { cuts: vec![cut], ..cropped };
        assert_eq!(span(&cut_too, [1.0, 1.0, 2.0], [1.0, 0.0, 0.0]), Some([1.0, 2.0]));
        assert_eq!(span(&cut_too, [9.0, 1.0, 2.0], [-1.0, 0.0, 0.0]), Some([6.0, 7.0]));
        assert_eq!(span(&cut_too, [0.0, 4.0, 2.0], [1.0, -1.0, 0.0]), Some([2.0, 4.0]));
        assert_eq!(span(&cut_too, [0.0, 4.1, 2.0], [1.0, -1.0, 0.0]), None);
    }

    proptest! {
        #![proptest_config(cases(256))]

        /// The middle of the stretch is drawn, and what lies beyond its ends is not.
        #[test]
        fn what_is_drawn_ends_where_a_stretch_does(
            origin in prop::array::uniform3(-9.0..20.0_f64), direction in prop::array::uniform3(-1.0..1.0_f64),
            low in prop::array::uniform3(-2.0..6.0_f64), size in prop::array::uniform3(0.5..12.0_f64),
            normal in prop::array::uniform3(-1.0..1.0_f64), through in prop::array::uniform3(2.0..6.0_f64),
        ) {
            prop_assume!(direction.iter().all(|d| d.abs() > 1e-3) && normal.iter().any(|n| n.abs() > 1e-3));
            let dims = [9, 7, 8];
            let crop = Crop { min_voxel: low, max_voxel: [0, 1, 2].map(|i| low[i] + size[i]) };
            let cut = Cut { normal, through_voxel: through };
            let drawn = |t: f64| {
                let at = [0, 1, 2].map(|i| origin[i] + t * direction[i]);
                let inside = (0..3).all(|i| (0.0..=(dims[i] - 1) as f64).contains(&at[i]));
                inside && !crop.removes(at) && !cut.removes(at)
            };
            let scene = Scene { crop: Some(crop.clone()), cuts: vec![cut.clone()], ..Scene::default() };
            match Drawn::new(&scene, dims).span(origin, direction) {
                Some([enter, leave]) => {
                    prop_assert!(leave - enter < 1e-6 || drawn(f64::midpoint(enter, leave)));
                    prop_assert!(!drawn(enter - 1e-6) && !drawn(leave + 1e-6));
                }
                None => prop_assert!((-4000..4000).all(|i| !drawn(f64::from(i) / 100.0))),
            }
        }
    }
}
