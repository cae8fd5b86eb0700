//! The command as a person uses it: files that appear, and mistakes that get one clear message and exit code 2.

use crate::checked;
use std::path::Path;
use std::process::{Command, Output};

fn cube3(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a small frame into `out`.
fn small(folder: &Path, more: &[&str]) -> Output {
    let mut arguments = vec!["run", "--size", "24", "--out", "out"];
    arguments.extend(more);
    cube3(folder, &arguments)
}

fn report(folder: &Path) -> serde_json::Value {
    report_in(folder, "out")
}

fn report_in(folder: &Path, out: &str) -> serde_json::Value {
    checked::report(&folder.join(out))
}

#[test]
fn a_run_writes_its_pictures_its_report_and_what_it_ran() {
    let folder = tempfile::tempdir().unwrap();
    let output = small(folder.path(), &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for name in [
        "image.png",
        "base_plane.png",
        "reference.png",
        "difference.png",
        "report.json",
        "report.html",
        "scene.toml",
        "machine.toml",
    ] {
        assert!(folder.path().join("out").join(name).metadata().unwrap().len() > 0, "{name}");
    }
    let report = report(folder.path());
    for key in [
        "/schema",
        "/scene/view",
        "/machine/lanes",
        "/plan/left_out/0/why",
        "/timing/cycles",
        "/timing/clock_hz",
        "/timing/frame_time_s",
        "/timing/fps",
        "/timing/beams",
        "/timing/samples",
        "/timing/fill_cycles",
        "/units/0/name",
        "/units/0/busy",
        "/units/0/starved",
        "/units/0/blocked",
        "/units/0/waiting",
        "/error/against",
        "/error/mean_relative",
        "/error/rms",
        "/error/max",
        "/error/psnr_db",
        "/error/gradient_mean_deg",
        "/wall/timing_s",
        "/wall/function_s",
        "/wall/reference_s",
        "/wall/samples_per_s",
        "/digest/base_plane",
        "/digest/image",
    ] {
        assert!(report.pointer(key).is_some_and(|value| !value.is_null()), "{key}");
    }
    let text = report.to_string();
    for key in [
        "limits",
        "critical",
        "resources",
        "operators",
        "interfaces",
        "traffic",
        "base_plane",
        "image",
        "reference_s",
        "max",
    ] {
        assert!(text.contains(&format!("\"{key}\":")), "{key}");
    }
}

#[test]
fn what_was_written_runs_again_to_the_same_bits() {
    let folder = tempfile::tempdir().unwrap();
    small(folder.path(), &["--gradient", "26d", "--mode", "first-opaque", "--yaw", "-50"]);
    let first = report(folder.path());
    let output = cube3(
        folder.path(),
        &["run", "--scene", "out/scene.toml", "--machine", "out/machine.toml", "--out", "again", "--fidelity", "cycle"],
    );
    assert!(output.status.success(), "{}", text(&output.stderr));
    let second = report_in(folder.path(), "again");
    let over = cube3(folder.path(), &["run", "--scene", "out/scene.toml", "--out", "out"]);
    assert_eq!(over.status.code(), Some(2), "a scene that is read is not written over");
    assert_eq!(first["digest"], second["digest"]);
    assert_eq!(first["timing"], second["timing"]);
}

#[test]
fn a_run_without_a_reference_leaves_none_of_an_earlier_one() {
    let folder = tempfile::tempdir().unwrap();
    small(folder.path(), &[]);
    small(folder.path(), &["--reference", "none"]);
    assert!(!folder.path().join("out/reference.png").exists());
    assert!(!folder.path().join("out/difference.png").exists());
    assert!(folder.path().join("out/image.png").exists());
}

#[test]
fn threads_change_nothing_but_the_wall_time() {
    let folder = tempfile::tempdir().unwrap();
    let mut reports = ["1", "2", "5"].map(|threads| {
        small(folder.path(), &["--threads", threads]);
        report(folder.path())
    });
    reports.iter_mut().for_each(|report| report["wall"] = serde_json::Value::Null);
    assert_eq!(reports[0], reports[1]);
    assert_eq!(reports[0], reports[2]);
}

#[test]
fn volumes_go_from_phantom_to_file_to_picture() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = cube3(folder.path(), arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    run(&["volume", "phantom", "engine", "--size", "20", "--out", "engine.nrrd"]);
    assert!(run(&["volume", "info", "engine.nrrd"]).contains("20 × 20 × 20"));
    run(&["volume", "convert", "engine.nrrd", "engine.raw"]);
    let raw = run(&["volume", "info", "engine.raw", "--dims", "20x20x20", "--type", "u8"]);
    assert!(raw.contains("20 × 20 × 20"), "{raw}");
    run(&["run", "--volume", "engine.raw", "--dims", "20x20x20", "--type", "u8", "--out", "out"]);
    let from_raw = report(folder.path());
    run(&["run", "--volume", "engine.nrrd", "--out", "out"]);
    assert_eq!(report(folder.path())["digest"], from_raw["digest"]);
}

#[test]
fn a_patients_volume_is_converted_as_stored_and_resampled_as_drawn() {
    let folder = tempfile::tempdir().unwrap();
    let run = |arguments: &[&str]| {
        let output = cube3(folder.path(), arguments);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let refused = |arguments: &[&str], words: &str| {
        let output = cube3(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(words), "{}", text(&output.stderr));
    };
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\n\
                  space directions: (1,0,0) (0,1,0) (0,0,2)\nencoding: raw\n\n";
    let bytes = [header.as_bytes(), &[10, 20, 30, 40, 50, 60, 70, 80]].concat();
    std::fs::write(folder.path().join("lps.nrrd"), bytes).unwrap();
    assert!(!run(&["volume", "convert", "lps.nrrd", "lps.nii.gz"]).contains("note"));
    assert!(!run(&["volume", "convert", "lps.nii.gz", "lps.mha", "--uncompressed"]).contains("note"));
    let shown = run(&["volume", "convert", "lps.mha", "stored.raw"]);
    assert!(shown.contains("note: stored.raw keeps no directions") && shown.contains("--ras"), "{shown}");
    assert!(!run(&["volume", "convert", "lps.mha", "drawn.raw", "--ras"]).contains("note"));
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("stored.raw"), [10, 20, 30, 40, 50, 60, 70, 80]);
    assert_eq!(read("drawn.raw"), [40, 30, 20, 10, 80, 70, 60, 50]);
    let shown = run(&["volume", "resample", "lps.mha", "cubes.raw", "--cubes", "--filter", "linear"]);
    assert!(shown.contains("2 × 2 × 2 at 1 × 1 × 2 -> 2 × 2 × 3 at 1 × 1 × 1, linear"), "{shown}");
    assert_eq!(read("cubes.raw"), [40, 30, 20, 10, 60, 50, 40, 30, 80, 70, 60, 50]);
    refused(&["volume", "resample", "cubes.raw", "a.nrrd", "--cubes"], "volume convert cubes.raw");
    refused(&["volume", "resample", "lps.mha", "a.nrrd"], "--cubes");
    refused(&["volume", "resample", "lps.mha", "a.nrrd", "--size", "2x2x3", "--spacing", "1,1,1"], "--size");
}

#[test]
fn the_printed_defaults_are_the_defaults() {
    let folder = tempfile::tempdir().unwrap();
    for (option, file) in [("--print-scene", "scene.toml"), ("--print-machine", "machine.toml")] {
        let output = cube3(folder.path(), &["run", option]);
        std::fs::write(folder.path().join(file), &output.stdout).unwrap();
    }
    small(folder.path(), &[]);
    let plain = report(folder.path());
    small(folder.path(), &["--scene", "scene.toml", "--machine", "machine.toml"]);
    assert_eq!(plain["digest"], report(folder.path())["digest"]);
}

#[test]
fn machines_and_scenes_are_listed_printed_and_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let printed = |arguments: &[&str]| {
        let output = cube3(folder.path(), arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    };
    for (command, key) in [("machine", "cfb.skew"), ("scene", "view.yaw_deg")] {
        let list = printed(&[command, "--parameters"]);
        assert!(list.contains(key.split_once('.').unwrap().1) && list.lines().all(|line| line.chars().count() <= 80));
        let json: serde_json::Value = serde_json::from_str(&printed(&[command, "--parameters", "--json"])).unwrap();
        let row = json.as_array().unwrap().iter().find(|row| row["key"] == key).unwrap();
        for field in ["kind", "unit", "legal", "default", "optional", "about", "source"] {
            assert!(!row[field].is_null(), "{field} of {row}");
        }
    }
    assert_eq!(printed(&["machine"]), printed(&["run", "--print-machine"]));
    assert_eq!(printed(&["scene"]), printed(&["run", "--print-scene"]));
    assert!(printed(&["machine", "--presets"]).contains("em-cube"));
    std::fs::write(folder.path().join("machine.toml"), printed(&["machine", "em-cube"])).unwrap();
    assert_eq!(printed(&["machine", "machine.toml"]), printed(&["machine", "em-cube"]));
    std::fs::write(folder.path().join("scene.toml"), "mode = \"maximum\"").unwrap();
    let scene = printed(&["scene", "scene.toml"]);
    std::fs::write(folder.path().join("again.toml"), &scene).unwrap();
    assert!(scene.contains("\"maximum\"") && scene == printed(&["scene", "again.toml"]));
}

#[test]
fn mistakes_get_one_message_and_exit_code_2_and_lose_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    small(path, &[]);
    let before = std::fs::read(path.join("out/image.png")).unwrap();
    std::fs::write(path.join("bad-scene.toml"), "schema = 1\n[view]\nyaw = 3\n").unwrap();
    std::fs::write(path.join("bad-machine.toml"), "lanes = 0\n").unwrap();
    std::fs::write(path.join("stuck.toml"), "lanes = 24\n[dsb]\nplanes = 1\n").unwrap();
    std::fs::write(
        path.join("short.nrrd"),
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 90 90 90\nencoding: raw\n\nabc",
    )
    .unwrap();
    let cases: [(&[&str], &str); 18] = [
        (&["--mode", "mip"], "maximum"),
        (&["--volume", "a.nrrd", "--phantom", "head"], "cannot be used with"),
        (&["--scene", "bad-scene.toml"], "bad-scene.toml:3"),
        (&["--scene", "missing.toml"], "missing.toml"),
        (&["--machine", "bad-machine.toml"], "lanes = 0 is outside 1 to 4096"),
        (&["--machine", "cube9"], "cube3-128"),
        (&["--machine", "stuck.toml"], "dsb.write waits for dsb.read"),
        (&["--threads", "0"], "give 1 to 256"),
        (&["--threads", "99999"], "give 1 to 256"),
        (&["--dims", "2x2x2"], "--dims and --type go together"),
        (&["--phantom", "kidney"], "head"),
        (&["--tilt", "nan"], "tilt"),
        (&["--eye", "1,-2,3"], "--eye is for perspective views"),
        (&["--distance", "90"], "give --fov DEGREES too"),
        (
            &["--fov", "180"],
            "view.perspective.field_of_view_deg: 180.0 is outside 0.001 to 179 degrees; the nearest legal value is 179.0",
        ),
        (&["--fov", "40", "--eye", "1,2"], "give three numbers, e.g. 63.5,-150,63.5"),
        (&["--fov", "40", "--eye", "1,nan,2"], "view.perspective.eye_voxel[1]"),
        (&["--fov", "40", "--eye=-1,1,2", "--distance", "3"], "cannot be used with"),
    ];
    let check = |output: Output, expected: &str, what: &str| {
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{what}: {message}");
        assert!(message.contains(expected), "{what}: {message}");
        assert_eq!(message.trim_end().lines().count(), 1, "{what}: {message}");
    };
    for (arguments, expected) in cases {
        check(small(path, arguments), expected, &format!("{arguments:?}"));
    }
    let output = cube3(path, &["run", "--volume", "short.nrrd", "--out", "out"]);
    check(output, "short.nrrd", "a header that promises more than the file holds");
    std::fs::write(path.join("file"), "").unwrap();
    check(cube3(path, &["run", "--size", "8", "--out", "file"]), "file", "a file in the folder's place");
    check(
        cube3(path, &["run", "--machine", "bad-machine.toml", "--out", "new"]),
        "lanes",
        "a folder that is not there",
    );
    assert!(!path.join("new").exists(), "nothing is written");
    assert_eq!(std::fs::read(path.join("out/image.png")).unwrap(), before, "nothing is written over");
}

#[test]
fn bench_prints_ratios_and_fractions() {
    let folder = tempfile::tempdir().unwrap();
    let output = cube3(folder.path(), &["bench", "--size", "16", "--timing-size", "16", "--repeats", "1"]);
    let table = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(table.contains("M samples/s") && table.contains("% of the bandwidth"), "{table}");
}

#[test]
fn verify_words_writes_tables_page_and_diagrams() {
    let folder = tempfile::tempdir().unwrap();
    let study = |more: &[&str]| {
        let arguments = ["verify", "--words", "--size", "12", "--wires", "accumulator,opacity_bits", "--out", "out"];
        cube3(folder.path(), &[&arguments[..], more].concat())
    };
    let output = study(&["--threads", "2"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    for part in ["accumulator_bits", "opacity_bits", "The front", "The cone alone"] {
        assert!(printed.contains(part), "{part} is not in {printed}");
    }
    assert!(!printed.contains("colour_bits"));
    let names = ["words.csv", "words.json", "words.html", "front.svg", "wires-wide.svg", "thin.svg", "scene.toml"];
    let read = || names.map(|name| std::fs::read(folder.path().join("out").join(name)).unwrap());
    let first = read();
    // No wire of the gradient was asked for.
    assert!(!folder.path().join("out/gradients.svg").exists());
    assert!(study(&["--threads", "1"]).status.success());
    assert!(read() == first, "one thread writes other bytes than two");
    // Nothing but accumulator and opacity was varied.
    let value: serde_json::Value = serde_json::from_slice(&first[1]).unwrap();
    assert_eq!(value["schema"], 1);
    let points = value["points"].as_array().unwrap();
    let of_machine = |point: &&serde_json::Value| point["sweep"] == "one-wire-machine";
    assert_eq!(points.iter().filter(of_machine).count(), 4 * (16 + 32));
    assert!(points.iter().filter(of_machine).all(|point| point["colour_bits"] == 12));
}

#[test]
fn mistakes_of_verify_and_vectors_get_one_message() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, part) in [
        (&["verify", "--yaw", "3"][..], "give --words"),
        (&["verify", "--dut", "true"], "--unit is missing"),
        (&["verify", "--unit", "hue"], "the units are cfb, bus"),
        (&["verify", "--unit", "lerp", "--format", "17.8"], "1 to 16"),
        (&["verify", "--unit", "lerp", "--set", "colour"], "NAME=NUMBER"),
        (&["verify", "--unit", "lerp", "--set", "nearest=2"], "no number that nearest can have"),
        (&["verify", "--vectors", "none.hex", "--dut", "true %o"], "`cube3 vectors` wrote"),
        (&["verify", "--vectors", "none.hex", "--count", "5", "--dut", "true %o"], "cannot be used with"),
        (&["vectors", "--unit", "node", "--count", "230000", "--testbench", "--out", "."], "holds 220752 lines"),
        (&["verify", "--unit", "lerp", "--words"], "cannot be used with"),
        (&["vectors", "--tilt", "3"], "--from-run"),
        (&["vectors", "--unit", "lerp", "--count", "1000001"], "at most"),
        (&["verify", "--words", "--wires", "colour,hue"], "accumulator"),
        (&["verify", "--words", "--bound", "-1"], "above 0"),
        (&["verify", "--words", "--phantom", "heart"], "heart"),
        (&["verify", "--words", "--size", "12", "--machine", "none.toml"], "none.toml"),
    ] {
        let output = cube3(folder.path(), arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(part) && message.trim_end().lines().count() == 1, "{message}");
    }
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
}

/// Nothing that was compared is no result: a scene that shows nothing, vectors without a line.
#[test]
fn nothing_is_not_verified() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let output = cube3(path, &["verify", "--words", "--phantom", "marschner-lobb", "--size", "8"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("the scene shows nothing"), "{}", text(&output.stderr));

    assert!(cube3(path, &["vectors", "--unit", "lerp", "--count", "3", "--out", "."]).status.success());
    let vectors = std::fs::read_to_string(path.join("lerp.hex")).unwrap();
    let header = |line: &&str| line.starts_with("//") && !line.contains("sha256");
    let empty = vectors.lines().filter(header).map(|line| format!("{line}\n")).collect::<String>();
    std::fs::write(path.join("none.hex"), empty).unwrap();
    std::fs::write(path.join("answers.hex"), "").unwrap();
    let output = cube3(path, &["verify", "--vectors", "none.hex", "--against", "answers.hex"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("no line to compare"), "{}", text(&output.stderr));
}

/// Vectors, a device that is right, one that is wrong, and one that does not answer.
#[test]
fn a_device_is_held_against_vectors() {
    let folder = tempfile::tempdir().unwrap();
    let made = cube3(folder.path(), &["vectors", "--unit", "node", "--count", "300", "--testbench", "--out", "v"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    assert!(text(&made.stdout).contains("of 28 points covered"), "{}", text(&made.stdout));
    assert!(folder.path().join("v/cube3_node_tb.sv").exists());
    // The outputs of a line are its last six fields.
    let right = "grep -v // %i | awk '{print $14,$15,$16,$17,$18,$19}' > %o";
    let device =
        |command: &str| cube3(folder.path(), &["verify", "--vectors", "v/node.hex", "--dut", command, "--out", "o"]);
    let output = device(right);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stdout).contains("all 300 lines are equal, bit for bit"));
    assert!(!folder.path().join("o/node.fst").exists());
    let wrong = right.replace("$19", "$18");
    let output = device(&wrong);
    assert_eq!(output.status.code(), Some(2));
    let shown = text(&output.stdout);
    assert!(shown.contains("wires of the definition") && shown.contains("* rgba[3]"), "{shown}");
    assert_eq!(text(&output.stderr).trim_end().lines().count(), 1);
    for name in ["node.fst", "node.gtkw", "node.sucl"] {
        assert!(folder.path().join("o").join(name).metadata().unwrap().len() > 0, "{name}");
    }
    // Paths are quoted for the shell, and what they hold is not filled in again.
    let arguments = ["verify", "--vectors", "v/node.hex", "--dut", right, "--out", "o's %d"];
    assert!(cube3(folder.path(), &arguments).status.success());
    let text_of = std::fs::read_to_string(folder.path().join("v/node.hex")).unwrap();
    std::fs::write(folder.path().join("v/node.hex"), text_of.replacen(" 1 ", " 0 ", 1)).unwrap();
    assert!(text(&device(right).stderr).contains("not those of the digest"));
    std::fs::write(folder.path().join("v/node.hex"), text_of).unwrap();
    for (command, part) in [
        ("true", "has no %o"),
        ("exit 3 # %o", "ended with"),
        ("true # %o", "wrote no"),
        ("echo 1 > %o", "1 fields"),
        ("echo 1 2 3 4 5 six > %o", "no hexadecimal"),
        ("echo 1 2 3 4 5 6 > %o", "1 lines for 300"),
    ] {
        let output = device(command);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {message}");
        assert!(message.contains(part) && message.trim_end().lines().count() == 1, "{message}");
    }
}

/// Recorded lines come with the frame's tables, and are equal to themselves.
#[test]
fn recorded_vectors_are_verified_with_the_tables_of_the_frame() {
    let folder = tempfile::tempdir().unwrap();
    let scene = ["--phantom", "head", "--size", "16"];
    for unit in ["trilin", "normalise", "classify", "phong"] {
        let made = cube3(
            folder.path(),
            &[&["vectors", "--from-run", "--unit", unit, "--count", "200", "--out", "v"], &scene[..]].concat(),
        );
        assert!(made.status.success(), "{}", text(&made.stderr));
        let vectors = format!("v/{unit}.hex");
        let body = std::fs::read_to_string(folder.path().join(&vectors)).unwrap();
        let outputs = body.lines().find_map(|line| line.strip_prefix("// outputs")).unwrap();
        let count: usize = outputs
            .split_whitespace()
            .map(|port| port.split(['[', ']']).nth(1).map_or(1, |count| count.parse().unwrap()))
            .sum();
        let device = format!(
            "grep -v // %i | awk '{{for (i = NF - {count} + 1; i <= NF; i++) printf \"%%s \", $i; print \"\"}}' > %o"
        )
        .replace("%%s", "%s");
        let output = cube3(folder.path(), &["verify", "--vectors", &vectors, "--dut", &device, "--out", "o"]);
        assert!(output.status.success(), "{unit}: {}{}", text(&output.stdout), text(&output.stderr));
    }
}

/// What `verify` says of our own lanes, wires and units.
#[test]
fn verify_holds_our_own_units_against_the_definitions() {
    let folder = tempfile::tempdir().unwrap();
    let output = cube3(folder.path(), &["verify", "--count", "60"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let shown = text(&output.stdout);
    assert_eq!(shown.lines().count(), 24, "a line for each unit, and one for all on channels: {shown}");
    assert!(shown.contains("of 180 frames, with 5817 pixels that are not empty, 0 differ"), "{shown}");
    // Where the machine has no code of its own for a unit, that is said.
    for line in shown.lines().filter(|line| !line.starts_with("on channels")) {
        let name = line.split_whitespace().next().unwrap();
        let definition = ["pixel", "reflectance", "channel"].contains(&name);
        assert_eq!(line.contains("no lanes: the machine runs the definition"), definition, "{line}");
        let counts = line.split_once(" equal in its lanes").map(|(before, _)| {
            let mut words = before.split_whitespace().rev();
            (words.next().unwrap().to_owned(), words.nth(1).unwrap().to_owned())
        });
        assert!(counts.is_none_or(|(answered, equal)| answered == equal && answered != "0"), "{line}");
    }
}

/// Every option that a command of `vectors` does not use is refused, and both are named.
#[test]
fn vectors_refuses_what_it_would_not_use() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let unused: [(&[&str], &[&str]); 5] = [
        (
            &["--list"],
            &[
                "--unit=lerp",
                "--format=8.8",
                "--set=nearest=0",
                "--machine=cube3-128",
                "--count=5",
                "--seed=3",
                "--all",
                "--out=o",
            ],
        ),
        (&["--sheet"], &["--count=5", "--seed=3", "--testbench", "--out=o", "--frame", "--from-run"]),
        (&["--pages", "p"], &["--unit=lerp", "--format=8.8", "--count=5", "--seed=3", "--testbench", "--out=o"]),
        (&["--from-run", "--unit", "lerp"], &["--seed=3", "--format=8.8", "--set=nearest=0", "--all"]),
        (&["--reference"], &["--count=5", "--format=8.8", "--unit=lerp"]),
    ];
    for (command, options) in unused {
        for option in options {
            let arguments = [&["vectors"], command, &[option]].concat();
            let output = cube3(path, &arguments);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{arguments:?}");
            let option = option.split('=').next().unwrap();
            let told = [command[0], option, "cannot be used with"].iter().all(|part| message.contains(part));
            assert!(told && message.trim_end().lines().count() == 1, "{arguments:?}: {message}");
        }
    }
    for command in [&["--list"][..], &["--sheet"], &["--pages", "p"]] {
        let message = text(&cube3(path, &[&["vectors", "--tilt", "5"], command].concat()).stderr);
        assert!(message.contains("--tilt is for --from-run and --frame"), "{command:?}: {message}");
    }
    assert!(std::fs::read_dir(path).unwrap().next().is_none());
}

/// Place, reason and remedy.
#[test]
fn what_vectors_cannot_do_is_said_with_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("file"), "kept").unwrap();
    let cases: [(&[&str], &str); 10] = [
        (&["--first", "5"], "--first: it chooses from what flowed in a run; give --from-run too, or leave it out"),
        (&["--unit", "channel", "--channel", "rays"], "--channel: it chooses from what flowed in a run"),
        (&["--list", "--pass", "1"], "--pass: it chooses from what flowed in a run"),
        (&["--from-run"], "--from-run: one unit is recorded at a time; give --unit NAME too"),
        (&["--from-run", "--unit", "lerp", "--channel", "rays"], "--channel is for the unit channel"),
        (
            &["--pages", "file"],
            "file: this is a file, and files are to be written into a folder; give another one with --pages",
        ),
        (
            &["--unit", "lerp", "--out", "file"],
            "file: this is a file, and files are to be written into a folder; give another one with --out",
        ),
        (&["--unit", "lerp", "--out", "file/below"], "file/below: the folder cannot be made"),
        (
            &["--frame", "--size", "12"],
            "cubes whose side is a power of two from 4 to 256 voxels, a lane for each; the volume is 12 x 12 x 12: \
             give a volume of 16 voxels a side",
        ),
        (&["--frame", "--size", "2"], "give a volume of 4 voxels a side"),
    ];
    for (arguments, expected) in cases {
        let arguments = [&["vectors"], arguments].concat();
        let output = cube3(path, &arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected) && message.trim_end().lines().count() == 1, "{arguments:?}: {message}");
    }
    assert_eq!(std::fs::read_to_string(path.join("file")).unwrap(), "kept");
    assert!(cube3(path, &["vectors", "--pages", "new/pages"]).status.success(), "a missing folder is made");
    assert!(path.join("new/pages/sheet-cfb.md").exists());
}

/// A device that hangs is killed with what it has started; one that is in time is not.
#[test]
fn a_device_that_hangs_is_given_up() {
    let folder = tempfile::tempdir().unwrap();
    let verify = |command: &str, more: &[&str]| {
        let arguments = ["verify", "--unit", "lerp", "--count", "5", "--out", "o", "--dut", command];
        cube3(folder.path(), &[&arguments, more].concat())
    };
    // The sleeper holds the pipe of standard error: were it alive, the output would not end.
    let start = std::time::Instant::now();
    let output = verify("sleep 300 & wait; echo 1 > %o", &["--dut-timeout", "0.2"]);
    assert!(start.elapsed() < std::time::Duration::from_secs(100), "{:?}", start.elapsed());
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("had not ended after 0.2 s and was killed"), "{message}");
    assert!(message.contains("--dut-timeout") && message.trim_end().lines().count() == 1, "{message}");
    let right = "grep -v // %i | awk '{print $4}' > %o";
    for more in [&[][..], &["--dut-timeout", "500"]] {
        let output = verify(right, more);
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    for (seconds, part) in
        [("0", "seconds above 0"), ("-1", "seconds above 0"), ("nan", "seconds above 0"), ("soon", "invalid")]
    {
        let output = verify(right, &["--dut-timeout", seconds]);
        assert_eq!(output.status.code(), Some(2));
        assert!(text(&output.stderr).contains(part), "{seconds}: {}", text(&output.stderr));
    }
    assert!(text(&cube3(folder.path(), &["verify", "--dut-timeout", "3"]).stderr).contains("--dut"));
}
