//! The traffic of a real run as vectors: what flowed through a unit of arithmetic or addressing while the machine rendered a frame.
//!
//! Lines are in the machine's order: sections and planes of ray slots, slots, depths; beams by section, plane and depth. From the ABC units on,
//! the first plane and the first slot come last where slots are shared, as [`FrameSetup::shading_order`] says. Values are those of the unit crates'
//! definitions on the frame's registers and voxels, which the cycle machine equals to the bit; channels are those of a timing run.

use crate::fidelity::Timing;
use crate::machine::{Machine, RunError};
use crate::trace::{self, Recorder};
use cube3_abc::golden::{Local, Neighbourhood, ReflectedLight, Stages};
use cube3_cfb::golden::Skew;
use cube3_cfb::{FrameBuffer, FrameBufferError, Piece, scan};
use cube3_cone::golden::{Node, Segment, combine};
use cube3_cone::{place_of_circle, segments};
use cube3_definition::Definition;
use cube3_frame::{BeamPlace, DiscreteRay, FrameSetup, GradientScale, HalfSpace, Phong, RayPlace, Schedule, Shading};
use cube3_machine::{ConeOrder, MachineSpec, RaySlots};
use cube3_trilin::golden::lift;
use cube3_vectors::{ExpressionError, Set, Tables, Unit, UnitFormat, Vectors};
use std::ops::ControlFlow::{self, Break, Continue};

/// Most rays that share a slot of the unit `cone`.
const RAYS: usize = 3;

/// Cycles that are recorded of a timing run at a time.
const CYCLES: u64 = 4096;

/// A run: a machine, the frames that it renders one after another, and a volume of voxel words, x fastest.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// The machine.
    pub machine: &'a MachineSpec,
    /// The registers of its frames.
    pub frames: &'a [FrameSetup],
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Voxel words.
    pub voxels: &'a [u16],
}

/// Which part of the traffic.
#[derive(Clone, Copy, Debug)]
pub struct Window<'a> {
    /// The frame, from 0; of a picture in perspective, its passes are frames.
    pub frame: usize,
    /// The first transaction of the unit in that frame, from 0; of a channel the first cycle of the run.
    pub first: usize,
    /// How many at most.
    pub count: usize,
    /// The channel that is taken for the unit `channel`, by its name in traces.
    pub channel: &'a str,
}

/// Why there is no recording.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// A frame that is not there.
    #[error("the picture has {frames} frames, and frame {frame} was asked for, counted from 0")]
    Frame {
        /// Asked for.
        frame: usize,
        /// There.
        frames: usize,
    },
    /// A unit that does nothing in the frame.
    #[error("the unit {unit} carries nothing in this frame: {reason}")]
    Idle {
        /// The unit.
        unit: &'static str,
        /// Why not.
        reason: String,
    },
    /// A window behind the last transaction.
    #[error("the unit {unit} has {found} transactions in this frame, and the window starts at {first}, counted from 0")]
    Beyond {
        /// The unit.
        unit: &'static str,
        /// Transactions of the frame.
        found: usize,
        /// First one asked for.
        first: usize,
    },
    /// A channel that is never empty again.
    #[error(
        "the channel {channel} is not empty in any cycle from {first} on, and vectors of a channel begin with an empty one: start earlier"
    )]
    Held {
        /// The channel.
        channel: String,
        /// The first cycle asked for.
        first: usize,
    },
    /// No channel of that name.
    #[error("the machine has no channel \"{channel}\"; its channels are {names}")]
    Channel {
        /// The name.
        channel: String,
        /// Those that there are.
        names: String,
    },
    /// A value that the unit's sheet does not allow.
    #[error(
        "transaction {line} has {field} = {value}, and vectors of the unit {unit} hold {low} to {high} in this format: {remedy}"
    )]
    Value {
        /// The unit.
        unit: &'static str,
        /// Transaction of the recording, from 0.
        line: usize,
        /// The field.
        field: String,
        /// Its value.
        value: i128,
        /// The lowest.
        low: i128,
        /// The highest.
        high: i128,
        /// What to change.
        remedy: &'static str,
    },
    /// More opacity tables than the vectors of classification number.
    #[error(
        "vectors of the unit classify tell up to 16 opacity tables apart, and rays whose ends have parts of a step have more: set \
         rays.ends = \"published\" in the machine file"
    )]
    Ends,
    /// A sheet.
    #[error(transparent)]
    Expression(#[from] ExpressionError),
    /// The machine.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The frame buffer.
    #[error(transparent)]
    FrameBuffer(#[from] FrameBufferError),
}

/// The traffic of a unit in a run: the format is the machine's with what the frame's registers set, and tables are the frame's.
///
/// - `lerp` is the first along w of each TRILIN unit: of rays (u, v).
/// - From the gradient on, samples inside of every half-space; from the light on, those of them that are not transparent. `clip`
///   has a line for each half-space.
/// - `leaf` has a line for every depth of every slot, `node` one for each call of a node, in the order of the tree.
/// - `cone` has a line for each chunk of a slot, of a tree with as many leaves as the machine has lanes.
/// - `cfb` and `bus` are what beams are read and turned by, `dsb` where rays are read.
/// - `channel` begins at the first cycle of the window in which the channel is empty; data are the tokens' numbers modulo 2^16.
pub struct Recording<'a> {
    run: &'a Run<'a>,
    window: &'a Window<'a>,
    set: Set,
}

impl<'a> Recording<'a> {
    /// The recording of a unit, before its first line.
    ///
    /// # Errors
    /// A frame or channel that is not there, a unit that the frame does not use.
    pub fn new(run: &'a Run<'a>, unit: &dyn Unit, window: &'a Window<'a>) -> Result<Recording<'a>, RecordError> {
        let name = unit.sheet().name;
        let frames = run.frames.len();
        let setup = run.frames.get(window.frame).ok_or(RecordError::Frame { frame: window.frame, frames })?;
        if name == "classify" && setup.ends.is_some() {
            return Err(RecordError::Ends);
        }
        let mut format = format(run, setup, name);
        if name == "channel" {
            let (machine, place) = channel(run, window)?;
            let reading = machine.counters().channels[place];
            (format.capacity, format.latency) = (reading.capacity as u32, reading.latency as u32);
        } else if let Some(reason) = Frame::new(run, setup).idle(name) {
            return Err(RecordError::Idle { unit: name, reason });
        }
        let set = Set::with_tables(unit, format, 0, tables(setup, name, unit, &format))?;
        Ok(Recording { run, window, set })
    }

    /// What the lines have in common.
    pub fn set(&self) -> &Set {
        &self.set
    }

    /// Gives the input fields of each line of the window to `take`, in order.
    ///
    /// # Errors
    /// A window behind the last line, traffic that the unit's vectors cannot hold, and what `take` says.
    pub fn lines<E: From<RecordError>>(&self, take: &mut dyn FnMut(Vec<i128>) -> Result<(), E>) -> Result<(), E> {
        let Recording { run, window, set } = self;
        let name = set.sheet.name;
        let mut checked = |line: usize, inputs: Vec<i128>| {
            check(set, line, &inputs)?;
            take(inputs)
        };
        if name == "channel" {
            return cycles(run, window, &mut checked);
        }
        let frame = Frame::new(run, &run.frames[window.frame]);
        let mut failed = None;
        let mut lines = Lines {
            first: window.first,
            count: window.count,
            seen: 0,
            taken: 0,
            take: &mut |line, inputs| {
                let taken = checked(line, inputs);
                failed = taken.err();
                if failed.is_none() { Continue(()) } else { Break(()) }
            },
        };
        let _ = frame.traffic(name, &mut lines).map_err(RecordError::from)?;
        let (taken, seen) = (lines.taken, lines.seen);
        match failed {
            Some(error) => Err(error),
            None if taken == 0 && seen <= window.first && window.count > 0 => {
                Err(RecordError::Beyond { unit: name, found: seen, first: window.first }.into())
            }
            None => Ok(()),
        }
    }
}

/// The vectors of a unit from a run, in memory.
///
/// # Errors
/// Those of [`Recording`].
pub fn record(run: &Run<'_>, unit: &dyn Unit, window: &Window<'_>) -> Result<Vectors, RecordError> {
    let recording = Recording::new(run, unit, window)?;
    let mut inputs = Vec::new();
    recording.lines(&mut |line| {
        inputs.push(line);
        Ok::<(), RecordError>(())
    })?;
    Ok(Vectors::of(unit, recording.set, inputs))
}

/// Whether the unit's vectors hold a line.
fn check(set: &Set, line: usize, inputs: &[i128]) -> Result<(), RecordError> {
    for (field, &value) in set.fields[0].iter().zip(inputs) {
        let [low, high] = field.range;
        if !(low..=high).contains(&value) {
            let unit = set.sheet.name;
            let remedy = "take a smaller volume or another view";
            return Err(RecordError::Value { unit, line, field: field.name.clone(), value, low, high, remedy });
        }
    }
    Ok(())
}

/// The format of a unit in a frame.
fn format(run: &Run<'_>, setup: &FrameSetup, unit: &str) -> UnitFormat {
    let machine = run.machine;
    let mut format = UnitFormat { words: setup.words, ..UnitFormat::of(machine) };
    format.lanes = if unit == "cone" { setup.cone.leaves } else { machine.lanes } as u32;
    format.dims = run.dims.map(|n| n as u32);
    if let Some(scale) = setup.gradient.and_then(|registers| registers.scale) {
        format.kept_bits = scale.kept_bits;
    }
    if let Some(table) = &setup.normaliser {
        format.root_bits = table.root_bits;
    }
    match &setup.shading {
        Some(Shading::Phong(phong)) => {
            format.power_bits = phong.power_bits;
            format.lights = phong.lights.len().max(1) as u32;
        }
        Some(Shading::Table(table)) => format.reflectance_bits = table.bits,
        None => {}
    }
    format.rows = setup.classification.gradient_rows.map_or(1, |rows| rows.rows);
    format.classes = setup.rays.as_ref().map_or(1, |rays| rays.length_classes);
    format
}

/// The contents of a unit's tables in a frame.
fn tables(setup: &FrameSetup, name: &str, unit: &dyn Unit, format: &UnitFormat) -> Tables {
    let words = |table: &[u32]| table.iter().map(|&entry| entry.into()).collect::<Vec<i128>>();
    let packed = |table: &[[u32; 3]], bits: u32| {
        let pack = |entry: &[u32; 3]| (0..3).map(|i| i128::from(entry[i]) << (bits * i as u32)).sum();
        table.iter().map(pack).collect::<Vec<i128>>()
    };
    let colour_bits = setup.words.colour_bits;
    match (name, &setup.normaliser, &setup.shading) {
        ("normalise", Some(normaliser), _) => vec![words(&normaliser.root)],
        ("classify", ..) => {
            vec![words(&setup.classification.opacity), packed(&setup.classification.colour, colour_bits)]
        }
        ("phong", _, Some(Shading::Phong(phong))) => vec![words(&phong.power)],
        ("reflectance", _, Some(Shading::Table(table))) => {
            vec![packed(&table.diffuse, colour_bits + 4), packed(&table.specular, colour_bits + 4)]
        }
        _ => unit.tables(format),
    }
}

/// The lines of a window, as they go by.
struct Lines<'a> {
    first: usize,
    count: usize,
    /// Lines so far, those before the window included.
    seen: usize,
    /// Lines of the window so far.
    taken: usize,
    /// Takes a line of the window and its number there.
    take: &'a mut dyn FnMut(usize, Vec<i128>) -> ControlFlow<()>,
}

impl Lines<'_> {
    /// The next line; made only where it is in the window. Ends where the window does.
    fn add(&mut self, line: impl FnOnce() -> Vec<i128>) -> ControlFlow<()> {
        if self.taken == self.count {
            return Break(());
        }
        if self.seen >= self.first {
            (self.take)(self.taken, line())?;
            self.taken += 1;
        }
        self.seen += 1;
        if self.taken == self.count { Break(()) } else { Continue(()) }
    }
}

/// Fields of a line from words.
fn fields<T: Into<i128> + Copy>(line: &mut Vec<i128>, words: &[T]) {
    line.extend(words.iter().map(|&word| word.into()));
}

/// A frame of a run.
struct Frame<'a> {
    run: &'a Run<'a>,
    setup: &'a FrameSetup,
    definition: Definition<'a>,
}

impl<'a> Frame<'a> {
    fn new(run: &'a Run<'a>, setup: &'a FrameSetup) -> Frame<'a> {
        Frame { run, setup, definition: Definition::new(setup, run.voxels) }
    }

    /// Why the frame does not use a unit, where it does not.
    fn idle(&self, unit: &str) -> Option<String> {
        let setup = self.setup;
        let geometry = &setup.geometry;
        let parallel = geometry.perspective.is_none();
        match unit {
            gradient if gradient.starts_with("gradient-") => match &setup.gradient {
                None => Some("nothing reads a gradient; shade the picture".into()),
                Some(registers) if registers.method.row().unit != gradient => {
                    Some(format!("the machine's gradient is the unit {}", registers.method.row().unit))
                }
                Some(_) => None,
            },
            "normalise" if setup.normaliser.is_none() => Some("nothing reads a gradient's direction or length".into()),
            "phong" if !matches!(setup.shading, Some(Shading::Phong(_))) => {
                Some("it does not shade by Phong's formula".into())
            }
            "reflectance" if !matches!(setup.shading, Some(Shading::Table(_))) => {
                Some("it does not shade by a reflectance table".into())
            }
            "lit" if setup.shading.is_none() => Some("it is not shaded".into()),
            "cue" if setup.depth_cue.is_none() => Some("it has no depth cue".into()),
            "clip" if setup.clips.is_empty() => Some("it has no cut plane and no crop box".into()),
            "clip" if !parallel => {
                Some("in perspective half-spaces are evaluated at places, not by ray and depth".into())
            }
            "cone" if setup.cone.order != ConeOrder::Tree => Some("its cone is no tree".into()),
            "bus" if !(parallel && geometry.slots == RaySlots::Wrapped && geometry.size[0] == self.run.machine.lanes) => {
                Some("its beams are not turned as a whole; take a parallel view of a volume with as many voxels a side as the machine has lanes".into())
            }
            "bus" if !self.schedule().sections().is_whole() => {
                Some("its beams are turned section by section; leave rays.section out of the machine file".into())
            }
            _ => None,
        }
    }

    /// Sends the lines of a unit.
    fn traffic(&self, unit: &str, lines: &mut Lines<'_>) -> Result<ControlFlow<()>, FrameBufferError> {
        Ok(match unit {
            "cfb" => self.addresses(lines),
            "bus" => return self.turns(lines),
            "dsb" => self.places(self.schedule().rays().map(slot_of), |slot, depth, _| {
                lines.add(|| vec![slot as i128, depth as i128])
            }),
            "lerp" | "trilin" => self.places(self.schedule().finished_rays().map(slot_of), |_, k, ray| {
                if self.setup.geometry.has_sample(ray, k as i64) {
                    lines.add(|| self.interpolation(unit, ray, k))
                } else {
                    Continue(())
                }
            }),
            "leaf" => self.places(self.shaded_slots(), |_, k, ray| lines.add(|| self.leaf_line(ray, k))),
            "node" | "pixel" | "cone" => self.rays(unit, lines),
            _ => self.places(self.shaded_slots(), |_, k, ray| {
                if self.setup.geometry.has_sample(ray, k as i64) {
                    self.shading(unit, ray, k, lines)
                } else {
                    Continue(())
                }
            }),
        })
    }

    /// The slots, plane and number, of the ABC units and what follows them, whose rays wait for their neighbours, in order: the first comes last where the last slot is
    /// followed by the first.
    fn shaded_slots(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        self.setup.shading_order(&self.schedule()).shaded().map(|slot| slot.map(|i| i as usize))
    }

    fn schedule(&self) -> Schedule {
        Schedule::new(self.run.machine, &self.setup.geometry)
    }

    /// Every depth of these slots in order, each with its ray.
    fn places(
        &self,
        slots: impl Iterator<Item = [usize; 2]>,
        mut see: impl FnMut(usize, usize, DiscreteRay) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let geometry = &self.setup.geometry;
        for [plane, slot] in slots {
            for depth in 0..geometry.size[2] {
                see(slot, depth, geometry.ray_in_slot(plane, slot, depth))?;
            }
        }
        Continue(())
    }

    /// The voxels that are read, beam by beam.
    fn addresses(&self, lines: &mut Lines<'_>) -> ControlFlow<()> {
        let geometry = &self.setup.geometry;
        for (BeamPlace { plane, depth, .. }, Piece { row, columns }) in scan(geometry, &self.schedule()) {
            let below = if geometry.doubled() { geometry.row_below(plane as usize, depth as usize) } else { None };
            for v in [Some(row as usize), below].into_iter().flatten() {
                for u in columns.iter().cloned().flatten() {
                    let xyz = geometry.axes.voxel(geometry.size, [u, v, depth as usize]);
                    lines.add(|| xyz.map(|i| i as i128).to_vec())?;
                }
            }
        }
        Continue(())
    }

    /// The beams that are turned, rows and columns modulo the lanes.
    fn turns(&self, lines: &mut Lines<'_>) -> Result<ControlFlow<()>, FrameBufferError> {
        let (machine, geometry) = (self.run.machine, &self.setup.geometry);
        let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
        let buffer = FrameBuffer::with_layout(skew, machine.cfb.layout, self.run.dims, self.run.voxels)?;
        let mut beam = Vec::new();
        Ok(scan(geometry, &self.schedule()).try_for_each(|(BeamPlace { depth, .. }, Piece { row, .. })| {
            lines.add(|| {
                buffer.fetch(&geometry.axes, row as usize, depth as usize, &mut beam);
                let column = geometry.u.columns[depth as usize] as usize;
                let mut line = [row as usize, column].map(|i| (i % machine.lanes) as i128).to_vec();
                fields(&mut line, &beam);
                line
            })
        }))
    }

    fn interpolation(&self, unit: &str, ray: DiscreteRay, k: usize) -> Vec<i128> {
        let (geometry, words) = (&self.setup.geometry, &self.setup.words);
        let voxels = self.definition.corners(ray, k);
        if unit == "lerp" {
            let [near, far] = [0, 1].map(|w| i128::from(lift(voxels[w][0][0], words)));
            return vec![near, far, geometry.offset.into()];
        }
        let mut line = Vec::new();
        fields(&mut line, voxels.as_flattened().as_flattened());
        fields(&mut line, &[geometry.offset]);
        fields(&mut line, &geometry.weights(ray, k));
        line
    }

    /// The stages of shading that a sample goes through: adds the line of the unit asked for, where the sample gets to it.
    fn shading(&self, unit: &str, ray: DiscreteRay, k: usize, lines: &mut Lines<'_>) -> ControlFlow<()> {
        let at = [ray.u, ray.v, k as i64];
        if unit == "clip" {
            return self.setup.clips.iter().try_for_each(|HalfSpace { distance }| {
                let steps = [distance.u, distance.v, distance.k, distance.constant];
                lines.add(|| at.into_iter().chain(steps).map(i128::from).collect())
            });
        }
        let stages = self.definition.stages(ray, k as i64).filter(|stages| !stages.outside);
        let line = stages.and_then(|stages| self.stage_line(unit, &stages));
        line.map_or(Continue(()), |line| lines.add(|| line))
    }

    /// What a stage of shading is given.
    fn stage_line(&self, unit: &str, stages: &Stages) -> Option<Vec<i128>> {
        let lit = stages.classified.filter(|(opacity, _)| *opacity > 0);
        let mut line = Vec::new();
        match unit {
            "normalise" => fields(&mut line, &stages.gradient),
            "classify" => {
                let table = &self.setup.classification;
                let [low, high] = table.threshold;
                let shift = table.gradient_rows.map_or(0, |rows| rows.shift);
                line.push(stages.shaded.value.sample.into());
                fields(&mut line, &[stages.normal.magnitude, stages.class, low, high, shift]);
            }
            "phong" => {
                let (_, Some(Shading::Phong(phong))) = (lit?, &self.setup.shading) else { return None };
                line = phong_line(stages.normal.direction, phong, &stages.towards);
            }
            "reflectance" => {
                let (_, Some(Shading::Table(table))) = (lit?, &self.setup.shading) else { return None };
                fields(&mut line, &stages.gradient);
                fields(&mut line, &[table.flat]);
            }
            "lit" => line = lit_line(lit?.1, stages.light?),
            "cue" => {
                fields(&mut line, &stages.lit);
                fields(&mut line, &[stages.cue?]);
            }
            _ => {
                let (around, local) = stages.around.as_ref()?;
                line = gradient_line(around, local);
            }
        }
        Some(line)
    }

    fn leaf_line(&self, ray: DiscreteRay, k: usize) -> Vec<i128> {
        let (cone, shaded) = (&self.setup.cone, self.definition.shade(ray, k as i64).value);
        let mut line = vec![cone.mode.code().into(), cone.opaque.into()];
        if shaded.present {
            line.extend([1, shaded.sample.into(), shaded.opacity.into()]);
            fields(&mut line, &shaded.colour);
        } else {
            line.extend([0; 6]);
        }
        line
    }

    /// The slots through the cone: its nodes, what it is given, or its pixels.
    fn rays(&self, unit: &str, lines: &mut Lines<'_>) -> ControlFlow<()> {
        let setup = self.setup;
        let (cone, words, geometry) = (&setup.cone, &setup.words, &setup.geometry);
        let mode = cone.mode.code().into();
        for [plane, slot] in self.shaded_slots() {
            let at = |k: usize| self.definition.leaf(geometry.ray_in_slot(plane, slot, k), k as i64);
            if unit == "cone" {
                for chunk in (0..geometry.size[2]).step_by(cone.leaves) {
                    lines.add(|| self.circle_line([plane, slot, chunk], at))?;
                }
                continue;
            }
            let mut flow = Continue(());
            let rays = segments(setup, plane, slot, at, &mut |left, right| {
                if unit == "node" && flow.is_continue() {
                    flow = lines.add(|| {
                        let mut line = vec![mode];
                        node_fields(&mut line, &left);
                        node_fields(&mut line, &right);
                        line
                    });
                }
                combine(cone.mode, left, right, words)
            });
            flow?;
            if unit == "pixel" {
                for Segment { node, .. } in rays {
                    lines.add(|| {
                        let mut line = vec![mode, node.present.into()];
                        fields(&mut line, &node.rgba);
                        line.push(cone.sum_weight.into());
                        line
                    })?;
                }
            }
        }
        Continue(())
    }

    /// A chunk of a slot on the circle of leaves.
    fn circle_line(&self, place: [usize; 3], at: impl Fn(usize) -> Node) -> Vec<i128> {
        let (cone, geometry) = (&self.setup.cone, &self.setup.geometry);
        let [plane, slot, _] = place;
        let start = slot % cone.leaves;
        let segment = |k: usize| Segment { ray: geometry.ray_in_slot(plane, slot, k), node: at(k) };
        let leaves: Vec<Segment> =
            (0..cone.leaves).map(|leaf| place_of_circle(self.setup, place, leaf, segment)).collect();
        // Rays are numbered in order of depth: from the start leaf on.
        let mut rays: Vec<DiscreteRay> = (0..cone.leaves).map(|i| leaves[(start + i) % cone.leaves].ray).collect();
        rays.dedup();
        let number = |leaf: &Segment| rays.iter().position(|ray| *ray == leaf.ray).unwrap_or(RAYS) as i128;
        let mut line = vec![cone.mode.code().into(), start as i128];
        line.extend(leaves.iter().map(|leaf| i128::from(leaf.node.present)));
        line.extend(leaves.iter().map(|leaf| i128::from(leaf.node.sample)));
        leaves.iter().for_each(|leaf| fields(&mut line, &leaf.node.rgba));
        line.extend(leaves.iter().map(number));
        line
    }
}

/// The slot of a place, plane and number.
fn slot_of(RayPlace { plane, slot, .. }: RayPlace) -> [usize; 2] {
    [plane as usize, slot as usize]
}

fn node_fields(line: &mut Vec<i128>, node: &Node) {
    line.extend([i128::from(node.present), node.sample.into()]);
    fields(line, &node.rgba);
}

fn gradient_line(around: &Neighbourhood, local: &Local) -> Vec<i128> {
    let one = 1 << GradientScale::FACTOR_BITS;
    let mut line = Vec::new();
    fields(&mut line, around.as_flattened().as_flattened());
    for shears in [local.here, local.behind, local.before] {
        fields(&mut line, &shears);
    }
    fields(&mut line, &local.mirrored);
    fields(&mut line, &local.factors.unwrap_or([one; 3]));
    fields(&mut line, &[local.nearness.unwrap_or(one)]);
    line
}

/// A frame without lights has one that gives none.
fn phong_line(normal: [i32; 3], phong: &Phong, towards: &[[[i32; 3]; 2]]) -> Vec<i128> {
    let mut line = normal.map(i128::from).to_vec();
    line.extend([i128::from(phong.ambient), phong.two_sided.into()]);
    if phong.lights.is_empty() {
        line.extend([0; 12]);
    }
    towards.iter().for_each(|[direction, _]| fields(&mut line, direction));
    towards.iter().for_each(|[_, half]| fields(&mut line, half));
    phong.lights.iter().for_each(|light| fields(&mut line, &light.diffuse));
    phong.lights.iter().for_each(|light| fields(&mut line, &light.specular));
    line
}

fn lit_line(colour: [u32; 3], light: ReflectedLight) -> Vec<i128> {
    let mut line = colour.map(i128::from).to_vec();
    fields(&mut line, &light.diffuse);
    fields(&mut line, &light.specular);
    line
}

/// A timing run of all frames, and the place of the window's channel among its channels.
fn channel<'a>(run: &Run<'a>, window: &Window<'_>) -> Result<(Machine<Timing>, usize), RecordError> {
    let machine = Machine::timing(run.machine, run.frames.to_vec())?;
    let joints = Machine::<Timing>::JOINTS;
    let names = || joints.map(|joint| joint.channel).join(", ");
    let place = joints.iter().position(|joint| joint.channel == window.channel);
    let place = place.ok_or_else(|| RecordError::Channel { channel: window.channel.to_owned(), names: names() })?;
    Ok((machine, place))
}

/// The cycles of a channel in a timing run of all frames: gives each line and its number to `take`.
fn cycles<E: From<RecordError>>(
    run: &Run<'_>,
    window: &Window<'_>,
    take: &mut dyn FnMut(usize, Vec<i128>) -> Result<(), E>,
) -> Result<(), E> {
    let (mut machine, place) = channel(run, window)?;
    let stuck = |deadlock| RecordError::from(RunError::from(deadlock));
    let first = window.first as u64;
    machine.run_until(first, &|_, _| {}).map_err(stuck)?;
    if machine.now() < first {
        let found = machine.now() as usize;
        return Err(RecordError::Beyond { unit: "channel", found, first: window.first }.into());
    }
    let mut token = machine.counters().channels[place].counters.pushes;
    let mut empty = machine.counters().channels[place].occupancy == 0;
    let (mut lines, mut done) = (0, false);
    while !done && lines < window.count {
        let from = machine.now();
        let cycles = trace::Window { from, to: from + CYCLES };
        let mut recorder = Recorder::new(&machine, cycles, run.machine.clock_hz);
        done = recorder.run(&mut machine, cycles.to, &|_, _| {}).map_err(stuck)?;
        recorder.finish().replay(|events: &trace::Events| {
            let pushed = events.pushed[place].is_some();
            if (empty || lines > 0) && lines < window.count {
                let data = if pushed { i128::from(token & 0xffff) } else { 0 };
                take(lines, vec![pushed.into(), data, events.popped[place].is_some().into()])?;
                lines += 1;
            }
            token += u64::from(pushed);
            empty = events.occupancy[place] == 0;
            Ok::<(), E>(())
        })?;
    }
    if lines == 0 && window.count > 0 {
        return Err(RecordError::Held { channel: window.channel.to_owned(), first: window.first }.into());
    }
    Ok(())
}
