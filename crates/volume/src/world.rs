//! Where a grid lies in the world, and how its axes run.
//!
//! ```text
//!   stored (i, j, k) ──AxisOrder──► grid (x, y, z) ──origin, spacing, directions──► world
//! ```
//!
//! A grid whose world is known is turned until its axes are the closest to the world's: x to the right, y to the front, z to the
//! head. A turn of axes moves no voxel in the world; what it cannot take away stays in [`World::directions`].

use glam::DVec3;

/// What world coordinates mean.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Space {
    /// The file does not say.
    #[default]
    Unknown,
    /// A patient, in mm: x to the right, y to the front (anterior), z to the head (superior); RAS+.
    Patient,
    /// A right-handed room, such as a scanner's; no sides of a patient.
    Room,
}

/// In which order a volume's voxels come from a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ordering {
    /// Axes closest to the world's, RAS+; as stored where the world is not known, but for axes of negative spacing, which are
    /// turned round.
    #[default]
    Ras,
    /// As the file has them.
    AsStored,
}

/// How stored axes become those of the grid: a permutation with flips.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AxisOrder {
    /// For each stored axis, fastest first, the axis of the grid that it becomes; a permutation of 0, 1, 2.
    pub axis: [usize; 3],
    /// Whether the stored axis runs against it.
    pub backward: [bool; 3],
}

impl Default for AxisOrder {
    fn default() -> Self {
        Self { axis: [0, 1, 2], backward: [false; 3] }
    }
}

/// All orders of three axes; the first that fits best is taken.
const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

impl AxisOrder {
    /// The order in which stored axes of these unit `directions` lie closest to the world's axes: the sum of the cosines is
    /// largest.
    pub fn closest(directions: [[f64; 3]; 3]) -> Self {
        let fit = |axis: &[usize; 3]| (0..3).map(|i| directions[i][axis[i]].abs()).sum::<f64>();
        let mut best = PERMUTATIONS[0];
        for other in &PERMUTATIONS[1..] {
            if fit(other) > fit(&best) + 1e-9 {
                best = *other;
            }
        }
        Self { axis: best, backward: [0, 1, 2].map(|i| directions[i][best[i]] < 0.0) }
    }

    /// Whether nothing changes.
    pub fn is_stored(&self) -> bool {
        *self == Self::default()
    }

    /// Numbers that belong to stored axes, for the axes of the grid.
    pub fn turn<T: Copy>(&self, stored: [T; 3]) -> [T; 3] {
        let mut grid = stored;
        for (i, value) in stored.into_iter().enumerate() {
            grid[self.axis[i]] = value;
        }
        grid
    }

    /// Numbers that belong to axes of the grid, for the stored axes.
    pub fn turn_back<T: Copy>(&self, grid: [T; 3]) -> [T; 3] {
        self.axis.map(|axis| grid[axis])
    }

    /// Where in the grid's storage the stored voxel (0, 0, 0) lies, and how far a step along each stored axis goes.
    pub(crate) fn strides(&self, stored: [usize; 3]) -> (usize, [isize; 3]) {
        let [nx, ny, _] = self.turn(stored);
        let step = [1, nx, nx * ny];
        let mut first = 0;
        let strides = [0, 1, 2].map(|i| {
            let step = step[self.axis[i]];
            if self.backward[i] {
                first += step * (stored[i] - 1);
                -(step as isize)
            } else {
                step as isize
            }
        });
        (first, strides)
    }

    /// Where each stored axis leads, as letters: `LPS`, or `+x-y+z` where the space has no sides.
    pub fn letters(&self, space: Space) -> String {
        let name = |i: usize| letter(space, self.axis[i], self.backward[i]);
        (0..3).map(name).collect()
    }
}

/// Where world axis `axis` leads, forward or backward.
pub(crate) fn letter(space: Space, axis: usize, backward: bool) -> &'static str {
    match space {
        Space::Patient => [["R", "A", "S"], ["L", "P", "I"]][usize::from(backward)][axis],
        _ => [["+x", "+y", "+z"], ["-x", "-y", "-z"]][usize::from(backward)][axis],
    }
}

/// Where a grid lies in the world, beside its origin and spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct World {
    /// What the coordinates mean.
    pub space: Space,
    /// The unit vectors in the world along which x, y and z of the grid run; not in one plane.
    pub directions: [[f64; 3]; 3],
    /// How the file's axes became those of the grid.
    pub taken: AxisOrder,
}

impl Default for World {
    /// Nothing known: the grid's axes are the world's.
    fn default() -> Self {
        Self {
            space: Space::Unknown,
            directions: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            taken: AxisOrder::default(),
        }
    }
}

/// What a turn of axes leaves over, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeftOver {
    /// The turn that takes the stored slices to the world's axes.
    pub turned_deg: f64,
    /// The stored axes' greatest distance from a right angle, as of a gantry that was tilted.
    pub slanted_deg: f64,
}

impl LeftOver {
    /// Less than this is a header's rounding.
    const ROUNDING_DEG: f64 = 0.01;

    /// Whether the grid lies along the world's axes.
    pub fn is_straight(&self) -> bool {
        self.turned_deg < Self::ROUNDING_DEG && self.slanted_deg < Self::ROUNDING_DEG
    }

    /// In words; `None` where the grid is straight.
    pub fn in_words(&self) -> Option<String> {
        let turned = format!("turned by {:.1}° from the world's axes (oblique)", self.turned_deg);
        let slanted = format!("axes {:.1}° off a right angle (gantry tilt)", self.slanted_deg);
        match (self.turned_deg >= Self::ROUNDING_DEG, self.slanted_deg >= Self::ROUNDING_DEG) {
            (false, false) => None,
            (true, false) => Some(turned),
            (false, true) => Some(slanted),
            (true, true) => Some(format!("{turned}, {slanted}")),
        }
    }
}

impl World {
    /// The unit vectors in the world along which the file's axes run.
    pub fn stored_directions(&self) -> [[f64; 3]; 3] {
        let AxisOrder { axis, backward } = self.taken;
        [0, 1, 2].map(|i| self.directions[axis[i]].map(|c| if backward[i] { -c + 0.0 } else { c }))
    }

    /// Where the file's axes lead, as letters: `LPS`, or `-x+y+z` where the space has no sides.
    pub fn stored_letters(&self) -> String {
        AxisOrder::closest(self.stored_directions()).letters(self.space)
    }

    /// Where x, y and z of the grid lead, as letters.
    pub fn letters(&self) -> String {
        AxisOrder::closest(self.directions).letters(self.space)
    }

    /// What is left over between grid and world; nothing where the space is not known.
    pub fn left_over(&self) -> LeftOver {
        if self.space == Space::Unknown {
            return LeftOver { turned_deg: 0.0, slanted_deg: 0.0 };
        }
        let stored = self.stored_directions();
        let order = AxisOrder::closest(stored);
        // The stored slice, of the first two stored axes, and its normal, beside the axes of the world that are closest.
        let [i, j, k] = stored.map(DVec3::from);
        let along = |s: usize| if order.backward[s] { -DVec3::AXES[order.axis[s]] } else { DVec3::AXES[order.axis[s]] };
        let (ei, ej) = (along(0), along(1));
        let j_square = (j - i * i.dot(j)).normalize();
        let (normal, en) = (i.cross(j_square), ei.cross(ej));
        // The trace of a turn by t is 1 + 2 cos t; its sine is better where t is small.
        let cosine = (i.dot(ei) + j_square.dot(ej) + normal.dot(en) - 1.0) / 2.0;
        let axis = ei.cross(i) + ej.cross(j_square) + en.cross(normal);
        let turned_deg = (axis.length() / 2.0).atan2(cosine).to_degrees();
        let off = |a: DVec3, b: DVec3| a.dot(b).abs().min(1.0).asin().to_degrees();
        LeftOver { turned_deg, slanted_deg: off(i, j).max(off(i, k)).max(off(j, k)) }
    }

    /// The world direction of a vector of the grid, (x, y, z) in voxel steps of equal length.
    pub fn direction_of(&self, vector: [f64; 3]) -> [f64; 3] {
        let sum: DVec3 = (0..3).map(|a| DVec3::from(self.directions[a]) * vector[a]).sum();
        sum.to_array()
    }

    /// Where a direction of the grid leads, as letters, the main one first; a further one where its part is at least a quarter.
    pub fn side(&self, vector: [f64; 3]) -> String {
        let direction = DVec3::from(self.direction_of(vector)).normalize_or_zero().to_array();
        let mut axes: Vec<usize> = (0..3).filter(|&a| direction[a].abs() >= 0.25).collect();
        axes.sort_by(|&a, &b| direction[b].abs().total_cmp(&direction[a].abs()));
        axes.into_iter().map(|a| letter(self.space, a, direction[a] < 0.0)).collect()
    }
}

/// What a header says of a grid's place, in the order of the stored axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Placed {
    pub space: Space,
    /// Positive.
    pub spacing: [f64; 3],
    /// Unit vectors.
    pub directions: [[f64; 3]; 3],
    /// Of the stored voxel (0, 0, 0).
    pub origin: [f64; 3],
    /// Axes that negative spacing turned round, where the space is not known.
    pub backward: [bool; 3],
}

impl Placed {
    /// A grid of which nothing is known but its spacing, which turns an axis round where it is negative.
    pub fn unknown(spacing: [f64; 3], origin: [f64; 3]) -> Self {
        let mut directions = World::default().directions;
        for (axis, direction) in directions.iter_mut().enumerate() {
            direction[axis] = 1f64.copysign(spacing[axis]);
        }
        let backward = spacing.map(|s| s < 0.0);
        Self { space: Space::Unknown, spacing: spacing.map(f64::abs), directions, origin, backward }
    }

    /// A grid of known steps along its axes, each of a length and a sense; `None` where an axis has no known direction.
    ///
    /// The error says what is wrong with the directions.
    pub fn steps(
        space: Space,
        steps: [Option<[f64; 3]>; 3],
        spacing: [f64; 3],
        origin: [f64; 3],
    ) -> Result<Self, &'static str> {
        let unit = steps.map(|step| step.map(|step| DVec3::from(step).normalize_or_zero()));
        let mut known: Vec<DVec3> = unit.iter().flatten().copied().collect();
        let mut directions = unit.map(Option::unwrap_or_default);
        for axis in 0..3 {
            if unit[axis].is_none() {
                directions[axis] = across(&known, axis);
                known.push(directions[axis]);
            }
        }
        let [x, y, z] = directions;
        if x.cross(y).dot(z).abs() < 1e-6 {
            return Err("the directions of the axes lie in one plane");
        }
        Ok(Self { space, spacing, directions: directions.map(|d| d.to_array()), origin, backward: [false; 3] })
    }

    /// How the axes are taken.
    pub fn order(&self, ordering: Ordering) -> AxisOrder {
        match (ordering, self.space) {
            (Ordering::AsStored, _) => AxisOrder::default(),
            (Ordering::Ras, Space::Unknown) => AxisOrder { backward: self.backward, ..AxisOrder::default() },
            (Ordering::Ras, _) => AxisOrder::closest(self.directions),
        }
    }

    /// Spacing, origin and world of the grid that comes of stored `dims` in this order.
    pub fn grid(&self, dims: [usize; 3], order: AxisOrder) -> ([f64; 3], [f64; 3], World) {
        let mut origin = DVec3::from(self.origin);
        let mut directions = self.directions;
        for axis in 0..3 {
            if order.backward[axis] {
                let direction = DVec3::from(directions[axis]);
                origin += direction * self.spacing[axis] * (dims[axis] - 1) as f64;
                directions[axis] = (-direction).to_array();
            }
        }
        // No negative zeros.
        let clean = |v: [f64; 3]| v.map(|c| c + 0.0);
        let world = World { space: self.space, directions: order.turn(directions).map(clean), taken: order };
        (order.turn(self.spacing), clean(origin.to_array()), world)
    }
}

/// A direction at right angles to those known, that of world axis `axis` where it can be.
fn across(known: &[DVec3], axis: usize) -> DVec3 {
    if let [a, b] = known
        && a.cross(*b).length() > 1e-6
    {
        let normal = a.cross(*b).normalize();
        return if normal[axis] < 0.0 { -normal } else { normal };
    }
    let rest = |a: usize| {
        known.iter().fold(DVec3::AXES[a], |rest, k| rest - *k * k.dot(rest) / k.length_squared().max(1e-300))
    };
    let best = [axis, (axis + 1) % 3, (axis + 2) % 3].into_iter().map(rest).find(|rest| rest.length() > 0.5);
    best.unwrap_or(DVec3::AXES[axis]).normalize()
}
