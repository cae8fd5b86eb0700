//! The links between boards in the whole machine, against a count of words lane by lane: for each sample that a lane computes, the lanes it
//! reads from.

use cube3::limits::{frame_interval, limits};
use cube3_cases::cases;
use cube3_channel::Reason;
use cube3_dsb::BoardSpec;
use cube3_dsb::golden::walk;
use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::{Abc, Boards, Cone, ConeKind, GradientMethod, MachineSpec, RaySlots, Rays};
use cube3_pipeline::{Machine, RunCounters};
use cube3_scene::{Perspective, Scene, View};
use proptest::prelude::*;
use std::collections::BTreeSet;
use std::sync::Arc;

/// Words over each link, forwards and backwards.
type Words = Vec<[u64; 2]>;

fn add(sum: &mut Words, words: &[[u64; 2]], times: u64) {
    sum.iter_mut().flatten().zip(words.iter().flatten()).for_each(|(sum, words)| *sum += times * words);
}

/// The links, by number and direction, that a word crosses which goes on by so many lanes, one after another; back where they are below 0.
fn path(spec: &BoardSpec, from: usize, by: i64) -> Vec<[usize; 2]> {
    let mut crossed = Vec::new();
    let mut lane = from;
    for _ in 0..by.abs() {
        let next = (lane + if by < 0 { spec.lanes - 1 } else { 1 }) % spec.lanes;
        if spec.board(lane) != spec.board(next) {
            crossed.push(if by < 0 { [spec.board(lane), 1] } else { [spec.board(next), 0] });
        }
        lane = next;
    }
    crossed
}

/// The neighbours that an estimator reads, (u, v, w), of a ray that runs with u and v: the table of estimators in the paper's section 4.
fn neighbours(method: GradientMethod) -> Vec<[i64; 3]> {
    let six = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]];
    let more: &[[i64; 3]] = match method {
        GradientMethod::Six | GradientMethod::SixSheared => &[],
        // The feet of the perpendiculars on the rays beside, behind those before.
        GradientMethod::Ten | GradientMethod::TenNormalised => &[[1, 0, -1], [-1, 0, 1], [0, 1, -1], [0, -1, 1]],
        // The four samples around the place behind and before along w.
        GradientMethod::Twelve => &[[-1, 0, 1], [0, -1, 1], [-1, -1, 1], [1, 0, -1], [0, 1, -1], [1, 1, -1]],
        GradientMethod::TwentySix | GradientMethod::TwentySixSheared => {
            return (0..27).map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1]).collect();
        }
    };
    six.into_iter().chain(more.iter().copied()).collect()
}

/// How many lanes away the samples are that the lanes of a frame read.
fn offsets(setup: &FrameSetup) -> BTreeSet<i64> {
    let mut offsets = BTreeSet::new();
    let Some(registers) = &setup.gradient else {
        return offsets;
    };
    let geometry = &setup.geometry;
    let [slots, _] = geometry.slot_counts();
    for slot in 0..slots {
        let against = geometry.mirrored(geometry.ray_in_slot(0, slot, 0))[0];
        for [u, _, w] in neighbours(registers.method) {
            let u = if against { -u } else { u };
            offsets.extend((0..geometry.size[2]).map(|k| u * setup.reach(k) + w));
        }
    }
    offsets
}

/// Words of a beam.
fn of_beam(spec: &BoardSpec, setup: &FrameSetup, plane: usize, depth: usize) -> Words {
    let geometry = &setup.geometry;
    let v = geometry.row_at(geometry.ray_in_slot(plane, 0, depth).v, depth);
    match v {
        None => vec![[0; 2]; spec.boards],
        Some(v) if geometry.perspective.is_none() => walk(spec, spec.moves(geometry, v, depth)),
        Some(_) => walk(spec, spec.gathered(geometry, plane, depth)),
    }
}

/// Words of a ray in TRILIN, ABC and cone. A lane without a sample sends and reads empty words.
fn of_ray(spec: &BoardSpec, machine: &MachineSpec, setup: &FrameSetup, slot: usize) -> [Words; 3] {
    let empty = || vec![[0; 2]; spec.boards];
    let mut words = [empty(), empty(), empty()];
    let lanes = spec.lanes;
    let chunks = setup.geometry.size[2].div_ceil(lanes) as u64;
    let offsets = offsets(setup);
    for lane in 0..lanes {
        // Voxels of the next depth, of two columns or of two planes; edges of the ray before.
        let (voxels, edges) = if setup.geometry.doubled() { (4, 0) } else { (2, 2) };
        for [link, backwards] in path(spec, (lane + 1) % lanes, -1) {
            words[0][link][backwards] += voxels * chunks;
        }
        for [link, backwards] in path(spec, (lane + lanes - 1) % lanes, 1) {
            words[0][link][backwards] += edges * chunks;
        }
        // The sample that this lane has computed, to each lane that reads it; a link carries it once.
        let farthest = |sign: i64| offsets.iter().map(|offset| -offset * sign).max().unwrap_or(0).max(0) * sign;
        for [link, backwards] in path(spec, lane, farthest(1)).into_iter().chain(path(spec, lane, farthest(-1))) {
            words[1][link][backwards] += chunks;
        }
    }
    words[2] = of_cone(spec, machine.cone.kind, slot % lanes, chunks);
    words
}

/// Words of a ray's nodes, four each, from the lane of its first sample on.
fn of_cone(spec: &BoardSpec, kind: ConeKind, start: usize, chunks: u64) -> Words {
    let lanes = spec.lanes;
    let mut words = vec![[0; 2]; spec.boards];
    // A node is in the lane of its first leaf.
    let pairs = |start: usize| {
        let mut moves = Vec::new();
        let mut size = 1;
        while size < lanes {
            moves.extend((0..lanes).step_by(2 * size).map(|left| [left + size, left]).filter(|pair| pair[0] < lanes));
            size *= 2;
        }
        moves.into_iter().map(move |pair| pair.map(|leaf| (start + leaf) % lanes))
    };
    match kind {
        ConeKind::FoldedTree => add(&mut words, &walk(spec, pairs(start)), 4 * chunks),
        ConeKind::ShiftedTree => {
            add(&mut words, &walk(spec, (0..lanes).map(|leaf| [(start + leaf) % lanes, leaf])), 4 * chunks);
            add(&mut words, &walk(spec, pairs(0)), 4 * chunks);
        }
        ConeKind::Chain => {
            let nodes = chunks as usize * lanes;
            add(&mut words, &walk(spec, (1..nodes).map(|i| [start + i - 1, start + i].map(|leaf| leaf % lanes))), 4);
        }
        ConeKind::Accumulator => {
            for lane in 0..lanes {
                let to_zero = |sign: i64| {
                    (0..)
                        .map(|by| sign * by)
                        .find(|by| spec.board((lane as i64 + by).rem_euclid(lanes as i64) as usize) == 0)
                };
                let ways = [1, -1].map(|sign| path(spec, lane, to_zero(sign).unwrap()));
                let [on, back] = &ways;
                for [link, backwards] in if on.len() <= back.len() { on } else { back } {
                    words[*link][*backwards] += 4 * chunks;
                }
            }
        }
    }
    words
}

/// What a frame sends: all together, and of it in TRILIN, ABC and cone.
fn of_frame(machine: &MachineSpec, setup: &FrameSetup) -> (Words, [u64; 3]) {
    let spec = BoardSpec::new(machine);
    let [slots, planes] = setup.geometry.slot_counts();
    let mut sum = vec![[0; 2]; spec.boards];
    for plane in 0..planes {
        for depth in 0..setup.geometry.size[2] {
            add(&mut sum, &of_beam(&spec, setup, plane, depth), 1);
        }
    }
    let mut units = [0; 3];
    for slot in 0..slots {
        for (unit, words) in units.iter_mut().zip(of_ray(&spec, machine, setup, slot)) {
            add(&mut sum, &words, planes as u64);
            *unit += planes as u64 * words.iter().flatten().sum::<u64>();
        }
    }
    (sum, units)
}

fn run(machine: &MachineSpec, frames: Vec<Arc<FrameSetup>>) -> RunCounters {
    let mut run = Machine::timing(machine, frames).unwrap();
    run.run(&|_, _| {}).unwrap();
    let counters = run.counters();
    for (name, account) in &counters.units {
        assert_eq!(account.cycles(), counters.cycles, "{name}");
    }
    counters
}

/// Machines of 2 to 8 boards, of every estimator and cone, with links of a rate or none.
fn machines() -> impl Strategy<Value = MachineSpec> {
    let method = proptest::sample::select(GradientMethod::ALL.map(|(method, _)| method).to_vec());
    let kind = proptest::sample::select(ConeKind::ALL.to_vec());
    let capacity = prop_oneof![Just(1024), 1_usize..20];
    (2_usize..=8, 1_usize..6, method, kind, any::<bool>(), (0.05..1.0_f64, capacity)).prop_map(
        |(count, lanes, gradient, kind, padded, (rate, capacity))| MachineSpec {
            // Rounded up to no whole number of lanes a board.
            lanes: count * lanes + lanes / 2,
            boards: Boards {
                count,
                link_words_per_cycle: Some(rate),
                link_capacity_words: capacity,
                ..Boards::default()
            },
            abc: Abc { gradient, ..Abc::default() },
            cone: Cone { kind },
            rays: Rays { slots: if padded { RaySlots::Padded } else { RaySlots::Wrapped }, ..Rays::default() },
            ..MachineSpec::default()
        },
    )
}

/// Parallel views and eyes, far, near and within.
fn views() -> impl Strategy<Value = View> {
    let eye = [-6.0..20.0_f64, -6.0..20.0_f64, -40.0..20.0_f64];
    (proptest::option::of(eye), [-1.0..1.0_f64, -1.0..1.0_f64, 0.3..1.0_f64]).prop_map(|(eye, direction)| {
        let perspective = eye.map(|eye| Perspective { eye_voxel: Some(eye), ..Perspective::new(60.0) });
        let direction = match eye {
            Some(eye) => [0, 1, 2].map(|i| 7.1 - eye[i]),
            None => direction,
        };
        View { perspective, ..View::from_direction(direction, None) }
    })
}

/// The passes of a picture; estimators with feet of perpendiculars have none from an eye.
fn passes(machine: &mut MachineSpec, view: View, dims: [usize; 3]) -> Vec<Arc<FrameSetup>> {
    let feet = matches!(machine.abc.gradient, GradientMethod::Ten | GradientMethod::TenNormalised);
    if view.perspective.is_some() && feet {
        machine.abc.gradient = GradientMethod::Twelve;
    }
    let scene = Scene { view, ..Scene::default() };
    let volume = VolumeInfo { dims, spacing: [1.0; 3], window: [0.0, 255.0] };
    picture_setup(&scene, machine, &volume, true).unwrap().setups
}

/// The least and the most cycles of a picture on links so narrow that nothing else counts: the words of the busiest link over the rate, and the same
/// for each token alone, one after another. And those of the longest token.
fn bounds(machine: &MachineSpec, passes: &[Arc<FrameSetup>]) -> [f64; 3] {
    let spec = BoardSpec::new(machine);
    let rate = machine.boards.link_words_per_cycle.unwrap();
    let busiest = |words: &Words| words.iter().flatten().copied().max().unwrap();
    let (mut all, mut alone, mut longest) = (vec![[0; 2]; spec.boards], 0, 0);
    let mut token = |words: Words, times: u64| {
        add(&mut all, &words, times);
        alone += times * busiest(&words);
        longest = longest.max(busiest(&words));
    };
    for setup in passes {
        let [slots, planes] = setup.geometry.slot_counts();
        for i in 0..planes * setup.geometry.size[2] {
            token(of_beam(&spec, setup, i / setup.geometry.size[2], i % setup.geometry.size[2]), 1);
        }
        for slot in 0..slots {
            of_ray(&spec, machine, setup, slot).into_iter().for_each(|words| token(words, planes as u64));
        }
    }
    [busiest(&all), alone, longest].map(|words| words as f64 / rate)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(60) })]

    #[test]
    fn links_carry_what_lanes_read(machine in machines(), view in views(), dims in [2_usize..18, 2_usize..18, 2_usize..18]) {
        let mut machine = machine;
        for setup in passes(&mut machine, view, dims) {
            let (words, units) = of_frame(&machine, &setup);
            let counters = run(&machine, vec![setup]);
            let carried: Vec<u64> = counters.links.iter().map(|link| link.words).collect();
            prop_assert_eq!(carried, words.as_flattened());
            prop_assert_eq!([counters.ray_words.trilin, counters.ray_words.abc, counters.ray_words.cone], units);
            // Nothing waits behind the last pixel, and all was put that was carried.
            prop_assert!(counters.links.iter().all(|link| link.waiting == 0));
            let all = counters.bus.link_words + units.iter().sum::<u64>();
            prop_assert_eq!(counters.links.iter().map(|link| link.words).sum::<u64>(), all);
        }
    }

    /// Four pictures from a machine that has done nothing: no link carries their words faster, and they are over when each token has had its
    /// links for itself, behind the fill and drain of a machine whose links are of any width.
    #[test]
    fn narrow_links_set_the_rate(machine in machines(), view in views(), dims in [2_usize..18, 2_usize..18, 2_usize..18]) {
        let mut machine = MachineSpec { boards: Boards { link_capacity_words: 1024, ..machine.boards }, ..machine };
        let passes = passes(&mut machine, view, dims);
        let [least, most, longest] = bounds(&machine, &passes);
        let cycles = run(&machine, vec![passes.clone(); 4].concat()).cycles as f64;
        let wide = MachineSpec { boards: Boards { link_words_per_cycle: None, ..machine.boards }, ..machine };
        let fill = run(&wide, passes).cycles as f64;
        prop_assert!(cycles >= 4.0 * least - longest, "{} < 4 · {}", cycles, least);
        prop_assert!(cycles <= 4.0 * most + fill + 3.0 * longest, "{} > 4 · {} + {}", cycles, most, fill);
    }
}

/// Of an even number of boards the half that is farther from a single accumulator sends over the link beside board 0, more than any other carries
/// of a ray: it never rests.
#[test]
fn a_link_that_is_always_the_busiest_sets_the_rate_by_its_words_alone() {
    for count in [2, 4, 6, 8] {
        for (slots, rate) in [(RaySlots::Wrapped, 0.4), (RaySlots::Padded, 0.25), (RaySlots::Wrapped, 0.1)] {
            let n = 4 * count;
            let mut machine = MachineSpec {
                lanes: n,
                boards: Boards { count, link_words_per_cycle: Some(rate), ..Boards::default() },
                cone: Cone { kind: ConeKind::Accumulator },
                rays: Rays { slots, ..Rays::default() },
                ..MachineSpec::default()
            };
            let view = View::from_direction([1e-6, 0.0, 1.0], None);
            let passes = passes(&mut machine, view, [n, n, n]);
            let [words, _, longest] = bounds(&machine, &passes);
            let interval = frame_interval(&machine, &passes).unwrap() as f64;
            assert!((interval - words).abs() <= longest, "{count} boards, {slots:?}: {interval}, not {words}");
        }
    }
}

/// An eye before the middle of a volume, with rays to both sides, and one so far to the side that all rays run with u.
#[test]
fn rays_against_u_read_two_lanes_away_and_wait_for_two_links() {
    let n = 8;
    // A lane on each board.
    let with = |link_latency_cycles| MachineSpec {
        lanes: n,
        boards: Boards { count: n, link_latency_cycles, ..Boards::default() },
        ..MachineSpec::default()
    };
    for (u, lanes_away) in [(3.5, 2), (-4.0, 1)] {
        let perspective = Perspective { eye_voxel: Some([u, 3.5, -30.0]), ..Perspective::new(60.0) };
        let view = View { perspective: Some(perspective), ..View::from_direction([3.5 - u, 0.0, 33.5], None) };
        let passes = passes(&mut with(1), view, [n; 3]);
        assert_eq!(passes.len(), 1);
        let [one, four] = [1, 4].map(|latency| run(&with(latency), passes.clone()));
        // Beams from the farthest board, TRILIN from the next lane, ABC, and a tree of three levels.
        assert_eq!(four.cycles - one.cycles, 3 * (4 + 1 + lanes_away + 7), "eye at u = {u}");
        let [slots, planes] = passes[0].geometry.slot_counts().map(|count| count as u64);
        assert_eq!(one.ray_words.abc, slots * planes * 2 * n as u64 * lanes_away, "eye at u = {u}");
    }
}

#[test]
fn stalls_on_links_have_their_name_in_every_unit() {
    let mut machine = MachineSpec {
        lanes: 32,
        boards: Boards { count: 4, link_words_per_cycle: Some(2.0), link_capacity_words: 8, ..Boards::default() },
        ..MachineSpec::default()
    };
    let passes = passes(&mut machine, View::from_direction([0.5, 0.25, 1.0], None), [32; 3]);
    let counters = run(&machine, passes.clone());
    let waiting = |unit: &str| {
        let (_, account) = counters.units.iter().find(|(name, _)| *name == unit).unwrap();
        account.waiting[Reason::Link as usize]
    };
    for unit in ["bus", "dsb.write", "dsb.read", "trilin", "abc", "cone"] {
        assert!(waiting(unit) > 0, "{unit}");
    }
    assert_eq!(["cfb", "host"].map(waiting), [0, 0]);
    // A token more than what fills it, of each of the four units.
    let peak = counters.links.iter().map(|link| link.peak).max().unwrap();
    assert!((8..8 + 16 + 4 + 4 + 20).contains(&peak), "{peak}");
    // Wide links are as good as any.
    let wide = Boards { link_words_per_cycle: Some(100.0), ..machine.boards };
    let any = Boards { link_words_per_cycle: None, ..machine.boards };
    let [wide, any] = [wide, any].map(|boards| run(&MachineSpec { boards, ..machine.clone() }, passes.clone()));
    assert_eq!((wide.cycles, &wide.units, wide.frame_ends), (any.cycles, &any.units, any.frame_ends));
    assert!(any.units.iter().all(|(_, account)| account.waiting[Reason::Link as usize] == 0));
}

#[test]
fn a_machine_that_its_links_limit_names_the_link() {
    let mut machine = MachineSpec {
        lanes: 32,
        boards: Boards { count: 4, link_words_per_cycle: Some(1.0), ..Boards::default() },
        cone: Cone { kind: ConeKind::Chain },
        ..MachineSpec::default()
    };
    let passes = passes(&mut machine, View::from_direction([1e-6, 0.0, 1.0], None), [32; 3]);
    let found = limits(&machine, &passes, None).unwrap();
    assert_eq!((found.critical.as_str(), found.next.as_deref()), ("links", Some("pipeline")));
    let any = MachineSpec { boards: Boards { link_words_per_cycle: None, ..machine.boards }, ..machine.clone() };
    let free = machine.clock_hz / frame_interval(&any, &passes).unwrap() as f64;
    assert_eq!(found.fps_without, Some(free));
    let (link, busy) = found.sentence.split_once(" frames/s (link 0, forwards, ").expect(&found.sentence);
    assert!(link.starts_with("links: "), "{}", found.sentence);
    let percent: u32 = busy.split_once(" % busy); without it ").unwrap().0.parse().unwrap();
    assert!((70..=100).contains(&percent), "{}", found.sentence);
    // Where they do not limit, no link is named.
    let wide = MachineSpec { boards: Boards { link_words_per_cycle: Some(64.0), ..machine.boards }, ..machine };
    let found = limits(&wide, &passes, None).unwrap();
    assert_eq!(found.critical, "pipeline");
    assert!(!found.sentence.contains("busy"), "{}", found.sentence);
}

/// The book's table of eight boards at 512³: words over each link, and frames a second by the width of the links.
#[test]
#[ignore = "prints the book's table; a minute or two"]
fn eight_boards_at_512() {
    let preset = cube3_inputs::machine("cube3-512").unwrap();
    let slope = |degrees: f64| degrees.to_radians().tan();
    let straight = |axis: usize| {
        let mut direction = [1e-6; 3];
        direction[axis] = 1.0;
        View::from_direction(direction, None)
    };
    let tilted = |du, dv| View::from_direction([slope(du), slope(dv), 1.0], None);
    let far = Perspective { eye_voxel: Some([255.5, 255.5, -700.0]), ..Perspective::new(40.0) };
    let views = [
        ("along x", straight(0)),
        ("along y", straight(1)),
        ("along z", straight(2)),
        ("slopes of 7° and 0°", tilted(7.0, 0.0)),
        ("30° and 7°", tilted(30.0, 7.0)),
        ("45° and 20°", tilted(45.0, 20.0)),
        ("45° and 45°", tilted(45.0, 45.0)),
        ("eye 700 voxels before it", View { perspective: Some(far), ..straight(2) }),
    ];
    for (name, view) in views {
        let mut machine = preset.clone();
        let passes = passes(&mut machine, view.clone(), [512; 3]);
        let counters = run(&machine, passes.clone());
        let per = |words: u64, tokens: u64| words as f64 / (8 * tokens) as f64;
        let rays = counters.ray_words;
        let busiest = cube3_pipeline::links::busiest_link(&counters.links).unwrap();
        print!(
            "| {name} | {:.1} | {} | {:.1}, {:.1}, {:.1} | {} {}: {:.1} |",
            per(counters.bus.link_words, counters.beams),
            counters.bus.link_peak,
            per(rays.trilin, counters.ray_slots),
            per(rays.abc, counters.ray_slots),
            per(rays.cone, counters.ray_slots),
            busiest.link,
            busiest.direction(),
            busiest.words as f64 / counters.ray_slots as f64,
        );
        for width in [None, Some(288.0), Some(256.0), Some(192.0), Some(128.0), Some(64.0), Some(32.0)] {
            machine.boards.link_words_per_cycle = width;
            let interval = frame_interval(&machine, &passes).unwrap();
            print!(" {:.1} |", machine.clock_hz / interval as f64);
        }
        println!();
    }
}
