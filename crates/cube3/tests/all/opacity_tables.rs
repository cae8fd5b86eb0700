//! What the opacity table makes of a scene, against closed forms; and which notes a run has, with the reason that is true.

use cube3::sequence::run_sequence;
use cube3::{RunOptions, RunResult, Runs};
use cube3_inputs::Series;
use cube3_inputs::{self as inputs, LoadedVolume};
use cube3_machine::{MachineSpec, RayEnds};
use cube3_method::Choice;
use cube3_report::{NO_OBJECT, OpacityReport};
use cube3_scene::{Crop, Image, Material, Mode, Scene, Threshold, View, VolumeSource};
use cube3_volume::{Phantom, ReadOptions, Volume};

/// An unlit scene of a transfer function, seen along y.
fn scene(opacity: &[[f64; 2]]) -> Scene {
    let mut scene = Scene {
        view: View { yaw_deg: 0.0, tilt_deg: 0.0, ..View::default() },
        image: Image { width_px: 32, height_px: 32, pixel_size_voxel: Some(0.5) },
        material: Material { shaded: false, ..Material::default() },
        ..Scene::default()
    };
    scene.transfer.opacity = opacity.to_vec();
    scene
}

/// The default machine with samples on the planes of voxels.
fn machine() -> MachineSpec {
    let mut machine = MachineSpec::default();
    machine.rays.offset = 0.0;
    machine
}

fn words(volume: Volume, window: Option<[f64; 2]>) -> LoadedVolume {
    inputs::to_words("test".into(), volume, window, &MachineSpec::default(), false).unwrap()
}

const FUNCTION: RunOptions =
    RunOptions { runs: Runs::Function, reference: None, cache: None, plan: true, limits: true, seed: 0 };

fn run(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume) -> RunResult {
    cube3::run(scene, machine, volume, &FUNCTION).unwrap()
}

fn opacity(result: &RunResult) -> OpacityReport {
    result.report.words.opacity.unwrap()
}

fn brightest(result: &RunResult) -> f64 {
    result.pictures.image.as_ref().unwrap().pixels.iter().map(|pixel| pixel[0]).fold(0.0, f64::max)
}

/// The one note of a run.
fn note(result: &RunResult) -> &str {
    let [note] = result.notes.as_slice() else { panic!("{:?}", result.notes) };
    note
}

/// The number behind a key in a note.
fn advised(note: &str, key: &str) -> u32 {
    let number = note.split(&format!("{key} = ")).last().unwrap();
    number.split(|c: char| !c.is_ascii_digit()).next().unwrap().parse().unwrap()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-3 * b.abs()
}

/// 512 samples of one opacity along each ray.
fn fog() -> LoadedVolume {
    words(Volume::from_fn([4, 512, 4], [1.0; 3], |_, _, _| 100_u8).unwrap(), Some([0.0, 255.0]))
}

fn of_fog(opacity: f64) -> Scene {
    scene(&[[0.0, opacity]])
}

#[test]
fn fog_below_half_a_word_is_lost_and_the_note_has_the_word_that_holds_it() {
    let (scene, volume) = (of_fog(1e-4), fog());
    let result = run(&scene, &machine(), &volume);
    let found = opacity(&result);
    assert_eq!((found.shown_fraction, found.lost_fraction, found.off_fraction), (1.0, 1.0, 1.0));
    assert_eq!((found.rounding.fraction, found.rounding.ray_more, found.entries.fraction), (1.0, 0.0, 0.0));
    assert!(close(found.rounding.ray_less, 512.0 * 1e-4), "{found:?}");
    assert!(note(&result).starts_with("nothing is visible: opacities of 100 % of the voxels"), "{}", note(&result));

    let mut longer = machine();
    longer.words.opacity_bits = advised(note(&result), "words.opacity_bits");
    let held = run(&scene, &longer, &volume);
    let right = 1.0 - (1.0 - 1e-4_f64).powi(512);
    assert!((brightest(&held) / right - 1.0).abs() < 0.1, "{} of {right}", brightest(&held));
    assert_eq!(held.notes, [""; 0]);
}

#[test]
fn fog_that_rounds_up_is_nearly_twice_as_dense_and_the_note_says_so() {
    let (scene, volume) = (of_fog(1.3e-4), fog());
    let result = run(&scene, &machine(), &volume);
    let found = opacity(&result);
    assert_eq!((found.lost_fraction, found.off_fraction, found.rounding.fraction), (0.0, 1.0, 1.0));
    assert_eq!(found.rounding.ray_less, 0.0);
    assert!(close(found.rounding.ray_more, 512.0 * (1.0 / 4095.0 - 1.3e-4)), "{found:?}");
    assert!(close(found.smallest_opacity, 1.0 / 4095.0));
    assert!(note(&result).contains("0.00013 becomes 0.000244"), "{}", note(&result));

    let mut longer = machine();
    longer.words.opacity_bits = advised(note(&result), "words.opacity_bits");
    let held = run(&scene, &longer, &volume);
    let right = 1.0 - (1.0 - 1.3e-4_f64).powi(512);
    assert!((brightest(&held) / right - 1.0).abs() < 0.1, "{} of {right}", brightest(&held));
    assert_eq!(held.notes, [""; 0]);
}

/// Opacities that the accumulator's shorter word drops: the key is the accumulator's.
#[test]
fn a_short_accumulator_is_named() {
    let mut machine = machine();
    machine.words.accumulator_bits = 8;
    let result = run(&of_fog(0.003), &machine, &fog());
    assert_eq!(opacity(&result).lost_fraction, 1.0);
    let note = note(&result);
    assert!(note.starts_with("nothing is visible: ") && note.contains("words of 8 bits"), "{note}");
    assert!(note.contains("words.accumulator_bits = ") && !note.contains("words.opacity_bits"), "{note}");
}

/// The check is of the tables, whatever runs.
#[test]
fn every_fidelity_has_the_note_and_a_sequence_has_it_too() {
    let (scene, volume) = (of_fog(1.3e-4), words(Volume::from_fn([4, 64, 4], [1.0; 3], |_, _, _| 9_u8).unwrap(), None));
    let expected = run(&scene, &machine(), &volume);
    assert!(note(&expected).contains("words.opacity_bits"));
    for runs in [Runs::Both, Runs::Timing, Runs::Cycle] {
        let result = cube3::run(&scene, &machine(), &volume, &RunOptions { runs, ..FUNCTION }).unwrap();
        assert_eq!((&result.notes, opacity(&result)), (&expected.notes, opacity(&expected)), "{runs:?}");
    }
    let phantom = VolumeSource { phantom: Some("fog".into()), size_voxels: Some(40), ..VolumeSource::default() };
    let scene = Scene { volume: phantom, ..of_fog(1.3e-4) };
    let read = ReadOptions::default();
    let mut series = Series::open(&scene, &machine(), &read, false, 2).unwrap();
    let result = run_sequence(&scene, &machine(), &mut series, 2, &FUNCTION, &mut |_| Ok(()), &|_, _, _| {}).unwrap();
    assert!(note(&result).contains("words.opacity_bits"));
    assert_eq!(opacity(&result).rounding.fraction, 1.0);
}

/// A plane of one value between those of a band that no entry's middle hits.
fn thin_band() -> (Scene, LoadedVolume) {
    let voxel = |x: usize, y: usize, z: usize| match [x, y, z] {
        [0, 0, 0] => u16::MAX,
        [_, 8, _] => 30_003,
        _ => 0,
    };
    let scene = scene(&[[30_001.0, 0.0], [30_002.0, 1.0], [30_004.0, 1.0], [30_005.0, 0.0]]);
    (scene, words(Volume::from_fn([16; 3], [1.0; 3], voxel).unwrap(), None))
}

#[test]
fn a_band_narrower_than_an_entry_is_lost_and_the_note_has_the_index_that_finds_it() {
    let (scene, volume) = thin_band();
    let result = run(&scene, &machine(), &volume);
    let found = opacity(&result);
    // One voxel of each column of sixteen, and one sample of each ray.
    assert_eq!((found.shown_fraction, found.lost_fraction, found.entry_width), (0.0625, 0.0625, 16.0));
    assert_eq!((found.entries.fraction, found.entries.ray_less, found.rounding.fraction), (0.0625, 1.0, 0.0));
    let text = note(&result);
    assert!(text.starts_with("nothing is visible: a table entry covers 16 values (words.table_bits = 12)"), "{text}");

    let mut longer = machine();
    longer.words.table_bits = advised(text, "words.table_bits");
    let held = run(&scene, &longer, &volume);
    assert!(brightest(&held) > 0.99);
    assert_eq!((opacity(&held).lost_fraction, held.notes.len()), (0.0, 0));
}

/// Voxels of 108 lie below the step at 108 by the middle of their entry, and on a slope no samples beside them have that value:
/// they are counted, and nothing can be seen.
#[test]
fn an_entry_that_samples_pass_through_is_counted_and_not_noted() {
    let slope = Volume::from_fn([16; 3], [1.0; 3], |x, y, z| 100 + ((x + y + z) % 16) as u8).unwrap();
    let result = run(&scene(&[[108.0, 0.0], [108.0, 0.9]]), &machine(), &words(slope, Some([0.0, 255.0])));
    let found = opacity(&result);
    assert_eq!((found.shown_fraction, found.lost_fraction, found.entries.fraction), (0.5, 0.0625, 0.0625));
    assert_eq!((found.entries.ray_less, found.entries.ray_more), (0.0, 0.0));
    assert_eq!(result.notes, [""; 0]);
}

#[test]
fn in_modes_of_surfaces_a_sample_is_opaque_or_not() {
    let mut machine = machine();
    machine.words.opacity_bits = 2;
    let mut scene = of_fog(0.51);
    (scene.mode, scene.transfer.opaque_alpha) = (Mode::FirstOpaque, 0.52);
    // Both are 2/3 as words of two bits, and the table makes opaque what is not.
    let found = opacity(&run(&scene, &machine, &fog()));
    assert_eq!((found.shown_fraction, found.lost_fraction, found.rounding.fraction), (0.0, 0.0, 1.0));
    assert_eq!(found.rounding.ray_more, 512.0);
    scene.transfer.opaque_alpha = 0.51;
    let found = opacity(&run(&scene, &machine, &fog()));
    assert_eq!((found.shown_fraction, found.off_fraction), (1.0, 0.0));
}

/// A mean of opacities is off by a word at most, and one sample's opacity too.
#[test]
fn modes_that_sum_no_opacities_have_no_note() {
    for (mode, checked) in [(Mode::WeightedSum, true), (Mode::Maximum, false), (Mode::Minimum, false)] {
        let result = run(&Scene { mode, ..of_fog(1.3e-4) }, &machine(), &fog());
        assert_eq!(result.notes, [""; 0], "{mode}");
        assert_eq!(result.report.words.opacity.is_some(), checked, "{mode}");
    }
}

/// 4096 values in 0..1, and one far away or not.
fn noise(far: f32) -> Volume {
    let value = |x: usize, y: usize, z: usize| match ((z * 16 + y) * 16 + x) * 1597 % 4096 {
        0 => far,
        place => place as f32 / 4096.0,
    };
    Volume::from_fn([16; 3], [1.0; 3], value).unwrap()
}

#[test]
fn an_outlier_that_takes_the_words_is_noted_and_a_window_helps() {
    let scene = scene(&[[0.0, 0.0], [1.0, 0.5]]);
    let result = run(&scene, &machine(), &words(noise(1e6), None));
    let text = note(&result);
    assert!(text.contains("all but 1 of 4,096 voxels") && text.contains("share 1 voxel word of 65,536"), "{text}");
    assert!(text.contains("volume.window = ["), "{text}");
    assert_eq!(run(&scene, &machine(), &words(noise(1e6), Some([0.0, 1.0]))).notes, [""; 0]);
    assert_eq!(run(&scene, &machine(), &words(noise(0.0), None)).notes, [""; 0]);
}

/// The words of an outlier's volume stand for nothing that is shown, and that is the reason.
#[test]
fn crowded_words_are_the_reason_where_they_hide_all() {
    let band = scene(&[[0.5, 0.0], [0.6, 0.5], [0.7, 0.5], [0.8, 0.0]]);
    let result = run(&band, &machine(), &words(noise(1e6), None));
    assert!(note(&result).starts_with("nothing is visible: all but 1 of 4,096 voxels"), "{}", note(&result));
}

/// Nothing is lost where the voxels of a word have one value, and where a person has set the window.
#[test]
fn sparse_volumes_labels_and_windows_are_no_outliers() {
    let of = |value: fn(usize) -> u8| {
        Volume::from_fn([16; 3], [1.0; 3], move |x, y, z| value((z * 16 + y) * 16 + x)).unwrap()
    };
    let dot = of(|place| if place == 1000 { 255 } else { 0 });
    let labels = of(|place| u8::from(place / 64 % 3 == 0));
    let scene = scene(&[[0.5, 0.0], [1.0, 1.0]]);
    assert_eq!(run(&scene, &machine(), &words(dot, None)).notes, [""; 0]);
    assert_eq!(run(&scene, &machine(), &words(labels, None)).notes, [""; 0]);
    // All but a few of the values lie below a window.
    let high = self::scene(&[[2e5, 0.0], [2e5, 1.0]]);
    assert_eq!(run(&high, &machine(), &words(noise(1e6), Some([1e5, 1e6]))).notes, [""; 0]);
}

#[test]
fn phantoms_with_a_fitting_scene_have_no_note() {
    let scene = |phantom: &str| {
        let volume = VolumeSource { phantom: Some(phantom.into()), size_voxels: Some(40), ..VolumeSource::default() };
        Scene { volume, ..Scene::default() }
    };
    for phantom in ["head", "sphere", "shepp-logan", "shells", "fog", "engine", "checker", "beating-heart"] {
        let scene = scene(phantom);
        let volume = inputs::load_volume(&scene, &MachineSpec::default(), &ReadOptions::default(), false).unwrap();
        // The checker reaches the border, where the ends of rays show.
        let mut notes = run(&scene, &MachineSpec::default(), &volume).notes;
        notes.retain(|note| phantom != "checker" || !note.contains("the ends of rays"));
        assert_eq!(notes, [""; 0], "{phantom}");
    }
}

/// The reason is the first on the way from the volume to the picture, and an empty picture has no error.
#[test]
fn what_hides_everything_is_said_and_has_no_error() {
    let solid = || words(Volume::from_fn([16; 3], [1.0; 3], |_, _, _| 100_u8).unwrap(), Some([0.0, 255.0]));
    let shown = scene(&[[50.0, 0.0], [60.0, 0.5]]);
    let crop = |from: f64, to: f64| Some(Crop { min_voxel: [from; 3], max_voxel: [to; 3] });
    let cut = cube3_scene::Cut { normal: [1.0, 0.0, 0.0], through_voxel: [-1.0, 0.0, 0.0] };
    let surface = Scene { mode: Mode::FirstOpaque, ..shown.clone() };
    let surface =
        Scene { transfer: cube3_scene::Transfer { opaque_alpha: 0.75, ..surface.transfer.clone() }, ..surface };
    for (scene, volume, reason) in [
        (Scene::default(), words(noise(0.0), None), "no voxel has a value that is shown"),
        (Scene { crop: crop(40.0, 50.0), ..shown.clone() }, solid(), "the crop box lies outside of the volume"),
        (Scene { crop: crop(4.2, 4.8), ..shown.clone() }, solid(), "the crop box leaves no voxel"),
        (Scene { cuts: vec![cut], ..shown.clone() }, solid(), "the cut planes leave no voxel"),
        (
            Scene { threshold: Some(Threshold { low: Some(120.0), high: None }), ..shown.clone() },
            solid(),
            "the threshold removes all voxels",
        ),
        (scene(&[[0.0, 0.0]]), solid(), "the transfer function is transparent everywhere"),
        (surface, solid(), "the transfer function's opacity is nowhere transfer.opaque_alpha = 0.75"),
    ] {
        let options = RunOptions { reference: Some(Choice::of(&cube3_method::IMAGE_ORDER)), ..FUNCTION };
        let result = cube3::run(&scene, &machine(), &volume, &options).unwrap();
        assert!(note(&result).starts_with(&format!("nothing is visible: {reason}")), "{reason}: {}", note(&result));
        let error = result.report.error.unwrap();
        if reason == "the crop box leaves no voxel" {
            // Rays of the reference have a length between voxels.
            assert!(error.footprint.pixels > 0 && error.whole.is_some());
            continue;
        }
        assert_eq!((error.whole, error.footprint.error, error.footprint.pixels), (None, None, 0), "{reason}");
        assert_eq!((error.remark.as_deref(), error.gradient_mean_deg), (Some(NO_OBJECT), None), "{reason}");
    }
}

/// A word of a weighted sum with exact ends is a part of the full one; it is no error of the table.
#[test]
fn the_word_of_a_whole_step_is_what_a_word_is_held_against() {
    let volume = words(Phantom::Head.generate(40, &Default::default()).unwrap(), None);
    let scene = Scene { mode: Mode::WeightedSum, ..Scene::default() };
    let mut machine = machine();
    machine.rays.ends = RayEnds::Exact;
    let result = run(&scene, &machine, &volume);
    assert_eq!(result.notes, [""; 0]);
    assert!(opacity(&result).off_fraction < 0.01, "{:?}", opacity(&result));
}

/// Frames of a sequence that show nothing have a remark each.
#[test]
fn empty_frames_of_a_sequence_have_no_error() {
    let phantom =
        VolumeSource { phantom: Some("marschner-lobb".into()), size_voxels: Some(16), ..VolumeSource::default() };
    let scene = Scene { volume: phantom, image: scene(&[]).image, ..Scene::default() };
    let mut series = Series::open(&scene, &machine(), &ReadOptions::default(), false, 2).unwrap();
    let options = RunOptions { reference: Some(Choice::of(&cube3_method::IMAGE_ORDER)), ..FUNCTION };
    let result = run_sequence(&scene, &machine(), &mut series, 2, &options, &mut |_| Ok(()), &|_, _, _| {}).unwrap();
    for frame in result.report.sequence.unwrap().frames {
        assert_eq!((frame.error, frame.remark.as_deref()), (None, Some(NO_OBJECT)));
    }
}

#[test]
fn threads_do_not_change_the_check() {
    let phantom = Phantom::Fog.generate(40, &Default::default()).unwrap();
    let volume = words(phantom, None);
    let scene = scene(&[[0.0, 0.0], [6000.0, 0.01]]);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let result = pool.install(|| run(&scene, &machine(), &volume));
        (opacity(&result), result.notes)
    };
    assert_eq!(on(1), on(5));
}
