//! Files of a run. They are all made before the first is written, and each appears whole or not at all.

use crate::animation::Animation;
use crate::problem::{Outcome, Problem};
use cube3::RunResult;
use cube3::sequence::Shown;
use cube3_machine::MachineSpec;
use cube3_picture::Picture;
use cube3_report::{Figure, html, png_rgb8, to_json, to_rgb8};
use cube3_scene::Scene;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// The animation's file.
pub const ANIMATION: &str = "animation.png";
/// The largest animation that the page carries, in bytes; a larger one is a file beside it alone.
const CARRIED: u64 = 8 << 20;
/// The folder of a sequence's frames.
const FRAMES: &str = "frames";

/// Writes report, pictures, and the resolved scene and machine into a folder, which is made if it is not there. The page shows the
/// `animation` of a sequence, where one is given, before the pictures. Pictures that an earlier run left there and this one did not make are
/// removed.
///
/// # Errors
/// What cannot be written, with its path.
pub fn write_run(
    folder: &Path,
    result: &RunResult,
    animation: Option<&[u8]>,
    scene: &Scene,
    machine: &MachineSpec,
) -> Outcome<Vec<String>> {
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
    let still = shown.iter().map(|&(i, title, caption)| Figure { title, caption, png: &files[i].1, still: None });
    let first = pictures.image.as_ref().and(files.first()).map(|(_, png)| png.as_slice());
    let caption = "All frames one after the other; the other pictures are of the first.";
    let moving = animation.map(|png| Figure { title: "Animation", caption, png, still: first });
    let page: Vec<Figure> = moving.into_iter().chain(still).collect();
    let page = html(&result.report, &page);
    files.push(("report.html", page.into_bytes()));
    files.push(("report.json", to_json(&result.report)?.into_bytes()));
    files.push(("scene.toml", scene.to_toml()?.into_bytes()));
    files.push(("machine.toml", machine.to_toml().into_bytes()));
    let written = write_files(folder, &files)?;
    // A picture of an earlier run beside this report would be taken for this run's.
    for path in not_made.iter().map(|name| folder.join(name)) {
        match std::fs::remove_file(&path) {
            Err(error) if error.kind() != std::io::ErrorKind::NotFound => return Err(failed(&path, error)),
            _ => {}
        }
    }
    if result.report.sequence.is_none() {
        remove_frames(folder, 0)?;
        remove(&folder.join(ANIMATION))?;
    }
    Ok(written)
}

/// Makes the folder of an option, if it is not there.
///
/// # Errors
/// A folder that cannot be made.
pub fn make_folder(folder: &Path, option: &str) -> Outcome<()> {
    if folder.is_file() {
        return Err(Problem::new(format!(
            "{}: this is a file, and files are to be written into a folder; give another one with {option}",
            folder.display()
        )));
    }
    std::fs::create_dir_all(folder).map_err(|error| {
        let path = folder.display();
        Problem::new(format!("{path}: the folder cannot be made: {error}; give another one with {option}"))
    })
}

/// Writes files into a folder, which is made if it is not there, and gives their paths.
///
/// # Errors
/// What cannot be written, with its path.
pub fn write_files(folder: &Path, files: &[(&str, Vec<u8>)]) -> Outcome<Vec<String>> {
    make_folder(folder, "--out")?;
    let write = |(name, bytes): &(&str, Vec<u8>)| {
        let path = folder.join(name);
        cube3_file::write_whole(&path, bytes).map_err(|error| failed(&path, error))?;
        Ok(path.display().to_string())
    };
    files.iter().map(write).collect()
}

/// Writes a file that a person has named, whole or not at all.
///
/// # Errors
/// A file that cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Outcome<()> {
    cube3_file::write_whole(path, bytes).map_err(|error| {
        Problem::new(format!("{}: {error}; give a file in a folder that can be written", path.display()))
    })
}

fn failed(path: &Path, error: std::io::Error) -> Problem {
    Problem::new(format!("{}: {error}; give another folder with --out", path.display()))
}

/// Removes a file, if it is there.
pub(crate) fn remove(path: &Path) -> Outcome<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(failed(path, error)),
        _ => Ok(()),
    }
}

fn frame_name(frame: usize) -> String {
    format!("frame_{frame:04}.png")
}

/// Removes the frames of an earlier sequence from number `from` on, and their folder once nothing is in it.
fn remove_frames(folder: &Path, from: usize) -> Outcome<()> {
    let frames = folder.join(FRAMES);
    let Ok(entries) = std::fs::read_dir(&frames) else {
        return Ok(());
    };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| name.strip_prefix("frame_")?.strip_suffix(".png")?.parse().ok());
        if number.is_some_and(|number: usize| number >= from) {
            remove(&entry.path())?;
        }
    }
    match std::fs::remove_dir(&frames) {
        Err(error) if !matches!(error.kind(), std::io::ErrorKind::DirectoryNotEmpty | std::io::ErrorKind::NotFound) => {
            Err(failed(&frames, error))
        }
        _ => Ok(()),
    }
}

/// Frames and animation of a sequence. They are written beside their places as they are made, and put there when all are.
pub struct SequenceFiles {
    folder: PathBuf,
    part: PathBuf,
    count: usize,
    made: usize,
    animation: Option<Animation<BufWriter<File>>>,
    /// Whether the animation's file is whole.
    animated: bool,
}

impl SequenceFiles {
    /// Room for `count` frames in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn new(folder: &Path, count: usize) -> Outcome<SequenceFiles> {
        let part = folder.join(".frames.part");
        std::fs::create_dir_all(&part).map_err(|error| failed(&part, error))?;
        Ok(SequenceFiles { folder: folder.to_owned(), part, count, made: 0, animation: None, animated: false })
    }

    /// Writes the next frame.
    ///
    /// # Errors
    /// What cannot be written, with its path.
    pub fn push(&mut self, shown: &Shown<'_>) -> Outcome<()> {
        let picture = shown.picture;
        let rgb = to_rgb8(picture);
        let path = self.part.join(frame_name(shown.frame));
        let png = png_rgb8(picture.width, picture.height, &rgb)?;
        std::fs::write(&path, png).map_err(|error| failed(&path, error))?;
        self.made += 1;
        let animation = match &mut self.animation {
            Some(animation) => animation,
            none => {
                let path = self.part.join(ANIMATION);
                let file = BufWriter::new(File::create(&path).map_err(|error| failed(&path, error))?);
                none.insert(Animation::new(file, picture.width, picture.height, self.count, shown.playback_fps)?)
            }
        };
        Ok(animation.push(&rgb)?)
    }

    /// The animation once all frames are there; none of no pictures, and none that is too large for a page to carry.
    ///
    /// # Errors
    /// Missing frames, and what cannot be written or read, with its path.
    pub fn animation(&mut self) -> Outcome<Option<Vec<u8>>> {
        let Some(animation) = self.animation.take() else {
            return Ok(None);
        };
        animation.finish()?;
        self.animated = true;
        let path = self.part.join(ANIMATION);
        let small = std::fs::metadata(&path).is_ok_and(|file| file.len() <= CARRIED);
        small.then(|| std::fs::read(&path).map_err(|error| failed(&path, error))).transpose()
    }

    /// Puts frames and animation into their places; those of an earlier sequence that this one did not make are removed.
    ///
    /// # Errors
    /// What cannot be written, with its path.
    pub fn finish(mut self) -> Outcome<Vec<String>> {
        if let Some(animation) = self.animation.take() {
            animation.finish()?;
            self.animated = true;
        }
        if !self.animated {
            remove(&self.folder.join(ANIMATION))?;
            remove_frames(&self.folder, 0)?;
            return Ok(Vec::new());
        }
        let frames = self.folder.join(FRAMES);
        std::fs::create_dir_all(&frames).map_err(|error| failed(&frames, error))?;
        let names = (0..self.made).map(|frame| (frame_name(frame), frames.join(frame_name(frame))));
        let animation = self.folder.join(ANIMATION);
        for (name, to) in names.chain([(ANIMATION.to_owned(), animation.clone())]) {
            std::fs::rename(self.part.join(name), &to).map_err(|error| failed(&to, error))?;
        }
        remove_frames(&self.folder, self.made)?;
        Ok(vec![format!("{} ({} frames)", frames.display(), self.made), animation.display().to_string()])
    }
}

impl Drop for SequenceFiles {
    /// Nothing half-made stays; what cannot be removed does no harm.
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.part);
    }
}

fn png(picture: &Picture) -> Outcome<Vec<u8>> {
    Ok(png_rgb8(picture.width, picture.height, &to_rgb8(picture))?)
}
