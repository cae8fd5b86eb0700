//! What every method that takes samples must lie between, whatever their phase.

use crate::stretches::Stretches;
use cube3_reference::{Line, LinearCue, RaycastError, check_volume, margin, nearest_axis, thickened};
use cube3_scene::{ImagePlane, Mode, Scene, smallest_spacing};
use cube3_volume::Volume;

/// The least and the largest that a pixel's channels can be, red, green and blue over the background.
pub type Range = [[f64; 2]; 3];

/// How far the ray gets along its fastest axis in a window, in voxels.
const WINDOW_VOXEL: f64 = 0.5;

/// The ranges of a parallel picture's pixels for the integral and for every method whose samples are near the ray.
///
/// A method that takes samples stands, at each place along the ray, for the opacity and the colour of a sample somewhere near. If that is
/// within `reach_voxel` of the place, along each axis, then its opacity and colour are between the least and the largest that the voxels of all
/// cells in reach have, and so are the integral's. Windows of the ray are composited from back to front with these ranges: c·A + (1 − A)·X is
/// linear in each of the three, so its ends are at ends of theirs. Where the reach leaves what is drawn, there may be nothing. Lit colours are between
/// ambient light alone and all light at once. So a range is as wide as the field changes within the reach: of a homogeneous medium it is open at
/// the ends of the ray alone.
///
/// # Errors
/// As [`converged`](crate::converged); a perspective view, in which lengths along neighbouring rays are not the same.
pub fn enclosure(volume: &Volume, scene: &Scene, reach_voxel: f64) -> Result<Vec<Range>, RaycastError> {
    scene.validate()?;
    check_volume(volume, 0.0)?;
    let (volume, scene) = thickened(volume, scene);
    let (volume, scene) = (&*volume, &*scene);
    if scene.view.perspective.is_some() || !scene.mode.adds_up() {
        return Err(RaycastError::Option {
            name: "view",
            value: reach_voxel,
            reason: "asked of rays from an eye, or of a mode that chooses a sample",
            right: "give a parallel view of composite or weighted-sum",
        });
    }
    let view = scene.view.frame()?;
    let smallest = smallest_spacing(volume.spacing);
    let plane = ImagePlane::new(scene, &view, volume.dims, volume.spacing);
    let axis = nearest_axis(view.direction, volume.spacing);
    let around = Around {
        volume,
        scene,
        stretches: Stretches::new(scene),
        cue: scene.depth_cue.as_ref().map(|cue| LinearCue::new(cue, volume, &view)),
        reach: reach_voxel,
        margin: margin(scene),
    };
    let extent = (volume.dims[axis] - 1) as f64 + 2.0 * margin(scene);
    let mut ranges = Vec::with_capacity(plane.width * plane.height);
    for row in 0..plane.height {
        for column in 0..plane.width {
            let line = Line::of_pixel(&plane, [column, row], volume.spacing, smallest);
            let windows = around.windows(&line);
            ranges.push(match scene.mode {
                Mode::WeightedSum => sum(&windows, line.direction[axis].abs() / extent, scene.background),
                _ => composite(&windows, scene.background),
            });
        }
    }
    Ok(ranges)
}

/// A stretch of the ray: its length, the opacity of a unit length and the colour.
struct Window {
    length: f64,
    opacity: [f64; 2],
    colour: Range,
}

struct Around<'a> {
    volume: &'a Volume,
    scene: &'a Scene,
    stretches: Stretches,
    cue: Option<LinearCue<'a>>,
    reach: f64,
    margin: f64,
}

impl Around<'_> {
    /// The windows of a line from the front, but for those in which nothing can be seen.
    fn windows(&self, line: &Line) -> Vec<Window> {
        let dims = self.volume.dims;
        let far = self.reach + self.margin;
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for (i, n) in dims.into_iter().enumerate() {
            let (low, high) = (-far, (n - 1) as f64 + far);
            let (origin, rate) = (line.origin[i], line.direction[i]);
            if rate == 0.0 {
                if origin < low || origin > high {
                    return Vec::new();
                }
                continue;
            }
            let (a, b) = ((low - origin) / rate, (high - origin) / rate);
            (enter, leave) = (enter.max(a.min(b)), leave.min(a.max(b)));
        }
        if enter >= leave {
            return Vec::new();
        }
        let fastest = line.direction.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        let count = ((leave - enter) * fastest / WINDOW_VOXEL).ceil().max(1.0);
        let length = (leave - enter) / count;
        (0..count as usize).filter_map(|i| self.window(line, enter + i as f64 * length, length)).collect()
    }

    fn window(&self, line: &Line, from: f64, length: f64) -> Option<Window> {
        let dims = self.volume.dims;
        let at = |t: f64| [0, 1, 2].map(|i| line.origin[i] + line.direction[i] * t);
        let (a, b) = (at(from), at(from + length));
        let low = [0, 1, 2].map(|i| (a[i].min(b[i]) - self.reach).floor() as isize);
        let high = [0, 1, 2].map(|i| (a[i].max(b[i]) + self.reach).ceil() as isize);
        let held = |i: usize, x: isize| x.clamp(0, dims[i] as isize - 1) as usize;
        let (first, last) = ([0, 1, 2].map(|i| held(i, low[i])), [0, 1, 2].map(|i| held(i, high[i])));
        let mut values = [f64::INFINITY, f64::NEG_INFINITY];
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                let row = (z * dims[1] + y) * dims[0];
                for x in first[0]..=last[0] {
                    let value = self.volume.samples.value(row + x);
                    values = [values[0].min(value), values[1].max(value)];
                }
            }
        }
        if self.stretches.clear(values) {
            return None;
        }
        let mut opacity = self.stretches.opacities(values, [0.0, f64::INFINITY]);
        let whole = (0..3).all(|i| low[i] >= 0 && high[i] < dims[i] as isize) && self.is_kept(low, high);
        if !whole {
            opacity[0] = 0.0;
        }
        let colour = self.colours(values);
        Some(Window { length, opacity, colour })
    }

    /// Whether crop and cuts keep all of a box.
    fn is_kept(&self, low: [isize; 3], high: [isize; 3]) -> bool {
        (0..8).all(|corner| {
            let at = [0, 1, 2].map(|i| if corner >> i & 1 == 0 { low[i] } else { high[i] } as f64);
            let cropped = self.scene.crop.as_ref().is_some_and(|crop| crop.removes(at));
            !cropped && !self.scene.cuts.iter().any(|cut| cut.removes(at))
        })
    }

    fn colours(&self, values: [f64; 2]) -> Range {
        let (scene, rgb) = (self.scene, self.stretches.colours(values));
        let material = &scene.material;
        let shaded = material.shaded && scene.mode == Mode::Composite;
        let cue = self.cue.as_ref().map_or([1.0; 2], |linear| {
            let (front, back) = (linear.cue.front, linear.cue.back);
            [front.min(back), front.max(back)]
        });
        [0, 1, 2].map(|i| {
            let [low, high] = rgb[i];
            let lit = |light: &cube3_scene::Light| light.colour[i] * (material.diffuse * high + material.specular);
            let range = match shaded {
                false => rgb[i],
                true => [
                    material.ambient * low,
                    (material.ambient * high + scene.lights.iter().map(lit).sum::<f64>()).min(1.0),
                ],
            };
            [range[0] * cue[0], range[1] * cue[1]]
        })
    }
}

/// From back to front.
fn composite(windows: &[Window], background: [f64; 3]) -> Range {
    let mut behind = background.map(|c| [c, c]);
    for window in windows.iter().rev() {
        let [least, most] = window.opacity.map(|alpha| -libm::expm1(window.length * libm::log1p(-alpha)));
        for (behind, colour) in behind.iter_mut().zip(window.colour) {
            let over = |colour: f64, behind: f64| [least, most].map(|hidden| colour * hidden + (1.0 - hidden) * behind);
            let (low, high) = (over(colour[0], behind[0]), over(colour[1], behind[1]));
            *behind = [low[0].min(low[1]), high[0].max(high[1])];
        }
    }
    behind
}

fn sum(windows: &[Window], weight: f64, background: [f64; 3]) -> Range {
    let total = |of: &dyn Fn(&Window) -> f64| (windows.iter().map(|w| of(w) * w.length).sum::<f64>() * weight).min(1.0);
    let alpha = [total(&|w| w.opacity[0]), total(&|w| w.opacity[1])];
    [0, 1, 2].map(|i| {
        let low = total(&|w| w.opacity[0] * w.colour[i][0]) + (1.0 - alpha[1]) * background[i];
        let high = total(&|w| w.opacity[1] * w.colour[i][1]) + (1.0 - alpha[0]) * background[i];
        [low, high.min(1.0)]
    })
}
