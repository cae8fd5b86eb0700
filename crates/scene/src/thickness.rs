//! Places of a scene in a volume that has an axis of one voxel.

use crate::Scene;
use std::borrow::Cow;

impl Scene {
    /// The scene of a volume whose axes of a `single` voxel are drawn with two, half a voxel to either side of it: places move by half a
    /// voxel, and a crop box that holds the voxel's centre holds its whole thickness.
    pub fn thickened(&self, single: [bool; 3]) -> Cow<'_, Scene> {
        if single == [false; 3] {
            return Cow::Borrowed(self);
        }
        let by = single.map(|single| if single { 0.5 } else { 0.0 });
        let moved = |place: [f64; 3]| [0, 1, 2].map(|i| place[i] + by[i]);
        let mut scene = self.clone();
        for cut in &mut scene.cuts {
            cut.through_voxel = moved(cut.through_voxel);
        }
        if let Some(perspective) = &mut scene.view.perspective {
            perspective.eye_voxel = perspective.eye_voxel.map(moved);
        }
        if let Some(crop) = &mut scene.crop {
            for axis in (0..3).filter(|&axis| single[axis]) {
                let (min, max) = (&mut crop.min_voxel[axis], &mut crop.max_voxel[axis]);
                let holds = *min <= 0.0 && *max >= 0.0;
                (*min, *max) = (*min + 0.5, *max + 0.5);
                if holds {
                    (*min, *max) = (min.min(0.0), max.max(1.0));
                }
            }
        }
        Cow::Owned(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Crop, Cut, Perspective};

    #[test]
    fn places_move_with_the_voxel_and_a_crop_keeps_all_of_it() {
        let mut scene = Scene {
            cuts: vec![Cut { normal: [0.0, 0.0, 1.0], through_voxel: [1.0, 2.0, 0.25] }],
            crop: Some(Crop { min_voxel: [1.0, 2.0, 0.0], max_voxel: [3.0, 4.0, 0.0] }),
            ..Scene::default()
        };
        scene.view.perspective = Some(Perspective { eye_voxel: Some([5.0, 6.0, 7.0]), ..Perspective::new(30.0) });
        let thick = scene.thickened([false, false, true]);
        assert_eq!(thick.cuts[0].through_voxel, [1.0, 2.0, 0.75]);
        let crop = thick.crop.as_ref().unwrap();
        assert_eq!((crop.min_voxel, crop.max_voxel), ([1.0, 2.0, 0.0], [3.0, 4.0, 1.0]));
        assert_eq!(thick.view.perspective.unwrap().eye_voxel, Some([5.0, 6.0, 7.5]));
        assert_eq!(*scene.thickened([false; 3]), scene);
        scene.crop = Some(Crop { min_voxel: [0.0, 0.0, 1.0], max_voxel: [9.0, 9.0, 2.0] });
        let crop = scene.thickened([false, false, true]).into_owned().crop.unwrap();
        assert_eq!([crop.min_voxel[2], crop.max_voxel[2]], [1.5, 2.5], "outside as before");
    }
}
