//! `cube3 run --frames`: frames and animation that appear, views that come back, volumes that are shown whole or torn as the port says.

use crate::checked;
use png::{ColorType, Decoder};
use serde_json::Value;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::process::{Command, Output};

fn cube3(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

/// Runs with a small picture of a volume of 16 voxels a side on 16 lanes.
fn run(folder: &Path, out: &str, more: &[&str]) -> Output {
    for (name, text) in [("small.toml", "[image]\nwidth_px = 40\nheight_px = 30\n"), ("lanes.toml", "lanes = 16\n")] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let scene = if more.contains(&"--scene") { vec![] } else { vec!["--scene", "small.toml"] };
    let arguments = [&["run", "--machine", "lanes.toml", "--out", out], scene.as_slice(), more].concat();
    cube3(folder, &arguments)
}

fn report(folder: &Path, out: &str, more: &[&str]) -> Value {
    let output = run(folder, out, more);
    assert!(output.status.success(), "{more:?}: {}", String::from_utf8_lossy(&output.stderr));
    checked::report(&folder.join(out))
}

const HEART: [&str; 4] = ["--phantom", "beating-heart", "--size", "16"];

fn heart(folder: &Path, out: &str, more: &[&str]) -> Value {
    report(folder, out, &[HEART.as_slice(), more].concat())
}

fn frames(report: &Value) -> &Vec<Value> {
    report["sequence"]["frames"].as_array().unwrap()
}

fn images(report: &Value) -> Vec<String> {
    frames(report).iter().map(|frame| frame["digest"]["image"].as_str().unwrap().to_owned()).collect()
}

/// The frames of a PNG file, each as red, green and blue of every pixel.
fn decoded(png: &Path) -> Vec<Vec<u8>> {
    let mut reader = Decoder::new(BufReader::new(File::open(png).unwrap())).read_info().unwrap();
    let (info, size) = (reader.info().clone(), reader.output_buffer_size().unwrap());
    assert_eq!(info.color_type, ColorType::Rgb);
    let frames = info.animation_control.map_or(1, |control| control.num_frames);
    let mut next = |_| {
        let mut rgb = vec![0; size];
        let frame = reader.next_frame(&mut rgb).unwrap();
        assert_eq!((frame.width, frame.height), (info.width, info.height));
        rgb
    };
    (0..frames).map(&mut next).collect()
}

fn rgb(png: &Path) -> Vec<u8> {
    decoded(png).remove(0)
}

#[test]
fn the_animation_holds_the_frames_and_each_is_a_picture_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let report = heart(folder.path(), "out", &["--frames", "5", "--turntable", "90", "--reference", "none"]);
    let out = folder.path().join("out");
    let animation = decoded(&out.join("animation.png"));
    assert_eq!(animation.len(), 5);
    for (index, shown) in animation.iter().enumerate() {
        assert_eq!(&rgb(&out.join(format!("frames/frame_{index:04}.png"))), shown, "{index}");
    }
    assert_eq!(rgb(&out.join("image.png")), animation[0]);
    let mut images = images(&report);
    images.dedup();
    assert_eq!(images.len(), 5);
    assert!(!out.join(".frames.part").exists());

    heart(folder.path(), "out", &["--frames", "2", "--reference", "none"]);
    assert_eq!(std::fs::read_dir(out.join("frames")).unwrap().count(), 2, "none of the longer sequence is left");
    heart(folder.path(), "out", &["--reference", "none"]);
    assert!(!out.join("frames").exists() && !out.join("animation.png").exists(), "nor of any beside a single frame");
}

#[test]
fn one_frame_is_a_plain_run_and_a_volume_that_stands_still_gives_one_picture_n_times() {
    let folder = tempfile::tempdir().unwrap();
    let still = ["--size", "16"];
    let plain = report(folder.path(), "plain", &still);
    let one = report(folder.path(), "one", &["--size", "16", "--frames", "1"]);
    for key in ["timing", "digest", "error", "units", "channels", "view", "plan", "words", "volume"] {
        assert_eq!(plain[key], one[key], "{key}");
    }
    assert!(plain.get("sequence").is_none() && plain["timing"].get("frames").is_none());
    for name in ["image.png", "base_plane.png", "reference.png", "difference.png"] {
        assert_eq!(rgb(&folder.path().join("plain").join(name)), rgb(&folder.path().join("one").join(name)), "{name}");
    }
    let four = report(folder.path(), "four", &["--size", "16", "--frames", "4"]);
    assert_eq!(images(&four), vec![plain["digest"]["image"].as_str().unwrap(); 4]);
    assert_eq!(four["timing"]["frames"], 4);
    assert!(four["sequence"]["acquisition"].is_null(), "nothing comes in");
    for frame in frames(&four) {
        assert_eq!(frame["error"]["mean_relative"], plain["error"]["mean_relative"]);
    }
}

#[test]
fn a_turntable_comes_back_and_keys_are_met() {
    let folder = tempfile::tempdir().unwrap();
    let run = |out: &str, more: &[&str]| {
        report(folder.path(), out, &[&["--size", "16", "--reference", "none"], more].concat())
    };
    let turned = images(&run("turned", &["--frames", "6", "--turntable", "720"]));
    assert_eq!(turned[..3], turned[3..]);
    assert_ne!(turned[0], turned[1]);
    assert_eq!(turned[0], run("plain", &[])["digest"]["image"]);
    assert_eq!(turned[1], run("third", &["--yaw", "150"])["digest"]["image"]);

    std::fs::write(
        folder.path().join("keys.toml"),
        "[image]\nwidth_px = 40\nheight_px = 30\n[[path.key]]\nframe = 1\nyaw_deg = -20.0\ntilt_deg = 30.0\n[[path.key]]\nframe = 3\nyaw_deg = 50.0\n",
    )
    .unwrap();
    let keyed = images(&run("keyed", &["--frames", "4", "--scene", "keys.toml"]));
    for (frame, yaw, tilt) in [(0, "-20", "30"), (1, "-20", "30"), (2, "15", "18.5"), (3, "50", "7")] {
        let plain = run("at", &["--yaw", yaw, "--tilt", tilt]);
        assert_eq!(keyed[frame], plain["digest"]["image"], "frame {frame}");
    }
    let again =
        report(folder.path(), "again", &["--scene", "keyed/scene.toml", "--frames", "4", "--reference", "none"]);
    assert_eq!(images(&again), keyed, "the path is written with the scene");
}

#[test]
fn a_series_of_files_is_shown_volume_by_volume_behind_a_double_buffer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let names = ["a.nrrd", "b.nrrd", "c.nrrd"];
    for (name, phase) in names.iter().zip(["0", "0.2", "0.5"]) {
        let made =
            cube3(path, &["volume", "phantom", "beating-heart", "--size", "16", "--phase", phase, "--out", name]);
        assert!(made.status.success());
    }
    let series = [&["--volume"], names.as_slice()].concat();
    let double = ["--frames", "4", "--acquisition", "double-buffer", "--reference", "none"];
    let shown = report(path, "series", &[series.as_slice(), &double].concat());
    let volumes: Vec<u64> = frames(&shown).iter().map(|frame| frame["volume"].as_u64().unwrap()).collect();
    assert_eq!(volumes, [0, 1, 2, 2], "the last volume stays");
    for (image, volume) in images(&shown).iter().zip(volumes) {
        let alone = report(path, "alone", &["--volume", names[volume as usize], "--reference", "none"]);
        assert_eq!(image, &alone["digest"]["image"]);
    }
    let again = report(path, "again", &[&["--scene", "series/scene.toml"], double.as_slice()].concat());
    assert_eq!(images(&again), images(&shown), "the series is written with the scene");
    let function = report(path, "f", &[series.as_slice(), &["--frames", "4", "--fidelity", "function"]].concat());
    assert_eq!(images(&function), images(&shown), "without a clock frame f shows volume f");
    assert!(function["timing"].is_null() && function["sequence"]["fps_sustained"].is_null());
}

#[test]
fn frames_tear_as_the_port_says_and_real_data_shows_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let mut cycles = Vec::new();
    for (mode, rate) in [("dual-port", "16"), ("cycle-stealing", "5"), ("double-buffer", "16")] {
        let run = |out: &str, more: &[&str]| {
            let port = ["--frames", "4", "--acquisition", mode, "--words-per-cycle", rate, "--reference", "none"];
            heart(folder.path(), out, &[port.as_slice(), more].concat())
        };
        let both = run("both", &[]);
        let acquisition = &both["sequence"]["acquisition"];
        assert_eq!(acquisition["mode"], mode);
        let torn = frames(&both).iter().filter(|frame| frame["torn"] == true).count();
        assert_eq!(acquisition["torn_frames"], torn);
        assert_eq!(torn > 0, mode != "double-buffer", "{mode}");
        assert_eq!(acquisition["stolen_cycles"].as_u64().unwrap() > 0, mode == "cycle-stealing");
        assert_eq!(acquisition["buffers"], if mode == "double-buffer" { 2 } else { 1 });
        cycles.push(both["timing"]["cycles"].as_u64().unwrap() - acquisition["stolen_cycles"].as_u64().unwrap());
        let real = run("cycle", &["--fidelity", "cycle"]);
        assert_eq!(real["sequence"], both["sequence"], "{mode}");
        assert_eq!(real["words"], both["words"], "{mode}");
        let mut threads = ["1", "3"].map(|threads| run("threads", &["--threads", threads]));
        threads.iter_mut().for_each(|report| report["wall"] = Value::Null);
        assert_eq!(threads[0], threads[1], "{mode}");
    }
    assert_eq!(cycles[0], cycles[1]);
    assert_eq!(cycles[0], cycles[2]);
}

/// An eye near the volume, whose pictures are put together from several base planes.
const EYE: [&str; 4] = ["--fov", "90", "--distance", "9"];

#[test]
fn in_perspective_each_frame_is_the_picture_that_it_is_alone() {
    let folder = tempfile::tempdir().unwrap();
    let run = |out: &str, more: &[&str]| {
        report(folder.path(), out, &[&["--size", "16", "--reference", "none"], EYE.as_slice(), more].concat())
    };
    let alone: Vec<Value> = ["30", "70", "110"].map(|yaw| run("alone", &["--yaw", yaw])).into();
    let expected: Vec<&Value> = alone.iter().map(|report| &report["digest"]).collect();
    assert_ne!(expected[0], expected[1]);
    for fidelity in ["both", "cycle", "function"] {
        let turned = run("turned", &["--frames", "3", "--turntable", "120", "--fidelity", fidelity]);
        let digests: Vec<&Value> = frames(&turned).iter().map(|frame| &frame["digest"]).collect();
        assert_eq!(digests, expected, "{fidelity}");
        if fidelity == "function" {
            continue;
        }
        // The beams, rays and samples of a picture are those of its passes, one behind another.
        for key in ["beams", "ray_slots", "samples"] {
            let sum: u64 = alone.iter().map(|report| report["timing"][key].as_u64().unwrap()).sum();
            assert_eq!(turned["timing"][key], sum, "{fidelity} {key}");
        }
        let ends: Vec<u64> = frames(&turned).iter().map(|frame| frame["end_cycle"].as_u64().unwrap()).collect();
        assert_eq!(ends[0], alone[0]["timing"]["cycles"].as_u64().unwrap(), "{fidelity}");
        assert_eq!(ends[2], turned["timing"]["cycles"].as_u64().unwrap(), "{fidelity}");
    }
}

#[test]
fn in_perspective_a_double_buffer_shows_each_volume_as_it_is_alone() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let names = ["a.nrrd", "b.nrrd"];
    for (name, phase) in names.iter().zip(["0", "0.4"]) {
        let made =
            cube3(path, &["volume", "phantom", "beating-heart", "--size", "16", "--phase", phase, "--out", name]);
        assert!(made.status.success());
    }
    let eye = [EYE.as_slice(), &["--reference", "none"]].concat();
    let series = |fidelity: &str| {
        let port =
            ["--frames", "6", "--turntable", "240", "--acquisition", "double-buffer", "--words-per-cycle", "0.25"];
        let more =
            [&["--volume"], names.as_slice(), eye.as_slice(), port.as_slice(), &["--fidelity", fidelity]].concat();
        report(path, fidelity, &more)
    };
    let (both, cycle) = (series("both"), series("cycle"));
    assert_eq!(both["sequence"], cycle["sequence"]);
    let mut shown = Vec::new();
    for (index, frame) in frames(&both).iter().enumerate() {
        let volume = frame["volume"].as_u64().unwrap();
        assert_eq!(frame["torn"], frame["newest_volume"] != frame["volume"]);
        assert_eq!(frame["mixed_beams"], 0, "the buffers change roles between frames of the machine");
        if frame["torn"] == true {
            continue;
        }
        shown.push(volume);
        let yaw = (30 + 40 * index).to_string();
        let one = [["--volume", names[volume as usize], "--yaw", &yaw].as_slice(), eye.as_slice()].concat();
        assert_eq!(frame["digest"], report(path, "alone", &one)["digest"], "frame {index}");
    }
    assert!(shown.len() >= 5 && shown.is_sorted() && shown[0] == 0 && shown[4] == 1, "{shown:?}");
}

#[test]
fn a_torn_picture_is_further_from_its_reference_than_a_whole_one() {
    let folder = tempfile::tempdir().unwrap();
    let error = |mode: &str| {
        // Against the machine's own samples in reals, a whole frame is off by its word lengths alone.
        let more = ["--frames", "2", "--phase-per-frame", "0.35", "--acquisition", mode, "--reference", "sheared"];
        let report = heart(folder.path(), "out", &more);
        frames(&report)[1]["error"]["rms"].as_f64().unwrap()
    };
    assert!(error("dual-port") > 50.0 * error("double-buffer"));
}

#[test]
fn mistakes_get_one_message_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for (name, size) in [("a.nrrd", "8"), ("b.nrrd", "9")] {
        assert!(cube3(path, &["volume", "phantom", "sphere", "--size", size, "--out", name]).status.success());
    }
    std::fs::write(path.join("direction.toml"), "[view]\ndirection = [0.0, 1.0, 0.0]\n").unwrap();
    let cases: [(&[&str], &str); 11] = [
        (&["--frames", "0"], "1..=100000"),
        (&["--turntable", "360"], "--frames"),
        (&["--phase-per-frame", "0.1"], "--frames"),
        (&["--volume", "a.nrrd", "b.nrrd"], "give --frames N too"),
        (&["--volume", "a.nrrd", "b.nrrd", "--frames", "2"], "the volumes of a series need one grid"),
        (&["--volume", "a.nrrd", "missing.nrrd", "--frames", "2"], "missing.nrrd"),
        (&["--size", "8", "--phase", "0.5"], "head does not move"),
        (&["--size", "8", "--frames", "2", "--phase-per-frame", "0.5"], "phantom head does not move"),
        (&["--volume", "a.nrrd", "--phase", "0.5"], "volume.phase"),
        (&["--size", "8", "--frames", "2", "--words-per-cycle", "0"], "acquisition.words_per_cycle"),
        (&["--size", "8", "--scene", "direction.toml", "--frames", "2", "--turntable", "9"], "given by a direction"),
    ];
    for (arguments, expected) in cases {
        let output = run(path, "out", arguments);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert_eq!(message.trim_end().lines().count(), 1, "{arguments:?}: {message}");
        assert!(!path.join("out/frames").exists() && !path.join("out/.frames.part").exists(), "{arguments:?}");
    }
}
