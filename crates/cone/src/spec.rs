//! The cone's data sheet: how long each kind takes for a ray, what it is made of, and what it sends between boards.

use cube3_dsb::BoardSpec;
use cube3_frame::Schedule;
use cube3_machine::{ChannelSize, ConeKind, MachineSpec};

/// Data sheet of the cone for one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConeSpec {
    /// How the nodes are joined.
    pub kind: ConeKind,
    /// Leaves.
    pub lanes: usize,
    /// Boards that the leaves are on.
    pub boards: usize,
    /// Cycles from a board to its neighbour.
    pub link_latency: u64,
    /// Chunks of a ray: ⌈n_w / lanes⌉.
    pub chunks: u64,
    /// Cycles in which a ray is at the leaves: the chunks, or for a single accumulator the samples.
    pub ray_cycles: u64,
}

/// Words of a node on a link: red, green, blue, opacity.
const NODE_WORDS: u64 = 4;

impl ConeSpec {
    /// The data sheet for a machine and a frame, which has this schedule there.
    pub fn new(machine: &MachineSpec, schedule: &Schedule) -> ConeSpec {
        ConeSpec::of(machine, schedule.shape().depths)
    }

    /// The data sheet for a machine and rays of so many samples.
    pub fn of(machine: &MachineSpec, samples: usize) -> ConeSpec {
        let chunks = Schedule::cycles(samples, machine.lanes);
        ConeSpec {
            kind: machine.cone.kind,
            lanes: machine.lanes,
            boards: machine.boards.count,
            link_latency: machine.boards.link_latency_cycles,
            chunks,
            ray_cycles: match machine.cone.kind {
                ConeKind::Accumulator => samples as u64,
                _ => chunks,
            },
        }
    }

    /// Levels of a tree, and stages of a shifter: ⌈log₂ lanes⌉.
    pub fn levels(&self) -> u64 {
        u64::from(self.lanes.next_power_of_two().trailing_zeros())
    }

    /// Cycles from the last one at the leaves to the pixel, on one board.
    pub fn latency(&self) -> u64 {
        self.first_latency() + self.turns_latency()
    }

    /// The same for a ray of one chunk. A node takes a cycle.
    fn first_latency(&self) -> u64 {
        match self.kind {
            ConeKind::FoldedTree => self.levels() + 1,
            ConeKind::ShiftedTree => 2 * self.levels() + 1,
            ConeKind::Chain => self.lanes as u64,
            ConeKind::Accumulator => 1,
        }
    }

    /// What the chunks behind the first add: in a chain each goes through all nodes behind the one before it, and other rays
    /// between them.
    #[inline]
    fn turns_latency(&self) -> u64 {
        match self.kind {
            ConeKind::Chain => (self.chunks - 1) * (self.lanes as u64 - 1),
            _ => 0,
        }
    }

    /// Cycles from the arrival of the last ray to its pixel.
    pub fn drain(&self) -> u64 {
        self.ray_cycles - 1 + self.latency()
    }

    /// Nodes that combine two stretches of a ray, the one that joins a tree's chunks included.
    pub fn nodes(&self) -> usize {
        match self.kind {
            ConeKind::FoldedTree | ConeKind::ShiftedTree | ConeKind::Chain => self.lanes,
            ConeKind::Accumulator => 1,
        }
    }

    /// Nodes' worth of registers in the shifter: a row of the lanes for each stage.
    pub fn shifter_words(&self) -> u64 {
        match self.kind {
            ConeKind::ShiftedTree => self.levels() * self.lanes as u64,
            _ => 0,
        }
    }

    /// Links that a pixel's nodes cross one after another, for a ray of one chunk; and more for each further chunk.
    #[inline]
    fn hops(&self) -> [u64; 2] {
        let boards = self.boards as u64;
        match self.kind {
            _ if boards == 1 => [0, 0],
            ConeKind::FoldedTree | ConeKind::ShiftedTree => [self.upper_levels().sum(), 0],
            ConeKind::Chain => [boards - 1, boards],
            ConeKind::Accumulator => [boards / 2, 0],
        }
    }

    /// Links from the right child's board to the left's, the shorter way round, for each level of a tree between boards.
    fn upper_levels(&self) -> impl Iterator<Item = u64> {
        let boards = self.boards as u64;
        let strides =
            std::iter::successors(Some(1), |stride| Some(stride * 2)).take_while(move |stride| *stride < boards);
        strides.map(move |stride| stride.min(boards - stride))
    }

    /// Words that a ray whose first sample is in lane `start` sends over each link, forwards and backwards; `links` has a place for
    /// each board. A lane without a sample sends an empty one. All go the shorter way round.
    pub fn link_words(&self, start: usize, links: &mut [[u64; 2]]) {
        links.fill([0; 2]);
        if self.boards == 1 {
            return;
        }
        let ring = BoardSpec { boards: self.boards, lanes: self.lanes, latency: self.link_latency };
        match self.kind {
            ConeKind::FoldedTree => self.tree_words(&ring, start, links),
            ConeKind::ShiftedTree => {
                // The shifter turns all leaves back by the start; the tree behind it starts at lane 0.
                self.tree_words(&ring, 0, links);
                let (back, on) = (start as u64, (self.lanes - start) as u64);
                let [words, backwards] = if on <= back { [on, 0] } else { [back, 1] };
                links.iter_mut().for_each(|link| link[backwards as usize] += words);
            }
            ConeKind::Chain => {
                for (board, link) in links.iter_mut().enumerate() {
                    // No chunk follows the last one over the link at which the circle begins.
                    let begins = ring.first_lane(board) == start;
                    link[0] = self.chunks - u64::from(begins);
                }
            }
            ConeKind::Accumulator => {
                // To board 0: the farther half of the ring goes on, the nearer one back.
                let half = self.boards.div_ceil(2);
                for (board, link) in links.iter_mut().enumerate() {
                    let end = if board == 0 { self.lanes } else { ring.first_lane(board) };
                    link[0] = end.saturating_sub(ring.first_lane(half)) as u64;
                    link[1] = if board == 0 { 0 } else { ring.first_lane(half).saturating_sub(end) as u64 };
                }
            }
        }
        let times = if self.kind == ConeKind::Chain { NODE_WORDS } else { NODE_WORDS * self.chunks };
        links.iter_mut().flatten().for_each(|words| *words *= times);
    }

    /// Nodes of a chunk over each link in a tree over the circle of leaves from lane `start` on. A node stands in the first lane of its left
    /// child and takes the right child from the first lane of that.
    fn tree_words(&self, ring: &BoardSpec, start: usize, links: &mut [[u64; 2]]) {
        let lanes = self.lanes;
        for (board, link) in links.iter_mut().enumerate() {
            // Leaves of the circle before the link; the circle's end is beside its beginning.
            let before = (ring.first_lane(board) + lanes - start) % lanes;
            if lanes.is_power_of_two() {
                // Every child is there: a pair for each bit that is 0.
                let half = lanes / 2;
                link[0] += u64::from(before == 0 || before > half);
                link[1] += if before > 0 { u64::from((!(before - 1) & (half - 1)).count_ones()) } else { 0 };
                continue;
            }
            for level in 0..self.levels() {
                let apart = 1 << level;
                if 2 * apart >= lanes {
                    // The root: the right child goes on round the circle where that is no longer.
                    link[0] += u64::from(before == 0 || before > apart);
                } else if before > 0 && (before - 1) & apart == 0 {
                    // Between the first lanes of two children, if there is a right one.
                    let right = ((before - 1) | apart) & !(apart - 1);
                    link[1] += u64::from(right < lanes);
                }
            }
        }
    }

    /// Cycles that a ray of several chunks takes longer from the leaves to the pixel than the channel of [`ConeSpec::pixels`].
    #[inline]
    pub fn extra_latency(&self) -> u64 {
        let [_, further] = self.hops();
        self.turns_latency() + (self.chunks - 1) * further * self.link_latency
    }

    /// The channel to the host: `channel.pixels` is that of a folded tree on one board, and what another cone or more boards take
    /// longer or shorter is added; room for the rays on their way comes with it.
    pub fn pixels(machine: &MachineSpec) -> ChannelSize {
        let size = machine.channel.pixels;
        let spec = ConeSpec::of(machine, 1);
        let folded = ConeSpec { kind: ConeKind::FoldedTree, ..spec };
        let [first, further] = spec.hops();
        let latency = (size.latency + spec.first_latency()).saturating_sub(folded.first_latency()).max(1);
        let latency = latency + first * spec.link_latency;
        let room = latency.saturating_sub(size.latency) + further * spec.link_latency;
        ChannelSize { capacity: size.capacity + room as usize, latency }
    }
}
