//! Samples of one plane.

/// Rows of one plane, one for each depth.
pub(crate) struct Plane {
    stride: usize,
    words: Vec<i32>,
}

impl Plane {
    pub fn new(stride: usize, depths: usize) -> Plane {
        Plane { stride, words: vec![0; stride * depths] }
    }

    pub fn row(&self, k: usize) -> &[i32] {
        &self.words[k * self.stride..(k + 1) * self.stride]
    }

    pub fn row_mut(&mut self, k: usize) -> &mut [i32] {
        &mut self.words[k * self.stride..(k + 1) * self.stride]
    }
}
