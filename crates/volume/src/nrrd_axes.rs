//! What the axes of an NRRD are, and where they lie in the world.

use crate::VolumeError;
use crate::layout::Series;
use crate::nrrd_header::Header;
use crate::place::Place;
use crate::text::{Field, clip};
use crate::world::{Placed, Space};

/// Kinds of axes that are axes of a grid, or may be.
const GRID_KINDS: [&str; 6] = ["domain", "space", "none", "???", "list", "time"];

/// The axes of a file.
pub(crate) struct Axes {
    /// All sizes, fastest first.
    pub sizes: Vec<usize>,
    /// Which of them are the grid's, at most three.
    grid: Vec<usize>,
    pub series: Series,
}

/// What `space directions` says of one axis.
#[derive(Clone, Debug, PartialEq)]
enum Direction {
    /// `none`: no axis of space.
    None,
    Vector(Vec<f64>),
}

impl Axes {
    pub fn of(header: &Header, place: &Place) -> Result<Axes, VolumeError> {
        let dimension = header.need("dimension", place)?;
        let count: usize = dimension.number("give the number of axes")?;
        if !(1..=16).contains(&count) {
            return Err(dimension.unsupported(format!("a grid of {count} axes"), "give 1 to 16 axes"));
        }
        let sizes = header.need("sizes", place)?.sizes(count)?;
        let kinds = match header.find("kinds", place) {
            Some(field) => field.value.split_whitespace().map(str::to_lowercase).collect(),
            None => Vec::new(),
        };
        let kind = |axis: usize| kinds.get(axis).map_or("domain", String::as_str);
        if let Some(axis) = (0..count).find(|&axis| sizes[axis] > 1 && !GRID_KINDS.contains(&kind(axis))) {
            let field = header.need("kinds", place)?;
            return Err(place.several(
                format!("line {}, 'kinds'", field.line),
                Some(sizes[axis] as u64),
                &clip(field.value.split_whitespace().nth(axis).unwrap_or_default()),
            ));
        }
        let directions = directions(header, place, count)?;
        // Time has a direction of its own where the space has four dimensions.
        let outside = |axis: usize| match directions.get(axis) {
            Some(Direction::None) => true,
            Some(Direction::Vector(v)) => v.len() == 4 && v[..3].iter().all(|c| *c == 0.0) && v[3] != 0.0,
            None => false,
        };
        // A component of its own, then whatever else has one step, as long as there are more axes than a grid has.
        let mut grid: Vec<usize> =
            (0..count).filter(|&axis| sizes[axis] > 1 || GRID_KINDS.contains(&kind(axis)) && !outside(axis)).collect();
        while grid.len() > 4
            && let Some(at) = grid.iter().rposition(|&axis| sizes[axis] == 1)
        {
            grid.remove(at);
        }
        let mut series = Series::After(1);
        if grid.len() > 3 {
            let named = |axis: &usize| outside(*axis) || matches!(kind(*axis), "list" | "time");
            let at = grid.iter().position(named).unwrap_or(grid.len() - 1);
            let axis = grid.remove(at);
            series = match at {
                _ if sizes[axis] == 1 => Series::After(1),
                0 => Series::Within(sizes[axis] as u64),
                at if at == grid.len() => Series::After(sizes[axis] as u64),
                _ => {
                    return Err(dimension.unsupported(
                        format!("a series along axis {axis}"),
                        "store the volumes one after another, with the series as the last axis",
                    ));
                }
            };
        }
        if grid.len() > 3 {
            return Err(dimension.unsupported(
                format!("a grid of {count} axes"),
                "give a volume of 1 to 3 axes, or a series of volumes with 4",
            ));
        }
        if grid.is_empty() {
            grid.push(0);
        }
        Ok(Axes { sizes, grid, series })
    }

    /// Voxels along the three axes of the grid.
    pub fn dims(&self) -> [usize; 3] {
        [0, 1, 2].map(|a| self.grid.get(a).map_or(1, |&axis| self.sizes[axis]))
    }

    /// Where the grid lies in the world.
    pub fn placed(&self, header: &Header, place: &Place, remarks: &mut Vec<String>) -> Result<Placed, VolumeError> {
        let vectors = directions(header, place, self.sizes.len())?;
        let origin = match header.find("space origin", place) {
            Some(field) => {
                let (vector, _) = field.vector(field.value)?;
                Some([0, 1, 2].map(|i| vector.get(i).copied().filter(|c| !c.is_nan()).unwrap_or(0.0)))
            }
            None => None,
        };
        let (spacing, starts) = self.scalar_spacing(header, place, remarks)?;
        if vectors.is_empty() {
            let starts = starts.map(|start| start.unwrap_or(0.0));
            return Ok(Placed::unknown(spacing, origin.unwrap_or(starts)));
        }
        let (space, signs) = match header.find("space", place) {
            Some(field) => space(&field)?,
            None => (Space::Unknown, [1.0; 3]),
        };
        let signed = |v: &[f64]| [0, 1, 2].map(|i| v.get(i).copied().unwrap_or(0.0) * signs[i]);
        let mut lengths = spacing.map(f64::abs);
        let mut steps = [None; 3];
        for (a, &axis) in self.grid.iter().enumerate() {
            let Direction::Vector(vector) = &vectors[axis] else { continue };
            let step = signed(vector);
            let length = step.iter().fold(0.0, |length: f64, &c| length.hypot(c));
            if step.iter().any(|c| c.is_nan()) {
                remarks
                    .push(format!("the direction of axis {axis} is not known: the spacing is taken as {}", lengths[a]));
            } else if length == 0.0 && self.sizes[axis] == 1 {
                remarks.push(format!("the direction of axis {axis} has no length: the spacing is taken as 1"));
            } else {
                (steps[a], lengths[a]) = (Some(step), length);
            }
        }
        let origin = signed(&origin.unwrap_or_default());
        let bad = |reason| {
            let line = header.find("space directions", place).map_or(0, |field| field.line);
            place.wrong(format!("line {line}, 'space directions'"), reason, "give three directions that span space")
        };
        // A step of no length is refused with the grid.
        let steps = steps.map(|step| step.filter(|step| step.iter().any(|c| *c != 0.0)));
        Placed::steps(space, steps, lengths, origin).map_err(bad)
    }

    /// Spacing by `spacings`, or by `axis mins` and `axis maxs`, with its sign, and the place of the first sample where those
    /// say it.
    fn scalar_spacing(
        &self,
        header: &Header,
        place: &Place,
        remarks: &mut Vec<String>,
    ) -> Result<([f64; 3], [Option<f64>; 3]), VolumeError> {
        let count = self.sizes.len();
        let numbers = |name: &str| -> Result<Option<Vec<f64>>, VolumeError> {
            let remedy = "give one number for each axis";
            header.find(name, place).map(|field| field.numbers(Some(count), remedy)).transpose()
        };
        let (spacings, mins, maxs) = (numbers("spacings")?, numbers("axis mins")?, numbers("axis maxs")?);
        let centers: Vec<&str> = match header.find("centers", place) {
            Some(field) => field.value.split_whitespace().collect(),
            None => Vec::new(),
        };
        let (mut spacing, mut starts) = ([1.0; 3], [None; 3]);
        for (a, &axis) in self.grid.iter().enumerate() {
            let known = |numbers: &Option<Vec<f64>>| numbers.as_ref().map(|n| n[axis]).filter(|n| !n.is_nan());
            let said = spacings.as_ref().map(|n| n[axis]);
            let (min, max) = (known(&mins), known(&maxs));
            // Samples are cells unless the header says that they are nodes.
            let node = centers.get(axis).is_some_and(|center| center.eq_ignore_ascii_case("node"));
            let steps = if node { self.sizes[axis] - 1 } else { self.sizes[axis] };
            let between = min.zip(max).map(|(min, max)| (max - min) / steps.max(1) as f64);
            let of_ends = said.is_none_or(f64::is_nan).then_some(between).flatten();
            spacing[a] = match (said, of_ends) {
                (_, Some(between)) if between != 0.0 => between,
                (Some(said), _) if !said.is_nan() && (said != 0.0 || self.sizes[axis] > 1) => said,
                (None, None) => 1.0,
                (said, _) => {
                    let said = said.map_or("no distance".into(), |said| said.to_string());
                    remarks.push(format!("the spacing of axis {axis} is {said}: it is taken as 1"));
                    1.0
                }
            };
            starts[a] = min.map(|min| if node { min } else { min + spacing[a] / 2.0 });
        }
        Ok((spacing, starts))
    }
}

/// One direction for each axis, or none where the header gives none.
fn directions(header: &Header, place: &Place, count: usize) -> Result<Vec<Direction>, VolumeError> {
    let Some(field) = header.find("space directions", place) else { return Ok(Vec::new()) };
    let mut rest = field.value.trim();
    let mut directions = Vec::new();
    for _ in 0..count {
        if let Some(after) = rest.strip_prefix("none") {
            (rest, _) = (after.trim_start(), directions.push(Direction::None));
            continue;
        }
        let (vector, after) = field.vector(rest)?;
        directions.push(Direction::Vector(vector));
        rest = after.trim_start();
    }
    if !rest.is_empty() {
        return Err(field.wrong(format!("more than {count} vectors"), "give one vector, or 'none', for each axis"));
    }
    Ok(directions)
}

/// What a named space is, and the signs that make RAS+ of its coordinates.
fn space(field: &Field) -> Result<(Space, [f64; 3]), VolumeError> {
    let name = field.value.to_lowercase();
    let name = name.strip_suffix("-time").unwrap_or(&name);
    Ok(match name {
        "right-anterior-superior" | "ras" | "rast" => (Space::Patient, [1.0, 1.0, 1.0]),
        "left-anterior-superior" | "las" | "last" => (Space::Patient, [-1.0, 1.0, 1.0]),
        "left-posterior-superior" | "lps" | "lpst" => (Space::Patient, [-1.0, -1.0, 1.0]),
        "scanner-xyz" | "3d-right-handed" => (Space::Room, [1.0, 1.0, 1.0]),
        // A mirror image, unless one axis is turned round.
        "3d-left-handed" => (Space::Room, [1.0, 1.0, -1.0]),
        _ => {
            return Err(field.wrong(
                format!("'{}' is no space", clip(field.value)),
                "write right-anterior-superior, left-posterior-superior or another space of the format",
            ));
        }
    })
}
