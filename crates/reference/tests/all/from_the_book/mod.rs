//! `image_order` against a caster that was written from the book and not from the code: 12 views and three eyes, to 10⁻¹².

use crate::common;

mod caster;

use crate::common::hash;
use caster::{Mode as Shown, Setting, View as Seen, Voxels, cast};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, Image, Light, Material, Mode, Perspective, Scene, Threshold, Transfer, View,
};
use cube3_volume::Volume;

/// A smooth field with a little noise on it, of 0 to about 250.
fn volume(dims: [usize; 3], spacing: [f64; 3]) -> Volume {
    Volume::from_fn(dims, spacing, |x, y, z| {
        let wave = |i: usize, rate: f64| (i as f64 * rate).sin();
        120.0 + 40.0 * wave(x, 0.7) + 50.0 * wave(y, 0.5) + 30.0 * wave(z, 0.9) + 9.0 * hash(5, [x, y, z])
    })
    .unwrap()
}

fn voxels(volume: &Volume, border: f64) -> Voxels {
    Voxels { dims: volume.dims, spacing: volume.spacing, values: volume.to_f64(), border }
}

/// A scene as both know it: the project's, and the book's.
fn pair(seen: Seen, mode: (Mode, Shown), rich: bool, step_voxel: f64) -> (Scene, Setting) {
    let opacity = vec![[60.0, 0.0], [130.0, 0.15], [210.0, 0.6]];
    let colour = vec![(40.0, [1.0, 0.2, 0.1]), (220.0, [0.1, 0.8, 1.0])];
    let mut setting = Setting {
        view: seen.clone(),
        width: 23,
        height: 19,
        background: [0.1, 0.2, 0.3],
        opacity,
        colour,
        opacity_correction: true,
        shaded: true,
        ambient: 0.1,
        diffuse: 0.7,
        specular: 0.2,
        shininess: 10.0,
        two_sided: true,
        lights: vec![(None, [1.0; 3])],
        depth_cue: None,
        cuts: Vec::new(),
        crop: None,
        threshold: [f64::NEG_INFINITY, f64::INFINITY],
        mode: mode.1,
        opaque_alpha: 0.3,
        step_voxel,
    };
    if rich {
        setting.opacity_correction = false;
        setting.two_sided = false;
        setting.shininess = 3.5;
        setting.lights = vec![(Some([1.0, -0.5, 2.0]), [1.0, 0.9, 0.5]), (None, [0.2, 0.3, 0.4])];
        setting.depth_cue = Some([0.9, 0.2]);
        setting.cuts = vec![([1.0, 0.3, -0.2], [7.1, 5.0, 5.0]), ([-0.1, -1.0, 0.4], [3.0, 1.3, 6.0])];
        setting.crop = Some([[0.3, 0.0, 0.9], [9.5, 9.2, 12.0]]);
        setting.threshold = [70.0, 225.0];
    }
    let (view, pixel_size_voxel) = match seen {
        Seen::Parallel { yaw_deg, tilt_deg, roll_deg, pixel_size_voxel } => {
            (View { roll_deg, ..View::from_angles(yaw_deg, tilt_deg) }, pixel_size_voxel)
        }
        Seen::Eye { yaw_deg, tilt_deg, roll_deg, field_of_view_deg, eye_voxel } => {
            let perspective = Some(Perspective { eye_voxel, ..Perspective::new(field_of_view_deg) });
            (View { roll_deg, perspective, ..View::from_angles(yaw_deg, tilt_deg) }, None)
        }
    };
    let [low, high] = setting.threshold;
    let scene = Scene {
        mode: mode.0,
        background: setting.background,
        view,
        image: Image { width_px: 23, height_px: 19, pixel_size_voxel },
        transfer: Transfer {
            opacity: setting.opacity.clone(),
            colour: setting.colour.iter().map(|&(value, rgb)| ColourPoint { value, rgb }).collect(),
            opacity_correction: setting.opacity_correction,
            opaque_alpha: setting.opaque_alpha,
            ..Transfer::default()
        },
        material: Material {
            shaded: setting.shaded,
            ambient: setting.ambient,
            diffuse: setting.diffuse,
            specular: setting.specular,
            shininess: setting.shininess,
            two_sided: setting.two_sided,
        },
        lights: setting.lights.iter().map(|&(direction, colour)| Light { direction, colour }).collect(),
        depth_cue: setting.depth_cue.map(|[front, back]| DepthCue { front, back }),
        cuts: setting.cuts.iter().map(|&(normal, through_voxel)| Cut { normal, through_voxel }).collect(),
        crop: setting.crop.map(|[min_voxel, max_voxel]| Crop { min_voxel, max_voxel }),
        threshold: rich.then_some(Threshold { low: Some(low), high: Some(high) }),
        ..Scene::default()
    };
    (scene, setting)
}

const MODES: [(Mode, Shown); 6] = [
    (Mode::Composite, Shown::Composite),
    (Mode::FirstOpaque, Shown::FirstOpaque),
    (Mode::LastOpaque, Shown::LastOpaque),
    (Mode::Maximum, Shown::Maximum),
    (Mode::Minimum, Shown::Minimum),
    (Mode::WeightedSum, Shown::WeightedSum),
];

fn assert_equal(volume: &Volume, seen: &Seen) {
    for mode in MODES {
        for (rich, step_voxel) in [(false, 1.0), (true, 0.37)] {
            let (scene, setting) = pair(seen.clone(), mode, rich, step_voxel);
            let border = 3.0;
            let options = ImageOrderOptions { step_voxel, border, ..ImageOrderOptions::default() };
            let ours = image_order(volume, &scene, &options, None).unwrap().picture.pixels;
            let theirs = cast(&voxels(volume, border), &setting);
            let error = common::largest_difference(&ours, &theirs);
            assert!(error < 1e-12, "{} from {seen:?}, {:?}: {error:e}", mode.0, volume.dims);
            // The rich scene's crop box is behind a single slice.
            let shown = ours.iter().any(|pixel| *pixel != scene.background);
            assert_eq!(shown, !rich || volume.dims[2] > 1, "{}", mode.0);
        }
    }
}

fn volumes() -> [Volume; 3] {
    [([12, 11, 13], [1.0; 3]), ([12, 11, 13], [1.0, 0.7, 1.9]), ([12, 11, 1], [1.0, 1.25, 3.0])]
        .map(|(dims, spacing)| volume(dims, spacing))
}

#[test]
fn twelve_views_are_the_books() {
    for (yaw_deg, tilt_deg, roll_deg) in [
        (3.0, 4.0, 0.0),
        (30.0, 7.0, 0.0),
        (45.5, 20.0, 12.0),
        (63.0, -35.0, 0.0),
        (95.0, 11.0, 0.0),
        (121.0, 61.0, -30.0),
        (150.0, -7.0, 0.0),
        (190.0, 33.0, 0.0),
        (222.0, -52.0, 90.0),
        (271.0, 15.0, 0.0),
        (300.0, 86.0, 0.0),
        (340.0, -88.0, 200.0),
    ] {
        for (volume, pixel_size_voxel) in volumes().iter().zip([None, Some(0.8), Some(0.61)]) {
            assert_equal(volume, &Seen::Parallel { yaw_deg, tilt_deg, roll_deg, pixel_size_voxel });
        }
    }
}

#[test]
fn three_eyes_are_the_books() {
    for (field_of_view_deg, eye_voxel) in [(40.0, None), (75.0, Some([4.3, -6.0, 3.1])), (100.0, Some([5.2, 4.4, 0.2]))]
    {
        for volume in &volumes() {
            let (yaw_deg, tilt_deg, roll_deg) = (24.0, 13.0, 8.0);
            assert_equal(volume, &Seen::Eye { yaw_deg, tilt_deg, roll_deg, field_of_view_deg, eye_voxel });
        }
    }
}
