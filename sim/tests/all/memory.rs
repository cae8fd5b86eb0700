//! Memory is known before it is taken: estimates against what is taken, and refusals under a limit.

use clap::Parser;
use cube3::Runs;
use cube3::memory::{self, Case, Grid, Need};
use cube3_machine::MachineSpec;
use cube3_scene::{Image, Perspective, Scene, VolumeSource};
use cube3_sim::command::Arguments;
use cube3_vectors::{UnitFormat, units};
use cube3_volume::{FileFormat, FileInfo, NewGrid, Phantom, PhantomParams, Resampling, Space, Volume, World, write};
use std::path::Path;
use std::process::{Command, Output};

const MB: u64 = 1 << 20;
/// The variable that has a command line for [`child`], a word a line.
const LINE: &str = "CUBE3_TEST_COMMAND";
/// Voxels a side: in a program that is not optimised fewer.
const SIDES: [usize; 2] = if cfg!(debug_assertions) { [32, 48] } else { [96, 224] };

/// Not a test of its own: does what it is told and says how much memory that took at most.
#[test]
fn child() {
    let Ok(line) = std::env::var(LINE) else { return };
    let words = ["cube3"].into_iter().chain(line.lines());
    Arguments::try_parse_from(words).unwrap().execute().unwrap();
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    println!("{}", status.lines().find(|line| line.starts_with("VmHWM:")).unwrap());
}

/// Most memory that a command takes.
fn peak(folder: &Path, command: &[&str]) -> u64 {
    let mut run = Command::new(std::env::current_exe().unwrap());
    run.current_dir(folder).args(["memory::child", "--exact", "--nocapture"]).env(LINE, command.join("\n"));
    let output = run.output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    let line = text.lines().find_map(|line| line.split_once("VmHWM:"));
    let kib = line.and_then(|(_, rest)| rest.trim().strip_suffix(" kB")?.trim().parse::<u64>().ok());
    kib.unwrap_or_else(|| panic!("{command:?}: {text}{}", String::from_utf8_lossy(&output.stderr))) * 1024
}

/// Runs of a sphere, each with its words on the command line.
fn runs() -> Vec<(Vec<String>, Need)> {
    let mut runs_of = Vec::new();
    let machine = MachineSpec::default();
    for side in SIDES {
        for (runs, fidelity) in
            [(Runs::Function, "function"), (Runs::Timing, "timing"), (Runs::Both, "both"), (Runs::Cycle, "cycle")]
        {
            for (fov, threads, reference) in
                [(None, 1, "none"), (Some("30"), 2, "none"), (None, 2, "sheared"), (Some("30"), 2, "sheared")]
            {
                if runs == Runs::Cycle && (side > 100 || reference != "none") {
                    continue;
                }
                let mut scene = Scene { volume: VolumeSource::from_phantom("sphere", side), ..Scene::default() };
                scene.view.perspective = fov.map(|_| Perspective::new(30.0));
                let grid = Grid::of_phantom("sphere", side).unwrap();
                let reference_too = reference != "none";
                let case = Case {
                    scene: &scene,
                    machine: &machine,
                    grid,
                    runs,
                    reference: reference_too,
                    mask: false,
                    threads,
                };
                let mut words: Vec<String> =
                    ["run", "--phantom", "sphere", "--out", "out", "--size"].map(String::from).into();
                words.extend([
                    side.to_string(),
                    "--fidelity".into(),
                    fidelity.into(),
                    "--reference".into(),
                    reference.into(),
                ]);
                words.extend(["--threads".into(), threads.to_string()]);
                words.extend(fov.into_iter().flat_map(|fov| ["--fov".into(), fov.into()]));
                runs_of.push((words, case.frame()));
            }
        }
    }
    runs_of
}

/// What is known of a file that holds such a grid.
fn about(grid: &Grid) -> FileInfo {
    FileInfo {
        format: FileFormat::Nrrd,
        dims: grid.dims,
        stored_dims: grid.dims,
        spacing: [1.0; 3],
        origin: [0.0; 3],
        world: World::default(),
        sample_type: grid.sample_type,
        volumes: 1,
        remarks: Vec::new(),
    }
}

/// The study of word lengths, the bench, a checkpoint, a frame for the RTL and a recording.
fn studies_and_states() -> Vec<(Vec<String>, Need)> {
    let words = |line: &str| line.split(' ').map(String::from).collect::<Vec<String>>();
    let machine = MachineSpec::default();
    let side = SIDES[0];
    let scene_of = |side| Scene { volume: VolumeSource::from_phantom("sphere", side), ..Scene::default() };
    let (scene, small) = (scene_of(side), scene_of(32));
    let studied = Scene { image: Image { width_px: 192, height_px: 192, ..small.image.clone() }, ..small.clone() };
    let grid = |side| Grid::of_phantom("sphere", side).unwrap();
    let of = |scene, side, runs| Case {
        scene,
        machine: &machine,
        grid: grid(side),
        runs,
        reference: runs == Runs::Function,
        mask: false,
        threads: 2,
    };
    let checkpoint = of(&scene, side, Runs::Cycle);
    let run = "run --phantom sphere --fidelity cycle --reference none --threads 2 --out out --checkpoint-at 500";
    let timing = SIDES[1];
    vec![
        (words(&format!("{run} --size {side}")), checkpoint.checkpoint(checkpoint.frame(), true, 0)),
        (words("vectors --frame --phantom sphere --size 32 --out out"), of(&small, 32, Runs::Cycle).rtl_frame()),
        (
            words("vectors --unit trilin --from-run --phantom sphere --size 32 --count 2000 --out out"),
            of(&small, 32, Runs::Cycle).recording(),
        ),
        (
            words("verify --words --phantom sphere --size 32 --wires accumulator --threads 2 --out out"),
            of(&studied, 32, Runs::Function).words_study(),
        ),
        (
            words(&format!("bench --size {side} --timing-size {timing} --repeats 1 --threads 2")),
            memory::bench(cube3_sim::bench::COPY_BYTES as u64, side, timing, 2),
        ),
    ]
}

/// What is taken is at most what was told, and at least half of it but for 64 MB.
#[test]
fn estimates_are_bounds_and_not_silly() {
    let folder = tempfile::tempdir().unwrap();
    let mut cases = runs();
    let words = |line: &str| line.split(' ').map(String::from).collect::<Vec<String>>();
    let machine = MachineSpec::default();
    // A large picture, alone and beside a reference.
    let width = if cfg!(debug_assertions) { 600 } else { 1600 };
    let mut scene = Scene { volume: VolumeSource::from_phantom("sphere", 16), ..Scene::default() };
    scene.image = Image { width_px: width, height_px: width, ..Image::default() };
    std::fs::write(folder.path().join("scene.toml"), scene.to_toml().unwrap()).unwrap();
    for reference in [false, true] {
        let grid = Grid::of_phantom("sphere", 16).unwrap();
        let case =
            Case { scene: &scene, machine: &machine, grid, runs: Runs::Function, reference, mask: false, threads: 1 };
        let name = if reference { "image-order:8" } else { "none" };
        let line = format!("run --scene scene.toml --fidelity function --threads 1 --out out --reference {name}");
        cases.push((words(&line), case.frame()));
    }
    // An eye in the volume, which sees to all sides.
    let mut scene = Scene { volume: VolumeSource::from_phantom("sphere", SIDES[0]), ..Scene::default() };
    let eye = Perspective { eye_voxel: Some([20.0; 3]), ..Perspective::new(90.0) };
    scene.view.perspective = Some(eye);
    let grid = Grid::of_phantom("sphere", SIDES[0]).unwrap();
    let case =
        Case { scene: &scene, machine: &machine, grid, runs: Runs::Both, reference: false, mask: false, threads: 2 };
    let line = "run --phantom sphere --fov 90 --eye 20,20,20 --threads 2 --out out --reference none --size";
    cases.push((words(&format!("{line} {}", SIDES[0])), case.frame()));
    // A sequence whose volumes move.
    let mut scene = Scene { volume: VolumeSource::from_phantom("beating-heart", SIDES[0]), ..Scene::default() };
    scene.volume.phase = None;
    let grid = Grid::of_phantom("beating-heart", SIDES[0]).unwrap();
    let case =
        Case { scene: &scene, machine: &machine, grid, runs: Runs::Cycle, reference: false, mask: false, threads: 1 };
    let line = "run --phantom beating-heart --fidelity cycle --reference none --frames 4 --threads 1 --out out --size";
    cases.push((words(&format!("{line} {}", SIDES[0])), case.sequence(4, true, 4)));
    let side = SIDES[1];
    let fog = Grid::of_phantom("fog", side).unwrap();
    let phantom = words(&format!("volume phantom fog --out fog.nrrd --size {side}"));
    cases.push((phantom, memory::volume("the phantom", &fog, false)));
    cases.push((words("volume convert fog.nrrd fog16.nrrd --bits 12"), memory::volume("fog.nrrd", &fog, true)));
    let of = |name: &str| units().into_iter().find(|unit| unit.sheet().name == name).unwrap();
    let lanes = |lanes| UnitFormat { lanes, ..UnitFormat::default() };
    for (name, setting, format) in [("dsb", "lanes=512", lanes(512)), ("cone", "leaves=256", lanes(256))] {
        let line = format!("verify --unit {name} --set {setting} --count 20 --out out");
        cases.push((words(&line), memory::set(of(name).as_ref(), &format, true).unwrap()));
    }
    let tables = UnitFormat { rows: 64, ..UnitFormat::default() };
    let line = "vectors --unit classify --set rows=64 --count 20000 --out out";
    cases.push((words(line), memory::set(of("classify").as_ref(), &tables, false).unwrap()));
    // Lines stream: more of them take no more.
    let line = "vectors --unit gradient-26 --count 100000 --out out";
    cases.push((words(line), memory::set(of("gradient-26").as_ref(), &UnitFormat::default(), false).unwrap()));
    cases.extend(studies_and_states());
    let grown = Resampling { grid: NewGrid::Size([side + 40; 3]), ..Resampling::default() };
    cases.push((
        words(&format!("volume resample fog.nrrd grown.nrrd --size {0}x{0}x{0}", side + 40)),
        memory::resampling("fog.nrrd", &about(&fog), &grown).unwrap(),
    ));
    for (words, need) in cases {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        let (taken, told) = (peak(folder.path(), &words), need.bytes());
        println!("{:>5} MB taken, {:>5} told: {}", taken / MB, told / MB, words.join(" "));
        assert!(taken <= told, "{words:?}: {taken} bytes were taken, {told} told: {need:?}");
        assert!(told <= 2 * taken + 64 * MB, "{words:?}: {taken} bytes were taken, {told} told: {need:?}");
    }
}

/// The header alone gives the grid, whatever the format.
#[test]
fn a_grid_is_known_before_its_voxels() {
    let folder = tempfile::tempdir().unwrap();
    let options = cube3_volume::ReadOptions::default();
    let phantom = |words: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder.path()).args(words).output().unwrap();
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    };
    phantom(&["volume", "phantom", "fog", "--size", "12", "--out", "fog.nrrd"]);
    phantom(&["volume", "convert", "fog.nrrd", "plain.nrrd", "--uncompressed", "--bits", "8"]);
    let fog = Grid::of_phantom("fog", 12).unwrap();
    assert_eq!(Grid::of_file(&folder.path().join("fog.nrrd"), &options).unwrap(), fog);
    let plain = Grid::of_file(&folder.path().join("plain.nrrd"), &options).unwrap();
    assert_eq!((plain.dims, plain.bytes()), ([12; 3], 2 * 12 * 12 * 12));
    assert!(Grid::of_file(&folder.path().join("none.nrrd"), &options).is_err());
}

/// Runs the program with so many MB of address space.
fn limited(folder: &Path, mb: u64, words: &[&str]) -> Output {
    let line = format!("ulimit -v {}; exec \"$0\" \"$@\"", mb * 1024);
    Command::new("sh")
        .current_dir(folder)
        .args(["-c", &line, env!("CARGO_BIN_EXE_cube3")])
        .args(words)
        .output()
        .unwrap()
}

/// Whether a command was refused for its memory, in one line.
fn refused(output: &Output) -> bool {
    let message = String::from_utf8_lossy(&output.stderr);
    let told = message.contains("of memory are needed") && message.contains("left in the address space (ulimit -v): ");
    output.status.code() == Some(2) && told && message.trim_end().lines().count() == 1
}

#[test]
fn what_does_not_fit_is_refused_before_it_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("large.toml"), "[image]\nwidth_px = 16384\nheight_px = 16384\n").unwrap();
    // A header of a volume of 64 GB whose voxels are zeros that no disk holds.
    let header = "NRRD0005\ntype: uint8\ndimension: 3\nsizes: 4000 4000 4000\nencoding: raw\n\n";
    std::fs::write(folder.path().join("huge.nrrd"), header).unwrap();
    let file = std::fs::File::options().write(true).open(folder.path().join("huge.nrrd")).unwrap();
    file.set_len(header.len() as u64 + 4000_u64.pow(3)).unwrap();
    for line in [
        "run --size 4000",
        "run --size 4000 --fidelity timing --reference none",
        "run --size 4000 --fidelity cycle --fov 30",
        "run --scene large.toml --size 16",
        "run --volume huge.nrrd",
        "run --frames 8 --phantom beating-heart --size 600",
        "run --frames 100000 --size 16 --fidelity cycle",
        "volume phantom sphere --size 4000",
        "volume info huge.nrrd",
        "volume convert huge.nrrd small.nrrd --bits 8",
        "bench --size 4000",
        "bench --timing-size 8000",
        "vectors --unit trilin --from-run --size 4000",
        "vectors --frame --size 4000",
        "vectors --unit normalise --set normal_bits=15,root_bits=27",
        "verify --unit dsb --set lanes=4096",
        "verify --unit classify --set table_bits=16,rows=256,classes=16",
        "verify --words --size 4000",
        "verify --words --scene large.toml --size 16",
    ] {
        let words: Vec<&str> = line.split(' ').collect();
        let output = limited(folder.path(), 2000, &words);
        assert!(refused(&output), "{line}: {:?} {}", output.status, String::from_utf8_lossy(&output.stderr));
    }
}

/// Above 1 GB the estimate is printed; here that of a trace, of a run that ends long before its window.
#[test]
fn a_large_estimate_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let run = ["run", "--size", "8", "--fidelity", "timing", "--trace", "trace.json", "--out", "out", "--to"];
    for (to, told) in [("500000", "memory: about 1.1 GB\n"), ("50000", "")] {
        let words = [&run[..], &[to]].concat();
        let output = Command::new(env!("CARGO_BIN_EXE_cube3")).current_dir(folder.path()).args(words).output().unwrap();
        assert!(output.status.success());
        assert_eq!(String::from_utf8_lossy(&output.stderr), told);
    }
}

/// Whatever the limit, a run ends well or is refused: it is never killed.
#[test]
fn just_enough_passes_and_less_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, machine) = (Scene::default(), MachineSpec::default());
    let grid = Grid::of_phantom("head", 40).unwrap();
    let case =
        Case { scene: &scene, machine: &machine, grid, runs: Runs::Both, reference: false, mask: false, threads: 2 };
    // The addresses of two threads, of the two beside them, and of the program.
    let need = (case.frame().bytes() + 4 * 66 * MB) / MB;
    let words = ["run", "--size", "40", "--reference", "none", "--threads", "2", "--out", "out"];
    // Threads that show progress are there already when the limit is looked at, or not yet.
    let enough = need + 100 + 2 * 66;
    let (mut passed, mut told) = (0, 0);
    for mb in (100..enough + 20).step_by(40).chain([need, enough]) {
        let output = limited(folder.path(), mb, &words);
        let (well, refused) = (output.status.success(), refused(&output));
        assert!(well || refused, "{mb} MB: {:?} {}", output.status, String::from_utf8_lossy(&output.stderr));
        assert!(if mb <= need { refused } else { well || mb < enough }, "{mb} MB of {need}");
        (passed, told) = (passed + u32::from(well), told + u32::from(refused));
    }
    assert!(passed > 0 && told > 3);
}

/// A file takes its voxels and 16 MB beside them, compressed or not, and however its axes are turned.
#[test]
fn reading_takes_the_voxels_and_a_little() {
    let folder = tempfile::tempdir().unwrap();
    let side = SIDES[1];
    let sphere = |size: usize| Phantom::Sphere.generate(size, &PhantomParams::default()).unwrap();
    let save = |name: &str, volume: &Volume, directions: [[f64; 3]; 3]| {
        let world = World { space: Space::Patient, directions, ..World::default() };
        write(folder.path().join(name), &volume.clone().with_world([0.0; 3], world).unwrap()).unwrap();
    };
    let straight = World::default().directions;
    save("small.nrrd", &sphere(4), straight);
    let idle = peak(folder.path(), &["volume", "info", "small.nrrd"]);
    let volume = sphere(side);
    let bytes = 2 * volume.len() as u64;
    save("ras.nrrd", &volume, straight);
    save("pir.nrrd", &volume, [[0.0, -1.0, 0.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]);
    save("las.nii.gz", &volume, [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    save("sar.mha", &volume, [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
    save("words.raw", &volume, straight);
    let dims = format!("{side}x{side}x{side}");
    for name in ["ras.nrrd", "pir.nrrd", "las.nii.gz", "sar.mha", "words.raw"] {
        let mut command = vec!["volume", "info", name];
        if name.ends_with(".raw") {
            command.extend(["--dims", &dims, "--type", "u16"]);
        }
        let taken = peak(folder.path(), &command).saturating_sub(idle);
        // What was idle is used again.
        assert!(taken + MB >= bytes && taken <= bytes + 16 * MB, "{name}: {taken} bytes for {bytes}");
    }
}
