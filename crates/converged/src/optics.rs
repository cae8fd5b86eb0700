//! What a scene's samples look like: opacity, colour, light, as numbers, as discs and as ranges.

use crate::disc::{Disc, is_whole};
use crate::part::{Part, PartGradient};
use crate::polynomial::{self, Cubic};
use crate::stretches::{Layers, Stretch, Stretches};
use cube3_scene::{Mode, ResolvedLight, Scene, phong};
use glam::DVec3;

/// Which way a light's product with the normal points along a whole part.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sign {
    Up,
    Down,
}

/// The scene's part in a pixel.
pub(crate) struct Optics<'a> {
    pub scene: &'a Scene,
    pub stretches: Stretches,
    /// Whether colours depend on gradients.
    pub lit: bool,
    /// Whether opacity does.
    pub two_dimensional: bool,
    /// The part of a colour that needs no normal.
    ambient: f64,
    /// Lit colours cannot exceed 1.
    never_clamped: bool,
}

/// What a part is like, where it is analytic.
pub(crate) struct Smooth {
    /// Opacity of a unit length.
    pub opacity: Disc,
    /// One minus it.
    pub clearness: Disc,
    pub colour: [Disc; 3],
}

impl Smooth {
    /// Extinction of a unit length, −ln(1 − opacity); none where the disc reaches full opacity.
    pub fn extinction(&self) -> Option<Disc> {
        let by_clearness = self.clearness.minus_ln()?;
        // Faint opacity has its digits in itself.
        let mid = if self.opacity.mid < 0.5 { -libm::log1p(-self.opacity.mid) } else { by_clearness.mid };
        Some(Disc::new(mid, by_clearness.radius))
    }
}

/// What keeps a part from being analytic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Obstacle {
    /// Something bends at this ζ, which lies inside.
    At(f64),
    /// Something is too near.
    Near,
}

/// What rounding can move the colour and the opacity of a part by.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Moved {
    pub colour: f64,
    pub opacity: f64,
}

impl<'a> Optics<'a> {
    pub fn new(scene: &'a Scene) -> Optics<'a> {
        let material = &scene.material;
        let shines = scene.lights.iter().any(|light| light.colour.iter().any(|c| *c > 0.0));
        let shaded = material.shaded && scene.mode == Mode::Composite;
        let sum = |i: usize| {
            scene.lights.iter().map(|light| light.colour[i]).sum::<f64>() * (material.diffuse + material.specular)
        };
        Optics {
            scene,
            stretches: Stretches::new(scene),
            lit: shaded && shines && (material.diffuse > 0.0 || material.specular > 0.0),
            two_dimensional: scene.transfer.is_two_dimensional(),
            ambient: if shaded { material.ambient } else { 1.0 },
            never_clamped: (0..3).all(|i| material.ambient + sum(i) <= 1.0 + 1e-12),
        }
    }

    pub fn wants_gradient(&self) -> bool {
        self.lit || self.two_dimensional
    }

    /// The opacity of a unit length at ζ.
    pub fn opacity(&self, part: &Part, stretch: &Stretch, layers: Layers, x: f64) -> f64 {
        self.between_layers(part, layers, x, |layer, value| stretch.opacity_at(layer, value))
    }

    /// The extinction of a unit length at ζ, −ln(1 − opacity), by whichever of the two has more digits.
    pub fn extinction(&self, part: &Part, stretch: &Stretch, layers: Layers, x: f64) -> f64 {
        let opacity = self.opacity(part, stretch, layers, x);
        if opacity < 0.5 {
            return -libm::log1p(-opacity);
        }
        -libm::log(self.between_layers(part, layers, x, |layer, value| stretch.clearness_at(layer, value)))
    }

    fn between_layers(&self, part: &Part, layers: Layers, x: f64, of: impl Fn(usize, f64) -> f64) -> f64 {
        let value = polynomial::at(&part.value, x);
        let at = match layers {
            Layers::One(layer) => of(layer, value),
            Layers::Between(layer) => {
                let g = &self.stretches.gradients;
                let magnitude = part.gradient.as_ref().map_or(0.0, |g| g.at(x).length() * g.scale);
                let weight = (magnitude - g[layer]) / (g[layer + 1] - g[layer]);
                let (below, above) = (of(layer, value), of(layer + 1, value));
                below + weight * (above - below)
            }
        };
        at.clamp(0.0, 1.0)
    }

    /// The lit colour at ζ.
    pub fn colour(&self, part: &Part, stretch: &Stretch, lights: &[ResolvedLight], x: f64) -> [f64; 3] {
        let rgb = stretch.colour_at(polynomial::at(&part.value, x));
        let cue = part.cue[0] + part.cue[1] * x;
        let lit = match part.gradient.as_ref().filter(|_| self.lit) {
            None => rgb.map(|c| self.ambient * c),
            Some(gradient) => {
                let g = gradient.at(x);
                let length = g.length();
                let normal = (length > 0.0).then(|| -g / length);
                phong(&self.scene.material, lights, normal, rgb)
            }
        };
        lit.map(|c| c * cue)
    }

    /// The magnitudes of a part's gradient, in values for the smallest spacing.
    pub fn magnitudes(&self, part: &Part) -> [f64; 2] {
        part.gradient.as_ref().map_or([0.0; 2], |g| g.magnitudes().map(|m| m * g.scale))
    }

    /// The layers of a part.
    pub fn layers(&self, part: &Part) -> Option<Layers> {
        let slack = part.gradient.as_ref().map_or(0.0, |g| 4.0 * g.moved() * g.scale);
        self.stretches.layers(self.magnitudes(part), slack)
    }

    /// Opacity and colour as discs around those in the middle, for |ζ| up to `reach`; channels that are clamped to 1 are `full`.
    pub fn smooth(
        &self,
        part: &Part,
        stretch: &Stretch,
        layers: Layers,
        lights: &[ResolvedLight],
        reach: f64,
        full: [bool; 3],
    ) -> Result<Smooth, Obstacle> {
        let value = Disc::of_polynomial(&part.value, reach);
        let off = value.affine(-stretch.origin, 1.0);
        let of = |line: [f64; 2]| off.affine(line[0], line[1]);
        let clear = |line: [f64; 2]| off.affine(1.0 - line[0], -line[1]);
        let [opacity, clearness] = match layers {
            Layers::One(layer) => [of(stretch.opacity[layer]), clear(stretch.opacity[layer])],
            Layers::Between(layer) => {
                let g = &self.stretches.gradients;
                let apart = g[layer + 1] - g[layer];
                let gradient = part.gradient.as_ref().ok_or(Obstacle::Near)?;
                let magnitude =
                    Disc::of_polynomial(&gradient.square, reach).sqrt().ok_or(Obstacle::Near)?.scaled(gradient.scale);
                let weight = magnitude.affine(-g[layer] / apart, 1.0 / apart);
                let lines = [stretch.opacity[layer], stretch.opacity[layer + 1]];
                let between = |[below, above]: [Disc; 2]| below.plus(weight.times(above.plus(below.scaled(-1.0))));
                [between(lines.map(of)), between(lines.map(clear))]
            }
        };
        let rgb = stretch.colour.map(of);
        let cue = Disc::new(part.cue[0], part.cue[1].abs() * reach);
        let lit = match part.gradient.as_ref().filter(|gradient| self.lit && !gradient.is_flat()) {
            None => rgb.map(|c| c.scaled(self.ambient)),
            Some(gradient) => self.lit_disc(gradient, lights, rgb, reach)?,
        };
        let unclamped = |i: usize| if full[i] { Disc::new(1.0, 0.0) } else { lit[i] };
        let colour = [0, 1, 2].map(unclamped).map(|c| if part.cue == [1.0, 0.0] { c } else { c.times(cue) });
        Ok(Smooth { opacity, clearness, colour })
    }

    /// Phong's model on discs ([`phong`]), where no light changes sides and nothing is clamped.
    fn lit_disc(
        &self,
        gradient: &PartGradient,
        lights: &[ResolvedLight],
        rgb: [Disc; 3],
        reach: f64,
    ) -> Result<[Disc; 3], Obstacle> {
        let material = &self.scene.material;
        let inverse = Disc::of_polynomial(&gradient.square, reach).inverse_sqrt().ok_or(Obstacle::Near)?;
        let even = is_whole(material.shininess) && material.shininess % 2.0 == 0.0;
        let mut lit = rgb.map(|c| c.scaled(material.ambient));
        for light in lights {
            let facing = gradient.against(light.direction);
            // Where a one-sided surface turns away from a light, its highlight ends with a jump.
            let jumps = !material.two_sided && material.specular > 0.0;
            let side = sign(&facing, gradient.slack_against(light.direction), jumps)?;
            if side == Sign::Down && !material.two_sided {
                continue;
            }
            let turned = |p: &Cubic, side: Sign| {
                let disc = Disc::of_polynomial(p, reach).times(inverse);
                if side == Sign::Down { disc.scaled(-1.0) } else { disc }
            };
            let diffuse = turned(&facing, side).scaled(material.diffuse);
            let mut specular = Disc::new(0.0, 0.0);
            if material.specular > 0.0 && light.halfway != DVec3::ZERO {
                let mirroring = gradient.against(light.halfway);
                // An even power has no sides.
                let side = if material.two_sided && even {
                    Sign::Up
                } else {
                    sign(&mirroring, gradient.slack_against(light.halfway), false)?
                };
                if side == Sign::Up || material.two_sided {
                    let highlight = turned(&mirroring, side).power(material.shininess).ok_or(Obstacle::Near)?;
                    specular = highlight.scaled(material.specular);
                }
            }
            for i in 0..3 {
                lit[i] = lit[i].plus(diffuse.times(rgb[i]).plus(specular).scaled(light.colour[i]));
            }
        }
        Ok(lit)
    }

    /// Which channels of the lit colour are clamped to 1 along a whole part; an obstacle where one is in places.
    pub fn clamped(&self, part: &Part, lights: &[ResolvedLight]) -> Result<[bool; 3], Obstacle> {
        let flat = part.gradient.as_ref().is_none_or(PartGradient::is_flat);
        if !self.lit || self.never_clamped || flat {
            return Ok([false; 3]);
        }
        let raw = self.colours(part, lights, true);
        if raw.iter().any(|[low, high]| *low < 1.0 && *high > 1.0) {
            return Err(Obstacle::Near);
        }
        Ok(raw.map(|[low, _]| low >= 1.0))
    }

    /// The least and the largest colour along a part, whatever bends in it; before the clamp to 1 and the cue where `raw`.
    pub fn colours(&self, part: &Part, lights: &[ResolvedLight], raw: bool) -> [[f64; 2]; 3] {
        let [low, high] = polynomial::range(&part.value);
        self.lit_range(part, lights, self.stretches.colours([low - part.slack, high + part.slack]), raw)
    }

    /// The same, of colours before light.
    pub fn lit_range(&self, part: &Part, lights: &[ResolvedLight], rgb: [[f64; 2]; 3], raw: bool) -> [[f64; 2]; 3] {
        let material = &self.scene.material;
        let mut lit = rgb.map(|[low, high]| [self.ambient * low, self.ambient * high]);
        if let Some(gradient) = part.gradient.as_ref().filter(|gradient| self.lit && !gradient.is_flat()) {
            let magnitudes = gradient.magnitudes();
            for light in lights {
                let of = |direction| {
                    let [low, high] = polynomial::range(&gradient.against(direction));
                    let slack = gradient.slack_against(direction);
                    cosines([low - slack, high + slack], magnitudes, material.two_sided)
                };
                let facing = of(light.direction);
                let highlight = of(light.halfway).map(|c| if c > 0.0 { libm::pow(c, material.shininess) } else { 0.0 });
                // From behind a one-sided surface nothing is mirrored.
                let least = if material.two_sided || facing[0] > 0.0 { highlight[0] } else { 0.0 };
                let most = if material.two_sided || facing[1] > 0.0 { highlight[1] } else { 0.0 };
                for i in 0..3 {
                    let of = |facing: f64, highlight: f64, rgb: f64| {
                        light.colour[i] * (material.diffuse * facing * rgb + material.specular * highlight)
                    };
                    lit[i][0] += of(facing[0], least, rgb[i][0]);
                    lit[i][1] += of(facing[1], most, rgb[i][1]);
                }
            }
            // Where it vanishes there is no normal, and ambient light alone.
            if magnitudes[0] == 0.0 {
                for i in 0..3 {
                    lit[i][0] = self.ambient * rgb[i][0];
                }
            }
        }
        if raw {
            return lit;
        }
        let cue = [part.cue[0] - part.cue[1].abs(), part.cue[0] + part.cue[1].abs()];
        lit.map(|[low, high]| [low.min(1.0) * cue[0].max(0.0), high.min(1.0) * cue[1].min(1.0)])
    }

    /// What rounding moves a part's colour and opacity by.
    pub fn moved(&self, part: &Part, stretch: &Stretch, layers: Layers, lights: &[ResolvedLight]) -> Moved {
        let material = &self.scene.material;
        let value = 3.0 * part.slack;
        let mut opacity = stretch.moved_opacity(value);
        let rgb = stretch.steepest_colour() * value + 8.0 * f64::EPSILON;
        let mut colour = rgb;
        let Some(gradient) = part.gradient.as_ref().filter(|gradient| !gradient.is_flat()) else {
            return Moved { colour, opacity };
        };
        let [least, most] = gradient.magnitudes();
        if let Layers::Between(_) = layers {
            let g = &self.stretches.gradients;
            let steepest = g.windows(2).map(|pair| 1.0 / (pair[1] - pair[0])).fold(0.0, f64::max);
            let moved = 8.0 * (gradient.moved() + f64::EPSILON * most) * gradient.scale;
            opacity += moved * steepest + 8.0 * f64::EPSILON;
        }
        if self.lit {
            let normal = (8.0 * gradient.moved() / least + 8.0 * f64::EPSILON).min(2.0);
            for light in lights {
                let strongest = light.colour.iter().copied().fold(0.0, f64::max);
                let highlight = if material.shininess >= 1.0 {
                    material.shininess * normal
                } else {
                    // Steeper without end as the cosine goes to 0, but |x^s − y^s| ≤ |x − y|^s.
                    let mirroring = polynomial::range(&gradient.against(light.halfway));
                    let least = cosines(mirroring, gradient.magnitudes(), material.two_sided)[0] - normal;
                    let slope = material.shininess * libm::pow(least.max(0.0), material.shininess - 1.0);
                    libm::pow(normal, material.shininess).min(slope * normal)
                };
                colour += strongest * (material.diffuse * (normal + rgb) + material.specular * highlight);
            }
        }
        Moved { colour, opacity }
    }
}

/// Which way a product points; where it changes sides, and by more than rounding. Where something jumps there rounding must not leave it open;
/// no product at all is down.
fn sign(p: &Cubic, slack: f64, jumps: bool) -> Result<Sign, Obstacle> {
    let [low, high] = polynomial::range(p);
    let room = if jumps { -4.0 * slack } else { 4.0 * slack };
    if high <= room {
        return Ok(Sign::Down);
    }
    if low >= -room {
        return Ok(Sign::Up);
    }
    if let Some(x) = polynomial::crossing(|x| polynomial::at(p, x), 0.0) {
        return Err(Obstacle::At(x));
    }
    let turn = polynomial::turns(p).into_iter().flatten().find(|x| x.abs() < 1.0);
    Err(turn.map_or(Obstacle::Near, Obstacle::At))
}

/// The cosines between a normal and a direction from the range of their product and that of the gradient's magnitude.
fn cosines([low, high]: [f64; 2], magnitudes: [f64; 2], two_sided: bool) -> [f64; 2] {
    let over = |x: f64, magnitude: f64| if x == 0.0 { 0.0 } else { (x / magnitude).clamp(-1.0, 1.0) };
    let most = over(high, magnitudes[if high > 0.0 { 0 } else { 1 }]);
    let least = over(low, magnitudes[if low > 0.0 { 1 } else { 0 }]);
    match two_sided {
        false => [least.max(0.0), most.max(0.0)],
        true if least >= 0.0 => [least, most],
        true if most <= 0.0 => [-most, -least],
        true => [0.0, most.max(-least)],
    }
}
