//! How many pixels a ray slot gives, from the geometry alone.

use cube3_host::{Geometry, Template};

/// Pixels of each slot of a frame: one, and one more for each depth at which the slot goes over to another ray.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PixelCounts {
    /// For each slot of a plane, the depths at which u changes.
    u: Vec<Vec<u32>>,
    /// For each plane, the depths at which v changes.
    v: Vec<Vec<u32>>,
}

impl PixelCounts {
    /// The seams of a geometry.
    pub fn new(geometry: &Geometry) -> PixelCounts {
        let [slots, planes] = geometry.slot_counts();
        let [closes_u, closes_v] = geometry.closes();
        let depths = geometry.size[2];
        let seams = |count: usize, n: usize, template: &Template, closes: bool| -> Vec<Vec<u32>> {
            let turns = |slot: usize| -> Vec<u32> {
                if !closes {
                    return Vec::new();
                }
                // The k-th change is where the column reaches k·n − slot.
                let first = (1..).map(|turn| template.first_depth((turn * n) as i64 - slot as i64));
                first.take_while(|&depth| depth < depths).filter(|&depth| depth > 0).map(|depth| depth as u32).collect()
            };
            (0..count).map(turns).collect()
        };
        PixelCounts {
            u: seams(slots, geometry.size[0], &geometry.u, closes_u),
            v: seams(planes, geometry.size[1], &geometry.v, closes_v),
        }
    }

    /// Pixels of a slot of a plane.
    #[inline]
    pub fn of(&self, plane: usize, slot: usize) -> u64 {
        let (u, v) = (&self.u[slot], &self.v[plane]);
        let both = if v.is_empty() { 0 } else { u.iter().filter(|depth| v.contains(depth)).count() };
        (1 + u.len() + v.len() - both) as u64
    }

    /// Pixels of the frame.
    pub fn total(&self) -> u64 {
        (0..self.v.len()).flat_map(|plane| (0..self.u.len()).map(move |slot| self.of(plane, slot))).sum()
    }
}
