//! The 48 symmetries of the cube.

use cube3_volume::Volume;

/// The axes behind x, y, z of a turned volume, and which of them run backwards.
pub struct Turn {
    pub axis: [usize; 3],
    pub reversed: [bool; 3],
}

/// All of them.
pub fn all_turns() -> Vec<Turn> {
    let axes = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let turn = |axis| (0..8).map(move |bits| Turn { axis, reversed: [0, 1, 2].map(|i| bits >> i & 1 == 1) });
    axes.into_iter().flat_map(turn).collect()
}

impl Turn {
    /// The turned volume.
    pub fn volume(&self, volume: &Volume) -> Volume {
        let dims = self.axis.map(|a| volume.dims[a]);
        let spacing = self.axis.map(|a| volume.spacing[a]);
        Volume::from_fn(dims, spacing, |x, y, z| {
            let at = [x, y, z];
            let mut from = [0; 3];
            for i in 0..3 {
                from[self.axis[i]] = if self.reversed[i] { dims[i] - 1 - at[i] } else { at[i] };
            }
            volume.value(from[0], from[1], from[2]) as u8
        })
        .unwrap()
    }

    /// A direction, turned with it.
    pub fn direction(&self, direction: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| if self.reversed[i] { -direction[self.axis[i]] } else { direction[self.axis[i]] })
    }
}
