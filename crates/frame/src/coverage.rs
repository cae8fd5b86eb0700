//! How well the rays of an eye cover the voxels.

use crate::{Fan, Geometry, PerspectivePass};

/// How well the rays of a pass cover the voxels between its outermost ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayCoverage {
    /// Distance between rays at the plane behind the last, in voxels.
    pub back_spacing: f64,
    /// Voxels that are in no cell column of any ray, as a fraction of those between the outermost rays.
    pub unused: f64,
    /// Largest distance between the two columns of a cell, in voxels.
    pub widest_cell: u32,
}

impl Geometry {
    /// The undersampling of a perspective pass, exactly as its rays have it.
    pub fn coverage(&self) -> Option<RayCoverage> {
        let pass = self.perspective.as_ref()?;
        let depths = pass.first_depth..self.size[2];
        let (mut met, mut all) = (0_u64, 0_u64);
        for k in depths.clone() {
            let [u, v] = [columns_met(&pass.u, k, self.size[0]), columns_met(&pass.v, k, self.size[1])];
            met += u[0] * v[0];
            all += u[1] * v[1];
        }
        let widest = |fan: &Fan| {
            let of_depth = |k: usize| fan.valid(k).map(move |i| (fan.right(i, k) - fan.near(i, k)) as u32);
            depths.clone().flat_map(of_depth).max().unwrap_or(0)
        };
        Some(RayCoverage {
            back_spacing: pass.back_spacing(self.size[2]),
            unused: if all > 0 { 1.0 - met as f64 / all as f64 } else { 0.0 },
            widest_cell: widest(&pass.u).max(widest(&pass.v)),
        })
    }
}

impl PerspectivePass {
    /// Distance between rays at plane `depths`, behind the last.
    pub fn back_spacing(&self, depths: usize) -> f64 {
        self.spacing_at(depths as i64, 0, 0)
    }
}

/// Columns of the volume at a depth that cells have, and all from the first of them to the last.
fn columns_met(fan: &Fan, k: usize, columns: usize) -> [u64; 2] {
    let (mut met, mut first, mut last) = (0, None, -1);
    for i in 0..fan.count() {
        for column in [fan.near(i, k), fan.right(i, k)] {
            if column > last && (0..columns as i32).contains(&column) {
                met += 1;
                last = column;
                first = first.or(Some(column));
            }
        }
    }
    [met, first.map_or(0, |first| (last - first + 1) as u64)]
}
