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
}

pub(crate) fn serialize<S: Serializer>(error: &Option<ImageError>, serializer: S) -> Result<S::Ok, S::Error> {
    let measures = error.map_or_else(Measures::default, |error| Measures {
        mean_relative: Some(error.mean_relative),
        rms: Some(error.rms),
        max: Some(error.max),
        psnr_db: error.psnr_db,
        fraction_off: Some(error.fraction_off),
    });
    measures.serialize(serializer)
}

pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<ImageError>, D::Error> {
    let Measures { mean_relative, rms, max, psnr_db, fraction_off } = Measures::deserialize(deserializer)?;
    let numbers = (mean_relative, rms, max, fraction_off);
    if let (Some(mean_relative), Some(rms), Some(max), Some(fraction_off)) = numbers {
        return Ok(Some(ImageError { mean_relative, rms, max, psnr_db, fraction_off }));
    }
    match numbers {
        (None, None, None, None) => Ok(None),
        _ => Err(serde::de::Error::custom("of mean_relative, rms, max and fraction_off all are numbers, or none")),
    }
}
