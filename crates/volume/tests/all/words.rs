//! Samples to voxel words: the map, its ends, its counts, its refusals.

use cube3_cases::cases;
use cube3_volume::{NonFiniteRule, Samples, Volume, VolumeError, VoxelWords, WordConversion, WordRounding};
use proptest::prelude::*;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

fn line(samples: Samples) -> Volume {
    Volume::new([samples.len(), 1, 1], [1.0; 3], samples).unwrap()
}

fn words(samples: Samples, bits: u32, conversion: WordConversion) -> Vec<u16> {
    line(samples).to_words(bits, &conversion).unwrap().0.words
}

#[test]
fn the_ends_of_the_window_are_the_ends_of_the_word() {
    for bits in 1..=16 {
        let top = ((1u32 << bits) - 1) as u16;
        let (w, report) = line(Samples::F64(vec![-3.0, 7.0, 2.0])).to_words(bits, &WordConversion::default()).unwrap();
        assert_eq!(w.words, [0, top, (f64::from(top) / 2.0).round() as u16]);
        assert_eq!((w.window, report.window), ([-3.0, 7.0], [-3.0, 7.0]));
        assert_eq!((w.value_of(0.0), w.value_of(f64::from(top))), (-3.0, 7.0));
        assert_eq!((w.word_of(-3.0), w.word_of(7.0)), (0.0, f64::from(top)));
    }
}

#[test]
fn words_that_are_the_data_stay_as_they_are_even_truncated() {
    let data: Vec<u16> = (0..=u16::MAX).collect();
    for rounding in [WordRounding::Nearest, WordRounding::Truncate] {
        let conversion = WordConversion { rounding, ..WordConversion::identity(16) };
        assert_eq!(words(Samples::U16(data.clone()), 16, conversion), data);
        // 8 bits to 16: times 257.
        let bytes: Vec<u8> = (0..=255).collect();
        let wide = WordConversion { window: Some([0.0, 255.0]), rounding, ..WordConversion::default() };
        let expected: Vec<u16> = (0..=255).map(|v| v * 257).collect();
        assert_eq!(words(Samples::U8(bytes), 16, wide), expected);
    }
}

#[test]
fn rounding_is_nearest_or_down() {
    let data = Samples::F64(vec![0.0, 0.49, 0.5, 0.99, 1.0, 2.5]);
    let to = |rounding| WordConversion { rounding, ..WordConversion::identity(2) };
    assert_eq!(words(data.clone(), 2, to(WordRounding::Nearest)), [0, 0, 1, 1, 1, 3]);
    assert_eq!(words(data, 2, to(WordRounding::Truncate)), [0, 0, 0, 0, 1, 2]);
}

#[test]
fn clipped_samples_are_saturated_and_counted() {
    let conversion = WordConversion { window: Some([10.0, 20.0]), ..WordConversion::default() };
    let (w, report) = line(Samples::I16(vec![-5, 9, 10, 15, 20, 21, 30000, 22])).to_words(8, &conversion).unwrap();
    assert_eq!(w.words, [0, 0, 0, 128, 255, 255, 255, 255]);
    assert_eq!((report.clipped_below, report.clipped_above, report.masked), (2, 3, 0));
    let text = report.to_string();
    assert!(text.contains("window 10 to 20") && text.contains("25.5 words per unit"), "{text}");
    assert!(text.contains("2 below and 3 above") && text.lines().count() == 2, "{text}");
}

#[test]
fn one_value_gives_word_zero() {
    assert_eq!(words(Samples::U8(vec![7; 4]), 12, WordConversion::default()), [0; 4]);
}

#[test]
fn values_at_the_ends_of_the_number_line_do_not_overflow() {
    let data = Samples::F64(vec![f64::MIN, 0.0, f64::MAX]);
    assert_eq!(words(data, 16, WordConversion::default()), [0, 32768, 65535]);
    let tiny = Samples::F64(vec![0.0, 5e-324, 1e-323]);
    assert_eq!(words(tiny, 16, WordConversion::default()), [0, 32768, 65535]);
    let w = VoxelWords::new([1; 3], [1.0; 3], 16, [f64::MIN, f64::MAX], vec![0]).unwrap();
    assert_eq!((w.value_of(0.0), w.value_of(65535.0)), (f64::MIN, f64::MAX));
}

#[test]
fn not_a_number_is_refused_with_its_place_or_masked_and_counted() {
    let mut data = vec![1.0f32; 3 * 4 * 5];
    data[2 + 3 * (1 + 4 * 3)] = f32::NAN;
    data[59] = f32::NEG_INFINITY;
    data[0] = 0.0;
    let volume = Volume::new([3, 4, 5], [1.0; 3], Samples::F32(data)).unwrap();
    let bad = volume.range().unwrap_err();
    assert_eq!(bad.position, [2, 1, 3]);
    match volume.to_words(8, &WordConversion::default()) {
        Err(VolumeError::NonFinite(bad)) => assert_eq!(bad.position, [2, 1, 3]),
        other => panic!("{other:?}"),
    }
    let mask = WordConversion { non_finite: NonFiniteRule::Mask, ..WordConversion::default() };
    let (w, report) = volume.to_words(8, &mask).unwrap();
    assert_eq!((w.word(2, 1, 3), w.word(2, 3, 4), w.word(1, 0, 0)), (0, 0, 255));
    assert_eq!((report.masked, report.window), (2, [0.0, 1.0]));
    let nothing = line(Samples::F64(vec![f64::NAN, f64::INFINITY]));
    assert_eq!(nothing.to_words(8, &mask).unwrap().0.words, [0, 0]);
}

#[test]
fn bits_windows_and_words_out_of_range_are_refused() {
    let volume = line(Samples::U8(vec![1, 2]));
    for bits in [0, 17, 32, u32::MAX] {
        assert!(volume.to_words(bits, &WordConversion::default()).is_err());
        assert!(volume.to_words(bits, &WordConversion::identity(bits)).is_err());
    }
    for window in [[1.0, 0.0], [f64::NAN, 1.0], [0.0, f64::INFINITY]] {
        let conversion = WordConversion { window: Some(window), ..WordConversion::default() };
        assert!(volume.to_words(8, &conversion).is_err());
    }
    assert!(VoxelWords::new([1; 3], [1.0; 3], 4, [0.0, 15.0], vec![16]).is_err());
    assert!(VoxelWords::new([2, 1, 1], [1.0; 3], 4, [0.0, 15.0], vec![1]).is_err());
    assert!(VoxelWords::from_fn([2, 2, 2], 3, |x, y, z| (x + 2 * y + 4 * z) as u16).is_ok());
}

#[test]
fn grids_that_are_none_are_refused() {
    assert!(Volume::new([0, 1, 1], [1.0; 3], Samples::U8(vec![])).is_err());
    assert!(Volume::new([2, 1, 1], [1.0; 3], Samples::U8(vec![1])).is_err());
    assert!(Volume::new([usize::MAX, 2, 1], [1.0; 3], Samples::U8(vec![])).is_err());
    assert!(Volume::new([1; 3], [1.0, f64::NAN, 1.0], Samples::U8(vec![1])).is_err());
    assert!(Volume::new([1; 3], [1.0; 3], Samples::U8(vec![1])).unwrap().with_origin([f64::NAN; 3]).is_err());
    assert!(Volume::from_fn([usize::MAX; 3], [1.0; 3], |_, _, _| 0u8).is_err());
}

#[test]
fn a_histogram_counts_every_voxel_once() {
    let volume = line(Samples::F64(vec![0.0, 0.1, 0.25, 0.5, 0.75, 1.0]));
    let histogram = volume.histogram(4).unwrap();
    assert_eq!((histogram.low, histogram.high), (0.0, 1.0));
    assert_eq!(histogram.counts, [2, 1, 1, 2]);
    assert_eq!(line(Samples::U8(vec![3; 5])).histogram(2).unwrap().counts, [5, 0]);
    assert_eq!(line(Samples::F64(vec![f64::MIN, f64::MAX])).histogram(2).unwrap().counts, [1, 1]);
    assert!(volume.histogram(0).is_err());
}

#[test]
fn map_rounds_and_saturates() {
    let volume = line(Samples::F64(vec![-1.0, 0.5, 254.6, 1e9]));
    assert_eq!(volume.map::<u8>(|v| v).samples, Samples::U8(vec![0, 1, 255, 255]));
    assert_eq!(volume.map::<f32>(|v| v * 2.0).samples, Samples::F32(vec![-2.0, 1.0, 509.2, 2e9]));
}

proptest! {
    #![proptest_config(cases(256))]

    /// A word is within half a step of its value, and the order of values is kept.
    #[test]
    fn words_stand_for_their_values(data in prop::collection::vec(-1e6..1e6f64, 2..40), bits in 1u32..=16) {
        let volume = line(Samples::F64(data.clone()));
        let (w, report) = volume.to_words(bits, &WordConversion::default()).unwrap();
        prop_assert_eq!(report.clipped_below + report.clipped_above + report.masked, 0);
        let step = (w.window[1] - w.window[0]) / f64::from(w.top());
        for (value, &word) in data.iter().zip(&w.words) {
            let error = (w.value_of(f64::from(word)) - value).abs();
            prop_assert!(error <= step * 0.5 * (1.0 + 1e-9) + 1e-9, "{} for a step of {}", error, step);
            for (other, &other_word) in data.iter().zip(&w.words) {
                prop_assert!(value > other || word <= other_word);
            }
        }
    }
}

proptest! {
    #![proptest_config(cases(256))]

    /// Every voxel is counted at its word, whatever the number of voxels and bits.
    #[test]
    fn counts_are_those_of_the_words(
        dims in prop::array::uniform3(1_usize..12), bits in 1_u32..=16, seed in any::<u64>(),
    ) {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let voxels = (0..dims.iter().product()).map(|_: usize| (random.next_u32() >> (32 - bits)) as u16).collect();
        let words = VoxelWords::new(dims, [1.0; 3], bits, [0.0, 1.0], voxels).unwrap();
        let counts = words.counts();
        prop_assert_eq!(counts.len(), 1 << bits);
        for (word, &count) in counts.iter().enumerate() {
            prop_assert_eq!(count, words.words.iter().filter(|&&w| usize::from(w) == word).count() as u64);
        }
    }
}

/// Of two planes of one word and a line of another, the planes lie flat; a word that is not asked for is not counted.
#[test]
fn voxels_of_a_plane_lie_flat_and_those_of_a_line_do_not() {
    let word = |x: usize, y: usize, z: usize| match [x, y, z] {
        [_, 2, _] => 100,
        [_, 5, _] => 100 + (x % 4) as u16,
        [_, 8, 8] => 200,
        _ => 0,
    };
    let words = VoxelWords::from_fn([10; 3], 8, word).unwrap();
    let asked: Vec<bool> = (0..256).map(|word| word >= 100).collect();
    let exact = words.flat_counts(0, &asked);
    assert_eq!((exact[0], exact[100], exact[200], exact.iter().sum::<u64>()), (0, 100, 0, 100));
    // But for two bits the second plane is one word too.
    let coarse = words.flat_counts(2, &asked);
    assert_eq!((coarse[100], coarse[103], coarse.iter().sum::<u64>()), (100 + 30, 20, 200));
}

/// Work on a volume is spread in chunks of samples: none is left out, taken twice or put elsewhere.
#[test]
fn every_sample_of_a_large_volume_has_its_place() {
    const SIZE: [usize; 3] = [(1 << 16) - 5, 3, 1];
    const CHUNK: usize = 1 << 16;
    let at = |x: usize, y: usize| (y * SIZE[0] + x) as f64;
    let volume = Volume::from_fn(SIZE, [1.0; 3], |x, y, _| at(x, y) as u32).expect("a volume");
    let count = volume.len();
    assert_eq!(volume.to_f64(), (0..count).map(|i| i as f64).collect::<Vec<_>>());
    assert_eq!(volume.map::<f32>(|value| -value).to_f32(), (0..count).map(|i| -(i as f32)).collect::<Vec<_>>());
    let (words, _) = volume.to_words(16, &WordConversion::default()).expect("words");
    let word = |i: usize| (i as f64 / (count - 1) as f64 * 65535.0).round() as u16;
    assert_eq!(words.words, (0..count).map(word).collect::<Vec<_>>());
    // The first, the last, and both sides of a border between chunks of a power of two.
    for special in [0, 1, CHUNK - 1, CHUNK, CHUNK + 1, 2 * CHUNK - 1, 2 * CHUNK, count - 1] {
        let value = |x, y, other: f64, special_value| if at(x, y) == special as f64 { special_value } else { other };
        let high = Volume::from_fn(SIZE, [1.0; 3], |x, y, _| value(x, y, 1.0, 7.0)).expect("a volume");
        assert_eq!(high.range().expect("finite"), (1.0, 7.0), "sample {special}");
        let bad = Volume::from_fn(SIZE, [1.0; 3], |x, y, _| value(x, y, 1.0, f64::NAN)).expect("a volume");
        assert_eq!(bad.finite_range(), ((1.0, 1.0), 1), "sample {special}");
        let found = bad.first_non_finite().expect("a NaN");
        assert_eq!(found.position, [special % SIZE[0], special / SIZE[0], 0]);
    }
}
