//! The modules with their voxels, and the fetch of a whole beam.

use crate::golden::{Placement, Skew, output_lane};
use cube3_frame::Axes;
use cube3_machine::Layout;
use cube3_word::turn;
use std::ops::Range;

/// The cubic frame buffer with a volume in it.
#[derive(Clone, Debug)]
pub struct FrameBuffer {
    placement: Placement,
    /// What each coordinate adds to the address and to the number of the module, for x, y, z.
    terms: [Vec<Term>; 3],
    /// Whether a beam along x, y, z that is not reversed is whole rows of words, turned.
    turns: [bool; 3],
    /// Chunks of lanes of a beam along x, y, z.
    chunks: [usize; 3],
    /// Words by address, those of all modules at an address side by side.
    modules: Vec<u16>,
    /// The other half of a double buffer.
    back: Option<Vec<u16>>,
    /// Volumes that come in, one behind another.
    incoming: Vec<Vec<u16>>,
}

/// What a coordinate adds.
#[derive(Clone, Copy, Debug)]
struct Term {
    address: usize,
    /// Below the number of modules.
    module: usize,
}

/// Whether each whole chunk of lanes of a beam has one address, and each voxel the module behind that of the one before.
fn turns(lanes: usize, terms: &[Term]) -> bool {
    let by_one = terms.get(1).is_some_and(|term| term.module == 1);
    by_one && terms.chunks_exact(lanes).all(|chunk| chunk.iter().all(|term| term.address == chunk[0].address))
}

/// A frame buffer that cannot be built.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameBufferError {
    /// A skew that leaves most of every module empty, on a large volume.
    #[error(
        "the frame buffer would take {bytes} bytes, above the limit of {limit}: the skew uses only every {depth}th module along x, \
         and blocks are filled up to whole ones; choose a skew whose first coefficient shares no factor with the lanes, the layout \
         \"rows\", or a smaller volume"
    )]
    Memory {
        /// Bytes that it would take.
        bytes: u128,
        /// Bytes that it may take.
        limit: u128,
        /// Words of a module for each row.
        depth: usize,
    },
}

impl FrameBuffer {
    /// Most bytes of module memory.
    pub const LIMIT_BYTES: u128 = 8 << 30;

    /// Writes a volume (x fastest) into the modules, rows behind one another.
    ///
    /// # Errors
    /// A skew and volume that would take too much memory.
    pub fn new(skew: Skew, dims: [usize; 3], voxels: &[u16]) -> Result<FrameBuffer, FrameBufferError> {
        FrameBuffer::with_layout(skew, Layout::Rows, dims, voxels)
    }

    /// Writes a volume (x fastest) into the modules in the order of a layout.
    ///
    /// # Errors
    /// A skew, layout and volume that would take too much memory.
    pub fn with_layout(
        skew: Skew,
        layout: Layout,
        dims: [usize; 3],
        voxels: &[u16],
    ) -> Result<FrameBuffer, FrameBufferError> {
        let placement = Placement { skew, layout, dims };
        let words = placement.words();
        let bytes = 2 * words as u128 * skew.lanes as u128;
        if bytes > Self::LIMIT_BYTES {
            return Err(FrameBufferError::Memory { bytes, limit: Self::LIMIT_BYTES, depth: skew.depth() });
        }
        let term = |axis: usize, i: usize| {
            let mut xyz = [0; 3];
            xyz[axis] = i;
            Term { address: placement.term(axis, i), module: placement.module(xyz) }
        };
        let terms: [Vec<Term>; 3] = [0, 1, 2].map(|axis| (0..dims[axis]).map(|i| term(axis, i)).collect());
        let modules = vec![0; words * skew.lanes];
        let mut buffer = FrameBuffer {
            placement,
            turns: [0, 1, 2].map(|axis| turns(skew.lanes, &terms[axis])),
            chunks: dims.map(|n| n.div_ceil(skew.lanes)),
            terms,
            modules,
            back: None,
            incoming: Vec::new(),
        };
        let mut voxel = voxels.iter();
        for z in 0..dims[2] {
            for y in 0..dims[1] {
                for x in 0..dims[0] {
                    let place = buffer.place([x, y, z]);
                    buffer.modules[place] = voxel.next().copied().unwrap_or(0);
                }
            }
        }
        Ok(buffer)
    }

    /// Sets the volumes (x fastest) that come in while frames are read, into the modules that are read or into a `double` buffer's other half.
    pub fn receive(&mut self, volumes: Vec<Vec<u16>>, double: bool) {
        self.back = double.then(|| self.modules.clone());
        self.incoming = volumes;
    }

    /// Writes words of the volumes that come in, counted from the first word of the first. Words that are not there are not written.
    pub fn write(&mut self, words: Range<u64>) {
        let [nx, ny, nz] = self.placement.dims;
        let voxels = (nx * ny * nz) as u64;
        for word in words {
            let (volume, i) = ((word / voxels) as usize, (word % voxels) as usize);
            let Some(&value) = self.incoming.get(volume).and_then(|volume| volume.get(i)) else {
                continue;
            };
            let place = self.place([i % nx, i / nx % ny, i / (nx * ny)]);
            self.back.as_mut().unwrap_or(&mut self.modules)[place] = value;
        }
    }

    /// The halves of a double buffer change roles.
    pub fn swap(&mut self) {
        if let Some(back) = &mut self.back {
            std::mem::swap(back, &mut self.modules);
        }
    }

    /// The module that holds a voxel of the volume, and its word there.
    pub fn module_and_address(&self, xyz: [usize; 3]) -> [usize; 2] {
        let Term { address, module } = self.term(xyz);
        [module, address]
    }

    /// Address and module of a voxel.
    #[inline]
    fn term(&self, [x, y, z]: [usize; 3]) -> Term {
        let [x, y, z] = [self.terms[0][x], self.terms[1][y], self.terms[2][z]];
        let lanes = self.placement.skew.lanes;
        let mut module = x.module + y.module + z.module;
        while module >= lanes {
            module -= lanes;
        }
        Term { address: x.address + y.address + z.address, module }
    }

    fn place(&self, xyz: [usize; 3]) -> usize {
        let Term { address, module } = self.term(xyz);
        address * self.placement.skew.lanes + module
    }

    /// Reads the beam along u at row `v` and plane `w` into lane order: voxel u of the beam goes to
    /// `u / lanes · lanes + (u + v + w) mod lanes`. Unused lanes are 0.
    pub fn fetch(&self, axes: &Axes, v: usize, w: usize, beam: &mut Vec<u16>) {
        let [along, axis_v, axis_w] = axes.axis;
        let dims = self.placement.dims;
        let (n, lanes) = (dims[along], self.placement.skew.lanes);
        beam.resize(self.chunks[along] * lanes, 0);
        let from = |reversed: bool, i: usize, n: usize| if reversed { n - 1 - i } else { i };
        let mut start = [0; 3];
        start[axis_v] = from(axes.reversed[1], v, dims[axis_v]);
        start[axis_w] = from(axes.reversed[2], w, dims[axis_w]);
        let rest = self.term(start);
        let lane = output_lane(lanes, [0, v, w]);
        let mut first = 0;
        if self.turns[along] && !axes.reversed[0] {
            // One address of all modules, which are turned to their lanes.
            let mut by = lane + lanes - rest.module;
            while by >= lanes {
                by -= lanes;
            }
            while first + lanes <= n {
                let row = (self.terms[along][first].address + rest.address) * lanes;
                turn(&self.modules[row..][..lanes], by, &mut beam[first..][..lanes]);
                first += lanes;
            }
        }
        if first < n {
            self.fetch_words(along, axes.reversed[0], first, rest, lane, &mut beam[first..]);
        }
    }

    /// The voxels of a beam from `first` on, word by word. `rest` is what its row and plane give to addresses and modules, `lane` that of the
    /// first voxel.
    fn fetch_words(&self, along: usize, reversed: bool, first: usize, rest: Term, mut lane: usize, beam: &mut [u16]) {
        let (n, lanes) = (self.placement.dims[along], self.placement.skew.lanes);
        let mut u = first;
        for beam in beam.chunks_mut(lanes) {
            let end = n.min(u + lanes);
            if end - u < lanes {
                beam.fill(0);
            }
            while u < end {
                let term = self.terms[along][if reversed { n - 1 - u } else { u }];
                let module = term.module + rest.module;
                let module = if module >= lanes { module - lanes } else { module };
                beam[lane] = self.modules[(term.address + rest.address) * lanes + module];
                lane = if lane + 1 == lanes { 0 } else { lane + 1 };
                u += 1;
            }
        }
    }

    /// The dims of the volume.
    pub fn dims(&self) -> [usize; 3] {
        self.placement.dims
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bitvec::prelude::*;
    use cube3_cases::cases;
    use proptest::prelude::*;
    use proptest::sample::select;

    /// Serves voxels by modules as the hardware would: in each cycle a mask of modules that are taken.
    fn served(skew: &Skew, start: [i64; 3], step: [i64; 3], count: usize) -> usize {
        let mut waiting: Vec<usize> =
            (0..count as i64).map(|i| skew.module([0, 1, 2].map(|a| start[a] + i * step[a]))).collect();
        let mut cycles = 0;
        while !waiting.is_empty() {
            let mut taken = bitvec![0; skew.lanes];
            waiting.retain(|&module| taken.replace(module, true));
            cycles += 1;
        }
        cycles
    }

    #[test]
    fn beams_along_every_axis_are_free_of_conflicts() {
        for n in 1..20 {
            let skew = Skew { coefficients: [1, 1, 1], lanes: n };
            for axis in 0..3 {
                let mut step = [0; 3];
                step[axis] = 1;
                assert_eq!(served(&skew, [3, 1, 4], step, n), 1);
                assert_eq!(skew.beam_cycles(axis, n), 1);
            }
        }
    }

    #[test]
    fn the_known_conflicts_along_the_diagonals() {
        for n in [2, 4, 8, 16, 64] {
            let skew = Skew { coefficients: [1, 1, 1], lanes: n };
            assert_eq!(served(&skew, [0; 3], [1, -1, 0], n), n, "all in one module");
            assert_eq!(served(&skew, [0; 3], [1, 1, 0], n), 2, "every second module");
            assert_eq!((skew.cycles([1, -1, 0], n), skew.cycles([1, 1, 0], n)), (n, 2));
        }
        let odd = Skew { coefficients: [1, 1, 1], lanes: 9 };
        assert_eq!(odd.cycles([1, 1, 0], 9), 1, "two and nine share no factor");
    }

    #[test]
    fn without_a_skew_a_beam_along_x_is_serial() {
        let skew = Skew { coefficients: [0, 1, 1], lanes: 8 };
        assert_eq!((skew.beam_cycles(0, 8), skew.beam_cycles(1, 8)), (8, 1));
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn cycles_are_those_of_the_fullest_module(
            lanes in 1_usize..40, coefficients: [i8; 3], step: [i8; 3], start: [i8; 3], count in 1_usize..100,
        ) {
            let skew = Skew { coefficients: coefficients.map(i64::from), lanes };
            let step = step.map(i64::from);
            prop_assert_eq!(skew.cycles(step, count), served(&skew, start.map(i64::from), step, count));
        }

        #[test]
        fn no_two_voxels_of_a_module_share_an_address(
            dims in [1_usize..30, 1_usize..20, 1_usize..20], lanes in 1_usize..12, coefficients in [-3_i64..4, -3_i64..4, -3_i64..4],
            layout in select(Layout::ALL.to_vec()),
        ) {
            prop_assume!(layout.takes(coefficients, lanes));
            let placement = Placement { skew: Skew { coefficients, lanes }, layout, dims };
            let words = placement.words();
            let buffer = FrameBuffer::with_layout(placement.skew, layout, dims, &vec![0; dims.iter().product()]).unwrap();
            let mut taken = bitvec![0; words * lanes];
            for place in 0..dims.iter().product() {
                let xyz = [place % dims[0], place / dims[0] % dims[1], place / dims[0] / dims[1]];
                let address = placement.address(xyz);
                prop_assert!(address < words);
                let module = placement.module(xyz);
                prop_assert_eq!(buffer.module_and_address(xyz), [module, address]);
                prop_assert!(!taken.replace(module * words + address, true));
            }
        }

        /// The eight voxels of a mini-block are words 8·m to 8·m + 7 of one module, x fastest; each run of `lanes` mini-blocks along x meets each
        /// module once; a module has 128 words of a block side by side; neighbouring blocks are in different banks, and the words of a bank
        /// are no others'.
        #[test]
        fn mini_blocks_lie_side_by_side_and_blocks_round_the_banks(
            dims in [1_usize..40, 1_usize..30, 1_usize..30], lanes in 1_usize..8, coefficients in [-3_i64..4, -3_i64..4, -3_i64..4],
            banks in select(vec![1_usize, 2, 4, 16]),
        ) {
            prop_assume!(Layout::MiniBlocks.takes(coefficients, lanes));
            let placement = Placement { skew: Skew { coefficients, lanes }, layout: Layout::MiniBlocks, dims };
            let sides = [2 * lanes, 8, 8];
            let mut of_bank = std::collections::HashMap::new();
            for place in 0..dims.iter().product() {
                let xyz = [place % dims[0], place / dims[0] % dims[1], place / dims[0] / dims[1]];
                let (module, address) = (placement.module(xyz), placement.address(xyz));
                let first = xyz.map(|i| i / 2 * 2);
                prop_assert_eq!(placement.module(first), module);
                prop_assert_eq!(placement.address(first) % 8, 0);
                prop_assert_eq!(address - placement.address(first), xyz[0] % 2 + 2 * (xyz[1] % 2) + 4 * (xyz[2] % 2));
                let [i, j] = [xyz[1] / 2 % 4, xyz[2] / 2 % 4];
                prop_assert_eq!(placement.address(first) % 128, 8 * i + 32 * j);
                let blocks = [0, 1, 2].map(|axis| dims[axis].div_ceil(sides[axis]));
                let block = [0, 1, 2].map(|axis| xyz[axis] / sides[axis]);
                prop_assert_eq!(address / 128, block[0] + blocks[0] * (block[1] + blocks[1] * block[2]));
                for ahead in 1..lanes {
                    prop_assert!(placement.module([xyz[0] + 2 * ahead, xyz[1], xyz[2]]) != module);
                }
                let bank = |xyz: [usize; 3]| (0..3).map(|axis| placement.block(axis, xyz[axis])).sum::<usize>() % banks;
                for (axis, side) in sides.into_iter().enumerate() {
                    let mut next = xyz;
                    next[axis] += side;
                    prop_assert!(banks == 1 || bank(next) != bank(xyz));
                }
                let word: usize = (0..3).map(|axis| placement.bank_term(axis, xyz[axis], banks)).sum();
                prop_assert_eq!(word % 128, address % 128);
                let before = of_bank.insert((module, bank(xyz), word), address);
                prop_assert_eq!(before, None);
            }
        }

        #[test]
        fn every_voxel_has_its_own_place_and_comes_back(
            dims in [1_usize..11, 1_usize..11, 1_usize..11], lanes in 1_usize..10, coefficients in [-3_i64..4, -3_i64..4, -3_i64..4],
            order in Just([0_usize, 1, 2]).prop_shuffle(), reversed: [bool; 3], layout in select(Layout::ALL.to_vec()),
        ) {
            prop_assume!(layout.takes(coefficients, lanes));
            let voxels: Vec<u16> = (1..=dims.iter().product::<usize>() as u16).collect();
            let skew = Skew { coefficients, lanes };
            let buffer = FrameBuffer::with_layout(skew, layout, dims, &voxels).unwrap();
            let axes = Axes { axis: order, reversed };
            let size = axes.permute(dims);
            let mut beam = Vec::new();
            for w in 0..size[2] {
                for v in 0..size[1] {
                    buffer.fetch(&axes, v, w, &mut beam);
                    for u in 0..size[0] {
                        let xyz = axes.voxel(size, [u, v, w]);
                        let lane = (u + v + w) % lanes;
                        let expected = voxels[xyz[0] + dims[0] * (xyz[1] + dims[1] * xyz[2])];
                        prop_assert_eq!(beam[u / lanes * lanes + lane], expected);
                    }
                    // No lane keeps what the beam before left in it, and there is no voxel 0.
                    prop_assert_eq!(beam.iter().filter(|&&word| word != 0).count(), size[0]);
                    beam.fill(u16::MAX);
                }
            }
        }
    }
}
