//! The numbers of a file in blocks, the next one unpacked by a thread of its own while one is put in its place.

use std::sync::mpsc::{channel, sync_channel};

use bytemuck::allocation::try_zeroed_vec;
use bytemuck::cast_slice_mut;

use crate::VolumeError;
use crate::parts::Parts;

/// Consecutive numbers of the file that are a box of the stored grid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub from: [usize; 3],
    pub size: [usize; 3],
}

impl Block {
    fn len(&self) -> usize {
        self.size.iter().product()
    }
}

/// The stored grid in blocks of at most `most` numbers (at least one): parts of a row, rows of a slice, or slices.
fn blocks([nx, ny, nz]: [usize; 3], most: usize) -> impl Iterator<Item = Block> + Send {
    let i = most.clamp(1, nx);
    let j = if i == nx { (most / nx).clamp(1, ny) } else { 1 };
    let k = if j == ny { (most / (nx * ny)).clamp(1, nz) } else { 1 };
    let starts = |n: usize, step: usize| (0..n).step_by(step);
    starts(nz, k).flat_map(move |z| {
        starts(ny, j).flat_map(move |y| {
            starts(nx, i).map(move |x| Block { from: [x, y, z], size: [i.min(nx - x), j.min(ny - y), k.min(nz - z)] })
        })
    })
}

/// Takes a block and its numbers.
type Put<'a> = &'a mut dyn FnMut(&Block, &[u8]) -> Result<(), VolumeError>;

/// How a grid is read in blocks.
pub(crate) struct Blocks {
    /// Voxels along the stored axes, fastest first.
    pub dims: [usize; 3],
    /// Bytes of a number.
    pub size: usize,
    /// Bytes of a block at most, but for a single number.
    pub bytes: usize,
    /// Volumes that lie voxel by voxel.
    pub volumes: usize,
    /// Which of them is read.
    pub frame: usize,
}

impl Blocks {
    /// Gives each block to `put` with its numbers, which are aligned for numbers of 8 bytes; `no_room` is the error where so many bytes
    /// cannot be had.
    pub fn read(
        &self,
        mut parts: Parts,
        no_room: &dyn Fn(usize) -> VolumeError,
        put: Put<'_>,
    ) -> Result<(), VolumeError> {
        let most = self.bytes / self.size / self.volumes;
        let all = || blocks(self.dims, most);
        let largest = all().next().map_or(0, |block| block.len()) * self.volumes * self.size;
        let room = || try_zeroed_vec::<u64>(largest.div_ceil(8)).map_err(|_| no_room(largest));
        if all().nth(1).is_none() {
            let mut buffer = room()?;
            for block in all() {
                put(&block, self.fill(&mut parts, &block, &mut buffer)?)?;
            }
            return parts.finish();
        }
        let (filled, full) = sync_channel::<(Block, Vec<u64>)>(1);
        let (emptied, empty) = channel();
        for buffer in [room()?, room()?] {
            let _ = emptied.send(buffer);
        }
        std::thread::scope(|scope| {
            let filler = scope.spawn(move || {
                for block in all() {
                    // Both ends go away only where the other has failed.
                    let Ok(mut buffer) = empty.recv() else { return Ok(()) };
                    self.fill(&mut parts, &block, &mut buffer)?;
                    if filled.send((block, buffer)).is_err() {
                        return Ok(());
                    }
                }
                parts.finish()
            });
            let placed = full.into_iter().try_for_each(|(block, buffer)| {
                put(&block, &bytemuck::cast_slice(&buffer)[..block.len() * self.size])?;
                let _ = emptied.send(buffer);
                Ok(())
            });
            drop(emptied);
            let filled = filler.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
            placed.and(filled)
        })
    }

    /// The numbers of a block, of the volume that is read.
    fn fill<'a>(&self, parts: &mut Parts, block: &Block, buffer: &'a mut [u64]) -> Result<&'a [u8], VolumeError> {
        let numbers: &mut [u8] = cast_slice_mut(buffer);
        let count = block.len();
        parts.fill(&mut numbers[..count * self.volumes * self.size])?;
        if self.volumes > 1 {
            match self.size {
                1 => self.gather::<1>(numbers, count),
                2 => self.gather::<2>(numbers, count),
                4 => self.gather::<4>(numbers, count),
                _ => self.gather::<8>(numbers, count),
            }
        }
        Ok(&numbers[..count * self.size])
    }

    fn gather<const SIZE: usize>(&self, numbers: &mut [u8], count: usize) {
        let (numbers, _) = numbers.as_chunks_mut::<SIZE>();
        for i in 0..count {
            numbers[i] = numbers[i * self.volumes + self.frame];
        }
    }
}
