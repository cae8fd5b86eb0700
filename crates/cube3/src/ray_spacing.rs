//! What a person should know where voxels are so long that the machine's rays, a voxel apart, cannot show their faces.

/// From this ratio of a voxel's side to the shortest on, there is a note. At 4 a face at 45° has steps of four pixels in a picture that shows the
/// shortest side as one.
const LONG: f64 = 4.0;

const AXES: [&str; 3] = ["x", "y", "z"];

/// A note for each axis of a volume whose voxels are long along it.
pub(crate) fn notes(dims: [usize; 3], spacing: [f64; 3]) -> Vec<String> {
    let shortest = cube3_scene::smallest_spacing(spacing);
    let long = |&axis: &usize| dims[axis] > 1 && spacing[axis] >= LONG * shortest;
    let note = |axis: usize| {
        let (name, ratio) = (AXES[axis], (spacing[axis] / shortest * 100.0).round() / 100.0);
        let cubes = ((dims[axis] - 1) as f64 * spacing[axis] / shortest).round() as u64 + 1;
        format!(
            "voxels are {ratio} times as long along {name} as along the shortest side, and rays and samples are a voxel apart: faces that \
             are seen at a slant come out in steps; interpolate the volume along {name} before ({cubes} slices make cubes)"
        )
    };
    (0..3).filter(long).map(note).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_voxels_have_a_note_with_the_slices_that_make_cubes() {
        assert!(notes([128; 3], [1.0, 1.0, 2.0]).is_empty());
        assert!(notes([128, 128, 1], [2.0, 2.0, 53.0]).is_empty(), "one slice has no next");
        let told = notes([128, 128, 10], [2.0, 2.0, 53.0]);
        assert_eq!(told.len(), 1);
        assert!(told[0].contains("26.5 times as long along z") && told[0].contains("240 slices"), "{told:?}");
    }
}
