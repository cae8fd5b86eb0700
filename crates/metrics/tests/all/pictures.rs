//! Image errors against closed forms.

use bitvec::prelude::*;
use cube3_cases::cases;
use cube3_metrics::{ImageComparison, ImageError, MetricsError, compare, difference, footprint, suggested_factor};
use cube3_picture::{Picture, PictureError};
use proptest::prelude::*;

const EQUAL: ImageError = ImageError {
    mean_relative: 0.0,
    rms: 0.0,
    max: 0.0,
    psnr_db: None,
    fraction_off: 0.0,
    percentile_99: 0.0,
    bias: 0.0,
};

fn grey(width: usize, height: usize, value: f64) -> Picture {
    Picture::filled(width, height, [value; 3]).unwrap()
}

fn whole(a: &Picture, b: &Picture) -> ImageError {
    compare(a, b, None).unwrap().whole
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * a.abs().max(b.abs())
}

#[test]
fn equal_pictures_have_no_error_and_no_finite_psnr() {
    let picture = grey(4, 3, 0.3);
    let comparison = compare(&picture, &picture, None).unwrap();
    assert_eq!(comparison.whole, EQUAL);
    assert_eq!(comparison.footprint, Some(EQUAL));
    assert_eq!(comparison.footprint_pixels, 12);
    let json = serde_json::to_value(comparison.whole).unwrap();
    assert!(json["psnr_db"].is_null());
    assert_eq!(serde_json::from_value::<ImageError>(json).unwrap(), EQUAL);
}

#[test]
fn black_against_white_is_the_largest_error() {
    let error = whole(&grey(7, 5, 0.0), &grey(7, 5, 1.0));
    assert_eq!(error.mean_relative, 1.0);
    assert_eq!((error.rms, error.max, error.fraction_off), (1.0, 1.0, 1.0));
    assert_eq!(error.psnr_db, Some(0.0));
    assert_eq!((error.percentile_99, error.bias), (1.0, -1.0));
}

#[test]
fn a_constant_offset_is_every_one_of_its_errors() {
    let error = whole(&grey(64, 64, 0.25), &grey(64, 64, 0.375));
    assert_eq!((error.mean_relative, error.rms, error.max), (0.125, 0.125, 0.125));
    assert_eq!((error.percentile_99, error.bias), (0.125, -0.125));
    assert!(close(error.psnr_db.unwrap(), 20.0 * 8.0_f64.log10()));
}

#[test]
fn one_channel_of_one_pixel_off() {
    let a = grey(10, 10, 0.0);
    let mut b = a.clone();
    b.pixels[37][1] = 0.5;
    let error = whole(&a, &b);
    assert!(close(error.mean_relative, 0.5 / 3.0_f64.sqrt() / 100.0));
    assert!(close(error.rms, 0.5 / 300.0_f64.sqrt()));
    assert!(close(error.psnr_db.unwrap(), 10.0 * 1200.0_f64.log10()));
    assert_eq!((error.max, error.fraction_off), (0.5, 0.01));
    assert!(close(error.bias, -0.5 / 300.0));
}

/// A picture of `count` pixels in a row, `off` of which are grey of a half and the others black.
fn row(count: usize, off: usize) -> Picture {
    Picture::new(count, 1, (0..count).map(|x| [if x % count < off { 0.5 } else { 0.0 }; 3]).collect()).unwrap()
}

#[test]
fn the_percentile_is_passed_by_one_pixel_of_a_hundred_and_not_by_more() {
    for (count, off, percentile) in [
        (100, 0, 0.0),
        (100, 1, 0.0),
        (100, 2, 0.5),
        (1000, 10, 0.0),
        (1000, 11, 0.5),
        // Of fewer than a hundred pixels, one is more than one of a hundred.
        (99, 1, 0.5),
        (1, 1, 0.5),
        (1, 0, 0.0),
        (101, 1, 0.0),
        (101, 2, 0.5),
        (199, 1, 0.0),
        (200, 2, 0.0),
        (200, 3, 0.5),
    ] {
        let error = whole(&row(count, off), &grey(count, 1, 0.0));
        assert_eq!(error.percentile_99, percentile, "{off} of {count}");
    }
}

#[test]
fn the_percentile_of_steps_is_the_step_at_its_rank() {
    let levels = |count: usize| (1..=count).map(move |k| [k as f64 / count as f64; 3]);
    for (count, rank) in [(100, 99), (200, 198), (50, 50), (250, 248)] {
        for turned in [false, true] {
            let mut pixels: Vec<[f64; 3]> = levels(count).collect();
            if turned {
                pixels.reverse();
            }
            let error = whole(&Picture::new(count, 1, pixels).unwrap(), &grey(count, 1, 0.0));
            assert!(close(error.percentile_99, rank as f64 / count as f64), "{count}: {error:?}");
        }
    }
}

#[test]
fn the_percentile_is_of_the_same_distances_as_the_mean() {
    let mut a = grey(1, 1, 0.0);
    a.pixels[0] = [0.3, 0.0, -0.4];
    let error = whole(&a, &grey(1, 1, 0.0));
    assert!(close(error.percentile_99, 0.5 / 3.0_f64.sqrt()));
    assert_eq!(error.percentile_99, error.mean_relative);
    assert_eq!(error.max, 0.4);
}

#[test]
fn the_bias_is_signed_and_cancels() {
    let picture = |values: [f64; 4]| Picture::new(4, 1, values.map(|value| [value; 3]).to_vec()).unwrap();
    let reference = grey(4, 1, 0.5);
    assert_eq!(whole(&picture([0.75, 0.25, 0.75, 0.25]), &reference).bias, 0.0);
    assert_eq!(whole(&picture([0.75; 4]), &reference).bias, 0.25);
    assert_eq!(whole(&picture([0.25; 4]), &reference).bias, -0.25);
    assert_eq!(whole(&picture([1.0, 0.5, 0.5, 0.5]), &reference).bias, 0.125);
    let mut red = reference.clone();
    red.pixels[0][0] = 1.0;
    assert!(close(whole(&red, &reference).bias, 0.5 / 12.0));
}

#[test]
fn percentile_and_bias_over_the_object_leave_the_background_out() {
    let (mut a, b) = (grey(10, 10, 0.0), grey(10, 10, 0.0));
    a.pixels[42] = [0.5; 3];
    let object = footprint(&a, &b, [0.0; 3]).unwrap();
    let error = compare(&a, &b, Some(&object)).unwrap();
    assert_eq!((error.whole.percentile_99, error.whole.bias), (0.0, 0.005));
    let object = error.footprint.unwrap();
    assert_eq!((object.percentile_99, object.bias), (0.5, 0.5));
}

#[test]
fn one_level_is_not_off_and_a_little_more_is() {
    for level in 0..255 {
        let [low, high] = [level, level + 1].map(|level| f64::from(level) / 255.0);
        assert_eq!(whole(&grey(1, 1, low), &grey(1, 1, high)).fraction_off, 0.0, "{level}");
        let more = high + 1e-6;
        assert_eq!(whole(&grey(1, 1, low), &grey(1, 1, more)).fraction_off, 1.0, "{level}");
    }
}

#[test]
fn the_footprint_is_not_diluted_by_background() {
    let background = [0.1, 0.2, 0.3];
    let mut a = Picture::filled(10, 10, background).unwrap();
    let mut b = a.clone();
    a.pixels[3] = [0.6, 0.7, 0.8];
    b.pixels[96] = [0.6, 0.7, 0.8];
    b.pixels[97] = [0.6, 0.7, 0.8];
    a.pixels[97] = [0.6, 0.7, 0.8];
    let mask = footprint(&a, &b, background).unwrap();
    assert_eq!(mask.iter_ones().collect::<Vec<_>>(), [3, 96, 97]);
    let comparison = compare(&a, &b, Some(&mask)).unwrap();
    assert_eq!(comparison.footprint_pixels, 3);
    let object = comparison.footprint.unwrap();
    assert!(close(object.mean_relative, 0.5 * 2.0 / 3.0));
    assert!(close(comparison.whole.mean_relative, 0.5 * 2.0 / 100.0));
    assert_eq!(object.max, comparison.whole.max);
}

#[test]
fn an_empty_footprint_has_no_error() {
    let comparison = compare(&grey(2, 2, 0.0), &grey(2, 2, 1.0), Some(&bitvec![0; 4])).unwrap();
    assert_eq!((comparison.footprint, comparison.footprint_pixels), (None, 0));
    assert_eq!(comparison.whole.max, 1.0);
}

#[test]
fn the_tiniest_and_the_greatest_differences_are_measured() {
    for apart in [5e-324, 1e-200, 1e-20, 1e200] {
        let error = whole(&grey(3, 3, 0.0), &grey(3, 3, apart));
        assert_eq!((error.rms, error.max), (apart, apart));
        assert_eq!(error.mean_relative, apart);
        assert_eq!((error.percentile_99, error.bias), (apart, -apart));
        assert!(close(error.psnr_db.unwrap(), -20.0 * apart.log10()), "{apart}");
    }
    let far = compare(&grey(1, 1, f64::MAX), &grey(1, 1, -f64::MAX), None);
    assert_eq!(far.unwrap_err(), MetricsError::DifferenceOverflow { x: 0, y: 0 });
}

#[test]
fn a_picture_that_is_not_finite_is_named_by_its_pixel() {
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let good = grey(4, 4, 0.0);
        let mut bad = good.clone();
        bad.pixels[9][2] = value;
        for (a, b) in [(&good, &bad), (&bad, &good), (&bad, &bad)] {
            let errors = [
                compare(a, b, None).unwrap_err(),
                footprint(a, b, [0.0; 3]).unwrap_err(),
                difference(a, b, 1.0).unwrap_err(),
            ];
            for error in errors {
                assert!(
                    matches!(error, MetricsError::Picture(PictureError::PixelNotFinite { x: 1, y: 2, channel: 2, .. })),
                    "{error}"
                );
            }
        }
    }
    let good = grey(1, 1, 0.0);
    assert!(footprint(&good, &good, [0.0, f64::NAN, 0.0]).is_err());
}

#[test]
fn sizes_must_agree() {
    let error = compare(&grey(2, 3, 0.0), &grey(3, 2, 0.0), None).unwrap_err();
    assert_eq!(error, PictureError::SizeMismatch { a: [2, 3], b: [3, 2] }.into());
    let error = compare(&grey(2, 3, 0.0), &grey(2, 3, 0.0), Some(&bitvec![1; 5])).unwrap_err();
    assert_eq!(error, MetricsError::MaskLength { expected: 6, found: 5 });
    let lying = Picture { width: 2, height: 3, pixels: Vec::new() };
    assert!(matches!(
        compare(&lying, &lying, None),
        Err(MetricsError::Picture(PictureError::WrongLength { expected: 6, found: 0, .. }))
    ));
}

#[test]
fn a_picture_needs_pixels_that_can_be_counted() {
    let new = |width, height| Picture::new(width, height, Vec::new()).unwrap_err();
    assert_eq!(new(0, 4), PictureError::EmptyPicture { width: 0, height: 4 });
    assert_eq!(new(usize::MAX, 2), PictureError::TooLarge { width: usize::MAX, height: 2 });
    assert!(matches!(new(2, 2), PictureError::WrongLength { expected: 4, found: 0, .. }));
}

#[test]
fn the_difference_picture_is_magnified_and_clipped() {
    let a = Picture::new(1, 2, vec![[0.5, 0.5, 0.5], [0.0, 1.0, 0.25]]).unwrap();
    let b = Picture::new(1, 2, vec![[0.5, 0.25, 0.75], [1.0, 0.0, 0.375]]).unwrap();
    let magnified = difference(&a, &b, 2.0).unwrap();
    assert_eq!(magnified.pixels, [[0.0, 0.5, 0.5], [1.0, 1.0, 0.25]]);
    assert_eq!(difference(&a, &b, 0.0).unwrap().pixels, [[0.0; 3]; 2]);
    for factor in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(difference(&a, &b, factor), Err(MetricsError::BadNumber { .. })));
    }
}

#[test]
fn the_factor_makes_the_largest_difference_visible_without_clipping() {
    let expected = [
        (0.0, 1),
        (1.0, 1),
        (0.51, 1),
        (0.5, 2),
        (0.2, 5),
        (0.1, 10),
        (0.05, 20),
        (0.02, 50),
        (0.01, 100),
        (1.0 / 255.0, 200),
        (1e-9, 200),
        (3.0, 1),
        (f64::NAN, 1),
    ];
    for (max_difference, factor) in expected {
        assert_eq!(suggested_factor(max_difference), factor, "{max_difference}");
    }
}

fn pictures(count: usize) -> impl Strategy<Value = Vec<Picture>> {
    (1_usize..7, 1_usize..7).prop_flat_map(move |(width, height)| {
        let pixels = proptest::collection::vec(proptest::array::uniform3(0.0..=1.0), width * height);
        let picture = pixels.prop_map(move |pixels| Picture { width, height, pixels });
        proptest::collection::vec(picture, count)
    })
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn order_matters_to_the_sign_of_the_bias_alone(pair in pictures(2)) {
        let (a, b) = (&pair[0], &pair[1]);
        let (forth, back) = (whole(a, b), whole(b, a));
        prop_assert_eq!(forth.bias, -back.bias);
        prop_assert_eq!(forth, ImageError { bias: forth.bias, ..back });
        prop_assert_eq!(difference(a, b, 3.0).unwrap(), difference(b, a, 3.0).unwrap());
    }

    #[test]
    fn errors_are_ordered_and_bounded(pair in pictures(2)) {
        let error = whole(&pair[0], &pair[1]);
        let slack = 1.0 + 1e-12;
        prop_assert!(0.0 <= error.mean_relative && error.mean_relative <= error.rms * slack);
        prop_assert!(error.rms <= error.max * slack && error.max <= 1.0);
        prop_assert!(0.0 <= error.percentile_99 && error.percentile_99 <= error.max * slack);
        prop_assert!(error.bias.abs() <= error.mean_relative * slack);
        prop_assert!((0.0..=1.0).contains(&error.fraction_off));
        prop_assert!(error.psnr_db.is_none_or(|psnr| psnr >= -1e-9));
    }

    #[test]
    fn halving_both_pictures_halves_the_error(pair in pictures(2)) {
        let half = |picture: &Picture| {
            let pixels = picture.pixels.iter().map(|pixel| pixel.map(|value| value / 2.0));
            Picture { pixels: pixels.collect(), ..*picture }
        };
        let full = whole(&pair[0], &pair[1]);
        let halved = whole(&half(&pair[0]), &half(&pair[1]));
        prop_assert!(close(halved.mean_relative, full.mean_relative / 2.0));
        prop_assert!(close(halved.rms, full.rms / 2.0));
        prop_assert_eq!(halved.max, full.max / 2.0);
    }

    #[test]
    fn the_triangle_inequality_holds(three in pictures(3)) {
        let far = |i: usize, j: usize| whole(&three[i], &three[j]);
        let slack = 1e-12;
        prop_assert!(far(0, 2).mean_relative <= far(0, 1).mean_relative + far(1, 2).mean_relative + slack);
        prop_assert!(far(0, 2).rms <= far(0, 1).rms + far(1, 2).rms + slack);
        prop_assert!(far(0, 2).max <= far(0, 1).max + far(1, 2).max + slack);
    }

    #[test]
    fn two_footprints_make_the_whole(pair in pictures(2), bits: u64) {
        let count = pair[0].pixels.len();
        let mask: BitVec = (0..count).map(|index| bits >> (index % 64) & 1 == 1).collect();
        let inside = compare(&pair[0], &pair[1], Some(&mask)).unwrap();
        let outside = compare(&pair[0], &pair[1], Some(&!mask)).unwrap();
        let of = |part: &ImageComparison| part.footprint.map_or(0.0, |e| e.mean_relative) * part.footprint_pixels as f64;
        prop_assert!(((of(&inside) + of(&outside)) / count as f64 - inside.whole.mean_relative).abs() < 1e-12);
        let largest = [&inside, &outside].into_iter().filter_map(|part| part.footprint).map(|e| e.max).fold(0.0, f64::max);
        prop_assert_eq!(largest, inside.whole.max);
    }

    #[test]
    fn the_suggested_factor_never_clips(max_difference in 0.0..=1.0_f64) {
        let factor = f64::from(suggested_factor(max_difference));
        prop_assert!(factor * max_difference <= 1.0);
        prop_assert!(max_difference < 0.0025 || factor * max_difference >= 0.4);
    }
}
