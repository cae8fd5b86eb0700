//! Makes the `FrameSetup`: scene and machine in, registers and tables out.

use crate::golden::{self, Basis, StepLengths, gradient_scale, is_unity, neutral_cue, sum_weight, whole_step_opacity};
use crate::in_frame::{corrects_opacity, in_frame};
use crate::{OpacityEntries, VolumeInfo, canonical, classification, ends, shading};
use cube3_frame::{
    ConeRegisters, EndRegisters, FrameSetup, Geometry, GradientRegisters, HalfSpace, LARGEST_SIDE, Normaliser,
    RayRegisters, largest_offset, slope_register,
};
use cube3_machine::{BusKind, Differences, GradientMethod, MachineSpec, ShadingUnit, TemplateRule};
use cube3_plan::{Item, Needs, Plan, Presence, Rule, Rules};
use cube3_scene::{Scene, SceneError, ViewFrame};
use cube3_word::{quantise_fraction, quantise_unit};

/// Largest ratio of the sides of a voxel, and the range of a side.
pub const LARGEST_RATIO: f64 = 1e6;
/// Smallest and largest side of a voxel.
pub const SPACING_RANGE: [f64; 2] = [1e-100, 1e100];

/// Why a frame cannot be set up.
#[derive(Debug, thiserror::Error)]
pub enum HostError {
    /// The scene.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// Voxels too far from cubes, or too small or large to calculate with.
    #[error(
        "the voxel spacing {spacing:?} cannot be rendered: give sides from 1e-100 to 1e100, the longest at most 10^6 times the shortest"
    )]
    Spacing {
        /// Sides of a voxel.
        spacing: [f64; 3],
    },
    /// A bus that cannot do what the view needs.
    #[error(
        "a rotating bus cannot bring a perspective view to its lanes: set bus.kind = \"gather\" in the machine file, or make the view parallel"
    )]
    Bus,
    /// Sections of ray slots, which share no voxels in a parallel view alone.
    #[error(
        "rays.section = {section} cannot be used in perspective, where the rays of a section read voxels of others: leave rays.section out of the \
         machine file, or make the view parallel"
    )]
    Sections {
        /// Ray slots of a section.
        section: usize,
    },
    /// A volume side out of range.
    #[error(
        "the volume has {dims:?} voxels along x, y, z; the machine's templates take 1 to {LARGEST_SIDE} each: crop or resample it"
    )]
    Size {
        /// The sides.
        dims: [usize; 3],
    },
    /// A unit that holds something for one direction of all rays.
    #[error("{key} = \"{value}\" cannot be used in perspective: {reason}; give \"{remedy}\" in the machine file")]
    Perspective {
        /// Key in the machine file.
        key: &'static str,
        /// What it has.
        value: &'static str,
        /// Why not.
        reason: &'static str,
        /// What can be used.
        remedy: &'static str,
    },
    /// Tables of opacity that would take too much memory.
    #[error(
        "the opacity tables of a pass would have 2^{bits} entries (2^{table} samples, 2^{rows} gradients, 2^{classes} step lengths), above the \
         limit of 2^{MOST_TABLE_BITS}: lower words.table_bits or words.table_gradient_bits in the machine file, or set {remedy}"
    )]
    Tables {
        /// Bits of an address: the sum of the others.
        bits: u32,
        /// Bits that samples give.
        table: u32,
        /// Bits that gradients give.
        rows: u32,
        /// Bits that step lengths give.
        classes: u32,
        /// What does without them.
        remedy: &'static str,
    },
}

/// Most address bits of the opacity tables of a frame: 2^26 entries are 256 MiB, of which a picture has up to six.
const MOST_TABLE_BITS: u32 = 26;

/// Checks that the machine's bus can serve a view, perspective or parallel.
///
/// # Errors
/// Perspective on a bus that only turns beams.
pub fn check_bus(machine: &MachineSpec, perspective: bool) -> Result<(), HostError> {
    if perspective && machine.bus.kind == BusKind::Rotate { Err(HostError::Bus) } else { Ok(()) }
}

/// A frame as the host has set it up.
#[derive(Clone, Debug, PartialEq)]
pub struct ParallelFrame {
    /// The registers and tables.
    pub setup: FrameSetup,
    /// The picture's axes.
    pub view: ViewFrame,
    /// What the plan left out of the setup.
    pub left_out: Vec<Item>,
}

/// Sets up the frame of parallel rays along the view's direction; [`picture_setup`](crate::picture_setup) is for every view. With
/// the rules of the plan, what cannot change a bit of the picture is left out; without, gradient, normaliser, shading and depth cue run in
/// every frame, on registers that change nothing where the scene does not ask for them.
///
/// # Errors
/// A view without a direction, and volumes too large for the registers.
pub fn frame_setup(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    rules: impl Into<Rules>,
) -> Result<ParallelFrame, HostError> {
    let view = checked_view(scene, volume)?;
    check_ends(scene, machine)?;
    let geometry = geometry(scene, machine, volume, &view);
    let plan = Plan::new(scene, machine, rules.into());
    let setup = registers(scene, machine, volume, &plan, &view, geometry);
    let left_out = plan.items(machine, scene.lights.len(), std::slice::from_ref(&setup));
    Ok(ParallelFrame { setup, view, left_out })
}

/// The picture's axes, of a volume that the registers can take.
pub(crate) fn checked_view(scene: &Scene, volume: &VolumeInfo) -> Result<ViewFrame, HostError> {
    if volume.dims.iter().any(|side| !(1..=LARGEST_SIDE).contains(side)) {
        return Err(HostError::Size { dims: volume.dims });
    }
    let [shortest, longest] = [f64::min, f64::max].map(|pick| volume.spacing.into_iter().fold(volume.spacing[0], pick));
    if !(shortest >= SPACING_RANGE[0] && longest <= SPACING_RANGE[1] && longest <= shortest * LARGEST_RATIO) {
        return Err(HostError::Spacing { spacing: volume.spacing });
    }
    Ok(scene.view.frame()?)
}

/// What the machine cannot do for rays of many directions.
pub(crate) fn check_perspective(scene: &Scene, machine: &MachineSpec) -> Result<(), HostError> {
    check_bus(machine, true)?;
    if let Some(section) = machine.rays.section {
        return Err(HostError::Sections { section });
    }
    let needs = Needs::of(scene, machine);
    let gradient = machine.abc.gradient;
    if needs.gradient && gradient.row().needs_parallel_rays() {
        return Err(HostError::Perspective {
            key: "abc.gradient",
            value: gradient.name(),
            reason: "the feet of its perpendiculars differ for every sample",
            remedy: "12",
        });
    }
    if needs.light && machine.abc.shading == ShadingUnit::ReflectanceTable {
        return Err(HostError::Perspective {
            key: "abc.shading",
            value: "reflectance-table",
            reason: "the table holds the light for one direction to the eye",
            remedy: "phong",
        });
    }
    if corrects_opacity(scene) {
        check_tables(scene, machine, RayRegisters::MOST_CLASSES, "transfer.opacity_correction = false in the scene")?;
    }
    check_ends(scene, machine)
}

/// Checks that the opacity tables of a frame with parts of a step for the ends of its rays are not too large.
fn check_ends(scene: &Scene, machine: &MachineSpec) -> Result<(), HostError> {
    if !ends::has_ends(scene, machine) {
        return Ok(());
    }
    let classes = RayRegisters::MOST_CLASSES + EndRegisters::CLASSES;
    check_tables(scene, machine, classes, "rays.ends = \"published\" there")
}

/// Checks that two-dimensional opacity tables of so many `classes` of step lengths are not too large.
fn check_tables(scene: &Scene, machine: &MachineSpec, classes: u32, remedy: &'static str) -> Result<(), HostError> {
    let [table, rows] = [machine.words.table_bits, machine.words.table_gradient_bits];
    let classes = classes.next_power_of_two().ilog2();
    let bits = table + rows + classes;
    if scene.transfer.is_two_dimensional() && bits > MOST_TABLE_BITS {
        return Err(HostError::Tables { bits, table, rows, classes, remedy });
    }
    Ok(())
}

/// All registers and tables for a geometry, of the parts that the plan gives the frame.
pub(crate) fn registers(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    plan: &Plan,
    view: &ViewFrame,
    geometry: Geometry,
) -> FrameSetup {
    let machine = &*in_frame(machine, &geometry);
    let basis = Basis::new(&geometry, volume.spacing, machine.abc.gradient);
    let words = machine.words;
    let rows = classification::gradient_rows(scene, machine, volume, &basis);
    let gradient = plan.gradient.is_there().then(|| gradient_registers(machine, &geometry, &basis, plan.rules));
    let steps = StepLengths::new(corrects_opacity(scene), &geometry, volume.spacing);
    let rays = ray_registers(scene, volume, plan.needs, &geometry, &basis, machine.abc.gradient, &steps);
    let ends = ends::registers(scene, machine, &geometry, &steps.lengths);
    let whole = ends.as_ref().map(|_| whole_step_opacity(scene.mode, &words, geometry.bounding_planes()));
    let entries = OpacityEntries::new(scene, machine, volume, steps.lengths, rows, &basis);
    let cue = scene.depth_cue.as_ref().map(|cue| golden::depth_cue(cue, &geometry, volume.spacing, view));
    FrameSetup {
        schema: 1,
        words,
        reuse: machine.trilin.reuse,
        clips: clips(scene, machine, &geometry),
        classification: classification::tables(scene, machine, volume, &entries, rows, whole),
        gradient,
        normaliser: plan.normaliser.is_there().then(|| Normaliser::new(words.normal_bits, machine.abc.root_bits)),
        shading: match plan.shading {
            Presence::Needed => Some(shading::registers(scene, machine, view, &geometry, &basis)),
            Presence::Idle => Some(shading::neutral(machine)),
            Presence::Absent => None,
        },
        depth_cue: cue.or_else(|| plan.depth_cue.is_there().then(neutral_cue)),
        cone: ConeRegisters {
            mode: scene.mode,
            order: machine.cone.kind.order(),
            leaves: machine.lanes,
            opaque: quantise_unit(scene.transfer.opaque_alpha, words.opacity_bits).max(1),
            sum_weight: sum_weight(&words, &geometry, whole),
        },
        geometry,
        rays,
        ends,
    }
}

/// What differs from ray to ray, of an eye.
fn ray_registers(
    scene: &Scene,
    volume: &VolumeInfo,
    needs: Needs,
    geometry: &Geometry,
    basis: &Basis,
    method: GradientMethod,
    steps: &StepLengths,
) -> Option<RayRegisters> {
    let pass = geometry.perspective.as_ref()?;
    let s = geometry.axes.permute(volume.spacing);
    let along =
        |slopes: &[i64], s: f64| -> Vec<f64> { slopes.iter().map(|&slope| s * golden::real_slope(slope)).collect() };
    let [view_u, view_v] = [along(&pass.u.slopes, s[0]), along(&pass.v.slopes, s[1])];
    let largest = view_u.iter().chain(&view_v).fold(s[2], |most, x| most.max(x.abs()));
    let view = |x: f64| (x / largest * f64::from(1 << 28)).round() as i32;
    let slope =
        |slopes: &[i64]| -> Vec<u32> { slopes.iter().map(|&slope| RayRegisters::slope_register(slope)).collect() };
    let reach = |k: usize| pass.reach_at(k as i64, geometry.offset, geometry.weight_bits);
    let spacing = |k: usize| pass.neighbour_spacing(k as i64, geometry.offset, geometry.weight_bits);
    let depths = 0..geometry.size[2];
    let (scale, _) = basis.scale(method);
    Some(RayRegisters {
        view_w: view(s[2]),
        view_u: view_u.into_iter().map(view).collect(),
        view_v: view_v.into_iter().map(view).collect(),
        at_eye: if needs.light {
            scene.lights.iter().map(|light| light.direction.is_none()).collect()
        } else {
            Vec::new()
        },
        length_u: steps.along_u.clone(),
        length_v: steps.along_v.clone(),
        length_classes: steps.lengths.len() as u32,
        slope_u: slope(&pass.u.slopes),
        slope_v: slope(&pass.v.slopes),
        closeness: depths.clone().map(|k| RayRegisters::closeness_registers(spacing(k))[0]).collect(),
        factors: depths
            .clone()
            .map(|k| {
                let apart = spacing(k).max(1.0);
                [golden::factor(scale[0] / apart), golden::factor(scale[1] / apart), golden::factor(scale[2])]
            })
            .collect(),
        reach: pass.doubled.then(|| depths.clone().map(reach).collect()),
        nearness: pass.doubled.then(|| depths.map(|k| RayRegisters::closeness_registers(spacing(k))[1]).collect()),
    })
}

/// The half-spaces of cuts and crop box.
fn clips(scene: &Scene, machine: &MachineSpec, geometry: &Geometry) -> Vec<HalfSpace> {
    let whole_steps = scene.mode.adds_up() && !ends::has_ends(scene, machine);
    let cuts = scene.cuts.iter().map(|cut| golden::cut(geometry, cut, whole_steps));
    cuts.chain(scene.crop.iter().flat_map(|crop| golden::crop(geometry, crop, whole_steps))).collect()
}

/// The sample offset that is asked for, a fraction of the weight bits. Where the largest or smallest value counts it is 0: between two planes a
/// lerp only comes nearer to the mean, and halfway a single bright voxel is half as bright.
pub(crate) fn wanted_offset(scene: &Scene, machine: &MachineSpec) -> u32 {
    let offset = if scene.mode.chooses_a_value() { 0.0 } else { machine.rays.offset };
    quantise_fraction(offset, machine.words.weight_bits)
}

/// Where discrete rays take their column: label volumes have the rule of the nearest voxel, whatever the machine file says.
pub(crate) fn template_rule(scene: &Scene, machine: &MachineSpec) -> TemplateRule {
    if scene.volume.labels { TemplateRule::Nearest } else { machine.rays.template }
}

fn geometry(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo, view: &ViewFrame) -> Geometry {
    let canonical = canonical(view.direction, volume.spacing);
    let slopes = canonical.slopes.map(slope_register);
    let bits = machine.words.weight_bits;
    let rule = template_rule(scene, machine);
    let offset = wanted_offset(scene, machine).min(largest_offset(rule, slopes, bits));
    let size = canonical.axes.permute(volume.dims);
    Geometry::new(size, canonical.axes, slopes, offset, bits, rule, machine.rays.slots)
}

fn gradient_registers(machine: &MachineSpec, geometry: &Geometry, basis: &Basis, rules: Rules) -> GradientRegisters {
    let kept = !rules.follow(Rule::GradientScale);
    let method = machine.abc.gradient;
    let weights = match method.row().differences {
        Differences::Feet => basis.feet,
        _ => geometry.real_slopes(),
    };
    GradientRegisters {
        method,
        weights: weights.map(|weight| quantise_fraction(weight, machine.words.weight_bits)),
        scale: Some(gradient_scale(machine, basis)).filter(|scale| basis.varies || !is_unity(scale) || kept),
        border: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_frame::Axes;
    use cube3_machine::Bus;
    use cube3_scene::{Mode, smallest_spacing};
    use cube3_word::Words;

    #[test]
    fn opacity_tables_of_an_eye_have_a_limit() {
        let fits = |scene: &Scene, table_bits, table_gradient_bits| {
            let words = cube3_word::Words { table_bits, table_gradient_bits, ..Default::default() };
            check_perspective(scene, &MachineSpec { words, ..MachineSpec::default() }).is_ok()
        };
        let mut scene = Scene::default();
        scene.transfer.opacity_correction = true;
        assert!(fits(&scene, 16, 8), "one row");
        let layer = |gradient| cube3_scene::Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, 0.5]] };
        scene.transfer.layers = vec![layer(0.0), layer(50.0)];
        assert_eq!([6, 7].map(|rows| fits(&scene, 16, rows)), [true, false]);
        scene.transfer.opacity_correction = false;
        assert!(fits(&scene, 16, 8), "one step length");
    }

    #[test]
    fn tables_for_the_ends_of_rays_have_a_limit_too() {
        let volume = VolumeInfo { dims: [4; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
        let mut scene = Scene::default();
        let layer = |gradient| cube3_scene::Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, 0.5]] };
        scene.transfer.layers = vec![layer(0.0), layer(50.0)];
        scene.transfer.opacity_correction = false;
        let rays = cube3_machine::Rays { ends: cube3_machine::RayEnds::Exact, ..cube3_machine::Rays::default() };
        let of = |mode, table_gradient_bits| {
            let words = Words { table_gradient_bits, ..Words::default() };
            let machine = MachineSpec { words, rays, ..MachineSpec::default() };
            let scene = Scene { mode, ..scene.clone() };
            (frame_setup(&scene, &machine, &volume, true).map(|_| ()), check_perspective(&scene, &machine))
        };
        let (parallel, eye) = of(Mode::Composite, 7);
        assert!(parallel.unwrap_err().to_string().ends_with("or set rays.ends = \"published\" there"));
        assert!(eye.unwrap_err().to_string().contains("2^27 entries (2^12 samples, 2^7 gradients, 2^8 step lengths)"));
        assert!(of(Mode::Maximum, 8).0.is_ok(), "no ends");
        assert!(of(Mode::Composite, 6).1.is_ok());
    }

    /// A class is at most half of a fifteenth of the range away from a ray's squared step, and the shortest step is a class of its own.
    #[test]
    fn step_lengths_of_an_eye_are_within_their_classes() {
        let scene = Scene::default();
        for (eye, spacing) in [
            ([16.0, 16.0, 16.0], [1.0; 3]),
            ([3.3, 40.0, -20.0], [1.0; 3]),
            ([16.0, 16.0, -5.0], [1.0, 2.0, 0.5]),
            ([-9.0, 12.5, 4.2], [1.0, 1.0, 3.0]),
        ] {
            let shape = cube3_frame::PassShape {
                size: [33; 3],
                axes: Axes { axis: [0, 1, 2], reversed: [false; 3] },
                eye,
                offset: 0,
                weight_bits: 8,
                rule: TemplateRule::SampleFloor,
                grid: 0.5,
                reach: 1,
                joins: false,
            };
            let geometry = Geometry::perspective(&shape).unwrap();
            let steps = StepLengths::new(corrects_opacity(&scene), &geometry, spacing);
            let pass = geometry.perspective.as_ref().unwrap();
            let smallest = smallest_spacing(spacing);
            let squares: Vec<(f64, usize)> = (0..pass.u.count() * pass.v.count())
                .map(|i| {
                    let (column, row) = (i % pass.u.count(), i / pass.u.count());
                    let [u, v] = [pass.u.slopes[column], pass.v.slopes[row]].map(golden::real_slope);
                    let square = (spacing[0] * u).powi(2) + (spacing[1] * v).powi(2) + spacing[2].powi(2);
                    let class = (steps.along_u[column] + steps.along_v[row]) >> RayRegisters::CLASS_SHIFT;
                    (square / smallest.powi(2), class as usize)
                })
                .collect();
            let [shortest, longest] =
                [f64::min, f64::max].map(|pick| squares.iter().map(|x| x.0).fold(squares[0].0, pick));
            let half = (longest - shortest) / 30.0;
            let bound = (1.0 + half / shortest).sqrt() - 1.0;
            let mut worst = 0.0_f64;
            for &(square, class) in &squares {
                let of_class = steps.lengths[class].powi(2);
                assert!((of_class - square).abs() <= half * 1.001, "{square}: {of_class}");
                worst = worst.max((of_class / square).sqrt().max((square / of_class).sqrt()) - 1.0);
                assert!(square > shortest || (of_class - shortest).abs() < 1e-12);
            }
            assert!(worst <= bound * 1.001 && worst > 0.8 * bound, "{worst} of {bound}");
        }
    }

    #[test]
    fn sections_are_for_parallel_views() {
        let rays = cube3_machine::Rays { section: Some(8), ..cube3_machine::Rays::default() };
        let machine = MachineSpec { rays, ..MachineSpec::default() };
        let volume = VolumeInfo { dims: [16; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
        assert!(crate::picture_setup(&Scene::default(), &machine, &volume, true).is_ok());
        let mut scene = Scene::default();
        scene.view.perspective = Some(cube3_scene::Perspective::new(40.0));
        assert_eq!(
            crate::picture_setup(&scene, &machine, &volume, true).unwrap_err().to_string(),
            "rays.section = 8 cannot be used in perspective, where the rays of a section read voxels of others: leave rays.section out \
             of the machine file, or make the view parallel"
        );
    }

    #[test]
    fn a_bus_that_only_turns_beams_is_for_parallel_views() {
        let rotate = MachineSpec { bus: Bus { kind: BusKind::Rotate, ..Bus::default() }, ..MachineSpec::default() };
        assert!(check_bus(&rotate, false).is_ok());
        assert!(check_bus(&MachineSpec::default(), true).is_ok());
        let text = check_bus(&rotate, true).unwrap_err().to_string();
        assert_eq!(
            text,
            "a rotating bus cannot bring a perspective view to its lanes: set bus.kind = \"gather\" in the machine file, \
             or make the view parallel"
        );
    }
}
