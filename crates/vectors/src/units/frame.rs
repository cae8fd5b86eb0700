//! Registers of frames in which all but one stage of the shading leaves colours as they are.

use cube3_abc::lanes::{AbcLanes, ShadedRow};
use cube3_frame::{Axes, Classification, ConeRegisters, FrameSetup, Geometry};
use cube3_machine::{ConeOrder, RaySlots, Reuse, TemplateRule};
use cube3_scene::Mode;
use cube3_word::{Words, unit_full};

/// Sample word 0 opaque and of a colour, without light, cue or clip.
pub fn coloured(colour: [u32; 3], words: &Words) -> FrameSetup {
    let axes = Axes { axis: [0, 1, 2], reversed: [false; 3] };
    FrameSetup {
        schema: 1,
        words: *words,
        geometry: Geometry::new(
            [1; 3],
            axes,
            [0; 2],
            0,
            words.weight_bits,
            TemplateRule::PlaneFloor,
            RaySlots::Wrapped,
        ),
        reuse: Reuse::Both,
        clips: Vec::new(),
        classification: Classification {
            threshold: [0, unit_full(words.sample_bits())],
            index_shift: words.sample_bits() - words.table_bits,
            opacity: vec![unit_full(words.opacity_bits)],
            colour: vec![colour],
            gradient_rows: None,
        },
        gradient: None,
        normaliser: None,
        shading: None,
        depth_cue: None,
        cone: ConeRegisters { mode: Mode::Composite, order: ConeOrder::Tree, leaves: 1, opaque: 1, sum_weight: 0 },
        rays: None,
        ends: None,
    }
}

/// The colour of a sample 0 of a frame, with a gradient of 1 along u, and how many words were saturated.
pub fn shaded(setup: &FrameSetup) -> ([u32; 3], u64) {
    let mut out = ShadedRow { present: vec![1], ..ShadedRow::default() };
    let samples = [[0], [1 << setup.words.gradient_drop()]];
    let neighbour = |w: usize, v: usize, u: usize| samples[usize::from([w, v, u] == [1, 1, 2])].as_slice();
    AbcLanes::new(setup, true).shade(1, neighbour, |_| [0; 3], &setup.geometry, &mut out);
    ([0, 1, 2].map(|i| out.colour[i][0]), out.overflows)
}
