//! The report of real runs: what made it, its numbers, its schema, its page.

use crate::checked;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Output};

fn cube3(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

/// Runs a small picture on few lanes into `out`; the report, which follows its schema.
fn run(folder: &Path, out: &str, more: &[&str]) -> Value {
    for (name, text) in [("small.toml", "[image]\nwidth_px = 40\nheight_px = 30\n"), ("lanes.toml", "lanes = 16\n")] {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let mut arguments = vec!["run", "--out", out];
    for (option, file) in [("--scene", "small.toml"), ("--machine", "lanes.toml")] {
        if !more.contains(&option) {
            arguments.extend([option, file]);
        }
    }
    arguments.extend(more);
    let output = cube3(folder, &arguments);
    assert!(output.status.success(), "{more:?}: {}", String::from_utf8_lossy(&output.stderr));
    checked::report(&folder.join(out))
}

fn page(folder: &Path, out: &str) -> String {
    std::fs::read_to_string(folder.join(out).join("report.html")).unwrap()
}

#[test]
fn every_kind_of_run_follows_the_schema() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let write = |name: &str, text: &str| std::fs::write(at.join(name), text).unwrap();
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 3 4\n\
                  space directions: (1,0,0) (0,1,0) (0,0,2)\nencoding: raw\n\n";
    std::fs::write(at.join("patient.nrrd"), [header.as_bytes(), &(0..24).collect::<Vec<u8>>()].concat()).unwrap();
    write("memory.toml", "lanes = 16\n[cfb]\nlayout = \"mini-blocks\"\nmemory = \"sdram\"\n");
    write("boards.toml", "lanes = 16\n[boards]\ncount = 4\nlink_words_per_cycle = 4\n");
    let (size, heart) = (["--size", "12"], ["--phantom", "beating-heart", "--size", "12"]);
    let cases: [(&str, &[&str]); 14] = [
        ("both", &size),
        ("timing", &["--size", "12", "--fidelity", "timing"]),
        ("function", &["--size", "12", "--fidelity", "function"]),
        ("cycle", &["--size", "12", "--fidelity", "cycle", "--no-plan"]),
        ("no-reference", &["--size", "12", "--reference", "none"]),
        ("maximum", &["--size", "12", "--mode", "maximum", "--reference", "sheared"]),
        ("eye", &["--size", "12", "--fov", "70", "--distance", "4"]),
        ("inside", &["--size", "12", "--fov", "60", "--eye", "6,6,6"]),
        ("patient", &["--volume", "patient.nrrd"]),
        ("labels", &["--volume", "patient.nrrd", "--labels"]),
        ("memory", &["--size", "12", "--machine", "memory.toml"]),
        ("boards", &["--size", "12", "--machine", "boards.toml"]),
        ("heart", &[heart.as_slice(), &["--frames", "3", "--turntable", "90"]].concat()),
        ("clock", &[heart.as_slice(), &["--frames", "2", "--fidelity", "timing"]].concat()),
    ];
    for (out, more) in cases {
        let report = run(at, out, more);
        assert_eq!(report["command"][1], "run", "{out}");
        // What each case is for is there.
        let place = match out {
            "eye" | "inside" => "/view/perspective/passes/0/widest_cell_voxel",
            "patient" => "/view/sides/front",
            "memory" => "/traffic/reorder/mini_blocks",
            "boards" => "/traffic/links/0/slots",
            "heart" => "/sequence/frames/2/footprint/percentile_99",
            "clock" => "/sequence/acquisition/words_written",
            _ => "/program/version",
        };
        assert!(report.pointer(place).is_some_and(|value| !value.is_null()), "{out}: {place}");
    }
}

#[test]
fn the_report_names_what_made_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let report = run(
        at,
        "a b",
        &["--size", "16", "--machine", "cube3-256", "--yaw", "-20", "--gradient", "26", "--threads", "1"],
    );
    let words = "run --scene small.toml --size 16 --machine cube3-256 --yaw -20 --gradient 26";
    let words: Vec<&str> = ["cube3"].into_iter().chain(words.split(' ')).collect();
    assert_eq!(report["command"], json!(words));
    let sources = json!({"scene_file": "small.toml", "machine_file": null, "machine_preset": "cube3-256"});
    assert_eq!(report["sources"], sources);
    let page = page(at, "a b");
    for part in
        ["preset cube3-256", "small.toml", "phantom head", "yaw -20°", "composite", "<dd>26</dd>", &words.join(" ")]
    {
        assert!(page.contains(part), "{part}");
    }
    let file = run(at, "file", &["--size", "16"]);
    assert_eq!(file["sources"]["machine_file"], "lanes.toml");
    cube3(at, &["run", "--size", "16", "--fidelity", "timing", "--out", "plain"]);
    let plain = checked::report(&at.join("plain"));
    let sources = json!({"scene_file": null, "machine_file": null, "machine_preset": "cube3-128"});
    assert_eq!(plain["sources"], sources, "without options");
}

#[test]
fn one_command_gives_one_report_in_any_folder_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let report = |out: &str, threads: &str| {
        let mut report = run(at, out, &["--size", "16", "--threads", threads]);
        report["wall"] = Value::Null;
        report
    };
    assert_eq!(report("one", "1"), report("two", "2"));
}

#[test]
fn window_scale_and_what_was_clipped_are_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let header = "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4 4 4\nencoding: raw\n\n";
    std::fs::write(at.join("v.nrrd"), [header.as_bytes(), &(0..64).collect::<Vec<u8>>()].concat()).unwrap();
    std::fs::write(at.join("w.toml"), "[image]\nwidth_px = 8\nheight_px = 8\n[volume]\nwindow = [10, 60]\n").unwrap();
    let volume = run(at, "out", &["--scene", "w.toml", "--volume", "v.nrrd"])["volume"].clone();
    assert_eq!(volume["window"], json!([10.0, 60.0]));
    assert_eq!(volume["word_bits"], 16);
    assert_eq!(volume["scale"], 65_535.0 / 50.0);
    assert_eq!((&volume["clipped_below"], &volume["clipped_above"]), (&json!(10), &json!(3)));
    assert_eq!(volume["masked"], 0);
}

#[test]
fn the_total_has_the_volume_in_it() {
    let folder = tempfile::tempdir().unwrap();
    for (out, more) in [
        ("frame", vec!["--size", "40"]),
        ("frames", vec!["--phantom", "beating-heart", "--size", "24", "--frames", "3"]),
    ] {
        let wall = run(folder.path(), out, &more)["wall"].clone();
        let seconds = |key: &str| wall[key].as_f64().unwrap();
        assert!(seconds("volume_s") > 0.0);
        let parts = seconds("volume_s") + seconds("reference_s") + seconds("function_s").max(seconds("timing_s"));
        assert!(seconds("total_s") >= parts, "{out}: {wall}");
    }
}

#[test]
fn a_sequence_shows_its_animation() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let report = run(at, "out", &["--phantom", "beating-heart", "--size", "16", "--frames", "3"]);
    assert_eq!(report["sequence"]["animation"], "animation.png");
    let page = page(at, "out");
    let animation = std::fs::read(at.join("out/animation.png")).unwrap();
    let carried = page.split("data:image/png;base64,").skip(1).filter_map(|rest| rest.split('"').next());
    // All of the file, as the browser sees it, and a still picture of the first frame for those who want less motion.
    let length = 4 * animation.len().div_ceil(3);
    assert!(carried.into_iter().any(|text| text.len() == length), "{length}");
    assert!(page.contains("prefers-reduced-motion") && page.contains("href=\"animation.png\""));
    let frames = report["sequence"]["frames"].as_array().unwrap();
    assert_eq!(frames[0]["footprint"]["bias"], report["error"]["footprint"]["bias"]);
    assert!(
        frames
            .iter()
            .all(|frame| frame["footprint"]["mean_relative"].as_f64() > frame["error"]["mean_relative"].as_f64())
    );
    let clock =
        run(at, "clock", &["--phantom", "beating-heart", "--size", "16", "--frames", "3", "--fidelity", "timing"]);
    assert_eq!(clock["sequence"]["animation"], Value::Null);
}

#[test]
fn each_channel_of_the_machine_is_in_the_drawing() {
    let folder = tempfile::tempdir().unwrap();
    let report = run(folder.path(), "out", &["--size", "12", "--fidelity", "timing"]);
    let page = page(folder.path(), "out");
    let drawing = page.split("<svg class=\"machine\"").nth(1).unwrap().split("</svg>").next().unwrap();
    for part in report["units"].as_array().unwrap().iter().chain(report["channels"].as_array().unwrap()) {
        let name = part["name"].as_str().unwrap();
        assert!(drawing.contains(&format!(">{name}<")), "{name}");
    }
    // Each box says what its unit does.
    assert!(!drawing.contains("></text>"), "a unit without a sentence");
}

#[test]
fn the_schema_is_printed_and_its_keys_are_in_the_book() {
    let folder = tempfile::tempdir().unwrap();
    let output = cube3(folder.path(), &["run", "--print-schema"]);
    assert_eq!(String::from_utf8(output.stdout).unwrap(), cube3_report::JSON_SCHEMA);
    let page =
        |name: &str| std::fs::read_to_string(format!("{}/../docs/src/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap();
    let book = ["report.md", "sequences.md", "errors.md"].map(page).concat();
    fn keys(value: &Value, found: &mut Vec<String>) {
        if let Some(properties) = value.get("properties").and_then(Value::as_object) {
            found.extend(properties.keys().cloned());
        }
        match value {
            Value::Object(entries) => entries.values().for_each(|value| keys(value, found)),
            Value::Array(items) => items.iter().for_each(|item| keys(item, found)),
            _ => {}
        }
    }
    let mut found = Vec::new();
    keys(&serde_json::from_str(cube3_report::JSON_SCHEMA).unwrap(), &mut found);
    let words: std::collections::BTreeSet<&str> = book.split(|c: char| !(c.is_alphanumeric() || c == '_')).collect();
    let missing: Vec<&String> = found.iter().filter(|key| !words.contains(key.as_str())).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
