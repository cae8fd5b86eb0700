//! The phantoms against their formulas: symmetries, integrals, values at known places.

use cube3_volume::{Phantom, PhantomParams, SampleType, Volume};

fn make(phantom: Phantom, size: usize) -> Volume {
    phantom.generate(size, &PhantomParams::default()).unwrap()
}

/// The voxel of the head at millimetres from the centre: x to the left, y back, z up.
fn head_at(head: &Volume, mm: [f64; 3]) -> f64 {
    let n = head.dims[0] as f64;
    let [x, y, z] = mm.map(|v| (v / 250.0 * n + (n - 1.0) / 2.0).round() as usize);
    head.value(x, y, z)
}

#[test]
fn names_are_read_back_and_others_refused() {
    for phantom in Phantom::ALL {
        assert_eq!(phantom.to_string().parse::<Phantom>().unwrap(), phantom);
    }
    assert!("skull".parse::<Phantom>().unwrap_err().to_string().contains("marschner-lobb"));
}

#[test]
fn every_size_works_but_none() {
    for phantom in Phantom::ALL {
        for size in [1, 2, 3, 7, 9] {
            assert_eq!(make(phantom, size).dims, [size; 3]);
        }
        assert!(phantom.generate(0, &PhantomParams::default()).is_err());
        assert!(phantom.generate(usize::MAX, &PhantomParams::default()).is_err());
    }
}

#[test]
fn the_same_phantom_twice_is_the_same_to_the_bit() {
    for phantom in Phantom::ALL {
        assert_eq!(make(phantom, 20), make(phantom, 20), "{phantom}");
    }
}

#[test]
fn spheres_and_shells_have_the_48_symmetries_of_the_cube() {
    for phantom in [Phantom::Sphere, Phantom::Shells] {
        for size in [15, 16] {
            let v = make(phantom, size);
            let m = size - 1;
            for z in 0..size {
                for y in 0..size {
                    for x in 0..size {
                        // These generate all 48: a mirror, a swap and a rotation of the axes.
                        let value = v.value(x, y, z);
                        assert_eq!(value, v.value(m - x, y, z));
                        assert_eq!(value, v.value(y, x, z));
                        assert_eq!(value, v.value(y, z, x));
                    }
                }
            }
        }
    }
}

#[test]
fn a_spheres_mass_is_its_volume() {
    use std::f64::consts::PI;
    for (size, radius, ramp) in [(64, 26.0, 2.2), (48, 15.5, 3.0), (64, 20.0, 8.0)] {
        let params = PhantomParams { radius: Some(radius), ramp: Some(ramp), ..PhantomParams::default() };
        let v = Phantom::Sphere.generate(size, &params).unwrap();
        let mass: f64 = v.to_f64().iter().sum::<f64>() / 65535.0;
        let expected = PI * (4.0 / 3.0 * radius.powi(3) + radius * ramp * ramp / 5.0);
        assert!((mass / expected - 1.0).abs() < 2e-4, "{mass} against {expected}");
    }
}

#[test]
fn a_sphere_has_its_ramp_and_its_centre() {
    let params = PhantomParams { centre: Some([10.0, 12.0, 14.0]), radius: Some(6.0), ..PhantomParams::default() };
    let v = Phantom::Sphere.generate(32, &params).unwrap();
    assert_eq!(v.value(10, 12, 14), 65535.0);
    assert_eq!(v.value(16, 12, 14), (0.5f64 * 65535.0).round());
    let cubic = |t: f64| (t * t * (3.0 - 2.0 * t) * 65535.0).round();
    assert_eq!(v.value(10, 17, 14), cubic(0.5 + 1.0 / 2.2));
    assert_eq!(v.value(10, 12, 21), cubic(0.5 - 1.0 / 2.2));
    assert_eq!(v.value(18, 12, 14), 0.0);
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let params = PhantomParams { ramp: Some(wrong), ..PhantomParams::default() };
        assert!(Phantom::Sphere.generate(8, &params).is_err());
        let params = PhantomParams { centre: Some([wrong / 0.0; 3]), ..PhantomParams::default() };
        assert!(Phantom::Sphere.generate(8, &params).is_err());
    }
}

#[test]
fn thin_shells_keep_their_mass() {
    use std::f64::consts::PI;
    let size = 160;
    let v = make(Phantom::Shells, size);
    let thickness = [0.25, 0.5, 1.0, 2.0, 4.0, 0.25];
    // Each shell's mass: a box of one voxel along the radius spreads r², by t/12 for its width 1.
    let c = (size as f64 - 1.0) / 2.0;
    let mut mass = [0.0; 6];
    for z in 0..size {
        for y in 0..size {
            for x in 0..size {
                let r = ((x as f64 - c).powi(2) + (y as f64 - c).powi(2) + (z as f64 - c).powi(2)).sqrt();
                let shell = (r / 10.0).round() as usize;
                if (1..=6).contains(&shell) {
                    mass[shell - 1] += v.value(x, y, z) / 65535.0;
                }
            }
        }
    }
    for (i, t) in thickness.iter().enumerate() {
        let r = 10.0 * (i + 1) as f64;
        let expected = 4.0 * PI * t * (r * r + t * t / 12.0 + 1.0 / 12.0);
        assert!((mass[i] / expected - 1.0).abs() < 0.02, "shell {i}: {} against {expected}", mass[i]);
    }
}

#[test]
fn marschner_lobb_is_its_formula() {
    let v = make(Phantom::MarschnerLobb, 41);
    assert_eq!(v.sample_type(), SampleType::F32);
    // At the centre ρᵣ(0) = cos(12π) = 1; at z = ±1 the sine is ±1; at r = 1 ρᵣ = cos 0 = 1.
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} against {b}");
    close(v.value(20, 20, 20), 1.5 / 2.5);
    close(v.value(20, 20, 40), 0.5 / 2.5);
    close(v.value(20, 20, 0), 1.0);
    close(v.value(40, 20, 20), 1.5 / 2.5);
    let r = 0.5f64;
    let ripple = (12.0 * std::f64::consts::PI * (std::f64::consts::PI * r / 2.0).cos()).cos();
    close(v.value(30, 20, 20), (1.0 + 0.25 * (1.0 + ripple)) / 2.5);
    let (low, high) = v.range().unwrap();
    assert!(low >= 0.0 && high <= 1.0);
}

#[test]
fn shepp_logan_has_its_densities_and_its_mass() {
    let n = 64;
    let v = make(Phantom::SheppLogan, n);
    let at = |p: [f64; 3]| {
        let [x, y, z] = p.map(|c| ((c + 1.0) / 2.0 * n as f64) as usize);
        v.value(x, y, z) / 65535.0
    };
    let close = |a: f64, b: f64| assert!((a - b).abs() < 2e-5, "{a} against {b}");
    close(at([0.0, 0.9, 0.0]), 1.0);
    close(at([0.0, -0.4, 0.0]), 0.2);
    close(at([0.22, 0.0, 0.0]), 0.0);
    close(at([-0.22, 0.0, 0.0]), 0.0);
    close(at([0.0, 0.35, -0.15]), 0.3);
    close(at([0.95, 0.95, 0.95]), 0.0);
    let table = [
        (1.0, 0.69 * 0.92 * 0.81),
        (-0.8, 0.6624 * 0.874 * 0.78),
        (-0.2, 0.11 * 0.31 * 0.22 + 0.16 * 0.41 * 0.28),
        (0.1, 0.21 * 0.25 * 0.41 + 2.0 * 0.046 * 0.046 * 0.05),
        (0.1, 0.046 * 0.023 * 0.05 + 0.023 * 0.023 * 0.02 + 0.023 * 0.046 * 0.02),
    ];
    let expected: f64 = table.iter().map(|(d, a)| d * a * 4.0 / 3.0 * std::f64::consts::PI).sum();
    let mass = v.to_f64().iter().sum::<f64>() / 65535.0 * (2.0 / n as f64).powi(3);
    assert!((mass / expected - 1.0).abs() < 5e-3, "{mass} against {expected}");
}

#[test]
fn fog_is_thin_smooth_and_gone_at_the_faces() {
    let n = 64;
    let v = make(Phantom::Fog, n);
    let (low, high) = v.range().unwrap();
    assert!(low == 0.0 && (6000.0..=6554.0).contains(&high), "{low} to {high}");
    for i in 0..n {
        for j in 0..n {
            assert!(v.value(0, i, j) < 10.0 && v.value(i, 0, j) < 10.0 && v.value(i, j, n - 1) < 10.0);
        }
    }
    // No step between neighbours above the wave's steepest slope, about 3π/2 of the whole over a half side.
    for z in 0..n {
        for y in 1..n {
            for x in 0..n {
                assert!((v.value(x, y, z) - v.value(x, y - 1, z)).abs() < 6553.5 * 0.2);
            }
        }
    }
}

#[test]
fn a_checker_alternates_with_its_period() {
    let v = Phantom::Checker.generate(12, &PhantomParams { period: Some(3), ..PhantomParams::default() }).unwrap();
    for z in 0..12 {
        for y in 0..12 {
            for x in 0..12 {
                let odd = (x / 3 + y / 3 + z / 3) % 2 == 1;
                assert_eq!(v.value(x, y, z), if odd { 65535.0 } else { 0.0 });
            }
        }
    }
    assert!(Phantom::Checker.generate(12, &PhantomParams { period: Some(0), ..PhantomParams::default() }).is_err());
}

#[test]
fn the_engine_has_casting_inserts_and_bores() {
    let n = 128;
    let v = make(Phantom::Engine, n);
    let at = |units: [f64; 3]| {
        let [x, y, z] = units.map(|u| (u / 200.0 * n as f64 + (n as f64 - 1.0) / 2.0).round() as usize);
        v.value(x, y, z)
    };
    let within = |value: f64, low: f64, high: f64| assert!((low..=high).contains(&value), "{value}");
    within(at([70.0, 30.0, 0.0]), 100.0, 160.0);
    within(at([38.0, 24.0, 10.0]), 180.0, 200.0);
    within(at([30.0, 0.0, -70.0]), 205.0, 225.0);
    within(at([76.0, 40.0, 60.0]), 235.0, 255.0);
    assert_eq!(at([38.0, 0.0, 20.0]), 0.0);
    assert_eq!(at([0.0, -65.0, -10.0]), 0.0);
    assert_eq!(at([-95.0, -95.0, 95.0]), 0.0);
}

#[test]
fn the_head_has_its_tissues_where_they_belong() {
    for n in [128, 256] {
        let head = make(Phantom::Head, n);
        assert_eq!(head.sample_type(), SampleType::U8);
        let within = |mm: [f64; 3], low: f64, high: f64| {
            let value = head_at(&head, mm);
            assert!((low..=high).contains(&value), "{value} at {mm:?} mm, {n} voxels");
        };
        // Air: before the face, above the crown, in the corner; inside the nose and the throat.
        within([0.0, -122.0, 0.0], 0.0, 0.0);
        within([0.0, 0.0, 122.0], 0.0, 0.0);
        within([-122.0, 122.0, 122.0], 0.0, 0.0);
        within([0.0, -4.0, -70.0], 0.0, 1.0);
        // Brain, neck, eye: soft, below the transfer function's 80.
        within([0.0, 10.0, 50.0], 70.0, 75.0);
        within([38.0, 30.0, -90.0], 60.0, 75.0);
        within([32.0, -70.0, 9.0], 60.0, 75.0);
        // Bone: forehead, back, cheek bone, chin, ramus, vertebra.
        within([0.0, -77.0, 40.0], 105.0, 200.0);
        within([0.0, 97.0, 36.0], 105.0, 200.0);
        within([47.0, -58.0, -13.0], 105.0, 200.0);
        within([0.0, -78.0, -90.0], 105.0, 200.0);
        within([48.5, -13.0, -52.0], 105.0, 200.0);
        within([0.0, 21.5, -51.0], 105.0, 200.0);
        // A front tooth.
        within([4.6, -79.0, -48.0], 185.0, 200.0);
    }
}

#[test]
fn the_head_is_a_skull_inside_flesh_with_two_equal_halves() {
    let n = 96;
    let head = make(Phantom::Head, n);
    let mut bone = 0;
    let mut soft = 0;
    for z in 0..n {
        for y in 0..n {
            for x in 0..n {
                let value = head.value(x, y, z);
                assert_eq!(value, head.value(n - 1 - x, y, z));
                bone += usize::from(value >= 90.0);
                soft += usize::from((55.0..80.0).contains(&value));
            }
        }
    }
    let litre = 1e6 / (250.0 / n as f64).powi(3);
    let (bone, soft) = (bone as f64 / litre, soft as f64 / litre);
    assert!((0.4..1.2).contains(&bone), "{bone} litres of bone");
    assert!((2.5..6.0).contains(&soft), "{soft} litres of soft tissue");
    assert!(head.range().unwrap().1 <= 200.0);
}

#[test]
fn a_beat_returns_to_its_bits_and_only_the_heart_beats() {
    let heart = |phase: Option<f64>| {
        Phantom::BeatingHeart.generate(32, &PhantomParams { phase, ..PhantomParams::default() }).unwrap()
    };
    assert_eq!(heart(None), heart(Some(0.0)));
    for phase in [0.0, 0.1, 0.35, 0.8] {
        assert_eq!(heart(Some(phase)), heart(Some(phase + 1.0)), "{phase}");
    }
    assert_ne!(heart(Some(0.0)), heart(Some(0.35)));
    for phase in [0.0, 0.2, 0.35, 0.9] {
        assert_eq!(heart(Some(phase)).range().unwrap(), (0.0, 200.0), "one window serves the whole beat");
    }
    for phantom in Phantom::ALL {
        let moved = phantom.generate(4, &PhantomParams { phase: Some(0.5), ..PhantomParams::default() });
        assert_eq!(moved.is_ok(), phantom.moves(), "{phantom}");
    }
    let lost = PhantomParams { phase: Some(f64::NAN), ..PhantomParams::default() };
    assert!(Phantom::BeatingHeart.generate(4, &lost).is_err());
}
