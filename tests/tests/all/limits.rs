//! Each row of `limits` by a machine that it limits, by how much follows from the machine.

use cube3::limits::{frame_interval, limits};
use cube3_frame::FrameSetup;
use cube3_host::{VolumeInfo, picture_setup};
use cube3_machine::{
    Abc, Acquisition, AcquisitionMode, Boards, Bus, Cfb, ChannelSize, Channels, Cone, ConeKind, Dsb, Frames, HostLink,
    MachineSpec, RaySlots, Rays,
};
use cube3_scene::{Perspective, Scene, View};
use std::sync::Arc;

const SIDE: usize = 32;

fn setups(machine: &MachineSpec, view: View) -> Vec<Arc<FrameSetup>> {
    let scene = Scene { view, ..Scene::default() };
    let volume = VolumeInfo { dims: [SIDE; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    picture_setup(&scene, machine, &volume, true).unwrap().setups
}

/// A machine of a lane for each voxel of a beam, and padded slots where pixels are to leave one at a time.
fn machine() -> MachineSpec {
    MachineSpec { lanes: SIDE, ..MachineSpec::default() }
}

#[test]
fn every_row_limits_a_machine_and_its_name_is_given() {
    let m = machine();
    let stealing = Acquisition { mode: AcquisitionMode::CycleStealing, words_per_cycle: SIDE as f64 };
    let narrow = ChannelSize { capacity: 1, latency: 2 };
    let padded = Rays { slots: RaySlots::Padded, ..m.rays };
    // Each row with a machine, and how many times as long its frames take as without what is in the way; as stated where it follows.
    let rows: [(&str, MachineSpec, Option<f64>); 12] = [
        ("memory", MachineSpec { cfb: Cfb { skew: [4, 1, 1], ..Cfb::default() }, ..m.clone() }, Some(4.0)),
        ("acquisition port", MachineSpec { acquisition: stealing, ..m.clone() }, None),
        ("bus", MachineSpec { bus: Bus { channels: Some(SIDE / 2), ..m.bus }, ..m.clone() }, Some(2.0)),
        ("bus", MachineSpec { bus: Bus { clock_hz: Some(m.clock_hz / 2.0), ..m.bus }, ..m.clone() }, Some(2.0)),
        (
            "links",
            MachineSpec {
                boards: Boards { count: 2, link_words_per_cycle: Some(2.0), link_capacity_words: 64, ..m.boards },
                ..m.clone()
            },
            None,
        ),
        ("buffers", MachineSpec { dsb: Dsb { ports: 1, ..m.dsb }, ..m.clone() }, Some(2.0)),
        // A ring in which nothing comes in while a plane is read.
        ("buffers", MachineSpec { dsb: Dsb { planes: 2, ..m.dsb }, ..m.clone() }, None),
        ("buffers", MachineSpec { abc: Abc { planes: 3, ..m.abc }, ..m.clone() }, None),
        ("cone", MachineSpec { cone: Cone { kind: ConeKind::Accumulator }, ..m.clone() }, Some(SIDE as f64)),
        // A token in two cycles and its credit in one more.
        ("channels", MachineSpec { channel: Channels { rays: narrow, ..m.channel }, ..m.clone() }, Some(3.0)),
        // Pixels of eight bytes.
        ("host", MachineSpec { host_link: HostLink { bytes_per_cycle: Some(2.0) }, rays: padded, ..m.clone() }, None),
        ("drain", MachineSpec { frames: Frames { overlap: false }, ..m.clone() }, None),
    ];
    for (name, limited, times) in rows {
        let passes = setups(&limited, View::from_direction([0.5, 0.25, 1.0], None));
        let incoming = (name == "acquisition port").then_some([SIDE; 3]);
        let found = limits(&limited, &passes, incoming).unwrap();
        assert_eq!(found.critical, name, "{}", found.sentence);
        assert!(found.sentence.starts_with(&format!("{name}: ")), "{}", found.sentence);
        let ratio = found.fps_without.unwrap() / found.fps;
        assert!(ratio > 1.01, "{name}: {ratio}");
        if let Some(times) = times {
            assert!((ratio / times - 1.0).abs() < 0.02, "{name}: {ratio}, not {times}");
        }
        assert!(found.without.iter().any(|without| without.resource == name));
    }
}

/// Eyes that are near need four words on the bus for each ray slot and depth, on a bus that has a channel for each lane already.
#[test]
fn a_bus_that_is_busy_with_the_words_of_a_near_eye_is_not_called_the_pipeline() {
    let m = machine();
    let perspective = Perspective { eye_voxel: Some([16.0, 16.0, -3.0]), ..Perspective::new(60.0) };
    let view = View { perspective: Some(perspective), ..View::from_direction([0.0, 0.0, 1.0], None) };
    let passes = setups(&m, view);
    assert!(passes[0].geometry.doubled());
    let found = limits(&m, &passes, None).unwrap();
    assert_eq!((found.critical.as_str(), found.fps_without), ("bus", None), "{}", found.sentence);
    assert!(!found.sentence.contains("pipeline"), "{}", found.sentence);
    // Four slices of every lane for each beam of a plane and depth.
    let geometry = &passes[0].geometry;
    let [slots, planes] = geometry.slot_counts();
    let slices =
        4 * slots.div_ceil(SIDE) * planes * (geometry.size[2] - geometry.perspective.as_ref().unwrap().first_depth);
    let interval = frame_interval(&m, &passes).unwrap() as f64 / passes.len() as f64;
    assert!((interval / slices as f64 - 1.0).abs() < 0.35, "{interval} cycles, {slices} slices");
}
