//! The study of word lengths: what theory says of errors, and that tables, fronts and files are what they claim.

use cube3_host::picture_setup;
use cube3_inputs::{self as inputs, LoadedVolume};
use cube3_machine::MachineSpec;
use cube3_method::{Choice, FUNCTION, Subject};
use cube3_metrics::{compare, footprint};
use cube3_picture::Picture;
use cube3_scene::{Image, Mode, Scene, View, VolumeSource};
use cube3_study::words::levels::LEVELS;
use cube3_study::words::picture::{Aim, SceneCase};
use cube3_study::words::sweeps::{Base, Row, Sweep, shortest, thin};
use cube3_study::words::thin::ThinCase;
use cube3_study::words::wire::{Design, Order, Variant, Wire, widest};
use cube3_study::words::{Options, Study, csv, front, json, page, plots, study};
use cube3_twin::{DiscreteOptions, sheared};
use cube3_volume::{ReadOptions, Volume};
use cube3_word::{Rounding, Words};
use std::sync::OnceLock;

fn head(size: usize) -> Scene {
    Scene {
        volume: VolumeSource::from_phantom("head", size),
        image: Image { width_px: 64, height_px: 64, ..Image::default() },
        ..Scene::default()
    }
}

fn load(scene: &Scene) -> LoadedVolume {
    inputs::load_volume(scene, &MachineSpec::default(), &ReadOptions::default(), false).unwrap()
}

/// The study of a small head, made once.
fn small() -> &'static Study {
    static STUDY: OnceLock<Study> = OnceLock::new();
    STUDY.get_or_init(|| of_head(2))
}

fn of_head(threads: usize) -> Study {
    let scene = head(20);
    let volume = load(&scene);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    pool.install(|| study(&scene, &MachineSpec::default(), &volume, &Options::default())).unwrap()
}

/// Rows of a sweep of one wire by length.
fn sweep(study: &Study, base: Base, wire: Wire, variant: Variant) -> Vec<(u32, &Row)> {
    let of = |row: &&Row| {
        matches!(row.sweep, Sweep::OneWire(b, w, _) if (b, w) == (base, wire)) && row.design.variant() == variant
    };
    study.rows.iter().filter(of).map(|row| (wire.of(&row.design.words), row)).collect()
}

/// The table of the book and of the cone's own test; the design's prototype, section 5, is within its factor of 1.6.
#[test]
fn thin_opacity_costs_what_the_cones_test_and_the_prototype_found() {
    let case = ThinCase::new();
    let table = [
        (8, 8, [107.0, 26.3, 3.45], [117.0, 26.0, 3.7]),
        (12, 12, [13.0, 0.652, 0.367], [12.0, 0.57, 0.33]),
        (16, 12, [0.919, 0.045, 0.04], [0.79, 0.04, 0.04]),
    ];
    for (accumulator_bits, bits, book, prototype) in table {
        let of = |rounding, order| {
            let words = Words { accumulator_bits, opacity_bits: bits, colour_bits: bits, rounding, ..Words::default() };
            case.measure(&words, order).mean
        };
        let got = [
            of(Rounding::Truncate, Order::InOrder),
            of(Rounding::Nearest, Order::InOrder),
            of(Rounding::Nearest, Order::Tree),
        ];
        for ((got, book), prototype) in got.into_iter().zip(book).zip(prototype) {
            // The book has two or three digits.
            assert!((got / book - 1.0).abs() < 0.013, "{accumulator_bits}/{bits}: {got}, not {book}");
            assert!((0.6..1.6).contains(&(got / prototype)), "{accumulator_bits}/{bits}: {got}, not {prototype}");
        }
    }
}

#[test]
fn thin_opacity_is_better_rounded_than_truncated_and_better_in_a_tree() {
    let rows = thin(&ThinCase::new(), &Words::default(), &Wire::ALL);
    let error = |accumulator: u32, table: u32, order: Order, rounding: Rounding| {
        let same = |words: &Words| {
            (words.accumulator_bits, words.opacity_bits, words.rounding) == (accumulator, table, rounding)
        };
        let row = rows.iter().find(|row| row.sweep == Sweep::Grid && row.order == order && same(&row.words));
        row.unwrap().error.mean
    };
    let mut pairs = 0;
    for row in rows.iter().filter(|row| row.sweep == Sweep::Grid) {
        let (accumulator, table) = (row.words.accumulator_bits, row.words.opacity_bits);
        let of = |order, rounding| error(accumulator, table, order, rounding);
        for order in [Order::Tree, Order::InOrder] {
            let [nearest, truncated] = [Rounding::Nearest, Rounding::Truncate].map(|rounding| of(order, rounding));
            // Where the table is what is short, the accumulator's rounding is nothing beside it.
            assert!(truncated >= 0.98 * nearest, "{accumulator}/{table} {order:?}: {truncated} below {nearest}");
        }
        let [tree, in_order] = [Order::Tree, Order::InOrder].map(|order| of(order, Rounding::Nearest));
        assert!(tree <= 1.02 * in_order, "{accumulator}/{table}: tree {tree}, in order {in_order}");
        pairs += 1;
    }
    assert_eq!(pairs, 8 * 5 * 4);
}

/// Twice the bits never make it worse, but for chance where another word is what is short.
#[test]
fn twice_the_bits_are_never_worse() {
    let study = small();
    for base in Base::ALL {
        for &wire in &study.options.wires {
            for variant in Variant::ALL {
                let rows = sweep(study, base, wire, variant);
                for (bits, row) in &rows {
                    let Some((_, longer)) = rows.iter().find(|(twice, _)| *twice == 2 * bits && *bits > 0) else {
                        continue;
                    };
                    let [short, long] = [row, longer].map(|row| row.measured.image.mean);
                    assert!(long <= 1.1 * short + 0.01, "{base:?} {wire:?} {variant:?} {bits}: {short} to {long}");
                    let [short, long] = [row, longer].map(|row| row.measured.gradient.unwrap().gradient.mean_deg);
                    assert!(long <= 1.1 * short + 0.01, "{base:?} {wire:?} {variant:?} {bits}: {short} to {long} deg");
                }
            }
        }
    }
}

#[test]
fn every_sweep_of_wide_words_ends_at_the_widest_design() {
    let study = small();
    for variant in Variant::ALL {
        let mut ends = study.options.wires.iter().map(|&wire| {
            let rows = sweep(study, Base::Wide, wire, variant);
            let (bits, last) = *rows.last().unwrap();
            assert_eq!((bits, last.design), (*wire.lengths().end(), Design::widest(variant)));
            assert_eq!(rows.len(), wire.lengths().count());
            last.measured
        });
        let first = ends.next().unwrap();
        assert!(ends.all(|end| end == first));
        // Truncated voxels are half a step too low.
        let most = if variant.truncated { 0.05 } else { 0.02 };
        assert!(first.image.mean < most, "{variant:?}: {}", first.image.mean);
    }
    // The order of the cone is behind the gradient.
    for wire in [Wire::Gradient, Wire::Normal] {
        let [tree, in_order] = [Variant::ALL[0], Variant::ALL[1]].map(|v| sweep(study, Base::Machine, wire, v));
        for ((_, a), (_, b)) in tree.iter().zip(&in_order) {
            assert_eq!(a.measured.gradient, b.measured.gradient);
        }
    }
}

/// The machine's own words have the error that a run's picture has against the sheared caster with whole steps, to the bit.
#[test]
fn the_machines_own_words_have_the_error_of_a_run() {
    let scene = head(20);
    let (machine, volume) = (MachineSpec::default(), load(&scene));
    let subject = Subject::new(&scene, &machine, &volume);
    let image = Choice::of(&FUNCTION).render(&subject, &|_, _, _| {}).unwrap().picture;
    let frames = picture_setup(&scene, &machine, &volume.info(), true).unwrap();
    let geometry = &frames.setups[0].geometry;
    let whole = DiscreteOptions { gradient: machine.abc.gradient, whole_steps: true, ..DiscreteOptions::default() };
    let base = sheared(&volume.data, &scene, geometry, &whole, None).unwrap();
    let pixels = base.warp(geometry, &frames.plane, volume.data.spacing, scene.background);
    let reference = Picture::new(image.width, image.height, pixels).unwrap();
    let object = footprint(&image, &reference, scene.background).unwrap();
    let expected = compare(&image, &reference, Some(&object)).unwrap().footprint.unwrap();
    let row = small().rows.iter().find(|row| row.sweep == Sweep::Machine).unwrap();
    assert_eq!(row.design, Design::of(machine.words, Variant::ALL[0]));
    let image = row.measured.image;
    let expected = [expected.mean_relative, expected.rms, expected.max].map(|error| LEVELS * error);
    assert_eq!([image.mean, image.rms, image.max], expected);
    assert!(image.mean > 0.0);
}

/// Bytes along an axis view are met exactly: no interpolation is rounded. What is left of a maximum is opacity and colour.
#[test]
fn along_an_axis_only_the_tables_words_are_left() {
    let volume = Volume::from_fn([12; 3], [1.0; 3], |x, y, z| ((31 * x + 57 * y + 83 * z) % 256) as u8).unwrap();
    let scene = Scene {
        mode: Mode::Maximum,
        view: View::from_direction([0.0, 0.0, 1.0], None),
        image: Image { width_px: 32, height_px: 32, ..Image::default() },
        ..head(12)
    };
    let machine = MachineSpec {
        words: Words { voxel_bits: 8, gradient_bits: 9, table_bits: 8, ..Words::default() },
        ..MachineSpec::default()
    };
    let volume = inputs::to_words("bytes".into(), volume, Some([0.0, 255.0]), &machine, false).unwrap();
    let mut case = SceneCase::new(&scene, &machine, &volume).unwrap();
    for variant in Variant::ALL {
        // A fraction of one bit holds the offset of a half, and a sample between two bytes.
        let exact = Words {
            voxel_bits: 8,
            weight_bits: 1,
            sample_fraction_bits: 1,
            table_bits: 9,
            ..widest(variant.rounding())
        };
        let exact = Words { gradient_bits: 10, ..exact };
        let mut before = f64::INFINITY;
        for bits in 2..=16 {
            let words = Words { colour_bits: bits, opacity_bits: bits, ..exact };
            let found = case.measure(&[Design { words, order: variant.order, fine_tables: true }]).unwrap()[0];
            // Half a step of each of the two factors, and the accumulator's of 2⁻³².
            let step = LEVELS / f64::from((1_u32 << bits) - 1);
            assert!(found.image.max <= step + 1e-5, "{variant:?} {bits}: {}", found.image.max);
            assert!(found.image.max <= before + step, "{variant:?} {bits}");
            before = found.image.max;
        }
        assert!(before < 0.005);
    }
}

/// A linear field of whole numbers has whole differences: its gradient is exact where the word holds them, and within the angle
/// that the dropped bits leave where it does not.
#[test]
fn gradients_of_a_linear_field_are_exact_until_bits_are_dropped() {
    let slopes = [300.0, -700.0, 1100.0_f64];
    let volume = Volume::from_fn([10; 3], [1.0; 3], |x, y, z| {
        (20000.0 + slopes[0] * x as f64 + slopes[1] * y as f64 + slopes[2] * z as f64) as u16
    })
    .unwrap();
    let mut scene = Scene { view: View::from_direction([0.0, 0.0, 1.0], None), ..head(10) };
    scene.transfer.opacity = vec![[0.0, 0.2], [65535.0, 0.2]];
    // Samples beyond the border are no part of the field.
    scene.crop = Some(cube3_scene::Crop { min_voxel: [1.6; 3], max_voxel: [7.4; 3] });
    let machine = MachineSpec::default();
    let volume = inputs::to_words("ramp".into(), volume, Some([0.0, 65535.0]), &machine, false).unwrap();
    let mut case = SceneCase::new(&scene, &machine, &volume).unwrap();
    let length = slopes.iter().map(|s| s * s).sum::<f64>().sqrt();
    for variant in Variant::ALL {
        for bits in 8..=24 {
            let words = Wire::Gradient.with(widest(variant.rounding()), bits);
            let design = Design { words, order: variant.order, fine_tables: true };
            let error = case.measure(&[design]).unwrap()[0].gradient.unwrap();
            assert!(error.samples > 10);
            // The difference of two samples is twice the slope, in fractions of 8 bits.
            let lost = if variant.truncated { 1.0 } else { 0.5 } * f64::from(1_u32 << words.gradient_drop());
            let exact = words.gradient_drop() <= 8;
            let bound = if exact { 1e-9 } else { (3.0_f64.sqrt() * lost / (2.0 * 256.0 * length)).asin().to_degrees() };
            assert!(error.gradient.max_deg <= bound, "{variant:?} {bits}: {} above {bound}", error.gradient.max_deg);
        }
    }
}

fn dominates(a: &Row, b: &Row, aim: Aim) -> bool {
    let key = |row: &Row| (row.measured.cost.total_bits(), row.measured.error(aim));
    let ((cost_a, error_a), (cost_b, error_b)) = (key(a), key(b));
    cost_a <= cost_b && error_a <= error_b && (cost_a < cost_b || error_a < error_b)
}

#[test]
fn no_design_beats_one_on_the_front() {
    let study = small();
    let rows = &study.rows;
    for aim in Aim::ALL {
        let all = study.front(aim, None).unwrap();
        assert!(all.len() > 10, "{}", all.len());
        for &index in &all {
            assert!(!rows.iter().any(|row| dominates(row, &rows[index], aim)));
        }
        // What is not on it is beaten, or the twin of one that is.
        let key = |row: &Row| (row.measured.cost.total_bits(), row.measured.error(aim));
        for (index, row) in rows.iter().enumerate() {
            let beats = |&on: &usize| on == index || dominates(&rows[on], row, aim) || key(&rows[on]) == key(row);
            assert!(all.iter().any(beats), "{row:?}");
        }
        for variant in Variant::ALL {
            for &on in &study.front(aim, Some(variant)).unwrap() {
                let beats = |row: &Row| row.design.variant() == variant && dominates(row, &rows[on], aim);
                assert!(rows[on].design.variant() == variant && !rows.iter().any(beats));
            }
        }
        // The cheapest within an error is the first of the front that is.
        for levels in [0.05, 0.5, 3.0] {
            let first = all.iter().map(|&on| &rows[on]).find(|row| row.measured.error(aim) <= levels);
            assert_eq!(study.cheapest(aim, levels).map(key), first.map(key));
        }
    }
    assert_eq!(front(rows, &[], Aim::Picture).unwrap(), Vec::<usize>::new());
    assert!(study.rows.iter().all(|row| row.measured.thin.mean > 0.0));
}

#[test]
fn the_shortest_word_is_the_first_of_those_that_stay_within_the_bound() {
    let study = small();
    for base in Base::ALL {
        for &wire in &study.options.wires {
            for variant in Variant::ALL {
                let rows = sweep(study, base, wire, variant);
                for bound in [0.01, 0.1, 0.5, 5.0] {
                    let good = |from: u32| rows.iter().all(|(b, row)| *b < from || row.measured.image.mean <= bound);
                    let expected = rows.iter().map(|(bits, _)| *bits).find(|&bits| good(bits));
                    let found = shortest(&study.rows, (base, wire, variant), |m| m.image.mean <= bound);
                    assert_eq!(found, expected, "{base:?} {wire:?} {variant:?} {bound}");
                }
            }
        }
    }
}

#[test]
fn files_are_the_same_bytes_on_any_number_of_threads() {
    let (one, two) = (of_head(1), small());
    assert_eq!(csv(&one).unwrap(), csv(two).unwrap());
    assert_eq!(json(&one).unwrap(), json(two).unwrap());
    let [drawn_one, drawn_two] = [&one, two].map(|study| plots(study).unwrap());
    assert_eq!(drawn_one, drawn_two);
    assert_eq!(page(&one, &drawn_one), page(two, &drawn_two));
}

#[test]
fn the_files_hold_every_point_and_their_schema() {
    let study = small();
    let text = csv(study).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1 + study.rows.len() + study.thin.len());
    let columns = lines[0].split(',').count();
    assert!(lines.iter().all(|line| line.split(',').count() == columns));
    let value: serde_json::Value = serde_json::from_str(&json(study).unwrap()).unwrap();
    assert_eq!(value["schema"], 1);
    let points = value["points"].as_array().unwrap();
    assert_eq!(points.len(), study.rows.len());
    let at = lines[0].split(',').position(|name| name == "image_mean_levels").unwrap();
    for (line, (point, row)) in lines[1..].iter().zip(points.iter().zip(&study.rows)) {
        assert_eq!(point["image_mean_levels"], row.measured.image.mean);
        assert_eq!(line.split(',').nth(at).unwrap().parse(), Ok(row.measured.image.mean));
        assert_eq!(point["cost_bits"], row.measured.cost.logic_bits + row.measured.cost.memory_bits);
    }
    assert_eq!(value["thin_opacity"]["points"].as_array().unwrap().len(), study.thin.len());
    for (aim, key) in [(Aim::Picture, "on_front"), (Aim::PictureAndThin, "on_front_with_thin")] {
        let on = points.iter().filter(|point| point[key] == true).count();
        assert_eq!(on, study.front(aim, None).unwrap().len());
    }
}

#[test]
fn a_perspective_view_is_refused_in_words() {
    let mut scene = head(12);
    scene.view.perspective = Some(cube3_scene::Perspective::new(30.0));
    let (machine, volume) = (MachineSpec::default(), load(&scene));
    let problem = SceneCase::new(&scene, &machine, &volume).err().unwrap().to_string();
    assert!(problem.contains("perspective"), "{problem}");
}
