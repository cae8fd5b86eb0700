//! What boards cost: words that queue at the links between them, and longer ways between neighbouring lanes.
//!
//! ```text
//!   bus ─[aligned]─► dsb.write    dsb.read ─[rays]─► trilin ─[samples]─► abc ─[shaded]─► cone
//!         gathering                           voxels,         samples          nodes
//!                                             edges
//! ```
//! A token's words are put on the links when it is pushed into the channel before the unit that needs them. It can be popped when
//! they are over; and while a link that they cross is full, it is not pushed.

use cube3_abc::{ShadedRay, frame_reach, reach};
use cube3_cfb::Beam;
use cube3_channel::{Archive, ArchiveError, Archived, Channel, ClockDomain};
use cube3_cone::ConeSpec;
use cube3_dsb::{BoardSpec, LinkReading, Links, RayPair};
use cube3_frame::{FrameSetup, Schedule};
use cube3_machine::{ChannelSize, Channels, MachineSpec};
use cube3_trilin::SampleRay;
use serde::{Deserialize, Serialize};
use std::borrow::Borrow;

/// Words that rays send over the links, all links and both directions together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct RayWords {
    /// TRILIN: voxels of the next depth and edges of the ray before, each of two planes.
    pub trilin: u64,
    /// ABC: samples of the lanes that the gradient reads on the other side.
    pub abc: u64,
    /// Cone: nodes between boards.
    pub cone: u64,
}

impl RayWords {
    /// The words of the rays of a frame, which has this schedule.
    pub fn new(machine: &MachineSpec, setup: &FrameSetup, schedule: &Schedule) -> RayWords {
        if machine.boards.count == 1 {
            return RayWords::default();
        }
        let links = RayLinks::new(machine, setup, *schedule);
        let sum = |words: &[[u64; 2]]| words.iter().flatten().sum::<u64>();
        let mut nodes = vec![[0; 2]; machine.boards.count];
        let cone = (0..schedule.shape().slots).map(|slot| {
            links.cone.link_words(slot % machine.lanes, &mut nodes);
            sum(&nodes)
        });
        let (planes, rays) = (schedule.shape().planes as u64, schedule.ray_slots());
        RayWords { trilin: rays * sum(&links.trilin), abc: rays * sum(&links.abc), cone: planes * cone.sum::<u64>() }
    }

    /// The sum.
    pub fn plus(self, other: RayWords) -> RayWords {
        RayWords { trilin: self.trilin + other.trilin, abc: self.abc + other.abc, cone: self.cone + other.cone }
    }
}

/// Words of a ray of a frame over each link, forwards and backwards.
#[derive(Clone, Debug)]
struct RayLinks {
    schedule: Schedule,
    trilin: Vec<[u64; 2]>,
    abc: Vec<[u64; 2]>,
    /// The cone's depend on the lane at which a ray begins.
    cone: ConeSpec,
}

impl RayLinks {
    fn new(machine: &MachineSpec, setup: &FrameSetup, schedule: Schedule) -> RayLinks {
        let boards = machine.boards.count;
        let chunks = schedule.ray_cycles();
        // The voxel of the next depth comes back from the next lane. The edge of the ray before comes on to the next lane; a cell of its
        // own has both columns instead. Of two planes or rows.
        let trilin = if schedule.shape().doubled { [0, 4 * chunks] } else { [2 * chunks; 2] };
        // A sample crosses a link once, for all lanes that read it.
        let abc = frame_reach(setup) as u64 * chunks;
        RayLinks {
            schedule,
            trilin: vec![trilin; boards],
            abc: vec![[abc; 2]; boards],
            cone: ConeSpec::new(machine, &schedule),
        }
    }
}

/// Words of the nodes of a ray over each link, forwards and backwards, by the lane at which it begins.
#[derive(Clone, Debug)]
struct ConeLinks {
    cone: ConeSpec,
    /// Those of the first lanes, one behind another.
    kept: Vec<[u64; 2]>,
}

impl ConeLinks {
    /// Most links of which words are kept, for all lanes together.
    const MOST: usize = 1 << 16;

    fn new(cone: ConeSpec) -> ConeLinks {
        let lanes = cone.lanes.min(ConeLinks::MOST / cone.boards);
        let mut kept = vec![[0; 2]; lanes * cone.boards];
        kept.chunks_exact_mut(cone.boards).enumerate().for_each(|(start, links)| cone.link_words(start, links));
        ConeLinks { cone, kept }
    }

    /// Those of a lane; `memory` has a place for each link.
    #[inline]
    fn words<'a>(&'a self, start: usize, memory: &'a mut [[u64; 2]]) -> &'a [[u64; 2]] {
        let first = start * self.cone.boards;
        match self.kept.get(first..first + self.cone.boards) {
            Some(words) => words,
            None => {
                self.cone.link_words(start, memory);
                memory
            }
        }
    }
}

/// The next ray of a unit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Next {
    frame: usize,
    /// Rays of the frame before it.
    sent: u64,
}

impl Next {
    /// Goes on to the ray behind it.
    #[inline]
    fn advance(&mut self, frames: &[RayLinks]) {
        self.sent += 1;
        if self.sent == frames[self.frame].schedule.ray_slots() && self.frame + 1 < frames.len() {
            *self = Next { frame: self.frame + 1, sent: 0 };
        }
    }
}

/// The links of a machine, and what its units put on them.
#[derive(Clone, Debug)]
pub(crate) struct Traffic {
    links: Links,
    frames: Vec<RayLinks>,
    /// The cones of the frames, each once, and which is that of each frame.
    cones: Vec<ConeLinks>,
    cone_of: Vec<usize>,
    lanes: usize,
    /// Which ray comes next of those that TRILIN and the ABC units need words for.
    next: [Next; 2],
    /// For each link and direction whether the nodes of any ray cross it.
    nodes_cross: Vec<[u64; 2]>,
    /// Nodes of a ray: their memory.
    nodes: Vec<[u64; 2]>,
}

impl Traffic {
    /// Empty links for some frames; none on a machine of one board.
    pub fn new<'a>(
        machine: &MachineSpec,
        frames: impl IntoIterator<Item = (&'a FrameSetup, Schedule)>,
    ) -> Option<Traffic> {
        let links = Links::new(machine)?;
        let ray_links = |(setup, schedule)| RayLinks::new(machine, setup, schedule);
        let frames: Vec<RayLinks> = frames.into_iter().map(ray_links).collect();
        let mut nodes = vec![[0; 2]; machine.boards.count];
        let mut nodes_cross = nodes.clone();
        // All rays begin somewhere on the circle, and all cones of a machine are alike but for the chunks: the links are those of any frame.
        let cone = ConeSpec::of(machine, machine.lanes);
        for start in 0..machine.lanes {
            cone.link_words(start, &mut nodes);
            let words = nodes.iter().flatten();
            nodes_cross.iter_mut().flatten().zip(words).for_each(|(cross, words)| *cross |= words);
        }
        let mut cones = Vec::<ConeLinks>::new();
        let mut number = |frame: &RayLinks| {
            cones.iter().position(|kept| kept.cone == frame.cone).unwrap_or_else(|| {
                cones.push(ConeLinks::new(frame.cone));
                cones.len() - 1
            })
        };
        let cone_of = frames.iter().map(&mut number).collect();
        Some(Traffic {
            links,
            frames,
            cones,
            cone_of,
            lanes: machine.lanes,
            next: Default::default(),
            nodes_cross,
            nodes,
        })
    }

    /// The links as the last cycle left them.
    pub fn links(&self) -> &Links {
        &self.links
    }

    /// Each link, forwards and backwards.
    pub fn readings(&self) -> Vec<LinkReading> {
        self.links.readings()
    }

    /// Ends a cycle, before the channels commit: links carry, and then take the words of the tokens pushed in it, those of the later unit
    /// first; `beam` are those of a beam of voxels.
    #[inline]
    pub fn end_cycle<A, B, C, D>(
        &mut self,
        beam: Option<&[[u64; 2]]>,
        aligned: &mut Channel<Beam<A>>,
        rays: &mut Channel<RayPair<B>>,
        samples: &mut Channel<SampleRay<C>>,
        shaded: &mut Channel<ShadedRay<D>>,
    ) {
        let Traffic { links, frames, cones, cone_of, lanes, next, nodes_cross, nodes } = self;
        links.carry();
        if let Some(ray) = shaded.pushed() {
            let cone = &cones[cone_of[ray.frame as usize]];
            let words = cone.words(ray.slot as usize % *lanes, nodes);
            shaded.delay(links.put(words));
        }
        if let Some(ray) = samples.pushed() {
            samples.delay(links.put(&frames[ray.frame as usize].abc));
            next[1].advance(frames);
        }
        if let Some(ray) = rays.pushed() {
            rays.delay(links.put(&frames[ray.frame as usize].trilin));
            next[0].advance(frames);
        }
        if let Some(words) = beam {
            aligned.delay(links.put(words));
        }
        if !links.limited() {
            return;
        }
        rays.shut(!links.has_room(&frames[next[0].frame].trilin));
        samples.shut(!links.has_room(&frames[next[1].frame].abc));
        shaded.shut(!links.has_room(nodes_cross));
    }
}

impl Archived for Traffic {
    fn archive(&mut self, archive: &mut Archive<'_>) -> Result<(), ArchiveError> {
        let Traffic { links, frames: _, cones: _, cone_of: _, lanes: _, next, nodes_cross: _, nodes: _ } = self;
        archive.item(next)?;
        links.archive(archive)
    }
}

/// The channels with what boards and the kind of cone add: a beam may go to the farthest board, samples to the lanes beside, as far as a gradient of
/// one of the frames reads; room for the tokens on their way comes with it.
pub fn channels(machine: &MachineSpec, frames: &[impl Borrow<FrameSetup>]) -> Channels {
    let spec = BoardSpec::new(machine);
    let farther = |size: ChannelSize, hops: usize| {
        let more = hops as u64 * spec.latency;
        ChannelSize { capacity: size.capacity + more as usize, latency: size.latency + more }
    };
    let sizes = machine.channel;
    let reach =
        frames.iter().map(|setup| frame_reach(setup.borrow())).fold(reach(machine.abc.gradient, 1, false), usize::max);
    Channels {
        aligned: farther(sizes.aligned, spec.diameter()),
        samples: farther(sizes.samples, spec.neighbour_hops(1)),
        shaded: farther(sizes.shaded, spec.neighbour_hops(reach)),
        pixels: ConeSpec::pixels(machine),
        ..sizes
    }
}

/// Words that a link can carry in a direction in so many cycles, where it is limited.
pub fn link_slots(machine: &MachineSpec, cycles: u64) -> Option<u64> {
    let rate = machine.boards.link_words_per_cycle.filter(|_| machine.boards.count > 1)?;
    Some(u64::try_from(ClockDomain::from_rate(rate).ticks_before(cycles)).unwrap_or(u64::MAX))
}

/// The link and direction that carried the most words; the first of several.
pub fn busiest_link(links: &[LinkReading]) -> Option<&LinkReading> {
    links.iter().rev().max_by_key(|link| link.carried())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_machine::{Boards, Cone, ConeKind};

    #[test]
    fn words_of_a_lane_are_its_cones_kept_or_not() {
        for kind in [ConeKind::FoldedTree, ConeKind::ShiftedTree, ConeKind::Chain, ConeKind::Accumulator] {
            let boards = Boards { count: 256, ..Boards::default() };
            let machine = MachineSpec { lanes: 512, boards, cone: Cone { kind }, ..MachineSpec::default() };
            let cone = ConeSpec::of(&machine, 700);
            let links = ConeLinks::new(cone);
            assert_eq!(links.kept.len(), ConeLinks::MOST, "half of the lanes");
            let (mut memory, mut expected) = (vec![[7; 2]; 256], vec![[0; 2]; 256]);
            for start in 0..512 {
                cone.link_words(start, &mut expected);
                assert_eq!(links.words(start, &mut memory), expected, "{kind:?} from lane {start}");
            }
        }
    }
}
