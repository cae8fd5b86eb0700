//! Registers and tables of the shading unit.

use crate::Basis;
use cube3_frame::{Geometry, Phong, PhongLight, ReflectanceTable, Shading};
use cube3_machine::{MachineSpec, ShadingUnit};
use cube3_scene::{ResolvedLight, Scene, ViewFrame, resolve_lights};

/// A light in the gradient's frame, negated: the surface's normal is against the gradient.
struct LocalLight {
    direction: [f64; 3],
    halfway: [f64; 3],
    colour: [f64; 3],
}

/// The shading unit's registers.
pub(crate) fn registers(
    scene: &Scene,
    machine: &MachineSpec,
    view: &ViewFrame,
    geometry: &Geometry,
    basis: &Basis,
) -> Shading {
    let local = |light: &ResolvedLight| LocalLight {
        direction: basis.components(&geometry.axes, -light.direction),
        halfway: basis.components(&geometry.axes, -light.halfway),
        colour: light.colour,
    };
    let lights: Vec<LocalLight> = resolve_lights(scene, view).iter().map(local).collect();
    match machine.abc.shading {
        ShadingUnit::Phong => Shading::Phong(phong(scene, machine, &lights)),
        ShadingUnit::ReflectanceTable => Shading::Table(reflectance(scene, machine, &lights)),
    }
}

/// An intensity 0 to [`Phong::MOST_INTENSITY`] as a fraction of the colour bits.
fn intensity(value: f64, colour_bits: u32) -> u32 {
    let one = f64::from(1_u32 << colour_bits);
    (value.clamp(0.0, f64::from(Phong::MOST_INTENSITY)) * one).round() as u32
}

/// An added intensity on the scale of a unit colour word.
fn added(value: f64, colour_bits: u32) -> u32 {
    (value.clamp(0.0, f64::from(Phong::MOST_INTENSITY)) * f64::from(cube3_word::unit_full(colour_bits))).round() as u32
}

fn phong(scene: &Scene, machine: &MachineSpec, lights: &[LocalLight]) -> Phong {
    let words = &machine.words;
    let one = f64::from(1_u32 << (words.normal_bits - 1));
    let quantise = |vector: [f64; 3]| vector.map(|x| (x * one).round() as i32);
    let material = &scene.material;
    let power_bits = machine.abc.power_bits;
    Phong {
        ambient: intensity(material.ambient, words.colour_bits),
        two_sided: material.two_sided,
        lights: lights
            .iter()
            .map(|light| PhongLight {
                direction: quantise(light.direction),
                halfway: quantise(light.halfway),
                diffuse: light.colour.map(|c| intensity(material.diffuse * c, words.colour_bits)),
                specular: light.colour.map(|c| added(material.specular * c, words.colour_bits)),
            })
            .collect(),
        power: Phong::powers(material.shininess, power_bits, words.colour_bits),
        power_bits,
    }
}

/// A Phong unit without lights that leaves colours as they are.
pub(crate) fn neutral(machine: &MachineSpec) -> Shading {
    let power_bits = machine.abc.power_bits;
    Shading::Phong(Phong {
        ambient: 1 << machine.words.colour_bits,
        two_sided: false,
        lights: Vec::new(),
        power: vec![0; (1 << power_bits) + 1],
        power_bits,
    })
}

fn reflectance(scene: &Scene, machine: &MachineSpec, lights: &[LocalLight]) -> ReflectanceTable {
    let (bits, colour_bits) = (machine.abc.reflectance_bits, machine.words.colour_bits);
    let material = &scene.material;
    let side = 1_u32 << bits;
    let centre = |i: u32| (f64::from(i) + 0.5) / f64::from(side) * 2.0 - 1.0;
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let mut diffuse = Vec::new();
    let mut specular = Vec::new();
    for face in 0..6 {
        for second in 0..side {
            for first in 0..side {
                let (axis, sign) = (face / 2, if face % 2 == 0 { 1.0 } else { -1.0 });
                let mut direction = [0.0; 3];
                direction[axis] = sign;
                direction[(axis + 1) % 3] = centre(first);
                direction[(axis + 2) % 3] = centre(second);
                let length = dot(direction, direction).sqrt();
                let direction = direction.map(|x| x / length);
                let (mut lit, mut shine) = ([material.ambient; 3], [0.0; 3]);
                for light in lights {
                    let (cosine, half) = (dot(direction, light.direction), dot(direction, light.halfway));
                    let (cosine, half) = match material.two_sided {
                        true => (cosine.abs(), half.abs()),
                        false if cosine <= 0.0 => (0.0, 0.0),
                        false => (cosine, half.max(0.0)),
                    };
                    for i in 0..3 {
                        lit[i] += material.diffuse * light.colour[i] * cosine;
                        shine[i] += material.specular * light.colour[i] * libm::pow(half, material.shininess);
                    }
                }
                diffuse.push(lit.map(|x| intensity(x, colour_bits)));
                specular.push(shine.map(|x| added(x, colour_bits)));
            }
        }
    }
    ReflectanceTable { bits, diffuse, specular, flat: intensity(material.ambient, colour_bits) }
}
