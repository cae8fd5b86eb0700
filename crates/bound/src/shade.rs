//! Opacity, colour and light of a sample.

use crate::grains::Grains;
use crate::interval::Interval;
use cube3_scene::{Material, ResolvedLight, Transfer};
use glam::DVec3;

/// A function linear between knots has its extremes at ends and knots; a step at a knot has both sides in it.
fn candidates(range: Interval, knots: impl Iterator<Item = f64>) -> Vec<f64> {
    let inside = knots.filter(|&knot| range.holds(knot, 0.0));
    let sides = inside.flat_map(|knot| [knot.next_down(), knot, knot.next_up()]);
    [range.low, range.high].into_iter().chain(sides).collect()
}

fn hull(values: impl IntoIterator<Item = f64>) -> Interval {
    let none = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
    values.into_iter().map(Interval::point).fold(none, Interval::or)
}

/// The opacities of a unit length that the scene gives samples of these values and gradient magnitudes: bilinear between knots of both.
pub fn opacities(transfer: &Transfer, values: Interval, magnitudes: Interval) -> Interval {
    let points = transfer.layers.iter().flat_map(|layer| &layer.opacity).chain(&transfer.opacity);
    let values = candidates(values, points.map(|point| point[0]));
    let magnitudes = candidates(magnitudes, transfer.layers.iter().map(|layer| layer.gradient));
    hull(
        magnitudes.iter().flat_map(|&magnitude| values.iter().map(move |&value| transfer.opacity_at(value, magnitude))),
    )
}

/// The colours that the scene gives samples of these values.
pub fn colours(transfer: &Transfer, values: Interval) -> [Interval; 3] {
    let values = candidates(values, transfer.colour.iter().map(|point| point.value));
    [0, 1, 2].map(|i| hull(values.iter().map(|&value| transfer.colour_at(value)[i])))
}

/// Lengths of the vectors in a box.
pub fn lengths(components: [Interval; 3]) -> Interval {
    let squares = components.map(|component| component.magnitude().rising(|size| size * size));
    (squares[0] + squares[1] + squares[2]).rising(f64::sqrt)
}

/// The normals that a gradient may give: all unit vectors no farther than `off` from one; and whether there may be none.
#[derive(Clone, Copy, Debug)]
pub struct Normals {
    /// The one in the middle; none where the gradient vanishes.
    pub middle: Option<DVec3>,
    /// How far they are from it.
    pub off: f64,
    /// Whether the gradient may vanish.
    pub may_vanish: bool,
}

impl Normals {
    /// Those against the gradients in a box. Two vectors g and g + e, |e| below |g|, have unit vectors no farther from each other than
    /// 2|e| / (|g| + |g + e|); longer errors give any direction.
    pub fn against(gradient: [Interval; 3], grains: &Grains) -> Normals {
        let middle = DVec3::from(gradient.map(Interval::middle));
        let error = DVec3::from(gradient.map(Interval::radius)).length();
        let length = middle.length();
        let may_vanish = gradient.iter().all(|component| component.holds(0.0, 0.0));
        let off = if error < length { 2.0 * error / (2.0 * length - error) } else { 2.0 };
        let middle = (length > 0.0).then(|| -middle / length);
        Normals { middle, off: (off + grains.direction).min(2.0), may_vanish }
    }

    /// The cosines with a direction of a length near 1 that is itself no farther off than `off`.
    fn cosines(&self, direction: DVec3, off: f64, grains: &Grains) -> Interval {
        let most = (direction.length() + off) * (1.0 + grains.direction);
        let cosine = self.middle.map_or(0.0, |normal| normal.dot(direction));
        Interval::around(cosine, self.off * most + off).held(-most, most).wider(grains.cosine)
    }
}

/// A light as a ray sees it.
#[derive(Clone, Copy, Debug)]
pub struct SeenLight {
    /// Its directions in the frame of the gradients, and its colour.
    pub light: ResolvedLight,
    /// How far the words of its two directions are from them.
    pub off: [f64; 2],
}

/// The lit colours of samples: Phong's formula, held at 1.
pub fn lit(
    material: &Material,
    lights: &[SeenLight],
    normals: &Normals,
    colour: [Interval; 3],
    grains: &Grains,
) -> [Interval; 3] {
    let ambient = Interval::around(material.ambient, grains.intensity);
    let of = |diffuse: [Interval; 3], specular: [Interval; 3]| {
        [0, 1, 2].map(|i| ((colour[i] * diffuse[i]).wider(grains.light) + specular[i]).held(0.0, 1.0))
    };
    let flat = of([ambient; 3], [Interval::point(0.0); 3]);
    if normals.middle.is_none() && normals.off == 0.0 {
        return flat;
    }
    let (mut diffuse, mut specular) = ([ambient; 3], [Interval::point(0.0); 3]);
    for seen in lights {
        let [facing, mirroring] = reflected(material, seen, normals, grains);
        let light = &seen.light;
        for i in 0..3 {
            let intensity = Interval::around(material.diffuse * light.colour[i], grains.intensity).held(0.0, 15.0);
            let added = Interval::around(material.specular * light.colour[i], grains.light).held(0.0, 15.0);
            diffuse[i] = diffuse[i] + (facing * intensity).wider(2.0 * grains.intensity);
            specular[i] = specular[i] + (mirroring * added).wider(grains.light);
        }
    }
    let lit = of(diffuse, specular);
    if normals.may_vanish { [0, 1, 2].map(|i| lit[i].or(flat[i])) } else { lit }
}

/// The cosine that light is scattered by, and the power that it is mirrored by.
fn reflected(material: &Material, seen: &SeenLight, normals: &Normals, grains: &Grains) -> [Interval; 2] {
    let dark = Interval::point(0.0);
    let facing = normals.cosines(seen.light.direction, seen.off[0], grains);
    let mirroring = normals.cosines(seen.light.halfway, seen.off[1], grains);
    if !material.two_sided && facing.high <= 0.0 {
        return [dark; 2];
    }
    // Words of cosines are at most 1; in a frame that is not at right angles reals are not.
    let positive = |cosine: Interval| {
        let positive = if material.two_sided { cosine.magnitude() } else { cosine.rising(|cosine| cosine.max(0.0)) };
        positive.or(positive.held(0.0, grains.largest_cosine))
    };
    let [index, power] = grains.power;
    let mirrored = positive(mirroring).wider(index).rising(|cosine| cosine.max(0.0));
    let highlight = mirrored.rising(|cosine| cosine.powf(material.shininess)).wider(power);
    let highlight = highlight.rising(|light| light.max(0.0));
    let seen = material.two_sided || facing.low > 0.0;
    [positive(facing), if seen { highlight } else { highlight.or(dark) }]
}
