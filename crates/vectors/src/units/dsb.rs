//! The addressing of a 2-D skewed buffer.

use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_dsb::PlaneStore;
use cube3_dsb::golden::{beam_lane, module, ray_lane};
use cube3_frame::{Axes, BeamPlace, Geometry, Schedule};
use cube3_machine::{RaySlots, TemplateRule};
use cube3_word::Probe;

/// Chunks of LANES of a beam and of a ray.
const CHUNKS: usize = 8;

/// The skewed buffer's addresses.
pub struct DsbSheet;

impl Unit for DsbSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "dsb",
            title: "Addresses of a plane",
            purpose: "Ray slot j at depth k is in module (j + k) mod LANES: neighbours along a beam (one k) are in different modules, and so are \
                      neighbours along a ray (one j). A beam of more than LANES slots comes in chunks of LANES, and the slot's place in it is \
                      its chunk and module; a ray of more than LANES depths likewise. Word of the module: the beam's chunk, and k.",
            source: "Pfister et al. 1995, section 4; `cube3_dsb::golden::{module, beam_lane, ray_lane}`",
            parameters: &["lanes"],
            module: None,
            inputs: vec![
                Port::unsigned("slot", "12", "ray slot j").within("0", "8 * LANES - 1"),
                Port::unsigned("depth", "12", "depth k").within("0", "8 * LANES - 1"),
            ],
            tables: Vec::new(),
            wires: vec![
                Wire::new("module", "(j + k) mod LANES", "0", "LANES - 1").made_by(WireKind::Cases),
                Wire::new("beam_place", "⌊j / LANES⌋·LANES + module", "0", "8 * LANES - 1"),
                Wire::new("ray_place", "⌊k / LANES⌋·LANES + module", "0", "8 * LANES - 1"),
            ],
            outputs: vec![
                Port::unsigned("beam_module", "12", "module"),
                Port::unsigned("beam_place", "12", "place of the slot in an aligned beam"),
                Port::unsigned("ray_place", "12", "place of the depth in a ray"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let [slot, depth] = Reader::new(inputs).words().map(|i: u32| i as usize);
        let lanes = format.lanes as usize;
        let places = [module(lanes, slot, depth), beam_lane(lanes, slot, depth), ray_lane(lanes, slot, depth)];
        let places = places.map(|place| place as i128);
        for (name, place) in ["module", "beam_place", "ray_place"].into_iter().zip(places) {
            probe.wire(name, 0, place);
        }
        places.to_vec()
    }

    /// Two planes are written beam by beam and read ray by ray, which come in order of depth: in one a word is its place in the beam, in the
    /// other its depth. The place in the ray is in the depth's chunk, in the module that the word has in the beam.
    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let lanes = format.lanes as usize;
        let side = CHUNKS * lanes;
        let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
        let geometry = Geometry::new([side, 2, side], axes, [0; 2], 0, 8, TemplateRule::PlaneFloor, RaySlots::Wrapped);
        let mut store = PlaneStore::new(Schedule::of(&geometry, lanes, None), 2);
        let places: Vec<u16> = (0..side as u16).collect();
        for depth in 0..side as u32 {
            let beam = |plane| BeamPlace { section: 0, plane, depth };
            store.write(beam(0), Some(&places));
            store.write(beam(1), Some(&vec![depth as u16; side]));
        }
        let mut rays = [Vec::new(), Vec::new()];
        let mut answer = |inputs: &Vec<i128>| {
            let [slot, depth] = Reader::new(inputs).words().map(|i: u32| i as usize);
            for (plane, ray) in rays.iter_mut().enumerate() {
                store.read(plane, false, slot, ray);
            }
            // A depth that is nowhere in the ray has no place.
            let found = rays[1].iter().position(|&word| usize::from(word) == depth)?;
            let beam_place = usize::from(rays[0][found]);
            let module = beam_place % lanes;
            Some([module, beam_place, found / lanes * lanes + module].map(|place| place as i128).to_vec())
        };
        Some(lines.iter().map(|line| answer(line).unwrap_or_else(|| vec![-1; 3])).collect())
    }

    fn formats(&self) -> Vec<UnitFormat> {
        [1, 2, 5, 8, 12, 16, 64].map(|lanes| UnitFormat { lanes, ..UnitFormat::default() }).to_vec()
    }
}
