//! From where the volume is seen.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::angle::sin_cos_degrees;
use crate::check::{self, Checked};
use crate::unit_vector::unit_vector;
use crate::{Perspective, SceneError};

/// `up` may come this near to the line of sight: the sine of the angle between them.
const LEAST_SINE_TO_UP: f64 = 1e-6;

/// From where the volume is seen: by two angles and a roll, or by a direction, which overrides them.
///
/// With yaw a and tilt e, the eye lies at (sin a·cos e, −cos a·cos e, sin e) from the centre of
/// the volume: yaw 0 and tilt 0 look along +y with +z up and +x to the right, yaw turns the eye towards
/// +x, tilt lifts it towards +z. A file may give the angles or `direction`, not both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "ViewInFile", into = "ViewInFile")]
pub struct View {
    /// Turn of the eye about +z, in degrees, any finite number.
    pub yaw_deg: f64,
    /// Height of the eye over the horizon, in degrees; beyond ±90 it passes over the pole and the
    /// volume hangs head down.
    pub tilt_deg: f64,
    /// Turn of the picture's content about its centre, clockwise as it is seen, in degrees.
    pub roll_deg: f64,
    /// From the eye into the scene, in world coordinates, of any length but 0. Where it is given, the
    /// three angles mean nothing and are not written to files.
    pub direction: Option<[f64; 3]>,
    /// What is up in the picture, with `direction` only: any vector not along it. `None` means +z, and
    /// what that tends to from yaw 0 when the view is along z: +y looking down, −y looking up.
    pub up: Option<[f64; 3]>,
    /// Rays from an eye; `None` means parallel ones.
    pub perspective: Option<Perspective>,
}

/// The keys as they stand in a file.
#[derive(Serialize, Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct ViewInFile {
    #[serde(skip_serializing_if = "Option::is_none")]
    yaw_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tilt_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    roll_deg: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    direction: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    up: Option<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    perspective: Option<Perspective>,
}

impl TryFrom<ViewInFile> for View {
    type Error = &'static str;

    fn try_from(given: ViewInFile) -> Result<Self, &'static str> {
        let ViewInFile { yaw_deg, tilt_deg, roll_deg, direction, up, perspective } = given;
        if direction.is_some() && (yaw_deg.is_some() || tilt_deg.is_some() || roll_deg.is_some()) {
            return Err("a direction and angles are both given; \
                give `direction` (and `up`), or `yaw_deg`, `tilt_deg` and `roll_deg`, not both");
        }
        let default = View::default();
        Ok(View {
            yaw_deg: yaw_deg.unwrap_or(default.yaw_deg),
            tilt_deg: tilt_deg.unwrap_or(default.tilt_deg),
            roll_deg: roll_deg.unwrap_or(default.roll_deg),
            direction,
            up,
            perspective,
        })
    }
}

impl From<View> for ViewInFile {
    fn from(view: View) -> Self {
        let angle = |angle_deg| view.direction.is_none().then_some(angle_deg);
        ViewInFile {
            yaw_deg: angle(view.yaw_deg),
            tilt_deg: angle(view.tilt_deg),
            roll_deg: angle(view.roll_deg),
            direction: view.direction,
            up: view.up,
            perspective: view.perspective,
        }
    }
}

impl Default for View {
    /// Yaw 30°, tilt 7°: the tilt of the paper's figure 14.
    fn default() -> Self {
        View::from_angles(30.0, 7.0)
    }
}

/// The axes of the picture in world space: orthogonal and of unit length; `right` = `direction` × `up`.
///
/// No component is −0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ViewFrame {
    /// From the eye into the scene.
    pub direction: DVec3,
    /// To the right in the picture.
    pub right: DVec3,
    /// Up in the picture.
    pub up: DVec3,
}

impl View {
    /// The view at these angles, without roll.
    pub fn from_angles(yaw_deg: f64, tilt_deg: f64) -> Self {
        View { yaw_deg, tilt_deg, roll_deg: 0.0, direction: None, up: None, perspective: None }
    }

    /// The view along `direction`, from the eye into the scene, with `up` upwards or +z if `None`.
    pub fn from_direction(direction: [f64; 3], up: Option<[f64; 3]>) -> Self {
        View { direction: Some(direction), up, ..View::default() }
    }

    /// The axes of the picture.
    ///
    /// Symmetric angles give symmetric axes to the bit: multiples of 90° components of 0 and ±1,
    /// a yaw of 45° two components of equal magnitude.
    ///
    /// # Errors
    ///
    /// An angle that is not finite, a vector that is zero or not finite, or an `up` within 10⁻⁶ of the
    /// line of sight.
    pub fn frame(&self) -> Result<ViewFrame, SceneError> {
        let frame = match self.direction {
            Some(direction) => along(direction, self.up)?,
            None => self.at_angles()?,
        };
        // Adding +0 turns −0 into +0, so that two ways to one view make the same bits.
        Ok(ViewFrame {
            direction: frame.direction + DVec3::ZERO,
            right: frame.right + DVec3::ZERO,
            up: frame.up + DVec3::ZERO,
        })
    }

    /// The axes from the angles. `up` is the eye's derivative by tilt, and `right` by yaw, over cos e:
    /// closed forms that need no hint and do not degenerate at the poles.
    fn at_angles(&self) -> Result<ViewFrame, SceneError> {
        check::finite("view.yaw_deg", self.yaw_deg)?;
        check::finite("view.tilt_deg", self.tilt_deg)?;
        check::finite("view.roll_deg", self.roll_deg)?;
        let (sin_a, cos_a) = sin_cos_degrees(self.yaw_deg);
        let (sin_e, cos_e) = sin_cos_degrees(self.tilt_deg);
        let (sin_r, cos_r) = sin_cos_degrees(self.roll_deg);
        let direction = DVec3::new(-sin_a * cos_e, cos_a * cos_e, -sin_e);
        let right = DVec3::new(cos_a, sin_a, 0.0);
        let up = DVec3::new(-sin_a * sin_e, cos_a * sin_e, cos_e);
        // The content turns clockwise when the axes turn the other way.
        Ok(ViewFrame { direction, right: right * cos_r + up * sin_r, up: up * cos_r - right * sin_r })
    }

    pub(crate) fn validate(&self) -> Checked {
        if self.up.is_some() && self.direction.is_none() {
            return Err(SceneError::at(
                "view.up",
                "up is given without a direction",
                "give `direction` too, or `roll_deg` instead of `up`",
            ));
        }
        self.frame()?;
        self.perspective.as_ref().map_or(Ok(()), Perspective::validate)
    }
}

/// The axes of a view along `direction`.
fn along(direction: [f64; 3], up: Option<[f64; 3]>) -> Result<ViewFrame, SceneError> {
    let direction = checked_unit("view.direction", direction)?;
    let right = match up {
        // Across +z, whatever the slope: the horizontal part of the direction, turned by 90°.
        None => unit_vector(DVec3::new(direction.y, -direction.x, 0.0)).unwrap_or(DVec3::X),
        Some(up) => {
            let across = direction.cross(checked_unit("view.up", up)?);
            if across.length() < LEAST_SINE_TO_UP {
                return Err(SceneError::at(
                    "view.up",
                    "up lies along the line of sight",
                    "give a vector that points across `direction`",
                ));
            }
            across / across.length()
        }
    };
    Ok(ViewFrame { direction, right, up: right.cross(direction) })
}

fn checked_unit(key: &str, vector: [f64; 3]) -> Result<DVec3, SceneError> {
    check::direction(key, vector)?;
    Ok(unit_vector(DVec3::from(vector)).unwrap_or_default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_cases::cases;
    use proptest::prelude::*;

    fn frame(yaw_deg: f64, tilt_deg: f64) -> ViewFrame {
        View::from_angles(yaw_deg, tilt_deg).frame().unwrap()
    }

    #[test]
    fn views_along_the_axes_are_exact() {
        let front = frame(0.0, 0.0);
        assert_eq!((front.direction, front.right, front.up), (DVec3::Y, DVec3::X, DVec3::Z));
        let side = frame(90.0, 0.0);
        assert_eq!((side.direction, side.right, side.up), (DVec3::NEG_X, DVec3::Y, DVec3::Z));
        let top = frame(0.0, 90.0);
        assert_eq!((top.direction, top.right, top.up), (DVec3::NEG_Z, DVec3::X, DVec3::Y));
        let below = frame(0.0, -90.0);
        assert_eq!((below.direction, below.right, below.up), (DVec3::Z, DVec3::X, DVec3::NEG_Y));
    }

    #[test]
    fn at_45_degrees_the_horizontal_components_are_equal() {
        for tilt in [0.0, 7.0, 45.0, -33.3] {
            for yaw in [45.0, 135.0, 225.0, -45.0, 405.0] {
                let ViewFrame { direction, right, up } = frame(yaw, tilt);
                for axis in [direction, right, up] {
                    assert_eq!(axis.x.abs().to_bits(), axis.y.abs().to_bits(), "{yaw} {tilt}");
                }
            }
        }
    }

    #[test]
    fn positive_roll_turns_the_content_clockwise() {
        let rolled = View { roll_deg: 90.0, ..View::from_angles(0.0, 0.0) }.frame().unwrap();
        // What was at the top of the picture, +z, is now at its right.
        assert_eq!(rolled.right, DVec3::Z);
        assert_eq!(rolled.up, DVec3::NEG_X);
        let slightly = View { roll_deg: 10.0, ..View::default() }.frame().unwrap();
        let top = frame(30.0, 7.0).up;
        assert!(top.dot(slightly.right) > 0.17 && top.dot(slightly.up) > 0.98);
    }

    #[test]
    fn views_straight_down_are_the_limit_of_tilted_ones() {
        for yaw in [0.0, 17.0, 90.0, 200.0] {
            let (pole, near) = (frame(yaw, 90.0), frame(yaw, 90.0 - 1e-9));
            assert!((pole.up - near.up).length() < 1e-10);
            assert!((pole.right - near.right).length() < 1e-10);
        }
    }

    #[test]
    fn a_direction_overrides_the_angles() {
        let view = View { direction: Some([0.0, 0.0, -3.0]), ..View::from_angles(77.0, 12.0) };
        assert_eq!(view.frame().unwrap(), frame(0.0, 90.0));
        let view = View::from_direction([0.0, 0.0, 1e-300], None);
        assert_eq!(view.frame().unwrap(), frame(0.0, -90.0));
        let view = View::from_direction([1.0, 1.0, 0.0], Some([0.0, 0.0, 9.0]));
        let frame = view.frame().unwrap();
        assert_eq!(frame.direction.x, frame.direction.y);
        assert_eq!(frame.up, DVec3::Z);
    }

    #[test]
    fn no_component_is_negative_zero() {
        for yaw in [0.0, -0.0, 90.0, 180.0, -90.0] {
            for tilt in [0.0, -0.0, 90.0, -90.0] {
                let ViewFrame { direction, right, up } = frame(yaw, tilt);
                for component in [direction, right, up].map(|axis| axis.to_array()).concat() {
                    assert!(component.to_bits() != (-0.0_f64).to_bits(), "{yaw} {tilt}");
                }
            }
        }
    }

    #[test]
    fn vectors_without_direction_are_errors_that_name_their_key() {
        let key = |view: View| view.frame().unwrap_err().key().to_owned();
        assert_eq!(key(View::from_angles(f64::NAN, 0.0)), "view.yaw_deg");
        assert_eq!(key(View::from_angles(0.0, f64::INFINITY)), "view.tilt_deg");
        assert_eq!(key(View::from_direction([0.0; 3], None)), "view.direction");
        assert_eq!(key(View::from_direction([0.0, f64::NAN, 1.0], None)), "view.direction[1]");
        assert_eq!(key(View::from_direction([1.0, 2.0, 3.0], Some([0.0; 3]))), "view.up");
        assert_eq!(key(View::from_direction([1.0, 2.0, 3.0], Some([-2.0, -4.0, -6.0]))), "view.up");
    }

    fn assert_orthonormal(frame: ViewFrame, tolerance: f64) -> Result<(), TestCaseError> {
        let ViewFrame { direction, right, up } = frame;
        for axis in [direction, right, up] {
            prop_assert!((axis.length() - 1.0).abs() < tolerance);
        }
        prop_assert!((direction.cross(up) - right).length() < tolerance);
        prop_assert!((right.cross(direction) - up).length() < tolerance);
        Ok(())
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn angles_give_orthonormal_axes(
            yaw_deg in -1e6..1e6_f64, tilt_deg in -180.0..180.0_f64, roll_deg in -360.0..360.0_f64,
        ) {
            let view = View { roll_deg, ..View::from_angles(yaw_deg, tilt_deg) };
            assert_orthonormal(view.frame().unwrap(), 1e-14)?;
        }

        #[test]
        fn directions_agree_with_angles(yaw in -180.0..180.0_f64, tilt in -89.0..89.0_f64) {
            let angles = frame(yaw, tilt);
            for up in [None, Some([0.0, 0.0, 1.0])] {
                let direction = (angles.direction * 12.5).to_array();
                let vectors = View::from_direction(direction, up).frame().unwrap();
                assert_orthonormal(vectors, 1e-14)?;
                prop_assert!((vectors.right - angles.right).length() < 1e-13);
                prop_assert!((vectors.up - angles.up).length() < 1e-13);
            }
        }

        #[test]
        fn opposite_angles_are_mirror_images_to_the_bit(
            yaw in -180.0..180.0_f64, tilt in -90.0..90.0_f64,
        ) {
            let (a, b) = (frame(yaw, tilt).direction, frame(-yaw, tilt).direction);
            prop_assert_eq!((a.x, a.y, a.z), (-b.x, b.y, b.z));
            let c = frame(yaw, -tilt).direction;
            prop_assert_eq!((a.x, a.y, a.z), (c.x, c.y, -c.z));
        }
    }
}
