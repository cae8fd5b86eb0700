//! What a machine is made of, counted from its configuration: a row for each part.

use crate::Overlap;
use cube3_cfb::memory::{edge_words, reorder_words};
use cube3_cone::ConeSpec;
use cube3_frame::{ConeRegisters, FrameSetup, GradientScale, HalfSpace, LinearFactor, Schedule, Shading};
use cube3_machine::operators::{self, UNIT_MUL};
use cube3_machine::{
    ControllerKind, GradientMethod, Layout, MachineSpec, MemoryModel, OperatorCounts, RayEnds, RaySlots, Reuse,
    ShadingUnit,
};
use cube3_pipeline::RunCounters;
use cube3_report::{InterfaceReport, LinesReport, MemoryBits, OperatorsReport, ResourcesReport};
use cube3_scene::MOST_LIGHTS;
use std::borrow::Borrow;

/// Counts a machine's resources for a volume of `dims` voxels, and what flowed through its interfaces in a run of `frames`. `interval`
/// is the cycles from a frame to the next.
pub fn resources(
    machine: &MachineSpec,
    dims: [usize; 3],
    frames: &[impl Borrow<FrameSetup>],
    counters: &RunCounters,
    interval: u64,
) -> ResourcesReport {
    let frames: &[&FrameSetup] = &frames.iter().map(Borrow::borrow).collect::<Vec<_>>();
    let operators = operators(machine, frames);
    let total: OperatorCounts = operators.iter().map(|part| part.each.times(part.count)).sum();
    let interfaces = interfaces(machine, frames, counters);
    let fps = machine.clock_hz / interval.max(1) as f64;
    let samples: u64 = frames.iter().map(|setup| setup.geometry.sample_count()).sum();
    let memory_gb = interfaces.first().and_then(|memory| memory.peak_bytes_per_s).unwrap_or(0.0) / 1e9;
    ResourcesReport {
        memory: memory(machine, dims, frames),
        lines: lines(machine),
        fps_per_memory_gb_per_s: if memory_gb > 0.0 { fps / memory_gb } else { 0.0 },
        samples_per_s_per_multiplier: samples as f64 * fps / total.multipliers.max(1) as f64,
        operators,
        total,
        interfaces,
    }
}

/// Operators of each part of a machine that renders `frames`, which hold how many lights there are and which bits of the scaled gradients
/// are kept; without any, one light and none.
pub fn operators(machine: &MachineSpec, frames: &[impl Borrow<FrameSetup>]) -> Vec<OperatorsReport> {
    let frames: &[&FrameSetup] = &frames.iter().map(Borrow::borrow).collect::<Vec<_>>();
    let words = &machine.words;
    let lanes = machine.lanes as u64;
    let mut parts = Vec::new();
    let mut part = |part: &str, count: u64, each: OperatorCounts| {
        if each != OperatorCounts::default() && count > 0 {
            parts.push(OperatorsReport { part: part.into(), count, each });
        }
    };
    part("trilin", lanes, operators::lerp(words).times(u64::from(machine.trilin.reuse.lerps())));
    part("abc: gradient", lanes, operators::gradient(machine.abc.gradient, words));
    let of_frame = frames.iter().filter_map(|setup| setup.gradient.as_ref());
    let near = of_frame.clone().map(|registers| registers.method).find(|&method| method != machine.abc.gradient);
    if let Some(near) = near {
        part("abc: gradient for near eyes", lanes, operators::gradient(near, words));
    }
    if machine.abc.gradient.row().normalised {
        let kept = of_frame.filter_map(|registers| registers.scale).map(|scale| scale.kept_bits).min().unwrap_or(0);
        part("abc: gradient scale", lanes, operators::gradient_scale(words, GradientScale::FACTOR_BITS - kept));
    }
    // The one shift also takes back by how much the weights of 26 exceed 1.
    let weights = |method: GradientMethod| method.row().extra_bits();
    let exceed = weights(machine.abc.gradient).max(near.map_or(0, weights));
    part("abc: gradient word", lanes, operators::gradient_word(words, exceed));
    part("abc: normaliser", lanes, operators::NORMALISER);
    part("abc: magnitude", lanes, operators::MAGNITUDE);
    match machine.abc.shading {
        ShadingUnit::Phong => part("abc: a light", lanes * lights(frames), operators::light(machine)),
        ShadingUnit::ReflectanceTable => part("abc: direction", lanes, operators::DIRECTION),
    }
    part("abc: lit colour", lanes, operators::lit_colour(words));
    part("abc: threshold and row", lanes, operators::THRESHOLD + operators::ROW);
    part("abc: depth cue", lanes, operators::depth_cue(words, LinearFactor::WORD_BITS));
    let clips = HalfSpace::MOST as u64;
    part("abc: cut planes and crop box", lanes, operators::half_spaces(clips));
    if machine.rays.ends == RayEnds::Exact {
        // For each half-space the distance after a step, two comparisons and a restoring divider; the smallest of all; and once the sum of
        // two reaches, its product with the step, rounded. Of a slot up to three rays have two ends each.
        let half_spaces = clips + 6;
        let reach = OperatorCounts { multipliers: 0, adders: 2, comparators: 3, dividers: 1 };
        let rays = if machine.rays.slots == RaySlots::Wrapped { 3 } else { 1 };
        part("abc: ends of rays", 2 * rays, reach.times(half_spaces) + OperatorCounts::new(1, 2, 0));
        // The faces beside the clips, and whether the samples before and behind are in their place.
        part("abc: faces of the volume", lanes, OperatorCounts::new(0, 6, 0));
    }
    part("cone: leaf", lanes, UNIT_MUL.times(3) + OperatorCounts::new(0, 0, 1));
    part(
        "cone: node",
        ConeSpec::of(machine, machine.lanes).nodes() as u64,
        OperatorCounts::new(0, 1, 1) + (UNIT_MUL + OperatorCounts::new(0, 1, 0)).times(4),
    );
    part(
        "cone: weight of a sum",
        1,
        OperatorCounts::new(4, 4 * operators::rounds(words, ConeRegisters::WEIGHT_BITS), 4),
    );
    parts
}

/// Lights that the shading units hold: those of the frames, or one.
fn lights(frames: &[&FrameSetup]) -> u64 {
    let of = |setup: &FrameSetup| match &setup.shading {
        Some(Shading::Phong(phong)) => phong.lights.len(),
        _ => 0,
    };
    frames.iter().copied().map(of).max().unwrap_or(0).clamp(1, MOST_LIGHTS) as u64
}

/// What [`memory`] calls the frame buffer.
pub const FRAME_BUFFER: &str = "frame buffer";

/// Bits of memory, by what they hold.
pub fn memory(machine: &MachineSpec, dims: [usize; 3], frames: &[impl Borrow<FrameSetup>]) -> Vec<MemoryBits> {
    let frames: &[&FrameSetup] = &frames.iter().map(Borrow::borrow).collect::<Vec<_>>();
    let words = &machine.words;
    let voxels: u64 = dims.iter().map(|&n| n as u64).product();
    let mut memory = Vec::new();
    let mut kind = |what: &str, counted: String, bits: u64| {
        if bits > 0 {
            memory.push(MemoryBits { what: what.into(), counted, bits });
        }
    };
    let buffers = match machine.acquisition.mode {
        cube3_machine::AcquisitionMode::DoubleBuffer => 2,
        _ => 1,
    };
    let voxel_bits = u64::from(words.voxel_bits);
    kind(FRAME_BUFFER, format!("{buffers} × {voxels} voxels of {voxel_bits} bits"), buffers * voxels * voxel_bits);
    if machine.cfb.layout == Layout::MiniBlocks
        && let Ok(held) = reorder_words(machine, frames)
    {
        kind("reorder buffer", format!("{held} voxels of {voxel_bits} bits"), held * voxel_bits);
    }
    if machine.cfb.controller == ControllerKind::FrFcfs {
        let (lanes, held) = (machine.lanes as u64, MemoryModel::words_held(&machine.cfb) as u64);
        let counted = format!("{lanes} modules × {held} words of {voxel_bits} bits");
        kind("reorder buffers of the modules", counted, lanes * held * voxel_bits);
    }
    // The largest frame sets the size of each buffer; registers and first planes are there twice where frames overlap, and first planes
    // where a frame has sections, which overlap likewise.
    let twice = if machine.frames.overlap { 2 } else { 1 };
    let schedule = |setup: &FrameSetup| Schedule::new(machine, &setup.geometry);
    let most = |of: &dyn Fn(&FrameSetup) -> u64| frames.iter().copied().map(of).max().unwrap_or(0);
    let overlap = machine.frames.overlap;
    let planes = most(&|setup| {
        let schedule = schedule(setup);
        let firsts = if schedule.shape().closes[1] { schedule.first_voxels(overlap) } else { 0 };
        schedule.voxel_planes(machine.dsb.planes) + firsts
    });
    kind("skewed buffers", format!("{planes} voxels of {voxel_bits} bits"), planes * voxel_bits);
    let sample_bits = u64::from(words.sample_bits());
    let kept_rays = match machine.trilin.reuse {
        Reuse::Ray | Reuse::Both => 2,
        Reuse::None | Reuse::Plane => 0,
    };
    let kept_planes = u64::from(matches!(machine.trilin.reuse, Reuse::Plane | Reuse::Both));
    let kept = most(&|setup| {
        let schedule = schedule(setup);
        let first = 2 * u64::from(schedule.shape().closes[0]);
        (kept_rays + first + kept_planes * schedule.sample_slots()) * schedule.shape().depths as u64
    });
    kind("lerps kept", format!("{kept} samples of {sample_bits} bits"), kept * sample_bits);
    let shaded = most(&|setup| {
        if setup.gradient.is_none() {
            return 0;
        }
        let schedule = schedule(setup);
        let firsts = if schedule.shape().closes[1] { schedule.first_samples(overlap) } else { 0 };
        schedule.sample_planes(setup.ring(machine.abc.planes)) + firsts
    });
    kind("sample planes", format!("{shaded} samples of {sample_bits} bits"), shaded * sample_bits);
    if machine.cfb.layout == Layout::MiniBlocks {
        let edges = most(&|setup| edge_words(&setup.geometry, &schedule(setup)));
        kind(
            "overlap buffers of voxels",
            format!("beside the chip, {edges} voxels of {voxel_bits} bits"),
            edges * voxel_bits,
        );
    }
    let ray_bits = u64::from(ray_bits(machine));
    let rays = most(&|setup| Overlap::new(machine, setup).rays);
    kind("overlap buffers of rays", format!("beside the chip, {rays} words of {ray_bits} bits"), rays * ray_bits);
    let samples = most(&|setup| Overlap::new(machine, setup).samples);
    kind(
        "overlap buffers of samples",
        format!("beside the chip, {samples} samples of {sample_bits} bits"),
        samples * sample_bits,
    );
    let shifter = ConeSpec::of(machine, machine.lanes).shifter_words();
    let coloured = u64::from(3 * words.colour_bits + words.opacity_bits);
    kind("shifter before the cone", format!("{shifter} samples of {coloured} bits"), shifter * coloured);
    let tables = most(&|setup| table_bits(machine, setup));
    let (boards, capacity) = (machine.boards.count as u64, machine.boards.link_capacity_words as u64);
    let queued = if boards > 1 && machine.boards.link_words_per_cycle.is_some() { 2 * boards * capacity } else { 0 };
    kind("link queues", format!("{queued} words of {voxel_bits} bits"), queued * voxel_bits);
    let lanes = machine.lanes as u64;
    kind("tables", format!("{lanes} lanes × {tables} bits"), lanes * tables);
    let templates = most(&|setup| {
        let geometry = &setup.geometry;
        let depth = geometry.size[2] as u64;
        // A step and a weight; in perspective a column and a weight for each ray.
        let (rays, place) = match &geometry.perspective {
            None => (2, 1),
            Some(pass) => ((pass.u.count() + pass.v.count()) as u64, 16),
        };
        rays * depth * (place + u64::from(words.weight_bits) + 1)
    });
    kind("templates", format!("{twice} × {templates} bits of columns and weights"), twice * templates);
    memory
}

/// Bits of a ray's word in TRILIN's overlap buffer: lerped along w where lerps of the ray before are kept, and else a voxel.
fn ray_bits(machine: &MachineSpec) -> u32 {
    match machine.trilin.reuse {
        Reuse::Ray | Reuse::Both => machine.words.sample_bits(),
        Reuse::None | Reuse::Plane => machine.words.voxel_bits,
    }
}

/// Bits of the tables of one lane.
fn table_bits(machine: &MachineSpec, setup: &FrameSetup) -> u64 {
    let words = &machine.words;
    let table = &setup.classification;
    let opacity = table.opacity.len() as u64 * u64::from(words.opacity_bits);
    let colour = table.colour.len() as u64 * 3 * u64::from(words.colour_bits);
    let root =
        setup.normaliser.as_ref().map_or(0, |table| table.root.len() as u64 * (u64::from(words.normal_bits) + 1));
    let shading = match &setup.shading {
        Some(Shading::Phong(phong)) => phong.power.len() as u64 * (u64::from(words.colour_bits) + 1),
        Some(Shading::Table(table)) => {
            (table.diffuse.len() + table.specular.len()) as u64 * 3 * (u64::from(words.colour_bits) + 4)
        }
        None => 0,
    };
    opacity + colour + root + shading
}

/// Data lines: of the bus, of the links, of the host's port.
fn lines(machine: &MachineSpec) -> Vec<LinesReport> {
    let voxel_bits = u64::from(machine.words.voxel_bits);
    let channels = machine.bus.channels.unwrap_or(machine.lanes) as u64;
    let mut lines = Vec::new();
    let mut kind = |what: &str, counted: String, count: u64| {
        lines.push(LinesReport { what: what.into(), counted, lines: count });
    };
    let bus = channels * voxel_bits;
    kind("bus lines", format!("{channels} channels of {voxel_bits} bits"), bus);
    let boards = machine.boards.count as u64;
    let link = machine.boards.link_words_per_cycle.map_or(machine.lanes as u64, |words| words.ceil() as u64);
    let host = machine.host_link.bytes_per_cycle.map_or_else(|| pixel_bits(machine), |bytes| 8 * bytes.ceil() as u64);
    if boards > 1 {
        let each = 2 * link * voxel_bits;
        kind("link lines", format!("{boards} links, 2 directions × {link} words of {voxel_bits} bits"), boards * each);
        let share = bus.div_ceil(boards);
        kind(
            "pins of a board",
            format!("{share} of the bus, {} of two links, {host} of the host", 2 * each),
            share + 2 * each + host,
        );
    }
    kind("host lines", "in a pipeline cycle".into(), host);
    lines
}

/// Bits of a pixel on its way to the host.
fn pixel_bits(machine: &MachineSpec) -> u64 {
    4 * 8 * u64::from(machine.words.accumulator_bits.div_ceil(8))
}

/// Bytes through each interface; the memory's first.
fn interfaces(machine: &MachineSpec, frames: &[&FrameSetup], counters: &RunCounters) -> Vec<InterfaceReport> {
    let words = &machine.words;
    let lanes = machine.lanes as f64;
    let clock = machine.clock_hz;
    let seconds = counters.cycles.max(1) as f64 / clock;
    let bytes = |bits: u32| f64::from(bits) / 8.0;
    let (voxel, sample) = (bytes(words.voxel_bits), bytes(words.sample_bits()));
    let shaded = bytes(3 * words.colour_bits + words.opacity_bits);
    let sum = |of: &dyn Fn(&FrameSetup) -> f64| frames.iter().copied().map(of).sum::<f64>();
    let beam = frames.first().map_or(0.0, |setup| setup.geometry.size[0] as f64);
    let slots = |setup: &FrameSetup| Schedule::new(machine, &setup.geometry).ray_slots() as f64;
    let depths = |setup: &FrameSetup| setup.geometry.size[2] as f64;
    // With sections, beams come in pieces: together all voxels.
    let all = |setup: &FrameSetup| setup.geometry.size.iter().map(|&n| n as f64).product::<f64>();
    let fetched = if machine.rays.section.is_some() { sum(&all) } else { counters.beams as f64 * beam };
    let rays = sum(&|setup| slots(setup) * depths(setup));
    // Voxels that a ray brings for each depth: of two planes, or a cell of its own.
    let corners_of = |setup: &FrameSetup| if setup.geometry.doubled() { 4.0 } else { 2.0 };
    let corners = sum(&|setup| corners_of(setup) * slots(setup) * depths(setup));
    let most_corners = frames.iter().copied().map(corners_of).fold(2.0, f64::max);
    let interface = |name: &str, peak: Option<f64>, total: f64| InterfaceReport {
        name: name.into(),
        peak_bytes_per_s: peak,
        mean_bytes_per_s: total / seconds,
    };
    let memory_clock = machine.memory_clock_hz();
    let bus = machine.bus.channels.unwrap_or(machine.lanes) as f64 * machine.bus.clock_hz.unwrap_or(clock);
    let mut interfaces = Vec::new();
    if machine.cfb.layout == Layout::MiniBlocks {
        let peak = lanes * voxel * memory_clock * MemoryModel::of(machine.cfb.memory).words_per_tick as f64;
        let read = counters.memory.iter().map(|frame| frame.words as f64).sum::<f64>();
        interfaces.push(interface("memory to reorder buffer", Some(peak), read * voxel));
        interfaces.push(interface("reorder buffer to bus", Some(lanes * voxel * clock), fetched * voxel));
    } else {
        interfaces.push(interface("memory to bus", Some(lanes * voxel * memory_clock), fetched * voxel));
    }
    interfaces.extend([
        interface("bus to buffers", Some(bus * voxel), counters.bus.words as f64 * voxel),
        interface("buffers to interpolation", Some(most_corners * lanes * voxel * clock), corners * voxel),
        interface("interpolation to shading", Some(lanes * sample * clock), rays * sample),
        interface("shading to cone", Some(lanes * shaded * clock), rays * shaded),
        interface(
            "cone to host",
            machine.host_link.bytes_per_cycle.map(|bytes| bytes * clock),
            counters.host.bytes as f64,
        ),
    ]);
    let overlaps = frames.iter().map(|setup| Overlap::new(machine, setup));
    let moved = overlaps
        .map(|overlap| overlap.rays_moved as f64 * bytes(ray_bits(machine)) + overlap.samples_moved as f64 * sample);
    let moved: f64 = moved.sum();
    if moved > 0.0 {
        interfaces.push(interface("overlap buffers", None, moved));
    }
    if machine.boards.count > 1 {
        // Each board has a link to its neighbour, which carries words in two directions.
        let words = machine.boards.link_words_per_cycle.map(|words| 2.0 * machine.boards.count as f64 * words);
        let links = words.map(|words| words * voxel * clock);
        let carried = counters.links.iter().map(|link| link.carried() as f64).sum::<f64>();
        interfaces.push(interface("links between boards", links, carried * voxel));
    }
    interfaces
}
