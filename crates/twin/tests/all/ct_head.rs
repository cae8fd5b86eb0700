//! The CT head of Cube-3, figure 14, against figures of an independent float prototype (design, section 5).
//!
//! The set-up under which they hold: `cthead_256x256x99_u8` with z doubled by linear interpolation to 198 slices (the
//! last one twice; 197 fits as well) of cubic voxels; z runs from the crown down and y from the face back. The
//! paper's transfer function, opacity corrected; white light at the eye, two-sided, 0.1 + 0.7·c + 0.2·c¹⁰; black
//! background. The eye at yaw 0, −20, −30, −45° and tilt −7° of this project's view, which is 7° towards the crown.
//! On the base plane: sample floor with o = ½ where equation (3) allows it, 12-neighbourhood gradient, 12 weight
//! bits. Pictures of 300² at a voxel a pixel; image order with step 1 from the entry point. Errors are the mean
//! Euclidean RGB distance over √3 of all pixels of the base plane, or of the picture.
//!
//! The prototype's 0.01 % at 45° is not met: here the slope is 1 and the offset 0 to the bit, both casters
//! interpolate in the plane of voxels, and the difference is exactly 0.

use crate::common::{mean_relative_percent, one_voxel_a_pixel};
use cube3_frame::{Geometry, largest_offset, slope_register};
use cube3_host::canonical;
use cube3_machine::{RaySlots, TemplateRule};
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_scene::{ImagePlane, Scene, View};
use cube3_twin::{DiscreteOptions, sheared, true_3d};
use cube3_volume::{ReadOptions, Volume, read};
use std::path::Path;

const WEIGHT_BITS: u32 = 12;
const BLACK: [f64; 3] = [0.0; 3];

fn head() -> Option<Volume> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/cthead_256x256x99_u8.nrrd");
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    let scan = read(&path, &ReadOptions::default()).unwrap();
    let [width, height, slices] = scan.dims;
    let doubled = Volume::from_fn([width, height, 2 * slices], [1.0; 3], |x, y, z| {
        let near = scan.value(x, y, z / 2);
        let far = scan.value(x, y, (z / 2 + z % 2).min(slices - 1));
        (0.5 * (near + far)) as f32
    });
    Some(doubled.unwrap())
}

fn geometry(volume: &Volume, view: &View, rule: TemplateRule) -> Geometry {
    let canonical = canonical(view.frame().unwrap().direction, volume.spacing);
    let slopes = canonical.slopes.map(slope_register);
    let offset = (1 << (WEIGHT_BITS - 1)).min(largest_offset(rule, slopes, WEIGHT_BITS));
    let size = canonical.axes.permute(volume.dims);
    Geometry::new(size, canonical.axes, slopes, offset, WEIGHT_BITS, rule, RaySlots::Wrapped)
}

/// Sheared against true on the base plane, sheared against image order, and the latter for the plane floor, in percent.
fn errors(volume: &Volume, yaw_deg: f64) -> [f64; 3] {
    let view = View::from_angles(-yaw_deg, -7.0);
    let scene = Scene { view: view.clone(), image: one_voxel_a_pixel(300, 300), ..Scene::default() };
    let options = DiscreteOptions::default();
    let reference = image_order(volume, &scene, &ImageOrderOptions::default(), None).unwrap().picture.pixels;
    let plane = ImagePlane::new(&scene, &view.frame().unwrap(), volume.dims, volume.spacing);

    let sample_floor = geometry(volume, &view, TemplateRule::SampleFloor);
    let by_shear = sheared(volume, &scene, &sample_floor, &options, None).unwrap();
    let exact = true_3d(volume, &scene, &sample_floor, &options, None).unwrap();
    let plane_floor = geometry(volume, &view, TemplateRule::PlaneFloor);
    let on_planes = sheared(volume, &scene, &plane_floor, &options, None).unwrap();
    [
        mean_relative_percent(&by_shear.over(BLACK), &exact.over(BLACK)),
        mean_relative_percent(&by_shear.warp(&sample_floor, &plane, volume.spacing, BLACK), &reference),
        mean_relative_percent(&on_planes.warp(&plane_floor, &plane, volume.spacing, BLACK), &reference),
    ]
}

/// The table of figure 14: 0 to 90° by 5°. Each angle takes seconds.
#[test]
#[ignore = "a minute; the table of docs/src/validation.md: cargo test --release -p cube3-twin --test all ct_head:: -- --ignored --nocapture"]
fn the_ct_head_over_the_papers_whole_range() {
    let Some(volume) = head() else { return };
    let table: Vec<[f64; 3]> = (0..=18).map(|step| errors(&volume, 5.0 * f64::from(step))).collect();
    for (step, [to_true, to_image_order, on_planes]) in table.iter().enumerate() {
        println!("| {}° | {to_true:.3} | {to_image_order:.3} | {on_planes:.3} |", 5 * step);
    }
    assert!(
        table[9][0] == 0.0 && table[8][0] > 0.0 && table[10][0] > 0.0,
        "at 45° both interpolate in the plane of voxels"
    );
    assert!(table.iter().all(|row| row[0] < 1.0 && row[1] < 1.6), "{table:?}");
}

#[test]
fn the_ct_head_has_the_prototypes_errors() {
    let Some(volume) = head() else { return };
    let expected =
        [(0.0, [0.37, 1.06, 1.06]), (20.0, [0.77, 1.08, 1.08]), (30.0, [0.85, 1.18, 1.16]), (45.0, [0.01, 1.33, 1.20])];
    for (yaw_deg, expected) in expected {
        let got = errors(&volume, yaw_deg);
        println!("yaw {yaw_deg}: sheared−true, sheared−image order, plane floor−image order {got:.3?} %, {expected:?}");
        for (i, (got, expected)) in got.into_iter().zip(expected).enumerate() {
            if expected == 0.01 {
                assert_eq!(got, 0.0, "yaw {yaw_deg}: both interpolate in the plane of voxels");
            } else {
                assert!((got / expected - 1.0).abs() < 0.2, "yaw {yaw_deg}, figure {i}: {got} %, not {expected} %");
            }
        }
    }
}
