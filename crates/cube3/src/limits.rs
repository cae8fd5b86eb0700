//! What limits the frame rate: the machine again with one resource at a time out of the way.

use crate::Outcome;
use cube3_cfb::PortSpec;
use cube3_channel::Account;
use cube3_frame::FrameSetup;
use cube3_machine::{
    Acquisition, AcquisitionMode, Boards, Bus, Cfb, ChannelSize, Channels, Cone, ConeKind, Dsb, Frames, HostLink,
    Layout, MachineSpec,
};
use cube3_pipeline::links::{busiest_link, link_slots};
use cube3_pipeline::{Machine, RunCounters, RunError};
use cube3_report::{LimitWithout, LimitsReport};
use std::sync::Arc;

/// A resource, what it is replaced by, and how.
struct Resource {
    name: &'static str,
    replaced_by: &'static str,
    remove: fn(&MachineSpec) -> MachineSpec,
}

/// Resources that can be taken out of the way, in the order of the pipeline. The pipeline itself is what is left.
const RESOURCES: [Resource; 9] = [
    Resource {
        name: "memory",
        replaced_by: "modules that give a word in every cycle, without conflicts",
        remove: |m| {
            // Words of mini-blocks come behind one another from every memory; rows of an ideal one wait for nothing.
            let layout = if m.cfb.layout == Layout::MiniBlocks { Layout::Rows } else { m.cfb.layout };
            MachineSpec { cfb: Cfb { layout, ..Cfb::default() }, ..m.clone() }
        },
    },
    Resource {
        name: "acquisition port",
        replaced_by: "a port of its own",
        remove: |m| MachineSpec {
            acquisition: match m.acquisition.mode {
                AcquisitionMode::CycleStealing => Acquisition { mode: AcquisitionMode::DualPort, ..m.acquisition },
                _ => m.acquisition,
            },
            ..m.clone()
        },
    },
    Resource {
        name: "bus",
        replaced_by: "a channel for each lane at the pipeline's clock",
        remove: |m| MachineSpec { bus: Bus { channels: None, clock_hz: None, ..m.bus }, ..m.clone() },
    },
    Resource {
        name: "links",
        replaced_by: "links that carry any number of words",
        remove: |m| MachineSpec { boards: Boards { link_words_per_cycle: None, ..m.boards }, ..m.clone() },
    },
    Resource {
        name: "buffers",
        replaced_by: "two ports and a plane more",
        remove: |m| {
            let dsb = Dsb { ports: 2, planes: m.dsb.planes.max(3) };
            let abc = cube3_machine::Abc { planes: m.abc.planes.max(4), ..m.abc };
            MachineSpec { dsb, abc, ..m.clone() }
        },
    },
    Resource {
        name: "cone",
        replaced_by: "a folded tree",
        remove: |m| match m.cone.kind {
            ConeKind::Accumulator => MachineSpec { cone: Cone { kind: ConeKind::FoldedTree }, ..m.clone() },
            _ => m.clone(),
        },
    },
    Resource {
        name: "channels",
        replaced_by: "room for a token more than the latency",
        remove: |m| MachineSpec { channel: roomy(&m.channel), ..m.clone() },
    },
    Resource {
        name: "host",
        replaced_by: "a host that takes any number of bytes",
        remove: |m| MachineSpec { host_link: HostLink { bytes_per_cycle: None }, ..m.clone() },
    },
    Resource {
        name: "drain",
        replaced_by: "the next frame behind this one's last beam",
        remove: |m| MachineSpec { frames: Frames { overlap: true }, ..m.clone() },
    },
];

/// Channels at full rate with the same latencies.
fn roomy(channels: &Channels) -> Channels {
    let room = |size: ChannelSize| ChannelSize { capacity: size.capacity.max(size.latency as usize + 1), ..size };
    Channels {
        beams: room(channels.beams),
        aligned: room(channels.aligned),
        rays: room(channels.rays),
        samples: room(channels.samples),
        shaded: room(channels.shaded),
        pixels: room(channels.pixels),
    }
}

/// Cycles from the last pixel of a picture to that of the next, where pictures of the same `passes` follow each other. Where links are limited
/// another one follows: what its beams put on the links while the buffers still hold this picture's is part of a picture's time.
///
/// # Errors
/// A machine that cannot move.
pub fn frame_interval(machine: &MachineSpec, passes: &[impl Clone + Into<Arc<FrameSetup>>]) -> Outcome<u64> {
    Ok(interval_under(machine, &shared(passes), None)?.0)
}

/// The frames as all runs share them.
fn shared(passes: &[impl Clone + Into<Arc<FrameSetup>>]) -> Vec<Arc<FrameSetup>> {
    passes.iter().cloned().map(Into::into).collect()
}

/// The same while volumes of `incoming` voxels along x, y, z come in without end; and what the run counted.
fn interval_under(
    machine: &MachineSpec,
    passes: &[Arc<FrameSetup>],
    incoming: Option<[usize; 3]>,
) -> Outcome<(u64, RunCounters)> {
    let pictures = if link_slots(machine, 1).is_some() { 4 } else { 3 };
    let frames = vec![passes; pictures].concat();
    let mut run = Machine::timing(machine, frames)?;
    if let Some(dims) = incoming {
        run.acquire(PortSpec::new(machine, dims, None));
        run.begin_pictures((0..pictures as u32).map(|picture| picture * passes.len() as u32).collect());
    }
    run.run(&|_, _| {}).map_err(RunError::from)?;
    let counters = run.counters();
    let ends = &counters.frame_ends;
    Ok((ends[3 * passes.len() - 1] - ends[2 * passes.len() - 1], counters))
}

/// The busiest link in words, with the part of the run in which it carried what it can.
fn named_link(machine: &MachineSpec, counters: &RunCounters) -> Option<String> {
    let link = busiest_link(&counters.links)?;
    let busy = link.carried() as f64 / link_slots(machine, counters.cycles)?.max(1) as f64;
    Some(format!("link {}, {}, {:.0} % busy", link.link, link.direction(), 100.0 * busy))
}

/// Units that each take all rays of a frame: where one of them is as busy as any, the pipeline itself is what limits.
const RAY_UNITS: [&str; 4] = ["dsb.read", "trilin", "abc", "cone"];

/// The unit that is busier than those that take rays, where there is one, by its name in `limits`, with the part of the cycles in which it is
/// busy: beams and words of a view can need more cycles than its rays, on a machine from which nothing can be taken to help that.
fn busier_than_rays(counters: &RunCounters) -> Option<(&'static str, f64)> {
    let busy = |(_, account): &(&'static str, Account)| account.busy;
    let (name, most) = counters.units.iter().max_by_key(|unit| busy(unit)).map(|unit| (unit.0, busy(unit)))?;
    let rays = counters.units.iter().filter(|(name, _)| RAY_UNITS.contains(name)).map(busy).max().unwrap_or(0);
    // A fiftieth: filling and draining are not the same for all units.
    let busier = most > rays + rays / 50;
    let name = match name {
        "cfb" => "beams",
        "dsb.write" => "buffers",
        other => other,
    };
    busier.then(|| (name, most as f64 / counters.cycles.max(1) as f64))
}

/// Finds the resource without which frames follow each other fastest, and what limits then; while volumes of `incoming` voxels
/// along x, y, z come in, if any.
///
/// # Errors
/// As [`frame_interval`].
pub fn limits(
    machine: &MachineSpec,
    passes: &[impl Clone + Into<Arc<FrameSetup>>],
    incoming: Option<[usize; 3]>,
) -> Outcome<LimitsReport> {
    let passes = &shared(passes);
    let (interval, counters) = interval_under(machine, passes, incoming)?;
    let interval_without = |machine: &MachineSpec, resource: &Resource| {
        let freed = (resource.remove)(machine);
        if freed == *machine {
            Ok(None)
        } else {
            interval_under(&freed, passes, incoming).map(|(interval, _)| Some(interval))
        }
    };
    let fps = |interval: u64| machine.clock_hz / interval.max(1) as f64;
    let mut without = Vec::new();
    let mut best: Option<(u64, &Resource)> = None;
    for resource in &RESOURCES {
        let Some(interval) = interval_without(machine, resource)? else { continue };
        without.push(LimitWithout {
            resource: resource.name.into(),
            replaced_by: resource.replaced_by.into(),
            fps: fps(interval),
        });
        if best.is_none_or(|(least, _)| interval < least) {
            best = Some((interval, resource));
        }
    }
    let (critical, fps_without, next) = match best.filter(|(least, _)| *least < interval) {
        None => ("pipeline", None, None),
        Some((least, critical)) => {
            let freed = (critical.remove)(machine);
            let mut next = (least, "pipeline");
            for resource in RESOURCES.iter().filter(|resource| resource.name != critical.name) {
                if let Some(then) = interval_without(&freed, resource)?
                    && then < next.0
                {
                    next = (then, resource.name);
                }
            }
            (critical.name, Some(fps(least)), Some(next.1))
        }
    };
    let sentence = match (fps_without, next) {
        (Some(faster), Some(next)) => {
            let verb = if matches!(next, "buffers" | "links" | "channels") { "limit" } else { "limits" };
            let link = named_link(machine, &counters).filter(|_| critical == "links");
            let link = link.map_or_else(String::new, |link| format!(" ({link})"));
            format!("{critical}: {:.1} frames/s{link}; without it {faster:.1}, then the {next} {verb}", fps(interval))
        }
        _ => match busier_than_rays(&counters) {
            Some((unit, busy)) => format!(
                "{unit}: {:.1} frames/s, busy in {:.1} % of the cycles, with {} lanes at {} MHz; nothing that can be taken out of its way slows it",
                fps(interval),
                100.0 * busy,
                machine.lanes,
                machine.clock_hz / 1e6
            ),
            None => format!(
                "{critical}: {:.1} frames/s, with {} lanes at {} MHz; no other resource slows it",
                fps(interval),
                machine.lanes,
                machine.clock_hz / 1e6
            ),
        },
    };
    let critical = match fps_without {
        Some(_) => critical,
        None => busier_than_rays(&counters).map_or(critical, |(unit, _)| unit),
    };
    Ok(LimitsReport {
        critical: critical.into(),
        fps: fps(interval),
        fps_without,
        next: next.map(Into::into),
        sentence,
        without,
    })
}
