//! The machine's own gradient words on the sphere phantom: the table of the design, section 3.

use cube3_definition::Definition;
use cube3_host::{Basis, VolumeInfo, frame_setup};
use cube3_machine::{Abc, GradientMethod, MachineSpec, Rays};
use cube3_metrics::mean_angle_deg;
use cube3_scene::{Scene, View};
use cube3_volume::{Phantom, PhantomParams, VoxelWords, WordConversion};
use glam::DVec3;

/// Mean angle in degrees between the gradient words and the normals of the sphere, at the first sample of every ray that
/// exceeds half of the range: figure 15 of the paper, with the bits of the default machine.
fn mean_angle(volume: &VoxelWords, yaw_deg: f64, offset: f64, method: GradientMethod) -> f64 {
    let machine = MachineSpec {
        rays: Rays { offset, ..Rays::default() },
        abc: Abc { gradient: method, ..Abc::default() },
        ..MachineSpec::default()
    };
    let scene = Scene { view: View::from_angles(yaw_deg, 0.0), ..Scene::default() };
    let info = VolumeInfo { dims: volume.dims, spacing: volume.spacing, window: volume.window };
    let setup = frame_setup(&scene, &machine, &info, true).unwrap().setup;
    let (geometry, defined) = (&setup.geometry, Definition::new(&setup, &volume.words));
    let basis = Basis::new(geometry, volume.spacing, method);
    let centre = DVec3::splat(31.5);
    let mut pairs = Vec::new();
    for ray in defined.rays() {
        let dense = |k: &i64| defined.sample(ray, *k).is_some_and(|sample| sample > 32767);
        if let Some(k) = (0..geometry.size[2] as i64).find(dense) {
            let world = basis.world(&geometry.axes, defined.gradient(ray, k).unwrap().map(f64::from));
            let at = geometry.axes.voxel_position(geometry.size, geometry.sample_position(ray, k as usize));
            pairs.push((world.to_array(), (centre - DVec3::from(at)).to_array()));
        }
    }
    assert!(pairs.len() > 1900, "about 26²·π rays meet the sphere");
    mean_angle_deg(pairs).unwrap().mean_deg.unwrap()
}

fn sphere(ramp: f64) -> VoxelWords {
    let params = PhantomParams { ramp: Some(ramp), ..PhantomParams::default() };
    let volume = Phantom::Sphere.generate(64, &params).unwrap();
    volume.to_words(16, &WordConversion::identity(16)).unwrap().0
}

const ANGLES: [f64; 4] = [0.0, 15.0, 30.0, 45.0];

/// Bilinear samples (o = 0 at every angle, which 45° forces on the sample floor), as the prototype must have taken them.
#[test]
fn the_table_of_the_design_within_fifteen_percent() {
    let volume = sphere(2.2);
    let table = [
        (GradientMethod::Six, [3.2, 6.1, 11.6, 21.3]),
        (GradientMethod::TwentySix, [1.1, 5.3, 11.9, 21.8]),
        (GradientMethod::TenNormalised, [3.2, 3.1, 3.3, 4.0]),
        (GradientMethod::Twelve, [3.2, 3.1, 3.1, 3.9]),
    ];
    for (method, expected) in table {
        let got = ANGLES.map(|yaw| mean_angle(&volume, yaw, 0.0, method));
        println!("{:>4}: {got:.2?}, design {expected:?}", method.name());
        for (got, expected) in got.into_iter().zip(expected) {
            assert!((got / expected - 1.0).abs() < 0.15, "{}: {got}, not {expected}", method.name());
        }
    }
}

#[test]
fn twelve_is_flat_and_the_mended_twenty_six_is_the_best() {
    let volume = sphere(3.0);
    let twelve = ANGLES.map(|yaw| mean_angle(&volume, yaw, 0.5, GradientMethod::Twelve));
    let mended = ANGLES.map(|yaw| mean_angle(&volume, yaw, 0.5, GradientMethod::TwentySixSheared));
    println!("ramp 3: 12 {twelve:.2?}, 26d {mended:.2?}");
    let spread = twelve.iter().copied().fold(0.0, f64::max) - twelve.iter().copied().fold(90.0, f64::min);
    assert!(spread < 0.5, "{twelve:?}");
    assert!((0..4).all(|i| mended[i] < twelve[i] && mended[i] < 1.7), "{mended:?}");
}
