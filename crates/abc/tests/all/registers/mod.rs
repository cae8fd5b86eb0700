//! Random registers and samples, as wide as their documentation allows.

use cube3_abc::golden::Neighbourhood;
use cube3_frame::{
    Axes, Classification, ConeRegisters, FrameSetup, Geometry, GradientRegisters, GradientRows, GradientScale,
    HalfSpace, Linear, LinearFactor, Normaliser, Phong, PhongLight, ReflectanceTable, Shading,
};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{
    Abc, ConeOrder, GradientMethod, MachineSpec, RayEnds, RaySlots, Rays, Reuse, ShadingUnit, TemplateRule,
};
use cube3_scene::{ColourPoint, Crop, Cut, DepthCue, Layer, Light, Material, Mode, Scene, Threshold, Transfer, View};
use cube3_word::{Rounding, Words, unit_full};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Numbers that look random, the same for a seed.
pub struct Dice(ChaCha8Rng);

impl Dice {
    pub fn new(seed: u64) -> Dice {
        Dice(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Numbers of their own for each place.
    pub fn at(seed: u64, place: u64) -> Dice {
        let mut dice = Dice::new(seed);
        dice.0.set_stream(place);
        dice
    }

    pub fn roll(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// From `low` to `high` inclusive; each end once in eight times.
    pub fn within(&mut self, low: i64, high: i64) -> i64 {
        match self.roll() % 8 {
            0 => low,
            1 => high,
            _ => low + (self.roll() % (high - low + 1) as u64) as i64,
        }
    }

    /// The same for words.
    pub fn word(&mut self, low: u32, high: u32) -> u32 {
        self.within(i64::from(low), i64::from(high)) as u32
    }

    pub fn real(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.roll() >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn one_in(&mut self, n: u64) -> bool {
        self.roll().is_multiple_of(n)
    }
}

/// Any word lengths that the units can hold.
pub fn words(dice: &mut Dice) -> Words {
    let voxel_bits = dice.word(1, 16);
    let sample_fraction_bits = dice.word(0, 8);
    let sample_bits = voxel_bits + sample_fraction_bits;
    // Most tables are small, for the tests' speed alone.
    let table_top = if dice.one_in(16) { 16 } else { 9 };
    let words = Words {
        voxel_bits,
        weight_bits: dice.word(0, 12),
        sample_fraction_bits,
        gradient_bits: dice.word(2, (sample_bits + 1).min(24)),
        normal_bits: dice.word(4, 15),
        table_bits: dice.word(1, sample_bits.min(table_top)),
        table_gradient_bits: dice.word(1, 8),
        colour_bits: dice.word(1, 16),
        opacity_bits: dice.word(1, 16),
        accumulator_bits: dice.word(1, 32),
        rounding: if dice.one_in(2) { Rounding::Nearest } else { Rounding::Truncate },
    };
    words.check().unwrap();
    words
}

/// The normaliser's table, by its own definition.
pub fn normaliser(bits: u32, root_bits: u32) -> Normaliser {
    let root_bits = root_bits.min(2 * bits - 2);
    let bin = f64::from(2 * bits - 2 - root_bits).exp2();
    let top = f64::from(2 * bits - 1).exp2();
    let entry = |i: u32| (top / ((f64::from(i) + 0.5) * bin).sqrt()).round() as u32;
    Normaliser { root: (1 << root_bits..12 << root_bits).map(|i| entry(i).min(1 << bits)).collect(), root_bits }
}

fn phong(dice: &mut Dice, words: &Words) -> Phong {
    let one = 1 << (words.normal_bits - 1);
    let intensity = (16 << words.colour_bits) - 1;
    let power_bits = dice.word(1, 11.min(words.normal_bits - 1));
    let lights = dice.within(0, 8);
    let mut light = || PhongLight {
        direction: [0; 3].map(|_| dice.within(-one, one) as i32),
        halfway: [0; 3].map(|_| dice.within(-one, one) as i32),
        diffuse: [0; 3].map(|_| dice.word(0, intensity)),
        specular: [0; 3].map(|_| dice.word(0, intensity)),
    };
    let lights = (0..lights).map(|_| light()).collect();
    Phong {
        ambient: dice.word(0, intensity),
        two_sided: dice.one_in(2),
        lights,
        power: (0..=1 << power_bits).map(|_| dice.word(0, 1 << words.colour_bits)).collect(),
        power_bits,
    }
}

/// Lights that shine straight at every normal: intensities near their limits, and full highlights in green and blue.
pub fn bright(dice: &mut Dice, words: &Words, lights: usize) -> Phong {
    let one = 1 << (words.normal_bits - 1);
    let intensity = (16 << words.colour_bits) - 1;
    let power_bits = 1;
    let mut light = || PhongLight {
        direction: [one; 3],
        halfway: [one; 3],
        diffuse: [0; 3].map(|_| dice.word(intensity / 2, intensity)),
        specular: [0, dice.word(0, intensity), dice.word(0, intensity)],
    };
    let lights = (0..lights).map(|_| light()).collect();
    Phong {
        ambient: dice.word(0, intensity),
        two_sided: true,
        lights,
        power: vec![1 << words.colour_bits; 3],
        power_bits,
    }
}

fn reflectance(dice: &mut Dice, words: &Words) -> ReflectanceTable {
    let bits = dice.word(2, 5);
    let intensity = (16 << words.colour_bits) - 1;
    let mut entries = || (0..6 << (2 * bits)).map(|_| [0; 3].map(|_| dice.word(0, intensity))).collect();
    let (diffuse, specular) = (entries(), entries());
    ReflectanceTable { bits, diffuse, specular, flat: dice.word(0, intensity) }
}

fn classification(dice: &mut Dice, words: &Words, rows: Option<GradientRows>) -> Classification {
    let last = unit_full(words.sample_bits());
    let entries = 1 << words.table_bits;
    // Opacity comes in stretches, some of them clear, so that rows have transparent ends and gaps.
    let stretch = dice.word(1, 16);
    let mut clear = false;
    let mut opacity = |i: u32| {
        clear = if i.is_multiple_of(stretch) { dice.one_in(2) } else { clear };
        if clear { 0 } else { dice.word(0, unit_full(words.opacity_bits)) }
    };
    let opacity = (0..entries * rows.map_or(1, |rows| rows.rows)).map(&mut opacity).collect();
    let colour = (0..entries).map(|_| [0; 3].map(|_| dice.word(0, unit_full(words.colour_bits)))).collect();
    let threshold = if dice.one_in(2) { [0, last] } else { [dice.word(0, last), dice.word(0, last)] };
    let index_shift = words.sample_bits() - words.table_bits;
    Classification { threshold, index_shift, opacity, colour, gradient_rows: rows }
}

fn linear(dice: &mut Dice, fraction_bits: u32) -> Linear {
    let one = 1_i64 << fraction_bits;
    Linear {
        u: dice.within(-one, one),
        v: dice.within(-one, one),
        k: dice.within(-3 * one, 3 * one),
        constant: dice.within(-100 * one, 100 * one),
    }
}

fn geometry(words: &Words) -> Geometry {
    let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
    Geometry::new([1; 3], axes, [0; 2], 0, words.weight_bits, TemplateRule::PlaneFloor, RaySlots::Wrapped)
}

/// Registers at random, each within its range, and none absent that another reads.
pub fn frame(dice: &mut Dice) -> FrameSetup {
    let words = words(dice);
    let rows = dice.one_in(3).then(|| GradientRows {
        shift: dice.word(0, words.gradient_bits),
        rows: dice.word(1, 1 << words.table_gradient_bits.min(14 - words.table_bits.min(13))),
    });
    let shading = match dice.roll() % 4 {
        0 => None,
        1 => Some(Shading::Table(reflectance(dice, &words))),
        _ => Some(Shading::Phong(phong(dice, &words))),
    };
    let normal_read = rows.is_some() || matches!(shading, Some(Shading::Phong(_)));
    let normaliser = (normal_read || dice.one_in(3)).then(|| normaliser(words.normal_bits, dice.word(4, 10)));
    let gradient_read = normaliser.is_some() || shading.is_some();
    let one = 1 << words.weight_bits;
    let method = GradientMethod::ALL[dice.within(0, 6) as usize].0;
    let room = GradientScale::room(method, &words).min(GradientScale::FACTOR_BITS);
    let scale = dice.one_in(2).then(|| GradientScale {
        factors: [0; 3].map(|_| dice.word(0, 1 << GradientScale::FACTOR_BITS)),
        kept_bits: dice.word(0, room),
    });
    let gradient = (gradient_read || dice.one_in(3)).then(|| GradientRegisters {
        method,
        weights: [dice.word(0, one), dice.word(0, one)],
        scale,
        border: dice.word(0, unit_full(words.sample_bits())) as i32,
    });
    FrameSetup {
        schema: 1,
        words,
        geometry: geometry(&words),
        reuse: Reuse::Both,
        clips: (0..dice.within(0, 12) / 4)
            .map(|_| HalfSpace { distance: linear(dice, HalfSpace::FRACTION_BITS) })
            .collect(),
        classification: classification(dice, &words, rows),
        gradient,
        normaliser,
        shading,
        depth_cue: dice.one_in(3).then(|| LinearFactor { factor: linear(dice, LinearFactor::FRACTION_BITS - 6) }),
        cone: ConeRegisters { mode: Mode::Composite, order: ConeOrder::Tree, leaves: 1, opaque: 1, sum_weight: 0 },
        rays: None,
        ends: None,
    }
}

/// Any machine with these words.
pub fn machine(dice: &mut Dice, words: Words) -> MachineSpec {
    let one_of = |wanted: bool| if wanted { RaySlots::Wrapped } else { RaySlots::Padded };
    let machine = MachineSpec {
        words,
        lanes: dice.within(1, 9) as usize,
        rays: Rays {
            slots: one_of(dice.one_in(2)),
            template: if dice.one_in(2) { TemplateRule::SampleFloor } else { TemplateRule::PlaneFloor },
            offset: dice.real(0.0, 1.0),
            // Tables for the ends of rays are many.
            ends: if words.table_bits < 10 && dice.one_in(2) { RayEnds::Exact } else { RayEnds::Published },
            ..Rays::default()
        },
        abc: Abc {
            gradient: GradientMethod::ALL[dice.within(0, 6) as usize].0,
            shading: if dice.one_in(3) { ShadingUnit::ReflectanceTable } else { ShadingUnit::Phong },
            power_bits: dice.word(1, 11.min(words.normal_bits - 1)),
            root_bits: dice.word(4, 10.min(2 * words.normal_bits - 2)),
            reflectance_bits: dice.word(2, 4),
            planes: 4,
            reach: dice.word(1, 5),
        },
        ..MachineSpec::default()
    };
    machine.check("machine").unwrap();
    machine
}

/// A direction that is not zero, along an axis or at a tie now and then.
pub fn direction(dice: &mut Dice) -> [f64; 3] {
    loop {
        let any = [0; 3].map(|_| if dice.one_in(3) { dice.within(-1, 1) as f64 } else { dice.real(-1.0, 1.0) });
        if any.iter().any(|x| x.abs() > 0.01) {
            return any;
        }
    }
}

fn opacity_points(dice: &mut Dice) -> Vec<[f64; 2]> {
    let mut values = vec![0.0; dice.within(1, 6) as usize];
    values.fill_with(|| dice.real(0.0, 255.0));
    values.sort_by(f64::total_cmp);
    values.into_iter().map(|value| [value, dice.real(-1.0, 1.0).max(0.0)]).collect()
}

/// Any scene that lights, cuts and classifies.
pub fn scene(dice: &mut Dice, dims: [usize; 3]) -> Scene {
    let layers = if dice.one_in(3) {
        vec![
            Layer { gradient: 0.0, opacity: opacity_points(dice) },
            Layer { gradient: dice.real(1.0, 200.0), opacity: opacity_points(dice) },
        ]
    } else {
        Vec::new()
    };
    let voxel = |dice: &mut Dice| dims.map(|side| dice.real(0.0, side as f64));
    let light = |dice: &mut Dice| Light {
        direction: dice.one_in(2).then(|| direction(dice)),
        colour: [0; 3].map(|_| dice.real(0.0, 1.0)),
    };
    let scene = Scene {
        mode: Mode::ALL[dice.within(0, 5) as usize],
        view: View::from_direction(direction(dice), None),
        transfer: Transfer {
            opacity_correction: dice.one_in(2),
            opaque_alpha: dice.real(0.01, 1.0),
            opacity: if layers.is_empty() { opacity_points(dice) } else { Vec::new() },
            colour: (0..3)
                .map(|i| ColourPoint { value: f64::from(i) * 80.0, rgb: [0; 3].map(|_| dice.real(0.0, 1.0)) })
                .collect(),
            layers,
        },
        material: Material {
            shaded: !dice.one_in(4),
            ambient: dice.real(0.0, 1.0),
            diffuse: dice.real(0.0, 1.0),
            specular: dice.real(0.0, 1.0),
            shininess: dice.real(0.01, 100.0),
            two_sided: dice.one_in(2),
        },
        lights: (0..dice.within(0, 8)).map(|_| light(dice)).collect(),
        depth_cue: dice.one_in(3).then(|| DepthCue { front: dice.real(0.0, 1.0), back: dice.real(0.0, 1.0) }),
        cuts: (0..dice.within(0, 6) / 3).map(|_| Cut { normal: direction(dice), through_voxel: voxel(dice) }).collect(),
        crop: dice.one_in(4).then(|| Crop { min_voxel: [0.5; 3], max_voxel: voxel(dice).map(|x| x + 0.5) }),
        threshold: dice.one_in(3).then(|| Threshold { low: Some(dice.real(0.0, 128.0)), high: Some(200.0) }),
        ..Scene::default()
    };
    scene.validate().unwrap();
    scene
}

/// Registers as the host makes them, from any scene on any machine.
pub fn hosted_frame(dice: &mut Dice) -> FrameSetup {
    let words = words(dice);
    let words = Words { table_gradient_bits: words.table_gradient_bits.min(3), ..words };
    let machine = machine(dice, words);
    // At times one side of more than a block.
    let (longest, long) = (dice.within(0, 9), dice.within(10, 40) as usize);
    let dims = [0, 1, 2].map(|i| if i == longest { long } else { dice.within(1, 9) as usize });
    let scene = scene(dice, dims);
    let volume = VolumeInfo { dims, spacing: [0; 3].map(|_| dice.real(0.5, 3.0)), window: [0.0, 255.0] };
    frame_setup(&scene, &machine, &volume, dice.one_in(2)).unwrap().setup
}

/// Neighbourhoods of sample words: full range, narrow, extreme, alternating, constant.
pub fn neighbourhood(dice: &mut Dice, sample_bits: u32) -> Neighbourhood {
    let last = i64::from(unit_full(sample_bits));
    let kind = dice.roll() % 8;
    let middle = dice.within(0, last);
    let mut s = [[[0; 3]; 3]; 3];
    for (place, sample) in s.iter_mut().flatten().flatten().enumerate() {
        let value = match kind {
            0 => middle,
            1 => (place as i64 % 2) * last,
            2 => (dice.roll() % 2) as i64 * last,
            3 | 4 => dice.within((middle - 3).max(0), (middle + 3).min(last)),
            _ => dice.within(0, last),
        };
        *sample = value as i32;
    }
    s
}
