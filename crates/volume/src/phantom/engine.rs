//! A machined block with bores and dense inserts, on the scale of the GE engine's CT scan.
//!
//! Casting 100 to 160, inserts 180 to 255, air 0, in u8. Half a block of two cylinders: a flange, a body
//! with two bores lined with sleeves, bolts in its corners, a cross bore with a shaft, ribs. Each
//! surface is a cubic ramp of its signed distance, 2.4 voxels from end to end. The cube is 200 units
//! wide.

use glam::DVec3;

use super::blocks::{half_diagonal, sample_in_blocks};
use super::solid::{Body, Solid, smooth_coverage};
use crate::{Volume, VolumeError};

const CUBE_UNITS: f64 = 200.0;
const RAMP_VOXELS: f64 = 2.4;

/// Densities; the casting's rises by as much from its bottom to its top.
const CASTING: f64 = 115.0;
const CASTING_RISE: f64 = 25.0;
const SLEEVE: f64 = 190.0;
const SHAFT: f64 = 215.0;
const BOLT: f64 = 245.0;

pub(super) fn engine(size: usize) -> Result<Volume, VolumeError> {
    let (casting, sleeves, shaft, bolts) = (casting(), sleeves(), shaft(), bolts());
    let unit = CUBE_UNITS / size as f64;
    let middle = (size as f64 - 1.0) / 2.0;
    let place = |v: [f64; 3]| (DVec3::from(v) - middle) * unit;
    sample_in_blocks(size, |centre| {
        let radius = half_diagonal() * unit;
        let reach = RAMP_VOXELS * unit;
        let near = |s: &Solid| s.near(place(centre), radius, reach);
        let (casting, sleeves, shaft, bolts) = (near(&casting), near(&sleeves), near(&shaft), near(&bolts));
        move |voxel| {
            let p = place(voxel);
            let mut value = 0.0;
            let mut lay = |metal: f64, solid: &Solid| {
                if !solid.is_empty() {
                    value += (metal - value) * smooth_coverage(solid.distance(p), RAMP_VOXELS * unit);
                }
            };
            lay(CASTING + CASTING_RISE * (p.z / CUBE_UNITS + 0.5), &casting);
            lay(SLEEVE, &sleeves);
            lay(SHAFT, &shaft);
            lay(BOLT, &bolts);
            f64::round(value) as u8
        }
    })
}

/// The axes of the two bores in x.
const BORES: [f64; 2] = [-38.0, 38.0];

fn casting() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::block([0.0, 0.0, -8.0], [82.0, 46.0, 62.0], 6.0));
    s.add(4.0, Body::block([0.0, 0.0, -72.0], [92.0, 62.0, 10.0], 4.0));
    s.add(4.0, Body::block([0.0, 0.0, 56.0], [88.0, 52.0, 9.0], 4.0));
    for x in [-70.0, -38.0, 0.0, 38.0, 70.0] {
        s.add(3.0, Body::block([x, 48.0, -10.0], [4.0, 8.0, 58.0], 2.0));
    }
    s.add(4.0, Body::capsule([0.0, -40.0, -10.0], [0.0, -70.0, -10.0], [20.0, 20.0]));
    // Bores, water jackets, crank case, port.
    for x in BORES {
        s.cut(2.0, Body::capsule([x, 0.0, -20.0], [x, 0.0, 130.0], [27.0, 27.0]));
    }
    s.cut(3.0, Body::block([0.0, 0.0, 10.0], [4.0, 34.0, 34.0], 3.0));
    s.cut(3.0, Body::capsule([-110.0, 0.0, -70.0], [110.0, 0.0, -70.0], [26.0, 26.0]));
    s.cut(2.0, Body::capsule([0.0, -20.0, -10.0], [0.0, -110.0, -10.0], [11.0, 11.0]));
    s
}

fn sleeves() -> Solid {
    let mut s = Solid::default();
    for x in BORES {
        s.add(0.0, Body::capsule([x, 0.0, -14.0], [x, 0.0, 38.0], [27.0, 27.0]));
        s.cut(0.0, Body::capsule([x, 0.0, -60.0], [x, 0.0, 120.0], [21.0, 21.0]));
    }
    s
}

fn shaft() -> Solid {
    let mut s = Solid::default();
    s.add(0.0, Body::capsule([-84.0, 0.0, -70.0], [84.0, 0.0, -70.0], [9.0, 9.0]));
    for x in [-60.0, -15.0, 15.0, 60.0] {
        s.add(2.0, Body::block([x, 0.0, -66.0], [4.0, 13.0, 18.0], 2.0));
    }
    s
}

fn bolts() -> Solid {
    let mut s = Solid::default();
    for x in [-76.0, 0.0, 76.0] {
        for y in [-40.0, 40.0] {
            s.add(0.0, Body::capsule([x, y, 20.0], [x, y, 68.0], [4.0, 4.0]));
            s.add(1.0, Body::block([x, y, 68.0], [7.0, 7.0, 4.0], 1.0));
        }
    }
    s
}
