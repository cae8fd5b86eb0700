//! Random machines, scenes and volumes for the tests that cross crates, and the tools that the hardware's tests run.

pub mod files;
pub mod golden_breaks;
pub mod house;
pub mod known_answers;
pub mod rtl;
pub mod rtl_vectors;
pub mod thorough;

pub mod rtl_pipeline;
pub mod waves;

use cube3_host::VolumeInfo;

use cube3_machine::{
    Abc, Boards, Bus, BusKind, Cfb, ChannelSize, Channels, Cone, ConeKind, ControllerKind, Dsb, GradientMethod,
    HostLink, Layout, LookAheadFreed, LookAheadUnit, MachineSpec, MemoryModel, RayEnds, RaySlots, Rays, Reuse,
    ShadingUnit, TemplateRule, Trilin,
};
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, Image, Layer, Light, Material, Mode, Perspective, Scene, Threshold, Transfer,
    View, VolumeSource,
};
use cube3_word::{Rounding, Words};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// A small volume of voxel words.
#[derive(Clone, Debug)]
pub struct SmallVolume {
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Size of a voxel.
    pub spacing: [f64; 3],
    /// Words, x fastest.
    pub words: Vec<u16>,
}

impl SmallVolume {
    /// What the host needs to know; data values are 0 to 255.
    pub fn info(&self) -> VolumeInfo {
        VolumeInfo { dims: self.dims, spacing: self.spacing, window: [0.0, 255.0] }
    }
}

/// Volumes of 1 to `most` voxels a side, of words below `2^bits`, cubes of unit voxels or not.
pub fn volumes(most: usize, bits: u32) -> impl Strategy<Value = SmallVolume> {
    let dims = prop_oneof![(1..=most).prop_map(|n| [n; 3]), [1..=most, 1..=most, 1..=most]];
    let sides = [0.5..2.0_f64, 0.5..2.0_f64, 0.5..2.0_f64];
    let extreme =
        proptest::sample::select(vec![[1.0, 1.0, 1000.0], [1000.0, 1.0, 1.0], [1.0, 1e-3, 1.0], [1e6, 1.0, 30.0]]);
    let spacing = prop_oneof![6 => Just([1.0; 3]), 2 => sides, 1 => extreme];
    (dims, spacing, any::<u64>()).prop_map(move |(dims, spacing, seed)| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let words =
            (0..dims.iter().product::<usize>()).map(|_| (random.next_u32() & ((1 << bits) - 1)) as u16).collect();
        SmallVolume { dims, spacing, words }
    })
}

/// Legal word lengths of every kind.
pub fn words() -> impl Strategy<Value = Words> {
    let first = (1_u32..=16, 0_u32..=12, 0_u32..=8, 0.0..=1.0_f64, 4_u32..=15, 0.0..=1.0_f64);
    let second = (1_u32..=8, 1_u32..=16, 1_u32..=16, 1_u32..=32, any::<bool>());
    let any = (first, second).prop_map(
        |((voxel, weight, fraction, gradient, normal, table), (rows, colour, opacity, accumulator, truncate))| {
            let pick = |part: f64, low: u32, high: u32| low + (part * f64::from(high - low)) as u32;
            let table_bits = pick(table, 1, (voxel + fraction).min(16));
            Words {
                voxel_bits: voxel,
                weight_bits: weight,
                sample_fraction_bits: fraction,
                gradient_bits: pick(gradient, 2, (voxel + fraction + 1).min(24)),
                normal_bits: normal,
                table_bits,
                // An eye has up to 16 such tables in each pass, and a test may make those of a hundred passes.
                table_gradient_bits: rows.min(17 - table_bits),
                colour_bits: colour,
                opacity_bits: opacity,
                accumulator_bits: accumulator,
                rounding: if truncate { Rounding::Truncate } else { Rounding::Nearest },
            }
        },
    );
    prop_oneof![1 => Just(Words::default()), 3 => any]
}

/// Buses, boards, cones, host links, ports and planes: the default half of the time, each, and anything that can run. Boards are a
/// part of the lanes.
fn fabrics() -> impl Strategy<Value = Fabric> {
    let rate = || proptest::option::of(prop_oneof![0.05..3.0_f64, 3.0..200.0_f64]);
    let bus = (any::<bool>(), proptest::option::of(1_usize..12), proptest::option::of(1e6..40e6_f64)).prop_map(
        |(rotate, channels, clock_hz)| Bus {
            kind: if rotate { BusKind::Rotate } else { BusKind::Gather },
            channels,
            clock_hz,
        },
    );
    let boards = (prop_oneof![Just(0.0), 0.0..1.0_f64], rate(), prop_oneof![Just(1024), 1_usize..40], 1_u64..4);
    let cone = proptest::sample::select(ConeKind::ALL.to_vec()).prop_map(|kind| Cone { kind });
    let host = rate().prop_map(|bytes_per_cycle| HostLink { bytes_per_cycle });
    let bus = prop_oneof![Just(Bus::default()), bus];
    let cone = prop_oneof![Just(Cone::default()), cone];
    (bus, boards, cone, host, 1_usize..=2, 3_usize..7).prop_map(
        |(bus, (boards, link_rate, link_capacity, link_latency), cone, host_link, ports, planes)| Fabric {
            bus,
            boards,
            link_rate,
            link_capacity,
            link_latency,
            cone,
            host_link,
            ports,
            planes,
        },
    )
}

/// What [`fabrics`] gives.
#[derive(Clone, Copy, Debug)]
struct Fabric {
    bus: Bus,
    /// Boards as a part of the lanes, 0 for one board.
    boards: f64,
    link_rate: Option<f64>,
    link_capacity: usize,
    link_latency: u64,
    cone: Cone,
    host_link: HostLink,
    ports: usize,
    /// Planes of samples.
    planes: usize,
}

/// Memory clock, type and layout of a frame buffer beside a pipeline of 50 MHz; the ideal one as often as all others.
fn memories() -> impl Strategy<Value = (Option<f64>, Cfb)> {
    let kinds = proptest::sample::select(MemoryModel::TABLE.map(|model| model.kind).to_vec());
    let asking =
        (proptest::option::of(1_usize..12), any::<[bool; 2]>(), prop_oneof![4 => Just(false), 1 => Just(true)]);
    let layouts = proptest::sample::select(Layout::ALL.to_vec());
    let slow = (kinds, proptest::option::of(0.4..2.0_f64), layouts, asking).prop_map(
        |(memory, speed, layout, (look_ahead, [bursts, column], chooses))| {
            let clock = MemoryModel::of(memory).clock_hz.unwrap_or(50e6);
            let look_ahead_unit = if bursts { LookAheadUnit::Bursts } else { LookAheadUnit::Words };
            let look_ahead_freed = if column { LookAheadFreed::Column } else { LookAheadFreed::Word };
            let chooses = chooses && layout != Layout::MiniBlocks;
            let controller = if chooses { ControllerKind::FrFcfs } else { ControllerKind::InOrder };
            let cfb =
                Cfb { memory, layout, look_ahead, look_ahead_unit, look_ahead_freed, controller, ..Cfb::default() };
            (speed.map(|speed| speed * clock), cfb)
        },
    );
    prop_oneof![Just((None, Cfb::default())), slow]
}

/// Machines of every kind that can run, with 1 to 9 lanes.
pub fn machines() -> impl Strategy<Value = MachineSpec> {
    let methods = proptest::sample::select(GradientMethod::ALL.map(|(method, _)| method).to_vec());
    let size = (1_usize..6, 1_u64..5).prop_map(|(capacity, latency)| ChannelSize { capacity, latency });
    let channels = [size.clone(), size.clone(), size.clone(), size.clone(), size.clone(), size];
    // Sections of ray slots, half of the time.
    let ends = (any::<bool>(), 1_u32..6, proptest::option::weighted(0.5, 1_usize..9));
    let rays = (any::<bool>(), any::<bool>(), 0.0..1.0_f64, prop_oneof![Just(0.5), 0.1..2.0_f64], ends);
    let rest = (
        1_usize..=9,
        [-3_i64..4, -3_i64..4, -3_i64..4],
        2_usize..5,
        proptest::sample::select(Reuse::ALL.to_vec()),
        any::<bool>(),
    );
    (words(), methods, channels, rays, rest, (memories(), fabrics())).prop_map(
        |(
            words,
            gradient,
            channels,
            (padded, plane, offset, grid, (exact, reach, section)),
            (lanes, skew, planes, reuse, table),
            ((memory_clock_hz, cfb), fabric),
        )| {
            let [beams, aligned, rays, samples, shaded, pixels] = channels;
            // With tables for the ends of rays there are nine times as many as for an eye.
            let words = if exact {
                let table_bits = words.table_bits.min(10);
                Words { table_bits, table_gradient_bits: words.table_gradient_bits.min(12 - table_bits), ..words }
            } else {
                words
            };
            let skew = if cfb.layout.takes(skew, lanes) { skew } else { [1, skew[1], skew[2]] };
            MachineSpec {
                lanes,
                words,
                rays: Rays {
                    slots: if padded { RaySlots::Padded } else { RaySlots::Wrapped },
                    template: if plane { TemplateRule::PlaneFloor } else { TemplateRule::SampleFloor },
                    offset,
                    grid,
                    ends: if exact { RayEnds::Exact } else { RayEnds::Published },
                    section,
                },
                clock_hz: 50e6,
                cfb: Cfb { skew, memory_clock_hz, ..cfb },
                bus: fabric.bus,
                boards: Boards {
                    count: 1 + (fabric.boards * lanes as f64) as usize,
                    link_words_per_cycle: fabric.link_rate,
                    link_capacity_words: fabric.link_capacity,
                    link_latency_cycles: fabric.link_latency,
                },
                dsb: Dsb { planes, ports: fabric.ports },
                trilin: Trilin { reuse },
                abc: Abc {
                    gradient,
                    shading: if table { ShadingUnit::ReflectanceTable } else { ShadingUnit::Phong },
                    power_bits: 10.min(words.normal_bits - 1),
                    root_bits: 6,
                    reflectance_bits: 3,
                    planes: fabric.planes,
                    reach,
                },
                cone: fabric.cone,
                host_link: fabric.host_link,
                channel: Channels { beams, aligned, rays, samples, shaded, pixels },
                ..MachineSpec::default()
            }
        },
    )
}

/// View directions: along axes, at 45°, and anywhere.
pub fn directions() -> impl Strategy<Value = [f64; 3]> {
    let few = proptest::sample::select(vec![-1.0, 0.0, 1.0]);
    let special = [few.clone(), few.clone(), few].prop_filter("a direction", |d| d.iter().any(|x| *x != 0.0));
    let any = [-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64]
        .prop_filter("a direction", |d| d.iter().map(|x| x * x).sum::<f64>() > 1e-3);
    prop_oneof![1 => special, 3 => any]
}

/// Scenes with every mode and feature.
pub fn scenes() -> impl Strategy<Value = Scene> {
    let mode = proptest::sample::select(Mode::ALL.to_vec());
    let vector = [-1.0..1.0_f64, -1.0..1.0_f64, 0.1..1.0_f64];
    let colour = [0.0..=1.0_f64, 0.0..=1.0_f64, 0.0..=1.0_f64];
    let light = (proptest::option::of(vector.clone()), colour.clone())
        .prop_map(|(direction, colour)| Light { direction, colour });
    let ramp = |seed: [f64; 4]| vec![[255.0 * seed[0] * 0.5, 0.0], [255.0 * (0.5 + seed[1] * 0.5), seed[2]]];
    let unit = || 0.0..=1.0_f64;
    let transfer = ([unit(), unit(), unit(), unit()], any::<bool>(), any::<bool>(), colour.clone(), 0.01..=1.0_f64)
        .prop_map(move |(seed, two, correct, colour, opaque)| {
            let mut transfer = Transfer {
                opacity: ramp(seed),
                colour: vec![
                    ColourPoint { value: 0.0, rgb: colour },
                    ColourPoint { value: 255.0, rgb: [1.0, colour[0], 0.5] },
                ],
                layers: Vec::new(),
                opacity_correction: correct,
                opaque_alpha: opaque,
            };
            if two {
                let opacity = std::mem::take(&mut transfer.opacity);
                transfer.layers = vec![
                    Layer { gradient: 0.0, opacity: vec![[0.0, 0.0], [255.0, seed[3]]] },
                    Layer { gradient: 200.0 * seed[3] + 1.0, opacity },
                ];
            }
            transfer
        });
    let material = (any::<bool>(), unit(), unit(), unit(), 1.0..40.0_f64, any::<bool>()).prop_map(
        |(shaded, ambient, diffuse, specular, shininess, two_sided)| Material {
            shaded,
            ambient,
            diffuse,
            specular,
            shininess,
            two_sided,
        },
    );
    let near = || 0.0..6.0_f64;
    let far = proptest::sample::select(vec![-1e300, -3e9, -1e9, 1e9, 1e10, 1e30]);
    let through = prop_oneof![6 => [near(), near(), near()], 1 => [near().boxed(), far.boxed(), near().boxed()]];
    let cut = (vector, through).prop_map(|(normal, through_voxel)| Cut { normal, through_voxel });
    let crop = [(0.0..3.0_f64, 3.0..7.0_f64), (0.0..3.0_f64, 3.0..7.0_f64), (0.0..3.0_f64, 3.0..7.0_f64)]
        .prop_map(|sides| Crop { min_voxel: sides.map(|s| s.0), max_voxel: sides.map(|s| s.1) });
    let cue = (unit(), unit()).prop_map(|(front, back)| DepthCue { front, back });
    let threshold = (proptest::option::of(0.0..120.0_f64), proptest::option::of(130.0..255.0_f64))
        .prop_map(|(low, high)| Threshold { low, high });
    let cuts = proptest::collection::vec(cut, 0..3);
    let rest = (
        cuts,
        proptest::option::weighted(0.3, crop),
        proptest::option::weighted(0.3, cue),
        proptest::option::weighted(0.3, threshold),
        proptest::bool::weighted(0.2),
    );
    (mode, directions(), transfer, material, proptest::collection::vec(light, 0..3), rest).prop_map(
        |(mode, direction, transfer, material, lights, (cuts, crop, depth_cue, threshold, labels))| Scene {
            mode,
            volume: VolumeSource { labels, ..VolumeSource::default() },
            view: View { direction: Some(direction), ..View::default() },
            transfer,
            material,
            lights,
            cuts,
            crop,
            depth_cue,
            threshold,
            ..Scene::default()
        },
    )
}

/// Perspective views: eyes in front, beside, on a face, on a voxel, inside and far away, looking anywhere.
pub fn perspectives() -> impl Strategy<Value = Perspective> {
    let near = || -9.0..15.0_f64;
    let inside = || 0.0..6.0_f64;
    let voxel = || (0_u8..6).prop_map(f64::from);
    let eye = prop_oneof![
        2 => [near(), near(), near()],
        1 => [inside(), inside(), inside()],
        1 => [voxel(), voxel(), voxel()],
        1 => [near().boxed(), Just(0.0).boxed(), near().boxed()],
        1 => [-1e3..1e3_f64, -1e3..1e3_f64, -1e3..1e3_f64],
        1 => [near().boxed(), (-1e12..1e12_f64).boxed(), near().boxed()],
    ];
    let field = prop_oneof![1 => Just(0.01), 4 => 10.0..90.0_f64, 1 => Just(150.0)];
    let place = prop_oneof![
        6 => eye.prop_map(|eye| (Some(eye), None)),
        2 => (0.0..40.0_f64).prop_map(|distance| (None, Some(distance))),
        1 => Just((None, None)),
    ];
    (field, place).prop_map(|(field_of_view_deg, (eye_voxel, distance_voxel))| Perspective {
        field_of_view_deg,
        eye_voxel,
        distance_voxel,
    })
}

/// A scene as an eye sees it, in a picture of a few pixels. An eye that looks past the volume, by more than 30 degrees from its
/// middle, turns to a place in it or just beside it.
pub fn from_eye(scene: &Scene, perspective: Perspective) -> Scene {
    let direction = scene.view.direction.map(|direction| {
        let Some(eye) = perspective.eye_voxel else { return direction };
        let to = |place: [f64; 3]| [0, 1, 2].map(|i| place[i] - eye[i]);
        let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
        let middle = to([3.0; 3]);
        let past = dot(middle, direction) < 0.866 * (dot(middle, middle) * dot(direction, direction)).sqrt();
        let turned = to(direction.map(|x| 3.0 + 3.5 * x));
        if past && dot(turned, turned) > 1e-3 { turned } else { direction }
    });
    let view = View { direction, perspective: Some(perspective), ..scene.view.clone() };
    let image = Image { width_px: 13, height_px: 9, ..scene.image.clone() };
    Scene { view, image, ..scene.clone() }
}

/// The machine with a gradient and a shading unit that it has in perspective, a bus for eyes, and planes taken whole.
pub fn for_perspective(machine: &MachineSpec) -> MachineSpec {
    let gradient = match machine.abc.gradient {
        GradientMethod::Ten => GradientMethod::Twelve,
        GradientMethod::TenNormalised => GradientMethod::SixSheared,
        method => method,
    };
    let abc = Abc { gradient, shading: ShadingUnit::Phong, ..machine.abc };
    let bus = Bus { kind: BusKind::Gather, ..machine.bus };
    let rays = Rays { section: None, ..machine.rays };
    MachineSpec { abc, bus, rays, ..machine.clone() }
}
