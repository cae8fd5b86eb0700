//! Files that `cube3_volume::write` wrote, read by the libraries that the formats come from.

use std::ffi::OsStr;
use std::path::Path;

use crate::others::{Grid, run, same, text};
use cube3_volume::{Sample, SampleType, Space, Volume, World, write};
use serde_json::Value;

/// What is written, by a name's ending, and the worlds that the format has words for.
const WRITTEN: [(&str, &[Space]); 4] = [
    ("nrrd", &[Space::Unknown, Space::Patient]),
    ("nii", &[Space::Unknown, Space::Patient]),
    ("nii.gz", &[Space::Patient]),
    ("mha", &[Space::Patient]),
];

/// Directions of the grid's axes: along the world's, turned, turned and mirrored, leaning.
const DIRECTIONS: [(&str, [[f64; 3]; 3]); 4] = [
    ("straight", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]),
    ("oblique", [[0.96, 0.0, -0.28], [0.168, 0.8, 0.576], [0.224, -0.6, 0.768]]),
    ("mirrored", [[0.96, 0.0, -0.28], [0.168, 0.8, 0.576], [-0.224, 0.6, -0.768]]),
    ("leaning", [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.28, 0.96]]),
];

#[test]
fn other_programs_read_what_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let mut written = Vec::new();
    for (suffix, spaces) in WRITTEN {
        for (n, sample_type) in SampleType::ALL.into_iter().enumerate() {
            for space in spaces {
                for (name, directions) in &DIRECTIONS[..if *space == Space::Unknown { 1 } else { 4 }] {
                    let volume =
                        volume_of(sample_type, n, World { space: *space, directions: *directions, ..World::default() });
                    let path = folder.path().join(format!("{sample_type}_{space:?}_{name}.{suffix}"));
                    write(&path, &volume).unwrap();
                    written.push((path, volume));
                }
            }
        }
    }
    let paths: Vec<&OsStr> = written.iter().map(|(path, _)| path.as_os_str()).collect();
    let Some(output) = run("read_back.py", &paths) else { return };
    let (mut readings, mut wrong) = (0, Vec::new());
    for line in String::from_utf8(output.stdout).unwrap().lines() {
        let told: Value = serde_json::from_str(line).unwrap();
        let file = text(&told, "file");
        let (_, volume) = written.iter().find(|(path, _)| path == Path::new(&file)).unwrap();
        if let Err(reason) = compare(&told, volume) {
            wrong.push(format!("{file}, {}: {reason}", text(&told, "library")));
        }
        readings += 1;
    }
    println!("{readings} readings of {} files, {} wrong", written.len(), wrong.len());
    assert!(readings >= written.len(), "every file has a reader");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A volume of a type, its values spread over the range of the type.
fn volume_of(sample_type: SampleType, n: usize, world: World) -> Volume {
    fn spread<S: Sample>(n: usize, low: f64, high: f64) -> Volume {
        let [nx, ny, nz] = [[3, 4, 5], [5, 2, 4], [4, 6, 1]][n % 3];
        Volume::from_fn([nx, ny, nz], [0.75, 1.25, 2.5], |x, y, z| {
            let at = ((z * ny + y) * nx + x) * 2654435761 % 1_000_003;
            S::nearest(low + (high - low) * at as f64 / 1_000_002.0)
        })
        .unwrap()
    }
    let volume = match sample_type {
        SampleType::U8 => spread::<u8>(n, 0.0, 255.0),
        SampleType::I8 => spread::<i8>(n, -128.0, 127.0),
        SampleType::U16 => spread::<u16>(n, 0.0, 65535.0),
        SampleType::I16 => spread::<i16>(n, -32768.0, 32767.0),
        SampleType::U32 => spread::<u32>(n, 0.0, u32::MAX.into()),
        SampleType::I32 => spread::<i32>(n, i32::MIN.into(), i32::MAX.into()),
        SampleType::F32 => spread::<f32>(n, -1e6, 1e6),
        SampleType::F64 => spread::<f64>(n, -1e9, 1e9),
    };
    // NIfTI has no place for the origin of an unknown world.
    let origin = if world.space == Space::Unknown { [0.0; 3] } else { [-3.5, 10.25, 7.0] };
    volume.with_world(origin, world).unwrap()
}

/// What is wrong with what a library read from a volume's file.
fn compare(told: &Value, volume: &Volume) -> Result<(), String> {
    let leaning = volume.world.left_over().slanted_deg > 0.01;
    let nifti = text(told, "file").contains(".nii");
    let itk = text(told, "library") == "ITK";
    if let Some(error) = told["error"].as_str() {
        // ITK refuses axes of NIfTI that are not at right angles.
        return if itk && nifti && leaning { Ok(()) } else { Err(error.to_owned()) };
    }
    let mut told = told.clone();
    // ITK takes every world for a patient's.
    if itk && volume.world.space == Space::Room {
        return Ok(());
    }
    if itk && volume.world.space == Space::Unknown {
        told["space"] = "unknown".into();
        told["affine"] = diagonal(&told["spacing"]);
        told["placed"] = false.into();
    }
    if told["space"].is_null() {
        told["space"] = "patient".into();
    }
    let grid = Grid::of(&told);
    same("volumes", grid.frames, 1)?;
    same("values", grid.values.len(), volume.len())?;
    grid.held(volume, &grid.values)
}

fn diagonal(spacing: &Value) -> Value {
    let row = |r: usize| Value::from_iter((0..4).map(|c| if r == c { spacing[c].clone() } else { 0.0.into() }));
    Value::from_iter((0..3).map(row))
}
