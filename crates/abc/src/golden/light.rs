//! Light on a sample, by formula or by table, and the depth cue.

use super::counted::{Counted, counted, show};
use super::normal::{direction_index_wires, normalise};
use cube3_frame::{LinearFactor, Normaliser, Phong, RayRegisters, ReflectanceTable};
use cube3_word::{Probe, Words, unit_full};

/// Diffuse and specular light on a sample: what multiplies its colour (fractions of `colour_bits`) and what is added
/// to it (on the scale of a unit colour word).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReflectedLight {
    /// Multiplies.
    pub diffuse: [u32; 3],
    /// Is added.
    pub specular: [u32; 3],
}

/// Phong's formula in integers, with lights that are the same for all samples.
pub fn phong(normal: [i32; 3], phong: &Phong, words: &Words) -> ReflectedLight {
    phong_from(normal, phong, |light| [phong.lights[light].direction, phong.lights[light].halfway], words)
}

/// The view vector of the ray in a slot of a perspective frame: what the gradient has towards the eye, fractions of `normal_bits − 1`.
pub fn view_vector(row: usize, column: usize, rays: &RayRegisters, table: &Normaliser, words: &Words) -> [i32; 3] {
    normalise([rays.view_u[column], rays.view_v[row], rays.view_w], table, words).direction
}

/// The vector halfway between a light and the eye, by the unit's own normaliser; 0 where they are opposite.
pub fn halfway(light: [i32; 3], view: [i32; 3], table: &Normaliser, words: &Words) -> [i32; 3] {
    normalise([0, 1, 2].map(|i| light[i] + view[i]), table, words).direction
}

/// Phong's formula with the direction of each light and what is halfway between it and the eye, as `towards(light)` gives them.
pub fn phong_from(
    normal: [i32; 3],
    phong: &Phong,
    towards: impl Fn(usize) -> [[i32; 3]; 2],
    words: &Words,
) -> ReflectedLight {
    phong_wires(normal, phong, towards, words, &mut ())
}

/// [`phong_from`], and what its wires carry.
pub fn phong_wires(
    normal: [i32; 3],
    phong: &Phong,
    towards: impl Fn(usize) -> [[i32; 3]; 2],
    words: &Words,
    probe: &mut impl Probe,
) -> ReflectedLight {
    let one_bits = words.normal_bits - 1;
    let mut light = ReflectedLight { diffuse: [phong.ambient; 3], specular: [0; 3] };
    for (number, source) in phong.lights.iter().enumerate() {
        let [direction, halfway] = towards(number);
        let towards = probe.within("towards", number, |probe| cosine(normal, direction, phong.two_sided, words, probe));
        let lit = phong.two_sided || towards > 0;
        let power = probe.within("half", number, |probe| {
            let half = cosine(normal, halfway, phong.two_sided, words, probe);
            let index = words.rounding.shift_right(half, one_bits - phong.power_bits);
            let power = if lit { i64::from(phong.power[index as usize]) } else { 0 };
            probe.wire("index", 0, index.into());
            probe.wire("power", 0, power.into());
            power
        });
        let diffuse_products = source.diffuse.map(|intensity| i64::from(intensity) * towards);
        let specular_products = source.specular.map(|intensity| i64::from(intensity) * power);
        let diffuse = diffuse_products.map(|product| words.rounding.shift_right(product, one_bits) as u32);
        let specular = specular_products.map(|product| words.rounding.shift_right(product, words.colour_bits) as u32);
        for i in 0..3 {
            light.diffuse[i] += diffuse[i];
            light.specular[i] += specular[i];
        }
        probe.within("light", 3 * number, |probe| {
            show(probe, "diffuse_product", diffuse_products);
            show(probe, "diffuse", diffuse);
            show(probe, "specular_product", specular_products);
            show(probe, "specular", specular);
        });
    }
    show(probe, "diffuse", light.diffuse);
    show(probe, "specular", light.specular);
    light
}

/// The cosine between a normal and a direction, a fraction of `normal_bits − 1`, at most 1; from behind, none or the same.
fn cosine(normal: [i32; 3], direction: [i32; 3], two_sided: bool, words: &Words, probe: &mut impl Probe) -> i64 {
    let one_bits = words.normal_bits - 1;
    let dot: i64 = (0..3).map(|i| i64::from(normal[i]) * i64::from(direction[i])).sum();
    // The back is lit as the front, to the bit: the magnitude is taken before it is rounded.
    let positive = if two_sided { dot.abs() } else { dot.max(0) };
    let rounded = words.rounding.shift_right(positive, one_bits);
    let cosine = rounded.min(1 << one_bits);
    probe.wire("dot", 0, dot.into());
    probe.wire("positive", 0, positive.into());
    probe.wire("rounded", 0, rounded.into());
    probe.wire("cosine", 0, cosine.into());
    cosine
}

/// Light on a sample by table.
pub fn reflectance(gradient: [i32; 3], table: &ReflectanceTable) -> ReflectedLight {
    reflectance_wires(gradient, table, &mut ())
}

/// [`reflectance`], and what its wires carry.
pub fn reflectance_wires(gradient: [i32; 3], table: &ReflectanceTable, probe: &mut impl Probe) -> ReflectedLight {
    match direction_index_wires(gradient, table.bits, probe) {
        Some(index) => ReflectedLight { diffuse: table.diffuse[index], specular: table.specular[index] },
        None => ReflectedLight { diffuse: [table.flat; 3], specular: [0; 3] },
    }
}

/// The colour of a lit sample, saturated at 1.
pub fn lit(colour: [u32; 3], light: ReflectedLight, words: &Words) -> Counted<[u32; 3]> {
    counted(lit_wires(colour, light, words, &mut ()))
}

/// [`lit`], whether each word was saturated, and what its wires carry.
pub fn lit_wires(colour: [u32; 3], light: ReflectedLight, words: &Words, probe: &mut impl Probe) -> [(u32, bool); 3] {
    let full = i64::from(unit_full(words.colour_bits));
    [0, 1, 2].map(|i| {
        let product = i64::from(colour[i]) * i64::from(light.diffuse[i]);
        let scaled = words.rounding.shift_right(product, words.colour_bits);
        let sum = scaled + i64::from(light.specular[i]);
        let value = sum.min(full);
        probe.wire("product", i, product.into());
        probe.wire("scaled", i, scaled.into());
        probe.wire("sum", i, sum.into());
        probe.wire("value", i, value.into());
        (value as u32, sum > full)
    })
}

/// A colour behind the depth cue's factor.
pub fn cued(colour: [u32; 3], factor: u32, words: &Words) -> [u32; 3] {
    cued_wires(colour, factor, words, &mut ())
}

/// [`cued`], and what its wires carry.
pub fn cued_wires(colour: [u32; 3], factor: u32, words: &Words, probe: &mut impl Probe) -> [u32; 3] {
    let products = colour.map(|c| i64::from(c) * i64::from(factor));
    let values = products.map(|product| words.rounding.shift_right(product, LinearFactor::WORD_BITS) as u32);
    show(probe, "product", products);
    show(probe, "value", values);
    values
}
