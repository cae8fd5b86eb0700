//! The addressing of one voxel, and how many cycles a row of voxels takes. The definition.

use cube3_frame::Geometry;
use cube3_machine::{Layout, RaySlots};
use cube3_word::Probe;
use std::ops::Range;

/// The skewed memory: voxel (x, y, z) of a volume `dims` is in module `(a·x + b·y + c·z) mod lanes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skew {
    /// Coefficients a, b, c.
    pub coefficients: [i64; 3],
    /// Modules.
    pub lanes: usize,
}

/// Greatest common divisor of a stride, whatever its sign, and the modules.
pub(crate) fn gcd(stride: i64, lanes: usize) -> usize {
    cube3_channel::gcd(stride.unsigned_abs(), lanes as u64) as usize
}

impl Skew {
    /// The module of a voxel, or of a displacement between voxels.
    pub fn module(&self, xyz: [i64; 3]) -> usize {
        self.module_wires(xyz, &mut ())
    }

    /// [`Skew::module`], and what its wires carry.
    pub fn module_wires(&self, xyz: [i64; 3], probe: &mut impl Probe) -> usize {
        let sum: i64 = (0..3).map(|i| self.coefficients[i] * xyz[i]).sum();
        let module = sum.rem_euclid(self.lanes as i64) as usize;
        probe.wire("sum", 0, sum.into());
        probe.wire("module", 0, module as i128);
        module
    }

    /// Words that a module holds of each row of `lanes` voxels along x: 1 where a and the modules share no factor.
    pub fn depth(&self) -> usize {
        gcd(self.coefficients[0], self.lanes)
    }

    /// Neighbouring voxels along an axis that are in different modules.
    pub fn together(&self, axis: usize) -> usize {
        self.lanes / gcd(self.coefficients[axis], self.lanes)
    }

    /// Cycles to read `count` voxels that are `step` apart: each module gives one a cycle, so the fullest module
    /// sets the time. 1 is free of conflicts.
    pub fn cycles(&self, step: [i64; 3], count: usize) -> usize {
        let stride = self.module(step) as i64;
        count.div_ceil(self.lanes / gcd(stride, self.lanes))
    }

    /// Cycles to read a whole beam of `count` voxels along `axis`, `lanes` voxels at a time.
    pub fn beam_cycles(&self, axis: usize, count: usize) -> usize {
        let mut step = [0; 3];
        step[axis] = 1;
        let (full, rest) = (count / self.lanes, count % self.lanes);
        full * self.cycles(step, self.lanes) + if rest > 0 { self.cycles(step, rest) } else { 0 }
    }
}

/// The voxels of a beam, or of the part of it that a section of ray slots has, in the steps in which they are read: in each as many of
/// the next ones as are in different modules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Steps {
    /// Neighbouring voxels that are in different modules; the next one is in the module of the first.
    together: usize,
    /// Voxels: before the step in which the first range ends, in that step, in it of the second range, and behind it.
    first: usize,
    start: usize,
    whole: usize,
    rest: usize,
    joined: usize,
    second: usize,
}

impl Steps {
    /// The steps of the voxels of one range of a beam, or of two, the first of which goes to the beam's end and the second begins at its
    /// start. `together` neighbours are in different modules.
    pub fn new(together: usize, columns: &[Range<usize>; 2]) -> Steps {
        let rest = columns[0].len() % together;
        // Of the second range those come with the rest of the first that are in no module of it.
        let taken = (columns[0].end - rest) % together;
        let free = if rest == 0 || taken == 0 || taken + rest > together { 0 } else { taken };
        Steps::with_room(together, columns, free)
    }

    /// The same where any `together` voxels come in a step.
    pub fn from_buffer(together: usize, columns: &[Range<usize>; 2]) -> Steps {
        let rest = columns[0].len() % together;
        Steps::with_room(together, columns, if rest == 0 { 0 } else { together - rest })
    }

    /// `free` voxels of the second range may come with the rest of the first.
    fn with_room(together: usize, columns: &[Range<usize>; 2], free: usize) -> Steps {
        let [first, second] = columns.clone().map(|columns| columns.len());
        Steps {
            together,
            first,
            start: columns[0].start,
            whole: first / together,
            rest: first % together,
            joined: free.min(second),
            second,
        }
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.whole + usize::from(self.rest > 0) + (self.second - self.joined).div_ceil(self.together)
    }

    /// The voxels of a step.
    pub fn voxels(&self, step: usize) -> [Range<usize>; 2] {
        let end = self.start + self.first;
        if step < self.whole {
            let first = self.start + step * self.together;
            return [first..first + self.together, 0..0];
        }
        if step == self.whole && self.rest > 0 {
            return [end - self.rest..end, 0..self.joined];
        }
        let behind = step - self.whole - usize::from(self.rest > 0);
        let first = self.joined + behind * self.together;
        [first..self.second.min(first + self.together), 0..0]
    }
}

/// Where the voxels of a volume lie in their modules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Placement {
    /// The modules.
    pub skew: Skew,
    /// The order of the words of a module.
    pub layout: Layout,
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
}

impl Placement {
    /// Words of a module along a side of a block. Voxels along y and z of a block of mini-blocks.
    pub const BLOCK_SIDE: usize = 8;
    /// Voxels along a side of a mini-block.
    pub const MINI: usize = 2;
    /// Words of a mini-block.
    pub const MINI_WORDS: usize = Self::MINI.pow(3);
    /// Words that a module holds of a block of mini-blocks.
    pub const MINI_BLOCK_WORDS: usize = (Self::BLOCK_SIDE / Self::MINI).pow(2) * Self::MINI_WORDS;

    /// The module of a voxel: that of the skew, with mini-blocks of the mini-block's coordinates.
    pub fn module(&self, xyz: [usize; 3]) -> usize {
        self.module_wires(xyz, &mut ())
    }

    /// [`Placement::module`], and what its wires carry.
    pub fn module_wires(&self, xyz: [usize; 3], probe: &mut impl Probe) -> usize {
        let side = if self.layout == Layout::MiniBlocks { Self::MINI } else { 1 };
        self.skew.module_wires(xyz.map(|i| (i / side) as i64), probe)
    }

    /// Voxels along x, y, z of a block of mini-blocks: `lanes` mini-blocks along x, four along y and z.
    fn mini_block(&self) -> [usize; 3] {
        [Self::MINI * self.skew.lanes, Self::BLOCK_SIDE, Self::BLOCK_SIDE]
    }

    /// Blocks of mini-blocks along x, y, z.
    fn mini_blocks(&self) -> [usize; 3] {
        let block = self.mini_block();
        [0, 1, 2].map(|axis| self.dims[axis].div_ceil(block[axis]))
    }

    /// With mini-blocks, which block along an axis a coordinate is in: the sum over the axes, modulo the banks, is the bank.
    pub fn block(&self, axis: usize, coordinate: usize) -> usize {
        coordinate / self.mini_block()[axis]
    }

    /// With mini-blocks, what a coordinate adds to the word of its bank, of `banks`. Along x every `banks`th block is in a bank, and these
    /// are numbered without gaps: blocks of a bank behind one another, 128 words each.
    pub fn bank_term(&self, axis: usize, coordinate: usize, banks: usize) -> usize {
        let [bx, by, _] = self.mini_blocks();
        let block = self.block(axis, coordinate);
        let number = [block / banks, block * bx.div_ceil(banks), block * bx.div_ceil(banks) * by][axis];
        number * Self::MINI_BLOCK_WORDS + self.word_in_block(axis, coordinate)
    }

    /// What a coordinate adds to the word within its block of mini-blocks: those of a mini-block side by side, of mini-blocks along y,
    /// then z. Along x a block has one mini-block of each module.
    fn word_in_block(&self, axis: usize, coordinate: usize) -> usize {
        let (side, mini) = (Self::BLOCK_SIDE / Self::MINI, coordinate / Self::MINI);
        let voxel = coordinate % Self::MINI * Self::MINI.pow(axis as u32);
        voxel + Self::MINI_WORDS * [0, mini % side, mini % side * side][axis]
    }

    /// Words of a module along x, y and z: those of a row of voxels, rows, planes.
    pub fn extent(&self) -> [usize; 3] {
        let [nx, ny, nz] = self.dims;
        [nx.div_ceil(self.skew.lanes) * self.skew.depth(), ny, nz]
    }

    /// Which of its module's words along an axis a voxel is.
    fn index(&self, axis: usize, coordinate: usize) -> usize {
        let (lanes, depth) = (self.skew.lanes, self.skew.depth());
        if axis == 0 { coordinate / lanes * depth + coordinate % lanes / (lanes / depth) } else { coordinate }
    }

    /// What a coordinate adds to the address. The address of a voxel is the sum over its three.
    ///
    /// Rows: `x' + n_x'·(y + n_y·z)`, with x' the word within the row. Blocks of B_x·B_y·B_z words, B the smaller of 8 and the
    /// extent: the block's number times its words, and then the same formula within the block. Mini-blocks: the block's number times 128,
    /// and the word within the block.
    pub fn term(&self, axis: usize, coordinate: usize) -> usize {
        let (index, extent) = (self.index(axis, coordinate), self.extent());
        let weight = |sides: [usize; 3]| -> usize { sides[..axis].iter().product() };
        match self.layout {
            Layout::Rows => index * weight(extent),
            Layout::Blocks => {
                let block = extent.map(|n| n.min(Self::BLOCK_SIDE));
                let blocks = [0, 1, 2].map(|a| extent[a].div_ceil(block[a]));
                let words: usize = block.iter().product();
                index / block[axis] * weight(blocks) * words + index % block[axis] * weight(block)
            }
            Layout::MiniBlocks => {
                let number = self.block(axis, coordinate) * weight(self.mini_blocks());
                number * Self::MINI_BLOCK_WORDS + self.word_in_block(axis, coordinate)
            }
        }
    }

    /// The address of a voxel within its module. No two voxels of a module share one.
    pub fn address(&self, xyz: [usize; 3]) -> usize {
        self.address_wires(xyz, &mut ())
    }

    /// [`Placement::address`], and what its wires carry.
    pub fn address_wires(&self, xyz: [usize; 3], probe: &mut impl Probe) -> usize {
        let terms = [0, 1, 2].map(|axis| self.term(axis, xyz[axis]));
        let address = terms.iter().sum();
        (0..3).for_each(|axis| probe.wire("term", axis, terms[axis] as i128));
        probe.wire("address", 0, address as i128);
        address
    }

    /// Words of each module, blocks filled up to whole ones.
    pub fn words(&self) -> usize {
        let extent = self.extent();
        match self.layout {
            Layout::Rows => extent.iter().product(),
            Layout::Blocks => extent.iter().map(|n| n.next_multiple_of((*n).clamp(1, Self::BLOCK_SIDE))).product(),
            Layout::MiniBlocks => self.mini_blocks().iter().product::<usize>() * Self::MINI_BLOCK_WORDS,
        }
    }
}

/// The lane of the output register that voxel (u, v, w) of a beam along u is put into: `(u + v + w) mod lanes`.
///
/// Forwards along x, y, z that is the voxel's module in the paper's skew. Against an axis, the output network
/// turns the beam, and mirrors it where u itself is reversed.
pub fn output_lane(lanes: usize, uvw: [usize; 3]) -> usize {
    (uvw[0] + uvw[1] + uvw[2]) % lanes
}

/// The row of the volume that plane `plane` of ray slots has at a depth.
#[inline(always)]
pub fn row(geometry: &Geometry, plane: u32, depth: u32) -> Option<u32> {
    if let Some(pass) = &geometry.perspective {
        return u32::try_from(pass.v.near(plane as usize, depth as usize))
            .ok()
            .filter(|&row| row < geometry.size[1] as u32);
    }
    let rows = geometry.size[1] as u32;
    let shift = geometry.v.columns[depth as usize];
    match geometry.slots {
        // Mostly no division is needed, which takes longer than all else of a cycle.
        RaySlots::Wrapped => Some(match plane + shift {
            row if row < rows => row,
            row if row < 2 * rows => row - rows,
            row => row % rows,
        }),
        RaySlots::Padded => (plane + shift).checked_sub(geometry.shear_v() as u32).filter(|&row| row < rows),
    }
}
