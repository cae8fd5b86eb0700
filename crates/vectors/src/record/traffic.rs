//! Lines of the units of arithmetic and addressing in a frame.

use super::run::Run;
use cube3_abc::golden::{Local, Neighbourhood, ReflectedLight, Stages};
use cube3_cfb::golden::Skew;
use cube3_cfb::{FrameBuffer, FrameBufferError, Piece, scan};
use cube3_cone::golden::{Node, Segment, combine};
use cube3_cone::{place_of_circle, segments};
use cube3_definition::Definition;
use cube3_frame::{BeamPlace, DiscreteRay, FrameSetup, GradientScale, HalfSpace, Phong, RayPlace, Schedule, Shading};
use cube3_machine::{ConeOrder, RaySlots};
use cube3_trilin::golden::lift;
use std::ops::ControlFlow::{self, Break, Continue};

/// Most rays that share a slot of the unit `cone`.
const RAYS: usize = 3;

/// The lines of a window, as they go by.
pub(super) struct Lines<'a> {
    pub(super) first: usize,
    pub(super) count: usize,
    /// Lines so far, those before the window included.
    pub(super) seen: usize,
    /// Lines of the window so far.
    pub(super) taken: usize,
    /// Takes a line of the window and its number there.
    pub(super) take: &'a mut dyn FnMut(usize, Vec<i128>) -> ControlFlow<()>,
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
pub(super) struct Frame<'a> {
    run: &'a Run<'a>,
    setup: &'a FrameSetup,
    definition: Definition<'a>,
}

impl<'a> Frame<'a> {
    pub(super) fn new(run: &'a Run<'a>, setup: &'a FrameSetup) -> Frame<'a> {
        Frame { run, setup, definition: Definition::new(setup, run.voxels) }
    }

    /// Why the frame does not use a unit, where it does not.
    pub(super) fn idle(&self, unit: &str) -> Option<String> {
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
    pub(super) fn traffic(&self, unit: &str, lines: &mut Lines<'_>) -> Result<ControlFlow<()>, FrameBufferError> {
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
