//! The shading model, in real numbers: the one definition that the reference renderers use directly and
//! the machine through tables.

use glam::DVec3;

use crate::{Material, ResolvedLight};

/// The colour of a sample whose transfer function gives it `rgb`, lit after Phong with the halfway
/// vector, before depth cueing; each channel 0 to 1.
///
/// ambient·rgb + Σ colour·(diffuse·(N·L)·rgb + specular·(N·H)^shininess), clamped. `normal` is the unit
/// vector that points away from the material, −∇f/|∇f|; `None` where the gradient vanishes, which leaves
/// the ambient light alone. A two-sided material takes the magnitudes of N·L and N·H; a one-sided one
/// has no light from behind: N·L is at least 0, and where it is 0 nothing is mirrored. A material that
/// is not shaded keeps `rgb`.
pub fn phong(material: &Material, lights: &[ResolvedLight], normal: Option<DVec3>, rgb: [f64; 3]) -> [f64; 3] {
    if !material.shaded {
        return rgb;
    }
    let mut lit = rgb.map(|channel| material.ambient * channel);
    if let Some(normal) = normal {
        for light in lights {
            let (diffuse, specular) = reflected(material, light, normal);
            for i in 0..3 {
                lit[i] += light.colour[i] * (diffuse * rgb[i] + specular);
            }
        }
    }
    lit.map(|channel| channel.clamp(0.0, 1.0))
}

/// How much of `light` is scattered and how much is mirrored to the eye.
fn reflected(material: &Material, light: &ResolvedLight, normal: DVec3) -> (f64, f64) {
    let (mut facing, mut mirroring) = (normal.dot(light.direction), normal.dot(light.halfway));
    if material.two_sided {
        (facing, mirroring) = (facing.abs(), mirroring.abs());
    } else if facing <= 0.0 {
        return (0.0, 0.0);
    }
    let highlight = if mirroring > 0.0 { libm::pow(mirroring, material.shininess) } else { 0.0 };
    (material.diffuse * facing, material.specular * highlight)
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    const GREY: [f64; 3] = [0.5, 0.25, 1.0];

    fn light(direction: DVec3, halfway: DVec3) -> ResolvedLight {
        ResolvedLight { direction, halfway, colour: [1.0; 3] }
    }

    fn at_eye() -> ResolvedLight {
        light(DVec3::NEG_Y, DVec3::NEG_Y)
    }

    fn one_sided() -> Material {
        Material { two_sided: false, ..Material::default() }
    }

    fn assert_close(got: [f64; 3], expected: [f64; 3]) {
        assert!((0..3).all(|i| (got[i] - expected[i]).abs() < 1e-15), "{got:?}, not {expected:?}");
    }

    #[test]
    fn a_surface_at_60_degrees_to_the_eye() {
        let c = 0.5_f64;
        let normal = DVec3::new(0.75_f64.sqrt(), -c, 0.0);
        let expected = GREY.map(|rgb| 0.1 * rgb + 0.7 * c * rgb + 0.2 * c.powi(10));
        assert_close(phong(&Material::default(), &[at_eye()], Some(normal), GREY), expected);
        assert_close(phong(&one_sided(), &[at_eye()], Some(normal), GREY), expected);
    }

    #[test]
    fn lights_add_up_each_in_its_colour() {
        let mut red = at_eye();
        red.colour = [1.0, 0.0, 0.0];
        let mut dim_green = light(DVec3::NEG_Y, DVec3::X);
        dim_green.colour = [0.0, 0.5, 0.0];
        let lit = phong(&Material::default(), &[red, dim_green], Some(DVec3::NEG_Y), [0.5; 3]);
        assert_close(lit, [0.05 + 0.35 + 0.2, 0.05 + 0.5 * 0.35, 0.05]);
    }

    #[test]
    fn without_a_normal_or_lights_only_ambient_light_is_left() {
        let ambient = GREY.map(|rgb| 0.1 * rgb);
        assert_close(phong(&Material::default(), &[at_eye()], None, GREY), ambient);
        assert_close(phong(&Material::default(), &[], Some(DVec3::X), GREY), ambient);
    }

    #[test]
    fn a_material_that_is_not_shaded_keeps_its_colour() {
        let flat = Material { shaded: false, ..Material::default() };
        assert_eq!(phong(&flat, &[at_eye()], Some(DVec3::X), GREY), GREY);
    }

    #[test]
    fn the_back_of_a_one_sided_surface_is_dark() {
        let ambient = GREY.map(|rgb| 0.1 * rgb);
        assert_close(phong(&one_sided(), &[at_eye()], Some(DVec3::Y), GREY), ambient);
        // Light from behind the surface mirrors nothing, though N·H is positive.
        let behind = light(DVec3::X, DVec3::Z);
        let normal = DVec3::new(-0.1, 0.0, 0.99).normalize();
        assert_close(phong(&one_sided(), &[behind], Some(normal), GREY), ambient);
        let front = phong(&Material::default(), &[at_eye()], Some(DVec3::NEG_Y), GREY);
        assert_eq!(phong(&Material::default(), &[at_eye()], Some(DVec3::Y), GREY), front);
    }

    #[test]
    fn a_light_opposite_to_the_eye_mirrors_nothing() {
        let opposite = light(DVec3::Y, DVec3::ZERO);
        let lit = phong(&Material::default(), &[opposite], Some(DVec3::Y), GREY);
        assert_close(lit, GREY.map(|rgb| 0.8 * rgb));
    }

    #[test]
    fn more_than_white_is_white() {
        let lit = phong(&Material::default(), &[at_eye(); 8], Some(DVec3::NEG_Y), [1.0; 3]);
        assert_eq!(lit, [1.0; 3]);
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn two_sided_light_does_not_see_the_normals_sign(
            n in prop::array::uniform3(-1.0..1.0_f64), l in prop::array::uniform3(-1.0..1.0_f64),
            shininess in 0.01..1000.0_f64,
        ) {
            prop_assume!(DVec3::from(n).length() > 0.1 && DVec3::from(l).length() > 0.1);
            let (normal, direction) = (DVec3::from(n).normalize(), DVec3::from(l).normalize());
            let lights = [light(direction, (direction + DVec3::NEG_Y).normalize_or_zero())];
            let material = Material { shininess, ..Material::default() };
            let lit = phong(&material, &lights, Some(normal), GREY);
            prop_assert_eq!(lit, phong(&material, &lights, Some(-normal), GREY));
            prop_assert!(lit.iter().all(|channel| (0.0..=1.0).contains(channel)));
            let one_sided = Material { two_sided: false, ..material };
            let less = phong(&one_sided, &lights, Some(normal), GREY);
            prop_assert!((0..3).all(|i| less[i] <= lit[i]));
        }
    }
}
