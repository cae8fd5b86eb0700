//! The passes of an eye as the host sets them up, their rays, and what the ray of a pixel is.

use cube3_frame::{DiscreteRay, Geometry};
use cube3_host::{PictureFrames, VolumeInfo, picture_setup};
use cube3_machine::{GradientMethod, MachineSpec, TemplateRule};
use cube3_scene::{Image, Perspective, Scene, View, eye, smallest_spacing};
use cube3_volume::Volume;
use glam::DVec3;

/// A scene as an eye at a place in voxels sees it, which looks to the middle of a volume of `dims` voxels.
pub fn seen_from(scene: &Scene, dims: [usize; 3], place: [f64; 3], field_of_view_deg: f64) -> Scene {
    let middle = dims.map(|n| (n - 1) as f64 / 2.0);
    let along = [0, 1, 2].map(|i| middle[i] - place[i]);
    let along = if along == [0.0; 3] { [0.3, 1.0, -0.2] } else { along };
    let view = View {
        perspective: Some(Perspective { eye_voxel: Some(place), ..Perspective::new(field_of_view_deg) }),
        ..View::from_direction(along, None)
    };
    let image = Image { pixel_size_voxel: None, ..scene.image.clone() };
    Scene { view, image, ..scene.clone() }
}

/// Frames of the default machine with an estimator and a rule.
pub fn frames(volume: &Volume, scene: &Scene, gradient: GradientMethod, template: TemplateRule) -> PictureFrames {
    let mut machine = MachineSpec::default();
    (machine.abc.gradient, machine.rays.template) = (gradient, template);
    let info = VolumeInfo { dims: volume.dims, spacing: volume.spacing, window: [0.0, 255.0] };
    picture_setup(scene, &machine, &info, true).unwrap()
}

/// The geometries of its passes, or the one of a parallel view.
pub fn geometries(frames: &PictureFrames) -> Vec<&Geometry> {
    frames.setups.iter().map(|setup| &setup.geometry).collect()
}

/// Every ray of a base plane, in the order of its pixels.
pub fn rays(geometry: &Geometry) -> impl Iterator<Item = DiscreteRay> + use<> {
    let (first, [width, height]) = (geometry.first_ray(), geometry.base_plane_size());
    (0..height as i64)
        .flat_map(move |row| (0..width as i64).map(move |column| DiscreteRay { u: first.u + column, v: first.v + row }))
}

/// A ray of a pass as places in voxels x, y, z by their depth w, from two of its samples.
pub fn line(geometry: &Geometry, ray: DiscreteRay) -> impl Fn(f64) -> DVec3 + use<'_> {
    let first = geometry.perspective.as_ref().unwrap().first_depth;
    let [near, far] = [first, first + 64].map(|k| DVec3::from(geometry.sample_position(ray, k)));
    move |depth| {
        let place = near + (far - near) * ((depth - near.z) / (far.z - near.z));
        DVec3::from(geometry.axes.voxel_position(geometry.size, place.to_array()))
    }
}

/// The eye's depth in a pass.
pub fn eye_depth(scene: &Scene, volume: &Volume, geometry: &Geometry) -> f64 {
    let view = scene.view.frame().unwrap();
    let place = eye(&scene.view, &view, &scene.image, volume.dims, volume.spacing).unwrap();
    let place = [0, 1, 2].map(|i| place[i] / volume.spacing[i]);
    geometry.axes.canonical_position(geometry.size, place)[2]
}

/// The world direction of a ray of a pass, and the length of its step in the smallest voxel spacing.
pub fn along(geometry: &Geometry, ray: DiscreteRay, spacing: [f64; 3]) -> (DVec3, f64) {
    let place = line(geometry, ray);
    let step = (place(1.0) - place(0.0)) * DVec3::from(spacing);
    (step.normalize(), step.length() / smallest_spacing(spacing))
}
