//! Files that other programs wrote, in every option of theirs, read and compared voxel by voxel at its place in the world.
//!
//! `outside/write_files.py` makes the files with ITK, nibabel, pynrrd, teem and VTK, and has the library that each format comes
//! from read them back. What is compared does not depend on how axes are ordered: a voxel's place and its value.

mod python;

use std::collections::BTreeMap;
use std::path::Path;

use cube3_volume::{Ordering, ReadOptions, Space, Volume, inspect, read};
use glam::{DMat3, DVec3};
use serde_json::Value;

/// The fewest files that make the comparison worth its name.
const FEWEST: usize = 300;

/// Places agree within this part of the smallest spacing: headers of NIfTI hold 32-bit reals.
const PLACE: f64 = 1e-3;

/// An axis this close to the middle between two of the world's, in degrees, may go to either.
const AMBIGUOUS_DEG: f64 = 1.0;

#[test]
fn volumes_of_other_programs_are_where_and_what_they_were() {
    let folder = tempfile::tempdir().unwrap();
    if python::run("write_files.py", &[folder.path().as_os_str()]).is_none() {
        return;
    }
    let lines = std::fs::read_to_string(folder.path().join("files.jsonl")).unwrap();
    let mut writers: BTreeMap<String, usize> = BTreeMap::new();
    let mut wrong = Vec::new();
    for line in lines.lines() {
        let told: Value = serde_json::from_str(line).unwrap();
        *writers.entry(text(&told, "writer")).or_default() += 1;
        if let Err(reason) = compare(folder.path(), &told) {
            let about = format!("{} ({}: {})", text(&told, "file"), text(&told, "writer"), text(&told, "options"));
            wrong.push(format!("{about}\n    {reason}"));
        }
    }
    let count: usize = writers.values().sum();
    for (writer, files) in &writers {
        println!("{files:4} files of {writer}");
    }
    println!("{count:4} files compared, {} wrong", wrong.len());
    assert!(wrong.is_empty(), "{} of {count} files:\n{}", wrong.len(), wrong.join("\n"));
    assert!(count >= FEWEST, "{count} files are too few");
}

/// Reads one file in both orders and every frame, and says what is wrong with it.
fn compare(folder: &Path, told: &Value) -> Result<(), String> {
    let path = folder.join(text(told, "file"));
    if let Some(word) = told["refused"].as_str() {
        return match read(&path, &ReadOptions::default()) {
            Ok(_) => Err("it was read".into()),
            Err(error) => says(&error.to_string(), word),
        };
    }
    let grid = Told::of(told);
    let info = inspect(&path, &ReadOptions::default()).map_err(|e| e.to_string())?;
    same("stored sizes", info.stored_dims, grid.dims)?;
    same("volumes", info.volumes, grid.frames)?;
    for frame in 0..grid.frames {
        let options = |ordering| ReadOptions { frame, ordering, ..ReadOptions::default() };
        let values = &grid.values[frame * grid.voxels()..][..grid.voxels()];
        let stored = read(&path, &options(Ordering::AsStored)).map_err(|e| e.to_string())?;
        same("sizes as stored", stored.dims, grid.dims)?;
        if let Some(at) = (0..values.len()).find(|&at| !grid.equal(stored.samples.value(at), values[at])) {
            return Err(format!("as stored: value {at} is {}, not {}", stored.samples.value(at), values[at]));
        }
        grid.held(&stored, values).map_err(|reason| format!("as stored: {reason}"))?;
        let turned = read(&path, &options(Ordering::Ras)).map_err(|e| e.to_string())?;
        grid.held(&turned, values)?;
        same("sizes of the header", info.dims, turned.dims)?;
        if turned.world.space != Space::Unknown {
            closest(turned.world.directions)?;
        }
        canonical(told, &turned, frame, &grid)?;
    }
    Ok(())
}

/// Whether a refusal is one line that names what the file has.
fn says(message: &str, word: &str) -> Result<(), String> {
    let named = message.to_lowercase().contains(&word.to_lowercase());
    if named && message.lines().count() == 1 { Ok(()) } else { Err(format!("'{message}' does not say '{word}'")) }
}

/// The grid that was written.
struct Told {
    dims: [usize; 3],
    frames: usize,
    spacing: [f64; 3],
    space: Space,
    /// World steps of the stored axes, as columns, and the place of the first voxel.
    steps: DMat3,
    origin: DVec3,
    /// Whether the file says where its first voxel is.
    placed: bool,
    /// Whether the header scales the values: they are kept as f32 then.
    scaled: bool,
    values: Vec<f64>,
}

impl Told {
    fn of(told: &Value) -> Self {
        let row = |r: usize| numbers::<4>(&told["affine"][r]);
        let rows = [row(0), row(1), row(2)];
        let column = |c: usize| DVec3::from(rows.map(|row| row[c]));
        Self {
            dims: numbers(&told["dims"]).map(|d| d as usize),
            frames: told["frames"].as_u64().unwrap() as usize,
            spacing: numbers(&told["spacing"]),
            space: match told["space"].as_str().unwrap() {
                "patient" => Space::Patient,
                "room" => Space::Room,
                _ => Space::Unknown,
            },
            steps: DMat3::from_cols(column(0), column(1), column(2)),
            origin: column(3),
            placed: told["placed"].as_bool().unwrap(),
            scaled: text(told, "options").contains("slope"),
            values: told["values"].as_array().unwrap().iter().map(number).collect(),
        }
    }

    fn voxels(&self) -> usize {
        self.dims.iter().product()
    }

    fn equal(&self, a: f64, b: f64) -> bool {
        a == b || a.is_nan() && b.is_nan() || self.scaled && (a - b).abs() <= 1e-6 * b.abs().max(1.0)
    }

    /// Whether a volume holds each stored voxel at its place in the world.
    fn held(&self, volume: &Volume, values: &[f64]) -> Result<(), String> {
        same("space", volume.world.space, self.space)?;
        let mut sizes = [self.dims, volume.dims];
        sizes.iter_mut().for_each(|s| s.sort_unstable());
        same("sizes, sorted", sizes[1], sizes[0])?;
        let [x, y, z] = [0, 1, 2].map(|a| DVec3::from(volume.world.directions[a]) * volume.spacing[a]);
        let (steps, mut origin) = (DMat3::from_cols(x, y, z), DVec3::from(volume.origin));
        if !self.placed {
            // Only the steps are known: both grids are put into the same corner.
            origin += corner(self.steps, self.origin, self.dims) - corner(steps, origin, volume.dims);
        }
        let to_grid = steps.inverse();
        let near = PLACE * self.spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let mut stored = 0;
        for k in 0..self.dims[2] {
            for j in 0..self.dims[1] {
                for i in 0..self.dims[0] {
                    let place = self.steps * DVec3::new(i as f64, j as f64, k as f64) + self.origin;
                    let index = (to_grid * (place - origin)).round();
                    let off = (steps * index + origin - place).length();
                    let inside = (0..3).all(|a| index[a] >= 0.0 && index[a] < volume.dims[a] as f64);
                    if !inside || off > near {
                        let grid = format!("voxel {index} of {:?}, {off:.6} off", volume.dims);
                        return Err(format!("stored voxel ({i}, {j}, {k}) lies at {place}, which is {grid}"));
                    }
                    let value = volume.value(index.x as usize, index.y as usize, index.z as usize);
                    if !self.equal(value, values[stored]) {
                        return Err(format!("stored voxel ({i}, {j}, {k}) is {}, not {value}", values[stored]));
                    }
                    stored += 1;
                }
            }
        }
        Ok(())
    }
}

/// The least coordinates of a grid's corners.
fn corner(steps: DMat3, origin: DVec3, dims: [usize; 3]) -> DVec3 {
    let corners = (0..8).map(|c| {
        let index = [0, 1, 2].map(|a| if c >> a & 1 == 1 { (dims[a] - 1) as f64 } else { 0.0 });
        steps * DVec3::from(index) + origin
    });
    corners.reduce(DVec3::min).unwrap()
}

/// Whether each axis of a grid runs along its own axis of the world, as far as that can be told.
fn closest(directions: [[f64; 3]; 3]) -> Result<(), String> {
    let mut main = [0; 3];
    for (a, direction) in directions.iter().enumerate() {
        let mut order = [0, 1, 2];
        order.sort_by(|&p, &q| direction[q].abs().total_cmp(&direction[p].abs()));
        let degrees = direction[order[1]].abs().atan2(direction[order[0]].abs()).to_degrees();
        if degrees > 45.0 - AMBIGUOUS_DEG {
            return Ok(());
        }
        main[a] = order[0];
    }
    if main[0] == main[1] || main[0] == main[2] || main[1] == main[2] {
        return Ok(());
    }
    if main == [0, 1, 2] && (0..3).all(|a| directions[a][a] > 0.0) {
        return Ok(());
    }
    Err(format!("{directions:?} are not the closest to right, front and head"))
}

/// Whether nibabel's `as_closest_canonical` has the same array.
fn canonical(told: &Value, volume: &Volume, frame: usize, grid: &Told) -> Result<(), String> {
    let canonical = &told["canonical"];
    if canonical.is_null() {
        return Ok(());
    }
    same("sizes of as_closest_canonical", volume.dims, numbers(&canonical["dims"]).map(|d| d as usize))?;
    let values = canonical["values"].as_array().unwrap()[frame * volume.len()..].iter().take(volume.len());
    for (at, value) in values.map(number).enumerate() {
        if !grid.equal(volume.samples.value(at), value) {
            return Err(format!("as_closest_canonical has {value} at {:?}", volume.position(at)));
        }
    }
    Ok(())
}

fn same<T: PartialEq + std::fmt::Debug>(what: &str, found: T, told: T) -> Result<(), String> {
    if found == told { Ok(()) } else { Err(format!("{what}: {found:?}, not {told:?}")) }
}

fn text(told: &Value, key: &str) -> String {
    told[key].as_str().unwrap_or_else(|| panic!("{key} in {told}")).to_owned()
}

/// A number, or the name of what is none.
fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

fn numbers<const N: usize>(values: &Value) -> [f64; N] {
    std::array::from_fn(|n| number(&values[n]))
}
