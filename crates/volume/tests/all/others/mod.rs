//! What other programs say a file holds, and whether a volume holds the same.

use std::ffi::OsStr;
use std::fmt::Debug;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use cube3_volume::{Space, Volume};
use glam::{DMat3, DVec3};
use serde_json::Value;

/// How to get what the scripts need.
const REMEDY: &str =
    "pip install numpy nibabel SimpleITK pynrrd vtk, apt-get install teem-apps, and name the Python in CUBE3_PYTHON";

/// The exit code by which a script says that a module is missing.
const MISSING: i32 = 3;

/// Runs a script of `tests/outside` with the Python that `CUBE3_PYTHON` names, or `python3`.
///
/// `None` where it or a module is missing; a line says so. Where `CUBE3_REQUIRE_TOOLS` is set that is a panic, as is a script
/// that fails.
pub fn run(script: &str, arguments: &[&OsStr]) -> Option<Output> {
    let python = std::env::var_os("CUBE3_PYTHON").unwrap_or("python3".into());
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/outside").join(script);
    let said = |output: &Output| String::from_utf8_lossy(&output.stderr).trim().to_owned();
    let missing = match Command::new(&python).env("PYTHONDONTWRITEBYTECODE", "1").arg(path).args(arguments).output() {
        Err(error) => format!("{}: {error}", PathBuf::from(&python).display()),
        Ok(output) if output.status.code() == Some(MISSING) => said(&output),
        Ok(output) => {
            assert!(output.status.success(), "{script}: {}\n{}", output.status, said(&output));
            return Some(output);
        }
    };
    assert!(std::env::var_os("CUBE3_REQUIRE_TOOLS").is_none(), "{missing}; {REMEDY}");
    eprintln!("skipped, {missing}; {REMEDY}");
    None
}

/// Places agree within this part of the smallest spacing: headers of NIfTI hold 32-bit reals.
const PLACE: f64 = 1e-3;

/// A grid in a file, in the order in which it is stored.
pub struct Grid {
    pub dims: [usize; 3],
    pub frames: usize,
    pub spacing: [f64; 3],
    pub space: Space,
    /// World steps of the stored axes, as columns, and the place of the first voxel.
    pub steps: DMat3,
    pub origin: DVec3,
    /// Whether the file says where its first voxel is.
    pub placed: bool,
    /// Whether the header scales the values: they are kept as f32 then.
    pub scaled: bool,
    /// Frame after frame.
    pub values: Vec<f64>,
}

impl Grid {
    /// What a line of a script tells.
    pub fn of(told: &Value) -> Self {
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
            scaled: told["options"].as_str().is_some_and(|options| options.contains("slope")),
            values: told["values"].as_array().unwrap().iter().map(number).collect(),
        }
    }

    /// Voxels of one frame.
    pub fn voxels(&self) -> usize {
        self.dims.iter().product()
    }

    /// Whether a value is that of the file.
    pub fn equal(&self, a: f64, b: f64) -> bool {
        a == b || a.is_nan() && b.is_nan() || self.scaled && (a - b).abs() <= 1e-6 * b.abs().max(1.0)
    }

    /// Whether a volume holds each stored voxel at its place in the world.
    pub fn held(&self, volume: &Volume, values: &[f64]) -> Result<(), String> {
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

/// Whether two are equal; the error says which is which.
pub fn same<T: PartialEq + Debug>(what: &str, found: T, told: T) -> Result<(), String> {
    if found == told { Ok(()) } else { Err(format!("{what}: {found:?}, not {told:?}")) }
}

/// A line's text under a key.
pub fn text(told: &Value, key: &str) -> String {
    told[key].as_str().unwrap_or_else(|| panic!("{key} in {told}")).to_owned()
}

/// A number, or the name of what is none.
pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| value.as_str().unwrap().parse().unwrap())
}

/// The first numbers of a list.
pub fn numbers<const N: usize>(values: &Value) -> [f64; N] {
    std::array::from_fn(|n| number(&values[n]))
}
