//! The addressing of one voxel, and how many cycles a row of voxels takes. The definition.

/// The skewed memory: voxel (x, y, z) of a volume `dims` is in module `(a·x + b·y + c·z) mod lanes`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Skew {
    /// Coefficients a, b, c.
    pub coefficients: [i64; 3],
    /// Modules.
    pub lanes: usize,
}

/// Greatest common divisor; `gcd(0, n) = n`.
pub fn gcd(a: i64, n: usize) -> usize {
    let (mut a, mut b) = (a.unsigned_abs() as usize, n);
    while a != 0 {
        (a, b) = (b % a, a);
    }
    b
}

impl Skew {
    /// The module of a voxel, or of a displacement between voxels.
    pub fn module(&self, xyz: [i64; 3]) -> usize {
        let sum: i64 = (0..3).map(|i| self.coefficients[i] * xyz[i]).sum();
        sum.rem_euclid(self.lanes as i64) as usize
    }

    /// Words that a module holds of each row of `lanes` voxels along x: 1 where a and the modules share no factor.
    pub fn depth(&self) -> usize {
        gcd(self.coefficients[0], self.lanes)
    }

    /// The address of a voxel within its module. No two voxels of a module share one.
    pub fn address(&self, dims: [usize; 3], xyz: [usize; 3]) -> usize {
        let rows = dims[0].div_ceil(self.lanes);
        let row = (xyz[2] * dims[1] + xyz[1]) * rows + xyz[0] / self.lanes;
        row * self.depth() + xyz[0] % self.lanes / (self.lanes / self.depth())
    }

    /// Words of each module for a volume.
    pub fn words(&self, dims: [usize; 3]) -> usize {
        dims[2] * dims[1] * dims[0].div_ceil(self.lanes) * self.depth()
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

/// The lane of the output register that voxel (u, v, w) of a beam along u is put into: `(u + v + w) mod lanes`.
///
/// Forwards along x, y, z that is the voxel's module in the paper's skew. Against an axis, the output network
/// turns the beam, and mirrors it where u itself is reversed.
pub fn output_lane(lanes: usize, uvw: [usize; 3]) -> usize {
    (uvw[0] + uvw[1] + uvw[2]) % lanes
}
