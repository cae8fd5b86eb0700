//! The same arithmetic for many samples at once.
//!
//! A row is any run of samples whose neighbours a function can give for each lane: the rays of a plane at one depth, or
//! the depths of one ray. It is shaded in blocks of [`BLOCK_LANES`] lanes, each from its neighbourhood to its colours before the next
//! begins. Arithmetic is in 32 bits where the words allow it, in 64 where they do not.
//!
//! The loops over the lanes of a block are long on purpose, a whole stage each: a compiler makes vectors of a long loop, while short
//! ones are unrolled first and seldom found again.

mod around;
mod classify;
mod gradient;
mod light;
mod normalise;
mod shaded;

use crate::ends::End;
use crate::golden;
use crate::perspective::RayLanes;
use cube3_frame::{FrameSetup, Geometry, LinearFactor, Normaliser, Shading};
use cube3_word::{BLOCK_LANES, LaneBlock, Words, block, put_block, vectorised};

pub use crate::perspective::LocalBlock;
pub use around::{Around, HERE, Neighbour, Neighbours};
pub use classify::ClassifyLanes;
pub use gradient::GradientLanes;
pub(crate) use gradient::reads;
pub use light::phong_rows;
pub use normalise::normalise_rows;
pub use shaded::{ShadedBlock, ShadedRow};

use gradient::neighbours;
use light::{PhongLanes, ShadingLanes, Towards, lit};
use normalise::{lengths, normalise};

/// The ABC unit's lanes for the registers of a frame.
#[derive(Clone, Debug)]
pub struct AbcLanes {
    words: Words,
    table: ClassifyLanes,
    gradient: Option<GradientLanes>,
    normaliser: Option<Normaliser>,
    shading: Option<ShadingLanes>,
    cue: Option<LinearFactor>,
    rays: Option<RayLanes>,
    /// Those of the 27 neighbours that are read.
    reads: Vec<Neighbours>,
    skip: bool,
    /// Lanes of the next block whose opacity is that of an end of a ray.
    ends: Vec<End>,
    stages: Stages,
}

/// Blocks between the stages, each of them a line of the cache.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Stages {
    around: Around,
    gradient: [LaneBlock<i32>; 3],
    overflow: LaneBlock<u32>,
    direction: [LaneBlock<i32>; 3],
    magnitude: LaneBlock<u32>,
    diffuse: [LaneBlock<u32>; 3],
    specular: [LaneBlock<u32>; 3],
    class: LaneBlock<u32>,
    /// Towards the light in hand and halfway to it, in perspective.
    towards: Towards,
    /// The block that a row is shaded in.
    out: ShadedBlock,
    local: LocalBlock,
}

impl Stages {
    fn new() -> Stages {
        Stages {
            around: [[0; BLOCK_LANES]; 27],
            gradient: [[0; BLOCK_LANES]; 3],
            overflow: [0; BLOCK_LANES],
            direction: [[0; BLOCK_LANES]; 3],
            magnitude: [0; BLOCK_LANES],
            diffuse: [[0; BLOCK_LANES]; 3],
            specular: [[0; BLOCK_LANES]; 3],
            class: [0; BLOCK_LANES],
            local: LocalBlock::default(),
            towards: Towards([[[0; BLOCK_LANES]; 3]; 2]),
            out: ShadedBlock::default(),
        }
    }
}

impl AbcLanes {
    /// Lanes for a frame. With `skip`, blocks that are transparent are not shaded, which changes no bit.
    pub fn new(setup: &FrameSetup, skip: bool) -> AbcLanes {
        let rays = RayLanes::new(setup);
        let shading = setup.shading.as_ref().map(|shading| match shading {
            Shading::Phong(phong) => ShadingLanes::Phong(PhongLanes::new(phong, &setup.words)),
            Shading::Table(table) => ShadingLanes::Table(table.clone()),
        });
        AbcLanes {
            words: setup.words,
            table: ClassifyLanes::new(&setup.classification),
            gradient: setup.gradient.map(|registers| GradientLanes::new(registers, &setup.words)),
            normaliser: setup.normaliser.clone(),
            shading,
            cue: setup.depth_cue,
            reads: neighbours(setup.gradient.map(|registers| registers.method), rays.is_some()),
            rays,
            skip,
            ends: Vec::new(),
            stages: Stages::new(),
        }
    }

    /// Makes ready for the rays `us` of plane `v`: in perspective each has a light of its own. It must be called before they are
    /// shaded; in a parallel frame it does nothing.
    pub fn aim(&mut self, v: i64, us: std::ops::Range<i64>) {
        if let Some(rays) = &mut self.rays {
            let phong = match &self.shading {
                Some(ShadingLanes::Phong(phong)) => Some(&phong.registers),
                _ => None,
            };
            rays.aim(v, us, phong, self.normaliser.as_ref(), &self.words);
        }
    }

    /// Shades `n` samples. `neighbour(w, v, u)` is a row of the neighbourhood, each index 0 to 2 and `neighbour(1, 1, 1)` the
    /// samples themselves, with `n` lanes at least; `at(lane)` is the lane's (u, v, k). `out.present` must have `n` entries. In perspective the rays must have been
    /// aimed at, their signs along u may change once, and the one along v not at all.
    pub fn shade<'a>(
        &mut self,
        n: usize,
        neighbour: impl Fn(usize, usize, usize) -> &'a [i32] + Copy,
        at: impl Fn(usize) -> [i64; 3] + Copy,
        geometry: &Geometry,
        out: &mut ShadedRow,
    ) {
        out.overflows = 0;
        out.opacity.resize(n, 0);
        out.colour.iter_mut().for_each(|colour| colour.resize(n, 0));
        let mut shaded = std::mem::take(&mut self.stages.out);
        let (mut first, mut end) = (n, 0);
        let mut ends = out.ends.as_slice();
        let samples = &neighbour(1, 1, 1)[..n];
        vectorised(
            #[inline(always)]
            || {
                for from in (0..n).step_by(BLOCK_LANES) {
                    shaded.samples = block(samples, from);
                    let present = block(&out.present, from);
                    shaded.present = present.map(u32::from);
                    let count = BLOCK_LANES.min(n - from);
                    while let [End { lane, class }, behind @ ..] = ends
                        && *lane < from + BLOCK_LANES
                    {
                        self.end(lane - from, *class);
                        ends = behind;
                    }
                    let saturated = self.block(
                        #[inline(always)]
                        |reads: &[Neighbours], around: &mut Around| {
                            for &Neighbour { place, w, v, u } in reads.as_flattened() {
                                around[place] = block(&neighbour(w, v, u)[..n], from);
                            }
                        },
                        count,
                        |lane| at(from + lane),
                        geometry,
                        &mut shaded,
                    );
                    if !self.table.all {
                        put_block(&shaded.present.map(|word| word as u8), &mut out.present, from);
                    }
                    put_block(&shaded.opacity, &mut out.opacity, from);
                    for (colour, shaded) in out.colour.iter_mut().zip(&shaded.colour) {
                        put_block(shaded, colour, from);
                    }
                    let Some(saturated) = saturated else {
                        continue;
                    };
                    out.overflows += u64::from(saturated);
                    if let Some(lane) = shaded.opacity.iter().rposition(|&opacity| opacity != 0) {
                        end = from + lane + 1;
                        if first == n {
                            first = from + shaded.opacity.iter().position(|&opacity| opacity != 0).unwrap_or(0);
                        }
                    }
                }
            },
        );
        self.stages.out = shaded;
        out.span = match (self.skip, first < n) {
            (false, _) => (0, n),
            (true, true) => (first, end),
            (true, false) => (0, 0),
        };
    }

    /// Says that a lane of the block that is shaded next has the opacity of an end of a ray, by its class.
    pub fn end(&mut self, lane: usize, class: u32) {
        self.ends.push(End { lane, class });
    }

    /// Shades a block. `begin` writes its samples and which of them are there, the first `count` lanes at most; `fill` the given
    /// neighbours, and it is not called where they are not needed. `at(lane)` is the lane's (u, v, k). Gives how
    /// many words were saturated; nothing where all is transparent and was not shaded.
    #[inline]
    pub fn shade_block(
        &mut self,
        begin: impl FnOnce(&mut ShadedBlock),
        fill: impl Fn(&[Neighbours], &mut Around),
        count: usize,
        at: impl Fn(usize) -> [i64; 3] + Copy,
        geometry: &Geometry,
        out: &mut ShadedBlock,
    ) -> Option<u32> {
        vectorised(
            #[inline(always)]
            || {
                begin(out);
                self.block(fill, count, at, geometry, out)
            },
        )
    }

    #[inline(always)]
    fn block(
        &mut self,
        fill: impl Fn(&[Neighbours], &mut Around),
        count: usize,
        at: impl Fn(usize) -> [i64; 3] + Copy,
        geometry: &Geometry,
        out: &mut ShadedBlock,
    ) -> Option<u32> {
        if let Some(rays) = self.rays.as_ref().filter(|rays| rays.has_classes()) {
            for lane in 0..count {
                self.stages.class[lane] = rays.class(at(lane));
            }
        }
        // Where the opacity depends on the gradient, that comes first.
        let first = self.table.rows.is_some();
        if first {
            self.gradient_stages(&fill, count, at, &out.samples);
        }
        let Stages { magnitude, class, .. } = &self.stages;
        self.table.opacity(magnitude, class, out);
        if !self.ends.is_empty() {
            self.end_stage(out);
        }
        if self.skip && !any(&out.opacity) {
            out.colour = [[0; BLOCK_LANES]; 3];
            return None;
        }
        if !first {
            self.gradient_stages(&fill, count, at, &out.samples);
        }
        self.table.colour(out);
        self.light_stage(count, at, out);
        if let Some(cue) = self.cue {
            let shift = self.words.rounding.by(LinearFactor::WORD_BITS);
            for lane in 0..count {
                let factor = i64::from(LinearFactor::word(geometry.evaluate(&cue.factor, at(lane))));
                for colour in &mut out.colour {
                    colour[lane] = shift.apply(i64::from(colour[lane]) * factor) as u32;
                }
            }
        }
        Some(self.clear_transparent(out))
    }

    /// The opacities of the ends of rays.
    #[inline(never)]
    fn end_stage(&mut self, out: &mut ShadedBlock) {
        for End { lane, class } in self.ends.drain(..) {
            if out.present[lane] != 0 {
                out.opacity[lane] = self.table.entry(class, out.samples[lane], self.stages.magnitude[lane]);
            }
        }
    }

    /// Neighbours, gradient and normal.
    #[inline(always)]
    fn gradient_stages(
        &mut self,
        fill: &impl Fn(&[Neighbours], &mut Around),
        count: usize,
        at: impl Fn(usize) -> [i64; 3] + Copy,
        samples: &LaneBlock<i32>,
    ) {
        if self.gradient.is_some() {
            fill(&self.reads, &mut self.stages.around);
        }
        self.gradient_stage(count, at, samples);
        self.normal_stage();
    }

    /// A transparent sample has no colour and counts no overflow.
    #[inline(always)]
    fn clear_transparent(&self, out: &mut ShadedBlock) -> u32 {
        let ShadedBlock { opacity, colour: [red, green, blue], .. } = out;
        let mut counted = self.stages.overflow;
        for i in 0..BLOCK_LANES {
            let seen = if opacity[i] == 0 { 0 } else { u32::MAX };
            red[i] &= seen;
            green[i] &= seen;
            blue[i] &= seen;
            counted[i] &= seen;
        }
        if any(&counted) { counted.iter().sum() } else { 0 }
    }

    #[inline(always)]
    fn gradient_stage(&mut self, count: usize, at: impl Fn(usize) -> [i64; 3] + Copy, samples: &LaneBlock<i32>) {
        let Stages { around, gradient: out, overflow, local, .. } = &mut self.stages;
        *overflow = [0; BLOCK_LANES];
        let Some(gradient) = &self.gradient else {
            return;
        };
        let Some(rays) = &self.rays else {
            return gradient.run(around, out, overflow);
        };
        // Where rays turn from running against u to running along it, the neighbourhood turns.
        let mirrored = rays.mirrored(at(0));
        let turn = (0..count).find(|&lane| rays.mirrored(at(lane))[0] != mirrored[0]).unwrap_or(count);
        for lanes in [0..turn, turn..count] {
            if lanes.is_empty() {
                continue;
            }
            let mirrored = rays.mirrored(at(lanes.start));
            rays.local(lanes.clone(), at, local);
            let turned = |i: usize, mirrored: bool| if mirrored { 2 - i } else { i };
            let mut from = *around;
            for (place, from) in from.iter_mut().enumerate() {
                let [w, v, u] = [place / 9, turned(place / 3 % 3, mirrored[1]), turned(place % 3, mirrored[0])];
                *from = around[9 * w + 3 * v + u];
            }
            for lane in lanes.clone().filter(|&lane| rays.is_first(at(lane))) {
                from[..9].iter_mut().for_each(|before| before[lane] = samples[lane]);
            }
            let (mut part, mut saturated) = ([[0; BLOCK_LANES]; 3], [0; BLOCK_LANES]);
            gradient.run_local(&from, local, mirrored, &mut part, &mut saturated);
            for (out, part) in out.iter_mut().zip(&part) {
                out[lanes.clone()].copy_from_slice(&part[lanes.clone()]);
            }
            overflow[lanes.clone()].copy_from_slice(&saturated[lanes]);
        }
    }

    #[inline(always)]
    fn normal_stage(&mut self) {
        if let Some(table) = &self.normaliser {
            let Stages { gradient, direction, magnitude, .. } = &mut self.stages;
            normalise(gradient, table, &self.words, direction);
            if self.table.rows.is_some() {
                lengths(gradient, direction, &self.words, magnitude);
            }
        }
    }

    #[inline(always)]
    fn light_stage(&mut self, count: usize, at: impl Fn(usize) -> [i64; 3] + Copy, out: &mut ShadedBlock) {
        let Stages { gradient, direction, diffuse, specular, overflow, towards, .. } = &mut self.stages;
        match &self.shading {
            Some(ShadingLanes::Phong(phong)) => {
                phong.begin(diffuse, specular);
                for (number, light) in phong.lights.iter().enumerate() {
                    let light = match &self.rays {
                        Some(rays) => {
                            rays.towards(number, phong.registers.lights[number].direction, count, at, &mut towards.0);
                            &*towards
                        }
                        None => light,
                    };
                    phong.add(number, light, direction, diffuse, specular);
                }
            }
            Some(ShadingLanes::Table(table)) => {
                for lane in 0..count {
                    let light = golden::reflectance([0, 1, 2].map(|i| gradient[i][lane]), table);
                    for i in 0..3 {
                        diffuse[i][lane] = light.diffuse[i];
                        specular[i][lane] = light.specular[i];
                    }
                }
            }
            None => return,
        }
        lit(diffuse, specular, &self.words, &mut out.colour, overflow);
    }
}

/// Whether any word is not 0.
#[inline(always)]
fn any(words: &LaneBlock<u32>) -> bool {
    words.iter().fold(0, |any, word| any | word) != 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn a_sample_of_a_block_comes_back(present: bool, sample: i32, opacity: u32, colour: [u32; 3], lane in 0..BLOCK_LANES) {
            let shaded = golden::Shaded { present, sample, opacity, colour };
            let mut block = ShadedBlock::default();
            block.put(lane, &shaded);
            for other in 0..BLOCK_LANES {
                let expected = if other == lane { shaded } else { golden::Shaded::default() };
                prop_assert_eq!(block.at(other), expected);
            }
        }
    }
}
