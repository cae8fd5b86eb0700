//! How many boards there are, and which lanes each has.

use cube3_machine::MachineSpec;

/// Data sheet of the boards and links.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BoardSpec {
    /// Boards.
    pub boards: usize,
    /// Lanes of all boards together.
    pub lanes: usize,
    /// Cycles from a board to its neighbour.
    pub latency: u64,
}

impl BoardSpec {
    /// The data sheet of a machine.
    pub fn new(machine: &MachineSpec) -> BoardSpec {
        BoardSpec { boards: machine.boards.count, lanes: machine.lanes, latency: machine.boards.link_latency_cycles }
    }

    /// The first lane of a board: boards differ by a lane at most.
    pub fn first_lane(&self, board: usize) -> usize {
        board * self.lanes / self.boards
    }

    /// The board of a lane.
    pub fn board(&self, lane: usize) -> usize {
        ((lane + 1) * self.boards - 1) / self.lanes
    }

    /// Links from a board to another, the shorter way round.
    pub fn hops(&self, from: usize, to: usize) -> usize {
        let forwards = (to + self.boards - from) % self.boards;
        forwards.min(self.boards - forwards)
    }

    /// Links to the farthest board.
    pub fn diameter(&self) -> usize {
        self.boards / 2
    }

    /// Links that a lane's neighbour at this distance can be away.
    pub fn neighbour_hops(&self, lanes: usize) -> usize {
        lanes.div_ceil(self.lanes / self.boards).min(self.diameter())
    }
}
