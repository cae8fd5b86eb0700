//! What a run has counted, unit by unit and channel by channel.

use crate::Fidelity;
use crate::host_port::HostCounters;
use crate::links::{RayWords, Traffic};
use crate::machine::{CHANNELS, Joint, Machine};
use cube3_cfb::memory::{MemoryCounters, ReorderCounters};
use cube3_channel::{Account, Channel, ChannelCounters, Deadlock, PortState, Wait, diagnose};
use cube3_dsb::LinkReading;
use cube3_dsb::bus::BusCounters;

/// What a run has counted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunCounters {
    /// Cycles from the first fetch to the last pixel.
    pub cycles: u64,
    /// Cycles from the first fetch to the last pixel of each frame.
    pub frame_ends: Vec<u64>,
    /// Beams read from the modules.
    pub beams: u64,
    /// Ray slots that went through the pipeline.
    pub ray_slots: u64,
    /// Cycles that the busier of the two sides needs for its tokens alone: beams in, or rays out.
    pub steady_cycles: u64,
    /// Each unit's name and account.
    pub units: Vec<(&'static str, Account)>,
    /// Each channel.
    pub channels: Vec<ChannelReading>,
    /// What the memory modules have done, by frame; nothing where they give any word in any cycle.
    pub memory: Vec<MemoryCounters>,
    /// What the reorder buffer behind them has done; nothing where they are read by beams.
    pub reorder: Option<ReorderCounters>,
    /// Words on the bus and on the links between boards.
    pub bus: BusCounters,
    /// Words of rays on those links, in the frames that the host has received whole.
    pub ray_words: RayWords,
    /// Each link between boards, forwards and backwards; nothing on one board.
    pub links: Vec<LinkReading>,
    /// Pixels and bytes to the host.
    pub host: HostCounters,
}

/// A channel at the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ChannelReading {
    /// Name.
    pub name: &'static str,
    /// Its place.
    pub joint: Joint,
    /// Tokens that fit.
    pub capacity: usize,
    /// Cycles from push to pop.
    pub latency: u64,
    /// Tokens still there.
    pub occupancy: usize,
    /// Counters.
    pub counters: ChannelCounters,
}

/// A channel as it stands between two cycles.
struct Standing {
    reading: ChannelReading,
    /// Whether a token can be popped.
    arrived: bool,
    /// Whether a token can be pushed.
    room: bool,
}

impl Standing {
    fn of<T>(channel: &Channel<T>, joint: Joint) -> Standing {
        let reading = ChannelReading {
            name: channel.name(),
            joint,
            capacity: channel.capacity(),
            latency: channel.latency(),
            occupancy: channel.occupancy(),
            counters: channel.counters(),
        };
        Standing { reading, arrived: channel.front().is_some(), room: channel.can_push() }
    }

    /// Who waits for whom: a channel between two units is empty, full, or neither.
    fn wait(&self) -> Option<Wait> {
        let ChannelReading { name, joint, occupancy, capacity, .. } = self.reading;
        let (unit, state, upon) = match (self.arrived, self.room) {
            (false, _) => (joint.to, PortState::Empty, joint.from),
            (true, false) => (joint.from, PortState::Full, joint.to),
            (true, true) => return None,
        };
        Some(Wait { unit, port: name.to_owned(), state, occupancy, capacity, upon })
    }
}

impl<F: Fidelity> Machine<F> {
    /// Each channel, in the order of [`Machine::JOINTS`].
    fn standings(&self) -> [Standing; CHANNELS] {
        let [beams, aligned, rays, samples, shaded, pixels] = Self::JOINTS;
        [
            Standing::of(&self.beams, beams),
            Standing::of(&self.aligned, aligned),
            Standing::of(&self.rays, rays),
            Standing::of(&self.samples, samples),
            Standing::of(&self.shaded, shaded),
            Standing::of(&self.pixels, pixels),
        ]
    }

    /// Who waits for whom, inside of the units and between them.
    pub(crate) fn deadlock(&self) -> Deadlock {
        let mut waits = self.dsb.inner_waits(&self.aligned);
        waits.extend(self.abc.inner_wait(&self.samples));
        waits.extend(self.standings().iter().filter_map(Standing::wait));
        diagnose(self.last_move, &waits)
    }

    /// Words of the rays of the frames that the host has received whole.
    fn ray_words_received(&self) -> RayWords {
        let frames = self.ray_words.iter().take(self.host.frames_done() as usize);
        frames.copied().fold(RayWords::default(), RayWords::plus)
    }

    /// The counters so far.
    pub fn counters(&self) -> RunCounters {
        let units = Self::UNITS.into_iter().zip(self.accounts().map(|account| *account)).collect();
        let channels = self.standings().map(|standing| standing.reading).into();
        RunCounters {
            cycles: self.cycle,
            frame_ends: self.frame_ends.clone(),
            beams: self.cfb.fetched(),
            ray_slots: self.ray_slots(),
            steady_cycles: self.cfb.account().active().max(self.dsb.accounts()[1].active()),
            units,
            channels,
            memory: self.cfb.memory_counters().to_vec(),
            reorder: self.cfb.reorder_counters(),
            bus: self.bus.counters(),
            ray_words: self.ray_words_received(),
            links: self.traffic.as_ref().map(Traffic::readings).unwrap_or_default(),
            host: self.host.counters(),
        }
    }
}
