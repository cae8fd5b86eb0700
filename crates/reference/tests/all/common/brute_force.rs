//! The definitions of the six modes, written down once more over a list of samples; and scenes that use everything.

use super::one_voxel_a_pixel;
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, Layer, Light, Material, Mode, ResolvedLight, Scene, Threshold, Transfer, View,
    corrected_opacity, depth_range, phong,
};
use cube3_volume::Volume;
use glam::DVec3;

/// One sample as brute force sees it.
pub struct Gathered {
    /// Its value.
    pub value: f64,
    /// x, y, z in voxels.
    pub position: [f64; 3],
    /// In the frame of the lights.
    pub gradient: DVec3,
    /// The part of a step that it stands for.
    pub part: f64,
}

/// The pixel of a list of samples, front to back.
pub fn brute_force(
    scene: &Scene,
    volume: &Volume,
    lights: &[ResolvedLight],
    samples: &[Gathered],
    length: f64,
    sum: f64,
) -> [f64; 4] {
    let view = scene.view.frame().unwrap();
    let shown: Vec<&Gathered> =
        samples.iter().filter(|s| !scene.threshold.as_ref().is_some_and(|t| t.removes(s.value))).collect();
    let opacity = |s: &Gathered| scene.transfer.opacity_at(s.value, s.gradient.length());
    let cue = |s: &Gathered, rgb: [f64; 3]| {
        let Some(cue) = &scene.depth_cue else { return rgb };
        let [near, far] = depth_range(&view, volume.dims, volume.spacing);
        let world = DVec3::from([0, 1, 2].map(|i| s.position[i] * volume.spacing[i]));
        let factor = cue.factor_at((view.direction.dot(world) - near) / (far - near));
        rgb.map(|c| c * factor)
    };
    let plain = |s: &Gathered| cue(s, scene.transfer.colour_at(s.value));
    let lit = |s: &Gathered| {
        let normal = (s.gradient != DVec3::ZERO).then(|| -s.gradient.normalize());
        cue(s, phong(&scene.material, lights, normal, scene.transfer.colour_at(s.value)))
    };
    let weighted = |[r, g, b]: [f64; 3], a: f64| [r * a, g * a, b * a, a];
    let opaque = |s: &&&Gathered| opacity(s) >= scene.transfer.opaque_alpha;
    match scene.mode {
        Mode::Composite => shown.iter().rev().fold([0.0; 4], |behind, s| {
            let correction = if scene.transfer.opacity_correction { length } else { 1.0 };
            let alpha = corrected_opacity(opacity(s), correction * s.part);
            let front = weighted(lit(s), alpha);
            [0, 1, 2, 3].map(|i| front[i] + (1.0 - alpha) * behind[i])
        }),
        Mode::FirstOpaque => shown.iter().find(opaque).map_or([0.0; 4], |s| weighted(lit(s), 1.0)),
        Mode::LastOpaque => shown.iter().rev().find(opaque).map_or([0.0; 4], |s| weighted(lit(s), 1.0)),
        Mode::Maximum | Mode::Minimum => {
            let sign = if scene.mode == Mode::Maximum { 1.0 } else { -1.0 };
            let best = shown.iter().map(|s| sign * s.value).fold(f64::NEG_INFINITY, f64::max);
            let front = shown.iter().find(|s| sign * s.value == best);
            front.map_or([0.0; 4], |s| weighted(plain(s), opacity(s)))
        }
        Mode::WeightedSum => shown.iter().fold([0.0; 4], |total, s| {
            let sample = weighted(plain(s), opacity(s));
            [0, 1, 2, 3].map(|i| total[i] + sample[i] * s.part * sum)
        }),
    }
}

/// Scenes that use everything, in every mode.
pub fn scenes() -> Vec<Scene> {
    let ramp = Transfer {
        opacity: vec![[60.0, 0.0], [200.0, 0.9]],
        colour: vec![
            ColourPoint { value: 0.0, rgb: [1.0, 0.2, 0.1] },
            ColourPoint { value: 255.0, rgb: [0.1, 0.8, 1.0] },
        ],
        ..Transfer::default()
    };
    let base = Scene {
        view: View::from_angles(25.0, 14.0),
        image: one_voxel_a_pixel(13, 12),
        transfer: ramp.clone(),
        background: [0.1, 0.2, 0.3],
        ..Scene::default()
    };
    let layers = vec![
        Layer { gradient: 5.0, opacity: vec![[80.0, 0.0], [160.0, 0.1]] },
        Layer { gradient: 50.0, opacity: vec![[40.0, 0.0], [160.0, 0.7]] },
    ];
    let lights = vec![
        Light { direction: Some([1.0, -0.5, 2.0]), colour: [1.0, 0.9, 0.5] },
        Light { direction: None, colour: [0.2, 0.3, 0.4] },
    ];
    let mut one_sided = base.material.clone();
    one_sided.two_sided = false;
    let everything = Scene {
        transfer: Transfer { layers, opacity: vec![], opaque_alpha: 0.3, ..ramp.clone() },
        lights,
        material: one_sided,
        depth_cue: Some(DepthCue { front: 0.9, back: 0.2 }),
        cuts: vec![Cut { normal: [1.0, 0.3, -0.2], through_voxel: [3.1, 2.0, 2.0] }],
        crop: Some(Crop { min_voxel: [0.3, 0.0, 0.9], max_voxel: [4.5, 3.2, 9.0] }),
        threshold: Some(Threshold { low: Some(50.0), high: Some(230.0) }),
        ..base.clone()
    };
    let flat = Scene {
        material: Material { shaded: false, ..base.material.clone() },
        transfer: Transfer { opacity_correction: false, ..ramp },
        depth_cue: Some(DepthCue::default()),
        ..base.clone()
    };
    [base, everything, flat]
        .into_iter()
        .flat_map(|scene| Mode::ALL.map(|mode| Scene { mode, ..scene.clone() }))
        .collect()
}
