//! The items of a plan: what the registers of a picture's frames do not have.

use crate::{Plan, Rule, RuleRow, Savings};
use cube3_frame::{FrameSetup, GradientScale, HalfSpace, LinearFactor, Normaliser, Schedule};
use cube3_machine::{MachineSpec, OperatorCounts, RaySlots, ShadingUnit, operators};
use cube3_scene::MOST_LIGHTS;
use std::borrow::Borrow;

/// Something that was left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// The rule that left it out.
    pub rule: Rule,
    /// Why it cannot change the picture.
    pub why: &'static str,
    /// What that saves.
    pub savings: Savings,
}

impl Item {
    /// The rule's row.
    pub fn row(&self) -> &'static RuleRow {
        self.rule.row()
    }
}

impl Plan {
    /// What was left out of a picture's frames on a machine, in all of them, in the order of the rules. In perspective a picture has up to
    /// six frames, and those that it does not need are an item.
    pub fn items(&self, machine: &MachineSpec, lights: usize, frames: &[impl Borrow<FrameSetup>]) -> Vec<Item> {
        let frames: Vec<&FrameSetup> = frames.iter().map(Borrow::borrow).collect();
        let mut items: Option<Vec<Item>> = None;
        for &setup in &frames {
            let of_frame = FrameItems { plan: self, machine, lights, setup }.items();
            items = Some(match items {
                None => of_frame,
                Some(before) => before.into_iter().filter_map(|item| joined(item, &of_frame)).collect(),
            });
        }
        let mut items = items.unwrap_or_default();
        let perspective = frames.iter().any(|setup| setup.geometry.perspective.is_some());
        if (perspective || frames.is_empty()) && self.rules.follow(Rule::OtherFaces) {
            items.push(Item {
                rule: Rule::OtherFaces,
                why: "no ray of the picture that meets the volume has its major axis there",
                savings: Savings { passes: 6_u64.saturating_sub(frames.len() as u64), ..Savings::default() },
            });
        }
        items
    }
}

/// An item of the frames before, where the next one has it, too.
fn joined(item: Item, next: &[Item]) -> Option<Item> {
    let same = next.iter().find(|other| other.rule == item.rule)?;
    Some(Item { savings: item.savings.and(same.savings), ..item })
}

/// A frame as it was made.
struct FrameItems<'a> {
    plan: &'a Plan,
    machine: &'a MachineSpec,
    lights: usize,
    setup: &'a FrameSetup,
}

impl FrameItems<'_> {
    fn items(&self) -> Vec<Item> {
        let mut items = vec![
            self.gradient_unit(),
            self.gradient_scale(),
            self.normaliser(),
            self.shading_unit(),
            self.depth_cue(),
            self.gradient_rows(),
            self.half_spaces(),
            self.closing_planes(),
        ];
        items.retain(|item| item.as_ref().is_some_and(|item| self.plan.rules.follow(item.rule)));
        items.into_iter().flatten().collect()
    }

    /// An item that saves operators of each lane, bits of memory and cycles.
    fn item(&self, rule: Rule, why: &'static str, operators: OperatorCounts, bits: u64, cycles: u64) -> Option<Item> {
        let schedule = self.schedule();
        let samples = schedule.ray_slots() * schedule.shape().depths as u64;
        let operations = operators.all() * samples;
        let savings = Savings { operators, cycles, bytes: bits.div_ceil(8), operations, passes: 0 };
        Some(Item { rule, why, savings })
    }

    fn gradient_unit(&self) -> Option<Item> {
        if self.setup.gradient.is_some() {
            return None;
        }
        let FrameItems { machine, setup, .. } = *self;
        let (words, method) = (&machine.words, machine.abc.gradient);
        let scale = if method.row().normalised { scale_operators(machine) } else { OperatorCounts::default() };
        let operators =
            operators::gradient(method, words) + operators::gradient_word(words, method.row().extra_bits()) + scale;
        let schedule = self.schedule();
        let ring = setup.ring(machine.abc.planes);
        let firsts = if schedule.shape().closes[1] { schedule.first_samples(machine.frames.overlap) } else { 0 };
        let samples = schedule.sample_planes(ring) + firsts + schedule.overlap_samples();
        let wait = |buffered| schedule.shading_order(setup.most_reach(), buffered).first_wait();
        let cycles = schedule.ray_cycles() * (wait(true) - wait(false));
        let bits = samples * u64::from(words.sample_bits());
        self.item(Rule::GradientUnit, "nothing in this scene reads a gradient", operators, bits, cycles)
    }

    fn gradient_scale(&self) -> Option<Item> {
        let registers = self.setup.gradient.as_ref().filter(|registers| registers.scale.is_none())?;
        if registers.method.row().normalised {
            let why = "the voxels are cubes and the differences are taken over equal lengths";
            self.item(Rule::GradientScale, why, scale_operators(self.machine), 0, 0)
        } else {
            let why = "this estimator uses its differences as they are";
            self.item(Rule::GradientScale, why, OperatorCounts::default(), 0, 0)
        }
    }

    fn normaliser(&self) -> Option<Item> {
        if self.setup.normaliser.is_some() {
            return None;
        }
        let why = match self.plan.needs.gradient {
            true => "the reflectance table reads the direction alone",
            false => "nothing in this scene reads the length or the direction of a gradient",
        };
        let (words, root_bits) = (&self.machine.words, self.machine.abc.root_bits);
        let bits = Normaliser::entries(root_bits) * u64::from(words.normal_bits + 1);
        self.item(Rule::Normaliser, why, operators::NORMALISER, self.in_lanes(bits), 0)
    }

    fn shading_unit(&self) -> Option<Item> {
        if self.setup.shading.is_some() {
            return None;
        }
        let (machine, words) = (self.machine, &self.machine.words);
        let colour_bits = u64::from(words.colour_bits);
        let bits = match machine.abc.shading {
            ShadingUnit::Phong => ((1 << machine.abc.power_bits) + 1) * (colour_bits + 1),
            ShadingUnit::ReflectanceTable => 2 * 6 * (1 << (2 * machine.abc.reflectance_bits)) * 3 * (colour_bits + 4),
        };
        let lights = self.lights.clamp(1, MOST_LIGHTS) as u64;
        let operators = operators::shading(machine, lights) + operators::lit_colour(words);
        let why = "this mode or material uses colours as they are";
        self.item(Rule::ShadingUnit, why, operators, self.in_lanes(bits), 0)
    }

    fn depth_cue(&self) -> Option<Item> {
        if self.setup.depth_cue.is_some() {
            return None;
        }
        let operators = operators::depth_cue(&self.machine.words, LinearFactor::WORD_BITS);
        self.item(Rule::DepthCue, "the scene has none", operators, 0, 0)
    }

    fn gradient_rows(&self) -> Option<Item> {
        let table = &self.setup.classification;
        if table.gradient_rows.is_some() {
            return None;
        }
        let words = &self.machine.words;
        let entries = table.opacity.len() as u64 * ((1 << words.table_gradient_bits) - 1);
        let bits = self.in_lanes(entries * u64::from(words.opacity_bits));
        let operators = operators::MAGNITUDE + operators::ROW;
        self.item(Rule::GradientRows, "opacity depends on the value alone", operators, bits, 0)
    }

    fn half_spaces(&self) -> Option<Item> {
        if !self.setup.clips.is_empty() {
            return None;
        }
        let operators = operators::half_spaces(HalfSpace::MOST as u64);
        self.item(Rule::HalfSpaces, "the scene has none", operators, 0, 0)
    }

    fn closing_planes(&self) -> Option<Item> {
        let geometry = &self.setup.geometry;
        if geometry.closes()[1] || geometry.slots != RaySlots::Wrapped {
            return None;
        }
        let FrameItems { machine, setup, .. } = *self;
        let (schedule, words, overlap) = (self.schedule(), &machine.words, machine.frames.overlap);
        let voxels = schedule.first_voxels(overlap) * u64::from(words.voxel_bits);
        let samples = if setup.gradient.is_some() { schedule.first_samples(overlap) } else { 0 };
        let bits = voxels + samples * u64::from(words.sample_bits());
        self.item(Rule::ClosingPlanes, "no slot is shared along v in this view", OperatorCounts::default(), bits, 0)
    }

    fn schedule(&self) -> Schedule {
        Schedule::new(self.machine, &self.setup.geometry)
    }

    /// Bits of a table that each lane has.
    fn in_lanes(&self, bits: u64) -> u64 {
        self.machine.lanes as u64 * bits
    }
}

/// The three factors of a gradient's components.
fn scale_operators(machine: &MachineSpec) -> OperatorCounts {
    operators::gradient_scale(&machine.words, GradientScale::FACTOR_BITS)
}
