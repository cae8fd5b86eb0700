//! The transfer function: which opacity and colour a value has.

use serde::{Deserialize, Serialize};

use crate::SceneError;
use crate::check::{self, Checked};
use crate::piecewise::{bracket, lerp};

/// The transfer function, linear between its points and constant beyond the first and the last.
///
/// Two points of the same value make a step; the value of the step itself takes the later point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "TransferInFile")]
pub struct Transfer {
    /// Whether a renderer corrects opacity to the length of its steps, by
    /// [`corrected_opacity`](crate::corrected_opacity).
    pub opacity_correction: bool,
    /// The opacity from which a sample is opaque, above 0 and at most 1, for
    /// [`Mode::FirstOpaque`](crate::Mode::FirstOpaque) and
    /// [`Mode::LastOpaque`](crate::Mode::LastOpaque).
    pub opaque_alpha: f64,
    /// Points [value, opacity per unit length], values ascending, opacity 0 to 1; the unit length is
    /// the smallest voxel spacing. Empty where there are layers.
    pub opacity: Vec<[f64; 2]>,
    /// Points of colour, values ascending, at least one.
    pub colour: Vec<ColourPoint>,
    /// Opacity over value and gradient magnitude, instead of `opacity`: linear between layers,
    /// gradients ascending.
    #[serde(rename = "layer", skip_serializing_if = "Vec::is_empty")]
    pub layers: Vec<Layer>,
}

/// The colour of one value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ColourPoint {
    /// The value.
    pub value: f64,
    /// Red, green and blue, 0 to 1.
    pub rgb: [f64; 3],
}

/// Opacity over value at one gradient magnitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// The gradient magnitude, in units of value per voxel, from 0 up.
    pub gradient: f64,
    /// Points [value, opacity per unit length], values ascending, opacity 0 to 1.
    pub opacity: Vec<[f64; 2]>,
}

/// The keys as they may stand in a file, before defaults.
#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct TransferInFile {
    opacity_correction: Option<bool>,
    opaque_alpha: Option<f64>,
    opacity: Option<Vec<[f64; 2]>>,
    colour: Option<Vec<ColourPoint>>,
    #[serde(rename = "layer")]
    layers: Vec<Layer>,
}

impl From<TransferInFile> for Transfer {
    fn from(given: TransferInFile) -> Self {
        let TransferInFile { opacity_correction, opaque_alpha, opacity, colour, layers } = given;
        // A file of layers alone does not mean the default ramp as well.
        let no_opacity = || if layers.is_empty() { default_opacity() } else { Vec::new() };
        Transfer {
            opacity_correction: opacity_correction.unwrap_or(true),
            opaque_alpha: opaque_alpha.unwrap_or(0.5),
            opacity: opacity.unwrap_or_else(no_opacity),
            colour: colour.unwrap_or_else(|| vec![ColourPoint { value: 0.0, rgb: [1.0, 1.0, 1.0] }]),
            layers,
        }
    }
}

/// The paper's: clear up to 80, linear to 0.75 at 100 and the same above, of 255.
fn default_opacity() -> Vec<[f64; 2]> {
    vec![[80.0, 0.0], [100.0, 0.75]]
}

impl Default for Transfer {
    /// The paper's ramp of opacity from 0 at 80 to 0.75 at 100, all white.
    fn default() -> Self {
        TransferInFile::default().into()
    }
}

impl Transfer {
    /// The opacity of a unit length, 0 to 1, of `value` where the gradient has `gradient_magnitude`
    /// (in units of value per voxel; looked at only if the function
    /// [is two-dimensional](Self::is_two_dimensional)). NaN is taken as the smallest.
    pub fn opacity_at(&self, value: f64, gradient_magnitude: f64) -> f64 {
        match bracket(&self.layers, |layer| layer.gradient, gradient_magnitude) {
            None => opacity_between(&self.opacity, value),
            Some((lower, upper, weight)) => {
                lerp(opacity_between(&lower.opacity, value), opacity_between(&upper.opacity, value), weight)
            }
        }
    }

    /// The colour of `value`: red, green and blue, 0 to 1. NaN is taken as the smallest value.
    pub fn colour_at(&self, value: f64) -> [f64; 3] {
        bracket(&self.colour, |point| point.value, value).map_or([0.0; 3], |(lower, upper, weight)| {
            std::array::from_fn(|i| lerp(lower.rgb[i], upper.rgb[i], weight))
        })
    }

    /// Whether opacity depends on the gradient's magnitude.
    pub fn is_two_dimensional(&self) -> bool {
        !self.layers.is_empty()
    }

    /// The gradient magnitude from which opacity does not change any more, in units of value per voxel:
    /// the last layer's, or 0 without layers. A table over gradient needs to reach no further.
    pub fn largest_gradient(&self) -> f64 {
        self.layers.last().map_or(0.0, |layer| layer.gradient)
    }

    pub(crate) fn validate(&self) -> Checked {
        if self.layers.is_empty() {
            validate_opacity("transfer.opacity", &self.opacity)?;
        } else if !self.opacity.is_empty() {
            return Err(SceneError::at(
                "transfer.opacity",
                "opacity is given by value alone and by layers too",
                "give only one of `opacity` and `[[transfer.layer]]`",
            ));
        }
        check::ascending(self.layers.iter().map(|layer| layer.gradient), |i| format!("transfer.layer[{i}].gradient"))?;
        for (i, layer) in self.layers.iter().enumerate() {
            validate_opacity(&format!("transfer.layer[{i}].opacity"), &layer.opacity)?;
        }
        not_empty("transfer.colour", self.colour.len())?;
        check::ascending(self.colour.iter().map(|point| point.value), |i| format!("transfer.colour[{i}].value"))
    }
}

fn opacity_between(points: &[[f64; 2]], value: f64) -> f64 {
    bracket(points, |point| point[0], value).map_or(0.0, |(lower, upper, weight)| lerp(lower[1], upper[1], weight))
}

fn validate_opacity(key: &str, points: &[[f64; 2]]) -> Checked {
    not_empty(key, points.len())?;
    check::ascending(points.iter().map(|point| point[0]), |i| format!("{key}[{i}][0]"))
}

fn not_empty(key: &str, len: usize) -> Checked {
    if len > 0 {
        return Ok(());
    }
    Err(SceneError::at(key, "the list is empty", "give at least one point"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use cube3_cases::cases;
    use proptest::prelude::*;

    fn of(opacity: &[[f64; 2]]) -> Transfer {
        Transfer { opacity: opacity.to_vec(), ..Transfer::default() }
    }

    #[test]
    fn the_default_is_the_papers_ramp() {
        let transfer = Transfer::default();
        for (value, opacity) in [(0.0, 0.0), (80.0, 0.0), (90.0, 0.375), (100.0, 0.75), (255.0, 0.75)] {
            assert_eq!(transfer.opacity_at(value, 0.0), opacity, "at {value}");
            assert_eq!(transfer.opacity_at(value, 1e9), opacity, "gradients do not matter");
        }
        assert_eq!(transfer.colour_at(17.0), [1.0; 3]);
        assert!(!transfer.is_two_dimensional());
        assert_eq!(transfer.largest_gradient(), 0.0);
    }

    #[test]
    fn a_step_takes_the_later_point_at_its_value() {
        let transfer = of(&[[10.0, 0.2], [10.0, 0.9]]);
        assert_eq!(transfer.opacity_at(10_f64.next_down(), 0.0), 0.2);
        assert_eq!(transfer.opacity_at(10.0, 0.0), 0.9);
        assert_eq!(transfer.opacity_at(11.0, 0.0), 0.9);
    }

    #[test]
    fn opacity_is_linear_between_layers_and_constant_beyond() {
        let transfer = Transfer {
            opacity: vec![],
            layers: vec![
                Layer { gradient: 10.0, opacity: vec![[0.0, 0.0], [100.0, 0.4]] },
                Layer { gradient: 30.0, opacity: vec![[0.0, 0.8]] },
            ],
            ..Transfer::default()
        };
        assert!(transfer.validate().is_ok() && transfer.is_two_dimensional());
        assert_eq!(transfer.largest_gradient(), 30.0);
        for (gradient, opacity) in [(0.0, 0.2), (10.0, 0.2), (20.0, 0.5), (30.0, 0.8), (99.0, 0.8)] {
            assert!((transfer.opacity_at(50.0, gradient) - opacity).abs() < 1e-15, "at {gradient}");
        }
    }

    #[test]
    fn colour_is_linear_between_points() {
        let transfer = Transfer {
            colour: vec![
                ColourPoint { value: 0.0, rgb: [1.0, 0.0, 0.5] },
                ColourPoint { value: 4.0, rgb: [0.0, 1.0, 0.5] },
            ],
            ..Transfer::default()
        };
        assert_eq!(transfer.colour_at(1.0), [0.75, 0.25, 0.5]);
        assert_eq!(transfer.colour_at(-1.0), [1.0, 0.0, 0.5]);
        assert_eq!(transfer.colour_at(5.0), [0.0, 1.0, 0.5]);
    }

    #[test]
    fn each_fault_is_named_by_its_key() {
        let scene = |transfer| Scene { transfer, ..Scene::default() };
        let key = |transfer: Transfer| scene(transfer).validate().unwrap_err().key().to_owned();
        assert_eq!(key(of(&[])), "transfer.opacity");
        assert_eq!(key(of(&[[5.0, 0.0], [4.0, 0.0]])), "transfer.opacity[1][0]");
        assert_eq!(key(of(&[[5.0, 0.0], [6.0, 1.1]])), "transfer.opacity[1][1]");
        assert_eq!(key(of(&[[f64::NAN, 0.0]])), "transfer.opacity[0][0]");
        assert_eq!(key(of(&[[0.0, f64::NAN]])), "transfer.opacity[0][1]");
        let base = Transfer::default;
        assert_eq!(key(Transfer { opaque_alpha: 0.0, ..base() }), "transfer.opaque_alpha");
        assert_eq!(key(Transfer { colour: vec![], ..base() }), "transfer.colour");
        let at = |gradient| vec![Layer { gradient, opacity: vec![[0.0, 0.0]] }];
        assert_eq!(key(Transfer { layers: at(1.0), ..base() }), "transfer.opacity");
        let layers = at(-1.0);
        let two_dimensional = Transfer { layers, opacity: vec![], ..base() };
        assert_eq!(key(two_dimensional), "transfer.layer[0].gradient");
        let colour = vec![ColourPoint { value: 0.0, rgb: [0.0, 2.0, 0.0] }];
        assert_eq!(key(Transfer { colour, ..base() }), "transfer.colour[0].rgb[1]");
    }

    proptest! {
        #![proptest_config(cases(256))]

        #[test]
        fn opacity_stays_in_range_and_meets_its_points(
            mut points in prop::collection::vec((-1e3..1e3_f64, 0.0..=1.0_f64), 1..8),
            value in prop_oneof![-2e3..2e3_f64, Just(f64::MAX), Just(f64::MIN), Just(f64::NAN)],
        ) {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let transfer = of(&points.iter().map(|p| [p.0, p.1]).collect::<Vec<_>>());
            prop_assert!(transfer.validate().is_ok());
            prop_assert!((0.0..=1.0).contains(&transfer.opacity_at(value, 0.0)));
            for (value, opacity) in points {
                prop_assert_eq!(transfer.opacity_at(value, 0.0), opacity);
            }
        }
    }
}
