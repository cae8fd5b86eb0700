//! Integer Phong and the reflectance table against the shading model in reals.

use crate::registers::{Dice, direction};
use cube3_abc::golden::{direction_index, lit, normalise, phong, reflectance};
use cube3_frame::{Phong, PhongLight, Shading};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{GradientMethod, MachineSpec, ShadingUnit};
use cube3_scene::{Light, Material, Scene, View, resolve_lights};
use cube3_word::{Words, quantise_unit, unit_full};
use glam::DVec3;

/// A random material, lights and view, with exponents up to `shininess`.
fn scene(dice: &mut Dice, shininess: f64) -> Scene {
    let light = |dice: &mut Dice| Light {
        direction: (!dice.one_in(3)).then(|| direction(dice)),
        colour: [0; 3].map(|_| dice.real(0.0, 1.0)),
    };
    Scene {
        view: View::from_direction(direction(dice), None),
        material: Material {
            shaded: true,
            ambient: dice.real(0.0, 0.5),
            diffuse: dice.real(0.0, 1.0),
            specular: dice.real(0.0, 1.0),
            shininess: dice.real(1.0, shininess),
            two_sided: dice.one_in(2),
        },
        lights: (0..dice.within(0, 8)).map(|_| light(dice)).collect(),
        ..Scene::default()
    }
}

/// A machine whose gradient components are those of the canonical voxel frame.
fn machine(shading: ShadingUnit) -> MachineSpec {
    let mut machine = MachineSpec::default();
    machine.words.table_bits = 1;
    machine.abc.gradient = GradientMethod::Twelve;
    machine.abc.shading = shading;
    machine
}

const VOLUME: VolumeInfo = VolumeInfo { dims: [4; 3], spacing: [1.0; 3], window: [0.0, 1.0] };

/// A normal is off by e_n = 2^−(root+2) in length and 2·2^−(B−1) in each component (see `normals.rs`), a light's direction by
/// half a unit in each; so a cosine is by e = 2^−(root+2) + (2·√3 + √3/2 + ½)·2^−(B−1), the ½ its own rounding. The
/// highlight's slope is at most the exponent, and its table's steps are 2^−power. Words round by half a unit: the ambient
/// light, the colour (which more lights multiply) and their product; and for each light its two intensities,
/// its two products, the entry of the highlight's table and its share of the colour.
#[test]
fn phong_in_integers_is_phong_in_reals_within_the_words() {
    let mut dice = Dice::new(11);
    let mut worst = 0.0_f64;
    let mut compared = 0;
    for _ in 0..1500 {
        let (scene, machine) = (scene(&mut dice, 60.0), machine(ShadingUnit::Phong));
        let setup = frame_setup(&scene, &machine, &VOLUME, true).unwrap().setup;
        let (Some(Shading::Phong(registers)), Some(table)) = (&setup.shading, &setup.normaliser) else {
            panic!("the scene is lit");
        };
        let lights = resolve_lights(&scene, &scene.view.frame().unwrap());
        let words = &setup.words;
        let unit = 1.0 / f64::from(1_u32 << (words.normal_bits - 1));
        let cosine_error =
            f64::from(1_u32 << (machine.abc.root_bits + 2)).recip() + (2.5 * 3.0_f64.sqrt() + 0.5) * unit;
        let step = f64::from(1_u32 << machine.abc.power_bits).recip();
        let m = &scene.material;
        let each = m.diffuse * cosine_error + m.specular * m.shininess * (cosine_error + 0.5 * step);
        let full = f64::from(unit_full(words.colour_bits));
        let n = lights.len() as f64;
        let bound = n * each + (1.5 + 3.5 * n) / full;
        for _ in 0..20 {
            let gradient = [0; 3].map(|_| dice.real(-30_000.0, 30_000.0).round());
            let canonical = setup.geometry.axes.to_canonical(DVec3::from(gradient)).map(|x| x as i32);
            let normal = -DVec3::from(gradient).normalize();
            // One-sided light jumps from nothing to its highlight where it grazes.
            if !m.two_sided && lights.iter().any(|light| normal.dot(light.direction).abs() < cosine_error) {
                continue;
            }
            let colour = [0; 3].map(|_| dice.real(0.0, 1.0));
            let raw = colour.map(|c| quantise_unit(c, words.colour_bits));
            let light = phong(normalise(canonical, table, words).direction, registers, words);
            let got = lit(raw, light, words).value.map(|c| f64::from(c) / full);
            let expected = cube3_scene::phong(m, &lights, Some(normal), colour);
            for i in 0..3 {
                let error = (got[i] - expected[i]).abs();
                worst = worst.max(error / bound);
                assert!(error <= bound, "{got:?}, not {expected:?} within {bound}: {m:?}, {lights:?}, {normal}");
            }
            compared += 1;
        }
    }
    println!("{compared} colours, the largest error {worst:.2} of its bound");
    assert!(compared > 10_000);
}

/// The table's cells are 2/2^bits wide on a face, and their middles at most half a diagonal, √2/2^bits, away.
#[test]
fn the_reflectance_table_is_phong_in_reals_within_half_a_cell() {
    let mut dice = Dice::new(12);
    let mut worst = 0.0_f64;
    for _ in 0..60 {
        let (scene, machine) = (scene(&mut dice, 10.0), machine(ShadingUnit::ReflectanceTable));
        let setup = frame_setup(&scene, &machine, &VOLUME, true).unwrap().setup;
        let Some(Shading::Table(table)) = &setup.shading else { panic!("the scene is lit") };
        let lights = resolve_lights(&scene, &scene.view.frame().unwrap());
        let words = &setup.words;
        let cell = 2.0_f64.sqrt() / f64::from(1_u32 << table.bits);
        let m = &scene.material;
        let n = lights.len() as f64;
        let full = f64::from(unit_full(words.colour_bits));
        let bound = n * (m.diffuse + m.specular * m.shininess) * cell + 3.0 / full;
        for _ in 0..300 {
            let gradient = [0; 3].map(|_| dice.real(-30_000.0, 30_000.0).round());
            let canonical = setup.geometry.axes.to_canonical(DVec3::from(gradient)).map(|x| x as i32);
            let normal = -DVec3::from(gradient).normalize();
            if !m.two_sided && lights.iter().any(|light| normal.dot(light.direction).abs() < cell) {
                continue;
            }
            let got = lit([unit_full(words.colour_bits); 3], reflectance(canonical, table), words).value;
            let expected = cube3_scene::phong(m, &lights, Some(normal), [1.0; 3]);
            for i in 0..3 {
                let error = (f64::from(got[i]) / full - expected[i]).abs();
                worst = worst.max(error / bound);
                assert!(error <= bound, "{got:?}, not {expected:?} within {bound}: {m:?}, {normal}");
            }
        }
    }
    println!("the largest error {worst:.2} of its bound");
}

#[test]
fn without_a_gradient_only_ambient_light_is_left() {
    for shading in [ShadingUnit::Phong, ShadingUnit::ReflectanceTable] {
        for two_sided in [false, true] {
            let material = Material { ambient: 0.25, two_sided, ..Material::default() };
            let scene = Scene { material, ..Scene::default() };
            let setup = frame_setup(&scene, &machine(shading), &VOLUME, true).unwrap().setup;
            let words = &setup.words;
            let light = match setup.shading.as_ref().unwrap() {
                Shading::Phong(registers) => {
                    let normal = normalise([0; 3], setup.normaliser.as_ref().unwrap(), words).direction;
                    phong(normal, registers, words)
                }
                Shading::Table(table) => reflectance([0; 3], table),
            };
            let got = lit([4000, 2000, 0], light, words).value;
            assert_eq!(got, [1000, 500, 0], "{shading:?}, two-sided {two_sided}");
        }
    }
    assert_eq!(direction_index([0; 3], 4), None);
}

#[test]
fn more_than_white_is_white_and_counted() {
    let lights = vec![Light { direction: None, colour: [1.0, 0.5, 0.0] }; 8];
    let material = Material { ambient: 0.0, diffuse: 1.0, specular: 0.0, ..Material::default() };
    let scene = Scene { lights, material, view: View::from_direction([0.0, 0.0, 1.0], None), ..Scene::default() };
    let setup = frame_setup(&scene, &machine(ShadingUnit::Phong), &VOLUME, true).unwrap().setup;
    let Some(Shading::Phong(registers)) = &setup.shading else { panic!("the scene is lit") };
    let normal = normalise([0, 0, 1000], setup.normaliser.as_ref().unwrap(), &setup.words).direction;
    let counted = lit([4095, 4095, 4095], phong(normal, registers, &setup.words), &setup.words);
    assert_eq!((counted.value, counted.overflows), ([4095, 4095, 0], 2));
}

#[test]
fn rows_of_normals_are_lit_as_each_alone() {
    let words = Words { normal_bits: 8, colour_bits: 8, ..Words::default() };
    let light =
        |direction: [i32; 3], halfway, level| PhongLight { direction, halfway, diffuse: level, specular: level };
    for two_sided in [false, true] {
        let registers = Phong {
            ambient: 20,
            two_sided,
            lights: vec![
                light([0, 0, -128], [90, 0, -90], [100, 50, 0]),
                light([-128, 0, 0], [0, 128, 0], [7, 200, 255]),
            ],
            power: (0..=16).map(|i| i * 16).collect(),
            power_bits: 4,
        };
        let normals: Vec<[i32; 3]> = (0..125_i32).map(|i| [i % 5, i / 5 % 5, i / 25].map(|x| (x - 2) * 64)).collect();
        let rows = [0, 1, 2].map(|axis| normals.iter().map(|normal| normal[axis]).collect());
        let [diffuse, specular] = cube3_abc::lanes::phong_rows(rows, &registers, &words);
        for (lane, &normal) in normals.iter().enumerate() {
            let alone = phong(normal, &registers, &words);
            assert_eq!(diffuse.each_ref().map(|row| row[lane]), alone.diffuse, "{normal:?}");
            assert_eq!(specular.each_ref().map(|row| row[lane]), alone.specular, "{normal:?}");
        }
        assert!(diffuse.iter().all(|row| row.len() == normals.len()));
    }
}
