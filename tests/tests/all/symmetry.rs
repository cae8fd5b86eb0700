//! Turning or mirroring the volume together with the view changes no bit of the base plane: all 48 symmetries of the cube.

use cube3_cases::cases;
use cube3_frame::BasePlane;
use cube3_function::{CanonicalVolume, render};
use cube3_host::frame_setup;
use cube3_machine::MachineSpec;
use cube3_scene::{Crop, Cut, Scene, View};
use cube3_tests::{SmallVolume, machines, scenes, volumes};
use proptest::prelude::*;

/// One of the 48: new axis i is old axis `axis[i]`, reversed or not.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    axis: [usize; 3],
    reversed: [bool; 3],
}

impl Symmetry {
    fn all() -> Vec<Symmetry> {
        let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
        let signs = (0..8).map(|bits| [bits & 1 != 0, bits & 2 != 0, bits & 4 != 0]);
        signs.flat_map(|reversed| orders.map(|axis| Symmetry { axis, reversed })).collect()
    }

    fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| if self.reversed[i] { -v[self.axis[i]] } else { v[self.axis[i]] })
    }

    /// A position in a volume of `dims` (before).
    fn position(&self, dims: [usize; 3], p: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let at = p[self.axis[i]];
            if self.reversed[i] { (dims[self.axis[i]] - 1) as f64 - at } else { at }
        })
    }

    fn volume(&self, volume: &SmallVolume) -> SmallVolume {
        let dims = self.axis.map(|a| volume.dims[a]);
        let mut words = vec![0; volume.words.len()];
        for z in 0..volume.dims[2] {
            for y in 0..volume.dims[1] {
                for x in 0..volume.dims[0] {
                    let to = self.position(volume.dims, [x as f64, y as f64, z as f64]).map(|c| c as usize);
                    words[to[0] + dims[0] * (to[1] + dims[1] * to[2])] =
                        volume.words[x + volume.dims[0] * (y + volume.dims[1] * z)];
                }
            }
        }
        SmallVolume { dims, spacing: self.axis.map(|a| volume.spacing[a]), words }
    }

    fn scene(&self, scene: &Scene, dims: [usize; 3]) -> Scene {
        let mut turned = scene.clone();
        turned.view = View { direction: scene.view.direction.map(|d| self.vector(d)), ..View::default() };
        for light in &mut turned.lights {
            light.direction = light.direction.map(|d| self.vector(d));
        }
        turned.cuts = scene
            .cuts
            .iter()
            .map(|cut| Cut { normal: self.vector(cut.normal), through_voxel: self.position(dims, cut.through_voxel) })
            .collect();
        turned.crop = scene.crop.as_ref().map(|crop| {
            let (a, b) = (self.position(dims, crop.min_voxel), self.position(dims, crop.max_voxel));
            Crop { min_voxel: [0, 1, 2].map(|i| a[i].min(b[i])), max_voxel: [0, 1, 2].map(|i| a[i].max(b[i])) }
        });
        turned
    }
}

fn image(machine: &MachineSpec, scene: &Scene, volume: &SmallVolume) -> BasePlane {
    let setup = frame_setup(scene, machine, &volume.info(), true).unwrap().setup;
    render(&setup, &CanonicalVolume::new(&setup.geometry.axes, volume.dims, &volume.words), true, &|_, _| {}).base
}

/// Positions on quarters of a voxel, which mirror exactly.
fn on_quarters(scene: &mut Scene) {
    let quarter = |p: &mut [f64; 3]| *p = p.map(|x| (x * 4.0).round() / 4.0);
    scene.cuts.iter_mut().for_each(|cut| quarter(&mut cut.through_voxel));
    if let Some(crop) = &mut scene.crop {
        quarter(&mut crop.min_voxel);
        quarter(&mut crop.max_voxel);
    }
}

proptest! {
    #![proptest_config(cases(150))]

    #[test]
    fn all_48_give_the_same_bits(
        (machine, mut scene, volume) in (machines(), scenes()).prop_flat_map(|(machine, scene)| {
            let bits = machine.words.voxel_bits;
            (Just(machine), Just(scene), volumes(6, bits))
        }),
        direction in [0.05..1.0_f64, 0.05..1.0_f64, 0.05..1.0_f64],
    ) {
        // Without ties: no two components of the direction, in voxels, are equal, and none is 0.
        let in_voxels = [0, 1, 2].map(|i| direction[i] / volume.spacing[i]);
        prop_assume!((0..3).all(|i| (in_voxels[i] - in_voxels[(i + 1) % 3]).abs() > 1e-6));
        scene.view = View { direction: Some(direction), ..View::default() };
        on_quarters(&mut scene);
        let expected = image(&machine, &scene, &volume);
        for symmetry in Symmetry::all() {
            let turned = symmetry.scene(&scene, volume.dims);
            let got = image(&machine, &turned, &symmetry.volume(&volume));
            prop_assert_eq!(&got, &expected, "{:?}", symmetry);
        }
    }
}
