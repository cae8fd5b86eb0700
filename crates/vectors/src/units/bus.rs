//! The fast bus as a rotation of a beam.

use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_dsb::Rotator;
use cube3_dsb::golden::{turn, turned};
use cube3_frame::{Axes, Geometry};
use cube3_machine::{RaySlots, TemplateRule};

/// The rotation.
pub struct BusSheet;

impl Unit for BusSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "bus",
            title: "Rotation of a beam",
            purpose: "A beam of LANES voxels is turned from the frame buffer's lanes to those of the skewed buffer: voxel x of row v at depth k \
                      comes from lane (x + v + k) mod LANES and goes to (j + k) mod LANES, where its slot j is (x − X(k)) mod LANES. So \
                      the beam turns by −X(k) − v, whatever the depth: what was in lane l is in (l + rotation) mod LANES.",
            source: "Pfister et al. 1995, section 4; `cube3_dsb::golden::rotation`",
            parameters: &["voxel_bits", "lanes"],
            module: None,
            inputs: vec![
                Port::unsigned("row", "12", "row v of the beam").within("0", "LANES - 1"),
                Port::unsigned("column", "12", "column X(k) of the discrete rays").within("0", "LANES - 1"),
                Port::unsigned("voxel", "V", "voxel words in the frame buffer's lanes").times("LANES"),
            ],
            tables: Vec::new(),
            wires: vec![
                Wire::new("difference", "slot of voxel 0, (0 − column) mod LANES, − row", "-(LANES - 1)", "LANES - 1"),
                Wire::new("rotation", "difference mod LANES, not negative", "0", "LANES - 1").made_by(WireKind::Cases),
            ],
            outputs: vec![
                Port::unsigned("rotation", "12", "how far the beam turns"),
                Port::unsigned("out", "V", "voxel words in the skewed buffer's lanes").times("LANES"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let mut fields = Reader::new(inputs);
        let lanes = format.lanes as usize;
        let [row, column] = fields.words().map(|i: u32| i as usize);
        let rotation = turn(lanes, row, (lanes - column) % lanes, probe);
        let mut outputs = vec![rotation as i128];
        outputs.extend(turned(&inputs[2..], rotation));
        outputs
    }

    /// Every row and column of a machine with few lanes.
    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        let lanes = i128::from(format.lanes.min(16));
        let line = |row, column| [row, column].into_iter().chain(0..i128::from(format.lanes)).collect::<Vec<i128>>();
        let mask = (1 << format.words.voxel_bits) - 1;
        let masked =
            |line: Vec<i128>| line.iter().enumerate().map(|(i, v)| if i < 2 { *v } else { v & mask }).collect();
        (0..lanes)
            .flat_map(|row| (0..lanes).map(move |column| (row, column)))
            .map(|(r, c)| masked(line(r, c)))
            .collect()
    }

    fn formats(&self) -> Vec<UnitFormat> {
        [1, 2, 5, 8, 16].map(|lanes| UnitFormat { lanes, ..UnitFormat::default() }).to_vec()
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let n = format.lanes as usize;
        let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
        let rotator = Rotator { lanes: n };
        let mut aligned = Vec::new();
        let line = |line: &Vec<i128>| {
            let mut geometry = Geometry::new([n; 3], axes, [0; 2], 0, 8, TemplateRule::PlaneFloor, RaySlots::Wrapped);
            geometry.u.columns.fill(line[1] as u32);
            let beam: Vec<u16> = line[2..].iter().map(|&voxel| voxel as u16).collect();
            // At any depth; the frame buffer's lanes and the skewed buffer's move along together.
            rotator.align(&geometry, line[0] as usize, 0, &beam, &mut aligned);
            let rotation = (2 * n - (line[1] + line[0]) as usize % n) % n;
            let mut outputs = vec![rotation as i128];
            outputs.extend(aligned.iter().map(|&voxel| i128::from(voxel)));
            outputs
        };
        Some(lines.iter().map(line).collect())
    }
}
