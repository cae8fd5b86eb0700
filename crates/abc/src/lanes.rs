//! The same arithmetic for many samples at once.
//!
//! A row is any run of samples whose neighbours a function can give for each lane: the rays of a plane at one depth, or
//! the depths of one ray. It is shaded in blocks of [`BLOCK`] lanes, each from its neighbourhood to its colours before the next
//! begins. Arithmetic is in 32 bits where the words allow it, in 64 where they do not.
//!
//! The loops over the lanes of a block are long on purpose, a whole stage each: a compiler makes vectors of a long loop, while short
//! ones are unrolled first and seldom found again.

use crate::ends::End;
use crate::golden;
use crate::perspective::RayLanes;
use cube3_frame::{
    Classification, FrameSetup, Geometry, GradientRegisters, GradientScale, LinearFactor, Normaliser, Phong,
    PhongLight, ReflectanceTable, Shading,
};
use cube3_machine::GradientMethod;
use cube3_word::{BLOCK, Block, Shift, Words, block, put_block, unit_full, vectorised};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

pub use crate::perspective::LocalBlock;

/// The samples of a block and their 26 neighbours, `[9 w + 3 v + u]`, each index 0 to 2: the samples themselves at
/// [`HERE`].
pub type Around = [Block<i32>; 27];

/// The place of the samples themselves.
pub const HERE: usize = 13;

/// A row of shaded samples; see [`golden::Shaded`].
#[derive(Clone, Debug, Default)]
pub struct ShadedRow {
    /// 1 where the sample takes part, 0 where not. Set before, cleared where a sample is outside of the threshold.
    pub present: Vec<u8>,
    /// Opacity.
    pub opacity: Vec<u32>,
    /// Red, green, blue; 0 where the opacity is.
    pub colour: [Vec<u32>; 3],
    /// The first lane with an opacity above 0, and one past the last; beyond them opacity and colour are 0.
    pub span: (usize, usize),
    /// Saturated words.
    pub overflows: u64,
    /// Lanes whose opacity is that of an end of a ray, in order. Set before.
    pub ends: Vec<End>,
}

/// A block of shaded samples: a word for each part of [`golden::Shaded`] and lane. Each row is a line of the cache.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[repr(C, align(64))]
pub struct ShadedBlock {
    /// 1 where the sample takes part, 0 where not. To be shaded, where it is in the volume.
    pub present: Block<u32>,
    /// Sample words.
    pub samples: Block<i32>,
    /// Opacity.
    pub opacity: Block<u32>,
    /// Red, green, blue; 0 where the opacity is.
    pub colour: [Block<u32>; 3],
}

impl ShadedBlock {
    /// The sample of a lane.
    #[inline]
    pub fn at(&self, lane: usize) -> golden::Shaded {
        golden::Shaded {
            present: self.present[lane] != 0,
            sample: self.samples[lane],
            opacity: self.opacity[lane],
            colour: [self.colour[0][lane], self.colour[1][lane], self.colour[2][lane]],
        }
    }

    /// Puts a sample into a lane.
    pub(crate) fn put(&mut self, lane: usize, shaded: &golden::Shaded) {
        self.present[lane] = shaded.present.into();
        self.samples[lane] = shaded.sample;
        self.opacity[lane] = shaded.opacity;
        self.colour.iter_mut().zip(shaded.colour).for_each(|(row, word)| row[lane] = word);
    }
}

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

/// A neighbour of a sample: its place in [`Around`], and its indices, each 0 to 2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Neighbour {
    /// `9 w + 3 v + u`.
    pub place: usize,
    /// Along the ray.
    pub w: usize,
    /// From plane to plane.
    pub v: usize,
    /// From ray to ray.
    pub u: usize,
}

/// Neighbours that are gathered together, so that the loop over their lanes is a long one. The last ones of a list may be the same.
pub type Neighbours = [Neighbour; 4];

/// Light, ready for blocks.
#[derive(Clone, Debug)]
enum ShadingLanes {
    Phong(PhongLanes),
    Table(ReflectanceTable),
}

/// Blocks between the stages, each of them a line of the cache.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
struct Stages {
    around: Around,
    gradient: [Block<i32>; 3],
    overflow: Block<u32>,
    direction: [Block<i32>; 3],
    magnitude: Block<u32>,
    diffuse: [Block<u32>; 3],
    specular: [Block<u32>; 3],
    class: Block<u32>,
    /// Towards the light in hand and halfway to it, in perspective.
    towards: Towards,
    /// The block that a row is shaded in.
    out: ShadedBlock,
    local: LocalBlock,
}

/// The direction of a light, and halfway between it and the eye, for each lane of a block.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Towards([[Block<i32>; 3]; 2]);

impl Stages {
    fn new() -> Stages {
        Stages {
            around: [[0; BLOCK]; 27],
            gradient: [[0; BLOCK]; 3],
            overflow: [0; BLOCK],
            direction: [[0; BLOCK]; 3],
            magnitude: [0; BLOCK],
            diffuse: [[0; BLOCK]; 3],
            specular: [[0; BLOCK]; 3],
            class: [0; BLOCK],
            local: LocalBlock::default(),
            towards: Towards([[[0; BLOCK]; 3]; 2]),
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
                for from in (0..n).step_by(BLOCK) {
                    shaded.samples = block(samples, from);
                    let present = block(&out.present, from);
                    shaded.present = present.map(u32::from);
                    let count = BLOCK.min(n - from);
                    while let [End { lane, class }, behind @ ..] = ends
                        && *lane < from + BLOCK
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
            out.colour = [[0; BLOCK]; 3];
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
        samples: &Block<i32>,
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
        for i in 0..BLOCK {
            let seen = if opacity[i] == 0 { 0 } else { u32::MAX };
            red[i] &= seen;
            green[i] &= seen;
            blue[i] &= seen;
            counted[i] &= seen;
        }
        if any(&counted) { counted.iter().sum() } else { 0 }
    }

    #[inline(always)]
    fn gradient_stage(&mut self, count: usize, at: impl Fn(usize) -> [i64; 3] + Copy, samples: &Block<i32>) {
        let Stages { around, gradient: out, overflow, local, .. } = &mut self.stages;
        *overflow = [0; BLOCK];
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
            let (mut part, mut saturated) = ([[0; BLOCK]; 3], [0; BLOCK]);
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
fn any(words: &Block<u32>) -> bool {
    words.iter().fold(0, |any, word| any | word) != 0
}

/// Whether a gradient method reads the neighbour at a displacement.
pub(crate) fn reads(method: GradientMethod, by: [i64; 3]) -> bool {
    let distance: i64 = by.iter().map(|x| x.abs()).sum();
    match method {
        GradientMethod::Six | GradientMethod::SixSheared => distance == 1,
        GradientMethod::TwentySix | GradientMethod::TwentySixSheared => true,
        // The feet of the perpendiculars: behind towards lower rays and before towards higher ones.
        GradientMethod::Ten | GradientMethod::TenNormalised => {
            distance == 1 || (distance == 2 && (by[0] + by[1]) * by[2] < 0)
        }
        // Behind on the side of the eye's lower slopes, before on the other.
        GradientMethod::Twelve => distance == 1 || (by[2] != 0 && by[0] * by[2] <= 0 && by[1] * by[2] <= 0),
    }
}

/// The neighbours that a frame reads; where rays may run either way, those of any of them.
fn neighbours(method: Option<GradientMethod>, mirrored: bool) -> Vec<Neighbours> {
    let signs: &[i64] = if mirrored { &[1, -1] } else { &[1] };
    let all = (0..27).map(|place| Neighbour { place, w: place / 9, v: place / 3 % 3, u: place % 3 });
    let read = |&Neighbour { place, w, v, u }: &Neighbour| {
        let [u, v, w] = [u, v, w].map(|i| i as i64 - 1);
        let any = |method| signs.iter().any(|su| signs.iter().any(|sv| reads(method, [su * u, sv * v, w])));
        place != HERE && method.is_some_and(any)
    };
    let read: Vec<Neighbour> = all.filter(read).collect();
    read.chunks(4).map(|some| std::array::from_fn(|i| some[i.min(some.len() - 1)])).collect()
}

/// Colours in the light: `min(round(colour · diffuse) + specular, 1)`, and how many words of each lane were saturated, added to what
/// is there; see [`golden::lit`].
#[inline(always)]
fn lit(
    diffuse: &[Block<u32>; 3],
    specular: &[Block<u32>; 3],
    words: &Words,
    colour: &mut [Block<u32>; 3],
    overflow: &mut Block<u32>,
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
    diffuse: &[Block<u32>; 3],
    specular: &[Block<u32>; 3],
    words: &Words,
    [red, green, blue]: &mut [Block<u32>; 3],
    overflow: &mut Block<u32>,
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
    for i in 0..BLOCK {
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
struct PhongLanes {
    registers: Phong,
    words: Words,
    lights: Vec<Towards>,
    /// Whether products and sums stay in 32 bits.
    narrow: bool,
}

impl PhongLanes {
    fn new(phong: &Phong, words: &Words) -> PhongLanes {
        let splat = |direction: [i32; 3]| direction.map(|component| [component; BLOCK]);
        PhongLanes {
            registers: phong.clone(),
            words: *words,
            lights: phong.lights.iter().map(|light| Towards([splat(light.direction), splat(light.halfway)])).collect(),
            narrow: words.colour_bits + 3 + words.normal_bits <= 31 && 2 * words.colour_bits + 4 <= 31,
        }
    }

    /// The light that comes from everywhere.
    #[inline(always)]
    fn begin(&self, diffuse: &mut [Block<u32>; 3], specular: &mut [Block<u32>; 3]) {
        *diffuse = [[self.registers.ambient; BLOCK]; 3];
        *specular = [[0; BLOCK]; 3];
    }

    /// Adds light `number`, which is `towards` each lane, and the highlight of what is halfway.
    #[inline(always)]
    fn add(
        &self,
        number: usize,
        light: &Towards,
        direction: &[Block<i32>; 3],
        diffuse: &mut [Block<u32>; 3],
        specular: &mut [Block<u32>; 3],
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
        direction: &[Block<i32>; 3],
        diffuse: &mut [Block<u32>; 3],
        specular: &mut [Block<u32>; 3],
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
        for i in 0..BLOCK {
            // Three products of directions of at most 2^14 stay below 2^30.
            let cosine = |to: &[Block<i32>; 3]| {
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

/// A row, block by block.
fn blocks<const N: usize>(rows: &[Vec<i32>; N], mut each: impl FnMut(usize, [Block<i32>; N])) {
    for from in (0..rows[0].len()).step_by(BLOCK) {
        each(from, rows.each_ref().map(|row| block(row, from)));
    }
}

/// Light on a row of normals by Phong's formula, of a parallel frame: diffuse and specular, see [`golden::phong`].
pub fn phong_rows(direction: [Vec<i32>; 3], phong: &Phong, words: &Words) -> [[Vec<u32>; 3]; 2] {
    let lanes = PhongLanes::new(phong, words);
    let row = || vec![0; direction[0].len()];
    let mut rows = [(); 2].map(|()| [row(), row(), row()]);
    blocks(&direction, |from, direction| {
        let (mut diffuse, mut specular) = ([[0; BLOCK]; 3], [[0; BLOCK]; 3]);
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

/// Directions of a block of gradients; see [`golden::normalise`].
#[inline(always)]
fn normalise(gradient: &[Block<i32>; 3], table: &Normaliser, words: &Words, out: &mut [Block<i32>; 3]) {
    let root = table.root.as_slice();
    let Some(last) = root.len().checked_sub(1) else {
        return;
    };
    let bits = words.normal_bits;
    let into = 2 * bits - 2 - table.root_bits;
    let first = 1_u32 << table.root_bits;
    let one = 1_u32 << (bits - 1);
    let half = 1_u32 << (bits - 1);
    let [out_u, out_v, out_w] = out;
    for i in 0..BLOCK {
        let words = [gradient[0][i], gradient[1][i], gradient[2][i]];
        let (block, _) = floated(words, bits);
        let square = block[0] * block[0] + block[1] * block[1] + block[2] * block[2];
        let index = (square >> into).max(first) - first;
        let reciprocal = root[(index as usize).min(last)];
        let component = |axis: usize| {
            let size = ((block[axis] * reciprocal + half) >> bits).min(one) as i32;
            if words[axis] < 0 { -size } else { size }
        };
        out_u[i] = component(0);
        out_v[i] = component(1);
        out_w[i] = component(2);
    }
}

/// The leading bits of the components' sizes, with the largest's first at the top, and by how much they were moved.
#[inline(always)]
fn floated(gradient: [i32; 3], bits: u32) -> ([u32; 3], u32) {
    let sizes = [gradient[0].unsigned_abs(), gradient[1].unsigned_abs(), gradient[2].unsigned_abs()];
    let zeros = (sizes[0] | sizes[1] | sizes[2] | 1).leading_zeros();
    let drop = 32 - bits;
    ([sizes[0] << zeros >> drop, sizes[1] << zeros >> drop, sizes[2] << zeros >> drop], zeros)
}

/// Magnitudes of a block of gradients with their directions; see [`golden::normalise`].
#[inline(always)]
fn lengths(gradient: &[Block<i32>; 3], direction: &[Block<i32>; 3], words: &Words, out: &mut Block<u32>) {
    let bits = words.normal_bits;
    for i in 0..BLOCK {
        let (block, zeros) = floated([gradient[0][i], gradient[1][i], gradient[2][i]], bits);
        let product = |axis: usize| u64::from(block[axis]) * u64::from(direction[axis][i].unsigned_abs());
        out[i] = golden::magnitude(product(0) + product(1) + product(2), zeros, bits);
    }
}

/// Directions and magnitudes of a row of gradients; see [`golden::normalise`].
pub fn normalise_rows(gradient: [Vec<i32>; 3], table: &Normaliser, words: &Words) -> ([Vec<i32>; 3], Vec<u32>) {
    let n = gradient[0].len();
    let mut rows = [(); 3].map(|()| vec![0; n]);
    let mut magnitudes = vec![0; n];
    blocks(&gradient, |from, gradient| {
        let (mut direction, mut magnitude) = ([[0; BLOCK]; 3], [0; BLOCK]);
        vectorised(
            #[inline(always)]
            || {
                normalise(&gradient, table, words, &mut direction);
                lengths(&gradient, &direction, words, &mut magnitude);
            },
        );
        rows.iter_mut().zip(&direction).for_each(|(row, words)| put_block(words, row, from));
        put_block(&magnitude, &mut magnitudes, from);
    });
    (rows, magnitudes)
}

/// The classification tables.
#[derive(Clone, Debug)]
pub struct ClassifyLanes {
    /// Red, green, blue in 16 bits each.
    colour: Vec<u64>,
    /// Opacity: `width` entries for each row, the rows of a class of step lengths behind one another. Copies of the lanes share it.
    opacity: Arc<[u32]>,
    width: u32,
    shift: u32,
    threshold: [u32; 2],
    /// How far a magnitude is shifted to its row, and the last row; where there is more than one.
    rows: Option<(u32, u32)>,
    /// Whether there is one row in all.
    flat: bool,
    /// Whether the threshold lets all samples take part.
    all: bool,
}

impl ClassifyLanes {
    /// Lanes for the tables of a frame.
    pub fn new(table: &Classification) -> ClassifyLanes {
        let pack = |colour: &[u32; 3]| u64::from(colour[0]) | u64::from(colour[1]) << 16 | u64::from(colour[2]) << 32;
        let last = (table.colour.len() as u32).wrapping_shl(table.index_shift).wrapping_sub(1);
        ClassifyLanes {
            colour: table.colour.iter().map(pack).collect(),
            opacity: table.opacity.as_slice().into(),
            width: table.colour.len() as u32,
            shift: table.index_shift,
            threshold: table.threshold,
            rows: table.gradient_rows.map(|rows| (rows.shift, rows.rows - 1)),
            flat: table.opacity.len() <= table.colour.len(),
            all: table.threshold[0] == 0 && table.threshold[1] >= last,
        }
    }

    /// Opacities of a block, and which samples take part: the others are 0. `magnitude` is read where the opacity depends on it; `class` is 0 where there
    /// is one class.
    #[inline(always)]
    pub fn opacity(&self, magnitude: &Block<u32>, class: &Block<u32>, out: &mut ShadedBlock) {
        if self.flat {
            self.opacity_in::<true>(magnitude, class, out);
        } else {
            self.opacity_in::<false>(magnitude, class, out);
        }
    }

    #[inline(always)]
    fn opacity_in<const FLAT: bool>(&self, magnitude: &Block<u32>, class: &Block<u32>, out: &mut ShadedBlock) {
        let shift = self.shift;
        let table = &*self.opacity;
        let Some(last) = table.len().checked_sub(1) else {
            return;
        };
        let [low, high] = self.threshold;
        let width = self.width;
        let (drop, top) = self.rows.unwrap_or((0, 0));
        // Copies, which nothing that is written can be part of.
        let (words, mut there, mut found) = (out.samples, out.present, [0; BLOCK]);
        let mut kept = [0; BLOCK];
        for i in 0..BLOCK {
            let word = words[i] as u32;
            let takes_part = there[i] != 0 && word >= low && word <= high;
            let row = if FLAT { 0 } else { (class[i] * (top + 1) + (magnitude[i] >> drop).min(top)) * width };
            let entry = table[((row + (word >> shift)) as usize).min(last)];
            there[i] = u32::from(takes_part);
            found[i] = if takes_part { entry } else { 0 };
            kept[i] = if takes_part { words[i] } else { 0 };
        }
        (out.samples, out.present, out.opacity) = (kept, there, found);
    }

    /// The opacity of a sample by the table of a class.
    fn entry(&self, class: u32, sample: i32, magnitude: u32) -> u32 {
        let (drop, top) = self.rows.unwrap_or((0, 0));
        let row = class * (top + 1) + (magnitude >> drop).min(top);
        self.opacity[row as usize * self.width as usize + (sample as u32 >> self.shift) as usize]
    }

    /// Colours of a block, to be cleared where the opacity is 0.
    #[inline(always)]
    pub fn colour(&self, out: &mut ShadedBlock) {
        let shift = self.shift;
        let table = self.colour.as_slice();
        let Some(last) = table.len().checked_sub(1) else {
            return;
        };
        let ShadedBlock { samples, colour: [red, green, blue], .. } = out;
        for i in 0..BLOCK {
            let entry = table[((samples[i] as u32 >> shift) as usize).min(last)];
            red[i] = entry as u32 & 0xffff;
            green[i] = (entry >> 16) as u32 & 0xffff;
            blue[i] = (entry >> 32) as u32;
        }
    }
}

/// The gradient unit's lanes.
#[derive(Clone, Copy, Debug)]
pub struct GradientLanes {
    method: GradientMethod,
    weights: [i32; 2],
    factors: Option<[u32; 3]>,
    lerp: Shift,
    scaling: Shift,
    whole: Shift,
    drop: Shift,
    top: i32,
    narrow: bool,
}

/// The place of a neighbour.
const fn place(w: usize, v: usize, u: usize) -> usize {
    9 * w + 3 * v + u
}

/// The four samples behind a sample that a gradient of 12 neighbours takes: along w, and also along u, along v, along both.
const BEHIND: [usize; 4] = [place(2, 1, 1), place(2, 1, 0), place(2, 0, 1), place(2, 0, 0)];
/// Those before it.
const BEFORE: [usize; 4] = [place(0, 1, 1), place(0, 1, 2), place(0, 2, 1), place(0, 2, 2)];

impl GradientLanes {
    /// Lanes for the registers of a frame.
    pub fn new(registers: GradientRegisters, words: &Words) -> GradientLanes {
        let weighted = matches!(registers.method, GradientMethod::TwentySix | GradientMethod::TwentySixSheared);
        let sheared = matches!(registers.method, GradientMethod::SixSheared | GradientMethod::TwentySixSheared);
        let extra = if weighted { 4 } else { 0 };
        // Bits of a difference, of a product of it, and of a sum of two.
        let bits = words.sample_bits() + extra + u32::from(sheared) * 2;
        let weight_bits = words.weight_bits.max(if registers.scale.is_some() { GradientScale::FACTOR_BITS } else { 0 });
        let kept = registers.scale.map_or(0, |scale| scale.kept_bits);
        GradientLanes {
            method: registers.method,
            weights: registers.weights.map(|weight| weight as i32),
            factors: registers.scale.map(|scale| scale.factors),
            lerp: words.rounding.by(words.weight_bits),
            scaling: words.rounding.by(GradientScale::FACTOR_BITS - kept),
            whole: words.rounding.by(GradientScale::FACTOR_BITS),
            drop: words.rounding.by(words.gradient_drop() + extra),
            top: ((1_i64 << (words.gradient_bits + kept - 1)) - 1) as i32,
            narrow: bits + weight_bits <= 30,
        }
    }

    /// Gradients of a block of a parallel frame, and in `overflow` how many words of each lane were saturated, added to what is there;
    /// see [`golden::gradient`].
    #[inline(always)]
    pub fn run(&self, around: &Around, out: &mut [Block<i32>; 3], overflow: &mut Block<u32>) {
        if self.narrow {
            self.parallel::<false>(around, out, overflow);
        } else {
            self.parallel::<true>(around, out, overflow);
        }
    }

    #[inline(always)]
    fn parallel<const WIDE: bool>(&self, around: &Around, out: &mut [Block<i32>; 3], overflow: &mut Block<u32>) {
        let [du, dv] = self.weights;
        match self.method {
            GradientMethod::Six | GradientMethod::SixSheared => central(around, out),
            GradientMethod::TwentySix | GradientMethod::TwentySixSheared => weighted(around, out),
            GradientMethod::Ten | GradientMethod::TenNormalised => feet::<WIDE>(around, [du, dv], self.lerp, out),
            GradientMethod::Twelve => {
                let [u, v, w] = out;
                for i in 0..BLOCK {
                    u[i] = around[place(1, 1, 2)][i] - around[place(1, 1, 0)][i];
                    v[i] = around[place(1, 2, 1)][i] - around[place(1, 0, 1)][i];
                    let far = bilinear::<WIDE>(corners(around, BEHIND, i), du, dv, self.lerp);
                    let near = bilinear::<WIDE>(corners(around, BEFORE, i), du, dv, self.lerp);
                    w[i] = far - near;
                }
            }
        }
        if matches!(self.method, GradientMethod::SixSheared | GradientMethod::TwentySixSheared) {
            let [u, v, w] = out;
            for i in 0..BLOCK {
                w[i] -= self.along::<WIDE>([u[i], v[i]], [du, dv]);
            }
        }
        if let Some(factors) = self.factors {
            self.scale::<WIDE>(&factors.map(|factor| [factor as i32; BLOCK]), out);
        }
        self.drop_low_bits(out, overflow);
    }

    /// The same for a block of a perspective frame, each lane with weights and factors of its own. All of the block's rays run against or
    /// along u, and against or along v, as `mirrored` says; the neighbourhood is already in the mirror.
    #[inline(always)]
    pub fn run_local(
        &self,
        around: &Around,
        local: &LocalBlock,
        mirrored: [bool; 2],
        out: &mut [Block<i32>; 3],
        overflow: &mut Block<u32>,
    ) {
        if self.narrow {
            self.local::<false>(around, local, mirrored, out, overflow);
        } else {
            self.local::<true>(around, local, mirrored, out, overflow);
        }
    }

    #[inline(always)]
    fn local<const WIDE: bool>(
        &self,
        around: &Around,
        local: &LocalBlock,
        mirrored: [bool; 2],
        out: &mut [Block<i32>; 3],
        overflow: &mut Block<u32>,
    ) {
        if matches!(self.method, GradientMethod::TwentySix | GradientMethod::TwentySixSheared) {
            weighted(around, out);
        } else {
            central(around, out);
        }
        let [u, v, w] = &mut *out;
        if self.method == GradientMethod::Twelve {
            let LocalBlock { behind: [behind_u, behind_v], before: [before_u, before_v], .. } = local;
            for i in 0..BLOCK {
                let far = bilinear::<WIDE>(corners(around, BEHIND, i), behind_u[i], behind_v[i], self.lerp);
                let near = bilinear::<WIDE>(corners(around, BEFORE, i), before_u[i], before_v[i], self.lerp);
                w[i] = far - near;
            }
        }
        if let Some(nearness) = &local.nearness {
            for i in 0..BLOCK {
                w[i] = self.whole.apply(i64::from(w[i]) * i64::from(nearness[i])) as i32;
            }
        }
        if matches!(self.method, GradientMethod::SixSheared | GradientMethod::TwentySixSheared) {
            let [here_u, here_v] = &local.here;
            for i in 0..BLOCK {
                w[i] -= self.along::<WIDE>([u[i], v[i]], [here_u[i], here_v[i]]);
            }
        }
        for (component, mirrored) in [u, v].into_iter().zip(mirrored) {
            if mirrored {
                component.iter_mut().for_each(|word| *word = -*word);
            }
        }
        self.scale::<WIDE>(&local.factors, out);
        self.drop_low_bits(out, overflow);
    }

    /// The part of differences along u and v that is one along the ray.
    #[inline(always)]
    fn along<const WIDE: bool>(&self, differences: [i32; 2], weights: [i32; 2]) -> i32 {
        if WIDE {
            let product = |i: usize| i64::from(differences[i]) * i64::from(weights[i]);
            self.lerp.apply(product(0) + product(1)) as i32
        } else {
            self.lerp.apply32(differences[0] * weights[0] + differences[1] * weights[1])
        }
    }

    #[inline(always)]
    fn scale<const WIDE: bool>(&self, factors: &[Block<i32>; 3], [u, v, w]: &mut [Block<i32>; 3]) {
        for i in 0..BLOCK {
            u[i] = mul::<WIDE>(u[i], factors[0][i], self.scaling);
            v[i] = mul::<WIDE>(v[i], factors[1][i], self.scaling);
            w[i] = mul::<WIDE>(w[i], factors[2][i], self.scaling);
        }
    }

    /// Drops the low bits of scaled differences, and holds them to the gradient's word.
    #[inline(always)]
    fn drop_low_bits(&self, [u, v, w]: &mut [Block<i32>; 3], overflow: &mut Block<u32>) {
        let GradientLanes { drop, top, .. } = *self;
        for i in 0..BLOCK {
            let dropped = [drop.apply32(u[i]), drop.apply32(v[i]), drop.apply32(w[i])];
            u[i] = dropped[0].clamp(-top - 1, top);
            v[i] = dropped[1].clamp(-top - 1, top);
            w[i] = dropped[2].clamp(-top - 1, top);
            overflow[i] +=
                u32::from(u[i] != dropped[0]) + u32::from(v[i] != dropped[1]) + u32::from(w[i] != dropped[2]);
        }
    }
}

#[inline(always)]
fn corners(around: &Around, places: [usize; 4], i: usize) -> [i32; 4] {
    [around[places[0]][i], around[places[1]][i], around[places[2]][i], around[places[3]][i]]
}

/// Central differences.
#[inline(always)]
fn central(around: &Around, [u, v, w]: &mut [Block<i32>; 3]) {
    for i in 0..BLOCK {
        u[i] = around[place(1, 1, 2)][i] - around[place(1, 1, 0)][i];
        v[i] = around[place(1, 2, 1)][i] - around[place(1, 0, 1)][i];
        w[i] = around[place(2, 1, 1)][i] - around[place(0, 1, 1)][i];
    }
}

/// Sums of nine differences along each axis, with weights 1, 2, 1 both ways across it.
#[inline(always)]
fn weighted(around: &Around, [u, v, w]: &mut [Block<i32>; 3]) {
    for i in 0..BLOCK {
        let sum = |pair: fn(usize, usize) -> [usize; 2]| {
            let difference = |a: usize, b: usize| {
                let [far, near] = pair(a, b);
                around[far][i] - around[near][i]
            };
            let across = |a: usize| difference(a, 0) + 2 * difference(a, 1) + difference(a, 2);
            across(0) + 2 * across(1) + across(2)
        };
        u[i] = sum(|a, b| [place(a, b, 2), place(a, b, 0)]);
        v[i] = sum(|a, b| [place(a, 2, b), place(a, 0, b)]);
        w[i] = sum(|a, b| [place(2, a, b), place(0, a, b)]);
    }
}

/// Differences of the feet of perpendiculars along u and v, and along the ray.
#[inline(always)]
fn feet<const WIDE: bool>(around: &Around, [du, dv]: [i32; 2], shift: Shift, [u, v, w]: &mut [Block<i32>; 3]) {
    for i in 0..BLOCK {
        let foot = |near: usize, far: usize, weight| lerp::<WIDE>(around[near][i], around[far][i], weight, shift);
        u[i] = foot(place(1, 1, 2), place(0, 1, 2), du) - foot(place(1, 1, 0), place(2, 1, 0), du);
        v[i] = foot(place(1, 2, 1), place(0, 2, 1), dv) - foot(place(1, 0, 1), place(2, 0, 1), dv);
        w[i] = around[place(2, 1, 1)][i] - around[place(0, 1, 1)][i];
    }
}

#[inline(always)]
fn bilinear<const WIDE: bool>(corners: [i32; 4], du: i32, dv: i32, shift: Shift) -> i32 {
    let near = lerp::<WIDE>(corners[0], corners[1], du, shift);
    let far = lerp::<WIDE>(corners[2], corners[3], du, shift);
    lerp::<WIDE>(near, far, dv, shift)
}

#[inline(always)]
fn lerp<const WIDE: bool>(near: i32, far: i32, weight: i32, shift: Shift) -> i32 {
    near + mul::<WIDE>(far - near, weight, shift)
}

/// A rounded product, in 32 bits or through 64.
#[inline(always)]
fn mul<const WIDE: bool>(a: i32, b: i32, shift: Shift) -> i32 {
    if WIDE { shift.apply(i64::from(a) * i64::from(b)) as i32 } else { shift.apply32(a * b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Whether a sample at a displacement changes a gradient.
    fn changes(method: GradientMethod, by: [i64; 3]) -> bool {
        let words = Words::default();
        let full = 1 << words.weight_bits;
        let word = |case: i32, place: i32| (case * 7919 + place * 10_429 + case * place * 631) % 20_011;
        let [u, v, w] = by.map(|i| (i + 1) as usize);
        (0..400).any(|case| {
            let weights = [case % 5, case / 5 % 5].map(|quarters| quarters * full / 4);
            let registers = GradientRegisters { method, weights, scale: None, border: 0 };
            let mut s: golden::Neighbourhood =
                [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| word(case as i32, 9 * w + 3 * v + u))));
            let before = golden::gradient(&s, &registers, &words);
            s[w][v][u] += 20_000;
            golden::gradient(&s, &registers, &words) != before
        })
    }

    #[test]
    fn the_neighbours_read_are_those_that_change_a_gradient() {
        assert_eq!((neighbours(None, false), neighbours(None, true)), (Vec::new(), Vec::new()));
        for (method, _) in GradientMethod::ALL {
            let [one_way, any_way] = [false, true].map(|mirrored| neighbours(Some(method), mirrored));
            let listed = |list: &[Neighbours], place: usize| list.as_flattened().iter().any(|read| read.place == place);
            let mut farthest = [0; 2];
            for place in 0..27 {
                let [w, v, u] = [place / 9, place / 3 % 3, place % 3].map(|i| i as i64 - 1);
                let needed = |mirror: [i64; 2]| place != HERE && changes(method, [mirror[0] * u, mirror[1] * v, w]);
                if place != HERE {
                    assert_eq!(reads(method, [u, v, w]), needed([1, 1]), "{method:?} at {:?}", [u, v, w]);
                }
                for (against, farthest) in farthest.iter_mut().enumerate() {
                    if needed([1 - 2 * against as i64, 1]) {
                        *farthest = (*farthest).max((u + w).unsigned_abs() as usize);
                    }
                }
                assert_eq!(listed(&one_way, place), needed([1, 1]), "{method:?}, place {place}");
                let either_way = [[1, 1], [1, -1], [-1, 1], [-1, -1]].into_iter().any(needed);
                assert_eq!(listed(&any_way, place), either_way, "{method:?}, place {place}, rays either way");
            }
            assert_eq!([false, true].map(|against| crate::reach(method, 1, against)), farthest, "{method:?}");
        }
    }

    proptest! {
        #[test]
        fn a_sample_of_a_block_comes_back(present: bool, sample: i32, opacity: u32, colour: [u32; 3], lane in 0..BLOCK) {
            let shaded = golden::Shaded { present, sample, opacity, colour };
            let mut block = ShadedBlock::default();
            block.put(lane, &shaded);
            for other in 0..BLOCK {
                let expected = if other == lane { shaded } else { golden::Shaded::default() };
                prop_assert_eq!(block.at(other), expected);
            }
        }
    }
}
