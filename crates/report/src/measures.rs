//! The measures of an error in `report.json`: numbers, or all of them `null` where there was nothing to measure.

use cube3_metrics::ImageError;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// The keys of [`ImageError`]. A `psnr_db` of `null` alone is that of equal pictures.
#[derive(Default, Serialize, Deserialize)]
struct Measures {
    mean_relative: Option<f64>,
    rms: Option<f64>,
    max: Option<f64>,
    psnr_db: Option<f64>,
    fraction_off: Option<f64>,
    percentile_99: Option<f64>,
    bias: Option<f64>,
}

/// Every measure that must be finite, with its key.
pub(crate) fn finite(error: &ImageError) -> [(&'static str, f64); 7] {
    [
        ("mean_relative", error.mean_relative),
        ("rms", error.rms),
        ("max", error.max),
        ("psnr_db", error.psnr_db.unwrap_or(0.0)),
        ("fraction_off", error.fraction_off),
        ("percentile_99", error.percentile_99),
        ("bias", error.bias),
    ]
}

pub(crate) fn serialize<S: Serializer>(error: &Option<ImageError>, serializer: S) -> Result<S::Ok, S::Error> {
    let measures = error.map_or_else(Measures::default, |error| Measures {
        mean_relative: Some(error.mean_relative),
        rms: Some(error.rms),
        max: Some(error.max),
        psnr_db: error.psnr_db,
        fraction_off: Some(error.fraction_off),
        percentile_99: Some(error.percentile_99),
        bias: Some(error.bias),
    });
    measures.serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<ImageError>, D::Error> {
    let read = Measures::deserialize(deserializer)?;
    let numbers = [read.mean_relative, read.rms, read.max, read.fraction_off, read.percentile_99, read.bias];
    if let [Some(mean_relative), Some(rms), Some(max), Some(fraction_off), Some(percentile_99), Some(bias)] = numbers {
        return Ok(Some(ImageError {
            psnr_db: read.psnr_db,
            mean_relative,
            rms,
            max,
            fraction_off,
            percentile_99,
            bias,
        }));
    }
    if numbers.iter().all(Option::is_none) {
        return Ok(None);
    }
    let keys = "mean_relative, rms, max, fraction_off, percentile_99 and bias";
    Err(serde::de::Error::custom(format!("of {keys} all are numbers, or none")))
}
