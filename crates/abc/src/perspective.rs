//! What the lanes need of each ray and depth of a perspective frame.

use crate::golden::{halfway, view_vector};
use cube3_frame::{FrameSetup, Normaliser, Phong, RayRegisters};
use cube3_word::{LaneBlock, Words};
use std::ops::Range;

/// Weights and factors of a block of gradients, by lane; see [`crate::golden::Local`].
#[derive(Clone, Debug, Default)]
pub struct LocalBlock {
    /// Along u and v; see [`crate::golden::Local::here`].
    pub here: [LaneBlock<i32>; 2],
    /// See [`crate::golden::Local::behind`].
    pub behind: [LaneBlock<i32>; 2],
    /// See [`crate::golden::Local::before`].
    pub before: [LaneBlock<i32>; 2],
    /// Of the three components.
    pub factors: [LaneBlock<i32>; 3],
    /// Absent where rays are nowhere less than a voxel apart.
    pub nearness: Option<LaneBlock<u32>>,
}

/// The registers of rays, and what has been made of them for the rays aimed at.
#[derive(Clone, Debug)]
pub(crate) struct RayLanes {
    registers: RayRegisters,
    weight_bits: u32,
    /// Numbers of the first ray along u and v.
    first: [i64; 2],
    /// How many rays run against u and against v; the others follow.
    turns: [i64; 2],
    /// The first plane behind an eye in the volume.
    first_plane: Option<i64>,
    /// The first ray aimed at.
    aimed: i64,
    view: [Vec<i32>; 3],
    /// Halfway to each light that is not at the eye; nothing for others.
    halfway: Vec<[Vec<i32>; 3]>,
}

impl RayLanes {
    pub fn new(setup: &FrameSetup) -> Option<RayLanes> {
        let (pass, registers) = (setup.geometry.perspective.as_ref()?, setup.rays.as_ref()?);
        let first = [pass.u.first, pass.v.first];
        Some(RayLanes {
            registers: registers.clone(),
            weight_bits: setup.words.weight_bits,
            first,
            turns: [first[0] + pass.u.turn() as i64, first[1] + pass.v.turn() as i64],
            first_plane: Some(pass.first_depth as i64).filter(|&first| first > 0),
            aimed: 0,
            view: Default::default(),
            halfway: vec![Default::default(); registers.at_eye.len()],
        })
    }

    /// View vectors and halfway vectors of rays of a plane.
    pub fn aim(&mut self, v: i64, us: Range<i64>, phong: Option<&Phong>, table: Option<&Normaliser>, words: &Words) {
        self.aimed = us.start;
        for row in self.view.iter_mut().chain(self.halfway.iter_mut().flatten()) {
            row.clear();
        }
        let (Some(phong), Some(table)) = (phong, table) else {
            return;
        };
        let row = (v - self.first[1]) as usize;
        for u in us {
            let view = view_vector(row, (u - self.first[0]) as usize, &self.registers, table, words);
            for (out, word) in self.view.iter_mut().zip(view) {
                out.push(word);
            }
            let lights = phong.lights.iter().zip(&self.registers.at_eye);
            for (out, (light, _)) in self.halfway.iter_mut().zip(lights).filter(|(_, (_, at_eye))| !**at_eye) {
                for (out, word) in out.iter_mut().zip(halfway(light.direction, view, table, words)) {
                    out.push(word);
                }
            }
        }
    }

    pub fn has_classes(&self) -> bool {
        self.registers.length_classes > 1
    }

    #[inline(always)]
    fn slot(&self, [u, v, _]: [i64; 3]) -> [usize; 2] {
        [(u - self.first[0]) as usize, (v - self.first[1]) as usize]
    }

    /// The class of a ray's step length.
    #[inline(always)]
    pub fn class(&self, at: [i64; 3]) -> u32 {
        let [column, row] = self.slot(at);
        self.registers.length_class(row, column)
    }

    /// Whether a ray runs against u and against v.
    #[inline(always)]
    pub fn mirrored(&self, [u, v, _]: [i64; 3]) -> [bool; 2] {
        [u < self.turns[0], v < self.turns[1]]
    }

    /// Whether a sample is on the first plane behind an eye in the volume; see [`crate::golden::behind_the_eye`].
    #[inline(always)]
    pub fn is_first(&self, [_, _, k]: [i64; 3]) -> bool {
        self.first_plane == Some(k)
    }

    /// Weights and factors of some lanes of a block.
    #[inline(always)]
    pub fn local(&self, lanes: Range<usize>, at: impl Fn(usize) -> [i64; 3] + Copy, out: &mut LocalBlock) {
        let registers = &self.registers;
        let last = registers.closeness.len() - 1;
        out.nearness = registers.nearness.as_ref().map(|_| out.nearness.unwrap_or_default());
        for lane in lanes {
            let [column, row] = self.slot(at(lane));
            let k = at(lane)[2] as usize;
            let slopes = [registers.slope_u[column], registers.slope_v[row]];
            let weigh = |out: &mut [LaneBlock<i32>; 2], k: usize| {
                for (out, slope) in out.iter_mut().zip(slopes) {
                    out[lane] = RayRegisters::shear(slope, registers.closeness[k], self.weight_bits) as i32;
                }
            };
            weigh(&mut out.here, k);
            weigh(&mut out.behind, (k + 1).min(last));
            weigh(&mut out.before, k.saturating_sub(1));
            for (out, factor) in out.factors.iter_mut().zip(registers.factors[k]) {
                out[lane] = factor as i32;
            }
            if let (Some(out), Some(nearness)) = (&mut out.nearness, &registers.nearness) {
                out[lane] = nearness[k];
            }
        }
    }

    /// Towards light `number`, and halfway between it and the eye, for the first `count` lanes of a block.
    #[inline(always)]
    pub fn towards(
        &self,
        number: usize,
        direction: [i32; 3],
        count: usize,
        at: impl Fn(usize) -> [i64; 3] + Copy,
        [light, half]: &mut [[LaneBlock<i32>; 3]; 2],
    ) {
        let at_eye = self.registers.at_eye[number];
        let halfway = if at_eye { &self.view } else { &self.halfway[number] };
        for lane in 0..count {
            let ray = (at(lane)[0] - self.aimed) as usize;
            for i in 0..3 {
                half[i][lane] = halfway[i][ray];
                light[i][lane] = if at_eye { half[i][lane] } else { direction[i] };
            }
        }
    }
}
