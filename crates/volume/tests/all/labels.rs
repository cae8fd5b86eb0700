//! Labels as voxel words: each its own, or a refusal.

use cube3_volume::{Samples, Volume, WordConversion};

fn line(samples: Samples) -> Volume {
    Volume::new([samples.len(), 1, 1], [1.0; 3], samples).unwrap()
}

/// A table's index of each word, and whether word = label · 2^shift for one shift.
fn indices(labels: &[u16], bits: u32, table_bits: u32) -> (Vec<u16>, Option<u32>) {
    let volume = line(Samples::U16(labels.to_vec()));
    let largest = volume.largest_label(bits).unwrap();
    let (words, report) = volume.to_words(bits, &WordConversion::labels(largest, bits, table_bits)).unwrap();
    assert_eq!((report.clipped_below, report.clipped_above), (0, 0));
    let shift = (0..16).find(|&shift| labels.iter().zip(&words.words).all(|(&label, &word)| label << shift == word));
    for (&label, &word) in labels.iter().zip(&words.words) {
        assert_eq!(words.value_of(f64::from(word)), f64::from(label));
    }
    (words.words.iter().map(|&word| word >> bits.saturating_sub(table_bits)).collect(), shift)
}

#[test]
fn a_label_is_its_own_word_where_the_table_has_an_entry_for_each() {
    let all: Vec<u16> = (0..=65535).collect();
    assert_eq!(indices(&all, 16, 16), (all.clone(), Some(0)));
    assert_eq!(indices(&all[..256], 8, 12), (all[..256].to_vec(), Some(0)));
}

#[test]
fn labels_move_up_by_what_an_index_drops_so_that_each_has_an_entry() {
    let all: Vec<u16> = (0..4096).collect();
    assert_eq!(indices(&all, 16, 12), (all.clone(), Some(4)));
    assert_eq!(indices(&all[..11], 12, 5), (all[..11].to_vec(), Some(7)));
}

#[test]
fn labels_that_have_no_room_move_less_and_share_entries() {
    let (entries, shift) = indices(&[0, 4095, 4096, 4097], 16, 12);
    assert_eq!((entries, shift), (vec![0, 2047, 2048, 2048], Some(3)));
    assert_eq!(indices(&[1, 65535], 16, 1).1, Some(0));
}

#[test]
fn what_names_nothing_is_refused_with_its_place() {
    let volume =
        Volume::new([3, 2, 2], [1.0; 3], Samples::F32((0..12).map(|i| if i == 10 { 2.5 } else { 3.0 }).collect()));
    let text = volume.unwrap().largest_label(16).unwrap_err().to_string();
    assert_eq!(
        text,
        "labels: voxel (1, 1, 1) is 2.5, and a label is a whole number from 0 up; give a segmentation, or leave labels out"
    );
    let text = line(Samples::I16(vec![0, -1])).largest_label(16).unwrap_err().to_string();
    assert!(text.contains("voxel (1, 0, 0) is -1"), "{text}");
    assert_eq!(line(Samples::F64(vec![f64::NAN, 7.0])).largest_label(8).unwrap(), 7.0);
}

#[test]
fn labels_beyond_the_words_are_refused_with_the_largest_and_the_bits() {
    let volume = line(Samples::U32(vec![1, 70_000, 2]));
    let text = volume.largest_label(16).unwrap_err().to_string();
    assert!(text.contains("the largest is 70000, and a voxel word of 16 bits holds 65535"), "{text}");
    let text = line(Samples::U8(vec![16])).largest_label(4).unwrap_err().to_string();
    assert!(text.contains("of 4 bits holds 15; raise words.voxel_bits"), "{text}");
    assert_eq!(line(Samples::U8(vec![15])).largest_label(4).unwrap(), 15.0);
}
