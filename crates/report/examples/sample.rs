//! Writes a made-up report, to look at: `cargo run -p cube3-report --example sample -- DIR`.

#[path = "../tests/all/sample/mod.rs"]
mod sample;

use std::error::Error;
use std::path::PathBuf;

use cube3_picture::Picture;
use cube3_report::{Figure, html, png_rgb8, table, to_json, to_rgb8};

const SIZE: usize = 160;

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "out".into()));
    std::fs::create_dir_all(&folder)?;
    let report = sample::report();
    report.check()?;
    let (image, reference) = (png(&ball(0.0)?)?, png(&ball(0.04)?)?);
    let difference = cube3_metrics::difference(&ball(0.0)?, &ball(0.04)?, 5.0)?;
    let difference = png(&difference)?;
    let figures = [
        Figure { title: "Image", caption: "The machine's base plane, warped", png: &image, still: None },
        Figure { title: "Reference", caption: "image-order, step 1", png: &reference, still: None },
        Figure { title: "Difference", caption: "Magnified 5 times", png: &difference, still: None },
    ];
    std::fs::write(folder.join("report.html"), html(&report, &figures))?;
    std::fs::write(folder.join("report.json"), to_json(&report)?)?;
    print!("{}", table(&report));
    Ok(())
}

fn png(picture: &Picture) -> Result<Vec<u8>, cube3_report::ReportError> {
    png_rgb8(picture.width, picture.height, &to_rgb8(picture))
}

/// A shaded ball, lit from a direction that depends on `turn`.
fn ball(turn: f64) -> Result<Picture, cube3_metrics::MetricsError> {
    let at = |index: usize| {
        let place = |i: usize| (2.0 * i as f64 + 1.0) / SIZE as f64 - 1.0;
        let (x, y) = (place(index % SIZE), place(index / SIZE));
        let depth = 0.7 - x * x - y * y;
        if depth < 0.0 {
            return [0.0; 3];
        }
        let light = (0.1 + 0.6 * depth.sqrt() - (0.5 + turn) * x - 0.4 * y).clamp(0.05, 1.0);
        [light, 0.85 * light, 0.7 * light]
    };
    Ok(Picture::new(SIZE, SIZE, (0..SIZE * SIZE).map(at).collect())?)
}
