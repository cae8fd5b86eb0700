//! The house: the crates of the workspace as rooms, and who uses whom, from `cargo metadata`.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The floors, from the ground up, each with its rooms. A room uses rooms of lower floors alone. Units stand on a stair, as each takes the
/// tokens that the one before it gives.
pub const FLOORS: &[(&str, &[&str])] = &[
    ("ground", &["word", "channel", "picture", "parameter", "file", "waveform", "cases"]),
    ("ground", &["volume", "metrics"]),
    ("scene", &["scene"]),
    ("scene", &["rendering"]),
    ("machine", &["machine"]),
    ("frame", &["frame"]),
    ("plan", &["plan"]),
    ("host", &["host"]),
    ("inputs", &["inputs"]),
    ("units", &["cfb"]),
    ("units", &["dsb"]),
    ("units", &["trilin"]),
    ("units", &["abc"]),
    ("units", &["cone"]),
    ("systems", &["pipeline", "function", "definition"]),
    ("references", &["reference"]),
    ("references", &["twin", "converged"]),
    ("references", &["bound"]),
    ("report", &["report"]),
    ("tools", &["trace", "resources"]),
    ("tools", &["vectors"]),
    ("method", &["method"]),
    ("study", &["study"]),
    ("library", &["cube3"]),
    ("command", &["sim"]),
    ("tests", &["tests"]),
];

/// Rooms that must not use another, though it is below them, each with the reason.
pub const WALLS: &[(&[&str], &str, &str)] = &[
    (&["cfb", "dsb", "trilin", "abc", "cone"], "host", "a unit knows registers, and not who makes them"),
    (&["cfb", "dsb", "trilin", "abc", "cone"], "plan", "a unit is there or not, and does not ask why"),
    (&["definition", "pipeline", "function"], "host", "a frame is what its registers say, whoever made them"),
    (&["definition", "pipeline", "function"], "plan", "a machine runs what its registers say, and does not ask why"),
    (&["reference", "twin", "converged"], "host", "what is measured with does not run what is measured"),
    (&["reference", "converged"], "frame", "image order knows scene and volume alone"),
    (&["reference", "converged"], "machine", "image order knows scene and volume alone"),
];

/// The rooms of a workspace, each with those that it uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct House {
    /// Each room with the rooms that its crate needs, those of its tests apart.
    pub uses: BTreeMap<String, BTreeSet<String>>,
    /// Each room's folder.
    pub folders: BTreeMap<String, PathBuf>,
}

/// How large a room is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Size {
    /// Lines in the files of its sources.
    pub lines: usize,
    /// Public items: functions, types, traits, constants and modules.
    pub public: usize,
}

impl House {
    /// The house of what `cargo metadata` says.
    ///
    /// # Errors
    /// Text that is not that.
    pub fn of_metadata(text: &str) -> Result<House, String> {
        let metadata: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
        let packages = metadata["packages"].as_array().ok_or("no packages")?;
        let room = |package: &Value| {
            let folder = Path::new(package["manifest_path"].as_str()?).parent()?;
            Some((folder.file_name()?.to_str()?.to_owned(), folder.to_owned()))
        };
        let rooms: BTreeMap<&str, (String, PathBuf)> =
            packages.iter().filter_map(|package| Some((package["name"].as_str()?, room(package)?))).collect();
        let mut house = House { uses: BTreeMap::new(), folders: rooms.values().cloned().collect() };
        for package in packages {
            let Some((name, _)) = package["name"].as_str().and_then(|name| rooms.get(name)) else {
                return Err("a package without a name".into());
            };
            let needed = package["dependencies"].as_array().into_iter().flatten().filter(|need| need["kind"].is_null());
            let uses = needed.filter_map(|need| Some(rooms.get(need["name"].as_str()?)?.0.clone())).collect();
            house.uses.insert(name.clone(), uses);
        }
        Ok(house)
    }

    /// The house of this workspace.
    ///
    /// # Errors
    /// A `cargo` that does not say.
    pub fn of_workspace() -> Result<House, String> {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
        let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
        let output = Command::new(cargo)
            .args(["metadata", "--no-deps", "--format-version", "1", "--offline", "--manifest-path"])
            .arg(manifest)
            .output()
            .map_err(|error| format!("cargo metadata: {error}"))?;
        if !output.status.success() {
            return Err(String::from_utf8_lossy(&output.stderr).into_owned());
        }
        House::of_metadata(&String::from_utf8_lossy(&output.stdout))
    }

    /// Arrows that the plan does not have, each in words: to the same floor or a higher one, or through a wall.
    pub fn faults(&self) -> Vec<String> {
        let floor = |room: &str| FLOORS.iter().position(|(_, rooms)| rooms.contains(&room));
        let mut faults = Vec::new();
        for (room, uses) in &self.uses {
            let Some(at) = floor(room) else {
                faults.push(format!("{room} is on no floor"));
                continue;
            };
            for used in uses {
                if floor(used).is_none_or(|below| below >= at) {
                    faults.push(format!("{room} uses {used}, which is not below it"));
                }
                for (rooms, other, reason) in WALLS {
                    if rooms.contains(&room.as_str()) && used == other {
                        faults.push(format!("{room} uses {used}: {reason}"));
                    }
                }
            }
        }
        let planned = FLOORS.iter().flat_map(|(_, rooms)| rooms.iter());
        faults
            .extend(planned.filter(|room| !self.uses.contains_key(**room)).map(|room| format!("{room} is not there")));
        faults
    }

    /// The least height of each room: one above the highest that it uses.
    fn heights(&self) -> BTreeMap<&str, usize> {
        let mut heights: BTreeMap<&str, usize> = self.uses.keys().map(|room| (room.as_str(), 0)).collect();
        for _ in 0..self.uses.len() {
            for (room, uses) in &self.uses {
                let height = uses.iter().map(|used| heights[used.as_str()] + 1).max().unwrap_or(0);
                heights.insert(room, height);
            }
        }
        heights
    }

    /// The rooms that a room uses and that none of the others it uses does.
    fn nearest(&self, room: &str) -> Vec<&str> {
        let uses = &self.uses[room];
        let behind = |from: &String, to: &String| {
            let (mut open, mut seen) = (vec![from], BTreeSet::new());
            while let Some(at) = open.pop() {
                if at != from && at == to {
                    return true;
                }
                open.extend(self.uses[at].iter().filter(|next| seen.insert(*next)));
            }
            false
        };
        uses.iter().filter(|to| !uses.iter().any(|from| from != *to && behind(from, to))).map(String::as_str).collect()
    }

    /// The house as an SVG: a row for each height, and a line from each room to those that it uses, less those that these use themselves.
    pub fn drawing(&self, title: &str) -> String {
        const BOX: [f64; 2] = [96.0, 30.0];
        const STEP: [f64; 2] = [112.0, 62.0];
        let heights = self.heights();
        let top = heights.values().copied().max().unwrap_or(0);
        let rows: Vec<Vec<&str>> = (0..=top)
            .map(|height| heights.iter().filter(|(_, h)| **h == height).map(|(room, _)| *room).collect())
            .collect();
        let widest = rows.iter().map(Vec::len).max().unwrap_or(0);
        let [width, height] = [widest as f64 * STEP[0] + 16.0, (top + 1) as f64 * STEP[1] + 36.0];
        let mut places = BTreeMap::new();
        for (level, rooms) in rows.iter().enumerate() {
            for (i, room) in rooms.iter().enumerate() {
                let left = (width - rooms.len() as f64 * STEP[0]) / 2.0 + i as f64 * STEP[0] + (STEP[0] - BOX[0]) / 2.0;
                places.insert(*room, [left, 36.0 + (top - level) as f64 * STEP[1]]);
            }
        }
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
             <text x=\"{}\" y=\"20\" text-anchor=\"middle\">{title}</text>\n",
            width / 2.0
        );
        for (room, [x, y]) in &places {
            for used in self.nearest(room) {
                let [to_x, to_y] = places[used];
                let _ = writeln!(
                    svg,
                    "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{to_y}\" stroke=\"#8a8a8a\"/>",
                    x + BOX[0] / 2.0,
                    y + BOX[1],
                    to_x + BOX[0] / 2.0
                );
            }
        }
        for (room, [x, y]) in &places {
            let _ = writeln!(
                svg,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" rx=\"4\" fill=\"#eaf1fb\" stroke=\"#4a6fa5\"/>\n\
                 <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{room}</text>",
                BOX[0],
                BOX[1],
                x + BOX[0] / 2.0,
                y + 20.0
            );
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// How large each room is.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub fn sizes(&self) -> std::io::Result<BTreeMap<&str, Size>> {
        self.folders.iter().map(|(room, folder)| Ok((room.as_str(), size(&folder.join("src"))?))).collect()
    }
}

fn size(folder: &Path) -> std::io::Result<Size> {
    const ITEMS: [&str; 8] = ["fn", "const fn", "struct", "enum", "trait", "const", "type", "mod"];
    let mut sum = Size::default();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            let inner = size(&path)?;
            sum = Size { lines: sum.lines + inner.lines, public: sum.public + inner.public };
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path)?;
            sum.lines += text.lines().count();
            let public = |line: &&str| {
                let item = line.trim_start().strip_prefix("pub ");
                item.is_some_and(|item| ITEMS.iter().any(|kind| item.starts_with(&format!("{kind} "))))
            };
            sum.public += text.lines().filter(public).count();
        }
    }
    Ok(sum)
}
