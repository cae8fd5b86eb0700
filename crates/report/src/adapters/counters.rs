//! What a run has counted: units, channels, memory, bus, links and host.

use crate::{ChannelReport, LinkReport, MemoryTraffic, ReorderTraffic, TrafficReport, UnitReport};
use cube3_cfb::memory::MemoryCounters;
use cube3_channel::{Account, Reason};
use cube3_dsb::LinkReading;
use cube3_machine::MachineSpec;
use cube3_pipeline::{ChannelReading, RunCounters, links::link_slots};

/// What each unit did with its cycles.
pub fn unit_reports(counters: &RunCounters) -> Vec<UnitReport> {
    let report = |(name, account): &(&str, Account)| UnitReport {
        name: (*name).into(),
        busy: account.busy,
        starved: account.starved,
        blocked: account.blocked,
        waiting: Reason::ALL
            .iter()
            .map(|&reason| (reason.name().to_owned(), account.waiting[reason as usize]))
            .filter(|(_, cycles)| *cycles > 0)
            .collect(),
    };
    counters.units.iter().map(report).collect()
}

/// What went over memory, bus, links and the host's port.
pub fn traffic_report(machine: &MachineSpec, counters: &RunCounters) -> TrafficReport {
    let mut sum = MemoryCounters::default();
    counters.memory.iter().for_each(|&frame| sum += frame);
    let memory = (!counters.memory.is_empty()).then_some(MemoryTraffic {
        words: sum.words,
        reads: sum.reads,
        row_hits: sum.row_hits,
        row_misses: sum.row_misses,
        row_conflicts: sum.row_conflicts,
        refreshes: sum.refreshes,
    });
    let reorder = counters.reorder.map(|buffer| ReorderTraffic {
        words: buffer.words,
        peak_words: buffer.peak_words,
        rows: buffer.rows,
        mini_blocks: buffer.mini_blocks,
    });
    let (bus, rays, host) = (&counters.bus, &counters.ray_words, &counters.host);
    let slots = link_slots(machine, counters.cycles);
    let link = |reading: &LinkReading| LinkReport {
        link: reading.link as u64,
        direction: reading.direction().into(),
        words: reading.carried(),
        slots,
        peak_words: reading.peak,
    };
    TrafficReport {
        memory,
        reorder,
        bus_words: bus.words,
        bus_slots: bus.slots,
        link_words: bus.link_words,
        link_peak_words: bus.link_peak,
        ray_words: [rays.trilin, rays.abc, rays.cone],
        links: counters.links.iter().map(link).collect(),
        host_pixels: host.pixels,
        host_bytes: host.bytes,
    }
}

/// Each channel with its capacity, and what it held.
pub fn channel_reports(counters: &RunCounters) -> Vec<ChannelReport> {
    let report = |reading: &ChannelReading| ChannelReport {
        name: reading.name.into(),
        from: reading.joint.from.into(),
        to: reading.joint.to.into(),
        capacity: reading.capacity as u64,
        latency: reading.latency,
        pushes: reading.counters.pushes,
        pops: reading.counters.pops,
        occupancy: reading.occupancy as u64,
        max_occupancy: reading.counters.max_occupancy,
        mean_occupancy: reading.counters.occupancy_cycles as f64 / counters.cycles.max(1) as f64,
    };
    counters.channels.iter().map(report).collect()
}
