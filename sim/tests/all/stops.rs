//! Traces, drawings, and save and resume as a person uses them.

use crate::checked;
use std::path::Path;
use std::process::{Command, Output};

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a small frame in a folder.
fn small(folder: &Path, more: &[&str]) -> Output {
    let arguments = ["run", "--size", "24", "--reference", "none"].iter().chain(more);
    Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder).args(arguments).output().unwrap()
}

fn succeeds(folder: &Path, more: &[&str]) -> String {
    let output = small(folder, more);
    assert!(output.status.success(), "{more:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn fails(folder: &Path, more: &[&str]) -> String {
    let output = small(folder, more);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{more:?}: {message}");
    assert_eq!(message.trim_end().lines().count(), 1, "{more:?}: {message}");
    message
}

fn report(folder: &Path, out: &str) -> serde_json::Value {
    checked::report(&folder.join(out))
}

#[test]
fn a_window_is_traced_in_each_format_and_fidelity_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    succeeds(path, &["--fidelity", "timing", "--out", "plain"]);
    let plain = report(path, "plain");
    for name in ["t.fst", "t.kanata", "t.json"] {
        let mut files = Vec::new();
        for fidelity in ["timing", "both", "cycle"] {
            let told = succeeds(path, &["--fidelity", fidelity, "--trace", name, "--from", "50", "--to", "90"]);
            assert!(told.contains(&format!("the trace of cycles 50 to 90 is in {name}")), "{told}");
            assert_eq!(report(path, "out")["timing"], plain["timing"]);
            assert_eq!(report(path, "out")["units"], plain["units"]);
            files.push(std::fs::read(path.join(name)).unwrap());
        }
        assert!(files[0] == files[1] && files[1] == files[2], "{name} is of the machine, not of the fidelity");
        // Beside a waveform, and only there, is how viewers show it.
        for viewer in ["t.gtkw", "t.sucl"].map(|viewer| path.join(viewer)) {
            assert_eq!(viewer.exists(), name == "t.fst", "{}", viewer.display());
            if viewer.exists() {
                assert!(std::fs::read_to_string(&viewer).unwrap().contains("cube3.cfb.kind"));
                std::fs::remove_file(viewer).unwrap();
            }
        }
    }
    let wave = wellen::simple::read(path.join("t.fst")).unwrap();
    assert_eq!(wave.time_table().len(), 2 * 40 + 1, "two edges a cycle, and the end");
    let end = plain["timing"]["cycles"].as_u64().unwrap();
    let told = succeeds(path, &["--trace", "end.kanata", "--from", &(end - 5).to_string(), "--to", "999999"]);
    assert!(told.contains(&format!("the trace ends with the run, at cycle {end}, before --to 999999")), "{told}");
}

#[test]
fn a_machine_that_cannot_move_is_reported_with_its_circle_and_traced_to_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("stuck.toml"), "lanes = 24\n[dsb]\nplanes = 1\n").unwrap();
    for fidelity in ["both", "timing", "cycle"] {
        let message =
            fails(path, &["--machine", "stuck.toml", "--fidelity", fidelity, "--trace", "stuck.kanata", "--to", "500"]);
        for part in
            ["nothing can move after cycle", "dsb.write waits for dsb.read", "dsb.read waits for dsb.write", "circle"]
        {
            assert!(message.contains(part), "{fidelity}: {message}");
        }
        let trace = std::fs::read_to_string(path.join("stuck.kanata")).unwrap();
        assert!(trace.contains("\t1\tblocked"), "the beam that found no buffer");
        std::fs::remove_file(path.join("stuck.kanata")).unwrap();
    }
    assert!(!path.join("out").exists());
}

#[test]
fn the_drawing_shows_every_unit_and_channel_and_is_the_same_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let told = succeeds(path, &["--topology", "machine.svg"]);
    assert!(told.trim_end().ends_with("machine.svg"), "{told}");
    succeeds(path, &["--topology", "machine.dot", "--fidelity", "cycle"]);
    let [svg, dot] = ["machine.svg", "machine.dot"].map(|name| std::fs::read_to_string(path.join(name)).unwrap());
    let report = report(path, "out");
    for unit in report["units"].as_array().unwrap() {
        let name = unit["name"].as_str().unwrap();
        let cycles: u64 = ["busy", "starved", "blocked"].iter().map(|key| unit[key].as_u64().unwrap()).sum();
        let busy = format!("busy {:.1} %", 100.0 * unit["busy"].as_f64().unwrap() / cycles as f64);
        assert!(svg.contains(&format!(">{name}</text>")) && svg.contains(&busy), "{name} {busy}");
        assert!(dot.contains(&format!("\"{name}\" [label=\"{name}\\n{busy}\"")), "{name} {busy}");
    }
    for channel in report["channels"].as_array().unwrap() {
        let s = if channel["latency"] == 1 { "" } else { "s" };
        let numbers = format!(
            "capacity {}, latency {} cycle{s}, mean occupancy {:.2}",
            channel["capacity"],
            channel["latency"],
            channel["mean_occupancy"].as_f64().unwrap()
        );
        assert!(svg.contains(&numbers) && dot.contains(&numbers), "{numbers}");
    }
    let arrows = |arrow: &str| dot.contains(arrow);
    assert!(arrows("\"cfb\" -> \"bus\"") && arrows("\"cone\" -> \"host\"") && arrows("\"dsb.write\" -> \"dsb.read\""));
    assert_eq!(svg.matches("<line").count(), dot.matches(" -> ").count());
    succeeds(path, &["--topology", "machine.svg"]);
    assert_eq!(std::fs::read_to_string(path.join("machine.svg")).unwrap(), svg);
}

#[test]
fn a_run_that_was_saved_is_resumed_to_the_same_report() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    for fidelity in ["timing", "both", "cycle"] {
        succeeds(path, &["--fidelity", fidelity, "--out", "through"]);
        let told = succeeds(path, &["--fidelity", fidelity, "--out", "saved", "--checkpoint-at", "300"]);
        assert!(told.contains("the state at cycle 300 is in"), "{told}");
        let told = succeeds(path, &["--fidelity", fidelity, "--out", "resumed", "--resume", "saved/checkpoint.cube3"]);
        assert!(told.contains("resumed at cycle 300"), "{told}");
        for key in ["timing", "units", "channels", "digest", "words"] {
            let through = &report(path, "through")[key];
            assert_eq!(through, &report(path, "saved")[key], "{fidelity} {key}");
            assert_eq!(through, &report(path, "resumed")[key], "{fidelity} {key}");
        }
    }
    let file = "saved/checkpoint.cube3";
    assert!(fails(path, &["--resume", file]).contains("its fidelity differs"));
    assert!(
        fails(path, &["--fidelity", "cycle", "--resume", file, "--yaw", "5"]).contains("its scene or plan differs")
    );
    assert!(
        fails(path, &["--fidelity", "cycle", "--resume", file, "--gradient", "26"]).contains("its machine differs")
    );
    assert!(fails(path, &["--fidelity", "cycle", "--resume", file, "--phantom", "fog"]).contains("its volume differs"));
    let early = ["--fidelity", "cycle", "--resume", file, "--checkpoint-at", "200"];
    assert!(fails(path, &early).contains("give --checkpoint-at 300 or above"));
    let early = ["--fidelity", "cycle", "--resume", file, "--trace", "t.fst", "--to", "400"];
    assert!(fails(path, &early).contains("give --from 300 or above"));
    let mut bytes = std::fs::read(path.join(file)).unwrap();
    bytes.truncate(bytes.len() / 2);
    std::fs::write(path.join("half.cube3"), &bytes).unwrap();
    assert!(fails(path, &["--fidelity", "cycle", "--resume", "half.cube3"]).contains("damaged"));
}

#[test]
fn mistakes_get_one_message_and_write_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    std::fs::write(path.join("other.txt"), "not saved\n").unwrap();
    let cases: [(&[&str], &str); 14] = [
        (&["--trace", "t.vcd", "--to", "9"], ".fst, .kanata or .json"),
        (&["--trace", "t.fst"], "--to"),
        (&["--to", "9"], "--trace"),
        (&["--trace", "t.fst", "--from", "9", "--to", "9"], "--from 9 --to 9 is no window"),
        (&["--trace", "t.fst", "--to", "99999999999"], "cycles at most"),
        (&["--trace", "t.fst", "--from", "90000", "--to", "90001"], "the run took"),
        (&["--trace", "nowhere/t.fst", "--to", "9"], "nowhere/t.fst"),
        (&["--trace", "t.fst", "--to", "9", "--fidelity", "function"], "no cycles to trace"),
        (&["--topology", "machine.png"], ".svg or .dot"),
        (&["--topology", "machine.svg", "--fidelity", "function"], "no units to draw"),
        (&["--checkpoint-at", "90000"], "give --checkpoint-at below"),
        (&["--checkpoint-at", "9", "--fidelity", "function"], "no cycles"),
        (&["--resume", "other.txt"], "other.txt: this is no checkpoint"),
        (&["--resume", "missing.cube3"], "missing.cube3"),
    ];
    for (arguments, expected) in cases {
        let message = fails(path, arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    let left: Vec<_> = std::fs::read_dir(path).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["other.txt"]);
}
