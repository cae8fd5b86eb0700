//! Volumes of labels and their scenes.

use super::hash;
use cube3_scene::{ColourPoint, Material, Mode, Scene, Transfer, View, VolumeSource};
use cube3_volume::Volume;
use proptest::prelude::*;

/// Labels are below.
pub const TOP: f64 = 40.0;

/// Labels without structure.
pub fn labels(dims: [usize; 3], spacing: [f64; 3], seed: u64) -> Volume {
    Volume::from_fn(dims, spacing, |x, y, z| (hash(seed, [x, y, z]) * TOP) as u8).unwrap()
}

/// Labels as shades of grey, not lit.
pub fn scene(direction: [f64; 3], mode: Mode) -> Scene {
    let grey = |value: f64| ColourPoint { value, rgb: [value / TOP; 3] };
    Scene {
        mode,
        volume: VolumeSource { labels: true, ..VolumeSource::default() },
        view: View::from_direction(direction, None),
        transfer: Transfer { opacity: vec![[0.0, 1.0]], colour: vec![grey(0.0), grey(TOP)], ..Transfer::default() },
        material: Material { shaded: false, ..Material::default() },
        ..Scene::default()
    }
}

/// A view that is along no axis.
pub fn direction() -> impl Strategy<Value = [f64; 3]> {
    let part = || prop_oneof![0.05..1.0_f64, -1.0..-0.05_f64];
    [part(), part(), part()]
}
