//! The operators that Yosys finds in each module of `tests/rtl` are those of the table of resources, one for one.
//!
//! Yosys elaborates a module and flattens it, and runs no pass that makes an operator into others or folds one with a constant. Then
//! of its cells `$mul` are multipliers; `$add`, `$sub` and `$neg` adders; `$lt`, `$le`, `$gt`, `$ge` comparators, which are of
//! magnitude, so `$eq` and `$ne` are none; `$div` and `$mod` dividers. Selections, shifts and memories are none of them.

use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::OperatorCounts;
use cube3_machine::{Abc, GradientMethod, MachineSpec, Reuse, ShadingUnit, Trilin};
use cube3_resources::operators;
use cube3_scene::{Material, Scene, View};
use cube3_tests::rtl::{self, Parameters};
use cube3_tests::thorough::thorough;
use cube3_word::{Rounding, Words};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Cells of a flattened module, by type.
fn cells(yosys: &Path, module: &str, parameters: &Parameters) -> BTreeMap<String, u64> {
    let set: String =
        parameters.iter().map(|(name, value)| format!("chparam -set {name} {value} {module}; ")).collect();
    let folder = tempfile::tempdir().unwrap();
    let found = folder.path().join("stat.json");
    let sources: String = rtl::modules().iter().map(|name| format!(" {name}.sv")).collect();
    let script = format!(
        "read_verilog -sv{sources}; {set}hierarchy -check -top {module}; proc -noopt; flatten; opt_clean; check -assert; \
         tee -q -o {} stat -json",
        found.display()
    );
    rtl::run(Command::new(yosys).current_dir(rtl::folder()).args(["-q", "-p", &script])).unwrap();
    let text = std::fs::read_to_string(&found).unwrap();
    let stat: serde_json::Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{error}: {text}"));
    let types = &stat["design"]["num_cells_by_type"];
    serde_json::from_value(types.clone()).unwrap_or_else(|error| panic!("{error}: {text}"))
}

fn synthesised(yosys: &Path, module: &str, parameters: &Parameters) -> OperatorCounts {
    let cells = cells(yosys, module, parameters);
    let of = |types: &[&str]| types.iter().filter_map(|kind| cells.get(*kind)).sum();
    OperatorCounts {
        multipliers: of(&["$mul"]),
        adders: of(&["$add", "$sub", "$neg"]),
        comparators: of(&["$lt", "$le", "$gt", "$ge"]),
        dividers: of(&["$div", "$mod", "$divfloor", "$modfloor"]),
    }
}

/// The default, the same truncated, words that drop nothing or everything, and ones that drop some bits everywhere.
fn words() -> [Words; 4] {
    let narrow = Words {
        voxel_bits: 4,
        weight_bits: 0,
        gradient_bits: 5,
        normal_bits: 5,
        table_bits: 4,
        colour_bits: 1,
        opacity_bits: 16,
        accumulator_bits: 1,
        ..Words::default()
    };
    let uneven = Words {
        voxel_bits: 12,
        weight_bits: 5,
        sample_fraction_bits: 3,
        gradient_bits: 9,
        normal_bits: 15,
        table_bits: 8,
        colour_bits: 7,
        opacity_bits: 5,
        accumulator_bits: 31,
        ..Words::default()
    };
    let truncated = Words { rounding: Rounding::Truncate, ..uneven };
    [Words::default(), narrow, uneven, truncated]
}

/// Machines of those words, or in a quick run of the default; index and root tables of the narrow ones are as small as their words.
fn machines() -> Vec<MachineSpec> {
    let tried = if thorough("synthesis in other words than the default") { 4 } else { 1 };
    let machine = |words: Words| {
        let power_bits = 10.min(words.normal_bits - 1);
        let root_bits = 8.min(2 * words.normal_bits - 2);
        let abc = Abc { power_bits, root_bits, ..Abc::default() };
        MachineSpec { lanes: 8, words, abc, ..MachineSpec::default() }
    };
    words().into_iter().take(tried).map(machine).collect()
}

/// Parameters of a machine's words, those that a module has.
fn parameters(machine: &MachineSpec, names: &[&'static str]) -> Parameters {
    let words = &machine.words;
    let value = |name: &str| match name {
        "VOXEL_BITS" => words.voxel_bits,
        "WEIGHT_BITS" => words.weight_bits,
        "SAMPLE_FRACTION_BITS" => words.sample_fraction_bits,
        "GRADIENT_BITS" => words.gradient_bits,
        "NORMAL_BITS" => words.normal_bits,
        "TABLE_BITS" => words.table_bits,
        "COLOUR_BITS" => words.colour_bits,
        "OPACITY_BITS" => words.opacity_bits,
        "ACCUMULATOR_BITS" => words.accumulator_bits,
        "POWER_BITS" => machine.abc.power_bits,
        "ROOT_BITS" => machine.abc.root_bits,
        "REFLECTANCE_BITS" => machine.abc.reflectance_bits,
        "NEAREST" => u32::from(words.rounding == Rounding::Nearest),
        name => panic!("{name} is no word"),
    };
    names.iter().map(|&name| (name, i64::from(value(name)))).collect()
}

/// The row of a part, of which each lane, node or light has one; none where it has no operators.
fn row(machine: &MachineSpec, frames: &[FrameSetup], part: &str) -> OperatorCounts {
    let parts = operators(machine, frames);
    parts.iter().find(|found| found.part == part).map(|found| found.each).unwrap_or_default()
}

const LERP: &[&str] = &["VOXEL_BITS", "WEIGHT_BITS", "SAMPLE_FRACTION_BITS", "NEAREST"];
const GRADIENT: &[&str] = &["VOXEL_BITS", "WEIGHT_BITS", "SAMPLE_FRACTION_BITS", "GRADIENT_BITS", "NEAREST"];

#[test]
fn an_interpolator_is_seven_lerps_and_the_table_counts_those_that_are_left() {
    let Some(yosys) = rtl::require("yosys") else { return };
    for machine in machines() {
        let set = parameters(&machine, LERP);
        let lerp = synthesised(&yosys, "cube3_lerp", &set);
        for reuse in [Reuse::None, Reuse::Ray, Reuse::Plane, Reuse::Both] {
            let machine = MachineSpec { trilin: Trilin { reuse }, ..machine.clone() };
            assert_eq!(row(&machine, &[], "trilin"), lerp.times(u64::from(reuse.lerps())), "{reuse:?} {set:?}");
        }
        assert_eq!(synthesised(&yosys, "cube3_trilin", &set), lerp.times(7), "{set:?}");
    }
}

const METHODS: [(GradientMethod, i64); 7] = [
    (GradientMethod::Six, 6),
    (GradientMethod::TwentySix, 26),
    (GradientMethod::Ten, 10),
    (GradientMethod::TenNormalised, 10),
    (GradientMethod::Twelve, 12),
    (GradientMethod::SixSheared, 61),
    (GradientMethod::TwentySixSheared, 261),
];

#[test]
fn gradients_have_the_operators_of_the_table() {
    let Some(yosys) = rtl::require("yosys") else { return };
    let cases: Vec<_> =
        machines().into_iter().flat_map(|machine| METHODS.map(|method| (machine.clone(), method))).collect();
    cases.par_iter().for_each(|(machine, (gradient, method))| {
        let machine = MachineSpec { abc: Abc { gradient: *gradient, ..machine.abc }, ..machine.clone() };
        let part = |name| row(&machine, &[], name);
        let unscaled = part("abc: gradient") + part("abc: gradient word");
        let scale = part("abc: gradient scale");
        assert_eq!(
            scale == OperatorCounts::default(),
            *gradient == GradientMethod::Ten,
            "10 has no lengths to even out"
        );
        for (factors, expected) in [(0, unscaled), (1, unscaled + scale)] {
            let mut set = parameters(&machine, GRADIENT);
            set.extend([("METHOD", *method), ("FACTORS", factors)]);
            if factors == 0 || *gradient != GradientMethod::Ten {
                assert_eq!(synthesised(&yosys, "cube3_gradient", &set), expected, "{gradient:?} {set:?}");
            }
        }
    });
}

/// Voxels that are not cubes: the bits that a frame's products keep below the word. Where they keep all, nothing is rounded.
#[test]
fn scaled_gradients_round_the_bits_that_a_frame_does_not_keep() {
    let Some(yosys) = rtl::require("yosys") else { return };
    let scene = Scene {
        view: View::from_direction([0.5, 0.25, 1.0], None),
        material: Material { shaded: true, ..Material::default() },
        ..Scene::default()
    };
    let volume = VolumeInfo { dims: [8; 3], spacing: [1.0, 1.0, 2.0], window: [0.0, 255.0] };
    let scaled = |machine: MachineSpec| {
        let setup = frame_setup(&scene, &machine, &volume, true).unwrap().setup;
        let kept = setup.gradient.unwrap().scale.unwrap().kept_bits;
        let mut set = parameters(&machine, GRADIENT);
        set.extend([("METHOD", 12), ("KEPT_BITS", i64::from(kept))]);
        let frames = [setup];
        let part = |name| row(&machine, &frames, name);
        let expected = part("abc: gradient") + part("abc: gradient scale") + part("abc: gradient word");
        assert_eq!(synthesised(&yosys, "cube3_gradient", &set), expected, "{set:?}");
        kept
    };
    let kept: Vec<u32> = machines().into_iter().map(scaled).collect();
    assert_eq!(kept, [14, 16, 15, 15][..kept.len()], "the first drops bits of the products, the second none");
}

/// A module, the words that it has, and which rows of the table it is.
type Unit = (&'static str, &'static [&'static str], &'static [&'static str]);

const UNITS: [Unit; 8] = [
    ("cube3_normalise", &["GRADIENT_BITS", "NORMAL_BITS", "ROOT_BITS"], &["abc: normaliser", "abc: magnitude"]),
    ("cube3_light", &["NORMAL_BITS", "COLOUR_BITS", "POWER_BITS", "NEAREST"], &["abc: a light"]),
    ("cube3_reflectance", &["GRADIENT_BITS", "COLOUR_BITS", "REFLECTANCE_BITS"], &["abc: direction"]),
    ("cube3_lit", &["COLOUR_BITS", "NEAREST"], &["abc: lit colour"]),
    (
        "cube3_classify",
        &["VOXEL_BITS", "SAMPLE_FRACTION_BITS", "GRADIENT_BITS", "TABLE_BITS", "COLOUR_BITS", "OPACITY_BITS"],
        &["abc: threshold and row"],
    ),
    (
        "cube3_leaf",
        &["VOXEL_BITS", "SAMPLE_FRACTION_BITS", "COLOUR_BITS", "OPACITY_BITS", "ACCUMULATOR_BITS", "NEAREST"],
        &["cone: leaf"],
    ),
    ("cube3_node", &["VOXEL_BITS", "SAMPLE_FRACTION_BITS", "ACCUMULATOR_BITS", "NEAREST"], &["cone: node"]),
    ("cube3_pixel", &["ACCUMULATOR_BITS", "NEAREST"], &["cone: weight of a sum"]),
];

#[test]
fn units_have_the_operators_of_the_table() {
    let Some(yosys) = rtl::require("yosys") else { return };
    let cases: Vec<_> = machines().into_iter().flat_map(|machine| UNITS.map(|unit| (machine.clone(), unit))).collect();
    cases.par_iter().for_each(|(machine, (module, names, parts))| {
        let shading = match *module {
            "cube3_reflectance" => ShadingUnit::ReflectanceTable,
            _ => ShadingUnit::Phong,
        };
        let machine = MachineSpec { abc: Abc { shading, ..machine.abc }, ..machine.clone() };
        let expected = parts.iter().map(|part| row(&machine, &[], part)).sum();
        let set = parameters(&machine, names);
        assert_eq!(synthesised(&yosys, module, &set), expected, "{module} {set:?}");
    });
}

/// The first light adds its specular part to 0, which a synthesizer will fold: each light is the same cell.
#[test]
fn a_shading_unit_is_its_lights_and_a_cone_its_nodes() {
    let Some(yosys) = rtl::require("yosys") else { return };
    for machine in machines() {
        let mut set = parameters(&machine, &["NORMAL_BITS", "COLOUR_BITS", "POWER_BITS", "NEAREST"]);
        set.push(("LIGHTS", 3));
        assert_eq!(synthesised(&yosys, "cube3_phong", &set), row(&machine, &[], "abc: a light").times(3), "{set:?}");
        let mut set = parameters(&machine, &["VOXEL_BITS", "SAMPLE_FRACTION_BITS", "ACCUMULATOR_BITS", "NEAREST"]);
        for leaves in [6, 8] {
            set.retain(|(name, _)| *name != "LEAVES");
            set.push(("LEAVES", leaves));
            let nodes = row(&machine, &[], "cone: node").times(leaves as u64 - 1);
            assert_eq!(synthesised(&yosys, "cube3_cone", &set), nodes, "{set:?}");
        }
    }
}

/// What a scan in order brings from one sample to the next, the table counts, and the modules, which take a sample anywhere, do not
/// have: the depth cue's factor is a sum that goes on by a step (an adder) and is held at both ends (two comparators), and each cut
/// plane's distance is such a sum with a comparator, where a plane evaluated anew needs three products.
#[test]
fn what_goes_along_with_the_scan_is_outside_of_the_modules() {
    let Some(yosys) = rtl::require("yosys") else { return };
    let clip = synthesised(&yosys, "cube3_clip", &Vec::new());
    assert_eq!(clip, OperatorCounts { multipliers: 3, adders: 3, comparators: 0, dividers: 0 }, "its sign is a bit");
    let factor = OperatorCounts { multipliers: 0, adders: 1, comparators: 2, dividers: 0 };
    for machine in machines() {
        let clips = row(&machine, &[], "abc: cut planes and crop box");
        assert_eq!((clips.multipliers, clips.adders, clips.comparators), (0, 12, 12), "an adder and a comparator each");
        let set = parameters(&machine, &["COLOUR_BITS", "NEAREST"]);
        let cue = synthesised(&yosys, "cube3_cue", &set);
        assert_eq!(cue + factor, row(&machine, &[], "abc: depth cue"), "{set:?}");
    }
}

#[test]
fn only_the_channel_has_state_and_no_module_a_latch() {
    let Some(yosys) = rtl::require("yosys") else { return };
    rtl::modules().par_iter().for_each(|module| {
        let small: Parameters = match module.as_str() {
            "cube3_classify" => vec![("TABLE_BITS", 2)],
            "cube3_reflectance" => vec![("REFLECTANCE_BITS", 2)],
            _ => Vec::new(),
        };
        let cells = cells(&yosys, module, &small);
        let state = cells.keys().filter(|kind| kind.contains("ff") || kind.contains("latch")).count();
        assert_eq!(state > 0, module == "cube3_channel", "{module}: {cells:?}");
        assert!(!cells.keys().any(|kind| kind.contains("latch")), "{module}: {cells:?}");
    });
}
