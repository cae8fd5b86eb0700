//! A TRILIN unit: the sample of a sheared cell.

use super::lerp_wires;
use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, WireRecorder};
use cube3_trilin::golden::{Weights, cell_wires, lift};
use cube3_trilin::lanes::TrilinLanes;
use cube3_word::BLOCK_LANES;

/// TRILIN.
pub struct TrilinSheet;

impl Unit for TrilinSheet {
    fn sheet(&self) -> Sheet {
        let parts = [lerp_wires("along_w", "4"), lerp_wires("along_u", "2"), lerp_wires("along_v", "1")];
        Sheet {
            name: "trilin",
            title: "Sheared trilinear interpolation",
            purpose: "The sample in the sheared cell between eight voxels: four of the front plane and four of the back one, on the \
                      discrete rays (u, v), (u+1, v), (u, v+1), (u+1, v+1). Voxels are lifted to sample words by F zero bits; then \
                      four lerps along w with the one weight of the frame, two along u, one along v, each rounded.",
            source: "Pfister et al. 1995, section 3; `cube3_trilin::golden::cell`",
            parameters: &["voxel_bits", "sample_fraction_bits", "weight_bits", "nearest"],
            module: None,
            inputs: vec![
                Port::unsigned("voxel", "V", "voxel words, number 4·w + 2·v + u").times("8"),
                Port::unsigned("weight_w", "W + 1", "offset o of the sample").within("0", "2^W"),
                Port::unsigned("weight_u", "W + 1", "weight along u").within("0", "2^W"),
                Port::unsigned("weight_v", "W + 1", "weight along v").within("0", "2^W"),
            ],
            tables: Vec::new(),
            wires: parts.concat(),
            outputs: vec![Port::unsigned("sample", "S", "sample word")],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let mut fields = Reader::new(inputs);
        let voxels: [u32; 8] = fields.words();
        let corners =
            [0, 1].map(|w| [0, 1].map(|v| [0, 1].map(|u| lift(voxels[4 * w + 2 * v + u] as u16, &format.words))));
        let [w, u, v] = fields.words();
        vec![cell_wires(corners, Weights { w, u, v }, &format.words, probe).into()]
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let lanes = TrilinLanes::new(&format.words);
        // The offset along w is one for a row: of each line, a row of one.
        let edges: Vec<Vec<i32>> = (0..4)
            .map(|edge| {
                let along_w = |line: &Vec<i128>| {
                    let mut out = [0];
                    lanes.row_along_w(&[line[edge] as u16], &[line[4 + edge] as u16], line[8] as u32, &mut out);
                    out[0]
                };
                let mut row: Vec<i32> = lines.iter().map(along_w).collect();
                row.resize(lines.len().next_multiple_of(BLOCK_LANES), 0);
                row
            })
            .collect();
        // Rows have whole blocks.
        let room = lines.len().next_multiple_of(BLOCK_LANES);
        let weights = |i: usize| {
            let mut row: Vec<u32> = lines.iter().map(|line| line[i] as u32).collect();
            row.resize(room, 0);
            row
        };
        let row = |near: &[i32], far: &[i32], weights: &[u32]| {
            let mut out = vec![0; room];
            lanes.lerps(near, far, weights, &mut out);
            out
        };
        let along_u = weights(9);
        let (above, below) = (row(&edges[0], &edges[1], &along_u), row(&edges[2], &edges[3], &along_u));
        Some(row(&above, &below, &weights(10))[..lines.len()].iter().map(|&sample| vec![sample.into()]).collect())
    }
}
