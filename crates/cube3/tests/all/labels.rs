//! Label volumes from the scene to picture, report and notes.

use cube3::{RunOptions, RunResult, Runs};
use cube3_inputs::Series;
use cube3_inputs::{self as inputs, LoadedVolume};
use cube3_machine::{MachineSpec, RayEnds};
use cube3_method::Choice;
use cube3_scene::{ColourPoint, Image, Material, Mode, Perspective, Scene, Transfer, View, VolumeSource};
use cube3_volume::{ReadOptions, Volume};

/// Boxes of labels 1 to 5 in label 0.
fn boxes() -> Volume {
    Volume::from_fn([24; 3], [1.0; 3], |x, y, z| {
        let outside = [x, y, z].iter().any(|&at| !(4..20).contains(&at));
        if outside { 0_u8 } else { 1 + ((x / 4 + y / 3 + z / 5) % 5) as u8 }
    })
    .unwrap()
}

/// Not lit; label 3 alone is seen, in its own colour.
fn scene(yaw: f64) -> Scene {
    let colour = |value: f64, rgb| ColourPoint { value, rgb };
    Scene {
        volume: VolumeSource { labels: true, ..VolumeSource::default() },
        view: View::from_angles(yaw, 10.0),
        image: Image { width_px: 48, height_px: 48, ..Image::default() },
        transfer: Transfer {
            opacity: vec![[2.5, 0.0], [2.5, 0.5], [3.5, 0.5], [3.5, 0.0]],
            colour: vec![colour(2.0, [1.0, 0.0, 0.0]), colour(3.0, [0.0, 1.0, 0.0]), colour(4.0, [0.0, 0.0, 1.0])],
            ..Transfer::default()
        },
        material: Material { shaded: false, ..Material::default() },
        ..Scene::default()
    }
}

fn load(volume: Volume, machine: &MachineSpec) -> LoadedVolume {
    inputs::labels_to_words("test".into(), volume, None, machine, false).unwrap()
}

fn run(scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume, reference: Option<Choice>) -> RunResult {
    cube3::run(scene, machine, volume, &RunOptions { runs: Runs::Function, reference, ..RunOptions::default() })
        .unwrap()
}

/// Interpolated, every edge from label 5 to 0 would have a rim of label 3; the default machine shows the colour of label 3 and no other.
#[test]
fn no_colour_of_another_label_is_seen() {
    let machine = MachineSpec::default();
    let volume = load(boxes(), &machine);
    for yaw in [0.0, 20.0, 45.0, 70.0] {
        for eye in [None, Some(Perspective::new(40.0))] {
            let mut scene = scene(yaw);
            scene.view.perspective = eye;
            let result = run(&scene, &machine, &volume, Some(Choice::of(&cube3_method::IMAGE_ORDER)));
            // Steps end beside the faces of labels, which is told.
            assert!(result.notes.iter().all(|note| note.contains("the reference itself")), "{:?}", result.notes);
            for picture in [result.pictures.image, result.pictures.reference] {
                let pixels = picture.unwrap().pixels;
                assert!(pixels.iter().all(|pixel| pixel[0] == 0.0 && pixel[2] == 0.0), "yaw {yaw}");
                assert!(pixels.iter().any(|pixel| pixel[1] > 0.5));
            }
        }
    }
}

/// Against the same samples in reals words are all that differs, and a picture of a hundredth as many steps is as near.
#[test]
fn the_picture_is_that_of_true_but_for_words() {
    for ends in [RayEnds::Published, RayEnds::Exact] {
        let mut machine = MachineSpec::default();
        machine.rays.ends = ends;
        machine.words.opacity_bits = 16;
        let volume = load(boxes(), &machine);
        for yaw in [0.0, 30.0, 45.0] {
            let scene = scene(yaw);
            let error = |reference| {
                run(&scene, &machine, &volume, reference).report.error.unwrap().whole.unwrap().mean_relative
            };
            let [of_true, sheared] =
                [Some(Choice::of(&cube3_method::TRUE)), Some(Choice::of(&cube3_method::SHEARED))].map(error);
            assert_eq!(of_true.to_bits(), sheared.to_bits());
            assert!(of_true < if ends == RayEnds::Exact { 1e-3 } else { 0.05 }, "{of_true} at {yaw}°, {ends:?}");
        }
    }
}

/// One slice of a label is one voxel thick, from both sides, whatever the offset of the machine.
#[test]
fn a_slice_of_labels_is_one_voxel_thick() {
    let volume = Volume::from_fn([9, 9, 1], [1.0; 3], |_, _, _| 3_u8).unwrap();
    for ends in [RayEnds::Published, RayEnds::Exact] {
        let mut machine = MachineSpec::default();
        (machine.rays.ends, machine.words.opacity_bits) = (ends, 16);
        let volume = load(volume.clone(), &machine);
        assert_eq!(volume.dims(), [9, 9, 1]);
        for tilt in [90.0, -90.0] {
            let scene = Scene { view: View::from_angles(0.0, tilt), ..scene(0.0) };
            let pixels = run(&scene, &machine, &volume, None).pictures.image.unwrap().pixels;
            let brightest = pixels.iter().map(|pixel| pixel[1]).fold(0.0, f64::max);
            assert!((brightest - 0.5).abs() < 1e-3, "{brightest} at {tilt}°");
        }
    }
}

#[test]
fn the_report_says_that_these_are_labels() {
    let machine = MachineSpec::default();
    let report = run(&scene(20.0), &machine, &load(boxes(), &machine), None).report;
    let text = cube3_report::table(&report);
    let line = |name: &str| text.lines().find(|line| line.trim_start().starts_with(name)).unwrap().to_owned();
    assert!(line("Voxel words").contains("labels, not interpolated; window 0 to 4095.938"), "{text}");
    assert!(line("Sampling").contains("offset 0, nearest voxel, wrapped"), "{text}");
    assert_eq!(report.scene["volume"]["labels"], true);
}

/// With more labels than entries a note names the key; with as many index bits as it says they are told apart.
#[test]
fn labels_that_share_an_entry_have_a_note() {
    let mut machine = MachineSpec::default();
    machine.words.table_bits = 2;
    machine.words.voxel_bits = 4;
    machine.words.gradient_bits = 5;
    let labels = boxes().map::<u8>(|label| 3.0 * label);
    let mut scene = scene(20.0);
    // Label 9, which is 3 in the boxes, shares an entry with label 8.
    scene.transfer.opacity = vec![[8.5, 0.0], [8.5, 0.5], [9.5, 0.5], [9.5, 0.0]];
    let told = |machine: &MachineSpec| run(&scene, machine, &load(labels.clone(), machine), None).notes;
    let notes = told(&machine);
    assert!(
        notes.iter().any(|note| note.contains("words.table_bits = 4 in the machine file tells these labels apart")),
        "{notes:?}"
    );
    machine.words.table_bits = 4;
    assert_eq!(told(&machine), Vec::<String>::new());
}

#[test]
fn what_are_no_labels_is_refused_with_its_source() {
    let machine = MachineSpec::default();
    let refused = |volume: Volume| {
        inputs::labels_to_words("a.nrrd".into(), volume, None, &machine, false).err().unwrap().to_string()
    };
    let text = refused(boxes().map::<f32>(|label| label / 2.0));
    assert!(
        text.starts_with("a.nrrd: labels: voxel (") && text.contains("is 1.5, and a label is a whole number"),
        "{text}"
    );
    let text = refused(boxes().map::<u32>(|label| 20_000.0 * label));
    assert!(text.contains("the largest is 100000, and a voxel word of 16 bits holds 65535"), "{text}");
}

/// The volumes of a series share the first one's words, in which every later label has to have one.
#[test]
fn a_series_of_labels_has_one_window() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, most: f64| {
        let path = folder.path().join(name);
        cube3_volume::write(&path, &boxes().map::<u16>(|label| (label * most / 5.0).round())).unwrap();
        path
    };
    let files = [write("a.nrrd", 5.0), write("b.nrrd", 4095.0), write("c.nrrd", 4100.0)];
    let mut scene = scene(0.0);
    scene.volume = VolumeSource { labels: true, ..VolumeSource::from_files(files) };
    let machine = MachineSpec::default();
    let mut series = Series::open(&scene, &machine, &ReadOptions::default(), false, 3).unwrap();
    assert_eq!(series.volume(0).unwrap().words.window, series.volume(1).unwrap().words.window);
    let text = series.volume(2).err().unwrap().to_string();
    assert!(
        text.contains("c.nrrd: labels: the largest is 4100, and the words of the series' first volume go up to 4095"),
        "{text}"
    );
}

#[test]
fn modes_that_choose_a_value_choose_a_label() {
    let machine = MachineSpec::default();
    let volume = load(boxes(), &machine);
    let mut scene = Scene { mode: Mode::Maximum, ..scene(30.0) };
    scene.transfer.opacity = vec![[0.0, 1.0]];
    let result = run(&scene, &machine, &volume, Some(Choice::of(&cube3_method::SHEARED)));
    assert!(result.report.error.unwrap().whole.unwrap().mean_relative < 1e-3);
}
