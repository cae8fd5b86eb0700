//! A second `image-order` ray caster, written from the book alone (`raycast.md`, `scene-files.md`, and `cone.md` for the modes) and from
//! none of the project's code: an outside oracle. It takes its own way wherever there is a choice: eight weights for a sample,
//! all samples of a ray kept and then composited from the back, a line clipped by one half-space after the other.
//!
//! A *place* is in voxels, a *point* is in the world; a point is a place times the spacing. The *unit* is the smallest
//! spacing.

/// A volume of values.
#[derive(Clone, Debug)]
pub struct Voxels {
    /// Number of voxels along x, y and z.
    pub dims: [usize; 3],
    /// Distance between voxels in the world.
    pub spacing: [f64; 3],
    /// The values, x fastest.
    pub values: Vec<f64>,
    /// What gradients see beyond the volume: the value of voxel word 0.
    pub border: f64,
}

/// From where one looks: `[view]` and `[view.perspective]` of a scene.
#[derive(Clone, Debug)]
pub enum View {
    /// Parallel rays; without a size of the pixels the volume's bounding sphere fits.
    Parallel { yaw_deg: f64, tilt_deg: f64, roll_deg: f64, pixel_size_voxel: Option<f64> },
    /// Rays from an eye; without a place of the eye the volume's bounding sphere fits.
    Eye { yaw_deg: f64, tilt_deg: f64, roll_deg: f64, field_of_view_deg: f64, eye_voxel: Option<[f64; 3]> },
}

/// How the samples of a ray become a pixel: `mode` of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    Composite,
    FirstOpaque,
    LastOpaque,
    Maximum,
    Minimum,
    WeightedSum,
}

/// What to show, and the step of the rays.
#[derive(Clone, Debug)]
pub struct Setting {
    pub view: View,
    /// Pixels in a row.
    pub width: usize,
    /// Rows of pixels.
    pub height: usize,
    /// What is seen where the volume is clear.
    pub background: [f64; 3],
    /// Points (value, opacity of a unit length), ascending: linear between, constant beyond.
    pub opacity: Vec<[f64; 2]>,
    /// Points (value, colour), likewise.
    pub colour: Vec<(f64, [f64; 3])>,
    /// Whether opacity is corrected to the step's length.
    pub opacity_correction: bool,
    /// Whether samples are lit at all.
    pub shaded: bool,
    pub ambient: f64,
    pub diffuse: f64,
    pub specular: f64,
    pub shininess: f64,
    /// Whether the back of a surface is lit as its front.
    pub two_sided: bool,
    /// Direction towards the light in the world, or none for a light at the eye, and its colour.
    pub lights: Vec<(Option<[f64; 3]>, [f64; 3])>,
    /// Factors on colour at the volume's nearest and farthest corner.
    pub depth_cue: Option<[f64; 2]>,
    /// Planes, each a normal in voxel coordinates that points at what is removed, and a place on the plane.
    pub cuts: Vec<([f64; 3], [f64; 3])>,
    /// The lowest and the highest place of what is shown.
    pub crop: Option<[[f64; 3]; 2]>,
    /// The lowest and the highest value that is not transparent.
    pub threshold: [f64; 2],
    pub mode: Mode,
    /// The opacity of a unit length from which a sample is opaque.
    pub opaque_alpha: f64,
    /// The step in the smallest spacing.
    pub step_voxel: f64,
}

/// The picture, row by row from the top left, over the background.
pub fn cast(voxels: &Voxels, setting: &Setting) -> Vec<[f64; 3]> {
    let caster = Caster::new(voxels, setting);
    let pixels = (0..setting.height).flat_map(|row| (0..setting.width).map(move |column| (column, row)));
    pixels.map(|(column, row)| caster.pixel(&caster.camera.ray(column, row))).collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn each(function: impl Fn(usize) -> f64) -> [f64; 3] {
    [function(0), function(1), function(2)]
}

/// A number between two; between equal ones it is just them.
fn mix(from: f64, to: f64, fraction: f64) -> f64 {
    from + (to - from) * fraction
}

/// A vector of length 1, or none of the vector 0; neither huge nor tiny vectors lose their direction.
fn normalised(vector: [f64; 3]) -> Option<[f64; 3]> {
    let largest = vector.iter().fold(0.0_f64, |largest, component| largest.max(component.abs()));
    if largest == 0.0 {
        return None;
    }
    let scaled = vector.map(|component| component / largest);
    let length = dot(scaled, scaled).sqrt();
    Some(scaled.map(|component| component / length))
}

/// Sine and cosine of an angle in degrees, exact at multiples of 90° and equal in size at 45° ("`[view]`").
fn sine_and_cosine(degrees: f64) -> (f64, f64) {
    let quarters = (degrees / 90.0).round();
    let rest = degrees - 90.0 * quarters;
    let (sine, cosine) = match rest.abs() == 45.0 {
        true => (std::f64::consts::FRAC_1_SQRT_2.copysign(rest), std::f64::consts::FRAC_1_SQRT_2),
        false => rest.to_radians().sin_cos(),
    };
    match quarters.rem_euclid(4.0) as u8 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

/// The line `point + distance·direction` in the world, seen from the distance `start` on.
struct Ray {
    point: [f64; 3],
    direction: [f64; 3],
    start: f64,
}

/// Where the rays come from: "From a pixel to its ray".
struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    forward: [f64; 3],
    /// The middle of the first and the last voxel's centre, in the world.
    centre: [f64; 3],
    /// Width and height of the picture less one, halved.
    middle: [f64; 2],
    rays: Rays,
}

enum Rays {
    /// Distance between pixels in the world.
    Parallel { pixel: f64 },
    /// Tangent of a pixel's width, and the eye's way from the centre to the right, up and against the view's direction.
    Eye { tangent: f64, right: f64, up: f64, back: f64 },
}

impl Camera {
    fn new(voxels: &Voxels, setting: &Setting, unit: f64) -> Camera {
        let (View::Parallel { yaw_deg, tilt_deg, roll_deg, .. } | View::Eye { yaw_deg, tilt_deg, roll_deg, .. }) =
            setting.view;
        let ((sine_yaw, cosine_yaw), (sine_tilt, cosine_tilt)) = (sine_and_cosine(yaw_deg), sine_and_cosine(tilt_deg));
        let (sine_roll, cosine_roll) = sine_and_cosine(roll_deg);
        let level = [cosine_yaw, sine_yaw, 0.0];
        let upright = [-sine_yaw * sine_tilt, cosine_yaw * sine_tilt, cosine_tilt];
        let mut camera = Camera {
            right: each(|k| level[k] * cosine_roll + upright[k] * sine_roll),
            up: each(|k| upright[k] * cosine_roll - level[k] * sine_roll),
            forward: [-sine_yaw * cosine_tilt, cosine_yaw * cosine_tilt, -sine_tilt],
            centre: each(|k| voxels.spacing[k] * (voxels.dims[k] as f64 - 1.0) / 2.0),
            middle: [(setting.width as f64 - 1.0) / 2.0, (setting.height as f64 - 1.0) / 2.0],
            rays: Rays::Parallel { pixel: unit },
        };
        camera.rays = camera.rays_of(voxels, setting, unit);
        camera
    }

    fn rays_of(&self, voxels: &Voxels, setting: &Setting, unit: f64) -> Rays {
        let sides = each(|k| voxels.dims[k].max(2) as f64 * voxels.spacing[k]);
        let diameter = dot(sides, sides).sqrt();
        let (width, height) = (setting.width as f64, setting.height as f64);
        match setting.view {
            View::Parallel { pixel_size_voxel, .. } => {
                Rays::Parallel { pixel: pixel_size_voxel.map_or(diameter / width.min(height), |size| size * unit) }
            }
            View::Eye { field_of_view_deg, eye_voxel, .. } => {
                let half = (field_of_view_deg / 2.0).to_radians().tan();
                let tangent = 2.0 * half / height;
                let Some(place) = eye_voxel else {
                    let back = diameter / 2.0 / (half * (width / height).min(1.0)).atan().sin();
                    return Rays::Eye { tangent, right: 0.0, up: 0.0, back };
                };
                let way = each(|k| place[k] * voxels.spacing[k] - self.centre[k]);
                Rays::Eye { tangent, right: dot(way, self.right), up: dot(way, self.up), back: -dot(way, self.forward) }
            }
        }
    }

    /// The ray of a pixel, followed from the plane through the volume's centre ("Perspective").
    fn ray(&self, column: usize, row: usize) -> Ray {
        let (across, along) = (column as f64 - self.middle[0], self.middle[1] - row as f64);
        let at = |right: f64, up: f64| each(|k| self.centre[k] + right * self.right[k] + up * self.up[k]);
        match self.rays {
            Rays::Parallel { pixel } => {
                let point = at(pixel * across, pixel * along);
                Ray { point, direction: self.forward, start: f64::NEG_INFINITY }
            }
            Rays::Eye { tangent, right, up, back } => {
                let slopes = [tangent * across, tangent * along];
                let length = (1.0 + slopes[0] * slopes[0] + slopes[1] * slopes[1]).sqrt();
                let towards = each(|k| self.forward[k] + slopes[0] * self.right[k] + slopes[1] * self.up[k]);
                Ray {
                    point: at(right + back * slopes[0], up + back * slopes[1]),
                    direction: towards.map(|component| component / length),
                    start: -back * length,
                }
            }
        }
    }
}

/// The places x with normal·(x − through) ≤ 0.
struct HalfSpace {
    normal: [f64; 3],
    through: [f64; 3],
}

impl HalfSpace {
    /// One side of a box: the places whose coordinate on `axis` is at most (`sign` 1) or at least (`sign` −1) `bound`.
    fn side(axis: usize, sign: f64, bound: f64) -> HalfSpace {
        let on_axis = |number: f64| each(|k| if k == axis { number } else { 0.0 });
        HalfSpace { normal: on_axis(sign), through: on_axis(bound) }
    }

    /// The stretch of a line of places that is left of a stretch.
    fn clip(&self, place: [f64; 3], velocity: [f64; 3], stretch: [f64; 2]) -> Option<[f64; 2]> {
        let outside = dot(self.normal, each(|k| place[k] - self.through[k]));
        let rate = dot(self.normal, velocity);
        let clipped = match rate {
            0.0 if outside > 0.0 => return None,
            0.0 => stretch,
            _ if rate > 0.0 => [stretch[0], stretch[1].min(-outside / rate)],
            _ => [stretch[0].max(-outside / rate), stretch[1]],
        };
        (clipped[0] <= clipped[1]).then_some(clipped)
    }
}

/// The volume with two voxels on each axis that has one: "How long a ray is".
struct Grid<'a> {
    voxels: &'a Voxels,
    /// Number of voxels along each axis, at least two.
    count: [usize; 3],
    /// From a place to the grid's own coordinates: a half on each axis of one voxel.
    shift: [f64; 3],
}

impl Grid<'_> {
    fn new(voxels: &Voxels) -> Grid<'_> {
        let shift = each(|k| if voxels.dims[k] == 1 { 0.5 } else { 0.0 });
        Grid { voxels, count: voxels.dims.map(|count| count.max(2)), shift }
    }

    /// A voxel's value, or the border beyond the volume.
    fn voxel(&self, index: [isize; 3]) -> f64 {
        let inside = (0..3).all(|k| index[k] >= 0 && index[k] < self.count[k] as isize);
        if !inside {
            return self.voxels.border;
        }
        let [x, y, z] = [0, 1, 2].map(|k| (index[k] as usize).min(self.voxels.dims[k] - 1));
        self.voxels.values[x + self.voxels.dims[0] * (y + self.voxels.dims[1] * z)]
    }

    /// The eight voxels around a place and their weights.
    fn corners(&self, place: [f64; 3]) -> [([isize; 3], f64); 8] {
        let held = each(|k| (place[k] + self.shift[k]).clamp(0.0, (self.count[k] - 1) as f64));
        let first = [0, 1, 2].map(|k| (held[k] as usize).min(self.count[k] - 2));
        let fraction = each(|k| held[k] - first[k] as f64);
        std::array::from_fn(|corner| {
            let far = [0, 1, 2].map(|k| corner >> k & 1);
            let weights = each(|k| if far[k] == 1 { fraction[k] } else { 1.0 - fraction[k] });
            ([0, 1, 2].map(|k| (first[k] + far[k]) as isize), weights[0] * weights[1] * weights[2])
        })
    }

    /// The value at a place, the weighted sum of eight voxels. Differences to one of them are summed, so that equal
    /// voxels give just their value.
    fn value(&self, place: [f64; 3]) -> f64 {
        let corners = self.corners(place);
        let first = self.voxel(corners[0].0);
        first + corners.iter().map(|&(index, weight)| weight * (self.voxel(index) - first)).sum::<f64>()
    }

    /// Central differences in values per unit. The difference of two interpolated values a whole number of voxels apart
    /// is the interpolated difference of voxels, which is exactly 0 where the voxels are equal.
    fn gradient(&self, place: [f64; 3], unit: f64) -> [f64; 3] {
        let corners = self.corners(place);
        each(|axis| {
            let beside = |index: [isize; 3], way: isize| {
                let mut moved = index;
                moved[axis] += way;
                self.voxel(moved) / 2.0
            };
            let halves = corners.iter().map(|&(index, weight)| weight * (beside(index, 1) - beside(index, -1)));
            halves.sum::<f64>() / (self.voxels.spacing[axis] / unit)
        })
    }
}

/// Where a value lies among ascending points: two points and the fraction of the way between them. A value on a step
/// belongs to the last point of that value.
fn between(points: usize, value_of: impl Fn(usize) -> f64, value: f64) -> (usize, usize, f64) {
    let next = (0..points).find(|&point| value_of(point) > value).unwrap_or(points);
    match next {
        0 => (0, 0, 0.0),
        _ if next == points => (points - 1, points - 1, 0.0),
        _ => (next - 1, next, (value - value_of(next - 1)) / (value_of(next) - value_of(next - 1))),
    }
}

/// The samples of a ray of some length: distance from the entry, and the part of a step that the sample stands for.
fn trapezoid(length: f64, step: f64) -> Vec<(f64, f64)> {
    let whole = (length / step).floor();
    let mut distances: Vec<f64> = (0..=whole as usize).map(|number| number as f64 * step).collect();
    if length - whole * step >= 1e-9 * step {
        distances.push(length);
    }
    let last = distances.len() - 1;
    let part = |number: usize| (distances[(number + 1).min(last)] - distances[number.saturating_sub(1)]) / 2.0 / step;
    distances.iter().enumerate().map(|(number, &distance)| (distance, part(number))).collect()
}

/// A sample that is within the threshold.
struct Sample {
    value: f64,
    /// Opacity of a unit length.
    opacity: f64,
    /// The part of a step that it stands for.
    part: f64,
    point: [f64; 3],
    place: [f64; 3],
}

struct Caster<'a> {
    setting: &'a Setting,
    grid: Grid<'a>,
    camera: Camera,
    /// The smallest spacing.
    unit: f64,
    /// What is drawn is in all of them.
    drawn: Vec<HalfSpace>,
}

impl<'a> Caster<'a> {
    fn new(voxels: &'a Voxels, setting: &'a Setting) -> Caster<'a> {
        let unit = voxels.spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let grid = Grid::new(voxels);
        let drawn = drawn(&grid, setting);
        Caster { setting, grid, camera: Camera::new(voxels, setting, unit), unit, drawn }
    }

    fn pixel(&self, ray: &Ray) -> [f64; 3] {
        let samples = self.samples(ray);
        let opaque = |sample: &&Sample| sample.opacity >= self.setting.opaque_alpha;
        let surface = match self.setting.mode {
            Mode::Composite => return self.composite(ray, &samples),
            Mode::WeightedSum => return self.weighted_sum(ray, &samples),
            Mode::FirstOpaque => samples.iter().find(opaque),
            Mode::LastOpaque => samples.iter().rfind(opaque),
            Mode::Maximum => {
                return self.value_shown(
                    samples.iter().reduce(|best, next| if next.value > best.value { next } else { best }),
                );
            }
            Mode::Minimum => {
                return self.value_shown(
                    samples.iter().reduce(|best, next| if next.value < best.value { next } else { best }),
                );
            }
        };
        surface.map_or(self.setting.background, |sample| self.colour(ray, sample))
    }

    /// A sample's colour without light, weighted with its opacity, over the background.
    fn value_shown(&self, chosen: Option<&Sample>) -> [f64; 3] {
        let background = self.setting.background;
        chosen.map_or(background, |sample| {
            let colour = self.unlit(sample);
            each(|channel| mix(background[channel], colour[channel], sample.opacity))
        })
    }

    /// Colour of a sample that is not lit, after depth cue.
    fn unlit(&self, sample: &Sample) -> [f64; 3] {
        let cue = self.cue(sample.point);
        self.plain_colour(sample.value).map(|channel| channel * cue)
    }

    /// The samples from front to back: "How long a ray is".
    fn samples(&self, ray: &Ray) -> Vec<Sample> {
        let Some([entry, exit]) = self.stretch(ray) else { return Vec::new() };
        let steps = trapezoid((exit - entry) / self.unit, self.setting.step_voxel);
        let samples = steps.into_iter().map(|(distance, part)| {
            let point = each(|k| ray.point[k] + ray.direction[k] * (entry + distance * self.unit));
            let place = each(|k| point[k] / self.grid.voxels.spacing[k]);
            let value = self.grid.value(place);
            Sample { value, opacity: self.opacity(value), part, point, place }
        });
        let [low, high] = self.setting.threshold;
        samples.filter(|sample| low <= sample.value && sample.value <= high).collect()
    }

    /// From which distance to which a ray is in what is drawn.
    fn stretch(&self, ray: &Ray) -> Option<[f64; 2]> {
        let place = each(|k| ray.point[k] / self.grid.voxels.spacing[k]);
        let velocity = each(|k| ray.direction[k] / self.grid.voxels.spacing[k]);
        let whole = Some([ray.start, f64::INFINITY]);
        self.drawn.iter().fold(whole, |stretch, half_space| half_space.clip(place, velocity, stretch?))
    }

    /// Opacity of a unit length.
    fn opacity(&self, value: f64) -> f64 {
        let points = &self.setting.opacity;
        if points.is_empty() {
            return 0.0;
        }
        let (low, high, fraction) = between(points.len(), |point| points[point][0], value);
        mix(points[low][1], points[high][1], fraction)
    }

    /// Colour of a value before light, white without points.
    fn plain_colour(&self, value: f64) -> [f64; 3] {
        let points = &self.setting.colour;
        if points.is_empty() {
            return [1.0; 3];
        }
        let (low, high, fraction) = between(points.len(), |point| points[point].0, value);
        each(|channel| mix(points[low].1[channel], points[high].1[channel], fraction))
    }

    /// Colour of a sample after light and depth cue.
    fn colour(&self, ray: &Ray, sample: &Sample) -> [f64; 3] {
        let plain = self.plain_colour(sample.value);
        let lit = if self.setting.shaded { self.lit(ray, sample, plain) } else { plain };
        let cue = self.cue(sample.point);
        lit.map(|channel| channel * cue)
    }

    /// Phong's model: "`[material]`".
    fn lit(&self, ray: &Ray, sample: &Sample, plain: [f64; 3]) -> [f64; 3] {
        let Setting { ambient, diffuse, specular, shininess, .. } = *self.setting;
        let mut sum = plain.map(|channel| ambient * channel);
        if let Some(ascent) = normalised(self.grid.gradient(sample.place, self.unit)) {
            let normal = ascent.map(|component| -component);
            for &(direction, light) in &self.setting.lights {
                let [facing, mirrored] = self.products(ray, normal, direction);
                let highlight = specular * mirrored.powf(shininess);
                sum = each(|channel| sum[channel] + light[channel] * (diffuse * facing * plain[channel] + highlight));
            }
        }
        sum.map(|channel| channel.clamp(0.0, 1.0))
    }

    /// N·L and N·H of a light, by the rule for surfaces of two sides or of one.
    fn products(&self, ray: &Ray, normal: [f64; 3], direction: Option<[f64; 3]>) -> [f64; 2] {
        let towards_eye = ray.direction.map(|component| -component);
        let towards_light = direction.and_then(normalised).unwrap_or(towards_eye);
        let halfway = match direction {
            Some(_) => normalised(each(|k| towards_light[k] + towards_eye[k])),
            None => Some(towards_eye),
        };
        let facing = dot(normal, towards_light);
        let mirrored = halfway.map_or(0.0, |halfway| dot(normal, halfway));
        match self.setting.two_sided {
            true => [facing.abs(), mirrored.abs()],
            false if facing > 0.0 => [facing, mirrored.max(0.0)],
            false => [0.0, 0.0],
        }
    }

    /// The factor of the depth cue: "Lights, cues and cuts". The nearest corner is as far before the centre as the
    /// farthest is behind.
    fn cue(&self, point: [f64; 3]) -> f64 {
        let Some([front, back]) = self.setting.depth_cue else { return 1.0 };
        let forward = self.camera.forward;
        let half_sides = each(|k| self.grid.voxels.spacing[k] * (self.grid.count[k] - 1) as f64 / 2.0);
        let farthest = dot(forward.map(f64::abs), half_sides);
        let depth = dot(each(|k| point[k] - self.camera.centre[k]), forward);
        let fraction = (depth + farthest) / (2.0 * farthest);
        mix(front, back, fraction)
    }

    /// Samples over the background, from back to front.
    fn composite(&self, ray: &Ray, samples: &[Sample]) -> [f64; 3] {
        let length = if self.setting.opacity_correction { self.setting.step_voxel } else { 1.0 };
        samples.iter().rev().fold(self.setting.background, |behind, sample| {
            let opacity = opacity_of_length(sample.opacity, length * sample.part);
            if opacity == 0.0 {
                return behind;
            }
            let colour = self.colour(ray, sample);
            each(|channel| colour[channel] * opacity + behind[channel] * (1.0 - opacity))
        })
    }

    /// Colours without light by their opacity and by the part of the volume's extent, along the axis nearest to the view, that they stand
    /// for ("Perspective"); the background has the rest. Of two axes as near, z comes before y before x.
    fn weighted_sum(&self, ray: &Ray, samples: &[Sample]) -> [f64; 3] {
        let spacing = self.grid.voxels.spacing;
        let steepness = each(|k| (self.camera.forward[k] / spacing[k]).abs());
        let axis = [1, 0].into_iter().fold(2, |best, k| if steepness[k] > steepness[best] { k } else { best });
        let planes = (self.setting.step_voxel * self.unit * ray.direction[axis] / spacing[axis]).abs();
        let whole = planes / (self.grid.count[axis] - 1) as f64;
        let covered: f64 = samples.iter().map(|sample| sample.opacity * sample.part * whole).sum();
        let rest = self.setting.background.map(|channel| channel * (1.0 - covered));
        samples.iter().fold(rest, |sum, sample| {
            let colour = self.unlit(sample);
            each(|channel| sum[channel] + colour[channel] * sample.opacity * sample.part * whole)
        })
    }
}

/// 1 − (1 − opacity)^length, with all digits of a small opacity.
fn opacity_of_length(opacity: f64, length: f64) -> f64 {
    if length == 0.0 { 0.0 } else { -(length * (-opacity.min(1.0)).ln_1p()).exp_m1() }
}

/// The box of the voxels, the crop box and the kept sides of the cut planes.
fn drawn(grid: &Grid, setting: &Setting) -> Vec<HalfSpace> {
    let sides = |axis: usize, low: f64, high: f64| [HalfSpace::side(axis, -1.0, low), HalfSpace::side(axis, 1.0, high)];
    let volume = (0..3).flat_map(|k| sides(k, -grid.shift[k], (grid.count[k] - 1) as f64 - grid.shift[k]));
    let crop = setting.crop.into_iter().flat_map(|[low, high]| {
        let holds_all = move |k: usize| grid.voxels.dims[k] == 1 && low[k] <= 0.0 && high[k] >= 0.0;
        (0..3).filter(move |&k| !holds_all(k)).flat_map(move |k| sides(k, low[k], high[k]))
    });
    let cuts = setting.cuts.iter().map(|&(normal, through)| HalfSpace { normal, through });
    volume.chain(crop).chain(cuts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn volume(dims: [usize; 3], value: impl Fn([f64; 3]) -> f64) -> Voxels {
        let place = |number: usize| [number % dims[0], number / dims[0] % dims[1], number / dims[0] / dims[1]];
        let values = (0..dims.iter().product()).map(|number| value(place(number).map(|index| index as f64))).collect();
        Voxels { dims, spacing: [1.0; 3], values, border: 0.0 }
    }

    /// One pixel, white and without light, of opacity value/1000.
    fn setting(yaw_deg: f64, tilt_deg: f64) -> Setting {
        Setting {
            view: View::Parallel { yaw_deg, tilt_deg, roll_deg: 0.0, pixel_size_voxel: Some(1.0) },
            width: 1,
            height: 1,
            background: [0.0; 3],
            opacity: vec![[0.0, 0.0], [1000.0, 1.0]],
            colour: vec![(0.0, [1.0; 3])],
            opacity_correction: true,
            shaded: false,
            ambient: 0.1,
            diffuse: 0.7,
            specular: 0.2,
            shininess: 10.0,
            two_sided: true,
            lights: vec![(None, [1.0; 3])],
            depth_cue: None,
            cuts: Vec::new(),
            crop: None,
            threshold: [f64::NEG_INFINITY, f64::INFINITY],
            mode: Mode::Composite,
            opaque_alpha: 0.5,
            step_voxel: 0.37,
        }
    }

    fn assert_close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
    }

    fn assert_fog(voxels: &Voxels, setting: &Setting, length: f64) {
        assert_close(cast(voxels, setting)[0][1], 1.0 - 0.95_f64.powf(length), 1e-13);
    }

    #[test]
    fn fog_has_the_opacity_of_its_length() {
        let fog = volume([16; 3], |_| 50.0);
        for step_voxel in [0.11, 0.5, 1.0, 15.0, 40.0] {
            assert_fog(&fog, &Setting { step_voxel, ..setting(90.0, 0.0) }, 15.0);
            assert_fog(&fog, &Setting { step_voxel, ..setting(45.0, 0.0) }, 15.0 * 2.0_f64.sqrt());
            assert_fog(&fog, &Setting { step_voxel, ..setting(0.0, 30.0) }, 15.0 / 30.0_f64.to_radians().cos());
            let uncorrected = Setting { step_voxel, opacity_correction: false, ..setting(0.0, 0.0) };
            assert_fog(&fog, &uncorrected, 15.0 / step_voxel);
        }
        let uneven = Voxels { spacing: [3.0, 2.0, 5.0], ..fog };
        assert_fog(&uneven, &setting(90.0, 0.0), 15.0 * 3.0 / 2.0);
    }

    #[test]
    fn cuts_crops_and_the_eye_shorten_rays() {
        let fog = volume([16; 3], |_| 50.0);
        let cuts = vec![([1.0, 1.0, 0.0], [7.5, 10.0, 0.0])];
        assert_fog(&fog, &Setting { cuts, ..setting(0.0, 0.0) }, 10.0);
        let crop = Some([[0.0, 2.25, 0.0], [15.0, 12.0, 15.0]]);
        assert_fog(&fog, &Setting { crop, ..setting(0.0, 0.0) }, 9.75);
        let eye = |y: f64| View::Eye {
            yaw_deg: 0.0,
            tilt_deg: 0.0,
            roll_deg: 0.0,
            field_of_view_deg: 60.0,
            eye_voxel: Some([7.5, y, 7.5]),
        };
        assert_fog(&fog, &Setting { view: eye(4.0), ..setting(0.0, 0.0) }, 11.0);
        assert_fog(&fog, &Setting { view: eye(-1e9), ..setting(0.0, 0.0) }, 15.0);
        assert_fog(&fog, &Setting { view: eye(15.5), ..setting(0.0, 0.0) }, 0.0);
    }

    #[test]
    fn one_slice_is_one_thick() {
        let slice = Voxels { spacing: [1.0, 1.0, 2.0], ..volume([9, 9, 1], |_| 50.0) };
        assert_fog(&slice, &setting(0.0, 90.0), 2.0);
        let tilt = 60.0_f64;
        assert_fog(&slice, &setting(0.0, tilt), 2.0 / tilt.to_radians().sin());
        let crop = Some([[0.0, 0.0, -0.1], [8.0, 8.0, 0.0]]);
        assert_fog(&slice, &Setting { crop, ..setting(0.0, 90.0) }, 2.0);
        let cuts = vec![([0.0, 0.0, 1.0], [0.0, 0.0, 0.25])];
        assert_fog(&slice, &Setting { cuts, ..setting(0.0, 90.0) }, 1.5);
    }

    #[test]
    fn the_ramp_of_the_book_is_of_the_second_order() {
        let ramp = volume([3, 65, 3], |[_, y, _]| y);
        let exact = 1.0 - (640.0 * (-1.0 - (0.9 * 0.9_f64.ln() - 0.9))).exp();
        assert_close(exact, 0.963569, 5e-7);
        let error = |step_voxel: f64| {
            let opacity = vec![[0.0, 0.0], [640.0, 1.0]];
            cast(&ramp, &Setting { opacity, step_voxel, ..setting(0.0, 0.0) })[0][0] - exact
        };
        let trapezoid_rule = (1.0 - exact) * (1.0 / 576.0 - 1.0 / 640.0) / 12.0;
        assert_close(error(1.0), trapezoid_rule, 1e-3 * trapezoid_rule);
        assert_close(error(1.0) / error(0.5), 4.0, 1e-3);
    }

    #[test]
    fn modes_choose_and_weigh_samples() {
        let hill = volume([5, 41, 5], |[_, y, _]| 100.0 - (y - 20.0).abs());
        let colour = vec![(0.0, [0.0; 3]), (100.0, [1.0; 3])];
        let base = Setting { colour, opacity: vec![[95.0, 0.0], [95.0, 1.0]], step_voxel: 0.5, ..setting(0.0, 0.0) };
        let full = Setting { opacity: vec![[0.0, 1.0]], ..base.clone() };
        let pixel = |mode: Mode| cast(&hill, &Setting { mode, ..full.clone() })[0][0];
        assert_close(pixel(Mode::Maximum), 1.0, 1e-13);
        assert_close(pixel(Mode::Minimum), 0.8, 1e-13);
        assert_close(pixel(Mode::WeightedSum), 0.9, 1e-13);
        let depth_cue = Some([1.0, 0.0]);
        let cued = |mode: Mode| cast(&hill, &Setting { mode, depth_cue, ..base.clone() })[0][0];
        assert_close(cued(Mode::FirstOpaque), 0.95 * (1.0 - 15.0 / 40.0), 1e-13);
        assert_close(cued(Mode::LastOpaque), 0.95 * (1.0 - 25.0 / 40.0), 1e-13);
    }

    #[test]
    fn a_wall_is_lit_by_its_angle() {
        let wall = Voxels { spacing: [1.0, 2.0, 1.0], ..volume([9; 3], |[x, y, _]| 10.0 * x + 10.0 * y) };
        let normal = normalised([-10.0, -5.0, 0.0]).unwrap();
        let (shaded, mode, crop) = (true, Mode::FirstOpaque, Some([[1.0; 3], [7.0; 3]]));
        let base = Setting { shaded, mode, crop, opacity: vec![[0.0, 1.0]], ..setting(0.0, 0.0) };
        let facing = -normal[1];
        let pixel = cast(&wall, &base)[0][2];
        assert_close(pixel, 0.1 + 0.7 * facing + 0.2 * facing.powi(10), 1e-13);
        let lights = vec![(Some([0.0, 3.0, 0.0]), [1.0; 3])];
        let away = cast(&wall, &Setting { lights, two_sided: false, ..base })[0][2];
        assert_close(away, 0.1, 1e-13);
    }

    #[test]
    fn rays_go_through_their_pixels() {
        let block = volume([16, 2, 16], |[x, _, z]| if x == 12.0 && z == 14.0 { 1000.0 } else { 0.0 });
        let picture = |roll_deg: f64, mode: Mode| {
            let view = View::Parallel { yaw_deg: 0.0, tilt_deg: 0.0, roll_deg, pixel_size_voxel: Some(1.0) };
            cast(&block, &Setting { view, width: 16, height: 16, mode, ..setting(0.0, 0.0) })
        };
        let brightest = |pixels: &[[f64; 3]]| pixels.iter().position(|pixel| pixel[0] > 0.5).unwrap();
        assert_eq!(brightest(&picture(0.0, Mode::Composite)), 16 + 12);
        assert_eq!(brightest(&picture(90.0, Mode::FirstOpaque)), 12 * 16 + 14);
    }

    #[test]
    fn from_far_away_the_picture_is_the_parallel_one() {
        let ball = volume([9; 3], |place| 500.0 - 30.0 * place.map(|x| (x - 4.2) * (x - 4.2)).iter().sum::<f64>());
        let sized = Setting { width: 12, height: 8, shaded: true, depth_cue: Some([1.0, 0.3]), ..setting(0.0, 0.0) };
        let (yaw_deg, tilt_deg, roll_deg) = (33.0, -12.0, 25.0);
        let parallel = View::Parallel { yaw_deg, tilt_deg, roll_deg, pixel_size_voxel: Some(1.25) };
        let expected = cast(&ball, &Setting { view: parallel, ..sized.clone() });
        let camera = Camera::new(&ball, &Setting { view: setting(yaw_deg, tilt_deg).view, ..sized.clone() }, 1.0);
        let eye_voxel = Some(each(|k| 4.0 - 1e6 * camera.forward[k]));
        let field_of_view_deg = 2.0 * (1.25e-6 * 8.0 / 2.0_f64).atan().to_degrees();
        let view = View::Eye { yaw_deg, tilt_deg, roll_deg, field_of_view_deg, eye_voxel };
        let found = cast(&ball, &Setting { view, ..sized });
        assert!(expected.iter().any(|pixel| pixel[0] > 0.3));
        for (found, expected) in found.iter().zip(&expected) {
            assert_close(found[0], expected[0], 1e-5);
        }
    }

    #[test]
    fn without_a_place_the_eye_sees_the_bounding_sphere() {
        let fog = volume([16; 3], |_| 50.0);
        for (width, height) in [(300, 200), (200, 300)] {
            let (yaw_deg, tilt_deg, roll_deg, field_of_view_deg) = (45.0, 0.0, 0.0, 50.0);
            let view = View::Eye { yaw_deg, tilt_deg, roll_deg, field_of_view_deg, eye_voxel: None };
            let camera = Camera::new(&fog, &Setting { view, width, height, ..setting(0.0, 0.0) }, 1.0);
            let (column, row) = if width < height { (0, height / 2) } else { (width / 2, 0) };
            let ray = camera.ray(column, row);
            let way = each(|k| camera.centre[k] - ray.point[k]);
            let along = dot(way, ray.direction);
            let missed = (dot(way, way) - along * along).sqrt();
            assert_close(missed, 8.0 * 3.0_f64.sqrt(), 0.1);
        }
    }
}
