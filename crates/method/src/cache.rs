//! Pictures that are kept by what they were made of.

use crate::{Choice, Render, RenderError, Subject};
use cube3_file::write_whole;
use cube3_picture::{Phase, Picture, Rendering, Watch};
use cube3_scene::{Scene, VolumeSource};
use cube3_volume::with_samples;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::fs::{create_dir_all, read, read_dir, remove_file};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What a file begins with; the digest of what follows comes next.
const MAGIC: &[u8; 8] = b"cube3pc1";

/// The end of a file's name.
const SUFFIX: &str = "picture";

/// What a folder holds at most: the oldest files go first.
const MOST_BYTES: u64 = 1 << 30;

/// A folder of pictures by methods that are worth it ([`SceneMethod::kept`](cube3_rendering::SceneMethod::kept)), each under the SHA-256 of all that it depends on:
/// method, options and their arithmetic's number, scene, voxels, spacing, border. Whatever changes gives another name, so nothing is ever out
/// of date; a file that is damaged is made anew.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cache {
    folder: PathBuf,
}

/// A rendering, and where it is from.
#[derive(Clone, Debug)]
pub struct Kept {
    /// The rendering; one that was found has the time of reading it.
    pub rendering: Rendering,
    /// Of one that was found: what making it took, in seconds.
    pub made_s: Option<f64>,
    /// Why it could not be kept, in words.
    pub unkept: Option<String>,
}

/// What a file holds.
#[derive(Serialize, Deserialize)]
struct Stored {
    width: usize,
    height: usize,
    pixels: Vec<[f64; 3]>,
    bound: Option<Vec<f64>>,
    samples: u64,
    bytes: u64,
    made_s: f64,
}

impl Cache {
    /// In a folder, which need not be there.
    pub fn at(folder: impl Into<PathBuf>) -> Cache {
        Cache { folder: folder.into() }
    }

    /// The picture of a subject, found or made.
    ///
    /// # Errors
    /// As [`Choice::render`]. A folder that cannot be written is no error: [`Kept::unkept`] says so.
    pub fn render(&self, choice: &Choice, subject: &Subject<'_>, watch: Watch<'_>) -> Result<Kept, RenderError> {
        choice.method.check(subject.scene)?;
        let Some(name) = name(choice, subject) else {
            return Ok(Kept { rendering: choice.render(subject, watch)?, made_s: None, unkept: None });
        };
        let path = self.folder.join(format!("{name}.{SUFFIX}"));
        let (found, phase) = Phase::of("found", || load(&path));
        if let Some((rendering, made_s)) = found {
            let rendering = Rendering { phases: vec![phase], ..rendering };
            return Ok(Kept { rendering, made_s: Some(made_s), unkept: None });
        }
        let rendering = choice.render(subject, watch)?;
        let kept = self.keep(&path, &rendering);
        let unkept = kept.err().map(|error| format!("{}: {error}", self.folder.display()));
        Ok(Kept { rendering, made_s: None, unkept })
    }

    fn keep(&self, path: &Path, rendering: &Rendering) -> io::Result<()> {
        create_dir_all(&self.folder)?;
        let Picture { width, height, pixels } = rendering.picture.clone();
        let (bound, samples, bytes) = (rendering.bound.clone(), rendering.samples, rendering.bytes);
        let stored = Stored { width, height, pixels, bound, samples, bytes, made_s: rendering.seconds() };
        let body = postcard::to_stdvec(&stored).map_err(io::Error::other)?;
        write_whole(path, &[MAGIC.as_slice(), Sha256::digest(&body).as_slice(), &body].concat())?;
        self.make_room(MOST_BYTES)
    }

    /// Removes the oldest files beyond `most` bytes.
    fn make_room(&self, most: u64) -> io::Result<()> {
        let mut files: Vec<(SystemTime, u64, PathBuf)> = Vec::new();
        for entry in read_dir(&self.folder)? {
            let path = entry?.path();
            // One that another run has removed in the meantime is gone.
            if path.extension().is_some_and(|end| end == SUFFIX)
                && let Ok(about) = path.metadata()
            {
                files.push((about.modified()?, about.len(), path));
            }
        }
        files.sort_by(|a, b| b.cmp(a));
        let mut held = 0;
        for (_, bytes, path) in files {
            held += bytes;
            if held > most {
                remove_file(path)
                    .or_else(|error| if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) })?;
            }
        }
        Ok(())
    }
}

/// The digest of all that a kept method's picture depends on; none for a method that is not kept.
fn name(choice: &Choice, subject: &Subject<'_>) -> Option<String> {
    let Render::Scene(method) = choice.method.render else { return None };
    let arithmetic = method.kept?;
    let scene_subject = subject.as_scene();
    let volume = scene_subject.volume;
    // Where the volume is from changes no pixel, nor where the view goes next.
    let source = VolumeSource { labels: subject.scene.volume.labels, ..VolumeSource::default() };
    let scene = Scene { volume: source, path: None, ..subject.scene.clone() };
    let about =
        (volume.dims, volume.spacing.map(f64::to_bits), volume.sample_type().name(), scene_subject.border.to_bits());
    let text = format!("{choice} {arithmetic} {about:?} {}", serde_json::to_string(&scene).ok()?);
    let mut digest = Sha256::new_with_prefix(text);
    with_samples!(&volume.samples, v => digest.update(bytemuck::cast_slice(v)));
    let mut name = String::new();
    for byte in digest.finalize() {
        let _ = write!(name, "{byte:02x}");
    }
    Some(name)
}

/// The rendering of a file and what making it took; none where it is not there or not whole.
fn load(path: &Path) -> Option<(Rendering, f64)> {
    let file = read(path).ok()?;
    let (digest, body) = file.strip_prefix(MAGIC)?.split_at_checked(32)?;
    if Sha256::digest(body).as_slice() != digest {
        return None;
    }
    let Stored { width, height, pixels, bound, samples, bytes, made_s } = postcard::from_bytes(body).ok()?;
    let picture = Picture::new(width, height, pixels).ok()?;
    Some((Rendering { picture, phases: Vec::new(), samples, bytes, bound }, made_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{File, write};
    use std::time::Duration;

    #[test]
    fn the_oldest_files_make_room_and_others_stay() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        for (age, name) in ["new.picture", "old.picture", "older.picture", "notes.txt"].into_iter().enumerate() {
            write(place(name), [0; 10]).unwrap();
            let file = File::options().append(true).open(place(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(60 * age as u64)).unwrap();
        }
        Cache::at(folder.path()).make_room(20).unwrap();
        let left = ["new.picture", "old.picture", "older.picture", "notes.txt"].map(|name| place(name).exists());
        assert_eq!(left, [true, true, false, true]);
    }
}
