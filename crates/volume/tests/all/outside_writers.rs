//! Files that other programs wrote, in every option of theirs, read and compared voxel by voxel at its place in the world.
//!
//! `outside/write_files.py` makes the files with ITK, nibabel, pynrrd, teem and VTK, and has the library that each format comes
//! from read them back. What is compared does not depend on how axes are ordered: a voxel's place and its value.

use std::collections::BTreeMap;
use std::path::Path;

use crate::others::{Grid, number, numbers, run, same, text};
use cube3_volume::{Ordering, ReadOptions, Space, Volume, inspect, read};
use serde_json::Value;

/// The fewest files that make the comparison worth its name.
const FEWEST: usize = 300;

/// An axis this close to the middle between two of the world's, in degrees, may go to either.
const AMBIGUOUS_DEG: f64 = 1.0;

#[test]
fn volumes_of_other_programs_are_where_and_what_they_were() {
    let folder = tempfile::tempdir().unwrap();
    if run("write_files.py", &[folder.path().as_os_str()]).is_none() {
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
    let grid = Grid::of(told);
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
fn canonical(told: &Value, volume: &Volume, frame: usize, grid: &Grid) -> Result<(), String> {
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
