//! No bytes make a reader panic or take memory beyond its limit.

use std::sync::LazyLock;

use crate::common::pack;
use cube3_cases::cases;
use cube3_volume::{FileFormat, RawLayout, ReadOptions, SampleType, read_bytes};
use proptest::prelude::*;

const FORMATS: [FileFormat; 4] = [FileFormat::Nrrd, FileFormat::Nifti, FileFormat::MetaImage, FileFormat::Raw];

static FILES: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
    let mut files: Vec<_> = ["nrrd", "nifti", "metaimage"].into_iter().flat_map(pack).collect();
    files.retain(|f| FileFormat::of_path(f.0.as_ref()).is_some_and(|format| format != FileFormat::Raw));
    files
});

fn options(frame: usize) -> ReadOptions {
    ReadOptions {
        memory_limit_bytes: Some(1 << 20),
        frame,
        raw: Some(RawLayout::new([2, 2, 2], SampleType::U16)),
        ..ReadOptions::default()
    }
}

/// Words that headers are made of, to get past the first checks.
const WORDS: &[&str] = &[
    "NRRD0004\n",
    "NRRD0005\n",
    "space: ",
    "RAS\n",
    "axis mins: ",
    "axis maxs: ",
    "hex\n",
    "x%02d.raw 1 2 1\n",
    "TransformMatrix = 1 0 0 0 1 0 0 0 1\n",
    "type: ",
    "uint8\n",
    "double\n",
    "int64\n",
    "dimension: ",
    "sizes: ",
    "spacings: ",
    "space directions: ",
    "none ",
    "(1,0,0) ",
    "(",
    ")",
    ",",
    "space origin: ",
    "encoding: ",
    "raw\n",
    "gzip\n",
    "ascii\n",
    "endian: ",
    "little\n",
    "big\n",
    "line skip: ",
    "byte skip: ",
    "data file: ",
    "LIST\n",
    "kinds: ",
    "list ",
    "1 ",
    "3\n",
    "2 2 2\n",
    "0 ",
    "-1\n",
    "18446744073709551615 ",
    "9223372036854775807\n",
    "nan ",
    "1e999 ",
    "\n",
    "\n\n",
    ":=",
    "#",
    "é",
    "ObjectType = Image\n",
    "NDims = 3\n",
    "NDims = 4\n",
    "DimSize = 2 2 2\n",
    "DimSize = 4294967295 4294967295 4294967295\n",
    "ElementType = MET_UCHAR\n",
    "ElementType = MET_DOUBLE\n",
    "ElementSpacing = 1 1 1\n",
    "CompressedData = True\n",
    "BinaryData = False\n",
    "HeaderSize = -1\n",
    "HeaderSize = 9223372036854775807\n",
    "ElementDataFile = LOCAL\n",
    "ElementDataFile = x\n",
];

proptest! {
    #![proptest_config(cases(2000))]

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..600), format in 0..FORMATS.len(), frame in 0usize..3) {
        let _ = read_bytes(&bytes, Some(FORMATS[format]), "random", &options(frame));
        let _ = read_bytes(&bytes, None, "random", &options(frame));
    }

    #[test]
    fn headers_of_random_words(
        words in prop::collection::vec(0..WORDS.len(), 0..40),
        nrrd in any::<bool>(),
        frame in prop::sample::select(vec![0usize, 1, usize::MAX]),
    ) {
        let text: String = words.iter().map(|&w| WORDS[w]).collect();
        let text = if nrrd { format!("NRRD0004\n{text}") } else { text };
        let format = if nrrd { FileFormat::Nrrd } else { FileFormat::MetaImage };
        let _ = read_bytes(text.as_bytes(), Some(format), "words", &options(frame));
    }

    #[test]
    fn good_files_with_changed_bytes(
        file in 0usize..1000,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        cut in any::<prop::sample::Index>(),
        whole in any::<bool>(),
    ) {
        let (name, good) = &FILES[file % FILES.len()];
        let mut bytes = good.clone();
        for (at, value) in changes {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        if !whole {
            bytes.truncate(cut.index(bytes.len()));
        }
        let result = read_bytes(&bytes, FileFormat::of_path(name.as_ref()), name, &options(0));
        if let Ok(volume) = result {
            prop_assert_eq!(volume.len(), volume.dims.iter().product::<usize>());
            prop_assert!(volume.spacing.iter().all(|s| *s > 0.0 && s.is_finite()));
        }
    }
}
