//! Pictures whose value is the length of a ray: with exact ends a ray is as long as it is between the voxel centres of its faces, in the
//! crop box and on the near side of cuts.

use cube3_frame::FrameSetup;
use cube3_function::{CanonicalVolume, FunctionRun, render};
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::{MachineSpec, RayEnds, Rays, TemplateRule};
use cube3_scene::{Crop, Cut, Mode, Perspective, Scene, View};
use std::sync::Arc;

const N: usize = 33;
const RANGE: f64 = 255.0;

/// An unlit scene that has one opacity wherever the volume is full, seen along `direction`.
fn fog(opacity: f64, direction: [f64; 3]) -> Scene {
    let mut scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    scene.material.shaded = false;
    scene.transfer.opacity = vec![[0.0, opacity]];
    scene
}

/// Of 16-bit opacities, so that a table's word does not show.
fn machine(ends: RayEnds, offset: f64) -> MachineSpec {
    let rays = Rays { ends, offset, template: TemplateRule::PlaneFloor, ..Rays::default() };
    let mut machine = MachineSpec { rays, ..MachineSpec::default() };
    machine.words.opacity_bits = 16;
    machine
}

fn run(scene: &Scene, machine: &MachineSpec) -> (Arc<FrameSetup>, FunctionRun) {
    let volume = VolumeInfo { dims: [N; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = picture_setup(scene, machine, &volume, true).unwrap().setups.remove(0);
    let words = vec![u16::MAX; N * N * N];
    let turned = CanonicalVolume::new(&setup.geometry.axes, [N; 3], &words);
    let run = render(&setup, &turned, true, &|_, _| {});
    (setup, run)
}

/// The opacity of the ray that is at a place of the volume's canonical plane in front, of 255.
fn grey((setup, run): &(Arc<FrameSetup>, FunctionRun), u: i64, v: i64) -> f64 {
    let [column, row] = setup.geometry.pixel(cube3_frame::DiscreteRay { u, v });
    f64::from(run.base.pixels[row * run.base.width + column][3]) / 65535.0 * RANGE
}

fn through(opacity: f64, length: f64) -> f64 {
    RANGE * (1.0 - (1.0 - opacity).powf(length))
}

/// 33 voxels are 32 steps: 121.4, where whole steps at offset 0 make 33 of them.
#[test]
fn a_volume_along_an_axis_is_as_long_as_its_voxel_centres_are_apart() {
    let scene = fog(0.02, [0.0, 0.0, 1.0]);
    for offset in [0.0, 0.1, 0.25, 0.5, 0.9] {
        let exact = grey(&run(&scene, &machine(RayEnds::Exact, offset)), 16, 16);
        assert!((exact - through(0.02, 32.0)).abs() < 0.1, "{offset}: {exact}");
        let published = grey(&run(&scene, &machine(RayEnds::Published, offset)), 16, 16);
        let samples = if offset == 0.0 { 33.0 } else { 32.0 };
        assert!((published - through(0.02, samples)).abs() < 0.1, "{offset}: {published}");
    }
}

/// Without the correction a step has the opacity of its table, however long it is, and an end its part of that.
#[test]
fn without_opacity_correction_a_part_is_one_of_a_step() {
    let mut scene = fog(0.02, [0.0, 1.0, 1.0]);
    scene.transfer.opacity_correction = false;
    let exact = grey(&run(&scene, &machine(RayEnds::Exact, 0.0)), 0, 16);
    assert!((exact - through(0.02, 32.0)).abs() < 0.1, "{exact}");
}

/// 1/32 of a step is the distance of two tables, so each end is at most 1/64 off.
#[test]
fn a_crop_of_two_voxels_is_two_voxels_thick_at_every_angle() {
    for yaw in [0.0_f64, 10.0, 30.0, 44.0, 44.8, 44.9, 45.0, 45.1, 46.0] {
        for offset in [0.0, 0.3, 0.5] {
            let (sin, cos) = yaw.to_radians().sin_cos();
            let mut scene = fog(0.1, [sin, cos, 0.0]);
            scene.crop = Some(Crop { min_voxel: [0.0, 16.0, 0.0], max_voxel: [32.0, 18.0, 32.0] });
            let of_frame = run(&scene, &machine(RayEnds::Exact, offset));
            let right = through(0.1, 2.0 / cos);
            // A ray through the middle of the crop box.
            let slope = of_frame.0.geometry.real_slopes()[0];
            let u =
                if yaw <= 45.0 { (16.0 - 17.0 * slope).round() as i64 } else { (17.0 - 16.0 * slope).round() as i64 };
            let grey = grey(&of_frame, u, 16);
            let off = (through(0.1, 2.0 / cos + cos.max(sin).recip() / 32.0 + 1e-3) - right).abs();
            assert!((grey - right).abs() <= off + 0.05, "yaw {yaw}, offset {offset}: {grey} for {right}");
        }
    }
}

/// A cut at 45 degrees before rays along an axis: each ray has its own length, from its face to the plane.
#[test]
fn a_cut_plane_ends_each_ray_where_it_meets_it() {
    for through_voxel in [[16.0, 16.0, 16.0], [16.3, 16.0, 16.0]] {
        let mut scene = fog(0.05, [0.0, 0.0, 1.0]);
        scene.cuts = vec![Cut { normal: [1.0, 0.0, 1.0], through_voxel }];
        for offset in [0.0, 0.4] {
            let of_frame = run(&scene, &machine(RayEnds::Exact, offset));
            let axes = of_frame.0.geometry.axes;
            for x in 1..32_i64 {
                let length = (through_voxel[0] + through_voxel[2] - x as f64).clamp(0.0, 32.0);
                let [u, v] = if axes.axis[0] == 0 { [x, 5] } else { [5, x] };
                let grey = grey(&of_frame, u, v);
                let off = through(0.05, length + 1.0 / 32.0 + 1e-3) - through(0.05, length);
                assert!((grey - through(0.05, length)).abs() <= off + 0.05, "x = {x}, offset {offset}: {grey}");
            }
        }
    }
}

/// Fog about an eye on the middle voxel: the ray straight ahead has 16 samples behind the eye, and they are a step of 1 apart.
#[test]
fn the_ray_straight_ahead_of_an_eye_has_its_own_length() {
    let mut scene = fog(0.02, [0.0, 1.0, 0.0]);
    scene.view.perspective =
        Some(Perspective { field_of_view_deg: 60.0, eye_voxel: Some([16.0; 3]), distance_voxel: None });
    // Tables of ends are by parts of the longest step, √3, of which an end is 1/64 off at most.
    for (ends, steps, off) in [(RayEnds::Published, 16.0, 0.0), (RayEnds::Exact, 16.0, 2.0 * 3_f64.sqrt() / 64.0)] {
        let mut machine = machine(ends, 0.5);
        machine.rays.template = TemplateRule::SampleFloor;
        let grey = grey(&run(&scene, &machine), 16, 16);
        let off = through(0.02, steps + off) - through(0.02, steps);
        assert!((grey - through(0.02, steps)).abs() < 0.1 + off, "{ends:?}: {grey}");
    }
}

/// A ray that is full from end to end is full in the mean, and nothing overflows; half of it is half.
#[test]
fn a_weighted_sum_of_parts_is_the_mean_over_the_length() {
    for direction in [[0.0, 0.0, 1.0], [0.3, 0.1, 1.0]] {
        for offset in [0.0, 0.1, 0.3, 0.5, 0.9] {
            let mut scene = Scene { mode: Mode::WeightedSum, ..fog(1.0, direction) };
            let machine = MachineSpec { words: cube3_word::Words::default(), ..machine(RayEnds::Exact, offset) };
            let full = run(&scene, &machine);
            let u = if direction[0] == 0.0 { 16 } else { 10 };
            assert!((grey(&full, u, 16) - RANGE).abs() < 0.5, "{offset}: {}", grey(&full, u, 16));
            assert!(direction[0] != 0.0 || full.1.overflows.pixel == 0, "{offset}: {}", full.1.overflows.pixel);
            scene.crop = Some(Crop { min_voxel: [0.0; 3], max_voxel: [32.0, 32.0, 16.0] });
            let half = grey(&run(&scene, &machine), u, 16);
            assert!((half - RANGE / 2.0).abs() < RANGE / 2048.0 + 0.2, "{offset}: {half}");
        }
    }
}
