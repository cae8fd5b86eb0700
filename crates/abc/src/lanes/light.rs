//! Light on a block: Phong's formula, and colours in the light.

use super::around::blocks;
use cube3_frame::{Phong, PhongLight, ReflectanceTable};
use cube3_word::{BLOCK_LANES, LaneBlock, Shift, Words, put_block, unit_full, vectorised};

/// Light, ready for blocks.
#[derive(Clone, Debug)]
pub(super) enum ShadingLanes {
    Phong(PhongLanes),
    Table(ReflectanceTable),
}

/// The direction of a light, and halfway between it and the eye, for each lane of a block.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(super) struct Towards(pub(super) [[LaneBlock<i32>; 3]; 2]);

/// Colours in the light: `min(round(colour · diffuse) + specular, 1)`, and how many words of each lane were saturated, added to what
/// is there; see [`crate::golden::lit`].
#[inline(always)]
pub(super) fn lit(
    diffuse: &[LaneBlock<u32>; 3],
    specular: &[LaneBlock<u32>; 3],
    words: &Words,
    colour: &mut [LaneBlock<u32>; 3],
    overflow: &mut LaneBlock<u32>,
) {
    // 8 lights of 15 and an ambient of 15 stay below 2^(colour_bits + 8).
    if 2 * words.colour_bits + 8 <= 32 {
        lit_in::<true>(diffuse, specular, words, colour, overflow);
    } else {
        lit_in::<false>(diffuse, specular, words, colour, overflow);
    }
}

#[inline(always)]
fn lit_in<const NARROW: bool>(
    diffuse: &[LaneBlock<u32>; 3],
    specular: &[LaneBlock<u32>; 3],
    words: &Words,
    [red, green, blue]: &mut [LaneBlock<u32>; 3],
    overflow: &mut LaneBlock<u32>,
) {
    let full = unit_full(words.colour_bits);
    let shift = words.rounding.by(words.colour_bits);
    let one = |colour: u32, diffuse: u32, specular: u32| {
        let reflected = if NARROW {
            (colour * diffuse + shift.half as u32) >> shift.bits
        } else {
            ((u64::from(colour) * u64::from(diffuse) + shift.half as u64) >> shift.bits) as u32
        };
        reflected + specular
    };
    for i in 0..BLOCK_LANES {
        let sums = [
            one(red[i], diffuse[0][i], specular[0][i]),
            one(green[i], diffuse[1][i], specular[1][i]),
            one(blue[i], diffuse[2][i], specular[2][i]),
        ];
        overflow[i] += u32::from(sums[0] > full) + u32::from(sums[1] > full) + u32::from(sums[2] > full);
        red[i] = sums[0].min(full);
        green[i] = sums[1].min(full);
        blue[i] = sums[2].min(full);
    }
}

/// Phong's formula for the lights of a frame.
#[derive(Clone, Debug)]
pub(super) struct PhongLanes {
    pub(super) registers: Phong,
    words: Words,
    pub(super) lights: Vec<Towards>,
    /// Whether products and sums stay in 32 bits.
    narrow: bool,
}

impl PhongLanes {
    pub(super) fn new(phong: &Phong, words: &Words) -> PhongLanes {
        let splat = |direction: [i32; 3]| direction.map(|component| [component; BLOCK_LANES]);
        PhongLanes {
            registers: phong.clone(),
            words: *words,
            lights: phong.lights.iter().map(|light| Towards([splat(light.direction), splat(light.halfway)])).collect(),
            narrow: words.colour_bits + 3 + words.normal_bits <= 31 && 2 * words.colour_bits + 4 <= 31,
        }
    }

    /// The light that comes from everywhere.
    #[inline(always)]
    pub(super) fn begin(&self, diffuse: &mut [LaneBlock<u32>; 3], specular: &mut [LaneBlock<u32>; 3]) {
        *diffuse = [[self.registers.ambient; BLOCK_LANES]; 3];
        *specular = [[0; BLOCK_LANES]; 3];
    }

    /// Adds light `number`, which is `towards` each lane, and the highlight of what is halfway.
    #[inline(always)]
    pub(super) fn add(
        &self,
        number: usize,
        light: &Towards,
        direction: &[LaneBlock<i32>; 3],
        diffuse: &mut [LaneBlock<u32>; 3],
        specular: &mut [LaneBlock<u32>; 3],
    ) {
        match (self.registers.two_sided, self.narrow) {
            (false, true) => self.add_in::<false, true>(number, light, direction, diffuse, specular),
            (false, false) => self.add_in::<false, false>(number, light, direction, diffuse, specular),
            (true, true) => self.add_in::<true, true>(number, light, direction, diffuse, specular),
            (true, false) => self.add_in::<true, false>(number, light, direction, diffuse, specular),
        }
    }

    #[inline(always)]
    fn add_in<const TWO_SIDED: bool, const NARROW: bool>(
        &self,
        number: usize,
        Towards([towards, halfway]): &Towards,
        direction: &[LaneBlock<i32>; 3],
        diffuse: &mut [LaneBlock<u32>; 3],
        specular: &mut [LaneBlock<u32>; 3],
    ) {
        let PhongLanes { registers: phong, words, .. } = self;
        let PhongLight { diffuse: by_diffuse, specular: by_specular, .. } = phong.lights[number];
        let table = phong.power.as_slice();
        let Some(last) = table.len().checked_sub(1) else {
            return;
        };
        let one = 1_i32 << (words.normal_bits - 1);
        let by_cosine = words.rounding.by(words.normal_bits - 1);
        let by_index = words.rounding.by(words.normal_bits - 1 - phong.power_bits);
        let by_power = words.rounding.by(words.colour_bits);
        let weigh = |x: u32, weight: u32, shift: Shift| {
            if NARROW {
                (x * weight + shift.half as u32) >> shift.bits
            } else {
                shift.apply(i64::from(x) * i64::from(weight)) as u32
            }
        };
        let (towards, halfway, direction) = (*towards, *halfway, *direction);
        let ([mut dr, mut dg, mut db], [mut sr, mut sg, mut sb]) = (*diffuse, *specular);
        for i in 0..BLOCK_LANES {
            // Three products of directions of at most 2^14 stay below 2^30.
            let cosine = |to: &[LaneBlock<i32>; 3]| {
                let dot = direction[0][i] * to[0][i] + direction[1][i] * to[1][i] + direction[2][i] * to[2][i];
                by_cosine.apply32(if TWO_SIDED { dot.abs() } else { dot.max(0) }).min(one)
            };
            let (straight, half) = (cosine(&towards), cosine(&halfway));
            let power = table[(by_index.apply32(half) as u32 as usize).min(last)];
            let power = if TWO_SIDED || straight > 0 { power } else { 0 };
            let straight = straight as u32;
            dr[i] += weigh(straight, by_diffuse[0], by_cosine);
            dg[i] += weigh(straight, by_diffuse[1], by_cosine);
            db[i] += weigh(straight, by_diffuse[2], by_cosine);
            sr[i] += weigh(power, by_specular[0], by_power);
            sg[i] += weigh(power, by_specular[1], by_power);
            sb[i] += weigh(power, by_specular[2], by_power);
        }
        (*diffuse, *specular) = ([dr, dg, db], [sr, sg, sb]);
    }
}

/// Light on a row of normals by Phong's formula, of a parallel frame: diffuse and specular, see [`crate::golden::phong`].
pub fn phong_rows(direction: [Vec<i32>; 3], phong: &Phong, words: &Words) -> [[Vec<u32>; 3]; 2] {
    let lanes = PhongLanes::new(phong, words);
    let row = || vec![0; direction[0].len()];
    let mut rows = [(); 2].map(|()| [row(), row(), row()]);
    blocks(&direction, |from, direction| {
        let (mut diffuse, mut specular) = ([[0; BLOCK_LANES]; 3], [[0; BLOCK_LANES]; 3]);
        vectorised(
            #[inline(always)]
            || {
                lanes.begin(&mut diffuse, &mut specular);
                for (number, light) in lanes.lights.iter().enumerate() {
                    lanes.add(number, light, &direction, &mut diffuse, &mut specular);
                }
            },
        );
        for (rows, words) in rows.iter_mut().zip([diffuse, specular]) {
            rows.iter_mut().zip(&words).for_each(|(row, words)| put_block(words, row, from));
        }
    });
    rows
}
