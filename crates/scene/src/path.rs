//! How the view moves over a sequence of frames.

use serde::{Deserialize, Serialize};
use strum::{IntoStaticStr, VariantArray};

use crate::check::{self, Checked};
use crate::{SceneError, View};

/// The most key frames of a path.
pub const MOST_KEYS: usize = 10_000;

/// How the view moves over a sequence of frames: a turntable or key frames, exactly one of them.
///
/// On a turntable, frame f of N has the view's own angles and a yaw of `yaw_deg + turntable_deg·f/N`, so a whole turn brings
/// frame N back to frame 0 and an animation repeats without a seam.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Path {
    /// Turn of the eye about +z over all frames, in degrees; negative turns the other way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turntable_deg: Option<f64>,
    /// How the angles go from key to key.
    pub interpolation: Interpolation,
    /// Views at certain frames, in ascending order; constant before the first and after the last.
    #[serde(rename = "key", skip_serializing_if = "Vec::is_empty")]
    pub keys: Vec<PathKey>,
}

/// How angles go from one key to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, IntoStaticStr, VariantArray)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Interpolation {
    /// Each angle changes evenly between two keys, and its speed jumps at a key.
    #[default]
    Linear,
    /// Cubic pieces whose speed at a key is the mean speed between the keys beside it, and 0 at the first and the last: no
    /// jump of speed; between keys an angle may go a little beyond both.
    Smooth,
}

/// The view at one frame. An angle that is not given is that of the scene's view.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PathKey {
    /// The frame, from 0; fractions lie between frames.
    pub frame: f64,
    /// As in the view, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub yaw_deg: Option<f64>,
    /// As in the view, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_deg: Option<f64>,
    /// As in the view, in degrees.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub roll_deg: Option<f64>,
}

impl Path {
    /// A turn of the eye by so many degrees over all frames.
    pub fn turntable(turntable_deg: f64) -> Path {
        Path { turntable_deg: Some(turntable_deg), ..Path::default() }
    }

    /// The view of frame `frame`, from 0, of a sequence of `frames`; what is not an angle is as in `view`.
    pub fn view_at(&self, view: &View, frame: usize, frames: usize) -> View {
        if let Some(turn) = self.turntable_deg {
            return View { yaw_deg: view.yaw_deg + turn * frame as f64 / frames.max(1) as f64, ..view.clone() };
        }
        let angle = |of: fn(&PathKey) -> Option<f64>, own: f64| {
            let values: Vec<[f64; 2]> = self.keys.iter().map(|key| [key.frame, of(key).unwrap_or(own)]).collect();
            self.interpolation.value(&values, frame as f64).unwrap_or(own)
        };
        View {
            yaw_deg: angle(|key| key.yaw_deg, view.yaw_deg),
            tilt_deg: angle(|key| key.tilt_deg, view.tilt_deg),
            roll_deg: angle(|key| key.roll_deg, view.roll_deg),
            ..view.clone()
        }
    }

    pub(crate) fn validate(&self, view: &View) -> Checked {
        if view.direction.is_some() {
            return Err(SceneError::at(
                "path",
                "a path turns angles, and the view is given by a direction",
                "give the view by `yaw_deg`, `tilt_deg` and `roll_deg`, or leave the path out",
            ));
        }
        match (self.turntable_deg, self.keys.is_empty()) {
            (None, true) => {
                return Err(SceneError::at(
                    "path",
                    "the path leads nowhere",
                    "give `turntable_deg`, or key frames as [[path.key]]",
                ));
            }
            (Some(_), false) => {
                return Err(SceneError::at(
                    "path.turntable_deg",
                    "a turntable and key frames are both given",
                    "give only one of `turntable_deg` and [[path.key]]",
                ));
            }
            _ => {}
        }
        check::at_most("path.key", self.keys.len(), MOST_KEYS)?;
        for (i, pair) in self.keys.windows(2).enumerate() {
            let [before, key] = [pair[0].frame, pair[1].frame];
            if key <= before {
                return Err(SceneError::at(
                    format!("path.key[{}].frame", i + 1),
                    format!("frame {key} comes after frame {before}"),
                    "give the keys in ascending order, each frame once",
                ));
            }
        }
        Ok(())
    }
}

impl Interpolation {
    /// The value at `x` of points [x, y] in ascending order of x; none where there are no points.
    fn value(self, points: &[[f64; 2]], x: f64) -> Option<f64> {
        let after = points.partition_point(|point| point[0] <= x);
        let (Some(&first), Some(&last)) = (points.first(), points.last()) else {
            return None;
        };
        if after == 0 {
            return Some(first[1]);
        }
        if after == points.len() {
            return Some(last[1]);
        }
        let ([x0, y0], [x1, y1]) = (points[after - 1], points[after]);
        let t = (x - x0) / (x1 - x0);
        if t == 0.0 {
            return Some(y0);
        }
        Some(match self {
            Interpolation::Linear => y0 + (y1 - y0) * t,
            Interpolation::Smooth => {
                // Hermite's cubic, its slopes those of the chords over each key.
                let slope = |i: usize| {
                    if i == 0 || i + 1 == points.len() {
                        return 0.0;
                    }
                    (points[i + 1][1] - points[i - 1][1]) / (points[i + 1][0] - points[i - 1][0])
                };
                let (m0, m1) = (slope(after - 1) * (x1 - x0), slope(after) * (x1 - x0));
                let ease = t * t * (3.0 - 2.0 * t);
                y0 + (y1 - y0) * ease + m0 * t * (1.0 - t) * (1.0 - t) - m1 * t * t * (1.0 - t)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use cube3_cases::cases;
    use proptest::prelude::*;

    fn yaw_keys(keys: &[[f64; 2]], interpolation: Interpolation) -> Path {
        let keys = keys.iter().map(|&[frame, yaw]| PathKey { frame, yaw_deg: Some(yaw), ..PathKey::default() });
        Path { interpolation, keys: keys.collect(), ..Path::default() }
    }

    #[test]
    fn a_whole_turn_comes_back_to_the_bits_of_its_first_frame() {
        let view = View { roll_deg: 3.0, ..View::from_angles(30.0, 7.0) };
        for (turn, frames, back) in [(360.0, 12, 12), (-360.0, 7, 7), (720.0, 8, 4), (1080.0, 9, 6)] {
            let at = |frame| Path::turntable(turn).view_at(&view, frame, frames).frame().unwrap();
            assert_eq!(at(0), view.frame().unwrap());
            assert_eq!(at(back), at(0), "{turn} over {frames}");
            assert_ne!(at(1), at(0));
        }
    }

    #[test]
    fn linear_keys_are_exact_at_the_keys_even_between_and_constant_beyond() {
        let path = yaw_keys(&[[2.0, 10.0], [6.0, 50.0], [8.0, -30.0]], Interpolation::Linear);
        let yaw = |frame| path.view_at(&View::from_angles(0.0, 5.0), frame, 12).yaw_deg;
        assert_eq!([0, 2, 3, 4, 6, 7, 8, 11].map(yaw), [10.0, 10.0, 20.0, 30.0, 50.0, 10.0, -30.0, -30.0]);
        assert_eq!(path.view_at(&View::from_angles(0.0, 5.0), 3, 12).tilt_deg, 5.0, "what no key gives is the view's");
    }

    #[test]
    fn mistakes_are_named() {
        let error = |path: &str| Scene::from_toml(&format!("schema = 1\n{path}"), "s.toml").unwrap_err().to_string();
        for (path, expected) in [
            ("[path]\n", "s.toml:2: path: the path leads nowhere"),
            ("[path]\nturntable = 360", "there is no key `turntable`"),
            ("[path]\nturntable_deg = nan", "path.turntable_deg"),
            ("[path]\nturntable_deg = 1.0\n[[path.key]]\nframe = 0.0", "both given"),
            ("[[path.key]]\nframe = 3.0\n[[path.key]]\nframe = 3.0", "path.key[1].frame: frame 3 comes after frame 3"),
            (
                "[[path.key]]\nframe = -1.0",
                "path.key[0].frame: -1.0 is outside 0 to 1e9 frames; the nearest legal value is 0.0",
            ),
            ("[[path.key]]\nyaw_deg = 1.0", "frame"),
            ("[[path.key]]\nframe = 0.0\nyaw = 1.0", "there is no key `yaw`"),
            ("[view]\ndirection = [0.0, 1.0, 0.0]\n[path]\nturntable_deg = 9.0", "given by a direction"),
            ("[path]\ninterpolation = \"spline\"\nturntable_deg = 9.0", "linear"),
        ] {
            let found = error(path);
            assert!(found.contains(expected), "{path}: {found}");
        }
    }

    #[test]
    fn a_path_is_written_and_read_back() {
        let mut scene = Scene { path: Some(Path::turntable(-90.0)), ..Scene::default() };
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap(), "s").unwrap(), scene);
        scene.path = Some(yaw_keys(&[[0.0, 1.0], [2.5, 3.0]], Interpolation::Smooth));
        assert_eq!(Scene::from_toml(&scene.to_toml().unwrap(), "s").unwrap(), scene);
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn smooth_paths_meet_their_keys_without_a_jump_of_speed_and_are_straight_where_keys_are(
            gaps in proptest::collection::vec((0.5..5.0_f64, -90.0..90.0_f64), 2..6), speed in -20.0..20.0_f64,
        ) {
            let mut x = 0.0;
            let points: Vec<[f64; 2]> = gaps.iter().map(|&(gap, y)| { x += gap; [x, y] }).collect();
            let smooth = |points: &[[f64; 2]], x: f64| Interpolation::Smooth.value(points, x).unwrap();
            for [x, y] in &points {
                prop_assert_eq!(smooth(&points, *x), *y);
                let h = 1e-6;
                let [before, after] = [y - smooth(&points, x - h), smooth(&points, x + h) - y];
                prop_assert!((before - after).abs() < 1e-3 * h.sqrt(), "{} and {}", before, after);
            }
            // Keys on a line: between two inner keys the cubic is the line.
            let line: Vec<[f64; 2]> = points.iter().map(|p| [p[0], speed * p[0]]).collect();
            for pair in line.windows(2).skip(1).take(line.len().saturating_sub(3)) {
                let x = (pair[0][0] + pair[1][0]) / 2.0;
                prop_assert!((smooth(&line, x) - speed * x).abs() < 1e-9);
            }
        }
    }
}
