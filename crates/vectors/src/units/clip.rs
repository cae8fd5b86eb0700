//! Cut planes and the crop box.

use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireRecorder};
use cube3_frame::{HalfSpace, Linear};

/// A half-space.
pub struct ClipSheet;

/// The sample u, v, k of a line, and the distance.
fn line(inputs: &[i128]) -> ([i64; 3], Linear) {
    let mut fields = Reader::new(inputs);
    let mut field = || fields.field() as i64;
    ([field(), field(), field()], Linear { u: field(), v: field(), k: field(), constant: field() })
}

impl Unit for ClipSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "clip",
            title: "Half-space",
            purpose: "Whether sample k of ray (u, v) of a parallel frame lies in a half-space: the sign of a linear function, its distance \
                      from a plane in voxels, a fraction of 32 bits. The sample on the plane is inside. Along u and v a step is at most 1, \
                      along the ray, which moves along all three, at most 3; a plane farther than 2^28 away is put there.",
            source: "`cube3_frame::Linear::at`",
            parameters: &[],
            module: None,
            inputs: vec![
                Port::signed("u", "14", "the ray along u").within("-8191", "8191"),
                Port::signed("v", "14", "the ray along v").within("-8191", "8191"),
                Port::signed("k", "14", "the sample").within("0", "8191"),
                Port::signed("step_u", "34", "step of the distance to the next ray along u").within("-2^32", "2^32"),
                Port::signed("step_v", "34", "along v").within("-2^32", "2^32"),
                Port::signed("step_k", "35", "along the ray").within("-3 * 2^32", "3 * 2^32"),
                Port::signed("constant", "62", "distance at sample 0 of ray (0, 0)").within("-2^60", "2^60"),
            ],
            tables: Vec::new(),
            wires: vec![
                Wire::new("product", "u · step_u, v · step_v, k · step_k", "-3 * 8191 * 2^32", "3 * 8191 * 2^32")
                    .times("3"),
                Wire::new(
                    "value",
                    "sum of the products and constant",
                    "-2^60 - 5 * 8191 * 2^32",
                    "2^60 + 5 * 8191 * 2^32",
                ),
            ],
            outputs: vec![Port::unsigned("kept", "1", "value ≥ 0")],
            clocked: false,
        }
    }

    fn evaluate(&self, _: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let ([u, v, k], distance) = line(inputs);
        vec![(distance.at_wires(u, v, k, probe) >= 0).into()]
    }

    /// Samples beside the plane and on it.
    fn corners(&self, _: &UnitFormat) -> Vec<Vec<i128>> {
        let mut noise = super::contents::Noise::new(4);
        let mut between = |low: i128, high: i128| low + noise.up_to(high - low);
        let mut beside = |distance: i128| {
            let at = [between(-8191, 8191), between(-8191, 8191), between(0, 8191)];
            let steps = [between(-1 << 32, 1 << 32), between(-1 << 32, 1 << 32), between(-3 << 32, 3 << 32)];
            let along: i128 = at.iter().zip(steps).map(|(at, step)| at * step).sum();
            [at.to_vec(), steps.to_vec(), vec![distance - along]].concat()
        };
        (0..8).flat_map(|_| [-1, 0, 1].map(&mut beside)).collect()
    }

    fn lanes(&self, _: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let answer = |inputs: &Vec<i128>| {
            let ([u, v, k], distance) = line(inputs);
            // The rays of a row that are kept, the line's in their midst.
            let [from, to] = HalfSpace { distance }.interval(v, k, [u - 2, u + 3]);
            vec![(from..to).contains(&u).into()]
        };
        Some(lines.iter().map(answer).collect())
    }

    /// No word of the machine enters it.
    fn formats(&self) -> Vec<UnitFormat> {
        vec![UnitFormat::default()]
    }
}
