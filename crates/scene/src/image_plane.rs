//! The image plane: where each pixel of the final picture is in the world and on the base plane.

use crate::{Image, Perspective, Scene, View, ViewFrame, sin_cos_degrees};
use glam::DVec3;

/// A view's image plane. World lengths are those of the spacing.
///
/// In a parallel view it goes through the centre of the volume. In perspective it is at the unit distance before the
/// eye, wherever the volume is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImagePlane {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// The world point at the centre of pixel (0, 0), the top left one.
    pub first: DVec3,
    /// World step from a pixel to the one on its right.
    pub across: DVec3,
    /// World step from a pixel to the one below.
    pub down: DVec3,
    /// The view's direction, through the centre of the picture, of unit length.
    pub direction: DVec3,
    /// The eye, in world coordinates; `None` in a parallel view.
    pub eye: Option<DVec3>,
    /// From the eye along the view to the plane across it through the volume's centre: below 0 where the centre is
    /// behind the eye, infinite in a parallel view.
    pub depth: f64,
    /// Where the ray through the picture's centre crosses that plane.
    pub middle: DVec3,
}

impl ImagePlane {
    /// The plane for a volume of `dims` voxels of `spacing`, seen as `frame`, which is the frame of the scene's view.
    /// Without a pixel size, a place of the eye or its distance in the scene, the sphere around the volume's voxels fits.
    pub fn new(scene: &Scene, frame: &ViewFrame, dims: [usize; 3], spacing: [f64; 3]) -> ImagePlane {
        let (image, direction) = (&scene.image, frame.direction);
        let centre = centre(dims, spacing);
        let (width, height) = (image.width_px as usize, image.height_px as usize);
        if let Some(perspective) = &scene.view.perspective {
            let sight = Sight::new(perspective, frame, image, dims, spacing);
            let pixel = 2.0 * half_height(perspective) / height as f64;
            let mut plane = ImagePlane {
                width,
                height,
                first: DVec3::ZERO,
                across: frame.right * pixel,
                down: -frame.up * pixel,
                direction,
                eye: Some(sight.eye),
                depth: sight.depth,
                middle: sight.middle,
            };
            plane.first = sight.eye + direction + plane.off_middle(0.0, 0.0);
            return plane;
        }
        let pixel = match image.pixel_size_voxel {
            Some(voxels) => voxels * smallest_spacing(spacing),
            None => diameter(dims, spacing) / width.min(height) as f64,
        };
        let across = frame.right * pixel;
        let down = -frame.up * pixel;
        let first = centre - across * ((width as f64 - 1.0) * 0.5) - down * ((height as f64 - 1.0) * 0.5);
        ImagePlane { width, height, first, across, down, direction, eye: None, depth: f64::INFINITY, middle: centre }
    }

    /// World point of a pixel's centre. In perspective it has no more digits than a place near the eye has: directions
    /// are for [`ImagePlane::ray`] to give.
    pub fn point(&self, column: f64, row: f64) -> DVec3 {
        self.first + self.across * column + self.down * row
    }

    /// The ray of a pixel: where it begins and its direction, both in the world.
    ///
    /// In a parallel view a ray runs through [`ImagePlane::point`], and both ways from there; the direction is the
    /// view's. In perspective it begins at the eye, and its direction is not of unit length: along the view it is 1, so
    /// that a ray's parameter is depth. It is as precise wherever the eye is.
    pub fn ray(&self, column: f64, row: f64) -> (DVec3, DVec3) {
        match self.eye {
            None => (self.point(column, row), self.direction),
            Some(eye) => (eye, self.direction + self.off_middle(column, row)),
        }
    }

    /// Where the ray of a pixel crosses the plane across the view through the volume's centre: [`ImagePlane::ray`]'s
    /// origin plus `depth` times its direction, with all digits also where the eye is far away.
    pub fn crossing(&self, column: f64, row: f64) -> DVec3 {
        match self.eye {
            None => self.point(column, row),
            Some(_) => self.middle + self.off_middle(column, row) * self.depth,
        }
    }

    /// From the middle of the picture to a pixel's centre.
    fn off_middle(&self, column: f64, row: f64) -> DVec3 {
        let middle = |pixels: usize| (pixels as f64 - 1.0) * 0.5;
        self.across * (column - middle(self.width)) + self.down * (row - middle(self.height))
    }
}

/// The eye of a view of a volume of `dims` voxels of `spacing`, in the world; `None` in a parallel view.
pub fn eye(view: &View, frame: &ViewFrame, image: &Image, dims: [usize; 3], spacing: [f64; 3]) -> Option<DVec3> {
    view.perspective.as_ref().map(|perspective| Sight::new(perspective, frame, image, dims, spacing).eye)
}

/// The eye, also as it is seen from the volume, which keeps the digits of its depth where it is far away.
struct Sight {
    eye: DVec3,
    /// As [`ImagePlane::depth`].
    depth: f64,
    /// As [`ImagePlane::middle`].
    middle: DVec3,
}

impl Sight {
    fn new(perspective: &Perspective, frame: &ViewFrame, image: &Image, dims: [usize; 3], spacing: [f64; 3]) -> Sight {
        let centre = centre(dims, spacing);
        if let Some(eye) = perspective.eye_voxel {
            let eye = DVec3::from(eye) * DVec3::from(spacing);
            let from_centre = eye - centre;
            let (x, y) = (from_centre.dot(frame.right), from_centre.dot(frame.up));
            let depth = -from_centre.dot(frame.direction);
            return Sight { eye, depth, middle: centre + frame.right * x + frame.up * y };
        }
        let depth = match perspective.distance_voxel {
            Some(voxels) => voxels * smallest_spacing(spacing),
            None => {
                // A sphere of radius r at distance d fills the angle asin(r/d) to either side.
                let narrowest = (f64::from(image.width_px) / f64::from(image.height_px)).min(1.0);
                let tangent = half_height(perspective) * narrowest;
                let sine = tangent / (1.0 + tangent * tangent).sqrt();
                diameter(dims, spacing) * 0.5 / sine
            }
        };
        Sight { eye: centre - frame.direction * depth, depth, middle: centre }
    }
}

/// Half the height of a picture at unit distance.
fn half_height(perspective: &Perspective) -> f64 {
    let (sine, cosine) = sin_cos_degrees(perspective.field_of_view_deg * 0.5);
    sine / cosine
}

/// The centre of the voxels' centres.
fn centre(dims: [usize; 3], spacing: [f64; 3]) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|i| (dims[i] - 1) as f64 * spacing[i] * 0.5))
}

/// The diameter of the sphere around the volume's voxels.
fn diameter(dims: [usize; 3], spacing: [f64; 3]) -> f64 {
    DVec3::from_array([0, 1, 2].map(|i| dims[i] as f64 * spacing[i])).length()
}

/// The smallest voxel spacing, the unit of steps, of lengths in pictures and of gradients; `spacing` is along the three axes.
pub fn smallest_spacing(spacing: [f64; 3]) -> f64 {
    spacing.iter().copied().fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    const DIMS: [usize; 3] = [33, 20, 57];
    const SPACING: [f64; 3] = [1.0, 0.8, 1.7];

    fn scene(perspective: Perspective) -> Scene {
        let mut scene = Scene::default();
        scene.view.perspective = Some(perspective);
        (scene.image.width_px, scene.image.height_px) = (40, 30);
        scene
    }

    fn plane(scene: &Scene) -> ImagePlane {
        ImagePlane::new(scene, &scene.view.frame().unwrap(), DIMS, SPACING)
    }

    fn at_distance(field_of_view_deg: f64, distance: f64) -> Scene {
        scene(Perspective { distance_voxel: Some(distance), ..Perspective::new(field_of_view_deg) })
    }

    #[test]
    fn a_parallel_ray_runs_through_its_point_along_the_view() {
        let scene = Scene::default();
        let plane = plane(&scene);
        let frame = scene.view.frame().unwrap();
        assert_eq!(eye(&scene.view, &frame, &scene.image, DIMS, SPACING), None);
        assert_eq!(plane.ray(3.0, 8.5), (plane.point(3.0, 8.5), frame.direction));
        assert_eq!((plane.crossing(3.0, 8.5), plane.depth), (plane.point(3.0, 8.5), f64::INFINITY));
    }

    #[test]
    fn the_field_of_view_lies_between_the_edges_at_every_distance() {
        for distance in [0.0, 1.0, 300.0, 1e9, 1e12] {
            for field_of_view_deg in [0.001, 40.0, 90.0, 179.0] {
                let plane = plane(&at_distance(field_of_view_deg, distance));
                let half = f64::to_radians(field_of_view_deg) / 2.0;
                for (column, row, tangent) in [
                    (19.5, -0.5, half.tan()),
                    (19.5, 29.5, half.tan()),
                    (-0.5, 14.5, half.tan() * 4.0 / 3.0),
                    (39.5, 14.5, half.tan() * 4.0 / 3.0),
                ] {
                    let (origin, ray) = plane.ray(column, row);
                    assert_eq!(Some(origin), plane.eye);
                    assert!((ray.dot(plane.direction) - 1.0).abs() < 1e-13 * tangent.max(1.0));
                    let across = ray - plane.direction;
                    assert!((across.length() / tangent - 1.0).abs() < 1e-10, "{field_of_view_deg}° from {distance}");
                }
                assert_eq!(plane.ray(19.5, 14.5).1, plane.direction);
            }
        }
    }

    #[test]
    fn without_a_place_for_the_eye_the_sphere_around_the_volume_touches_the_narrower_edges() {
        let radius = DVec3::new(33.0, 16.0, 57.0 * 1.7).length() / 2.0;
        for (size, edge) in [((40, 30), (19.5, -0.5)), ((30, 40), (-0.5, 19.5)), ((30, 30), (14.5, 29.5))] {
            for field_of_view_deg in [0.001, 30.0, 90.0, 179.0] {
                let mut scene = scene(Perspective::new(field_of_view_deg));
                (scene.image.width_px, scene.image.height_px) = size;
                let plane = plane(&scene);
                let (origin, ray) = plane.ray(edge.0, edge.1);
                let to_centre = centre(DIMS, SPACING) - origin;
                let distance = to_centre.cross(ray.normalize()).length();
                assert!((distance / radius - 1.0).abs() < 1e-10, "{distance}, not {radius}");
                assert!((to_centre.length() / plane.depth - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn an_eye_is_where_it_is_put_and_does_not_turn_the_view() {
        let turned = at_distance(50.0, 250.0);
        for eye_voxel in [[16.0, 9.5, 28.0], [0.0; 3], [-300.0, 7.0, 1e9], [1e12, -1e12, 1e12]] {
            let scene = scene(Perspective { eye_voxel: Some(eye_voxel), ..Perspective::new(50.0) });
            let plane = plane(&scene);
            let expected = DVec3::from(eye_voxel) * DVec3::from(SPACING);
            let frame = scene.view.frame().unwrap();
            assert_eq!(plane.eye, Some(expected));
            assert_eq!(eye(&scene.view, &frame, &scene.image, DIMS, SPACING), plane.eye);
            assert_eq!(plane.ray(3.0, 2.0).1, self::plane(&turned).ray(3.0, 2.0).1);
        }
    }

    #[test]
    fn far_away_the_crossings_are_the_points_of_the_parallel_view() {
        for distance in [1e3, 1e9, 1e12] {
            let perspective = at_distance(2.0 * (25.0_f64 / distance).atan().to_degrees(), distance);
            let mut parallel = perspective.clone();
            parallel.view.perspective = None;
            parallel.image.pixel_size_voxel = Some(50.0 / 30.0);
            let (far, parallel) = (plane(&perspective), plane(&parallel));
            for (column, row) in [(0.0, 0.0), (39.0, 0.0), (12.25, 29.0)] {
                let off = far.crossing(column, row) - parallel.point(column, row);
                assert!(off.length() < 1e-12 * 57.0, "{off} from {distance}");
            }
        }
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn point_ray_and_crossing_are_on_one_line(
            eye_voxel in prop::array::uniform3(-100.0..100.0_f64), yaw in -180.0..180.0_f64, tilt in -90.0..90.0_f64,
            field_of_view_deg in 0.001..170.0_f64, column in 0.0..39.0_f64, row in 0.0..29.0_f64,
        ) {
            let perspective = Perspective { eye_voxel: Some(eye_voxel), ..Perspective::new(field_of_view_deg) };
            let mut scene = scene(perspective);
            (scene.view.yaw_deg, scene.view.tilt_deg) = (yaw, tilt);
            let plane = plane(&scene);
            let (origin, ray) = plane.ray(column, row);
            let size = 500.0 * ray.length();
            prop_assert!((plane.point(column, row) - origin - ray).length() < 1e-14 * size);
            prop_assert!((plane.crossing(column, row) - (origin + ray * plane.depth)).length() < 1e-14 * size);
            let at_centre = centre(DIMS, SPACING) - plane.crossing(column, row);
            prop_assert!(at_centre.dot(plane.direction).abs() < 1e-14 * size);
        }
    }
}
