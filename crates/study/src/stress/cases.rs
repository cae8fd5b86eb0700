//! The stiff and the extreme as data: each case a name and the subjects that are tried.

use super::subject::Subject;
use cube3_scene::{Crop, Cut, DepthCue, Layer, Light, Mode, Perspective, Threshold, View};
use cube3_volume::Samples;
use cube3_word::{Length, Rounding, Words};

/// A case.
pub struct Case {
    /// What it is about.
    pub group: &'static str,
    /// What is tried.
    pub name: &'static str,
    /// The subjects; the worst of them counts.
    pub subjects: fn() -> Vec<Subject>,
    /// A part of the message with which every method refuses it, where it is to be refused.
    pub refused: Option<&'static str>,
}

const SIDE: usize = 18;

const fn case(group: &'static str, name: &'static str, subjects: fn() -> Vec<Subject>) -> Case {
    Case { group, name, subjects, refused: None }
}

/// Every case.
pub const CASES: &[Case] = &[
    case("opacity", "opacity 0 everywhere", || vec![fog(255.0, 0.0)]),
    case("opacity", "opacity 1 everywhere", || vec![fog(255.0, 1.0), fog(255.0, 1.0).lit()]),
    case("opacity", "opacity of a unit length from 1e-30 to 1e-3", || {
        [1e-30, 1e-15, 1e-6, 1e-3].map(|a| fog(200.0, a)).into()
    }),
    case("opacity", "opacity of a unit length 1 - 1e-3 to 1 - 2^-53", || {
        [1e-3, 1e-6, 1e-12, f64::EPSILON / 2.0].map(|left| fog(200.0, 1.0 - left)).into()
    }),
    case("opacity", "opacity that a word cannot hold, seen through 18 and 200 voxels", || {
        let thin = |dims| Subject::new(dims, |_| 200.0).opacity(&[[0.0, 4e-6]]);
        vec![thin([SIDE; 3]), near(thin([6, 200, 6]).view(View::from_angles(1.0, 0.5))), fog(200.0, 7e-6)]
    }),
    case("opacity", "512 samples of the smallest opacity that a word of 16 bits holds", || {
        let dims = [5, 512, 5];
        vec![near(Subject::new(dims, |_| 200.0).opacity(&[[0.0, 1.01 / 65535.0]]).view(View::from_angles(0.0, 0.0)))]
    }),
    case("opacity", "depths of 0.01 to 36,000 in a step, in voxels 1000 long", || {
        [1e-5, 1e-3, 0.7, 1.0 - f64::EPSILON / 2.0]
            .map(|alpha| Subject::new([9; 3], |_| 200.0).opacity(&[[0.0, alpha]]).spacing([1.0, 1000.0, 1.0]))
            .into()
    }),
    case("opacity", "a step, which rays cross at every angle", || {
        [[[100.0, 0.0], [100.0, 0.3]], [[100.0, 0.0], [100.0, 1.0]], [[100.0, 1.0], [100.0, 0.0]]]
            .map(|points| ramp().opacity(&points))
            .into()
    }),
    case("opacity", "a shell of a millionth of a value", || {
        let shell = [[128.0, 0.0], [128.0, 1.0], [128.000_001, 1.0], [128.000_001, 0.0]];
        vec![ramp().opacity(&shell), ball().opacity(&shell), ball().opacity(&shell).lit()]
    }),
    case("opacity", "alternating clear and opaque, faint and dense layers", || {
        let layers = |even: f64, odd: f64| {
            Subject::new([SIDE; 3], |[_, y, _]| if y % 2 == 0 { 50.0 } else { 200.0 }).opacity(&[
                [50.0, even],
                [120.0, even],
                [120.0, odd],
                [200.0, odd],
            ])
        };
        vec![layers(0.0, 1.0), layers(1e-12, 0.999_999), layers(0.9, 1e-6), layers(0.0, 0.02)]
    }),
    case("opacity", "a weighted sum, faint and full", || {
        [1e-12, 0.01, 1.0].map(|a| fog(200.0, a).with(|s| s.scene.mode = Mode::WeightedSum)).into()
    }),
    case("opacity", "opacity by the gradient, with a step and a shell of it", || {
        let layer = |gradient, alpha| Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, alpha]] };
        let of = |layers: Vec<Layer>| {
            // A table of 2^14 values by the gradient's would not fit.
            ball().with(|s| {
                (s.scene.transfer.opacity, s.scene.transfer.layers) = (vec![], layers);
                (s.machine.words.table_bits, s.machine.words.table_gradient_bits) = (8, 7);
            })
        };
        vec![
            of(vec![layer(0.0, 0.0), layer(40.0, 0.9)]),
            of(vec![layer(20.0, 0.0), layer(20.0, 1.0), layer(20.5, 0.0)]),
        ]
    }),
    case("light", "gradients that vanish: a plateau, and a field of one value", || {
        vec![fog(200.0, 0.2).lit(), plateau().lit(), plateau().lit().with(one_sided)]
    }),
    case("light", "gradients along one axis and of the largest size", || {
        let stripes = |axis: usize| Subject::new([SIDE; 3], move |at| if at[axis] % 4 < 2 { 0.0 } else { 255.0 }).lit();
        vec![stripes(0), stripes(1), stripes(2)]
    }),
    case("light", "lights opposite to the eye, along the surface, more than white", || {
        let lights = |directions: &[[f64; 3]]| {
            let all = directions.iter().map(|&d| Light { direction: Some(d), ..Light::default() }).collect();
            ball().lit().with(|s: &mut Subject| s.scene.lights = all)
        };
        vec![lights(&[[0.4, -0.9, -0.2]]), lights(&[[0.0, 1.0, 0.0]]).with(one_sided), lights(&[[1.0, 0.0, 0.0]; 8])]
    }),
    case("light", "highlights of exponents 0.1 and 1000", || {
        [0.1, 1000.0].map(|shininess| ball().lit().with(|s| s.scene.material.shininess = shininess)).into()
    }),
    case("light", "a depth cue to black", || {
        vec![ball().with(|s| s.scene.depth_cue = Some(DepthCue { front: 1.0, back: 0.0 }))]
    }),
    case("fields", "voxels at the limits of their type", || {
        let noise = |i: usize| if (i * 2_654_435_761) >> 7 & 1 == 0 { 0_u8 } else { 255 };
        let dims = [SIDE; 3];
        vec![Subject::of_samples(dims, Samples::U8((0..SIDE.pow(3)).map(noise).collect())).lit()]
    }),
    case("fields", "noise of all values, lit", || {
        let noise = |i: usize| ((i as u32).wrapping_mul(2_654_435_761) >> 13) as u8;
        vec![Subject::of_samples([SIDE; 3], Samples::U8((0..SIDE.pow(3)).map(noise).collect())).lit()]
    }),
    Case {
        group: "fields",
        name: "a voxel that is not a number",
        subjects: || vec![hole(f64::NAN), hole(f64::INFINITY)],
        refused: Some("voxel (3, 2, 1)"),
    },
    case("fields", "voxels that are no numbers, masked", || {
        [f64::NAN, f64::NEG_INFINITY].map(|value| hole(value).with(|s| s.mask = true)).into()
    }),
    case("fields", "labels, dense and faint", || {
        let labels = |alpha: f64| {
            Subject::of_samples([9; 3], Samples::U8((0..729).map(|i| (i * 7 % 5) as u8).collect()))
                .opacity(&[[0.0, 0.0], [1.0, 0.0], [2.0, alpha], [4.0, alpha]])
                .with(|s| s.scene.volume.labels = true)
        };
        vec![labels(1.0), labels(1e-6), labels(0.3)]
    }),
    case("views", "along each axis, both ways", || {
        [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
            .into_iter()
            .flat_map(|d| [1.0, -1.0].map(|s| along(d.map(|x| s * f64::from(x)))))
            .collect()
    }),
    case("views", "at 45 degrees in one slope and in both", || {
        [[1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [1.0, 0.0, -1.0], [1.0, 1.0, 1.0], [-1.0, 1.0, 1.0]].map(along).into()
    }),
    case("views", "a last bit beside 45 degrees", || {
        [1_f64.next_up(), 1_f64.next_down()]
            .into_iter()
            .flat_map(|x| [along([x, 1.0, 0.0]), along([x, 1.0, 1.0])])
            .collect()
    }),
    case("views", "an eye in the volume, on a face, on a voxel", || {
        [[8.3, 7.9, 9.1], [8.0, 0.0, 8.0], [5.0, 5.0, 5.0], [0.0, 0.0, 0.0]].map(|eye| eye_at(eye, 70.0)).into()
    }),
    case("views", "an eye at 1e9 voxels, and at 1e12", || [[8.0, -1e9, 8.0], [1e12, -1e12, 1e11]].map(far_eye).into()),
    case("views", "fields of view of 0.001 and 179 degrees", || {
        vec![eye_at([8.0, -9.0, 8.0], 0.001), eye_at([8.3, 7.9, 9.1], 179.0)]
    }),
    case("views", "lit near the eye and around it", || {
        [[8.3, 7.9, 9.1], [8.0, -2.0, 8.0]].map(|eye| eye_at(eye, 90.0).lit()).into()
    }),
    case("volumes", "1, 2 and 3 voxels a side, lines and sheets of them", || {
        [[1, 1, 1], [2, 2, 2], [3, 3, 3], [1, 1, 9], [9, 1, 1], [1, 9, 1], [1, 7, 7], [2, 1, 3]]
            .map(|dims| Subject::new(dims, |[x, y, z]| (60 * (x + y + z + 1) % 256) as f64).lit())
            .into()
    }),
    case("volumes", "no cubes, no powers of two, more lanes than voxels", || {
        let of = |dims| Subject::new(dims, |[x, y, z]| ((x * 11 + y * 7 + z * 5) % 256) as f64).lit();
        vec![of([5, 19, 11]), of([23, 6, 9]).with(|s| s.machine.lanes = 64)]
    }),
    case("volumes", "voxels of 1:1000", || {
        let of = |spacing| Subject::new([9; 3], |[x, y, z]| (20 * (x + y + z) % 256) as f64).spacing(spacing);
        vec![near(of([1.0, 1.0, 1000.0])), near(of([1000.0, 1.0, 1.0])), of([0.001, 1.0, 1.0])]
    }),
    case("clips", "exact lengths: boxes, cuts and thresholds between voxels", || {
        let crop = Crop { min_voxel: [2.3, 1.7, 3.1], max_voxel: [11.9, 14.2, 12.6] };
        let cut = Cut { normal: [1.0, 0.4, -0.7], through_voxel: [8.2, 7.7, 8.9] };
        let thin = Crop { min_voxel: [0.0, 8.1, 0.0], max_voxel: [17.0, 8.3, 17.0] };
        vec![
            fog(200.0, 0.1).with(|s| s.scene.crop = Some(crop.clone())),
            fog(200.0, 0.1).with(|s| (s.scene.crop, s.scene.cuts) = (Some(crop), vec![cut])),
            fog(200.0, 0.6).with(|s| s.scene.crop = Some(thin)),
            ball().with(|s| s.scene.threshold = Some(Threshold { low: Some(60.3), high: Some(180.7) })),
        ]
    }),
    case("words", "voxels, samples, weights of the fewest bits", || {
        vec![
            words(|w| (w.voxel_bits, w.table_bits) = (8, 8)),
            words(|w| w.sample_fraction_bits = 0),
            words(|w| w.weight_bits = 1),
            words(|w| w.weight_bits = 2),
        ]
    }),
    case("words", "each word at its fewest and at its most bits", || {
        let of = |length: &Length, bits: fn(&Length, &Words) -> u32| {
            words(|words| {
                let bits = bits(length, words);
                *(length.of_mut)(words) = bits;
            })
        };
        // A length that others must follow is tried with what it is by itself.
        let ends =
            |length: &Length| [of(length, |length, _| length.low), of(length, |length, words| length.largest(words))];
        let all = Words::LENGTHS.iter().flat_map(ends);
        all.filter(|subject| subject.machine.words.check().is_ok()).collect()
    }),
    case("words", "colour, opacity and accumulator of 4 to 32 bits, both roundings", || {
        let both = [Rounding::Nearest, Rounding::Truncate];
        both.into_iter()
            .flat_map(|rounding| {
                [4, 8, 12, 16].map(|bits| {
                    words(move |w| {
                        (w.colour_bits, w.opacity_bits, w.accumulator_bits, w.rounding) =
                            (bits, bits, bits.max(8), rounding);
                    })
                })
            })
            .chain([words(|w| w.accumulator_bits = 32)])
            .collect()
    }),
];

fn fog(value: f64, alpha: f64) -> Subject {
    Subject::new([SIDE; 3], move |_| value).opacity(&[[0.0, alpha]])
}

/// With pixels so near that many rays run through all of a long volume.
fn near(subject: Subject) -> Subject {
    subject.with(|subject| subject.scene.image.pixel_size_voxel = Some(0.3))
}

/// Values that grow along y.
fn ramp() -> Subject {
    Subject::new([SIDE; 3], |[_, y, _]| 255.0 * y as f64 / (SIDE - 1) as f64)
}

/// A soft ball in the middle.
fn ball() -> Subject {
    Subject::new([SIDE; 3], |at| {
        let middle = (SIDE - 1) as f64 / 2.0;
        let square: f64 = at.iter().map(|&i| (i as f64 - middle).powi(2)).sum();
        (255.0 * (1.0 - square / 60.0)).clamp(0.0, 255.0).round()
    })
}

/// Two levels with edges of one cell between them.
fn plateau() -> Subject {
    Subject::new([SIDE; 3], |[x, y, z]| if (5..12).contains(&x) && y > 6 && z < 11 { 200.0 } else { 40.0 })
}

fn hole(value: f64) -> Subject {
    let samples = (0..512).map(|i| if i == 3 + 8 * (2 + 8) { value } else { 100.0 }).collect();
    Subject::of_samples([8; 3], Samples::F64(samples))
}

fn one_sided(subject: &mut Subject) {
    subject.scene.material.two_sided = false;
}

fn along(direction: [f64; 3]) -> Subject {
    ball().view(View::from_direction(direction, None))
}

fn eye_at(eye: [f64; 3], field_of_view_deg: f64) -> Subject {
    let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(field_of_view_deg) };
    ball().view(View { perspective: Some(perspective), ..View::from_angles(10.0, 5.0) })
}

/// From far away, where the volume is less than a pixel of the least field of view: the ray of the middle pixel runs through it.
fn far_eye(eye: [f64; 3]) -> Subject {
    let middle = (SIDE - 1) as f64 / 2.0;
    let perspective = Perspective { eye_voxel: Some(eye), ..Perspective::new(0.001) };
    let towards = View::from_direction(eye.map(|x| middle - x), None);
    ball().view(View { perspective: Some(perspective), ..towards }).with(|subject| {
        (subject.scene.image.width_px, subject.scene.image.height_px) = (5, 5);
    })
}

fn words(change: impl FnOnce(&mut Words)) -> Subject {
    ball().lit().with(|subject| change(&mut subject.machine.words))
}
