//! A ray's piece in one cell: the field, its gradient and the depth cue along it.
//!
//! Inside of a cell a trilinear field is a cubic along a line, and so is each component of the interpolated central differences.

use crate::polynomial::Cubic;
use cube3_reference::{Grid, Line, LinearCue};
use cube3_volume::Sample;

/// The corners of a cell, x fastest.
pub(crate) type Corners = [f64; 8];

/// What rays ask of a volume.
pub(crate) trait Field: Sync {
    /// The values at the corners of the cell whose smallest corner is given.
    fn corners(&self, corner: [isize; 3]) -> Corners;
    /// The components of the gradient at the corners, in values for the smallest voxel spacing.
    fn gradients(&self, corner: [isize; 3]) -> [Corners; 3];
}

/// The central difference at a voxel along an axis, in values for the smallest spacing.
fn difference<S: Sample>(grid: &Grid<'_, S>, at: [isize; 3], axis: usize) -> f64 {
    let beside = |by: isize| {
        let mut at = at;
        at[axis] += by;
        grid.voxel(at)
    };
    (beside(1) - beside(-1)) * 0.5 / grid.per_voxel[axis]
}

/// Something of each corner of a cell; of a voxel of labels of itself.
fn at_corners<S: Sample>(grid: &Grid<'_, S>, corner: [isize; 3], of: impl Fn([isize; 3]) -> f64) -> Corners {
    if grid.nearest() {
        return [of(corner); 8];
    }
    let beside = |i: usize, axis: usize| corner[axis] + (i >> axis & 1) as isize;
    [0, 1, 2, 3, 4, 5, 6, 7].map(|i| of([beside(i, 0), beside(i, 1), beside(i, 2)]))
}

impl<S: Sample> Field for Grid<'_, S> {
    fn corners(&self, corner: [isize; 3]) -> Corners {
        let inside = |i: usize| corner[i] >= 0 && (corner[i] as usize) + 1 < self.dims[i];
        if self.nearest() || !(inside(0) && inside(1) && inside(2)) {
            return at_corners(self, corner, |at| self.voxel(at));
        }
        let [x, y, z] = corner.map(|i| i as usize);
        let (row, slice) = (self.dims[0], self.dims[0] * self.dims[1]);
        let first = z * slice + y * row + x;
        let voxels = &self.samples[first..first + slice + row + 2];
        [0, 1, row, row + 1, slice, slice + 1, slice + row, slice + row + 1].map(|i| voxels[i].into())
    }

    fn gradients(&self, corner: [isize; 3]) -> [Corners; 3] {
        [0, 1, 2].map(|axis| at_corners(self, corner, |at| difference(self, at, axis)))
    }
}

/// The field of a cell along a line: from `start`, a place in the cell, 0 to 1 along each axis, `rate` of it for one of the parameter.
pub(crate) fn along(corners: &Corners, start: [f64; 3], rate: [f64; 3]) -> Cubic {
    let [x, y, z] = start;
    let [dx, dy, dz] = rate;
    let lerp = |a: f64, b: f64, w: f64| a + w * (b - a);
    let c = corners;
    // Differences along x at the four edges, and what is left of the corners at the line's x.
    let slope = [c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6]];
    let value = [c[0] + x * slope[0], c[2] + x * slope[1], c[4] + x * slope[2], c[6] + x * slope[3]];
    let across = |p: [f64; 4]| [p[1] - p[0], p[3] - p[2]];
    let inside = |p: [f64; 4]| [lerp(p[0], p[1], y), lerp(p[2], p[3], y)];
    let (fx, fy) = (inside(slope), across(value));
    let fxy = across(slope);
    let f = inside(value);
    let at = |p: [f64; 2]| lerp(p[0], p[1], z);
    let rise = |p: [f64; 2]| p[1] - p[0];
    [
        at(f),
        dx * at(fx) + dy * at(fy) + dz * rise(f),
        dx * dy * at(fxy) + dz * (dx * rise(fx) + dy * rise(fy)),
        dx * dy * dz * rise(fxy),
    ]
}

/// The least and the largest of a cell's corners, between which all of it is.
pub(crate) fn extremes(corners: &Corners) -> [f64; 2] {
    corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &c| [low.min(c), high.max(c)])
}

/// The gradient along a piece, divided by `scale` so that nothing over- or underflows; all zero where the field is flat.
#[derive(Clone, Debug)]
pub(crate) struct Gradient {
    pub along: [Cubic; 3],
    pub scale: f64,
    /// What rounding moves each component of the scaled gradient by.
    pub slack: [f64; 3],
}

/// The stretch of a ray in one cell, as polynomials of the way from where it begins.
#[derive(Clone, Debug)]
pub(crate) struct Piece {
    pub length: f64,
    pub value: Cubic,
    /// What rounding moves the value by.
    pub slack: f64,
    /// Where it is wanted.
    pub gradient: Option<Gradient>,
    /// The factor of the depth cue where it begins, and its rate.
    pub cue: [f64; 2],
    /// What rounding moves the ends by.
    pub end_slack: f64,
}

/// Where a piece lies.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    /// The cell.
    pub corner: [isize; 3],
    /// The parameters of its ends.
    pub ends: [f64; 2],
}

impl Place {
    /// The piece of a ray there; `corners` are the cell's.
    pub fn piece(
        &self,
        field: &dyn Field,
        corners: &Corners,
        line: &Line,
        wants_gradient: bool,
        cue: Option<&LinearCue<'_>>,
    ) -> Piece {
        let [enter, leave] = self.ends;
        let at = [0, 1, 2].map(|i| line.origin[i] + line.direction[i] * enter);
        let start = [0, 1, 2].map(|i| at[i] - self.corner[i] as f64);
        // Rounding of the place in the cell: of the product, of the sum and of what is left.
        let largest =
            (0..3).fold(1.0_f64, |most, i| most.max(line.origin[i].abs()).max((at[i] - line.origin[i]).abs()));
        let moved = 4.0 * f64::EPSILON * largest;
        let slack = |corners: &Corners| {
            let [low, high] = extremes(corners);
            let apart = high - low;
            if apart == 0.0 {
                0.0
            } else {
                apart * (3.0 * moved + 64.0 * f64::EPSILON) + 4.0 * f64::EPSILON * low.abs().max(high.abs())
            }
        };
        let gradient = wants_gradient.then(|| {
            let components = field.gradients(self.corner);
            let scale = components.iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
            if scale == 0.0 {
                return Gradient { along: [[0.0; 4]; 3], scale: 1.0, slack: [0.0; 3] };
            }
            // Division by a power of two changes no digit.
            let scale = libm::exp2(libm::floor(libm::log2(scale)));
            let scaled = components.map(|corners| corners.map(|c| c / scale));
            // A difference of voxels and its division by the spacing are rounded; one of equal voxels is exact.
            let rounded = |corners: &Corners| if corners.iter().all(|c| *c == 0.0) { 0.0 } else { 16.0 * f64::EPSILON };
            Gradient {
                along: [0, 1, 2].map(|i| along(&scaled[i], start, line.direction)),
                scale,
                slack: [0, 1, 2].map(|i| slack(&scaled[i]) + rounded(&scaled[i])),
            }
        });
        let cue = cue.map_or([1.0, 0.0], |linear| {
            let [depth, rate] = depth_along(linear, line, enter);
            let [front, back] = [linear.cue.front, linear.cue.back];
            // Beyond the corners' depths the factor is that of the nearest; the piece has been cut there.
            match depth + rate * (leave - enter) / 2.0 {
                ..=0.0 => [front, 0.0],
                1.0.. => [back, 0.0],
                _ => [front + (back - front) * depth, (back - front) * rate],
            }
        });
        Piece {
            length: leave - enter,
            value: along(corners, start, line.direction),
            slack: slack(corners),
            gradient,
            cue,
            end_slack: 4.0 * f64::EPSILON * (enter.abs() + leave.abs()),
        }
    }
}

/// The depth that a cue goes by at a ray's parameter, and its rate.
pub(crate) fn depth_along(cue: &LinearCue<'_>, line: &Line, parameter: f64) -> [f64; 2] {
    let at = |i: usize| line.origin[i] + line.direction[i] * parameter;
    let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(|i| cue.rate[i] * of(i)).sum::<f64>();
    [cue.first + sum(&at), sum(&|i| line.direction[i])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::polynomial;
    use cube3_cases::cases;
    use cube3_reference::cell;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(cases(256))]

        /// The cubic is what seven lerps give at every place of the line.
        #[test]
        fn along_a_line_it_is_the_interpolation(
            corners in prop::array::uniform8(-2.0..2.0_f64), start in prop::array::uniform3(0.0..1.0_f64),
            rate in prop::array::uniform3(-1.0..1.0_f64), s in 0.0..1.0_f64,
        ) {
            let place = [0, 1, 2].map(|i| start[i] + s * rate[i]);
            let pair = |i: usize| [corners[i], corners[i + 1]];
            let expected = cell([[pair(0), pair(2)], [pair(4), pair(6)]], place);
            let got = polynomial::at(&along(&corners, start, rate), s);
            prop_assert!((got - expected).abs() < 1e-13, "{got} {expected}");
        }
    }
}
