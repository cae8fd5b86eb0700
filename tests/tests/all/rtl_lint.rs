//! Every module of `tests/rtl` is clean in Verilator and Icarus Verilog with all warnings on, in words of every kind.

use cube3_tests::rtl::{self, Parameters};
use rayon::prelude::*;

/// Lengths of words from the narrowest to the widest, by the names of the modules' parameters.
const WORDS: [(&str, [i64; 4]); 13] = [
    // The default, the narrowest, the widest, and unequal ones that drop bits.
    ("VOXEL_BITS", [16, 1, 16, 9]),
    ("WEIGHT_BITS", [8, 0, 12, 5]),
    ("SAMPLE_FRACTION_BITS", [0, 0, 8, 3]),
    ("GRADIENT_BITS", [17, 2, 24, 7]),
    ("KEPT_BITS", [0, 0, 0, 16]),
    ("NORMAL_BITS", [12, 4, 15, 7]),
    ("ROOT_BITS", [8, 4, 10, 5]),
    ("POWER_BITS", [10, 3, 11, 2]),
    ("TABLE_BITS", [12, 1, 16, 5]),
    ("COLOUR_BITS", [12, 1, 16, 5]),
    ("OPACITY_BITS", [12, 1, 16, 13]),
    ("ACCUMULATOR_BITS", [16, 1, 32, 8]),
    ("REFLECTANCE_BITS", [6, 2, 8, 3]),
];

/// A module, the words that it has, and sets of its other parameters.
struct Row(&'static str, &'static [&'static str], Vec<Parameters>);

fn rows() -> Vec<Row> {
    let lerp = &["VOXEL_BITS", "WEIGHT_BITS", "SAMPLE_FRACTION_BITS"];
    let gradient = &["VOXEL_BITS", "WEIGHT_BITS", "SAMPLE_FRACTION_BITS", "GRADIENT_BITS", "KEPT_BITS"];
    let classify = &[
        "VOXEL_BITS",
        "SAMPLE_FRACTION_BITS",
        "GRADIENT_BITS",
        "KEPT_BITS",
        "TABLE_BITS",
        "COLOUR_BITS",
        "OPACITY_BITS",
    ];
    let leaf = &["VOXEL_BITS", "SAMPLE_FRACTION_BITS", "COLOUR_BITS", "OPACITY_BITS", "ACCUMULATOR_BITS"];
    let node = &["VOXEL_BITS", "SAMPLE_FRACTION_BITS", "ACCUMULATOR_BITS"];
    let light = &["NORMAL_BITS", "COLOUR_BITS", "POWER_BITS"];
    let rounding = || vec![vec![("NEAREST", 1)], vec![("NEAREST", 0)]];
    let each = |name: &'static str, values: &[i64]| -> Vec<Parameters> {
        values.iter().map(|&value| vec![(name, value)]).collect()
    };
    let skews = [
        [8, 20, 8, 3, 1, 1, 1, 0],
        [8, 20, 8, 3, 1, 1, 1, 1],
        [6, 13, 3, 70, 2, -1, -7, 1],
        [1, 1, 1, 1, 0, 0, 0, 1],
        [4096, 4096, 4096, 4096, -4096, 4096, 4095, 1],
        [4, 20, 8, 3, 1, 1, 1, 2],
        [1, 1, 1, 1, 0, 0, 0, 2],
        [4096, 4096, 4096, 4096, -4095, 4096, 4095, 2],
    ];
    let skew = |values: [i64; 8]| {
        ["LANES", "NX", "NY", "NZ", "SKEW_A", "SKEW_B", "SKEW_C", "BLOCKS"].into_iter().zip(values).collect()
    };
    let methods = [6, 26, 10, 12, 61, 261].into_iter().flat_map(|method| {
        [[0, 0, 1], [0, 1, 0], [1, 1, 1]].map(|[perspective, factors, nearest]| {
            vec![("METHOD", method), ("PERSPECTIVE", perspective), ("FACTORS", factors), ("NEAREST", nearest)]
        })
    });
    let tables = [[1, 1], [64, 1], [2, 3], [256, 16]].map(|[rows, classes]| vec![("ROWS", rows), ("CLASSES", classes)]);
    let channels = [[1, 1], [3, 2], [8, 6], [255, 1]]
        .map(|[capacity, latency]| vec![("CAPACITY", capacity), ("LATENCY", latency), ("WIDTH", capacity)]);
    let turns = [[1, 3, 1], [2, 1, 1], [7, 5, 3], [8, 16, 3]]
        .map(|[items, width, bits]| vec![("ITEMS", items), ("WIDTH", width), ("AMOUNT_BITS", bits)]);
    let rounds = [[8, 8, 0, 1], [8, 3, 5, 1], [8, 3, 5, 0], [40, 2, 39, 1]]
        .map(|[from, to, drop, nearest]| vec![("IN", from), ("OUT", to), ("DROP", drop), ("NEAREST", nearest)]);
    let sizes = [[1, 1], [1, 32], [16, 1], [5, 12]].map(|[from, to]| vec![("FROM", from), ("TO", to)]);
    let products = [[1, 1], [1, 0], [16, 1], [32, 0]].map(|[bits, nearest]| vec![("BITS", bits), ("NEAREST", nearest)]);
    vec![
        Row("cube3_bus", &["VOXEL_BITS"], each("LANES", &[1, 7, 8])),
        Row("cube3_cfb", &[], skews.map(skew).to_vec()),
        Row("cube3_channel", &[], channels.to_vec()),
        Row("cube3_classify", classify, tables.to_vec()),
        Row("cube3_clip", &[], vec![vec![]]),
        Row("cube3_cone", node, each("LEAVES", &[1, 2, 3, 6, 8])),
        Row("cube3_cue", &["COLOUR_BITS"], rounding()),
        Row("cube3_dsb", &[], each("LANES", &[1, 7, 8, 4096])),
        Row("cube3_gradient", gradient, methods.collect()),
        Row("cube3_join", node, rounding()),
        Row("cube3_leaf", leaf, rounding()),
        Row("cube3_lerp", lerp, rounding()),
        Row("cube3_light", light, rounding()),
        Row("cube3_lit", &["COLOUR_BITS"], rounding()),
        Row("cube3_node", node, rounding()),
        Row("cube3_normalise", &["GRADIENT_BITS", "KEPT_BITS", "NORMAL_BITS", "ROOT_BITS"], vec![vec![]]),
        Row("cube3_phong", light, each("LIGHTS", &[1, 8])),
        Row("cube3_pixel", &["ACCUMULATOR_BITS"], rounding()),
        Row("cube3_reflectance", &["GRADIENT_BITS", "KEPT_BITS", "COLOUR_BITS", "REFLECTANCE_BITS"], vec![vec![]]),
        Row("cube3_round", &[], rounds.to_vec()),
        Row("cube3_trilin", lerp, rounding()),
        Row("cube3_turn", &[], turns.to_vec()),
        Row("cube3_unit_mul", &[], products.to_vec()),
        Row("cube3_unit_resize", &[], sizes.to_vec()),
    ]
}

/// Every module with every set of its parameters, in words of every kind.
fn cases() -> Vec<(&'static str, Parameters)> {
    let mut cases = Vec::new();
    for Row(module, names, sets) in rows() {
        let kinds = if names.is_empty() { 1 } else { 4 };
        for kind in 0..kinds {
            let of = |name: &&'static str| (*name, WORDS.iter().find(|(word, _)| word == name).unwrap().1[kind]);
            let words: Parameters = names.iter().map(of).collect();
            cases.extend(sets.iter().map(|set| (module, [words.clone(), set.clone()].concat())));
        }
    }
    cases
}

fn assert_clean(check: impl Fn(&str, &Parameters) -> Result<(), String> + Sync) {
    let failures: Vec<String> = cases()
        .par_iter()
        .filter_map(|(module, set)| Some(format!("{module} {set:?}\n{}", check(module, set).err()?)))
        .collect();
    assert!(failures.is_empty(), "{} not clean:\n{}", failures.len(), failures.join("\n"));
}

#[test]
fn every_module_of_the_folder_is_checked() {
    let checked: Vec<String> = rows().iter().map(|Row(module, _, _)| module.to_string()).collect();
    assert_eq!(rtl::modules(), checked);
}

#[test]
fn verilator_has_nothing_to_say() {
    let Some(verilator) = rtl::require("verilator") else { return };
    assert_clean(|module, set| rtl::verilator_lint(&verilator, module, set));
}

#[test]
fn icarus_has_nothing_to_say() {
    let Some(iverilog) = rtl::require("iverilog") else { return };
    let folder = tempfile::tempdir().unwrap();
    assert_clean(|module, set| {
        let name: Vec<String> = set.iter().map(|(_, value)| value.to_string()).collect();
        rtl::icarus_lint(&iverilog, module, set, &folder.path().join(format!("{module}.{}", name.join("."))))
    });
}

/// A width that does not fit is found: the checks above can fail.
#[test]
fn a_word_that_does_not_fit_is_found() {
    let Some(verilator) = rtl::require("verilator") else { return };
    let set = vec![("IN", 8), ("OUT", 9), ("DROP", 0), ("NEAREST", 0)];
    let error = rtl::verilator_lint(&verilator, "cube3_round", &set).unwrap_err();
    assert!(error.contains("WIDTH"), "{error}");
}
