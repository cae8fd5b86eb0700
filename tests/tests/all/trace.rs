//! Traces: one stream of events that adds up to the counters, and three files that hold what the stream holds.

use cube3::clocked::{Stops, TraceRequest};
use cube3::{RunOptions, Runs, run_frame};
use cube3_cases::cases;
use cube3_channel::{Account, Activity, Reason};
use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_inputs as inputs;
use cube3_machine::{Boards, Frames, MachineSpec};
use cube3_pipeline::{CHANNELS, Machine, RunCounters, UNITS};
use cube3_pipeline::{Token, TokenKind};
use cube3_scene::{Scene, VolumeSource};
use cube3_tests::waves::Waves;
use cube3_tests::{SmallVolume, machines, scenes, volumes};
use cube3_trace::{CycleWindow, Events, Recorder, Recording, TraceFormat};
use cube3_volume::ReadOptions;
use proptest::prelude::*;
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// A timing run of some frames, traced from one cycle to another, and its counters.
fn traced(machine: &MachineSpec, setups: &[FrameSetup], from: u64, to: u64) -> (Recording, RunCounters) {
    let mut run = Machine::timing(machine, setups.to_vec()).unwrap();
    run.run_until(from, &|_, _| {}).unwrap();
    let mut recorder = Recorder::new(&run, CycleWindow { from, to }, machine.clock_hz);
    recorder.run(&mut run, to, &|_, _| {}).unwrap();
    run.run(&|_, _| {}).unwrap();
    (recorder.finish(), run.counters())
}

fn events(recording: &Recording) -> Vec<Events> {
    let mut all = Vec::new();
    recording
        .replay(|events| {
            all.push(events.clone());
            Ok::<(), ()>(())
        })
        .unwrap();
    all
}

fn setups(machine: &MachineSpec, scenes: &[Scene], volume: &SmallVolume) -> Vec<FrameSetup> {
    scenes.iter().map(|scene| frame_setup(scene, machine, &volume.info(), true).unwrap().setup).collect()
}

fn cycles(machine: &MachineSpec, setups: &[FrameSetup]) -> RunCounters {
    let mut run = Machine::timing(machine, setups.to_vec()).unwrap();
    run.run(&|_, _| {}).unwrap();
    run.counters()
}

/// Machines, frames and windows; the window is given as two fractions of the run.
fn runs() -> impl Strategy<Value = (MachineSpec, Vec<FrameSetup>, [f64; 2])> {
    let scenes = proptest::collection::vec(scenes(), 1..3);
    (machines(), scenes, volumes(6, 8), any::<bool>(), 1.0..1e10_f64, [0.0..1.0_f64, 0.0..1.0_f64]).prop_map(
        |(machine, scenes, volume, overlap, clock_hz, window)| {
            let machine = MachineSpec { frames: Frames { overlap }, clock_hz, ..machine };
            let setups = setups(&machine, &scenes, &volume);
            (machine, setups, window)
        },
    )
}

/// A window of a run of `cycles` cycles, of one cycle at least.
fn window(cycles: u64, fractions: [f64; 2]) -> [u64; 2] {
    let mut ends = fractions.map(|fraction| (fraction * cycles as f64) as u64);
    ends.sort_unstable();
    [ends[0], ends[1].max(ends[0] + 1).min(cycles)]
}

/// A token of a waveform, where there is one.
fn token(waves: &Waves, channel: &str, way: &str, kind: TokenKind, place: usize) -> Option<Token> {
    let field = |name: &str| waves.word(&format!("cube3.{channel}.{way}_{name}"), place).map(|word| word as u32);
    Some(Token { frame: field("frame")?, plane: field("plane")?, place: field(kind.place())? })
}

proptest! {
    #![proptest_config(cases(100))]

    #[test]
    fn the_events_add_up_to_the_counters_and_a_window_is_a_part_of_the_whole((machine, setups, fractions) in runs()) {
        let plain = cycles(&machine, &setups);
        let (whole, counters) = traced(&machine, &setups, 0, plain.cycles);
        prop_assert_eq!(&counters, &plain, "a trace changes nothing");
        let all = events(&whole);
        prop_assert_eq!(all.len() as u64, plain.cycles);
        for unit in 0..UNITS {
            let mut account = Account::default();
            for events in &all {
                account.record(events.activities[unit]);
            }
            prop_assert_eq!((whole.units()[unit], account), plain.units[unit]);
        }
        for i in 0..CHANNELS {
            let reading = plain.channels[i];
            let pushed: Vec<Token> = all.iter().filter_map(|events| events.pushed[i]).collect();
            let popped: Vec<Token> = all.iter().filter_map(|events| events.popped[i]).collect();
            prop_assert_eq!(pushed.len() as u64, reading.counters.pushes);
            prop_assert_eq!(&pushed, &popped, "first in, first out, and nothing is left");
            prop_assert_eq!(all.iter().map(|events| events.occupancy[i] as u64).sum::<u64>(), reading.counters.occupancy_cycles);
            prop_assert!(all.iter().all(|events| events.popped[i].is_none() || events.popped[i] == events.front[i]));
            let mut each = pushed.clone();
            each.sort_unstable();
            each.dedup();
            prop_assert_eq!(each.len(), pushed.len(), "every token has a name of its own");
        }
        let [from, to] = window(plain.cycles, fractions);
        let (part, _) = traced(&machine, &setups, from, to);
        prop_assert_eq!(&events(&part)[..], &all[from as usize..to as usize]);
        for format in [TraceFormat::Fst, TraceFormat::Kanata, TraceFormat::Perfetto] {
            let bytes = part.write(format).unwrap().len() as u64;
            prop_assert!(bytes <= 8192 + format.bytes_per_cycle() * (to - from), "{}: {} bytes for {} cycles", format.name(), bytes, to - from);
        }
    }

    #[test]
    fn a_waveform_holds_every_event((machine, setups, fractions) in runs()) {
        let [from, to] = window(cycles(&machine, &setups).cycles, fractions);
        let (recording, _) = traced(&machine, &setups, from, to);
        let waves = Waves::by_wellen(recording.write(TraceFormat::Fst).unwrap());
        prop_assert_eq!(waves.times.len() as u64, 2 * (to - from) + 1, "two edges a cycle, and the end");
        for (events, place) in events(&recording).iter().zip((0..).step_by(2)) {
            let seconds = waves.seconds(place);
            let exact = events.cycle as f64 / machine.clock_hz;
            prop_assert!((seconds - exact).abs() <= 1e-3 / machine.clock_hz, "{} s for {} s", seconds, exact);
            prop_assert_eq!((waves.bits("cube3.clock", place), waves.bits("cube3.clock", place + 1)), ("1", "0"));
            for (i, name) in recording.units().into_iter().enumerate() {
                let scope = name.replace('.', "_");
                let activity = waves.word(&format!("cube3.{scope}.activity"), place).unwrap();
                prop_assert_eq!(Activity::from_code(activity as u8), Some(events.activities[i]));
                prop_assert_eq!(waves.text(&format!("cube3.{scope}.kind"), place), events.activities[i].name());
            }
            for (i, track) in recording.tracks().iter().enumerate() {
                let (channel, kind) = (track.joint.channel, track.joint.tokens);
                let word = |name: &str| waves.word(&format!("cube3.{channel}.{name}"), place);
                prop_assert_eq!(word("occupancy"), Some(events.occupancy[i] as u64));
                prop_assert_eq!(word("push"), Some(u64::from(events.pushed[i].is_some())));
                prop_assert_eq!(word("pop"), Some(u64::from(events.popped[i].is_some())));
                prop_assert_eq!(token(&waves, channel, "pushed", kind, place), events.pushed[i]);
                prop_assert_eq!(token(&waves, channel, "popped", kind, place), events.popped[i]);
            }
        }
    }

    #[test]
    fn konata_shows_every_token_where_it_was((machine, setups, fractions) in runs()) {
        let [from, to] = window(cycles(&machine, &setups).cycles, fractions);
        let (recording, _) = traced(&machine, &setups, from, to);
        let log = Log::read(&String::from_utf8(recording.write(TraceFormat::Kanata).unwrap()).unwrap());
        // What each token does, told by the stream of events.
        let mut entered: BTreeMap<(String, u64), String> = BTreeMap::new();
        let (mut stalls, mut retired) = (0, 0);
        let name = |kind: TokenKind, token: Token| {
            format!("{}: frame {}, plane {}, {} {}", kind.name(), token.frame, token.plane, kind.place(), token.place)
        };
        for events in events(&recording) {
            for (i, track) in recording.tracks().iter().enumerate() {
                let (joint, cycle) = (track.joint, events.cycle);
                let consumer = recording.units().iter().position(|unit| *unit == joint.to).unwrap();
                if let Some(token) = events.popped[i] {
                    // The same cycle as the first in the channel: then the token was never seen there.
                    entered.insert((name(joint.tokens, token), cycle), joint.to.into());
                    retired += u64::from(["aligned", "pixels"].contains(&joint.channel));
                } else if events.front[i].is_some() && is_stall(events.activities[consumer]) {
                    stalls += 1;
                }
                if let Some(token) = events.pushed[i]
                    && cycle + 1 < to
                {
                    entered.insert((name(joint.tokens, token), cycle + 1), joint.channel.into());
                }
            }
        }
        let shown: BTreeMap<(String, u64), String> = log.stages.iter().map(|(key, stage)| (key.clone(), stage.clone())).collect();
        for (key, stage) in &entered {
            prop_assert_eq!(shown.get(key), Some(stage), "{:?}", key);
        }
        for (key, stage) in &shown {
            // Beside those, a token has one more stage: where it was born, or stood when the window began.
            prop_assert!(entered.contains_key(key) || log.born[&key.0] == key.1, "{:?} {}", key, stage);
        }
        prop_assert_eq!(log.retired, retired);
        let born_stalls: u64 = log.stalls_before_channel;
        prop_assert_eq!(log.stall_cycles - born_stalls, stalls);
    }

    #[test]
    fn perfetto_shows_every_cycle_of_every_unit((machine, setups, fractions) in runs()) {
        let machine = MachineSpec { clock_hz: machine.clock_hz.min(1e9), ..machine };
        let [from, to] = window(cycles(&machine, &setups).cycles, fractions);
        let (recording, _) = traced(&machine, &setups, from, to);
        let text = String::from_utf8(recording.write(TraceFormat::Perfetto).unwrap()).unwrap();
        let trace: serde_json::Value = serde_json::from_str(&text).unwrap();
        let all = events(&recording);
        let trace = trace["traceEvents"].as_array().unwrap();
        for unit in 0..UNITS {
            let mut at = from;
            let mut end_us: Option<f64> = None;
            for slice in trace.iter().filter(|event| event["ph"] == "X" && event["tid"] == unit + 1) {
                prop_assert_eq!(slice["args"]["cycle"].as_u64(), Some(at), "slices follow one another");
                let cycles = slice["args"]["cycles"].as_u64().unwrap();
                for events in &all[(at - from) as usize..][..cycles as usize] {
                    prop_assert_eq!(slice["name"].as_str(), Some(events.activities[unit].name()));
                }
                let [start, duration] = ["ts", "dur"].map(|key| slice[key].as_f64().unwrap());
                prop_assert!((start - at as f64 * 1e6 / machine.clock_hz).abs() <= 0.000_501 + start * 1e-15);
                if let Some(end) = end_us {
                    prop_assert!((start - end).abs() < 0.000_2 + start * 1e-14, "and leave no gap");
                }
                end_us = Some(start + duration);
                at += cycles;
            }
            prop_assert_eq!(at, to);
        }
        for (i, track) in recording.tracks().iter().enumerate() {
            let counter = trace.iter().rfind(|event| event["ph"] == "C" && event["name"] == track.joint.channel).unwrap();
            prop_assert_eq!(counter["args"]["tokens"].as_u64(), Some(all.last().unwrap().occupancy[i] as u64));
        }
    }
}

fn is_stall(activity: Activity) -> bool {
    matches!(activity, Activity::Blocked | Activity::Waiting(_))
}

/// A Kanata log, read by the rules of its format.
#[derive(Default)]
struct Log {
    born: HashMap<String, u64>,
    /// The stage that a token enters in a cycle, on lane 0.
    stages: HashMap<(String, u64), String>,
    retired: u64,
    /// Cycles on lane 1, of all tokens, and those of tokens that are still with the unit that makes them.
    stall_cycles: u64,
    stalls_before_channel: u64,
}

impl Log {
    fn read(text: &str) -> Log {
        let mut log = Log::default();
        let mut lines = text.lines().map(|line| line.split('\t').collect::<Vec<_>>());
        assert_eq!(lines.next().unwrap(), ["Kanata", "0004"]);
        let start = lines.next().unwrap();
        assert_eq!(start[0], "C=");
        let mut now: u64 = start[1].parse().unwrap();
        let mut names: Vec<String> = Vec::new();
        let mut stages: Vec<String> = Vec::new();
        let mut stalls: HashMap<usize, (u64, String)> = HashMap::new();
        let mut ended: Vec<usize> = Vec::new();
        for line in lines {
            let id = || line[1].parse::<usize>().unwrap();
            match line[0] {
                "C" => now += line[1].parse::<u64>().unwrap(),
                "I" => {
                    assert_eq!(id(), names.len(), "ids in sequence");
                    names.push(String::new());
                    stages.push(String::new());
                }
                "L" => {
                    assert!(log.born.insert(line[3].into(), now).is_none(), "{} twice", line[3]);
                    names[id()] = line[3].into();
                }
                "S" if line[2] == "0" => {
                    stages[id()] = line[3].into();
                    assert!(log.stages.insert((names[id()].clone(), now), line[3].into()).is_none());
                }
                "S" => assert!(stalls.insert(id(), (now, line[3].into())).is_none(), "one stall at a time"),
                "E" => {
                    let (since, name) = stalls.remove(&id()).unwrap();
                    assert_eq!((line[2], line[3]), ("1", name.as_str()));
                    log.stall_cycles += now - since;
                    if ["cfb", "dsb.read"].contains(&stages[id()].as_str()) {
                        log.stalls_before_channel += now - since;
                    }
                }
                "R" => {
                    assert_eq!(line[2].parse::<u64>().unwrap(), log.retired);
                    assert!(!ended.contains(&id()));
                    ended.push(id());
                    log.retired += 1;
                }
                other => panic!("{other}"),
            }
        }
        assert!(stalls.is_empty());
        log
    }
}

#[test]
fn a_ray_whose_nodes_wait_on_links_is_not_there_yet() {
    let machine = MachineSpec {
        lanes: 8,
        boards: Boards { count: 2, link_words_per_cycle: Some(0.25), ..Boards::default() },
        ..MachineSpec::default()
    };
    let info = VolumeInfo { dims: [8; 3], spacing: [1.0; 3], window: [0.0, 65535.0] };
    let setup = frame_setup(&Scene::default(), &machine, &info, true).unwrap().setup;
    let to = cycles(&machine, std::slice::from_ref(&setup)).cycles;
    let (recording, _) = traced(&machine, &[setup], 0, to);
    let cone = recording.units().iter().position(|unit| *unit == "cone").unwrap();
    let shaded = recording.tracks().iter().position(|track| track.joint.to == "cone").unwrap();
    let all = events(&recording);
    // The cone's own channel has no words on links: it waits for those of the ray in front alone.
    let waits = |events: &&Events| events.activities[cone] == Activity::Waiting(Reason::Link);
    assert!(all.iter().filter(waits).count() > to as usize / 4);
    assert!(all.iter().filter(waits).all(|events| events.front[shaded].is_none()));
}

#[test]
fn windows_and_files_that_cannot_be_are_refused() {
    let refused = |from, to, format| CycleWindow::new(from, to, format).unwrap_err().to_string();
    assert!(refused(5, 5, TraceFormat::Fst).contains("no window of cycles"));
    assert!(refused(6, 5, TraceFormat::Fst).contains("no window of cycles"));
    for format in [TraceFormat::Fst, TraceFormat::Kanata, TraceFormat::Perfetto] {
        let most = TraceFormat::LIMIT_BYTES / format.bytes_per_cycle();
        assert!(CycleWindow::new(7, 7 + most, format).is_ok());
        assert!(refused(7, 8 + most, format).contains(&format!("give {most} cycles at most")));
        assert!(refused(0, u64::MAX, format).contains("above the limit"));
    }
    assert!(TraceFormat::of(Path::new("a.vcd")).unwrap_err().to_string().contains(".kanata"));
    assert!(TraceFormat::of(Path::new("fst")).is_err());
}

/// The run of `traces/small-machine.kanata`; `traces/README.md` tells how to write it again.
#[test]
fn the_small_machine_has_the_trace_of_the_reference() {
    let traces = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../traces"));
    let machine = inputs::machine(traces.join("small-machine.toml").to_str().unwrap()).unwrap();
    let scene = Scene { volume: VolumeSource::from_phantom("head", 8), ..Scene::default() };
    let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let reference = std::fs::read_to_string(traces.join("small-machine.kanata")).unwrap();
    for runs in [Runs::Timing, Runs::Cycle] {
        let path = folder.path().join("trace.kanata");
        let trace = TraceRequest {
            path: path.clone(),
            format: TraceFormat::Kanata,
            window: CycleWindow { from: 100, to: 140 },
        };
        let stops = Stops { trace: Some(trace), ..Stops::default() };
        let options = RunOptions { runs, reference: None, ..RunOptions::default() };
        run_frame(&scene, &machine, &volume, &options, &stops, &|_, _, _| {}).unwrap();
        assert_eq!(std::fs::read_to_string(path).unwrap(), reference, "{}", runs.name());
    }
    for word in ["blocked", "bank_conflict", "samples", "host"] {
        assert!(reference.contains(word), "the reference shows {word}");
    }
}
