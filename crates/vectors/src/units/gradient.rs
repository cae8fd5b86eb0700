//! The gradient unit, a unit for each of its estimators.

use super::contents::Noise;
use super::lerp_wires;
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder, word_formats};
use cube3_abc::golden::{Local, local_gradient_wires};
use cube3_abc::lanes::{Around, GradientLanes, LocalBlock};
use cube3_frame::{GradientRegisters, GradientScale};
use cube3_machine::{Differences, Estimator, GradientMethod};
use cube3_word::{BLOCK_LANES, LaneBlock};

/// The gradient of one estimator.
pub struct GradientSheet(pub GradientMethod);

/// One, of factors and nearness.
const ONE: u32 = 1 << GradientScale::FACTOR_BITS;

/// The wires of a component from `from`, within ± `reach`, to its word.
macro_rules! component {
    ($part:literal, $count:literal, $from:literal, $reach:literal, $drop:literal) => {
        [
            Wire::new(
                "product",
                concat!($from, " · factor"),
                concat!("-(", $reach, ") * 2^16"),
                concat!("(", $reach, ") * 2^16"),
            ),
            Wire::new(
                "scaled",
                "product / 2^(16 − K), rounded",
                concat!("-(", $reach, ") * 2^K"),
                concat!("(", $reach, ") * 2^K"),
            )
            .made_by(WireKind::Rounded { of: "product", bits: "16 - K" }),
            Wire::new("dropped", concat!("scaled / 2^", $drop, ", rounded"), low!($reach, $drop), high!($reach, $drop))
                .made_by(WireKind::Rounded { of: "scaled", bits: $drop }),
            Wire::new(
                "word",
                "dropped, held in G bits",
                concat!("max(", low!($reach, $drop), ", -2^(G - 1))"),
                concat!("min(", high!($reach, $drop), ", 2^(G - 1) - 1)"),
            )
            .made_by(WireKind::Held { of: "dropped", low: "-2^(G - 1)", high: "2^(G - 1) - 1" }),
        ]
        .map(|wire| wire.of($part).times($count))
        .to_vec()
    };
}

/// The lowest value of a difference within ± `reach` behind the factor and without its lowest bits.
macro_rules! low {
    ($reach:literal, $drop:literal) => {
        concat!("(-(", $reach, ") * 2^K + NEAREST * (2^", $drop, " / 2)) / 2^", $drop)
    };
}

/// The highest.
macro_rules! high {
    ($reach:literal, $drop:literal) => {
        concat!("((", $reach, ") * 2^K + NEAREST * (2^", $drop, " / 2)) / 2^", $drop)
    };
}

/// Whether a word can be beyond its bits at all.
macro_rules! overflows {
    ($reach:literal, $drop:literal) => {
        concat!("min(1, max(0, ", high!($reach, $drop), " - (2^(G - 1) - 1)))")
    };
}

/// A difference within ± `reach`.
macro_rules! difference {
    ($name:literal, $formula:literal, $reach:literal) => {
        Wire::new($name, $formula, concat!("-(", $reach, ")"), $reach)
    };
}

/// The difference along the ray in front of an eye that is near, within ± `reach`.
macro_rules! nearness {
    ($straight:literal, $reach:literal) => {
        [
            difference!("straight", $straight, $reach),
            Wire::new(
                "near_product",
                "straight · nearness",
                concat!("-(", $reach, ") * 2^16"),
                concat!("(", $reach, ") * 2^16"),
            ),
            difference!("near", "near_product / 2^16, rounded", $reach)
                .made_by(WireKind::Rounded { of: "near_product", bits: "16" }),
        ]
        .map(|wire| wire.of("along"))
        .to_vec()
    };
}

/// What u and v, within ± `reach` each and together within ± `sum`, have of the ray.
macro_rules! shear {
    ($reach:literal, $sum:literal) => {
        [
            Wire::new(
                "shear_product",
                "difference across · here",
                concat!("-(", $reach, ") * 2^W"),
                concat!("(", $reach, ") * 2^W"),
            )
            .times("2"),
            Wire::new("shear_sum", "sum of the two", concat!("-(", $sum, ") * 2^W"), concat!("(", $sum, ") * 2^W")),
            difference!("shear", "shear_sum / 2^W, rounded", $sum)
                .made_by(WireKind::Rounded { of: "shear_sum", bits: "W" }),
        ]
        .map(|wire| wire.of("along"))
        .to_vec()
    };
}

impl GradientSheet {
    /// The six that a machine can be built with; 10 and 10 normalised differ in their factors alone.
    pub fn all() -> Vec<Box<dyn Unit>> {
        use GradientMethod::{Six, SixSheared, Ten, Twelve, TwentySix, TwentySixSheared};
        let unit = |method| Box::new(GradientSheet(method)) as Box<dyn Unit>;
        [Six, TwentySix, Ten, Twelve, SixSheared, TwentySixSheared].map(unit).into()
    }

    fn is_ten(&self) -> bool {
        self.0.row().differences == Differences::Feet
    }

    /// Purpose, wires, and whether a word can overflow.
    fn arithmetic(&self) -> (&'static str, Vec<Wire>, &'static str) {
        let across = |reach: Wire| vec![reach.of("across").times("2")];
        let along = |reach: Wire| vec![reach.of("along")];
        let pair = Wire::new("pair", "s − s, 9 pairs along u, 9 along v, 9 along w", "-M", "M").times("27");
        match self.0 {
            GradientMethod::Six => (
                "Differences of the six neighbours on the grid of rays.",
                [
                    across(difference!("difference", "the next sample − the one before", "M")),
                    across(difference!("turned", "difference, negated in the mirror", "M")),
                    component!("across", "2", "turned", "M", "D"),
                    nearness!("the sample behind − the one before", "M"),
                    along(difference!("difference", "near", "M")),
                    component!("along", "1", "difference", "M", "D"),
                ]
                .concat(),
                overflows!("M", "D"),
            ),
            GradientMethod::TwentySix => (
                "Each component is a sum of nine differences with weights 4, 2, 1 by their distance, sixteen times a difference of one \
                 pair; the four bits are dropped with the others.",
                [
                    vec![pair],
                    across(difference!("difference", "the pairs by 4, 2, 1", "16 * M")),
                    across(difference!("turned", "difference, negated in the mirror", "16 * M")),
                    component!("across", "2", "turned", "16 * M", "(D + 4)"),
                    nearness!("the pairs by 4, 2, 1", "16 * M"),
                    along(difference!("difference", "near", "16 * M")),
                    component!("along", "1", "difference", "16 * M", "(D + 4)"),
                ]
                .concat(),
                overflows!("16 * M", "(D + 4)"),
            ),
            GradientMethod::Ten | GradientMethod::TenNormalised => (
                "Differences of the feet of the perpendiculars from the sample onto its four neighbour rays, and along the ray. It serves \
                 parallel frames alone: `mirrored` is 0 and `nearness` 1.",
                [
                    lerp_wires("foot", "4").to_vec(),
                    across(difference!("difference", "foot right − left; below − above", "M")),
                    across(difference!("turned", "difference, negated in the mirror", "M")),
                    component!("across", "2", "turned", "M", "D"),
                    along(difference!("difference", "the sample behind − the one before", "M")),
                    component!("along", "1", "difference", "M", "D"),
                ]
                .concat(),
                overflows!("M", "D"),
            ),
            GradientMethod::Twelve => (
                "Differences of the four neighbours on the slice, and of two samples straight behind and before, each between four rays.",
                [
                    lerp_wires("along_u", "4").to_vec(),
                    lerp_wires("along_v", "2").to_vec(),
                    across(difference!("difference", "the next sample − the one before", "M")),
                    across(difference!("turned", "difference, negated in the mirror", "M")),
                    component!("across", "2", "turned", "M", "D"),
                    nearness!("straight behind − straight before", "M"),
                    along(difference!("difference", "near", "M")),
                    component!("along", "1", "difference", "M", "D"),
                ]
                .concat(),
                overflows!("M", "D"),
            ),
            GradientMethod::SixSheared => (
                "Differences of the six neighbours on the grid of rays; from the one along the ray, what the ray has of u and v is taken \
                 away.",
                [
                    across(difference!("difference", "the next sample − the one before", "M")),
                    across(difference!("turned", "difference, negated in the mirror", "M")),
                    component!("across", "2", "turned", "M", "D"),
                    nearness!("the sample behind − the one before", "M"),
                    shear!("M", "2 * M"),
                    along(difference!("difference", "near − shear", "3 * M")),
                    component!("along", "1", "difference", "3 * M", "D"),
                ]
                .concat(),
                overflows!("3 * M", "D"),
            ),
            GradientMethod::TwentySixSheared => (
                "Sums of nine differences as 26 has them; from the one along the ray, what the ray has of u and v is taken away. The sums \
                 share their samples: what one corner adds to u it takes from v. So u and v together reach 24·M, not 32·M, and what is \
                 left of the ray 30·M, not 48·M.",
                [
                    vec![pair],
                    across(difference!("difference", "the pairs by 4, 2, 1", "16 * M")),
                    across(difference!("turned", "difference, negated in the mirror", "16 * M")),
                    component!("across", "2", "turned", "16 * M", "(D + 4)"),
                    nearness!("the pairs by 4, 2, 1", "16 * M"),
                    shear!("16 * M", "24 * M"),
                    along(difference!("difference", "near − shear", "30 * M")),
                    component!("along", "1", "difference", "30 * M", "(D + 4)"),
                ]
                .concat(),
                overflows!("30 * M", "(D + 4)"),
            ),
        }
    }

    fn registers(&self, local: &Local, format: &UnitFormat) -> GradientRegisters {
        let scale = local.factors.map(|factors| GradientScale { factors, kept_bits: format.kept_bits });
        GradientRegisters { method: self.0, weights: local.here, scale, border: 0 }
    }

    /// Words and saturated words of lines by the lanes, with one of the components alone where the others' factors are 0.
    fn rows(&self, format: &UnitFormat, lines: &[Line]) -> Vec<([i32; 3], u32)> {
        let mut all = vec![([0; 3], 0); lines.len()];
        let (parallel, others): (Vec<usize>, Vec<usize>) =
            (0..lines.len()).partition(|&line| self.is_ten() || is_parallel(&lines[line].local));
        let runs = parallel.into_iter().map(|line| vec![line]).chain([0, 1, 2, 3].map(|side| {
            let mirrored = [side & 1 != 0, side & 2 != 0];
            others.iter().copied().filter(|&line| lines[line].local.mirrored == mirrored).collect()
        }));
        for run in runs {
            let Some(first) = run.first().map(|&line| &lines[line].local) else { continue };
            let parallel = self.is_ten() || is_parallel(first);
            let lanes = GradientLanes::new(self.registers(first, format), &format.words);
            let turn = |i: usize, mirrored: bool| if mirrored { 2 - i } else { i };
            for part in run.chunks(BLOCK_LANES) {
                let words = |of: &dyn Fn(&Line) -> i32| -> LaneBlock<i32> {
                    std::array::from_fn(|lane| part.get(lane).map_or(0, |&line| of(&lines[line])))
                };
                let around: Around = std::array::from_fn(|place| {
                    let [w, v, u] = [place / 9, place / 3 % 3, place % 3];
                    let place = w * 9 + turn(v, first.mirrored[1]) * 3 + turn(u, first.mirrored[0]);
                    words(&|line| line.samples[place])
                });
                let (mut out, mut overflow) = ([[0; BLOCK_LANES]; 3], [0; BLOCK_LANES]);
                if parallel {
                    cube3_word::vectorised(|| lanes.run(&around, &mut out, &mut overflow));
                } else {
                    let weights = |of: fn(&Local) -> [u32; 2]| [0, 1].map(|i| words(&|line| of(&line.local)[i] as i32));
                    let nearness = words(&|line| line.local.nearness.unwrap_or(ONE) as i32);
                    let local = LocalBlock {
                        here: weights(|local| local.here),
                        behind: weights(|local| local.behind),
                        before: weights(|local| local.before),
                        factors: [0, 1, 2].map(|i| words(&|line| line.local.factors.map_or(0, |f| f[i] as i32))),
                        nearness: Some(nearness.map(|word| word as u32)),
                    };
                    cube3_word::vectorised(|| {
                        lanes.run_local(&around, &local, first.mirrored, &mut out, &mut overflow)
                    });
                }
                for (lane, &line) in part.iter().enumerate() {
                    all[line] = ([out[0][lane], out[1][lane], out[2][lane]], overflow[lane]);
                }
            }
        }
        all
    }
}

/// The fields of a line.
#[derive(Clone)]
struct Line {
    samples: [i32; 27],
    local: Local,
}

impl Line {
    fn new(inputs: &[i128]) -> Line {
        let mut fields = Reader::new(inputs);
        Line {
            samples: fields.signed_words(),
            local: Local {
                here: fields.words(),
                behind: fields.words(),
                before: fields.words(),
                mirrored: [fields.flag(), fields.flag()],
                factors: Some(fields.words()),
                nearness: Some(fields.word()),
            },
        }
    }
}

/// Whether a sample could be one of a parallel frame.
fn is_parallel(local: &Local) -> bool {
    let alike = local.behind == local.here && local.before == local.here;
    alike && local.mirrored == [false; 2] && local.nearness == Some(ONE)
}

/// A line with the same weights on all planes.
fn corner(samples: [i128; 27], weights: [i128; 2], factors: [i128; 3], nearness: i128) -> Vec<i128> {
    [samples.to_vec(), [weights; 3].concat(), vec![0; 2], factors.to_vec(), vec![nearness]].concat()
}

/// Samples by their displacement along u, v and w, each −1 to 1.
fn samples(of: impl Fn([i32; 3]) -> i128) -> [i128; 27] {
    std::array::from_fn(|i| of([i % 3, i / 3 % 3, i / 9].map(|at| at as i32 - 1)))
}

/// Samples of parallel frames, which have lanes of their own.
fn parallel(format: &UnitFormat) -> Vec<Vec<i128>> {
    let mut noise = Noise::new(1);
    let top = format.value_of("M").unwrap_or_default();
    let weight = 1 << format.words.weight_bits;
    let mut line = |_| {
        let samples = std::array::from_fn(|_| noise.up_to(top));
        let weights = std::array::from_fn(|_| noise.up_to(weight));
        corner(samples, weights, std::array::from_fn(|_| noise.up_to(ONE.into())), ONE.into())
    };
    (0..16).map(&mut line).collect()
}

/// Each component furthest from 0 and a whole number of its words; what u and v together, and what is left of the ray without
/// them, are furthest from 0: where no field alone leads, as a weight of 0 hides the differences that it weighs.
fn extremes(format: &UnitFormat) -> Vec<Vec<i128>> {
    let top = format.value_of("M").unwrap_or_default();
    let weight = 1 << format.words.weight_bits;
    let near = |at: i32| 2 - at.abs();
    let across = |[u, v, w]: [i32; 3]| near(w) * (near(v) * u + near(u) * v);
    let left = |at: [i32; 3]| near(at[0]) * near(at[1]) * at[2] - across(at);
    let line = |size: i128, weight: i128, part: &dyn Fn([i32; 3]) -> i32| {
        let samples = samples(|at| if part(at) > 0 { size } else { 0 });
        corner(samples, [weight; 2], [ONE.into(); 3], ONE.into())
    };
    let mut lines = Vec::new();
    for sign in [-1, 1] {
        lines.push(line(top, weight, &|at| sign * across(at)));
        lines.push(line(top, weight, &|at| sign * left(at)));
        for axis in 0..3 {
            lines.push(line(top, 0, &|at| sign * at[axis]));
            lines.push(line(1 << format.words.gradient_drop(), 0, &|at| sign * at[axis]));
        }
    }
    lines
}

/// Differences of 1 and −1 with factors, and with a nearness, that leave a half.
fn ties(format: &UnitFormat) -> Vec<Vec<i128>> {
    let half = i128::from(ONE / 2);
    let mut lines = Vec::new();
    for side in [-1, 1] {
        let faces =
            samples(|at| i128::from(at.iter().sum::<i32>() == side && at.iter().filter(|x| **x != 0).count() == 1));
        let corners = samples(|at| i128::from(at == [side; 3]));
        for samples in [faces, corners] {
            lines.push(corner(samples, [0; 2], [half >> format.kept_bits; 3], ONE.into()));
            lines.push(corner(samples, [0; 2], [ONE.into(); 3], half));
        }
    }
    lines
}

impl Unit for GradientSheet {
    fn sheet(&self) -> Sheet {
        let Estimator { unit: name, title, rtl_parameters: parameters, .. } = *self.0.row();
        let (purpose, wires, overflows) = self.arithmetic();
        let [mirrored, nearness] = if self.is_ten() { ["0", "2^16"] } else { ["1", "0"] };
        Sheet {
            name,
            title,
            purpose,
            source: "Pfister et al. 1995, section 4; `cube3_abc::golden::local_gradient`",
            parameters: &["voxel_bits", "sample_fraction_bits", "weight_bits", "gradient_bits", "kept_bits", "nearest"],
            module: Some(("cube3_gradient", parameters)),
            inputs: vec![
                Port::unsigned("s", "S", "samples of the neighbourhood, number 9·w + 3·v + u")
                    .times("27")
                    .within("0", "M"),
                Port::unsigned("here", "W + 1", "by how many rays the ray moves to the next plane along u and v")
                    .times("2")
                    .within("0", "2^W"),
                Port::unsigned("behind", "W + 1", "the same in rays of the plane behind").times("2").within("0", "2^W"),
                Port::unsigned("ahead", "W + 1", "and of the plane before").times("2").within("0", "2^W"),
                Port::unsigned("mirrored", "1", "whether the ray runs against u and v")
                    .times("2")
                    .within("0", mirrored),
                Port::unsigned("factor", "17", "factors of the components, fractions of 16 bits")
                    .times("3")
                    .within("0", "2^16"),
                Port::unsigned("nearness", "17", "factor of the difference along the ray, a fraction of 16 bits")
                    .within(nearness, "2^16"),
            ],
            tables: Vec::new(),
            wires,
            outputs: vec![
                Port::signed("g", "G", "components along u, v, w").times("3"),
                Port::unsigned("overflow", "1", "whether the word was held").times("3").within("0", overflows),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let Line { samples, local } = Line::new(inputs);
        let s = [0, 1, 2].map(|w| [0, 1, 2].map(|v| [0, 1, 2].map(|u| samples[9 * w + 3 * v + u])));
        let nearness = local.nearness.filter(|_| !self.is_ten());
        let local = Local { nearness, ..local };
        let words = local_gradient_wires(&s, &self.registers(&local, format), &local, &format.words, probe);
        let (g, overflow) = (words.map(|(word, _)| word.into()), words.map(|(_, saturated)| saturated.into()));
        [g, overflow].concat()
    }

    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        [parallel(format), extremes(format), ties(format)].concat()
    }

    /// Words as wide as differences, and with the most bits that a scale keeps.
    fn formats(&self) -> Vec<UnitFormat> {
        let kept = |format: UnitFormat| UnitFormat {
            kept_bits: GradientScale::FACTOR_BITS.min(GradientScale::room(self.0, &format.words)),
            ..format
        };
        let formats = word_formats();
        let truncated = formats[5..].iter().map(|format| kept(*format));
        formats[..5].iter().copied().chain([kept(formats[0]), kept(formats[1])]).chain(truncated).collect()
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let lines: Vec<Line> = lines.iter().map(|line| Line::new(line)).collect();
        // The lanes count a sample's words; a component whose factor is 0 has none.
        let alone = [0, 1, 2].map(|i| {
            let mut lines = lines.clone();
            for line in &mut lines {
                line.local.factors =
                    line.local.factors.map(|factors| std::array::from_fn(|j| if i == j { factors[j] } else { 0 }));
            }
            self.rows(format, &lines)
        });
        let all = self.rows(format, &lines);
        let answer = |line: usize| {
            let words = all[line].0.map(i128::from);
            [words, [0, 1, 2].map(|i| i128::from(alone[i][line].1))].concat()
        };
        Some((0..lines.len()).map(answer).collect())
    }
}
