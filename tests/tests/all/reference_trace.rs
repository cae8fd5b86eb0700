//! The default run against the reference in `traces/`: bits and cycles do not change unnoticed, in either fidelity.

use cube3::{RunOptions, Runs, run};
use cube3_inputs as inputs;
use cube3_scene::Scene;
use cube3_volume::ReadOptions;
use serde_json::Value;

#[test]
fn the_default_run_has_the_bits_and_cycles_of_the_reference() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../traces/default-run.json");
    let reference: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let scene = Scene::default();
    let machine = inputs::machine("cube3-128").unwrap();
    let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap();
    for (i, runs) in [Runs::Both, Runs::Cycle].into_iter().enumerate() {
        let reference = &reference["runs"][i];
        let options = RunOptions { runs, reference: None, ..RunOptions::default() };
        let report = run(&scene, &machine, &volume, &options).unwrap().report;
        let timing = report.timing.unwrap();
        let counts = [timing.cycles, timing.beams, timing.ray_slots, timing.samples];
        let expected = ["cycles", "beams", "ray_slots", "samples"].map(|key| reference[key].as_u64().unwrap());
        assert_eq!(counts, expected, "{}", runs.name());
        assert_eq!(report.digest.base_plane.as_deref(), reference["digest_base_plane"].as_str(), "{}", runs.name());
        assert_eq!(report.digest.image.as_deref(), reference["digest_image"].as_str(), "{}", runs.name());
    }
}
