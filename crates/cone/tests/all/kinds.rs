//! The kinds of cone: data sheet, order, pixels of a slot.

use cube3_abc::ShadedRay;
use cube3_cases::cases;
use cube3_channel::Channel;
use cube3_cone::golden::{Node, Segment, circle, combine, front_to_back, reduce};
use cube3_cone::lanes::in_order;
use cube3_cone::{ConeSpec, ConeUnit, NoPixels, PixelCounts, PixelGroup};
use cube3_frame::{ConeRegisters, DiscreteRay, FrameSetup, Geometry, Schedule};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_machine::{Boards, Cone, ConeKind, ConeOrder, MachineSpec, RaySlots, Rays};
use cube3_scene::{Mode, Scene, View};
use cube3_word::{Rounding, Words, unit_full, unit_mul};
use proptest::prelude::*;

fn machine(kind: ConeKind, lanes: usize) -> MachineSpec {
    MachineSpec { lanes, cone: Cone { kind }, ..MachineSpec::default() }
}

fn setup(machine: &MachineSpec, dims: [usize; 3], direction: [f64; 3]) -> FrameSetup {
    let scene = Scene { view: View::from_direction(direction, None), ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    frame_setup(&scene, machine, &volume, true).unwrap().setup
}

#[test]
fn the_data_sheet() {
    // Kind; cycles of a ray, latency, drain, nodes, words of the shifter: for 128 leaves and 128, 512 samples.
    for (kind, one, four) in [
        (ConeKind::FoldedTree, [1, 8, 8, 128, 0], [4, 8, 11, 128, 0]),
        (ConeKind::ShiftedTree, [1, 15, 15, 128, 896], [4, 15, 18, 128, 896]),
        (ConeKind::Chain, [1, 128, 128, 128, 0], [4, 509, 512, 128, 0]),
        (ConeKind::Accumulator, [128, 1, 128, 1, 0], [512, 1, 512, 1, 0]),
    ] {
        for (samples, expected) in [(128, one), (512, four)] {
            let spec = ConeSpec::of(&machine(kind, 128), samples);
            let got = [spec.ray_cycles, spec.latency(), spec.drain(), spec.nodes() as u64, spec.shifter_words()];
            assert_eq!(got, expected, "{kind:?}, {samples} samples");
        }
    }
}

#[test]
fn the_channel_to_the_host_is_that_of_a_folded_tree_and_what_differs() {
    let size = |kind| ConeSpec::pixels(&machine(kind, 128));
    let sizes = ConeKind::ALL.map(|kind| (size(kind).capacity, size(kind).latency));
    assert_eq!(sizes, [(10, 8), (17, 15), (130, 128), (10, 1)]);
    // Eight boards: three levels of a tree over 1, 2 and 4 links; seven links along a chain; four to the farthest board.
    let boards = Boards { count: 8, link_latency_cycles: 3, ..Boards::default() };
    let size = |kind| ConeSpec::pixels(&MachineSpec { boards, ..machine(kind, 128) }).latency;
    assert_eq!(ConeKind::ALL.map(size), [8 + 3 * 7, 15 + 3 * 7, 128 + 3 * 7, 1 + 3 * 4]);
    let words = |kind, start| {
        let mut links = [[0; 2]; 8];
        ConeSpec::of(&MachineSpec { boards, ..machine(kind, 128) }, 128).link_words(start, &mut links);
        links.as_flattened().iter().sum::<u64>()
    };
    // Tree: four pairs over one link, two over two, one over four. Accumulator: 16 lanes each 0, 1, 2, 3, 4, 3, 2, 1 links away.
    assert_eq!(ConeKind::ALL.map(|kind| words(kind, 0)), [4 * 12, 4 * 12, 4 * 7, 4 * 16 * 16]);
    // A lane further on, each link is between the two leaves of a pair, and a chain crosses the link at which it began. The shifter turns all
    // leaves back by a lane: one over each link.
    assert_eq!(ConeKind::ALL.map(|kind| words(kind, 1)), [4 * (12 + 8), 4 * (12 + 8), 4 * 8, 4 * 16 * 16]);
    // Behind the first leaf of each board all four levels within a board cross its link.
    assert_eq!(words(ConeKind::FoldedTree, 15), 4 * (12 + 8 * 4));
}

#[test]
fn a_pixel_leaves_after_the_drain_and_not_a_cycle_earlier() {
    for kind in ConeKind::ALL {
        for (lanes, depths) in [(8, 8), (8, 17), (1, 3), (5, 11), (16, 3)] {
            let machine = machine(kind, lanes);
            let setup = setup(&machine, [1, 1, depths], [0.0, 0.0, 1.0]);
            let spec = ConeSpec::new(&machine, &Schedule::new(&machine, &setup.geometry));
            // The presets give a folded tree its log₂ lanes and one.
            let mut machine = machine.clone();
            machine.channel.pixels = cube3_machine::ChannelSize::pipelined(spec.levels() + 1);
            let size = ConeSpec::pixels(&machine);
            let mut cone = ConeUnit::new(vec![spec], NoPixels);
            let mut shaded = Channel::<ShadedRay<()>>::new("shaded", 2, 1).unwrap();
            let mut pixels = Channel::<PixelGroup<()>>::new("pixels", size.capacity, size.latency).unwrap();
            let (mut offered, mut arrived) = (0, Vec::new());
            for cycle in 0..2000 {
                if offered < 40 && shaded.push_slot().is_some() {
                    offered += 1;
                }
                if pixels.pop().is_some() {
                    arrived.push(cycle);
                }
                cone.tick(std::slice::from_ref(&setup), &mut shaded, &mut pixels);
                shaded.commit();
                pixels.commit();
            }
            // Ray m is at the leaves from the end of the one before it, in cycle 1 the first; nothing stops it.
            let expected: Vec<u64> = (0..40).map(|ray| 1 + ray * spec.ray_cycles + spec.drain()).collect();
            assert_eq!(arrived, expected, "{kind:?}, {depths} samples on {lanes} lanes");
            assert_eq!(cone.account().blocked, 0);
        }
    }
}

fn node(words: &Words, (present, alpha, colour, sample): (bool, u32, [u32; 3], i32)) -> Node {
    let bits = words.accumulator_bits;
    if !present {
        return Node::default();
    }
    let alpha = alpha & unit_full(bits);
    let [r, g, b] = colour.map(|c| u64::from(unit_mul(c & unit_full(bits), alpha, bits, words.rounding)));
    Node { present, sample, rgba: [r, g, b, u64::from(alpha)] }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(1000) })]

    #[test]
    fn front_to_back_is_the_recurrence_whatever_the_lanes_and_a_tree_of_one_leaf(
        accumulator_bits in 1_u32..=32, truncate: bool, leaves in 1_usize..30,
        raw in prop::collection::vec((any::<bool>(), any::<u32>(), any::<[u32; 3]>(), 0..9_i32), 1..24),
        seams in prop::collection::vec(0_usize..24, 0..3),
    ) {
        let rounding = if truncate { Rounding::Truncate } else { Rounding::Nearest };
        let words = Words { accumulator_bits, rounding, ..Words::default() };
        let depths: Vec<Node> = raw.into_iter().map(|raw| node(&words, raw)).collect();
        for mode in Mode::ALL {
            let cone = ConeRegisters { mode, order: ConeOrder::FrontToBack, leaves, opaque: 1, sum_weight: 0 };
            let whole = reduce(&depths, &cone, &words);
            let mut sum = Node::default();
            for depth in &depths {
                sum = combine(mode, sum, *depth, &words);
            }
            prop_assert_eq!(whole, sum);
            prop_assert_eq!(whole, front_to_back(&depths, &ConeRegisters { leaves: 1, ..cone }, &words));
            prop_assert_eq!(whole, reduce(&depths, &ConeRegisters { order: ConeOrder::Tree, leaves: 1, ..cone }, &words));
            // Several rays in a slot: each is reduced by itself.
            let of = |depth: usize| seams.iter().filter(|&&seam| seam <= depth).count();
            let at = |depth: usize| {
                Segment { ray: DiscreteRay { u: -(of(depth) as i64), v: 7 }, node: depths[depth] }
            };
            let got = in_order(depths.len(), at, mode, &words);
            let rays: Vec<DiscreteRay> = circle(depths.len(), 0, at, mode, &words).iter().map(|s| s.ray).collect();
            prop_assert_eq!(got.iter().map(|segment| segment.ray).collect::<Vec<_>>(), rays);
            for segment in got {
                let alone: Vec<Node> =
                    (0..depths.len()).filter(|&depth| at(depth).ray == segment.ray).map(|depth| depths[depth]).collect();
                prop_assert_eq!(segment.node, reduce(&alone, &cone, &words));
            }
        }
    }

    #[test]
    fn a_slot_has_a_pixel_for_each_of_its_rays(
        dims in prop::array::uniform3(1_usize..12), direction in prop::array::uniform3(-1.0..1.0_f64), padded: bool,
    ) {
        prop_assume!(direction.iter().any(|x| x.abs() > 0.01));
        let slots = if padded { RaySlots::Padded } else { RaySlots::Wrapped };
        let machine = MachineSpec { rays: Rays { slots, ..Rays::default() }, ..MachineSpec::default() };
        let geometry: Geometry = setup(&machine, dims, direction).geometry;
        let counts = PixelCounts::new(&geometry, Schedule::new(&machine, &geometry));
        let [slots, planes] = geometry.slot_counts();
        let mut total = 0;
        for plane in 0..planes {
            for slot in 0..slots {
                let mut rays: Vec<DiscreteRay> =
                    (0..geometry.size[2]).map(|k| geometry.ray_in_slot(plane, slot, k)).collect();
                rays.dedup();
                prop_assert_eq!(counts.of(plane, slot), rays.len() as u64);
                total += rays.len() as u64;
            }
        }
        prop_assert_eq!(counts.total(), total);
    }
}
