//! Where mini-blocks lie: what each coordinate adds to a place, and how rows of them go round the modules.

use crate::golden::{Placement, gcd};
use serde::{Deserialize, Serialize};

/// What a coordinate adds to the place of a mini-block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Mini {
    /// To the word of the module.
    pub address: u64,
    /// To the word of the bank.
    pub word: u64,
    /// To the bank.
    pub block: u64,
    /// To the module.
    pub module: u64,
}

impl Mini {
    /// All mini-blocks along an axis.
    pub fn all(placement: &Placement, axis: usize, banks: usize) -> Vec<Mini> {
        let mini = |voxel: usize| {
            let mut xyz = [0; 3];
            xyz[axis] = voxel;
            Mini {
                address: placement.term(axis, voxel) as u64,
                word: placement.bank_term(axis, voxel, banks) as u64,
                block: placement.block(axis, voxel) as u64,
                module: placement.module(xyz) as u64,
            }
        };
        (0..placement.dims[axis]).step_by(Placement::MINI).map(mini).collect()
    }

    /// What both add.
    pub fn plus(self, other: Mini) -> Mini {
        Mini {
            address: self.address + other.address,
            word: self.word + other.word,
            block: self.block + other.block,
            module: self.module + other.module,
        }
    }
}

/// How a row of mini-blocks goes round the modules: `stride` modules further each, back at the first after `period`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub stride: usize,
    pub period: usize,
    /// Of stride / gcd modulo the period.
    inverse: usize,
}

impl Round {
    /// Rows whose mini-blocks are `stride` modules apart.
    pub fn new(stride: i64, lanes: usize) -> Round {
        let stride = stride.rem_euclid(lanes as i64) as usize;
        let shared = gcd(stride as i64, lanes);
        let period = lanes / shared;
        let inverse = (0..period).find(|i| i * (stride / shared) % period == 1 % period).unwrap_or(0);
        Round { stride, period, inverse }
    }

    /// The first mini-block of a row that is in module `module`, where the row's first is in module `start`; all others are `period` apart.
    pub fn first(&self, lanes: usize, start: usize, module: usize) -> Option<usize> {
        let (distance, shared) = ((module + lanes - start) % lanes, lanes / self.period);
        distance.is_multiple_of(shared).then(|| distance / shared * self.inverse % self.period)
    }
}
