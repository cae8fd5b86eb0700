//! PNG files come back as they went.

use cube3_cases::cases;
use cube3_picture::Picture;
use cube3_report::{ReportError, png_rgb8, to_rgb8};
use proptest::prelude::*;

/// Width, height and bytes of an 8-bit RGB picture.
fn decode(file: &[u8]) -> (usize, usize, Vec<u8>) {
    let mut reader = png::Decoder::new(std::io::Cursor::new(file)).read_info().unwrap();
    let mut rgb = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut rgb).unwrap();
    assert_eq!((frame.color_type, frame.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    (frame.width as usize, frame.height as usize, rgb)
}

#[test]
fn words_round_to_the_nearest_level_and_clip() {
    let pixels = vec![
        [0.0, 1.0, 0.5],
        [0.499 / 255.0, 0.501 / 255.0, 254.5 / 255.0],
        [-1.0, 2.0, f64::NAN],
        [f64::NEG_INFINITY, f64::INFINITY, -0.0],
    ];
    let picture = Picture::new(2, 2, pixels).unwrap();
    assert_eq!(to_rgb8(&picture), [0, 255, 128, 0, 1, 255, 0, 255, 0, 0, 255, 0]);
}

#[test]
fn every_level_comes_back() {
    let pixels = (0..=255).map(|level| [f64::from(level) / 255.0; 3]).collect();
    let picture = Picture::new(256, 1, pixels).unwrap();
    let levels: Vec<u8> = to_rgb8(&picture).into_iter().step_by(3).collect();
    assert_eq!(levels, (0..=255).collect::<Vec<u8>>());
}

#[test]
fn a_picture_of_the_wrong_size_is_refused() {
    for (width, height, bytes) in [(2, 2, 11), (2, 2, 13), (0, 0, 0), (0, 5, 0), (usize::MAX, 2, 6), (usize::MAX, 1, 6)]
    {
        let error = png_rgb8(width, height, &vec![0; bytes]).unwrap_err();
        assert!(matches!(error, ReportError::PictureSize { .. }), "{error}");
    }
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn any_picture_comes_back(width in 1_usize..9, height in 1_usize..9, seed: [u8; 32]) {
        let bytes: Vec<u8> =
            (0..3 * width * height).map(|i| seed[i % 32].wrapping_mul(i as u8)).collect();
        let file = png_rgb8(width, height, &bytes).unwrap();
        prop_assert_eq!(decode(&file), (width, height, bytes.clone()));
        prop_assert_eq!(png_rgb8(width, height, &bytes).unwrap(), file);
    }
}
