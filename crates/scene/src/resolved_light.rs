//! The lights as a view sees them.

use glam::DVec3;

use crate::unit_vector::unit_vector;
use crate::{Light, Scene, ViewFrame};

/// A light and the eye are opposite to each other when their unit vectors add to less than this: the
/// sum is rounding error then, and its direction means nothing.
const OPPOSITE: f64 = 1e-12;

/// A light as one view sees it, or one ray of a perspective view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResolvedLight {
    /// Towards the light, of unit length.
    pub direction: DVec3,
    /// Halfway between the light and the eye, of unit length; zero where they are opposite.
    pub halfway: DVec3,
    /// Red, green and blue, 0 to 1.
    pub colour: [f64; 3],
}

/// The lights of `scene` as the view `frame` sees them, in the scene's order.
///
/// A light whose direction is zero or not finite, which [`Scene::validate`] rejects, has zero vectors
/// and lights nothing. In perspective these are the lights of the ray through the picture's centre; [`turn_lights`]
/// makes those of another.
pub fn resolve_lights(scene: &Scene, frame: &ViewFrame) -> Vec<ResolvedLight> {
    let resolve = |light: &Light| {
        let direction = light.direction.and_then(|direction| unit_vector(DVec3::from(direction))).unwrap_or_default();
        ResolvedLight { direction, halfway: DVec3::ZERO, colour: light.colour }
    };
    let mut lights: Vec<ResolvedLight> = scene.lights.iter().map(resolve).collect();
    turn_lights(scene, frame.direction, &mut lights);
    lights
}

/// Makes `lights`, which are `scene`'s from [`resolve_lights`], those that a ray along `direction` sees, of unit
/// length: a light at the eye shines along the ray, and what is halfway follows the eye.
pub fn turn_lights(scene: &Scene, direction: DVec3, lights: &mut [ResolvedLight]) {
    let eye = DVec3::ZERO - direction;
    for (light, resolved) in scene.lights.iter().zip(lights) {
        if light.direction.is_none() {
            (resolved.direction, resolved.halfway) = (eye, eye);
        } else {
            resolved.halfway = halfway(resolved.direction, eye);
        }
    }
}

/// Halfway between two unit vectors; zero where they are opposite, or the light's is none.
fn halfway(light: DVec3, eye: DVec3) -> DVec3 {
    let sum = light + eye;
    if light == DVec3::ZERO || sum.length() < OPPOSITE { DVec3::ZERO } else { unit_vector(sum).unwrap_or_default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::View;

    fn resolved(direction: Option<[f64; 3]>, view: View) -> ResolvedLight {
        let light = Light { direction, colour: [0.1, 0.2, 0.3] };
        let scene = Scene { lights: vec![light], view, ..Scene::default() };
        let lights = resolve_lights(&scene, &scene.view.frame().unwrap());
        assert_eq!(lights.len(), 1);
        assert_eq!(lights[0].colour, [0.1, 0.2, 0.3]);
        lights[0]
    }

    #[test]
    fn a_light_at_the_eye_is_towards_the_viewer() {
        let light = resolved(None, View::from_angles(0.0, 0.0));
        assert_eq!((light.direction, light.halfway), (DVec3::NEG_Y, DVec3::NEG_Y));
    }

    #[test]
    fn a_light_from_above_has_its_halfway_between() {
        let light = resolved(Some([0.0, 0.0, 5.0]), View::from_angles(0.0, 0.0));
        assert_eq!(light.direction, DVec3::Z);
        assert!((light.halfway - DVec3::new(0.0, -1.0, 1.0).normalize()).length() < 1e-15);
    }

    #[test]
    fn a_light_opposite_to_the_eye_has_no_halfway() {
        for (yaw, tilt) in (0..360).flat_map(|yaw| [(yaw, 0), (yaw, 7), (yaw, -61)]) {
            let view = View::from_angles(f64::from(yaw), f64::from(tilt));
            let away = view.frame().unwrap().direction * 3.7;
            let light = resolved(Some(away.to_array()), view);
            assert_eq!(light.halfway, DVec3::ZERO);
            assert!(light.direction.dot(away) > 3.6);
        }
    }

    #[test]
    fn lights_turned_to_a_ray_are_those_of_a_view_along_it() {
        let given = [None, Some([3.0, -1.0, 0.5]), Some([0.0, 0.0, 0.0]), Some([0.0, 2.0, 0.0])];
        let lights = given.map(|direction| Light { direction, ..Light::default() }).to_vec();
        let scene = Scene { lights, ..Scene::default() };
        let mut turned = resolve_lights(&scene, &scene.view.frame().unwrap());
        for (yaw, tilt) in [(0.0, 0.0), (180.0, 0.0), (33.0, -71.0), (30.0, 7.0)] {
            let frame = View::from_angles(yaw, tilt).frame().unwrap();
            turn_lights(&scene, frame.direction, &mut turned);
            assert_eq!(turned, resolve_lights(&scene, &frame));
        }
    }

    #[test]
    fn a_light_without_a_direction_lights_nothing() {
        for bad in [[0.0; 3], [f64::NAN, 0.0, 1.0]] {
            let light = resolved(Some(bad), View::default());
            assert_eq!((light.direction, light.halfway), (DVec3::ZERO, DVec3::ZERO));
        }
    }
}
