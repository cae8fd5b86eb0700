//! Volumes of files in a run: their directions, their series, and what is said of them.

use crate::checked;
use std::path::Path;
use std::process::{Command, Output};

use cube3_volume::{ReadOptions, Volume, read};
use serde_json::Value;

/// A smooth lump that no turn or mirror maps onto itself, at voxel (x, y, z) of the world's order.
fn lump(x: usize, y: usize, z: usize) -> u8 {
    let near = |a: f64, b: f64, c: f64, r: f64| {
        let d = (x as f64 - a).powi(2) + (y as f64 - b).powi(2) + (z as f64 - c).powi(2);
        (1.0 - d / (r * r)).max(0.0)
    };
    (200.0 * (near(6.0, 9.0, 7.0, 6.0) + 0.7 * near(14.0, 6.0, 9.0, 4.0) + 0.5 * near(9.0, 11.0, 14.0, 3.0))).min(255.0)
        as u8
}

const DIMS: [usize; 3] = [20, 17, 18];

/// An NRRD of the lump whose stored axes lead where `directions` (signed axis numbers from 1, x fastest) say.
fn nrrd(path: &Path, directions: [i32; 3], header: &str) {
    let axis = directions.map(|d| d.unsigned_abs() as usize - 1);
    let sizes = axis.map(|a| DIMS[a]);
    let (mut voxels, mut origin, mut vectors) = (Vec::new(), [0.0; 3], String::new());
    for k in 0..sizes[2] {
        for j in 0..sizes[1] {
            for i in 0..sizes[0] {
                let mut at = [0; 3];
                for s in 0..3 {
                    at[axis[s]] = if directions[s] < 0 { sizes[s] - 1 - [i, j, k][s] } else { [i, j, k][s] };
                }
                voxels.push(lump(at[0], at[1], at[2]));
            }
        }
    }
    for s in 0..3 {
        let mut vector = [0; 3];
        vector[axis[s]] = directions[s].signum();
        vectors += &format!(" ({},{},{})", vector[0], vector[1], vector[2]);
        if directions[s] < 0 {
            origin[axis[s]] = (sizes[s] - 1) as f64;
        }
    }
    let text = format!(
        "NRRD0004\ntype: uchar\ndimension: 3\nsizes: {} {} {}\n{header}space directions:{vectors}\nspace origin: ({},{},{})\n\
         encoding: raw\n\n",
        sizes[0], sizes[1], sizes[2], origin[0], origin[1], origin[2]
    );
    std::fs::write(path, [text.as_bytes(), &voxels].concat()).unwrap();
}

fn cube3(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

fn run(folder: &Path, volume: &str, out: &str, more: &[&str]) -> String {
    let fixed = ["run", "--fidelity", "function", "--threads", "1", "--volume", volume, "--out", out];
    let output = cube3(folder, &[&fixed, more].concat());
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn report(folder: &Path, out: &str) -> Value {
    checked::report(&folder.join(out))
}

fn bytes(folder: &Path, file: &str) -> Vec<u8> {
    std::fs::read(folder.join(file)).unwrap()
}

const SCENE: &str = "schema = 2\n[image]\nwidth_px = 48\nheight_px = 48\n[transfer]\nopacity = [[20, 0], [120, 0.6]]\n\
    [crop]\nmin_voxel = [2, 1, 0]\nmax_voxel = [17, 16, 15]\n[[cut]]\nnormal = [1, 2, 0.5]\nthrough_voxel = [11, 9, 9]\n";

/// Pictures, errors and digests are those of the file that is stored to the right, front and head; cuts and crop too.
#[test]
fn a_file_is_drawn_by_its_directions_however_it_is_stored() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    std::fs::write(at.join("scene.toml"), SCENE).unwrap();
    let ras = "space: right-anterior-superior\n";
    nrrd(&at.join("ras.nrrd"), [1, 2, 3], ras);
    let views: [&[&str]; 2] = [&["--yaw", "40", "--tilt", "20"], &["--fov", "40", "--eye", "9,-20,12"]];
    for (view, more) in views.into_iter().enumerate() {
        let more = [more, &["--scene", "scene.toml"]].concat();
        run(at, "ras.nrrd", &format!("ras{view}"), &more);
        for (name, directions, letters) in [
            ("las", [-1, 2, 3], "LAS"),
            ("pir", [-2, -3, 1], "PIR"),
            ("lps", [-1, -2, 3], "LPS"),
            ("sar", [3, 2, 1], "SAR"),
        ] {
            nrrd(&at.join(format!("{name}.nrrd")), directions, ras);
            let out = format!("{name}{view}");
            run(at, &format!("{name}.nrrd"), &out, &more);
            for picture in ["image.png", "base_plane.png", "reference.png", "difference.png"] {
                let (a, b) = (format!("ras{view}/{picture}"), format!("{out}/{picture}"));
                assert!(bytes(at, &a) == bytes(at, &b), "{a} and {b}");
            }
            let (plain, turned) = (report(at, &format!("ras{view}")), report(at, &out));
            assert_eq!(plain["error"], turned["error"]);
            assert_eq!(turned["volume"]["axes"]["stored"], letters);
            assert_eq!(turned["volume"]["axes"]["drawn"], "RAS");
        }
        // As stored the left is on the right.
        std::fs::write(at.join("stored.toml"), format!("{SCENE}[volume]\naxes = \"stored\"\n")).unwrap();
        run(at, "las.nrrd", "stored", &[&more[..more.len() - 1], &["stored.toml"]].concat());
        assert!(bytes(at, "stored/image.png") != bytes(at, &format!("ras{view}/image.png")));
        assert_eq!(report(at, "stored")["volume"]["axes"]["drawn"], "LAS");
    }
}

#[test]
fn the_report_says_which_side_of_the_picture_is_which() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    nrrd(&at.join("las.nrrd"), [-1, 2, 3], "space: RAS\n");
    let sides = |yaw: &str, tilt: &str| {
        run(at, "las.nrrd", "o", &["--reference", "none", "--yaw", yaw, "--tilt", tilt]);
        let sides = &report(at, "o")["view"]["sides"];
        ["left", "right", "top", "bottom", "front"].map(|side| sides[side].as_str().unwrap().to_owned())
    };
    // From behind, from the front, from above with the back below, and from between.
    assert_eq!(sides("0", "0"), ["L", "R", "S", "I", "P"]);
    assert_eq!(sides("180", "0"), ["R", "L", "S", "I", "A"]);
    assert_eq!(sides("0", "90"), ["L", "R", "A", "P", "S"]);
    assert_eq!(sides("30", "0"), ["LP", "RA", "S", "I", "PR"]);
    let text = run(at, "las.nrrd", "o", &["--reference", "none"]);
    assert!(text.contains("stored LAS, drawn RAS") && text.contains("on the left"), "{text}");
    // A phantom has no sides.
    let output = cube3(at, &["run", "--size", "16", "--fidelity", "function", "--reference", "none", "--out", "p"]);
    assert!(output.status.success());
    assert!(report(at, "p")["view"]["sides"].is_null() && report(at, "p")["volume"]["axes"].is_null());
}

#[test]
fn scenes_of_the_first_format_are_told_that_files_are_turned() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    nrrd(&at.join("las.nrrd"), [-1, 2, 3], "space: RAS\n");
    nrrd(&at.join("unnamed.nrrd"), [-1, 2, 3], "space dimension: 3\n");
    std::fs::write(at.join("old.toml"), SCENE.replace("schema = 2", "schema = 1")).unwrap();
    std::fs::write(at.join("new.toml"), SCENE).unwrap();
    let told = |volume: &str, scene: &str| {
        let text = run(at, volume, "o", &["--reference", "none", "--scene", scene]);
        text.contains("note: the scene is of format 1") && text.contains("here LAS; it is now drawn RAS")
    };
    assert!(told("las.nrrd", "old.toml"));
    assert!(!told("las.nrrd", "new.toml") && !told("unnamed.nrrd", "old.toml"));
}

#[test]
fn what_is_left_over_of_a_tilted_gantry_is_said_with_its_angle() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    nrrd(&at.join("las.nrrd"), [-1, 2, 3], "space: RAS\n");
    let straight = std::fs::read(at.join("las.nrrd")).unwrap();
    let text = String::from_utf8_lossy(&straight[..straight.iter().position(|b| *b >= 128).unwrap_or(straight.len())])
        .into_owned();
    let (sin, cos) = 12f64.to_radians().sin_cos();
    let tilted = text.replace("(0,0,1)\n", &format!("(0,{sin},{cos})\n"));
    let head = text.find("\n\n").unwrap() + 2;
    let tilted_head = tilted.find("\n\n").unwrap() + 2;
    std::fs::write(at.join("tilted.nrrd"), [&tilted.as_bytes()[..tilted_head], &straight[head..]].concat()).unwrap();
    let text = run(at, "tilted.nrrd", "o", &["--reference", "none"]);
    assert!(text.contains("note: tilted.nrrd: axes 12.0° off a right angle (gantry tilt)"), "{text}");
    let slanted = report(at, "o")["volume"]["axes"]["slanted_deg"].as_f64().unwrap();
    assert!((slanted - 12.0).abs() < 1e-6, "{slanted}");
    run(at, "las.nrrd", "straight", &["--reference", "none"]);
    assert!(bytes(at, "o/image.png") == bytes(at, "straight/image.png"));
}

/// Three volumes of 6 × 5 × 4 in one NRRD, and each in one of its own.
fn series(at: &Path) {
    let voxel = |t: usize, i: usize| if t == 2 { 255 - (i * 2) as u8 } else { (i * (t + 1)) as u8 };
    let volume = |t: usize| (0..120).map(|i| voxel(t, i)).collect::<Vec<u8>>();
    let header = |sizes: &str, axes: usize| {
        format!("NRRD0004\ntype: uchar\ndimension: {axes}\nsizes: {sizes}\nencoding: raw\n\n")
    };
    let all: Vec<u8> = (0..3).flat_map(volume).collect();
    std::fs::write(at.join("all.nrrd"), [header("6 5 4 3", 4).as_bytes(), &all].concat()).unwrap();
    for t in 0..3 {
        std::fs::write(at.join(format!("{t}.nrrd")), [header("6 5 4", 3).as_bytes(), &volume(t)].concat()).unwrap();
    }
    std::fs::write(
        at.join("t.toml"),
        "[image]\nwidth_px = 16\nheight_px = 16\n[transfer]\nopacity = [[0, 0], [255, 1]]\n",
    )
    .unwrap();
}

#[test]
fn a_series_in_one_file_plays_as_one_in_several() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    series(at);
    let fixed = ["--reference", "none", "--scene", "t.toml"];
    run(at, "all.nrrd", "one", &[&fixed[..], &["--frames", "3"]].concat());
    let output = cube3(
        at,
        &[
            "run",
            "--fidelity",
            "function",
            "--threads",
            "1",
            "--volume",
            "0.nrrd",
            "1.nrrd",
            "2.nrrd",
            "--frames",
            "3",
            "--out",
            "several",
            "--reference",
            "none",
            "--scene",
            "t.toml",
        ],
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let frame = |out: &str, frame: usize| bytes(at, &format!("{out}/frames/frame_{frame:04}.png"));
    let frames: Vec<Vec<u8>> = (0..3).map(|i| frame("one", i)).collect();
    assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    for (i, picture) in frames.iter().enumerate() {
        assert!(*picture == frame("several", i), "frame {i}");
    }
    // A single run takes one, and says which.
    let window = "[volume]\nfile = \"all.nrrd\"\nwindow = [0, 119]\n";
    std::fs::write(at.join("w.toml"), format!("{}{window}", std::fs::read_to_string(at.join("t.toml")).unwrap()))
        .unwrap();
    let text = run(at, "all.nrrd", "o", &["--reference", "none", "--scene", "w.toml"]);
    assert!(
        text.contains("all.nrrd, volume 0 of 0 to 2") && text.contains("note: all.nrrd holds a series of 3 volumes"),
        "{text}"
    );
    assert!(bytes(at, "o/image.png") == frames[0]);
    let text = run(at, "all.nrrd", "o", &["--reference", "none", "--scene", "w.toml", "--time", "2"]);
    assert!(text.contains("volume 2 of 0 to 2") && !text.contains("holds a series"), "{text}");
    assert!(bytes(at, "o/image.png") == frames[2]);
    std::fs::write(at.join("time.toml"), "[volume]\ntime = 2\n").unwrap();
    let text = run(at, "all.nrrd", "o", &["--reference", "none", "--scene", "time.toml"]);
    assert!(text.contains("volume 2 of 0 to 2"), "{text}");
    let output = cube3(at, &["run", "--time", "0", "--size", "16", "--out", "no"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("a phantom is no series"), "{output:?}");
    let output = cube3(at, &["volume", "convert", "all.nrrd", "all.nrrd"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("would take its place"), "{output:?}");
    let output = cube3(at, &["run", "--volume", "all.nrrd", "--time", "3", "--out", "no"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("volume 3 of a file of 3"), "{output:?}");
    assert!(!at.join("no").exists());
}

#[test]
fn grids_that_differ_by_the_last_digit_of_a_float_are_one() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    series(at);
    let spaced = |name: &str, spacing: &str| {
        let bytes = std::fs::read(at.join(name)).unwrap();
        let end = bytes.windows(2).position(|w| w == b"\n\n").unwrap();
        let header = [&bytes[..end], format!("\nspacings: {spacing}\n\n").as_bytes(), &bytes[end + 2..]].concat();
        std::fs::write(at.join(format!("s{name}")), header).unwrap();
    };
    spaced("0.nrrd", "0.7 0.7 0.7");
    spaced("1.nrrd", "0.7 0.699999988 0.7");
    spaced("2.nrrd", "0.7 0.69 0.7");
    let frames = |second: &str| {
        cube3(
            at,
            &[
                "run",
                "--fidelity",
                "function",
                "--volume",
                "s0.nrrd",
                second,
                "--frames",
                "2",
                "--out",
                "o",
                "--scene",
                "t.toml",
            ],
        )
    };
    assert!(frames("s1.nrrd").status.success());
    let refused = frames("s2.nrrd");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("need one grid"));
}

#[test]
fn a_value_that_is_not_finite_is_named_with_its_file_and_the_remedy() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let numbers: Vec<u8> = (0..8).flat_map(|i| (if i == 5 { f32::NAN } else { i as f32 }).to_le_bytes()).collect();
    let header = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 2 2\nendian: little\nencoding: raw\n\n";
    std::fs::write(at.join("nan.nrrd"), [header.as_bytes(), &numbers].concat()).unwrap();
    let output = cube3(at, &["run", "--volume", "nan.nrrd"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("nan.nrrd: voxel (1, 0, 1) is NaN") && message.contains("--mask-non-finite"), "{message}");
    assert_eq!(output.status.code(), Some(2));
    // The library's reader leaves them alone.
    let volume: Volume = read(at.join("nan.nrrd"), &ReadOptions::default()).unwrap();
    assert!(volume.value(1, 0, 1).is_nan());
}
