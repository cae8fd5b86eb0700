//! Random stiff scenes by every method: finite, in range, within the bound of the integral, and no darker where there is more.

use cube3_cases::cases;
use cube3_method::{METHODS, RenderError};
use cube3_rendering::MethodError;
use cube3_scene::{ColourPoint, Mode, View};
use cube3_study::stress::{StressError, Subject, Truth};
use proptest::prelude::*;
use std::collections::BTreeMap;
use std::sync::Mutex;

/// What more opacity may darken a pixel by: rounding of reals, and of a few bits of the words.
const REALS: f64 = 1e-9;
const WORDS: f64 = 4.0 / 65535.0;

/// An opacity of a unit length whose depth is log-uniform over 30 decades, up to where it is rounded to 1; or none, or full.
fn opacities() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => (-29.0..1.5_f64).prop_map(|decades| -(-10_f64.powf(decades)).exp_m1()),
        1 => Just(0.0),
        1 => Just(1.0),
    ]
}

/// How a volume's values lie.
#[derive(Clone, Copy, Debug)]
enum Field {
    Layers { period: usize },
    Ramp,
    Ball,
    Noise,
}

fn fields() -> impl Strategy<Value = Field> {
    prop_oneof![
        (2..6_usize).prop_map(|period| Field::Layers { period }),
        Just(Field::Ramp),
        Just(Field::Ball),
        Just(Field::Noise)
    ]
}

fn value(field: Field, [x, y, z]: [usize; 3], dims: [usize; 3]) -> f64 {
    match field {
        Field::Layers { period } => {
            if (x + 2 * y) % period < period / 2 {
                40.0
            } else {
                200.0
            }
        }
        Field::Ramp => (255 * y / (dims[1] - 1)) as f64,
        Field::Ball => {
            let off = [x, y, z].iter().zip(dims).map(|(&i, n)| (i as f64 - (n - 1) as f64 / 2.0).powi(2)).sum::<f64>();
            (255.0 - 6.0 * off).clamp(0.0, 255.0).round()
        }
        Field::Noise => f64::from((((x * 73 + y * 151 + z * 211) * 2_654_435_761) >> 5) as u8),
    }
}

/// Opacity over the values: a step, a shell from thin to thick, a ramp, or one everywhere.
fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
    let at = 45.0..195.0_f64;
    prop_oneof![
        opacities().prop_map(|a| vec![[0.0, a]]),
        (at.clone(), opacities(), opacities()).prop_map(|(v, a, b)| vec![[v, a], [v, b]]),
        (at.clone(), -9.0..1.5_f64, opacities()).prop_map(|(v, wide, a)| {
            let end = v + 10_f64.powf(wide);
            vec![[v, 0.0], [v, a], [end, a], [end, 0.0]]
        }),
        (at, 1.0..60.0_f64, opacities(), opacities()).prop_map(|(v, wide, a, b)| vec![[v, a], [v + wide, b]]),
    ]
}

fn subjects() -> impl Strategy<Value = Subject> {
    let dims = [7..14_usize, 7..14, 7..14];
    let view = (-180.0..180.0_f64, -90.0..90.0_f64);
    (
        dims,
        fields(),
        points(),
        view,
        any::<bool>(),
        prop_oneof![4 => Just(Mode::Composite), 1 => Just(Mode::WeightedSum)],
    )
        .prop_map(|(dims, field, points, (yaw, tilt), lit, mode)| {
            let subject =
                Subject::new(dims, |at| value(field, at, dims)).opacity(&points).view(View::from_angles(yaw, tilt));
            subject.with(|subject| {
                (subject.scene.mode, subject.scene.material.shaded) = (mode, lit);
                (subject.scene.image.width_px, subject.scene.image.height_px) = (11, 11);
            })
        })
}

/// The same, white over black and not lit, so that a pixel is its opacity.
fn white(mut subject: Subject) -> Subject {
    subject.scene.background = [0.0; 3];
    subject.scene.material.shaded = false;
    subject.scene.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
    subject
}

#[test]
fn stiff_scenes_are_finite_in_range_and_within_their_bounds_by_every_method() {
    let seen: Mutex<BTreeMap<&str, [usize; 2]>> = Mutex::default();
    proptest!(cases(120), |(subject in subjects())| {
        let truth = Truth::new(&subject).unwrap();
        for method in METHODS {
            let name = method.about.name;
            let measure = match truth.measure(method, &subject) {
                Ok(measure) => measure,
                Err(StressError::Render(RenderError::Method(MethodError::Lacks { .. }))) => continue,
                Err(error) => return Err(TestCaseError::fail(format!("{name}: {error}"))),
            };
            prop_assert!(measure.finite && measure.in_range, "{name}: {measure:?}");
            prop_assert!(measure.kept, "{name}: {measure:?}");
            let mut seen = seen.lock().unwrap();
            let of = seen.entry(name).or_default();
            of[0] += 1;
            of[1] += usize::from(measure.bound < 0.2);
        }
    });
    let seen = seen.into_inner().unwrap();
    println!("pictures, and those whose worst pixel has a bound below a fifth: {seen:?}");
    assert!(seen.len() == METHODS.len() && seen.values().all(|of| of[1] > 0), "{seen:?}");
}

#[test]
fn more_opacity_darkens_no_method() {
    proptest!(cases(60), |(subject in subjects(), less in -20.0..0.0_f64)| {
        let more = white(subject);
        let mut fewer = more.clone();
        for point in &mut fewer.scene.transfer.opacity {
            point[1] *= 10_f64.powf(less);
        }
        let [before, after] = [&fewer, &more].map(|subject| Truth::new(subject).unwrap());
        for method in METHODS {
            let (_, dark) = before.picture(method, &fewer).unwrap();
            let (_, bright) = after.picture(method, &more).unwrap();
            let slack = if method.about.in_words { WORDS } else { 2.0 * REALS + if method.about.name == "converged" { 2e-6 } else { 0.0 } };
            for (pixel, (dark, bright)) in dark.pixels.iter().zip(&bright.pixels).enumerate() {
                prop_assert!(dark[0] <= bright[0] + slack, "{}, pixel {pixel}: {dark:?} {bright:?}", method.about.name);
            }
        }
    });
}
