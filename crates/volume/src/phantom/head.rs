//! A human head as a CT scanner sees it, on the scale of the Cube-3 paper's CT head.
//!
//! Air is 0, soft tissue 60 to 75, bone 105 to 200 (teeth the densest), so the paper's transfer
//! function, opacity 0 up to 80 and 0.75 from 100 on, shows the skull. x runs to the patient's left,
//! the face looks towards −y, the crown is up, at high z; left and right are mirror images. The cube
//! is 250 mm wide; the skull has the proportions of an adult's, about 180 mm long and 140 mm wide.
//!
//! Bones and tissues are smooth unions of ellipsoids and capsules ([`Solid`]). Each is laid over what is
//! under it by its share of the voxel: value ← value + (tissue − value)·coverage, where the coverage is
//! the cubic ramp 3t² − 2t³ of the signed distance, 2.4 voxels from end to end and as steep in the
//! middle as a linear ramp of 1.6 voxels.

use glam::DVec3;

use super::blocks::{half_diagonal, sample_in_blocks};
use super::solid::{Body, FAR, Solid, smooth_coverage};
use crate::{Volume, VolumeError};

/// Side of the cube in mm.
const CUBE_MM: f64 = 250.0;
/// Width of the ramp across a surface, in voxels.
const RAMP_VOXELS: f64 = 2.4;
/// Thickness of the cranium.
const CRANIUM_MM: f64 = 6.5;
/// Thickness of the scalp over it.
const SCALP_MM: f64 = 6.0;
/// Densities on the paper's 8-bit scale.
const MUSCLE: f64 = 66.0;
const SKIN: f64 = 60.0;
const CEREBROSPINAL_FLUID: f64 = 62.0;
const BRAIN: f64 = 72.0;
const EYE: f64 = 62.0;
const LENS: f64 = 75.0;
const SPONGY_BONE: f64 = 120.0;
const HARD_BONE: f64 = 170.0;
const TOOTH: f64 = 200.0;

pub(super) fn head(size: usize) -> Result<Volume, VolumeError> {
    let head = Head::new();
    let mm = CUBE_MM / size as f64;
    let middle = (size as f64 - 1.0) / 2.0;
    let place = |v: [f64; 3]| {
        let p = (DVec3::from(v) - middle) * mm;
        // The two halves mirror each other.
        DVec3::new(p.x.abs(), p.y, p.z)
    };
    sample_in_blocks(size, |centre| {
        // Half the block's diagonal; folding at x = 0 brings points no further apart.
        let radius = half_diagonal() * mm;
        let near = head.near(place(centre), radius, RAMP_VOXELS * mm);
        move |voxel| near.density(place(voxel), RAMP_VOXELS * mm).round() as u8
    })
}

/// The parts of the head, in mm from the centre of the cube. Only the half at x ≥ 0 is drawn.
#[derive(Clone, Debug)]
struct Head {
    /// The outside of the braincase, a solid.
    braincase: Solid,
    /// Holes through its wall.
    openings: Solid,
    /// All bones but the braincase, with what is cut from them.
    face: Solid,
    /// The lower jaw.
    mandible: Solid,
    teeth: Solid,
    spine: Solid,
    /// The outside of the head below the scalp.
    flesh: Solid,
    /// Air inside: nose, sinuses, throat, ear canals.
    airways: Solid,
    /// The wall between the halves of the nose.
    septum: Solid,
    eyes: Solid,
    lenses: Solid,
    /// Whether there is air only.
    empty: bool,
}

impl Head {
    fn new() -> Head {
        Head {
            braincase: braincase(),
            openings: openings(),
            face: face(),
            mandible: mandible(),
            teeth: teeth(),
            spine: spine(),
            flesh: flesh(),
            airways: airways(),
            septum: septum(),
            eyes: eyes(),
            lenses: lenses(),
            empty: false,
        }
    }

    /// What is needed within `radius` of `centre` for surfaces softened over `ramp`.
    fn near(&self, centre: DVec3, radius: f64, ramp: f64) -> Head {
        // Braincase: scalp outside, wall and fluid inside. Others: the change from hard to spongy bone.
        let around = |solid: &Solid| solid.near(centre, radius, ramp + 10.0);
        let near = |solid: &Solid| solid.near(centre, radius, ramp + 5.0);
        let mut head = Head {
            braincase: around(&self.braincase),
            openings: near(&self.openings),
            face: near(&self.face),
            mandible: near(&self.mandible),
            teeth: near(&self.teeth),
            spine: near(&self.spine),
            flesh: near(&self.flesh),
            airways: near(&self.airways),
            septum: near(&self.septum),
            eyes: near(&self.eyes),
            lenses: near(&self.lenses),
            empty: false,
        };
        head.empty = head.flesh.is_empty() && head.braincase.is_empty();
        head
    }

    /// The density at `p`, 0 to 200, with surfaces softened over `ramp`.
    fn density(&self, p: DVec3, ramp: f64) -> f64 {
        if self.empty {
            return 0.0;
        }
        let braincase = self.braincase.distance(p);
        let skin = (braincase - SCALP_MM).min(self.flesh.distance(p));
        if skin > ramp {
            return 0.0;
        }
        let mut value = 0.0;
        let mut lay = |tissue: f64, d: f64| value += (tissue - value) * smooth_coverage(d, ramp);
        lay(SKIN, skin);
        lay(MUSCLE, skin + 3.0);
        let cavity = braincase + CRANIUM_MM;
        lay(CEREBROSPINAL_FLUID, cavity);
        lay(BRAIN, cavity + 2.5);

        let wall = braincase.max(-cavity).max(-self.openings.distance(p));
        lay(0.0, self.airways.distance(p));
        let bone = wall.min(self.face.distance(p)).min(self.mandible.distance(p)).min(self.spine.distance(p));
        let bone = bone.min(self.septum.distance(p));
        if bone < FAR / 2.0 {
            let depth = ((-bone - 1.5) / 3.0).clamp(0.0, 1.0);
            lay(HARD_BONE + (SPONGY_BONE - HARD_BONE) * depth * depth * (3.0 - 2.0 * depth), bone);
        }
        lay(EYE, self.eyes.distance(p));
        lay(LENS, self.lenses.distance(p));
        lay(TOOTH, self.teeth.distance(p));
        value
    }
}

fn braincase() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([0.0, 8.0, 46.0], [66.0, 82.0, 60.0]));
    // Occiput, parietal eminences, forehead, temporal bone.
    s.add(18.0, Body::ellipsoid([0.0, 48.0, 34.0], [58.0, 52.0, 48.0]));
    s.add(18.0, Body::ellipsoid([32.0, 34.0, 56.0], [37.0, 46.0, 42.0]));
    s.add(18.0, Body::ellipsoid([0.0, -34.0, 46.0], [54.0, 44.0, 46.0]));
    s.add(14.0, Body::ellipsoid([34.0, 10.0, 14.0], [32.0, 40.0, 28.0]));
    // The temples are hollow behind the eyes.
    s.cut(10.0, Body::turned([70.0, -44.0, 14.0], [17.0, 28.0, 26.0], 14.0));
    s
}

fn openings() -> Solid {
    let mut s = Solid::default();
    // Foramen magnum; the orbits.
    s.add(0.0, Body::ellipsoid([0.0, 30.0, -14.0], [15.0, 18.0, 22.0]));
    s.add(0.0, orbit(0.0));
    s
}

/// The eye socket, made wider by `wall`: a cone that opens forward and outward.
fn orbit(wall: f64) -> Body {
    Body::capsule([32.5, -68.0, 8.0], [12.0, -22.0, 5.0], [19.0 + wall, 3.0 + wall])
}

fn face() -> Solid {
    let mut s = Solid::default();
    // The orbit's walls, cut off in front by the plane of the rim.
    s.add(0.0, orbit(3.5));
    s.cut(3.0, Body::block([40.0, -115.0, 8.0], [80.0, 42.0, 60.0], 2.0));
    // Brow: from the root of the nose over the orbit to its outer rim; then the outer rim.
    s.add(7.0, Body::capsule([0.0, -76.0, 22.0], [14.0, -76.0, 26.0], [7.5, 6.5]));
    s.add(7.0, Body::capsule([14.0, -76.0, 26.0], [36.0, -70.0, 29.0], [6.5, 5.5]));
    s.add(7.0, Body::capsule([36.0, -70.0, 29.0], [50.0, -57.0, 20.0], [5.5, 5.0]));
    s.add(5.0, Body::capsule([50.0, -57.0, 20.0], [50.0, -55.0, -6.0], [5.0, 5.5]));
    // Cheek bone, its foot on the upper jaw, the lower rim, and the arch to the ear.
    s.add(6.0, Body::turned([47.0, -58.0, -13.0], [12.0, 9.0, 10.5], 35.0));
    s.add(6.0, Body::capsule([44.0, -60.0, -14.0], [27.0, -64.0, -27.0], [9.0, 9.0]));
    s.add(5.0, Body::capsule([46.0, -62.0, -10.0], [24.0, -73.0, -11.0], [5.0, 4.5]));
    s.add(5.0, Body::capsule([52.0, -52.0, -13.0], [64.0, -30.0, -11.0], [5.5, 4.2]));
    s.add(5.0, Body::capsule([64.0, -30.0, -11.0], [66.0, -6.0, -8.0], [4.2, 4.2]));
    s.add(5.0, Body::capsule([66.0, -6.0, -8.0], [60.0, 10.0, -5.0], [4.2, 5.0]));
    // Upper jaw and the ridge that bears its teeth.
    s.add(6.0, Body::ellipsoid([0.0, -54.0, -22.0], [30.0, 26.0, 20.0]));
    s.add(6.0, Body::ellipsoid([0.0, -51.0, -40.0], [29.5, 28.0, 9.0]));
    s.add(4.0, Body::capsule([14.0, -74.0, -6.0], [13.0, -74.0, -32.0], [4.0, 5.5]));
    // Bones of the nose and the inner rim.
    s.add(5.0, Body::capsule([1.5, -78.0, 18.0], [3.5, -86.0, 1.0], [5.0, 3.4]));
    s.add(4.0, Body::capsule([8.0, -76.0, 17.0], [14.0, -74.0, -8.0], [4.5, 4.0]));
    // Base of the skull: temporal bone, mastoid process, sphenoid and its wings, occipital base.
    s.add(8.0, Body::ellipsoid([46.0, 20.0, -6.0], [17.0, 24.0, 13.0]));
    s.add(6.0, Body::capsule([53.0, 27.0, -6.0], [50.0, 23.0, -30.0], [10.0, 6.5]));
    s.add(8.0, Body::ellipsoid([16.0, -8.0, -10.0], [34.0, 30.0, 8.0]));
    s.add(6.0, Body::capsule([14.0, -24.0, -14.0], [15.0, -28.0, -38.0], [6.0, 4.0]));
    s.add(6.0, Body::capsule([18.0, 34.0, -18.0], [20.0, 40.0, -18.0], [6.0, 6.0]));
    // Nose, orbit, sinuses and the joint of the jaw are hollow.
    s.cut(2.0, orbit(0.0));
    s.cut(2.0, Body::ellipsoid([4.0, -84.0, -22.0], [9.0, 24.0, 10.5]));
    s.cut(2.0, Body::ellipsoid([2.0, -86.0, -10.0], [6.5, 22.0, 12.0]));
    s.cut(1.0, Body::ellipsoid([0.0, -52.0, -15.0], [11.0, 34.0, 15.0]));
    s.cut(1.0, Body::ellipsoid([26.0, -54.0, -19.0], [11.0, 11.0, 9.0]));
    s.cut(1.0, Body::ellipsoid([9.0, -75.0, 28.0], [8.0, 3.2, 6.0]));
    s.cut(1.0, Body::capsule([40.0, 13.0, -6.0], [90.0, 13.0, -6.0], [3.5, 3.5]));
    s.cut(2.0, Body::ellipsoid([52.0, -2.0, -15.0], [10.0, 8.0, 7.0]));
    // The palate is arched.
    s.cut(3.0, Body::ellipsoid([0.0, -46.0, -48.0], [20.0, 26.0, 13.0]));
    s
}

fn mandible() -> Solid {
    let mut s = Solid::default();
    // Ramus: condyle, coronoid process, and the plate between them.
    s.add(0.0, Body::capsule([52.0, -1.0, -16.0], [50.0, 0.0, -30.0], [5.5, 4.5]));
    s.add(4.0, Body::capsule([50.0, 0.0, -30.0], [47.0, -6.0, -66.0], [4.5, 6.0]));
    s.add(4.0, Body::capsule([50.0, -24.0, -22.0], [47.0, -22.0, -62.0], [3.5, 5.5]));
    s.add(6.0, Body::ellipsoid([48.5, -13.0, -52.0], [5.0, 17.0, 22.0]));
    // Body: a low and a high row from the angle to the chin.
    s.add(6.0, Body::capsule([47.0, -8.0, -68.0], [38.0, -44.0, -80.0], [6.5, 7.0]));
    s.add(6.0, Body::capsule([38.0, -44.0, -80.0], [22.0, -68.0, -88.0], [7.0, 7.5]));
    s.add(6.0, Body::capsule([22.0, -68.0, -88.0], [0.0, -78.0, -90.0], [7.5, 8.0]));
    s.add(8.0, Body::capsule([45.0, -20.0, -64.0], [33.0, -46.0, -72.0], [5.5, 5.5]));
    s.add(8.0, Body::capsule([33.0, -46.0, -72.0], [19.0, -67.0, -75.0], [5.5, 5.5]));
    s.add(8.0, Body::capsule([19.0, -67.0, -75.0], [0.0, -75.0, -76.0], [5.5, 5.5]));
    s.add(8.0, Body::capsule([40.0, -34.0, -73.0], [20.0, -67.0, -81.0], [5.5, 5.5]));
    s.add(8.0, Body::capsule([20.0, -67.0, -81.0], [0.0, -76.5, -83.0], [5.5, 5.5]));
    s.add(10.0, Body::ellipsoid([0.0, -81.0, -93.0], [17.0, 6.0, 6.0]));
    s
}

/// Seven teeth on each side of each jaw along a parabola.
fn teeth() -> Solid {
    /// Width of each tooth from the middle outwards, upper and lower.
    const WIDTHS: [[f64; 7]; 2] = [[8.5, 6.8, 7.6, 7.0, 7.0, 10.0, 9.6], [5.8, 6.2, 7.2, 7.2, 7.4, 10.8, 10.2]];
    /// Gap between two teeth.
    const GAP_MM: f64 = 1.5;
    /// The parabola's apex in y, and its curvature.
    const APEX_MM: [f64; 2] = [-79.5, -77.5];
    const CURVATURE: f64 = 0.036;
    let mut s = Solid::default();
    for jaw in 0..2 {
        let mut x = 0.0;
        for (i, &width) in WIDTHS[jaw].iter().enumerate() {
            // A step along the parabola by the tooth's width and its gap.
            let step = |x: f64, length: f64| x + length / (2.0 * CURVATURE * x).hypot(1.0);
            let middle = step(x, (width + GAP_MM) / 2.0);
            x = step(middle, (width + GAP_MM) / 2.0);
            let y = APEX_MM[jaw] + CURVATURE * middle * middle;
            // Incisors are thin, molars square; the canine is the longest.
            let thick = if i < 2 { 6.0 } else { 8.5 };
            let long = if i == 2 { 1.0 } else { 0.0 };
            let turn = (2.0 * CURVATURE * middle).atan().to_degrees();
            let (low, high) = if jaw == 0 { (-58.0 - long, -38.0) } else { (-77.0, -61.0 + long) };
            let radii = [width / 2.0, thick / 2.0, (high - low) / 2.0];
            s.add(0.0, Body::turned([middle, y, (low + high) / 2.0], radii, turn));
        }
    }
    s
}

/// The upper vertebrae of the neck.
fn spine() -> Solid {
    let mut s = Solid::default();
    for level in 0..5 {
        let z = -32.0 - 19.0 * f64::from(level);
        let y = 20.0 + 1.5 * f64::from(level);
        s.add(2.0, Body::block([0.0, y, z], [11.0, 9.5, 7.5], 4.0));
        s.add(3.0, Body::capsule([10.0, y + 6.0, z], [24.0, y + 7.0, z - 2.0], [4.5, 4.0]));
        s.add(3.0, Body::capsule([15.0, y + 8.0, z], [0.0, y + 27.0, z - 2.0], [4.5, 4.0]));
        s.add(4.0, Body::capsule([15.0, y + 9.0, z + 8.0], [15.0, y + 10.5, z - 8.0], [4.5, 4.5]));
        s.add(3.0, Body::capsule([0.0, y + 27.0, z - 2.0], [0.0, y + 40.0, z - 7.0], [4.0, 3.5]));
    }
    s
}

fn flesh() -> Solid {
    let mut s = Solid::default();
    // Face, cheeks, jaw, chin, neck.
    s.add(0.0, Body::ellipsoid([0.0, -32.0, 0.0], [66.0, 56.0, 58.0]));
    s.add(25.0, Body::ellipsoid([0.0, -34.0, -46.0], [57.0, 52.0, 48.0]));
    s.add(20.0, Body::ellipsoid([0.0, -46.0, -76.0], [44.0, 44.0, 28.0]));
    s.add(15.0, Body::ellipsoid([0.0, -80.0, -91.0], [20.0, 14.0, 14.0]));
    s.add(25.0, Body::capsule([0.0, 18.0, -30.0], [0.0, 30.0, -180.0], [54.0, 58.0]));
    s.add(20.0, Body::ellipsoid([0.0, 40.0, 10.0], [66.0, 66.0, 50.0]));
    // Nose with its wings, lips.
    s.add(8.0, Body::capsule([0.0, -84.0, 18.0], [0.0, -105.0, -16.0], [6.0, 7.5]));
    s.add(6.0, Body::ellipsoid([10.0, -95.0, -20.0], [8.0, 9.0, 7.0]));
    s.add(10.0, Body::ellipsoid([0.0, -84.0, -50.0], [26.0, 11.0, 9.0]));
    s.add(10.0, Body::ellipsoid([0.0, -83.0, -65.0], [23.0, 11.0, 8.0]));
    s.add(10.0, Body::ellipsoid([32.0, -72.0, 8.0], [18.0, 12.0, 13.0]));
    // The ear and its hollow.
    s.add(4.0, Body::turned([79.0, 18.0, 2.0], [6.0, 17.0, 30.0], -25.0));
    s.cut(4.0, Body::turned([86.0, 14.0, 0.0], [6.0, 10.0, 19.0], -25.0));
    // The mouth's slit and the nostrils.
    s.cut(2.0, Body::ellipsoid([0.0, -100.0, -59.0], [24.0, 10.0, 2.0]));
    s.cut(2.0, Body::capsule([6.5, -97.0, -32.0], [5.0, -90.0, -20.0], [3.5, 3.5]));
    s
}

fn airways() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([0.0, -54.0, -15.0], [10.0, 32.0, 14.0]));
    s.add(2.0, Body::capsule([4.0, -80.0, -22.0], [6.0, -96.0, -30.0], [4.5, 3.5]));
    s.add(4.0, Body::capsule([0.0, -28.0, -18.0], [0.0, -4.0, -50.0], [8.0, 8.0]));
    s.add(4.0, Body::capsule([0.0, -4.0, -50.0], [0.0, -4.0, -180.0], [8.0, 8.0]));
    s.add(0.0, Body::ellipsoid([26.0, -54.0, -19.0], [11.0, 11.0, 9.0]));
    s.add(0.0, Body::ellipsoid([9.0, -75.0, 28.0], [8.0, 3.2, 6.0]));
    s.add(0.0, Body::capsule([52.0, 13.0, -6.0], [92.0, 13.0, -6.0], [3.0, 3.5]));
    s
}

fn septum() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([0.0, -54.0, -14.0], [1.4, 26.0, 15.0]));
    s
}

fn eyes() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([32.0, -72.0, 9.0], [12.0, 12.0, 12.0]));
    s
}

fn lenses() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::ellipsoid([32.0, -80.0, 9.0], [4.5, 2.2, 4.5]));
    s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a block leaves out cannot be seen in it.
    #[test]
    fn blocks_leave_no_seams() {
        let whole = Head::new();
        for size in [48, 100] {
            let (mm, middle) = (CUBE_MM / size as f64, (size as f64 - 1.0) / 2.0);
            let head = head(size).unwrap();
            for z in 0..size {
                for y in 0..size {
                    for x in 0..size {
                        let p = (DVec3::new(x as f64, y as f64, z as f64) - middle) * mm;
                        let p = DVec3::new(p.x.abs(), p.y, p.z);
                        let density = whole.density(p, RAMP_VOXELS * mm);
                        let error = (head.value(x, y, z) - density).abs();
                        // Half for the rounding; the rest where a blend reaches further than the block looks.
                        assert!(error <= 0.51, "{error} at {p} mm, {size} voxels");
                    }
                }
            }
        }
    }
}
