//! The address generator of the cubic frame buffer.

use crate::unit::Reader;
use crate::{Port, Sheet, Tables, Unit, UnitFormat, Wire, WireKind, WireRecorder};
use cube3_cfb::FrameBuffer;
use cube3_cfb::golden::{Placement, Skew};
use cube3_machine::Layout;

/// The frame buffer's addresses.
pub struct CfbSheet;

fn placement(format: &UnitFormat) -> Placement {
    Placement {
        skew: Skew { coefficients: format.skew, lanes: format.lanes as usize },
        layout: format.layout,
        dims: format.dims.map(|n| n as usize),
    }
}

impl Unit for CfbSheet {
    fn sheet(&self) -> Sheet {
        Sheet {
            name: "cfb",
            title: "Address generator",
            purpose: "Module and address of voxel (x, y, z): module (a·x + b·y + c·z) mod LANES, with a non-negative remainder. Within a module \
                      the words of a row of voxels come first, then rows, then planes; with BLOCKS = 1 blocks of 8 × 8 × 8 words, one behind \
                      another. With d = gcd(a, LANES), a module has d words of each LANES voxels along x: word ⌊x / LANES⌋·d + (x mod LANES) / \
                      (LANES / d). BLOCKS = 2: mini-block (i, j, k) = (⌊x / 2⌋, ⌊y / 2⌋, ⌊z / 2⌋) is in module (a·i + b·j + c·k) mod LANES, which needs \
                      d = 1. Blocks of 2·LANES × 8 × 8 voxels come one behind another, 128 words of each module: word x mod 2 + 2·(y mod 2) + \
                      4·(z mod 2) + 8·(j mod 4) + 32·(k mod 4) within.",
            source: "Pfister et al. 1995, section 2; `cube3_cfb::golden::Placement`",
            parameters: &["lanes", "nx", "ny", "nz", "skew_a", "skew_b", "skew_c", "blocks"],
            module: None,
            inputs: vec![
                Port::unsigned("x", "12", "voxel along x").within("0", "NX - 1"),
                Port::unsigned("y", "12", "voxel along y").within("0", "NY - 1"),
                Port::unsigned("z", "12", "voxel along z").within("0", "NZ - 1"),
            ],
            tables: Vec::new(),
            wires: vec![
                Wire::new("sum", "a·x + b·y + c·z, or of mini-blocks", "SKEW_LOW", "SKEW_HIGH"),
                Wire::new("module", "sum mod LANES, not negative", "0", "LANES - 1").made_by(WireKind::Cases),
                Wire::new("term", "what x, y and z add to the address", "0", "TERM").times("3").loose(),
                Wire::new("address", "the sum of the terms", "0", "TERM").loose(),
            ],
            outputs: vec![
                Port::unsigned("module_number", "12", "module"),
                Port::unsigned("address", "36", "word of the module"),
            ],
            clocked: false,
        }
    }

    fn evaluate(&self, format: &UnitFormat, _: &Tables, inputs: &[i128], probe: &mut WireRecorder) -> Vec<i128> {
        let xyz: [u32; 3] = Reader::new(inputs).words();
        let placement = placement(format);
        let module = placement.module_wires(xyz.map(|i| i as usize), probe);
        let address = placement.address_wires(xyz.map(|i| i as usize), probe);
        vec![module as i128, address as i128]
    }

    fn lanes(&self, format: &UnitFormat, _: &Tables, lines: &[Vec<i128>]) -> Option<Vec<Vec<i128>>> {
        let Placement { skew, layout, dims } = placement(format);
        let buffer = FrameBuffer::with_layout(skew, layout, dims, &[]).ok()?;
        let answer = |inputs: &Vec<i128>| {
            let xyz: [u32; 3] = Reader::new(inputs).words();
            buffer.module_and_address(xyz.map(|i| i as usize)).map(|place| place as i128).to_vec()
        };
        Some(lines.iter().map(answer).collect())
    }

    /// Every voxel of a volume that has few.
    fn corners(&self, format: &UnitFormat) -> Vec<Vec<i128>> {
        let [nx, ny, nz] = format.dims.map(|n| i128::from(n.min(9)));
        (0..nx).flat_map(|x| (0..ny).flat_map(move |y| (0..nz).map(move |z| vec![x, y, z]))).step_by(3).collect()
    }

    fn formats(&self) -> Vec<UnitFormat> {
        let format = |lanes, dims, skew, layout| UnitFormat { lanes, dims, skew, layout, ..UnitFormat::default() };
        let [rows, blocks, mini_blocks] = Layout::ALL;
        vec![
            UnitFormat::default(),
            format(8, [16, 16, 16], [1, 1, 1], blocks),
            format(5, [7, 11, 9], [1, 1, 1], rows),
            format(6, [13, 5, 10], [2, 1, 1], rows),
            format(6, [13, 5, 10], [4, 3, 1], blocks),
            format(8, [9, 17, 3], [-1, 3, -5], blocks),
            format(1, [4, 2, 3], [1, 1, 1], rows),
            format(32, [64, 40, 100], [1, 2, 4], rows),
            format(4, [16, 20, 18], [1, 1, 1], mini_blocks),
            format(6, [29, 9, 3], [-5, 3, 2], mini_blocks),
            format(1, [5, 2, 17], [0, 1, 1], mini_blocks),
        ]
    }
}
