//! Files of a run. They are all made before the first is written, and each appears whole or not at all.

use crate::problem::{Outcome, Problem};
use crate::run::RunResult;
use cube3_host::MachineSpec;
use cube3_metrics::Picture;
use cube3_report::{Figure, html, png_rgb8, to_json, to_rgb8};
use cube3_scene::Scene;
use std::path::Path;

/// Writes report, pictures, and the resolved scene and machine into a folder, which is made if it is not there. Pictures that
/// an earlier run left there and this one did not make are removed.
///
/// # Errors
/// What cannot be written, with its path.
pub fn write_run(folder: &Path, result: &RunResult, scene: &Scene, machine: &MachineSpec) -> Outcome<Vec<String>> {
    let pictures = &result.pictures;
    let factor = result.report.error.as_ref().map_or(1.0, |error| error.difference_factor);
    let magnified = format!("Absolute difference, magnified {factor} times.");
    let against = result.report.error.as_ref().map_or("", |error| error.against.as_str());
    let reference = format!("The reference: {against}, in 64-bit reals.");
    let figures = [
        ("image.png", "Picture", "The base plane, warped by the host.", &pictures.image),
        ("base_plane.png", "Base plane", "What the machine sends: a pixel for each ray.", &pictures.base_plane),
        ("reference.png", "Reference", reference.as_str(), &pictures.reference),
        ("difference.png", "Difference", magnified.as_str(), &pictures.difference),
    ];
    let mut files: Vec<(&str, Vec<u8>)> = Vec::new();
    let mut shown = Vec::new();
    let mut not_made = Vec::new();
    for (name, title, caption, picture) in figures {
        if let Some(picture) = picture {
            files.push((name, png(picture)?));
            shown.push((files.len() - 1, title, caption));
        } else {
            not_made.push(name);
        }
    }
    let page: Vec<Figure> =
        shown.iter().map(|&(i, title, caption)| Figure { title, caption, png: &files[i].1 }).collect();
    let page = html(&result.report, &page);
    files.push(("report.html", page.into_bytes()));
    files.push(("report.json", to_json(&result.report)?.into_bytes()));
    files.push(("scene.toml", scene.to_toml()?.into_bytes()));
    files.push(("machine.toml", machine.to_toml().into_bytes()));
    let failed = |path: &Path, error: std::io::Error| {
        Problem::new(format!("{}: {error}; give another folder with --out", path.display()))
    };
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    let mut written = Vec::new();
    for (name, bytes) in &files {
        let path = folder.join(name);
        replace(&path, bytes).map_err(|error| failed(&path, error))?;
        written.push(path.display().to_string());
    }
    // A picture of an earlier run beside this report would be taken for this run's.
    for path in not_made.iter().map(|name| folder.join(name)) {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(failed(&path, error)),
            _ => {}
        }
    }
    Ok(written)
}

/// Writes a file that a person has named, whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Outcome<()> {
    replace(path, bytes).map_err(|error| {
        Problem::new(format!("{}: {error}; give a file in a folder that can be written", path.display()))
    })
}

/// Writes beside the file first, so that it appears at once.
fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    let name = path.file_name().ok_or_else(|| std::io::Error::other("this is no name for a file"))?;
    let part = path.with_file_name(format!(".{}.part", name.to_string_lossy()));
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path))
}

fn png(picture: &Picture) -> Outcome<Vec<u8>> {
    Ok(png_rgb8(picture.width, picture.height, &to_rgb8(picture))?)
}
