//! Pictures of known length and value: crops at every angle, single slices, bright voxels, and what a reference says of itself.

use cube3::{RunOptions, RunResult, Runs};
use cube3_inputs::{self as inputs, LoadedVolume};
use cube3_machine::{MachineSpec, RayEnds};
use cube3_method::Choice;
use cube3_picture::Picture;
use cube3_scene::{ColourPoint, Crop, Image, Material, Mode, Scene, View};
use cube3_volume::Volume;

/// An unlit scene of a transfer function, seen along y unless turned; an even number of pixels, a quarter of a voxel wide.
fn scene(opacity: &[[f64; 2]]) -> Scene {
    let mut scene = Scene {
        view: View::from_angles(0.0, 0.0),
        image: Image { width_px: 64, height_px: 64, pixel_size_voxel: Some(0.25) },
        material: Material { shaded: false, ..Material::default() },
        ..Scene::default()
    };
    scene.transfer.opacity = opacity.to_vec();
    scene
}

fn machine(offset: f64, ends: RayEnds) -> MachineSpec {
    let mut machine = MachineSpec::default();
    (machine.rays.offset, machine.rays.ends) = (offset, ends);
    // So that a word of opacity does not show.
    machine.words.opacity_bits = 16;
    machine
}

fn load(dims: [usize; 3], value: impl Fn(usize, usize, usize) -> u8 + Sync) -> LoadedVolume {
    let volume = Volume::from_fn(dims, [1.0; 3], value).unwrap();
    inputs::to_words("test".into(), volume, Some([0.0, 255.0]), &MachineSpec::default(), false).unwrap()
}

fn run(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume, reference: Option<Choice>) -> RunResult {
    let options = RunOptions { runs: Runs::Function, reference, ..RunOptions::default() };
    cube3::run(scene, machine, volume, &options).unwrap()
}

/// The middle of a picture, of 255.
fn middle(picture: Option<&Picture>) -> f64 {
    let picture = picture.unwrap();
    255.0 * picture.pixels[picture.height / 2 * picture.width + picture.width / 2][0]
}

fn both(result: &RunResult) -> [f64; 2] {
    [middle(result.pictures.image.as_ref()), middle(result.pictures.reference.as_ref())]
}

fn brightest(picture: Option<&Picture>) -> f64 {
    255.0 * picture.unwrap().pixels.iter().map(|pixel| pixel[0]).fold(0.0, f64::max)
}

fn through(opacity: f64, length: f64) -> f64 {
    255.0 * (1.0 - (1.0 - opacity).powf(length))
}

/// In the published machine too a crop of two voxels has two samples, at every offset that an angle leaves.
#[test]
fn a_crop_of_two_voxels_does_not_flash_at_45_degrees() {
    let volume = load([33; 3], |_, _, _| 100);
    let mut scene = scene(&[[0.0, 0.1]]);
    scene.crop = Some(Crop { min_voxel: [0.0, 16.0, 0.0], max_voxel: [32.0, 18.0, 32.0] });
    for ends in [RayEnds::Published, RayEnds::Exact] {
        for yaw in [0.0_f64, 44.0, 44.7, 44.8, 44.9, 45.0, 45.1, 46.0] {
            scene.view = View::from_angles(yaw, 0.0);
            let right = through(0.1, 2.0 / yaw.to_radians().cos());
            let [machine, reference] =
                both(&run(&scene, &machine(0.5, ends), &volume, Some(Choice::of(&cube3_method::IMAGE_ORDER))));
            assert!((reference - right).abs() < 1e-6, "{reference}, not {right} at {yaw}°");
            // Beyond 45° the crop's faces lie along the planes of samples, and a ray has as many as it meets.
            assert!((machine - right).abs() < if yaw > 45.0 { 2.5 } else { 0.9 }, "{machine}, not {right} at {yaw}°");
        }
    }
}

/// One slice of opacity ½ is half opaque from its front and from its back, with the same light.
#[test]
fn a_slice_is_one_thick_from_both_sides() {
    let volume = load([16, 16, 1], |_, _, _| 100);
    assert_eq!((volume.dims(), volume.words.dims), ([16, 16, 1], [16, 16, 2]));
    for ends in [RayEnds::Published, RayEnds::Exact] {
        let mut lit = Vec::new();
        for z in [-1.0, 1.0] {
            let mut scene = scene(&[[0.0, 0.5]]);
            scene.view = View::from_direction([0.0, 0.0, z], Some([0.0, 1.0, 0.0]));
            let [machine_, reference] =
                both(&run(&scene, &machine(0.5, ends), &volume, Some(Choice::of(&cube3_method::IMAGE_ORDER))));
            assert!((machine_ - 127.5).abs() < 0.1 && (reference - 127.5).abs() < 1e-9, "{machine_}, {reference}");
            scene.crop = Some(Crop { min_voxel: [0.0; 3], max_voxel: [15.0, 15.0, 0.0] });
            let cropped =
                both(&run(&scene, &machine(0.5, ends), &volume, Some(Choice::of(&cube3_method::IMAGE_ORDER))));
            assert_eq!(cropped, [machine_, reference], "a crop box that holds the voxel holds all of it");
            scene.crop = None;
            scene.material.shaded = true;
            lit.push(both(&run(&scene, &machine(0.5, ends), &volume, Some(Choice::of(&cube3_method::IMAGE_ORDER)))));
        }
        assert_eq!(lit[0], lit[1]);
    }
}

/// A voxel of 255 is 255 on the base plane, and where pixels lie an eighth of a voxel beside it what interpolation gives there.
#[test]
fn a_bright_voxel_keeps_its_value_in_a_maximum_projection() {
    let volume = load([16; 3], |x, y, z| if [x, y, z] == [8; 3] { 255 } else { 0 });
    let mut scene = Scene { mode: Mode::Maximum, ..scene(&[[0.0, 1.0]]) };
    scene.transfer.colour =
        vec![ColourPoint { value: 0.0, rgb: [0.0; 3] }, ColourPoint { value: 255.0, rgb: [1.0; 3] }];
    for offset in [0.0, 0.5] {
        let result =
            run(&scene, &machine(offset, RayEnds::Published), &volume, Some(Choice::of(&cube3_method::IMAGE_ORDER)));
        assert!((brightest(result.pictures.base_plane.as_ref()) - 255.0).abs() < 0.1);
        let beside = 255.0 * 0.875 * 0.875;
        for picture in [&result.pictures.image, &result.pictures.reference] {
            assert!((brightest(picture.as_ref()) - beside).abs() < 0.3, "{}", brightest(picture.as_ref()));
        }
    }
}

/// Machine and reference sample layers where they are brightest, and agree; the integral does not.
#[test]
fn a_pattern_that_aliases_in_both_is_seen_in_the_references_own_error() {
    let volume = load([16, 33, 16], |_, y, _| if y % 2 == 1 { 200 } else { 0 });
    // Of the 2 voxels from dark to dark a twentieth is above 190: 1.6 voxels in all.
    let scene = scene(&[[190.0, 0.0], [190.0, 0.04]]);
    let right = through(0.04, 1.6);
    let coarse = run(&scene, &machine(0.0, RayEnds::Published), &volume, Some("image-order:1".parse().unwrap()));
    let [machine_, reference] = both(&coarse);
    assert!((machine_ - through(0.04, 16.0)).abs() < 0.1 && (reference - machine_).abs() < 0.1);
    let error = coarse.report.error.unwrap();
    let own = error.reference.clone().unwrap();
    assert_eq!((own.of.as_str(), own.against.as_str()), ("image-order:1", "converged:1e-5"));
    assert!(own.against_bound.is_some_and(|bound| bound <= 1e-5));
    // What is measured is the volume's border, over which the warp fades.
    let measured = error.footprint.error.unwrap().mean_relative;
    assert!(own.error.mean_relative > 4.0 * measured, "{own:?} beside {measured}");
    let told = coarse.notes.iter().any(|note| note.contains("--reference converged"));
    assert!(told, "{:?}", coarse.notes);
    let fine = run(&scene, &machine(0.0, RayEnds::Published), &volume, Some("image-order:0.0078125".parse().unwrap()));
    assert!((both(&fine)[1] - right).abs() < 0.7, "{} of {right}", both(&fine)[1]);
    let error = fine.report.error.unwrap();
    assert!(error.footprint.error.unwrap().mean_relative > 0.3 && error.reference.unwrap().error.mean_relative < 0.01);
}

/// Whole steps at the ends of rays are told of where they show, and only there.
#[test]
fn a_note_says_where_the_ends_of_rays_show() {
    let told = |result: &RunResult| result.notes.iter().any(|note| note.contains("rays.ends = \"exact\""));
    let volume = load([33; 3], |_, _, _| 100);
    let fog = scene(&[[0.0, 0.02]]);
    for (offset, ends, expected) in
        [(0.0, RayEnds::Published, true), (0.0, RayEnds::Exact, false), (0.5, RayEnds::Published, false)]
    {
        let result = run(&fog, &machine(offset, ends), &volume, None);
        assert_eq!(told(&result), expected, "offset {offset}, {ends:?}: {:?}", result.notes);
    }
    let inner = load([33; 3], |x, y, z| if [x, y, z].iter().all(|i| (8..25).contains(i)) { 100 } else { 0 });
    let block = scene(&[[50.0, 0.0], [50.0, 0.02]]);
    assert!(!told(&run(&block, &machine(0.0, RayEnds::Published), &inner, None)));
    let cropped = Scene {
        crop: Some(Crop { min_voxel: [0.0, 12.5, 0.0], max_voxel: [32.0, 13.0, 32.0] }),
        transfer: cube3_scene::Transfer { opacity: vec![[50.0, 0.0], [50.0, 0.3]], ..block.transfer.clone() },
        ..block
    };
    assert!(told(&run(&cropped, &machine(0.0, RayEnds::Published), &inner, None)));
}
