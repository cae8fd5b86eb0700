//! Interpolation in one cell of eight voxels.

/// From `near` to `far` by `weight`: exact for equal ends and at weight 0.
#[inline(always)]
pub fn lerp(near: f64, far: f64, weight: f64) -> f64 {
    near + weight * (far - near)
}

/// Seven lerps, in the order of Pfister et al. 1995, section 3: four along w, two along u, one along v.
///
/// `corners[k][j][i]` is the voxel of plane k, row j, column i; the weights, 0 to 1, are along u, v, w. The four corners of the
/// far plane need not lie behind those of the near one: that is all that sheared interpolation is.
#[inline(always)]
pub fn cell(corners: [[[f64; 2]; 2]; 2], weights: [f64; 3]) -> f64 {
    let [near, far] = corners;
    let along_w = |j: usize, i: usize| lerp(near[j][i], far[j][i], weights[2]);
    let along_u = |j: usize| lerp(along_w(j, 0), along_w(j, 1), weights[0]);
    lerp(along_u(0), along_u(1), weights[1])
}
