//! The same arithmetic for a row of samples at once.
//!
//! A row is any run of samples whose neighbours a function can give for each lane: the rays of a plane at one depth, or
//! the depths of one ray. Arithmetic is in 32 bits where the words allow it, in 64 where they do not.

use crate::golden;
use crate::perspective::RayLanes;
use cube3_host::{
    Classification, FrameSetup, Geometry, GradientMethod, GradientRegisters, GradientScale, LinearFactor, Normaliser,
    Phong, ReflectanceTable, Shading,
};
use cube3_word::{Shift, Words, unit_full};

pub use crate::perspective::LocalRows;

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
}

/// The ABC unit's lanes for the registers of a frame.
#[derive(Clone, Debug)]
pub struct AbcLanes {
    words: Words,
    table: ClassifyLanes,
    gradient: Option<GradientLanes>,
    normaliser: Option<Normaliser>,
    shading: Option<Shading>,
    cue: Option<LinearFactor>,
    rays: Option<RayLanes>,
    skip: bool,
    row: Scratch,
}

/// Rows between the stages.
#[derive(Clone, Debug, Default)]
struct Scratch {
    gradient: [Vec<i32>; 3],
    overflow: Vec<u32>,
    block: [Vec<u32>; 3],
    index: Vec<u32>,
    reciprocal: Vec<u32>,
    direction: [Vec<i32>; 3],
    magnitude: Vec<u32>,
    cosine: [Vec<i32>; 2],
    power: Vec<u32>,
    diffuse: [Vec<u32>; 3],
    specular: [Vec<u32>; 3],
    /// Towards the light in hand and halfway to it, by lane.
    towards: [[Vec<i32>; 3]; 2],
    class: Vec<u32>,
    local: LocalRows,
}

fn resize<T: Default + Clone>(rows: &mut [Vec<T>], n: usize) {
    for row in rows {
        row.resize(n, T::default());
    }
}

impl AbcLanes {
    /// Lanes for a frame. With `skip`, rows and ends of rows that are transparent are not shaded, which changes no bit.
    pub fn new(setup: &FrameSetup, skip: bool) -> AbcLanes {
        AbcLanes {
            words: setup.words,
            table: ClassifyLanes::new(&setup.classification),
            gradient: setup.gradient.map(|registers| GradientLanes::new(registers, &setup.words)),
            normaliser: setup.normaliser.clone(),
            shading: setup.shading.clone(),
            cue: setup.depth_cue,
            rays: RayLanes::new(setup),
            skip,
            row: Scratch::default(),
        }
    }

    /// Makes ready for the rays `us` of plane `v`: in perspective each has a light of its own. It must be called before they are
    /// shaded; in a parallel frame it does nothing.
    pub fn aim(&mut self, v: i64, us: std::ops::Range<i64>) {
        if let Some(rays) = &mut self.rays {
            rays.aim(v, us, self.shading.as_ref(), self.normaliser.as_ref(), &self.words);
        }
    }

    /// Shades `n` samples. `neighbour(w, v, u)` is a row of the neighbourhood, each index 0 to 2 and `neighbour(1, 1, 1)` the
    /// samples themselves, with `n` lanes at least; `at(lane)` is the lane's (u, v, k). `out.present` must have `n` entries. In perspective the rays must have been
    /// aimed at, their signs along u may change once, and the one along v not at all.
    #[inline(always)]
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
        resize(&mut out.colour, n);
        let two_dimensional = self.table.rows.is_some();
        if two_dimensional {
            self.gradient_stage(0, n, neighbour, at);
            self.normal_stage(0, n);
        }
        self.row.class.clear();
        if let Some(rays) = self.rays.as_ref().filter(|rays| rays.has_classes()) {
            self.row.class.extend((0..n).map(|lane| rays.class(at(lane))));
        }
        let span = self.table.opacity(n, neighbour(1, 1, 1), &self.row.magnitude, &self.row.class, out);
        out.span = if self.skip { span } else { (0, n) };
        let (from, to) = out.span;
        for colour in &mut out.colour {
            colour[..from].fill(0);
            colour[to..].fill(0);
        }
        if from >= to {
            out.span = (0, 0);
            return;
        }
        if !two_dimensional {
            self.gradient_stage(from, to, neighbour, at);
            self.normal_stage(from, to);
        }
        self.table.colour(from, to, neighbour(1, 1, 1), out);
        match self.shading.take() {
            Some(Shading::Phong(phong)) => {
                phong_stage(&mut self.row, self.rays.as_ref(), &self.words, from, to, &phong, at);
                self.light_stage(from, to, out);
                self.shading = Some(Shading::Phong(phong));
            }
            Some(Shading::Table(table)) => {
                self.table_stage(from, to, &table);
                self.light_stage(from, to, out);
                self.shading = Some(Shading::Table(table));
            }
            None => {}
        }
        if let Some(cue) = self.cue {
            let shift = self.words.rounding.by(LinearFactor::WORD_BITS);
            for lane in from..to {
                let factor = i64::from(LinearFactor::word(geometry.evaluate(&cue.factor, at(lane))));
                for colour in &mut out.colour {
                    colour[lane] = shift.apply(i64::from(colour[lane]) * factor) as u32;
                }
            }
        }
        self.clear_transparent(from, to, out);
    }

    /// A transparent sample has no colour and counts no overflow.
    #[inline(always)]
    fn clear_transparent(&self, from: usize, to: usize, out: &mut ShadedRow) {
        let opacity = &out.opacity[from..to];
        let n = opacity.len();
        for colour in &mut out.colour {
            let colour = &mut colour[from..to];
            for i in 0..n {
                colour[i] = if opacity[i] == 0 { 0 } else { colour[i] };
            }
        }
        if self.gradient.is_some() || self.shading.is_some() {
            let overflow = &self.row.overflow[from..to];
            let counted: u32 = (0..n).map(|i| if opacity[i] == 0 { 0 } else { overflow[i] }).sum();
            out.overflows = u64::from(counted);
        }
    }

    #[inline(always)]
    fn gradient_stage<'a>(
        &mut self,
        from: usize,
        to: usize,
        neighbour: impl Fn(usize, usize, usize) -> &'a [i32] + Copy,
        at: impl Fn(usize) -> [i64; 3] + Copy,
    ) {
        let row = &mut self.row;
        row.overflow.resize(to.max(row.overflow.len()), 0);
        row.overflow[from..to].fill(0);
        let Some(gradient) = &self.gradient else {
            return;
        };
        let most = to.max(row.gradient[0].len());
        resize(&mut row.gradient, most);
        let [u, v, w] = &mut row.gradient;
        let Some(rays) = self.rays.as_ref().filter(|_| from < to) else {
            let out = [&mut u[from..to], &mut v[from..to], &mut w[from..to]];
            return gradient.run(from, neighbour, out, &mut row.overflow[from..to]);
        };
        // Where rays turn from running against u to running along it, the neighbourhood turns.
        let mirrored = rays.mirrored(at(from));
        let turn = (from..to).find(|&lane| rays.mirrored(at(lane))[0] != mirrored[0]).unwrap_or(to);
        for (from, to) in [(from, turn), (turn, to)] {
            if from < to {
                let mirrored = rays.mirrored(at(from));
                rays.local(from, to, at, &mut row.local);
                let out = [&mut u[from..to], &mut v[from..to], &mut w[from..to]];
                let turned = |i: usize, mirrored: bool| if mirrored { 2 - i } else { i };
                let neighbour =
                    |w: usize, v: usize, u: usize| neighbour(w, turned(v, mirrored[1]), turned(u, mirrored[0]));
                gradient.run_local(from, neighbour, &row.local, mirrored, out, &mut row.overflow[from..to]);
            }
        }
    }

    #[inline(always)]
    fn normal_stage(&mut self, from: usize, to: usize) {
        let Some(table) = &self.normaliser else {
            return;
        };
        normalise(&mut self.row, table, &self.words, from, to, self.table.rows.is_some());
    }

    #[inline(always)]
    fn table_stage(&mut self, from: usize, to: usize, table: &ReflectanceTable) {
        let row = &mut self.row;
        let most = to.max(row.diffuse[0].len());
        resize(&mut row.diffuse, most);
        resize(&mut row.specular, most);
        for lane in from..to {
            let gradient = [0, 1, 2].map(|i| row.gradient[i][lane]);
            let light = golden::reflectance(gradient, table);
            for i in 0..3 {
                row.diffuse[i][lane] = light.diffuse[i];
                row.specular[i][lane] = light.specular[i];
            }
        }
    }

    #[inline(always)]
    fn light_stage(&mut self, from: usize, to: usize, out: &mut ShadedRow) {
        let (row, words) = (&mut self.row, &self.words);
        let full = unit_full(words.colour_bits);
        let shift = words.rounding.by(words.colour_bits);
        // 8 lights of 15 and an ambient of 15 stay below 2^(colour_bits + 8).
        let narrow = 2 * words.colour_bits + 8 <= 32;
        let overflow = &mut row.overflow[from..to];
        for i in 0..3 {
            let colour = &mut out.colour[i][from..to];
            let (diffuse, specular) = (&row.diffuse[i][from..to], &row.specular[i][from..to]);
            let n = colour.len();
            let (diffuse, specular, overflow) = (&diffuse[..n], &specular[..n], &mut overflow[..n]);
            if narrow {
                for lane in 0..n {
                    let sum = ((colour[lane] * diffuse[lane] + shift.half as u32) >> shift.bits) + specular[lane];
                    overflow[lane] += u32::from(sum > full);
                    colour[lane] = sum.min(full);
                }
            } else {
                for lane in 0..n {
                    let product = u64::from(colour[lane]) * u64::from(diffuse[lane]);
                    let sum = ((product + shift.half as u64) >> shift.bits) as u32 + specular[lane];
                    overflow[lane] += u32::from(sum > full);
                    colour[lane] = sum.min(full);
                }
            }
        }
    }
}

/// Diffuse and specular light of the rows' normals.
#[inline(always)]
fn phong_stage(
    row: &mut Scratch,
    rays: Option<&RayLanes>,
    words: &Words,
    from: usize,
    to: usize,
    phong: &Phong,
    at: impl Fn(usize) -> [i64; 3] + Copy,
) {
    let most = to.max(row.power.len());
    resize(&mut row.cosine, most);
    resize(&mut row.diffuse, most);
    resize(&mut row.specular, most);
    row.power.resize(most, 0);
    for i in 0..3 {
        row.diffuse[i][from..to].fill(phong.ambient);
        row.specular[i][from..to].fill(0);
    }
    let narrow = words.colour_bits + 3 + words.normal_bits <= 31;
    for (number, light) in phong.lights.iter().enumerate() {
        if let Some(rays) = rays {
            rays.towards(number, light.direction, from, to, at, &mut row.towards);
            for (cosine, towards) in row.cosine.iter_mut().zip(&row.towards) {
                let towards = |lane: usize| [towards[0][lane], towards[1][lane], towards[2][lane]];
                dot(&row.direction, towards, phong.two_sided, words, from, &mut cosine[from..to]);
            }
        } else {
            for (cosine, direction) in row.cosine.iter_mut().zip([light.direction, light.halfway]) {
                dot(&row.direction, |_| direction, phong.two_sided, words, from, &mut cosine[from..to]);
            }
        }
        let [towards, half] = &row.cosine;
        let (towards, half, power) = (&towards[from..to], &half[from..to], &mut row.power[from..to]);
        look_up_power(half, towards, phong, words, power);
        let by_cosine = words.rounding.by(words.normal_bits - 1);
        let by_power = words.rounding.by(words.colour_bits);
        let wide_power = 2 * words.colour_bits + 4 > 31;
        for i in 0..3 {
            accumulate(towards, light.diffuse[i], by_cosine, narrow, &mut row.diffuse[i][from..to]);
            accumulate(power, light.specular[i], by_power, !wide_power, &mut row.specular[i][from..to]);
        }
    }
}

/// Light on a row of normals by Phong's formula, of a parallel frame: diffuse and specular, see [`golden::phong`].
pub fn phong_rows(direction: [Vec<i32>; 3], phong: &Phong, words: &Words) -> [[Vec<u32>; 3]; 2] {
    let n = direction[0].len();
    let mut row = Scratch { direction, ..Scratch::default() };
    phong_stage(&mut row, None, words, 0, n, phong, |_| [0; 3]);
    [row.diffuse, row.specular]
}

/// `out += round(weight · x)`.
#[inline(always)]
fn accumulate<T: Copy + Into<i64> + AsWord>(x: &[T], weight: u32, shift: Shift, narrow: bool, out: &mut [u32]) {
    let n = out.len();
    let x = &x[..n];
    if weight == 0 {
        return;
    }
    if narrow {
        for lane in 0..n {
            out[lane] += (x[lane].word() * weight + shift.half as u32) >> shift.bits;
        }
    } else {
        for lane in 0..n {
            out[lane] += shift.apply(x[lane].into() * i64::from(weight)) as u32;
        }
    }
}

/// A word that is not negative, as an unsigned one.
trait AsWord {
    fn word(self) -> u32;
}

impl AsWord for i32 {
    #[inline(always)]
    fn word(self) -> u32 {
        self as u32
    }
}

impl AsWord for u32 {
    #[inline(always)]
    fn word(self) -> u32 {
        self
    }
}

/// The cosine between directions and a light, which may be another one for each lane, counted from `from`.
#[inline(always)]
fn dot(
    direction: &[Vec<i32>; 3],
    light: impl Fn(usize) -> [i32; 3],
    two_sided: bool,
    words: &Words,
    from: usize,
    out: &mut [i32],
) {
    let n = out.len();
    let [u, v, w] = direction;
    let (u, v, w) = (&u[from..][..n], &v[from..][..n], &w[from..][..n]);
    let one = 1_i32 << (words.normal_bits - 1);
    // Three products of directions of at most 2^14 stay below 2^30.
    let shift = words.rounding.by(words.normal_bits - 1);
    if two_sided {
        for lane in 0..n {
            let light = light(lane);
            let dot = u[lane] * light[0] + v[lane] * light[1] + w[lane] * light[2];
            out[lane] = shift.apply32(dot.abs()).min(one);
        }
    } else {
        for lane in 0..n {
            let light = light(lane);
            let dot = u[lane] * light[0] + v[lane] * light[1] + w[lane] * light[2];
            out[lane] = shift.apply32(dot.max(0)).min(one);
        }
    }
}

#[inline(always)]
fn look_up_power(half: &[i32], towards: &[i32], phong: &Phong, words: &Words, out: &mut [u32]) {
    let n = out.len();
    let (half, towards) = (&half[..n], &towards[..n]);
    let shift = words.rounding.by(words.normal_bits - 1 - phong.power_bits);
    let table = &phong.power[..(1 << phong.power_bits) + 1];
    let last = table.len() - 1;
    if phong.two_sided {
        for lane in 0..n {
            out[lane] = table[(shift.apply32(half[lane]) as usize).min(last)];
        }
    } else {
        for lane in 0..n {
            let power = table[(shift.apply32(half[lane]) as usize).min(last)];
            out[lane] = if towards[lane] > 0 { power } else { 0 };
        }
    }
}

#[inline(always)]
fn normalise(row: &mut Scratch, table: &Normaliser, words: &Words, from: usize, to: usize, magnitude: bool) {
    let most = to.max(row.index.len());
    resize(&mut row.block, most);
    resize(&mut row.direction, most);
    row.index.resize(most, 0);
    row.reciprocal.resize(most, 0);
    row.magnitude.resize(most, 0);
    let n = to - from;
    let bits = words.normal_bits;
    let Scratch {
        gradient: [gu, gv, gw],
        block: [bu, bv, bw],
        index,
        reciprocal,
        direction: [du, dv, dw],
        magnitude: length,
        ..
    } = row;
    let (gu, gv, gw) = (&gu[from..to], &gv[from..to], &gw[from..to]);
    let (bu, bv, bw) = (&mut bu[from..to], &mut bv[from..to], &mut bw[from..to]);
    let (index, reciprocal) = (&mut index[from..to], &mut reciprocal[from..to]);
    let into = 2 * bits - 2 - table.root_bits;
    let first = 1_u32 << table.root_bits;
    for lane in 0..n {
        let sizes = [gu[lane].unsigned_abs(), gv[lane].unsigned_abs(), gw[lane].unsigned_abs()];
        let zeros = (sizes[0] | sizes[1] | sizes[2] | 1).leading_zeros();
        let block = [sizes[0] << zeros, sizes[1] << zeros, sizes[2] << zeros];
        let block = [block[0] >> (32 - bits), block[1] >> (32 - bits), block[2] >> (32 - bits)];
        let square = block[0] * block[0] + block[1] * block[1] + block[2] * block[2];
        bu[lane] = block[0];
        bv[lane] = block[1];
        bw[lane] = block[2];
        index[lane] = (square >> into).max(first) - first;
    }
    let root = table.root.as_slice();
    for lane in 0..n {
        reciprocal[lane] = root[index[lane] as usize];
    }
    let one = 1_u32 << (bits - 1);
    let half = 1_u32 << (bits - 1);
    for (block, gradient, out) in
        [(&*bu, gu, &mut du[from..to]), (&*bv, gv, &mut dv[from..to]), (&*bw, gw, &mut dw[from..to])]
    {
        for lane in 0..n {
            let size = ((block[lane] * reciprocal[lane] + half) >> bits).min(one) as i32;
            out[lane] = if gradient[lane] < 0 { -size } else { size };
        }
    }
    if magnitude {
        for lane in 0..n {
            let sizes = gu[lane].unsigned_abs() | gv[lane].unsigned_abs() | gw[lane].unsigned_abs();
            let sum = u64::from(bu[lane]) * u64::from(du[from + lane].unsigned_abs())
                + u64::from(bv[lane]) * u64::from(dv[from + lane].unsigned_abs())
                + u64::from(bw[lane]) * u64::from(dw[from + lane].unsigned_abs());
            length[from + lane] = golden::magnitude(sum, (sizes | 1).leading_zeros(), bits);
        }
    }
}

/// Directions and magnitudes of a row of gradients; see [`golden::normalise`].
pub fn normalise_rows(gradient: [Vec<i32>; 3], table: &Normaliser, words: &Words) -> ([Vec<i32>; 3], Vec<u32>) {
    let n = gradient[0].len();
    let mut row = Scratch { gradient, ..Scratch::default() };
    normalise(&mut row, table, words, 0, n, true);
    (row.direction, row.magnitude)
}

/// The classification tables, a word for opacity and colour together.
#[derive(Clone, Debug)]
pub struct ClassifyLanes {
    /// Opacity, red, green, blue in 16 bits each; the opacity is that of row 0. A table for each class of step lengths.
    packed: Vec<u64>,
    /// Entries of one class.
    width: usize,
    opacity: Vec<u32>,
    shift: u32,
    threshold: [u32; 2],
    rows: Option<(u32, u32)>,
    all: bool,
}

impl ClassifyLanes {
    /// Lanes for the tables of a frame.
    pub fn new(table: &Classification) -> ClassifyLanes {
        let packed = table
            .colour
            .iter()
            .cycle()
            .zip(&table.opacity)
            .map(|(colour, &opacity)| {
                u64::from(opacity)
                    | u64::from(colour[0]) << 16
                    | u64::from(colour[1]) << 32
                    | u64::from(colour[2]) << 48
            })
            .collect();
        let last = (table.colour.len() as u32).wrapping_shl(table.index_shift).wrapping_sub(1);
        ClassifyLanes {
            packed,
            width: table.colour.len(),
            opacity: if table.gradient_rows.is_some() { table.opacity.clone() } else { Vec::new() },
            shift: table.index_shift,
            threshold: table.threshold,
            rows: table.gradient_rows.map(|rows| (rows.shift, rows.rows - 1)),
            all: table.threshold[0] == 0 && table.threshold[1] >= last,
        }
    }

    /// Opacities of all lanes, and the span in which they are not 0. `magnitude` is read where the opacity depends on it; `class` may be
    /// empty where there is one class.
    #[inline(always)]
    pub fn opacity(
        &self,
        n: usize,
        samples: &[i32],
        magnitude: &[u32],
        class: &[u32],
        out: &mut ShadedRow,
    ) -> (usize, usize) {
        let width = self.width;
        let packed = self.packed.as_slice();
        let (opacity, samples) = (&mut out.opacity[..n], &samples[..n]);
        match self.rows {
            None if class.is_empty() => {
                for lane in 0..n {
                    opacity[lane] = packed[((samples[lane] as u32) >> self.shift) as usize] as u32 & 0xffff;
                }
            }
            None => {
                let class = &class[..n];
                for lane in 0..n {
                    let place = class[lane] as usize * width + ((samples[lane] as u32) >> self.shift) as usize;
                    opacity[lane] = packed[place] as u32 & 0xffff;
                }
            }
            Some((shift, last)) => {
                for lane in 0..n {
                    let class = class.get(lane).map_or(0, |&class| class * (last + 1));
                    let row = (class + (magnitude[lane] >> shift).min(last)) as usize;
                    opacity[lane] = self.opacity[row * width + ((samples[lane] as u32) >> self.shift) as usize];
                }
            }
        }
        let present = &mut out.present[..n];
        for lane in 0..n {
            if present[lane] == 0 {
                opacity[lane] = 0;
            }
        }
        if !self.all {
            for lane in 0..n {
                let word = samples[lane] as u32;
                if word < self.threshold[0] || word > self.threshold[1] {
                    present[lane] = 0;
                    opacity[lane] = 0;
                }
            }
        }
        let from = opacity.iter().position(|&a| a != 0).unwrap_or(n);
        let to = opacity.iter().rposition(|&a| a != 0).map_or(from, |last| last + 1);
        (from, to)
    }

    /// Colours of lanes `from` to `to`.
    #[inline(always)]
    pub fn colour(&self, from: usize, to: usize, samples: &[i32], out: &mut ShadedRow) {
        let (packed, samples) = (self.packed.as_slice(), &samples[from..to]);
        let [red, green, blue] = &mut out.colour;
        let (red, green, blue) = (&mut red[from..to], &mut green[from..to], &mut blue[from..to]);
        for lane in 0..to - from {
            let entry = packed[((samples[lane] as u32) >> self.shift) as usize];
            red[lane] = (entry >> 16) as u32 & 0xffff;
            green[lane] = (entry >> 32) as u32 & 0xffff;
            blue[lane] = (entry >> 48) as u32;
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

    /// Gradients of a parallel frame, and in `overflow` how many words of each lane were saturated, added to what is there. Lane 0 is
    /// lane `from` of each row of the neighbourhood; see [`golden::gradient`].
    #[inline(always)]
    pub fn run<'a>(
        &self,
        from: usize,
        neighbour: impl Fn(usize, usize, usize) -> &'a [i32] + Copy,
        out: [&mut [i32]; 3],
        overflow: &mut [u32],
    ) {
        let n = overflow.len();
        // Written out, as what is not inlined is not vectorised.
        let row = |w: usize, v: usize, u: usize| &neighbour(w, v, u)[from..from + n];
        let side = |w: usize, v: usize| [row(w, v, 0), row(w, v, 1), row(w, v, 2)];
        let slice = |w: usize| [side(w, 0), side(w, 1), side(w, 2)];
        let rows: Rows = [slice(0), slice(1), slice(2)];
        let [out_u, out_v, out_w] = out;
        if self.narrow {
            self.differences::<false>(&rows, out_u, out_v, out_w);
            self.hold::<false>([out_u, out_v, out_w], overflow);
        } else {
            self.differences::<true>(&rows, out_u, out_v, out_w);
            self.hold::<true>([out_u, out_v, out_w], overflow);
        }
    }

    /// Differences along u, v and w; see [`golden::gradient`].
    #[inline(always)]
    fn differences<const WIDE: bool>(&self, rows: &Rows, u: &mut [i32], v: &mut [i32], w: &mut [i32]) {
        let [du, dv] = self.weights;
        let n = u.len();
        let (v, w) = (&mut v[..n], &mut w[..n]);
        match self.method {
            GradientMethod::Six | GradientMethod::SixSheared | GradientMethod::Twelve => {
                subtract(rows[1][1][2], rows[1][1][0], u);
                subtract(rows[1][2][1], rows[1][0][1], v);
                if self.method == GradientMethod::Twelve {
                    let behind = [rows[2][1][1], rows[2][1][0], rows[2][0][1], rows[2][0][0]].map(|row| &row[..n]);
                    let before = [rows[0][1][1], rows[0][1][2], rows[0][2][1], rows[0][2][2]].map(|row| &row[..n]);
                    for i in 0..n {
                        let far = bilinear::<WIDE>(
                            [behind[0][i], behind[1][i], behind[2][i], behind[3][i]],
                            du,
                            dv,
                            self.lerp,
                        );
                        let near = bilinear::<WIDE>(
                            [before[0][i], before[1][i], before[2][i], before[3][i]],
                            du,
                            dv,
                            self.lerp,
                        );
                        w[i] = far - near;
                    }
                } else {
                    subtract(rows[2][1][1], rows[0][1][1], w);
                }
            }
            GradientMethod::TwentySix | GradientMethod::TwentySixSheared => {
                weighted(|a, b| [rows[a][b][2], rows[a][b][0]], u);
                weighted(|a, b| [rows[a][2][b], rows[a][0][b]], v);
                weighted(|a, b| [rows[2][a][b], rows[0][a][b]], w);
            }
            GradientMethod::Ten | GradientMethod::TenNormalised => {
                let [right, left] = [[rows[1][1][2], rows[0][1][2]], [rows[1][1][0], rows[2][1][0]]];
                feet::<WIDE>(right, left, du, self.lerp, u);
                let [below, above] = [[rows[1][2][1], rows[0][2][1]], [rows[1][0][1], rows[2][0][1]]];
                feet::<WIDE>(below, above, dv, self.lerp, v);
                subtract(rows[2][1][1], rows[0][1][1], w);
            }
        }
        if matches!(self.method, GradientMethod::SixSheared | GradientMethod::TwentySixSheared) {
            for i in 0..n {
                let along = if WIDE {
                    self.lerp.apply(i64::from(u[i]) * i64::from(du) + i64::from(v[i]) * i64::from(dv)) as i32
                } else {
                    self.lerp.apply32(u[i] * du + v[i] * dv)
                };
                w[i] -= along;
            }
        }
    }

    /// The gradient with weights and factors for each lane; see [`golden::local_gradient`]. `neighbour` gives the neighbourhood as it
    /// is `mirrored`.
    #[inline(always)]
    pub fn run_local<'a>(
        &self,
        from: usize,
        neighbour: impl Fn(usize, usize, usize) -> &'a [i32] + Copy,
        local: &LocalRows,
        mirrored: [bool; 2],
        out: [&mut [i32]; 3],
        overflow: &mut [u32],
    ) {
        let n = overflow.len();
        let rows: Rows = [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| &neighbour(w, v, u)[from..from + n])));
        if self.narrow {
            self.local::<false>(&rows, local, mirrored, out, overflow);
        } else {
            self.local::<true>(&rows, local, mirrored, out, overflow);
        }
    }

    #[inline(always)]
    fn local<const WIDE: bool>(
        &self,
        rows: &Rows,
        local: &LocalRows,
        mirrored: [bool; 2],
        [u, v, w]: [&mut [i32]; 3],
        overflow: &mut [u32],
    ) {
        let n = overflow.len();
        let (u, v, w) = (&mut u[..n], &mut v[..n], &mut w[..n]);
        let weighs = matches!(self.method, GradientMethod::TwentySix | GradientMethod::TwentySixSheared);
        if weighs {
            weighted(|a, b| [rows[a][b][2], rows[a][b][0]], u);
            weighted(|a, b| [rows[a][2][b], rows[a][0][b]], v);
            weighted(|a, b| [rows[2][a][b], rows[0][a][b]], w);
        } else {
            subtract(rows[1][1][2], rows[1][1][0], u);
            subtract(rows[1][2][1], rows[1][0][1], v);
            if self.method == GradientMethod::Twelve {
                let slice = |w: usize, v: usize, u: usize| {
                    [rows[w][1][1], rows[w][1][u], rows[w][v][1], rows[w][v][u]].map(|row| &row[..n])
                };
                let (behind, before) = (slice(2, 0, 0), slice(0, 2, 2));
                let [behind_u, behind_v] = local.behind.each_ref().map(|weights| &weights[..n]);
                let [before_u, before_v] = local.before.each_ref().map(|weights| &weights[..n]);
                for i in 0..n {
                    let far = bilinear::<WIDE>(behind.map(|row| row[i]), behind_u[i], behind_v[i], self.lerp);
                    let near = bilinear::<WIDE>(before.map(|row| row[i]), before_u[i], before_v[i], self.lerp);
                    w[i] = far - near;
                }
            } else {
                subtract(rows[2][1][1], rows[0][1][1], w);
            }
        }
        if let Some(nearness) = &local.nearness {
            for (word, &near) in w.iter_mut().zip(nearness) {
                *word = self.whole.apply(i64::from(*word) * i64::from(near)) as i32;
            }
        }
        if matches!(self.method, GradientMethod::SixSheared | GradientMethod::TwentySixSheared) {
            let [du, dv] = local.here.each_ref().map(|weights| &weights[..n]);
            for i in 0..n {
                let along = if WIDE {
                    self.lerp.apply(i64::from(u[i]) * i64::from(du[i]) + i64::from(v[i]) * i64::from(dv[i])) as i32
                } else {
                    self.lerp.apply32(u[i] * du[i] + v[i] * dv[i])
                };
                w[i] -= along;
            }
        }
        for (component, mirrored) in [&mut *u, &mut *v].into_iter().zip(mirrored) {
            if mirrored {
                component.iter_mut().for_each(|word| *word = -*word);
            }
        }
        for (component, factors) in [&mut *u, &mut *v, &mut *w].into_iter().zip(&local.factors) {
            let factors = &factors[..n];
            for i in 0..n {
                component[i] = mul::<WIDE>(component[i], factors[i], self.scaling);
            }
        }
        self.drop_low_bits([u, v, w], overflow);
    }

    /// Scales differences, drops their low bits, and holds them to the gradient's word.
    #[inline(always)]
    fn hold<const WIDE: bool>(&self, mut components: [&mut [i32]; 3], overflow: &mut [u32]) {
        let n = overflow.len();
        for (i, component) in components.iter_mut().enumerate() {
            let component = &mut component[..n];
            if let Some(factors) = self.factors {
                let factor = factors[i] as i32;
                for word in component.iter_mut() {
                    *word = mul::<WIDE>(*word, factor, self.scaling);
                }
            }
        }
        self.drop_low_bits(components, overflow);
    }

    #[inline(always)]
    fn drop_low_bits(&self, components: [&mut [i32]; 3], overflow: &mut [u32]) {
        let n = overflow.len();
        for component in components {
            let component = &mut component[..n];
            for lane in 0..n {
                let dropped = self.drop.apply32(component[lane]);
                let held = dropped.clamp(-self.top - 1, self.top);
                overflow[lane] += u32::from(held != dropped);
                component[lane] = held;
            }
        }
    }
}

/// Rows of the neighbourhood, `[w][v][u]`, all of one length.
type Rows<'a> = [[[&'a [i32]; 3]; 3]; 3];

#[inline(always)]
fn subtract(far: &[i32], near: &[i32], out: &mut [i32]) {
    let n = out.len();
    let (far, near) = (&far[..n], &near[..n]);
    for i in 0..n {
        out[i] = far[i] - near[i];
    }
}

/// Differences of nine pairs of rows with weights 1, 2, 1 both ways.
#[inline(always)]
fn weighted<'a>(pair: impl Fn(usize, usize) -> [&'a [i32]; 2], out: &mut [i32]) {
    let n = out.len();
    out.fill(0);
    for (a, first) in [1, 2, 1].into_iter().enumerate() {
        for (b, second) in [1, 2, 1].into_iter().enumerate() {
            let weight = first * second;
            let [far, near] = pair(a, b);
            let (far, near) = (&far[..n], &near[..n]);
            for i in 0..n {
                out[i] += weight * (far[i] - near[i]);
            }
        }
    }
}

/// The difference of two lerps, each of a pair of rows.
#[inline(always)]
fn feet<const WIDE: bool>(plus: [&[i32]; 2], minus: [&[i32]; 2], weight: i32, shift: Shift, out: &mut [i32]) {
    let n = out.len();
    let ([p0, p1], [m0, m1]) = (plus.map(|row| &row[..n]), minus.map(|row| &row[..n]));
    for i in 0..n {
        out[i] = lerp::<WIDE>(p0[i], p1[i], weight, shift) - lerp::<WIDE>(m0[i], m1[i], weight, shift);
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
