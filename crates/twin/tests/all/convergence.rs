//! The order of the casters on the base plane as voxels become finer: one field over the unit cube, its extinction a length of the world the same, on 17,
//! 33 and 65 voxels a side. Each pixel of the base plane beside the integral along its own ray, by Simpson's rule on the field itself.

use crate::common::order::{assert_order, order};
use crate::common::{fog, geometry_along};
use cube3_frame::Geometry;
use cube3_machine::TemplateRule;
use cube3_scene::{Scene, View, corrected_opacity};
use cube3_twin::{BaseRendering, DiscreteOptions, SampleCell, discrete, step_length};
use cube3_volume::Volume;
use glam::DVec3;

const SIDES: [usize; 3] = [17, 33, 65];
const TOP: f64 = 255.0;
/// Panels of Simpson's rule along a ray.
const PANELS: usize = 128;

fn spacings() -> [f64; 3] {
    SIDES.map(|n| 1.0 / (n - 1) as f64)
}

/// Interpolation has it exactly, in a sheared cell too.
fn affine(at: DVec3) -> f64 {
    40.0 + 60.0 * at.x + 90.0 * at.y + 50.0 * at.z
}

/// Curved along every axis and between axes.
fn curved(at: DVec3) -> f64 {
    120.0 + 60.0 * (2.1 * at.x + 0.3).sin() * (1.7 * at.z).cos() + 50.0 * at.y * at.y - 40.0 * at.x * at.y * at.z
}

/// Which caster, on which samples.
#[derive(Clone, Copy, Debug)]
struct Setting {
    field: fn(DVec3) -> f64,
    cell: SampleCell,
    offset: f64,
    /// Every sample stands for a whole step, as published.
    whole_steps: bool,
}

/// The field on n voxels a side, seen aslant.
struct Subject {
    n: usize,
    scene: Scene,
    geometry: Geometry,
    setting: Setting,
    volume: Volume,
}

impl Subject {
    fn new(n: usize, setting: Setting) -> Subject {
        let spacing = 1.0 / (n - 1) as f64;
        let place = |i: usize| i as f64 * spacing;
        let value = |x, y, z| (setting.field)(DVec3::new(place(x), place(y), place(z)));
        let volume = Volume::from_fn([n; 3], [spacing; 3], value).unwrap();
        let mut scene = Scene { view: View::from_angles(24.0, 11.0), ..fog(0.0) };
        scene.transfer.opacity = vec![[0.0, 0.0], [TOP, corrected_opacity(0.1, 16.0 * spacing)]];
        let direction = scene.view.frame().unwrap().direction;
        let geometry = geometry_along(&volume, direction, TemplateRule::PlaneFloor, setting.offset);
        Subject { n, scene, geometry, setting, volume }
    }

    fn base(&self) -> BaseRendering {
        let options = DiscreteOptions { whole_steps: self.setting.whole_steps, ..DiscreteOptions::default() };
        discrete(&self.volume, &self.scene, &self.geometry, self.setting.cell, &options, None).unwrap()
    }

    /// Extinction of a step at depth w of the ray of a pixel.
    fn extinction(&self, base: &BaseRendering, pixel: usize, w: f64) -> f64 {
        let (first, [du, dv]) = (self.geometry.first_ray(), self.geometry.real_slopes());
        let u = (first.u + (pixel % base.width) as i64) as f64 + w * du;
        let v = (first.v + (pixel / base.width) as i64) as f64 + w * dv;
        let at = DVec3::from(self.geometry.axes.voxel_position(self.geometry.size, [u, v, w]));
        let opacity = self.scene.transfer.opacity_at((self.setting.field)(at / (self.n - 1) as f64), 0.0);
        -(-opacity).ln_1p() * step_length(&self.geometry, self.volume.spacing)
    }

    /// Whether a ray goes from the front face to the back one.
    fn goes_through(&self, base: &BaseRendering, pixel: usize) -> bool {
        let (first, [du, dv]) = (self.geometry.first_ray(), self.geometry.real_slopes());
        let extent = (self.n - 1) as f64;
        let inside =
            |at: i64, slope: f64| [at as f64, at as f64 + extent * slope].iter().all(|x| (0.0..=extent).contains(x));
        inside(first.u + (pixel % base.width) as i64, du) && inside(first.v + (pixel / base.width) as i64, dv)
    }

    /// The integral along a ray that goes through.
    fn truth(&self, base: &BaseRendering, pixel: usize) -> f64 {
        let panel = (self.n - 1) as f64 / PANELS as f64;
        let at = |half: usize| self.extinction(base, pixel, half as f64 * panel / 2.0);
        let sum = (0..PANELS).map(|i| at(2 * i) + 4.0 * at(2 * i + 1) + at(2 * i + 2)).sum::<f64>();
        sum * panel / 6.0
    }

    /// Errors of the opacity of all rays that go through, and the first term of what it should be for an affine field.
    fn errors(&self) -> Vec<[f64; 2]> {
        let base = self.base();
        let through = (0..base.pixels.len()).filter(|pixel| self.goes_through(&base, *pixel));
        let error = |pixel: usize| {
            let depth = self.truth(&base, pixel);
            let left = (-depth).exp();
            [base.pixels[pixel][3] - (1.0 - left), left * self.leading(&base, pixel)]
        };
        let errors: Vec<[f64; 2]> = through.map(error).collect();
        assert!(errors.len() > self.n, "enough rays go through");
        errors
    }

    /// What the samples' sum is above ∫τ dw, by the first term of each stretch. Within, a sample is in the middle of its step: −1/24 of the change of
    /// τ'. The first stands for o + ½ from the face on, the last for 3/2 − o up to the other: each is (o − ½)/2 beyond the middle of its stretch.
    /// Whole steps are τ·(½ − o) short at the front, and as much long at the back.
    fn leading(&self, base: &BaseRendering, pixel: usize) -> f64 {
        let o = self.setting.offset;
        let (back, small) = ((self.n - 1) as f64, 1e-3);
        let value = |w: f64| self.extinction(base, pixel, w);
        let slope = |w: f64| (value(w + small) - value(w - small)) / (2.0 * small);
        if self.setting.whole_steps {
            return (o - 0.5) * (value(back) - value(0.0)) - (slope(back) - slope(0.0)) / 24.0;
        }
        let ends = (slope(0.0) * (o + 0.5) + slope(back) * (1.5 - o)) * (o - 0.5) / 2.0;
        ends - (slope(back) - slope(0.0)) / 24.0
    }
}

/// Root of the mean square of the errors at each of the sides.
fn rms(setting: Setting) -> [f64; 3] {
    SIDES.map(|n| {
        let errors = Subject::new(n, setting).errors();
        (errors.iter().map(|[error, _]| error * error).sum::<f64>() / errors.len() as f64).sqrt()
    })
}

/// Every setting with its name and its order. What is left of an affine field with o = ½ is the bend of −ln(1 − α), of which a voxel has less and less:
/// the third.
fn settings() -> Vec<(String, Setting, f64)> {
    let mut all = Vec::new();
    for (name, field, middle) in [("affine", affine as fn(DVec3) -> f64, 3.0), ("curved", curved, 2.0)] {
        for (caster, cell) in [("true", SampleCell::Exact), ("sheared", SampleCell::Sheared)] {
            for (offset, whole_steps, order) in
                [(0.5, false, middle), (0.25, false, 2.0), (0.5, true, middle), (0.25, true, 1.0)]
            {
                let ends = if whole_steps { ", whole steps" } else { "" };
                all.push((
                    format!("{caster}, {name}, o = {offset}{ends}"),
                    Setting { field, cell, offset, whole_steps },
                    order,
                ));
            }
        }
    }
    all
}

#[test]
fn exact_ends_are_of_the_second_order_and_whole_steps_of_the_first_unless_samples_are_in_the_middle() {
    for (name, setting, order) in settings() {
        assert_order(&name, &spacings(), &rms(setting), order, 0.1);
    }
}

/// Of a field that interpolation has exactly, the error of every ray is that of its sum.
#[test]
fn the_error_on_an_affine_field_is_the_sums_in_closed_form() {
    for cell in [SampleCell::Exact, SampleCell::Sheared] {
        for whole_steps in [false, true] {
            for offset in [0.5, 0.25, 0.125] {
                let setting = Setting { field: affine, cell, offset, whole_steps };
                let errors = Subject::new(SIDES[2], setting).errors();
                let largest = errors.iter().map(|[_, term]| term.abs()).fold(0.0, f64::max);
                for [error, term] in errors {
                    assert!((error - term).abs() < 0.03 * largest, "{setting:?}: {error:e}, not {term:e}");
                }
            }
        }
    }
}

/// The table of the section "Order of convergence" in docs/src/raycast.md.
#[test]
#[ignore = "prints the book's table: cargo test --release -p cube3-twin --test all convergence:: -- --ignored --nocapture"]
fn the_orders_as_a_table() {
    println!("| caster, field, offset | order | n = 17 | n = 33 | n = 65 |\n| --- | --- | --- | --- | --- |");
    for (name, setting, _) in settings() {
        let errors = rms(setting);
        let shown = errors.map(|error| format!("{error:.1e}")).join(" | ");
        println!("| {name} | {:.2} | {shown} |", order(&spacings(), &errors));
    }
}
