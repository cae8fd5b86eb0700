//! A frame buffer that is written while it is read, and the limit of its memory.

use cube3_cfb::golden::Skew;
use cube3_cfb::{FrameBuffer, FrameBufferError};
use cube3_frame::Axes;
use cube3_machine::Layout;

const DIMS: [usize; 3] = [5, 3, 2];
const AXES: Axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };

fn buffer(layout: Layout) -> FrameBuffer {
    let skew = Skew { coefficients: [1, 1, 1], lanes: 4 };
    let old: Vec<u16> = (0..30).collect();
    FrameBuffer::with_layout(skew, layout, DIMS, &old).unwrap()
}

/// All voxels, x fastest, read beam by beam.
fn voxels(buffer: &FrameBuffer) -> Vec<u16> {
    assert_eq!(buffer.dims(), DIMS);
    let mut all = Vec::new();
    let mut beam = Vec::new();
    for w in 0..2 {
        for v in 0..3 {
            buffer.fetch(&AXES, v, w, &mut beam);
            // Chunks of four lanes, turned by the skew.
            all.extend((0..5).map(|u| beam[u / 4 * 4 + (u + v + w) % 4]));
        }
    }
    all
}

#[test]
fn words_that_come_in_are_there_at_once_and_the_others_stay() {
    for layout in Layout::ALL {
        let mut buffer = buffer(layout);
        let incoming: Vec<Vec<u16>> = vec![(100..130).collect(), (200..230).collect()];
        buffer.receive(incoming, false);
        let mut expected: Vec<u16> = (0..30).collect();
        assert_eq!(voxels(&buffer), expected);
        for (words, volume) in [(0..7, 100), (7..29, 100), (29..30, 100), (30..41, 200)] {
            buffer.write(words.clone());
            for word in words {
                expected[word as usize % 30] = volume + word as u16 % 30;
            }
            assert_eq!(voxels(&buffer), expected);
        }
        // There is no third volume, and no second half to swap with.
        buffer.write(60..63);
        buffer.swap();
        assert_eq!(voxels(&buffer), expected);
    }
}

#[test]
fn a_double_buffer_shows_a_volume_when_its_halves_change_roles() {
    let mut buffer = buffer(Layout::Rows);
    let new: Vec<u16> = (100..130).collect();
    buffer.receive(vec![new.clone()], true);
    buffer.write(0..30);
    let old: Vec<u16> = (0..30).collect();
    assert_eq!(voxels(&buffer), old);
    buffer.swap();
    assert_eq!(voxels(&buffer), new);
    buffer.swap();
    assert_eq!(voxels(&buffer), old);
}

#[test]
fn a_buffer_beyond_the_limit_is_refused_with_its_bytes_before_memory_is_taken() {
    // One voxel, but all words of a row are in one module; and a volume that is too large.
    for (coefficients, lanes, dims, bytes, depth) in [
        ([0, 1, 1], 65_537, [1; 3], 2 * 65_537 * 65_537, 65_537),
        ([1; 3], 4096, [4096, 4096, 257], 2 * 4096 * 4096 * 257, 1),
    ] {
        // A buffer is too large to be shown.
        let error = FrameBuffer::new(Skew { coefficients, lanes }, dims, &[]).err();
        assert_eq!(error, Some(FrameBufferError::Memory { bytes, limit: FrameBuffer::LIMIT_BYTES, depth }));
    }
}
