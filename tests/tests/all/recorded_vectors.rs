//! Recorded traffic is that of the cycle machine: what a unit's definition makes of its recorded lines is what the next unit got.

use cube3_abc::ShadedSamples;
use cube3_abc::golden::{Local, classify_in, direction_index, lit, local_gradient, normalise, phong_from};
use cube3_cases::cases;
use cube3_cone::Pixels;
use cube3_cone::golden::{Node, leaf, pixel};
use cube3_cone::segments;
use cube3_definition::Definition;
use cube3_frame::{BeamPlace, FrameSetup, LinearFactor, Phong, PhongLight, Schedule, Shading};
use cube3_host::picture_setup;
use cube3_machine::{ConeOrder, GradientMethod, MachineSpec, RayEnds};
use cube3_pipeline::Machine;
use cube3_scene::{Perspective, Scene};
use cube3_tests::{SmallVolume, for_perspective, from_eye, machines, perspectives, scenes, volumes};
use cube3_trilin::RaySamples;
use cube3_vectors::record::{Excerpt, RecordError, Run, record};
use cube3_vectors::{Reader, Set, Sheet, Tables, Unit, UnitFormat, Vectors, WireRecorder, units};
use cube3_word::Probe;
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

/// What a unit is sent, whether its sheet is there or not: its name alone.
struct Lines(&'static str);

impl Unit for Lines {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: self.0,
            title: "",
            purpose: "",
            source: "",
            parameters: &[],
            module: None,
            inputs: Vec::new(),
            tables: Vec::new(),
            wires: Vec::new(),
            outputs: Vec::new(),
            clocked: false,
        }
    }

    fn evaluate(&self, _: &UnitFormat, _: &Tables, _: &[i128], _: &mut WireRecorder) -> Vec<i128> {
        Vec::new()
    }
}

/// The tokens of a frame of a cycle run, in order.
#[derive(Clone, Default)]
struct Tokens {
    samples: Vec<RaySamples>,
    /// With plane and slot.
    shaded: Vec<([usize; 2], ShadedSamples)>,
    pixels: Vec<Pixels>,
}

fn tokens(machine: &MachineSpec, setups: &[Arc<FrameSetup>], volume: &SmallVolume) -> Vec<Tokens> {
    let mut cycle = Machine::cycle(machine, setups.to_vec(), volume.dims, &volume.words).unwrap();
    let mut frames = vec![Tokens::default(); setups.len()];
    let mut pushes = [0; 3];
    loop {
        let done = cycle.run_until(cycle.now() + 1, &|_, _| {}).unwrap();
        let data = cycle.data();
        let now = [data.samples.counters().pushes, data.shaded.counters().pushes, data.pixels.counters().pushes];
        if let Some(ray) = data.samples.newest().filter(|_| now[0] > pushes[0]) {
            frames[ray.frame as usize].samples.push(ray.data.clone());
        }
        if let Some(ray) = data.shaded.newest().filter(|_| now[1] > pushes[1]) {
            frames[ray.frame as usize].shaded.push(([ray.plane as usize, ray.slot as usize], ray.data.clone()));
        }
        if let Some(group) = data.pixels.newest().filter(|_| now[2] > pushes[2]) {
            frames[group.frame as usize].pixels.push(group.data.clone());
        }
        pushes = now;
        if done {
            return frames;
        }
    }
}

const ALL: Excerpt<'static> = Excerpt { frame: 0, first: 0, count: usize::MAX, channel: "rays" };

/// A unit's recording of a frame; none where the frame does not use it, or its vectors cannot hold the traffic of a slot that more
/// than three rays share or of a volume many times wider than the machine.
fn recorded(run: &Run<'_>, unit: &dyn Unit, frame: usize) -> Option<Vectors> {
    let name = unit.sheet().name;
    match record(run, unit, &Excerpt { frame, ..ALL }) {
        Ok(vectors) => Some(vectors),
        Err(RecordError::Idle { .. } | RecordError::Ends) => None,
        Err(RecordError::Value { .. }) if ["cone", "dsb"].contains(&name) => None,
        // No sample in the volume, or none that gets so far.
        Err(RecordError::Beyond { found: 0, .. }) => None,
        Err(error) => panic!("{name}: {error}"),
    }
}

fn of_name(name: &str) -> Box<dyn Unit> {
    units().into_iter().find(|unit| unit.sheet().name == name).unwrap()
}

fn node_of(fields: &[i128]) -> Node {
    let rgba = std::array::from_fn(|i| fields[2 + i] as u64);
    Node { present: fields[0] == 1, sample: fields[1] as i32, rgba }
}

/// Units whose wires a frame by definition has.
const UNITS: [&str; 12] = [
    "trilin",
    "clip",
    "gradient",
    "normalise",
    "classify",
    "phong",
    "reflectance",
    "lit",
    "cue",
    "leaf",
    "node",
    "pixel",
];

/// Part, name, place and value.
type Wires = BTreeSet<(&'static str, &'static str, usize, i128)>;

/// The wires of a walk over a frame, by unit.
#[derive(Default)]
struct Walk {
    unit: Option<&'static str>,
    part: (&'static str, usize),
    seen: BTreeMap<&'static str, Wires>,
}

impl Probe for Walk {
    fn wire(&mut self, name: &'static str, place: usize, value: i128) {
        let (part, of_part) = self.part;
        self.seen.entry(self.unit.unwrap()).or_default().insert((part, name, of_part + place, value));
    }

    fn within<R>(&mut self, part: &'static str, place: usize, work: impl FnOnce(&mut Self) -> R) -> R {
        let outer = (self.unit, self.part);
        match self.unit {
            Some(_) => self.part = (part, place),
            None => self.unit = UNITS.into_iter().find(|unit| *unit == part),
        }
        let result = work(self);
        (self.unit, self.part) = outer;
        result
    }
}

/// The wires of a unit's recorded lines.
fn wires(name: &str, vectors: &Vectors) -> Wires {
    let mut recorder = WireRecorder::default();
    let Set { format, tables, .. } = &vectors.set;
    for line in &vectors.inputs {
        of_name(name).evaluate(format, tables, line, &mut recorder);
    }
    recorder.seen().iter().map(|seen| (seen.part, seen.name, seen.place, seen.value)).collect()
}

/// The name of the unit of a gradient's method.
fn gradient_unit(method: GradientMethod) -> &'static str {
    match method {
        GradientMethod::Six => "gradient-6",
        GradientMethod::TwentySix => "gradient-26",
        GradientMethod::Ten | GradientMethod::TenNormalised => "gradient-10",
        GradientMethod::Twelve => "gradient-12",
        GradientMethod::SixSheared => "gradient-6d",
        GradientMethod::TwentySixSheared => "gradient-26d",
    }
}

fn case() -> impl Strategy<Value = (MachineSpec, Scene, SmallVolume)> {
    (machines(), scenes(), perspectives(), any::<bool>()).prop_flat_map(
        |(machine, scene, perspective, parallel): (_, _, Perspective, bool)| {
            let bits = machine.words.voxel_bits;
            let (machine, scene) =
                if parallel { (machine, scene) } else { (for_perspective(&machine), from_eye(&scene, perspective)) };
            (Just(machine), Just(scene), volumes(7, bits))
        },
    )
}

fn frames((machine, scene, volume): &(MachineSpec, Scene, SmallVolume)) -> Vec<Arc<FrameSetup>> {
    picture_setup(scene, machine, &volume.info(), true).unwrap().setups
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(200) })]

    #[test]
    fn samples_leaves_nodes_and_pixels_are_those_of_the_cycle_run(case in case()) {
        let setups = frames(&case);
        let (machine, _, volume) = &case;
        prop_assume!(!setups.is_empty());
        let run = Run { machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
        for (frame, (setup, tokens)) in setups.iter().zip(tokens(machine, &setups, volume)).enumerate() {
            let [slots, planes] = setup.geometry.slot_counts();
            let depths = setup.geometry.size[2];
            let places = || (0..slots * planes).flat_map(|token| (0..depths).map(move |k| (token, k)));
            let outputs = |name: &str| recorded(&run, of_name(name).as_ref(), frame).map(|vectors| vectors.outputs);

            let samples: Vec<Vec<i128>> = places()
                .filter_map(|(token, k)| Some(vec![tokens.samples[token].at(k)?.into()]))
                .collect();
            prop_assert_eq!(outputs("trilin").unwrap_or_default(), samples);

            let at = |token: usize, k: usize| leaf(&tokens.shaded[token].1.at(k), &setup.cone, &setup.words);
            let fields = |node: Node| {
                let mut fields = vec![node.present.into(), node.sample.into()];
                fields.extend(node.rgba.map(i128::from));
                fields
            };
            let leaves: Vec<Vec<i128>> = places().map(|(token, k)| fields(at(token, k))).collect();
            prop_assert_eq!(outputs("leaf").unwrap_or_default(), leaves);

            // The nodes of the run get what is recorded, call by call, and what the recording says to it makes the pixels.
            let nodes = recorded(&run, of_name("node").as_ref(), frame);
            let mut calls = nodes.iter().flat_map(|nodes| nodes.inputs.iter().zip(&nodes.outputs));
            let mut wrong = 0;
            let mut rays = Vec::new();
            for token in 0..slots * planes {
                let at = |k: usize| at(token, k);
                let [plane, slot] = tokens.shaded[token].0;
                rays.extend(segments(setup, plane, slot, at, &mut |left, right| {
                    let Some((inputs, outputs)) = calls.next() else {
                        wrong += 1;
                        return Node::default();
                    };
                    wrong += usize::from(inputs[1..7] != fields(left) || inputs[7..] != fields(right));
                    node_of(outputs)
                }));
            }
            prop_assert_eq!((wrong, calls.next()), (0, None));
            let got: Vec<[u32; 4]> = rays.iter().map(|ray| pixel(ray.node, &setup.cone, &setup.words).value).collect();
            let expected: Vec<[u32; 4]> = tokens.pixels.iter().flat_map(|group| group.0.iter().map(|p| p.rgba)).collect();
            prop_assert_eq!(&got, &expected);
            let pixels: Vec<Vec<i128>> = expected.iter().map(|rgba| rgba.map(i128::from).to_vec()).collect();
            let recorded_pixels: Vec<Vec<i128>> =
                outputs("pixel").unwrap_or_default().into_iter().map(|line| line[..4].to_vec()).collect();
            prop_assert_eq!(recorded_pixels, pixels);

            // A ray that fits the leaves is the cone's alone.
            if depths <= setup.cone.leaves && setup.cone.order == ConeOrder::Tree
                && let Some(cones) = outputs("cone") {
                let mut rays = rays.iter();
                for line in cones {
                    for ray in 0..line[0] as usize {
                        let mut node = vec![line[1 + ray], line[4 + ray]];
                        node.extend(&line[7 + 4 * ray..11 + 4 * ray]);
                        prop_assert_eq!(rays.next().map(|ray| ray.node), Some(node_of(&node)));
                    }
                }
                prop_assert!(rays.next().is_none());
            }
        }
    }

    /// Of gradients, lines have wires of factors that are 1 too, and of light those of a light that gives none; of pixels, a frame has those
    /// of rays beside the volume, which no slot has.
    #[test]
    fn the_wires_of_recorded_lines_are_those_of_the_frame_by_definition(case in case()) {
        let setups = frames(&case);
        let (machine, _, volume) = &case;
        let run = Run { machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
        for (frame, setup) in setups.iter().enumerate() {
            let mut walk = Walk::default();
            Definition::new(setup, &volume.words).base_plane_wires(&mut walk);
            for name in UNITS {
                let of = walk.seen.remove(name).unwrap_or_default();
                let name = match &setup.gradient {
                    Some(registers) if name == "gradient" => gradient_unit(registers.method),
                    None if name == "gradient" => continue,
                    _ => name,
                };
                if name == "classify" && setup.ends.is_some() {
                    continue;
                }
                let recorded = recorded(&run, of_name(name).as_ref(), frame).map(|vectors| wires(name, &vectors)).unwrap_or_default();
                match name {
                    "pixel" => prop_assert!(of.is_superset(&recorded), "{}: {:?}", name, recorded.difference(&of).next()),
                    _ if name.starts_with("gradient-") || name == "phong" => {
                        prop_assert!(of.is_subset(&recorded), "{}: {:?}", name, of.difference(&recorded).next());
                    }
                    _ => prop_assert_eq!(of, recorded, "{}", name),
                }
            }
            prop_assert!(walk.seen.is_empty(), "{:?}", walk.seen.keys());
        }
    }

    #[test]
    fn each_stage_of_shading_gets_what_the_one_before_makes_up_to_the_coloured_samples(mut case in case()) {
        // Vectors of classification do not number the tables for the ends of rays.
        case.0.rays.ends = RayEnds::Published;
        let setups = frames(&case);
        let (machine, _, volume) = &case;
        prop_assume!(!setups.is_empty());
        let run = Run { machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
        for (frame, (setup, tokens)) in setups.iter().zip(tokens(machine, &setups, volume)).enumerate() {
            let words = &setup.words;
            let lines = |name| recorded(&run, &Lines(name), frame).map(|vectors| vectors.inputs).unwrap_or_default();
            let classified = lines("classify");
            let mut gradients = vec![[0; 3]; classified.len()];
            if let Some(registers) = &setup.gradient {
                let name = gradient_unit(registers.method);
                let gradient = |line: &Vec<i128>| {
                    let mut fields = Reader::new(line);
                    let s = [(); 3].map(|()| [(); 3].map(|()| fields.signed_words()));
                    let [here, behind, before] = [(); 3].map(|()| fields.words());
                    let mirrored = [(); 2].map(|()| fields.flag());
                    let (factors, nearness) = (Some(fields.words()), Some(fields.word()));
                    let local = Local { mirrored, here, behind, before, factors, nearness };
                    local_gradient(&s, registers, &local, words).value
                };
                gradients = lines(name).iter().map(gradient).collect();
            }
            prop_assert_eq!(gradients.len(), classified.len());
            let mut normals = vec![([0; 3], 0); classified.len()];
            if let Some(table) = &setup.normaliser {
                let inputs: Vec<[i32; 3]> = lines("normalise").iter().map(|line| Reader::new(line).signed_words()).collect();
                prop_assert_eq!(&inputs, &gradients);
                normals = inputs.iter().map(|g| normalise(*g, table, words)).map(|n| (n.direction, n.magnitude)).collect();
            }
            // Of the visible ones: opacity, colour, and which sample it was.
            let mut opaque = Vec::new();
            for (i, line) in classified.iter().enumerate() {
                prop_assert_eq!(line[1], i128::from(normals[i].1));
                let of = classify_in(line[2] as u32, line[0] as i32, line[1] as u32, &setup.classification);
                opaque.extend(of.filter(|(opacity, _)| *opacity > 0).map(|(opacity, colour)| (i, opacity, colour)));
            }
            let mut coloured: Vec<[u32; 3]> = opaque.iter().map(|(_, _, colour)| *colour).collect();
            if let Some(shading) = &setup.shading {
                let lit_lines = lines("lit");
                let light: Vec<Vec<i128>> = match shading {
                    Shading::Phong(phong) => {
                        let lines = lines("phong");
                        let normals: Vec<Vec<i128>> = opaque.iter().map(|o| normals[o.0].0.map(i128::from).to_vec()).collect();
                        prop_assert_eq!(lines.iter().map(|line| line[..3].to_vec()).collect::<Vec<_>>(), normals);
                        lines.iter().map(|line| light_of(line, phong, words)).collect()
                    }
                    Shading::Table(table) => {
                        let light = |line: &Vec<i128>| {
                            let index = direction_index(Reader::new(line).signed_words(), table.bits);
                            let [diffuse, specular] = match index {
                                Some(index) => [table.diffuse[index], table.specular[index]],
                                None => [[line[3] as u32; 3], [0; 3]],
                            };
                            diffuse.into_iter().chain(specular).map(i128::from).collect()
                        };
                        lines("reflectance").iter().map(light).collect()
                    }
                };
                prop_assert_eq!(lit_lines.iter().map(|line| line[3..].to_vec()).collect::<Vec<_>>(), light);
                let before: Vec<[u32; 3]> = lit_lines.iter().map(|line| Reader::new(line).words()).collect();
                prop_assert_eq!(&before, &coloured);
                let lit_of = |line: &Vec<i128>| {
                    let mut fields = Reader::new(line);
                    let (colour, diffuse, specular) = (fields.words(), fields.words(), fields.words());
                    lit(colour, cube3_abc::golden::ReflectedLight { diffuse, specular }, words).value
                };
                coloured = lit_lines.iter().map(lit_of).collect();
            }
            if setup.depth_cue.is_some() {
                let lines = lines("cue");
                let before: Vec<[u32; 3]> = lines.iter().map(|line| Reader::new(line).words()).collect();
                prop_assert_eq!(&before, &coloured);
                prop_assert!(lines.iter().all(|line| (0..=1 << LinearFactor::WORD_BITS).contains(&line[3])));
                let cued = |line: &Vec<i128>| cube3_abc::golden::cued(Reader::new(line).words(), line[3] as u32, words);
                coloured = lines.iter().map(cued).collect();
            }
            let mut expected = Vec::new();
            for (_, shaded) in &tokens.shaded {
                for k in 0..setup.geometry.size[2] {
                    let shaded = shaded.at(k);
                    if shaded.present && shaded.opacity > 0 {
                        expected.push((shaded.opacity, shaded.colour));
                    }
                }
            }
            let got: Vec<(u32, [u32; 3])> = opaque.iter().zip(coloured).map(|(o, colour)| (o.1, colour)).collect();
            prop_assert_eq!(got, expected);
        }
    }

    #[test]
    fn every_channel_is_pushed_and_popped_as_its_vectors_say(case in case()) {
        let setups = frames(&case);
        let (machine, _, volume) = &case;
        prop_assume!(!setups.is_empty());
        let run = Run { machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
        let mut timing = Machine::timing(machine, setups.clone()).unwrap();
        timing.run(&|_, _| {}).unwrap();
        let unit = of_name("channel");
        for reading in timing.counters().channels {
            let vectors = record(&run, unit.as_ref(), &Excerpt { channel: reading.name, ..ALL }).unwrap();
            prop_assert_eq!(vectors.inputs.len() as u64, timing.now());
            let mut popped = 0;
            let (mut held, mut sum) = (0, 0);
            for (inputs, outputs) in vectors.inputs.iter().zip(&vectors.outputs) {
                prop_assert!(inputs[0] <= outputs[0] && inputs[2] <= outputs[1], "{}: {:?} {:?}", reading.name, inputs, outputs);
                prop_assert_eq!(outputs[3], held);
                if inputs[2] == 1 {
                    prop_assert_eq!(outputs[2], popped & 0xffff);
                    popped += 1;
                }
                held += inputs[0] - inputs[2];
                sum += held;
            }
            prop_assert_eq!(sum as u64, reading.counters.occupancy_cycles);
            prop_assert_eq!(popped as u64, reading.counters.pops);
            // A later window begins with an empty channel, and goes on alike.
            let first = vectors.inputs.len() / 2;
            if let Ok(later) = record(&run, unit.as_ref(), &Excerpt { channel: reading.name, first, ..ALL }) {
                let from = vectors.inputs.len() - later.inputs.len();
                prop_assert!(from >= first && vectors.outputs[from][3] == 0);
                prop_assert_eq!(&later.inputs[..], &vectors.inputs[from..]);
                prop_assert_eq!(&later.outputs[..], &vectors.outputs[from..]);
            }
        }
    }

    #[test]
    fn voxels_have_places_of_their_own_and_come_to_their_slots(case in case()) {
        let setups = frames(&case);
        let (machine, _, volume) = &case;
        prop_assume!(!setups.is_empty());
        let run = Run { machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
        for (frame, setup) in setups.iter().enumerate() {
            let geometry = &setup.geometry;
            let mut places = HashMap::new();
            let addresses = recorded(&run, of_name("cfb").as_ref(), frame);
            for (xyz, place) in addresses.iter().flat_map(|vectors| vectors.inputs.iter().zip(&vectors.outputs)) {
                prop_assert_eq!(places.entry(place.clone()).or_insert(xyz.clone()), xyz);
            }
            if let Some(turned) = recorded(&run, of_name("bus").as_ref(), frame) {
                let word = |plane: usize, slot: usize, k: usize| {
                    let ray = geometry.ray_in_slot(plane, slot, k);
                    let uvw = [geometry.column_at(ray.u, k)?, geometry.row_at(ray.v, k)?, k];
                    let [x, y, z] = geometry.axes.voxel(geometry.size, uvw);
                    volume.words.get(x + volume.dims[0] * (y + volume.dims[1] * z)).copied()
                };
                let whole = Schedule::of(geometry, machine.lanes, None);
                for ((BeamPlace { plane, depth: k, .. }, _), line) in cube3_cfb::scan(geometry, &whole).zip(&turned.outputs) {
                    for slot in 0..machine.lanes {
                        let lane = (slot + k as usize) % machine.lanes;
                        prop_assert_eq!(Some(line[1 + lane] as u16), word(plane as usize, slot, k as usize));
                    }
                }
            }
        }
    }

    #[test]
    fn every_unit_holds_the_traffic_of_a_run_and_windows_are_parts_of_it(case in case(), first in 0_usize..40, count in 0_usize..40) {
        let setups = frames(&case);
        let (machine, _, volume) = &case;
        prop_assume!(!setups.is_empty());
        let run = Run { machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
        for unit in units() {
            let (unit, frame) = (unit.as_ref(), setups.len() - 1);
            let Some(all) = recorded(&run, unit, frame).filter(|vectors| !vectors.set.sheet.clocked) else { continue };
            let end = (first + count).min(all.inputs.len());
            match record(&run, unit, &Excerpt { frame, first, count, ..ALL }) {
                Ok(part) => prop_assert_eq!(&part.inputs[..], &all.inputs[first.min(end)..end]),
                Err(RecordError::Beyond { found, .. }) => {
                    prop_assert!(found == all.inputs.len() && found <= first);
                }
                Err(error) => panic!("{}: {error}", all.set.sheet.name),
            }
        }
    }
}

/// Diffuse and specular light of a line of the unit `phong`.
fn light_of(line: &[i128], phong: &Phong, words: &cube3_word::Words) -> Vec<i128> {
    let mut fields = Reader::new(line);
    let (normal, ambient, two_sided) = (fields.signed_words(), fields.word(), fields.flag());
    let lights = (line.len() - 5) / 12;
    let directions: Vec<[i32; 3]> = (0..lights).map(|_| fields.signed_words()).collect();
    let halfways: Vec<[i32; 3]> = (0..lights).map(|_| fields.signed_words()).collect();
    let diffuse: Vec<[u32; 3]> = (0..lights).map(|_| fields.words()).collect();
    let specular: Vec<[u32; 3]> = (0..lights).map(|_| fields.words()).collect();
    let light = |i: usize| PhongLight {
        direction: directions[i],
        halfway: halfways[i],
        diffuse: diffuse[i],
        specular: specular[i],
    };
    let registers = Phong { ambient, two_sided, lights: (0..lights).map(light).collect(), ..phong.clone() };
    let light = phong_from(normal, &registers, |i| [directions[i], halfways[i]], words);
    light.diffuse.into_iter().chain(light.specular).map(i128::from).collect()
}

#[test]
fn what_cannot_be_recorded_is_told() {
    let machine = MachineSpec { lanes: 4, ..MachineSpec::default() };
    let volume = SmallVolume { dims: [4; 3], spacing: [1.0; 3], words: vec![0; 64] };
    let setups = picture_setup(&Scene::default(), &machine, &volume.info(), true).unwrap().setups;
    let run = Run { machine: &machine, frames: &setups, dims: volume.dims, voxels: &volume.words };
    let told = |unit: &str, window: Excerpt<'_>| record(&run, of_name(unit).as_ref(), &window).unwrap_err().to_string();
    let frame = told("trilin", Excerpt { frame: 9, ..ALL });
    assert!(frame.contains("frame 9 was asked for"), "{frame}");
    let channel = told("channel", Excerpt { channel: "rings", ..ALL });
    assert!(channel.contains("no channel \"rings\"; its channels are beams, aligned, rays"), "{channel}");
    let beyond = told("leaf", Excerpt { first: 64, ..ALL });
    assert!(beyond.contains("leaf has 64 transactions in this frame, and the window starts at 64"), "{beyond}");
    let late = told("channel", Excerpt { first: 1 << 20, ..ALL });
    assert!(late.contains("the window starts at 1048576"), "{late}");
    let cue = record(&run, &Lines("cue"), &ALL).unwrap_err().to_string();
    assert!(cue.contains("carries nothing in this frame: it has no depth cue"), "{cue}");
}
