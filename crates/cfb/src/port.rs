//! The acquisition port: words of new volumes that come in while frames are read.
//!
//! ```text
//!   source ──► words waiting (two groups) ──► modules, a group in a module cycle
//! ```
//!
//! Words come in voxel order, x fastest, then y, then z, each volume behind the one before. A module takes one word in a cycle,
//! so a cycle takes a *group*: as many words as a row along x meets modules. A source that is faster is held back.
//!
//! Of mini-blocks two neighbours along x are in one module. The port has two groups at hand and writes the first voxel of each pair of both in
//! one cycle and the second in the next, so that it takes a group a cycle there, too. A word that is written is written into the reorder
//! buffer as well, where its mini-block is there: a beam shows what is in the modules when it is sent.

use std::ops::Range;

use crate::golden::Skew;
use cube3_machine::{AcquisitionMode, MachineSpec};
use serde::{Deserialize, Serialize};

/// Bits of the rate register below a word.
const FRACTION_BITS: u32 = 40;

/// Data sheet of the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PortSpec {
    /// How written and read voxels share the modules.
    pub mode: AcquisitionMode,
    /// Words that come in with a cycle, in units of 2⁻⁴⁰; at most a group.
    pub rate: u64,
    /// Words that a module cycle takes.
    pub group: u64,
    /// Words of a volume.
    pub voxels: u64,
    /// Words that come in before the source stops.
    pub words: u64,
}

impl PortSpec {
    /// The port of a machine for volumes of `dims`, of which `volumes` come in; without end for `None`.
    pub fn new(machine: &MachineSpec, dims: [usize; 3], volumes: Option<u64>) -> PortSpec {
        let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
        let group = (machine.lanes / skew.depth()).max(1) as u64;
        let rate = machine.acquisition.words_per_cycle.min(group as f64);
        let voxels = dims.iter().map(|&n| n as u64).product();
        PortSpec {
            mode: machine.acquisition.mode,
            rate: ((rate * (1_u64 << FRACTION_BITS) as f64).round() as u64).max(1),
            group,
            voxels,
            words: volumes.map_or(u64::MAX, |volumes| volumes.saturating_mul(voxels)),
        }
    }

    /// Words that come in with a cycle.
    pub fn words_per_cycle(&self) -> f64 {
        self.rate as f64 / (1_u64 << FRACTION_BITS) as f64
    }
}

/// The port.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct AcquisitionPort {
    spec: PortSpec,
    state: State,
    /// For each beam, in the order of fetches: words that it has seen written.
    seen: Vec<u64>,
}

/// What has come in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct State {
    /// Part of a word, in units of 2⁻⁴⁰.
    fraction: u64,
    /// Words that wait for the modules.
    waiting: u64,
    /// Words in the modules.
    written: u64,
    /// Double buffer: volumes that have become visible.
    shown: u64,
    /// Cycles taken from reads.
    stolen: u64,
    /// Whether the last cycle was taken from a read, so that this one is not.
    yields: bool,
}

impl AcquisitionPort {
    /// A port at which nothing has come in.
    pub fn new(spec: PortSpec) -> AcquisitionPort {
        AcquisitionPort { spec, state: State::default(), seen: Vec::new() }
    }

    /// The data sheet.
    pub fn spec(&self) -> &PortSpec {
        &self.spec
    }

    /// Words in the modules.
    pub fn written(&self) -> u64 {
        self.state.written
    }

    /// Cycles in which a write kept a beam from being read.
    pub fn stolen(&self) -> u64 {
        self.state.stolen
    }

    /// For each beam of voxels, in the order of fetches over all frames: the words W that it has seen written. Voxel i of
    /// the volume (x fastest) is then of the volume number ⌈(W − i)/voxels⌉, or of volume 0, which was there at the start,
    /// where W ≤ i.
    pub fn seen(&self) -> &[u64] {
        &self.seen
    }

    /// The words of a cycle come in, as far as there is room and the source has any.
    #[inline]
    pub(crate) fn arrive(&mut self) {
        let State { waiting, written, .. } = self.state;
        let sum = self.state.fraction + self.spec.rate;
        self.state.fraction = sum & ((1 << FRACTION_BITS) - 1);
        let room = (2 * self.spec.group - waiting).min(self.spec.words - written - waiting);
        self.state.waiting += (sum >> FRACTION_BITS).min(room);
    }

    /// Whether a complete volume waits for the next frame.
    #[inline]
    pub(crate) fn can_show(&self) -> bool {
        self.spec.mode == AcquisitionMode::DoubleBuffer
            && self.state.written == (self.state.shown + 1) * self.spec.voxels
    }

    /// The buffers change roles.
    #[inline]
    pub(crate) fn show(&mut self) {
        self.state.shown += 1;
    }

    /// Whether the port takes this cycle from a beam that could be read. A write never takes two cycles running from reads.
    #[inline]
    pub(crate) fn steals(&mut self, reads: bool) -> bool {
        let due = self.spec.mode == AcquisitionMode::CycleStealing && self.due();
        self.state.yields = due && reads && !self.state.yields;
        self.state.stolen += u64::from(self.state.yields);
        self.state.yields
    }

    /// Whether a group is complete: a full one, or the last of a volume.
    #[inline]
    fn due(&self) -> bool {
        let rest = self.spec.voxels - self.state.written % self.spec.voxels;
        self.state.waiting >= self.spec.group.min(rest)
    }

    /// The words that the modules take in this cycle; `free` is a cycle that no beam is read in, or that was taken from one.
    #[inline]
    pub(crate) fn write(&mut self, free: bool) -> Range<u64> {
        let State { waiting, written, shown, .. } = self.state;
        let count = match self.spec.mode {
            AcquisitionMode::DualPort => waiting.min(self.spec.group),
            // The buffer behind the one that is read holds one volume.
            AcquisitionMode::DoubleBuffer => waiting.min(self.spec.group).min((shown + 1) * self.spec.voxels - written),
            AcquisitionMode::CycleStealing if free && self.due() => {
                self.spec.group.min(self.spec.voxels - written % self.spec.voxels)
            }
            AcquisitionMode::CycleStealing => 0,
        };
        self.state.waiting -= count;
        self.state.written += count;
        written..written + count
    }

    /// A beam is fetched.
    #[inline]
    pub(crate) fn fetched(&mut self) {
        self.seen.push(match self.spec.mode {
            AcquisitionMode::DoubleBuffer => self.state.shown * self.spec.voxels,
            _ => self.state.written,
        });
    }
}
