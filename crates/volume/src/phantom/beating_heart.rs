//! A heart that beats in a thorax: two chambers whose walls move, in closed form over space and phase.
//!
//! Air is 0, lung 12, soft tissue 45, bone 140, muscle of the heart 120, blood 170 in the right chamber and 200 in the left and
//! in the aorta, in u8: with the paper's transfer function, opacity 0 up to 80, heart, vessels and spine are seen. x runs to
//! the patient's left, the chest looks towards −y, the head is up, at high z. The cube is 200 mm wide.
//!
//! A chamber is an ellipsoid that keeps its proportions. With t the phase, 0 at the end of filling, it holds
//!
//! ```text
//!   V(t) = V₁ + (V₀ − V₁)·s(t),   s(t) = (1 + cos(π·t/0.35))/2 up to t = 0.35, then (1 − cos(π·(t − 0.35)/0.65))/2
//! ```
//!
//! so its half axes are those at the end of filling times ∛(V/V₀). Muscle cannot be compressed: the wall around a chamber keeps its
//! volume, and its outside is the ellipsoid that holds V(t) and the wall. Each tissue is laid over what is under it by its share
//! of the voxel, the cubic ramp 3t² − 2t³ of the signed distance, 2.4 voxels from end to end.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::PhantomParams;
use super::blocks::{half_diagonal, sample_in_blocks};
use super::solid::{Body, Solid, smooth_coverage};
use crate::{Volume, VolumeError};

/// Side of the cube in mm.
const CUBE_MM: f64 = 200.0;
/// Width of the ramp across a surface, in voxels.
const RAMP_VOXELS: f64 = 2.4;
/// Share of the period in which the chambers empty: a third, as at rest.
const SYSTOLE: f64 = 0.35;
/// Phases are whole multiples of 2⁻³², so that t and t + 1 are one number whatever the rounding of the sum.
const PHASES: f64 = 4_294_967_296.0;

/// Densities.
const LUNG: f64 = 12.0;
const TISSUE: f64 = 45.0;
const MUSCLE: f64 = 120.0;
const BONE: f64 = 140.0;
const BLOOD_RIGHT: f64 = 170.0;
const BLOOD_LEFT: f64 = 200.0;

/// A chamber in the frame of the heart.
#[derive(Clone, Copy, Debug)]
struct Chamber {
    /// Centre in mm.
    centre: [f64; 3],
    /// Half axes at the end of filling in mm.
    radii: [f64; 3],
    /// Thickness of the wall there, at the ends of the half axes.
    wall_mm: f64,
    /// The part of the blood that leaves with each beat.
    ejected: f64,
}

/// The left chamber, 115 ml at most; its long axis is the heart's.
const LEFT: Chamber = Chamber { centre: [0.0, 0.0, 0.0], radii: [25.0, 25.0, 44.0], wall_mm: 9.0, ejected: 0.6 };
/// The right chamber, 88 ml at most.
const RIGHT: Chamber = Chamber { centre: [-52.0, 0.0, 4.0], radii: [20.0, 27.0, 39.0], wall_mm: 4.0, ejected: 0.55 };

/// Where the heart's own frame has its origin in the thorax.
const HEART_MM: [f64; 3] = [22.0, -14.0, -8.0];

/// The share of the stroke that is in the chambers at phase `t` from 0 to 1: 1 when they are full.
fn filling(t: f64) -> f64 {
    if t < SYSTOLE {
        (1.0 + (PI * t / SYSTOLE).cos()) / 2.0
    } else {
        (1.0 - (PI * (t - SYSTOLE) / (1.0 - SYSTOLE)).cos()) / 2.0
    }
}

/// 4/3·π times the product of the half axes.
fn ellipsoid_volume(radii: [f64; 3]) -> f64 {
    4.0 / 3.0 * PI * radii[0] * radii[1] * radii[2]
}

impl Chamber {
    /// Volume of the blood in mm³.
    fn blood(&self, filling: f64) -> f64 {
        ellipsoid_volume(self.radii) * (1.0 - self.ejected * (1.0 - filling))
    }

    /// The chamber and its outside.
    fn bodies(&self, filling: f64) -> [Body; 2] {
        let (full, blood) = (ellipsoid_volume(self.radii), self.blood(filling));
        let outside = self.radii.map(|radius| radius + self.wall_mm);
        let all = ellipsoid_volume(outside);
        let inner = (blood / full).cbrt();
        let outer = ((all - full + blood) / all).cbrt();
        let scaled = |radii: [f64; 3], by: f64| Body::ellipsoid(self.centre, radii.map(|radius| radius * by));
        [scaled(self.radii, inner), scaled(outside, outer)]
    }
}

/// The phase of `params`, brought to [0, 1).
fn phase(params: &PhantomParams) -> Result<f64, VolumeError> {
    let phase = params.phase.unwrap_or(0.0);
    if !phase.is_finite() {
        return Err(VolumeError::Parameter {
            name: "phase",
            reason: format!("{phase} is no phase"),
            remedy: "give a finite number; whole numbers are the end of filling",
        });
    }
    let steps = (phase.rem_euclid(1.0) * PHASES).round();
    Ok(if steps == PHASES { 0.0 } else { steps / PHASES })
}

pub(super) fn beating_heart(size: usize, params: &PhantomParams) -> Result<Volume, VolumeError> {
    let scene = Thorax::new(filling(phase(params)?));
    let mm = CUBE_MM / size as f64;
    let middle = (size as f64 - 1.0) / 2.0;
    let place = |v: [f64; 3]| (DVec3::from(v) - middle) * mm;
    sample_in_blocks(size, |centre| {
        let radius = half_diagonal() * mm;
        let near = scene.near(place(centre), radius, RAMP_VOXELS * mm);
        move |voxel| near.density(place(voxel), RAMP_VOXELS * mm).round() as u8
    })
}

/// From the thorax to the frame of the heart, whose long axis points from the apex, at the left, below and in front, to the base.
fn to_heart() -> DMat3 {
    let long = DVec3::new(-0.5, 0.45, 0.74).normalize();
    let across = DVec3::Y.cross(long).normalize();
    DMat3::from_cols(across, long.cross(across), long).transpose()
}

/// Everything at one phase. The heart's solids are in its own frame.
#[derive(Clone, Debug)]
struct Thorax {
    body: Solid,
    lungs: Solid,
    spine: Solid,
    vessels: Solid,
    muscle: Solid,
    right: Solid,
    left: Solid,
    turn: DMat3,
}

impl Thorax {
    fn new(filling: f64) -> Thorax {
        let ([left, left_outside], [right, right_outside]) = (LEFT.bodies(filling), RIGHT.bodies(filling));
        let mut muscle = Solid::default();
        muscle.add(0.0, left_outside);
        muscle.add(6.0, right_outside);
        let only = |body: Body| {
            let mut solid = Solid::default();
            solid.add(0.0, body);
            solid
        };
        Thorax {
            body: body(),
            lungs: lungs(),
            spine: spine(),
            vessels: vessels(),
            muscle,
            right: only(right),
            left: only(left),
            turn: to_heart(),
        }
    }

    fn in_heart(&self, p: DVec3) -> DVec3 {
        self.turn * (p - DVec3::from(HEART_MM))
    }

    /// What is needed within `radius` of `centre` for surfaces softened over `ramp`.
    fn near(&self, centre: DVec3, radius: f64, ramp: f64) -> Thorax {
        let near = |solid: &Solid| solid.near(centre, radius, ramp);
        let inside = |solid: &Solid| solid.near(self.in_heart(centre), radius, ramp);
        Thorax {
            body: near(&self.body),
            lungs: near(&self.lungs),
            spine: near(&self.spine),
            vessels: near(&self.vessels),
            muscle: inside(&self.muscle),
            right: inside(&self.right),
            left: inside(&self.left),
            turn: self.turn,
        }
    }

    /// The density at `p`, 0 to 200, with surfaces softened over `ramp`.
    fn density(&self, p: DVec3, ramp: f64) -> f64 {
        let mut value = 0.0;
        let mut lay = |tissue: f64, solid: &Solid, p: DVec3| {
            if !solid.is_empty() {
                value += (tissue - value) * smooth_coverage(solid.distance(p), ramp);
            }
        };
        lay(TISSUE, &self.body, p);
        lay(LUNG, &self.lungs, p);
        lay(BONE, &self.spine, p);
        lay(BLOOD_LEFT, &self.vessels, p);
        let p = self.in_heart(p);
        lay(MUSCLE, &self.muscle, p);
        lay(BLOOD_RIGHT, &self.right, p);
        lay(BLOOD_LEFT, &self.left, p);
        value
    }
}

/// The chest, an ellipsoid much longer than the cube.
fn body() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([0.0, 0.0, 0.0], [96.0, 82.0, 400.0]));
    s
}

/// Both lungs, with room between them for heart and spine.
fn lungs() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([-54.0, 8.0, 0.0], [34.0, 58.0, 110.0]));
    s.add(0.0, Body::ellipsoid([58.0, 14.0, 0.0], [30.0, 54.0, 110.0]));
    s
}

/// Vertebrae with their spinous processes.
fn spine() -> Solid {
    let mut s = Solid::default();
    for level in 0..9 {
        let z = -104.0 + 26.0 * f64::from(level);
        s.add(2.0, Body::block([0.0, 52.0, z], [15.0, 12.0, 10.5], 4.0));
        s.add(4.0, Body::capsule([0.0, 62.0, z], [0.0, 76.0, z - 8.0], [5.0, 3.5]));
    }
    s
}

/// The aorta: up from the base of the left chamber, over the arch, down along the spine.
fn vessels() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::capsule([2.0, 4.0, 22.0], [-8.0, 0.0, 58.0], [11.0, 11.0]));
    s.add(4.0, Body::capsule([-8.0, 0.0, 58.0], [2.0, 18.0, 72.0], [11.0, 10.5]));
    s.add(4.0, Body::capsule([2.0, 18.0, 72.0], [14.0, 36.0, 60.0], [10.5, 10.0]));
    s.add(4.0, Body::capsule([14.0, 36.0, 60.0], [12.0, 34.0, -130.0], [10.0, 8.5]));
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(phase: f64) -> PhantomParams {
        PhantomParams { phase: Some(phase), ..PhantomParams::default() }
    }

    /// Blood of both chambers in mm³, from voxels: each side of the septum from muscle to its own blood.
    fn blood(size: usize, phase: f64) -> [f64; 2] {
        let volume = beating_heart(size, &at(phase)).unwrap();
        let (mm, middle, turn) = (CUBE_MM / size as f64, (size as f64 - 1.0) / 2.0, to_heart());
        let mut sums = [0.0; 2];
        for z in 0..size {
            for y in 0..size {
                for x in 0..size {
                    let p = (DVec3::new(x as f64, y as f64, z as f64) - middle) * mm;
                    let p = turn * (p - DVec3::from(HEART_MM));
                    let value = volume.value(x, y, z);
                    // The septum's middle plane parts the chambers; around each, a shell of its wall belongs to it.
                    for (i, (chamber, density)) in [(LEFT, BLOOD_LEFT), (RIGHT, BLOOD_RIGHT)].into_iter().enumerate() {
                        let q = (p - DVec3::from(chamber.centre)) / (DVec3::from(chamber.radii) + 3.0);
                        if q.length() < 1.0 && (p.x < -28.5) == (i == 1) {
                            sums[i] += ((value - MUSCLE) / (density - MUSCLE)).clamp(0.0, 1.0) * mm.powi(3);
                        }
                    }
                }
            }
        }
        sums
    }

    #[test]
    fn chambers_hold_the_blood_of_their_closed_form() {
        for t in [0.0, 0.1, 0.2, 0.35, 0.5, 0.675, 0.9] {
            let found = blood(128, t);
            for (found, chamber) in found.into_iter().zip([LEFT, RIGHT]) {
                let expected = chamber.blood(filling(t));
                assert!((found / expected - 1.0).abs() < 0.01, "{t}: {found} for {expected} mm³");
            }
        }
    }

    #[test]
    fn walls_keep_their_volume_and_the_chambers_never_meet() {
        for step in 0..100 {
            let filling = filling(f64::from(step) / 100.0);
            for chamber in [LEFT, RIGHT] {
                let [inner, outer] = chamber.bodies(filling).map(|body| match body {
                    Body::Ellipsoid { radii, .. } => ellipsoid_volume(radii.to_array()),
                    _ => 0.0,
                });
                let wall =
                    ellipsoid_volume(chamber.radii.map(|r| r + chamber.wall_mm)) - ellipsoid_volume(chamber.radii);
                assert!((inner - chamber.blood(filling)).abs() < 1e-6);
                assert!((outer - inner - wall).abs() < 1e-6);
            }
        }
        const { assert!(LEFT.radii[0] + RIGHT.radii[0] + 5.0 < LEFT.centre[0] - RIGHT.centre[0]) };
    }

    #[test]
    fn a_beat_starts_and_ends_full_and_is_empty_at_systole_with_no_jump() {
        assert_eq!(filling(0.0), 1.0);
        assert!(filling(SYSTOLE) < 1e-15);
        for step in 0..1000 {
            let t = f64::from(step) / 1000.0;
            let next = filling((t + 1e-3) % 1.0);
            assert!((next - filling(t)).abs() <= PI / 2.0 * 1e-3 / SYSTOLE + 1e-9, "{t}");
        }
    }

    #[test]
    fn phases_a_whole_number_apart_are_one() {
        for t in [0.0, 0.1, 0.25, 1.0 / 3.0, 0.7, 0.999] {
            let of = |t: f64| phase(&at(t)).unwrap();
            for beats in [-3.0, 1.0, 2.0, 7.0, 1000.0] {
                assert_eq!(of(t), of(t + beats), "{t} + {beats}");
            }
        }
        assert_eq!(phase(&at(-1e-300)).unwrap(), 0.0);
    }

    /// What a block leaves out cannot be seen in it.
    #[test]
    fn blocks_leave_no_seams() {
        let whole = Thorax::new(filling(0.2));
        let size = 48;
        let (mm, middle) = (CUBE_MM / size as f64, (size as f64 - 1.0) / 2.0);
        let heart = beating_heart(size, &at(0.2)).unwrap();
        for z in 0..size {
            for y in 0..size {
                for x in 0..size {
                    let p = (DVec3::new(x as f64, y as f64, z as f64) - middle) * mm;
                    let error = (heart.value(x, y, z) - whole.density(p, RAMP_VOXELS * mm)).abs();
                    assert!(error <= 0.51, "{error} at {p} mm");
                }
            }
        }
    }
}
