//! Makes the `FrameSetup`: scene and machine in, registers and tables out.

use crate::{OpacityEntries, canonical, classification, ends, shading, whole_step_opacity};
use cube3_frame::{
    Axes, ConeRegisters, EndRegisters, FrameSetup, Geometry, GradientRegisters, GradientScale, HalfSpace, LARGEST_SIDE,
    Linear, LinearFactor, Normaliser, Perspective, RayRegisters, SLOPE_FRACTION_BITS, largest_offset, slope_register,
};
use cube3_machine::{Abc, BusKind, GradientMethod, MachineSpec, RaySlots, ShadingUnit, TemplateRule};
use cube3_scene::{Mode, Scene, SceneError, ViewFrame};
use cube3_word::{Words, quantise_fraction, quantise_unit, unit_full, unit_resize};
use std::borrow::Cow;

/// What the host needs to know of a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeInfo {
    /// Voxels along x, y, z: 1 to [`LARGEST_SIDE`] each.
    pub dims: [usize; 3],
    /// Size of a voxel along x, y, z.
    pub spacing: [f64; 3],
    /// Data values of voxel word 0 and of the largest word.
    pub window: [f64; 2],
}

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
pub struct Frame {
    /// The registers and tables.
    pub setup: FrameSetup,
    /// The picture's axes.
    pub view: ViewFrame,
    /// What the plan left out of the setup.
    pub left_out: Vec<LeftOut>,
}

/// Something that this scene does not need on this machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// The unit, table or buffer.
    pub what: String,
    /// Why it cannot change the picture.
    pub why: String,
    /// What that saves.
    pub saves: String,
}

/// Sets up the frame of parallel rays along the view's direction; [`picture_setup`](crate::picture_setup) is for every view. With
/// `plan`, what cannot change a bit of the picture is left out; without, gradient, normaliser, shading and depth cue run in every
/// frame, on registers that change nothing where the scene does not ask for them.
///
/// # Errors
/// A view without a direction, and volumes too large for the registers.
pub fn frame_setup(scene: &Scene, machine: &MachineSpec, volume: &VolumeInfo, plan: bool) -> Result<Frame, HostError> {
    let view = checked_view(scene, volume)?;
    check_ends(scene, machine)?;
    let geometry = geometry(scene, machine, volume, &view);
    let (setup, left_out) = registers(scene, machine, volume, plan, &view, geometry);
    Ok(Frame { setup, view, left_out })
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
    let (lit, rows) = (is_lit(scene), scene.transfer.is_two_dimensional());
    let gradient = machine.abc.gradient;
    if (lit || rows) && matches!(gradient, GradientMethod::Ten | GradientMethod::TenNormalised) {
        return Err(HostError::Perspective {
            key: "abc.gradient",
            value: gradient.name(),
            reason: "the feet of its perpendiculars differ for every sample",
            remedy: "12",
        });
    }
    if lit && machine.abc.shading == ShadingUnit::ReflectanceTable {
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

/// Whether opacities are corrected to the length of a step.
fn corrects_opacity(scene: &Scene) -> bool {
    scene.mode == Mode::Composite && scene.transfer.opacity_correction
}

/// Whether a scene's pixels are lit colours.
fn is_lit(scene: &Scene) -> bool {
    scene.material.shaded && lights_matter(scene.mode)
}

/// Whether pixels of a scene depend on gradients.
pub(crate) fn reads_gradients(scene: &Scene) -> bool {
    is_lit(scene) || scene.transfer.is_two_dimensional()
}

/// Rays that are no farther apart than this anywhere, in voxels, are near throughout.
const NEAR_SPACING: f64 = 2.0;

/// The machine as a frame uses it: where rays share columns, a ray moves by more than a ray from plane to plane, and the four samples of
/// estimator 12 are too near. Two multiplications do it: of 26d, whose nine differences for each component bear near samples best, or of
/// 6d where rays are also far apart, and sums over them would smooth too much.
pub(crate) fn in_frame<'a>(machine: &'a MachineSpec, geometry: &Geometry) -> Cow<'a, MachineSpec> {
    let Some(pass) = &geometry.perspective else {
        return Cow::Borrowed(machine);
    };
    let back = pass.spacing_at(geometry.size[2] as i64 - 1, geometry.offset, geometry.weight_bits);
    let gradient = match machine.abc.gradient {
        GradientMethod::Twelve if pass.doubled && back <= NEAR_SPACING => GradientMethod::TwentySixSheared,
        GradientMethod::Twelve if pass.doubled => GradientMethod::SixSheared,
        // Nothing reads the gradient, or it would have been refused.
        GradientMethod::Ten | GradientMethod::TenNormalised => GradientMethod::SixSheared,
        method => method,
    };
    Cow::Owned(MachineSpec { abc: Abc { gradient, ..machine.abc }, ..machine.clone() })
}

/// All registers and tables for a geometry, and what the plan left out.
pub(crate) fn registers(
    scene: &Scene,
    machine: &MachineSpec,
    volume: &VolumeInfo,
    plan: bool,
    view: &ViewFrame,
    geometry: Geometry,
) -> (FrameSetup, Vec<LeftOut>) {
    let machine = &*in_frame(machine, &geometry);
    let basis = Basis::new(&geometry, volume.spacing, machine.abc.gradient);
    let words = machine.words;
    let lit = is_lit(scene);
    let rows = classification::gradient_rows(scene, machine, volume, &basis);
    let mut left_out = Vec::new();
    let mut leave = |what: &str, why: &str, saves: String| {
        left_out.push(LeftOut { what: what.into(), why: why.into(), saves });
    };
    let gradient_needed = lit || rows.is_some();
    let gradient = (gradient_needed || !plan).then(|| gradient_registers(machine, &geometry, &basis, plan));
    if !gradient_needed && plan {
        let planes = machine.abc.planes * geometry.size[2] * geometry.slot_counts()[0];
        leave(
            "gradient unit",
            "nothing in this scene reads a gradient",
            format!("{planes} words of sample planes, a plane of fill"),
        );
    }
    if let Some(registers) = &gradient
        && plan
        && registers.scale.is_none()
    {
        let why = match registers.method {
            GradientMethod::Ten => "this estimator uses its differences as they are",
            _ => "the voxels are cubes and the differences are taken over equal lengths",
        };
        leave("gradient scale", why, "3 multipliers a lane".into());
    }
    if !lit && plan {
        leave("shading unit", "this mode or material uses colours as they are", "normaliser and lights".into());
    }
    if scene.depth_cue.is_none() && plan {
        leave("depth cueing", "the scene has none", "3 multipliers a lane".into());
    }
    if rows.is_none() && plan {
        leave(
            "gradient rows of the opacity table",
            "opacity depends on the value alone",
            format!("{} table entries", ((1 << words.table_gradient_bits) - 1) << words.table_bits),
        );
    }
    let normal_needed = rows.is_some() || (lit && machine.abc.shading == ShadingUnit::Phong);
    if gradient_needed && !normal_needed && plan {
        leave(
            "normaliser",
            "the reflectance table reads the direction alone",
            "6 multipliers a lane and the root table".into(),
        );
    }
    let clips = clips(scene, machine, &geometry);
    if clips.is_empty() && plan {
        leave("cut planes and crop box", "the scene has none", "12 comparators a lane".into());
    }
    if plan && !geometry.closes()[1] && geometry.slots == RaySlots::Wrapped {
        let words = geometry.size[0] * geometry.size[2];
        leave(
            "closing planes",
            "no slot is shared along v in this view",
            format!("{words} voxels and {} samples of buffer", 2 * words),
        );
    }
    let steps = StepLengths::new(scene, &geometry, volume.spacing);
    let rays = geometry
        .perspective
        .as_ref()
        .map(|pass| ray_registers(scene, volume, &geometry, pass, &basis, machine.abc.gradient, &steps));
    let ends = ends::registers(scene, machine, &geometry, &steps.lengths);
    let whole = ends.as_ref().map(|_| whole_step_opacity(scene.mode, &words, geometry.bounding_planes()));
    let entries = OpacityEntries::new(scene, machine, volume, steps.lengths, rows, &basis);
    let setup = FrameSetup {
        schema: 1,
        words,
        reuse: machine.trilin.reuse,
        clips,
        classification: classification::tables(scene, machine, volume, &entries, rows, whole),
        gradient,
        normaliser: (normal_needed || !plan).then(|| Normaliser::new(words.normal_bits, machine.abc.root_bits)),
        shading: if lit {
            Some(shading::registers(scene, machine, view, &geometry, &basis))
        } else {
            (!plan).then(|| shading::neutral(machine))
        },
        depth_cue: depth_cue(scene, &geometry, volume, view).or_else(|| (!plan).then(neutral_cue)),
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
    };
    (setup, left_out)
}

/// The weight of a weighted sum: one of the samples of a ray through all planes, or one step of those from the front face to the back one,
/// where opacity 1 over a `whole` step has a word of its own.
fn sum_weight(words: &Words, geometry: &Geometry, whole: Option<u32>) -> u64 {
    let one = 1_u64 << ConeRegisters::WEIGHT_BITS;
    let Some(whole) = whole else {
        return one / geometry.size[2] as u64;
    };
    let bits = words.accumulator_bits;
    let whole = unit_resize(whole, words.opacity_bits, bits).max(1);
    let steps = geometry.bounding_planes().saturating_sub(1).max(1) as u128;
    (u128::from(one) * u128::from(unit_full(bits)) / (u128::from(whole) * steps)).min(one.into()) as u64
}

/// Step lengths that opacity is corrected to, in units of the smallest spacing: one in a parallel frame, in perspective the
/// middles of classes, and the parts of the squared length that put a ray into its class.
pub(crate) struct StepLengths {
    pub lengths: Vec<f64>,
    along_u: Vec<u32>,
    along_v: Vec<u32>,
}

/// Squared lengths that differ by less, relative to the shortest, share one class: the opacity is then off by less than a 16-bit word.
const SAME_LENGTH: f64 = 1e-6;

impl StepLengths {
    pub(crate) fn new(scene: &Scene, geometry: &Geometry, spacing: [f64; 3]) -> StepLengths {
        let corrects = corrects_opacity(scene);
        let Some(pass) = &geometry.perspective else {
            let length = if corrects { step_length(geometry, spacing) } else { 1.0 };
            return StepLengths { lengths: vec![length], along_u: Vec::new(), along_v: Vec::new() };
        };
        let s = geometry.axes.permute(spacing);
        let squares = |slopes: &[i64], s: f64| -> Vec<f64> {
            slopes.iter().map(|&slope| (s * real_slope(slope)).powi(2)).collect()
        };
        let [along_u, along_v] = [squares(&pass.u.slopes, s[0]), squares(&pass.v.slopes, s[1])];
        let least = |squares: &[f64]| squares.iter().copied().fold(f64::INFINITY, f64::min);
        let most = |squares: &[f64]| squares.iter().copied().fold(0.0, f64::max);
        let [least_u, least_v] = [least(&along_u), least(&along_v)];
        let shortest = least_u + least_v + s[2].powi(2);
        let range = most(&along_u) - least_u + (most(&along_v) - least_v);
        let smallest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
        let classes = match corrects {
            true if range > shortest * SAME_LENGTH => RayRegisters::MOST_CLASSES,
            _ => 1,
        };
        // Classes from the shortest step to the longest; a ray is in the nearest. So the ray straight ahead has its own length.
        let lengths = (0..classes).map(|class| {
            let middle = f64::from(class) / f64::from((classes - 1).max(1));
            if corrects { (shortest + range * middle).sqrt() / smallest } else { 1.0 }
        });
        let top = f64::from((classes - 1) << RayRegisters::CLASS_SHIFT);
        let part = |squares: &[f64], least: f64, half: u32| -> Vec<u32> {
            let part =
                |square: &f64| if classes == 1 { 0 } else { ((square - least) / range * top).round() as u32 + half };
            squares.iter().map(part).collect()
        };
        let half = 1 << (RayRegisters::CLASS_SHIFT - 1);
        StepLengths {
            lengths: lengths.collect(),
            along_u: part(&along_u, least_u, half),
            along_v: part(&along_v, least_v, 0),
        }
    }
}

fn real_slope(register: i64) -> f64 {
    register as f64 / f64::from(1_u32 << SLOPE_FRACTION_BITS)
}

fn ray_registers(
    scene: &Scene,
    volume: &VolumeInfo,
    geometry: &Geometry,
    pass: &Perspective,
    basis: &Basis,
    method: GradientMethod,
    steps: &StepLengths,
) -> RayRegisters {
    let s = geometry.axes.permute(volume.spacing);
    let along = |slopes: &[i64], s: f64| -> Vec<f64> { slopes.iter().map(|&slope| s * real_slope(slope)).collect() };
    let [view_u, view_v] = [along(&pass.u.slopes, s[0]), along(&pass.v.slopes, s[1])];
    let largest = view_u.iter().chain(&view_v).fold(s[2], |most, x| most.max(x.abs()));
    let view = |x: f64| (x / largest * f64::from(1 << 28)).round() as i32;
    let slope =
        |slopes: &[i64]| -> Vec<u32> { slopes.iter().map(|&slope| RayRegisters::slope_register(slope)).collect() };
    let reach = |k: usize| pass.reach_at(k as i64, geometry.offset, geometry.weight_bits);
    let spacing = |k: usize| pass.neighbour_spacing(k as i64, geometry.offset, geometry.weight_bits);
    let depths = 0..geometry.size[2];
    let (scale, _) = basis.scale(method);
    let factor = |x: f64| quantise_fraction(x, GradientScale::FACTOR_BITS);
    RayRegisters {
        view_w: view(s[2]),
        view_u: view_u.into_iter().map(view).collect(),
        view_v: view_v.into_iter().map(view).collect(),
        at_eye: if is_lit(scene) {
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
                [factor(scale[0] / apart), factor(scale[1] / apart), factor(scale[2])]
            })
            .collect(),
        reach: pass.doubled.then(|| depths.clone().map(reach).collect()),
        nearness: pass.doubled.then(|| depths.map(|k| RayRegisters::closeness_registers(spacing(k))[1]).collect()),
    }
}

/// Modes whose pixel is a lit colour; the others show values.
fn lights_matter(mode: Mode) -> bool {
    matches!(mode, Mode::Composite | Mode::FirstOpaque | Mode::LastOpaque)
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

/// The frame that a gradient's components are in, treated as orthonormal by the shading unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Basis {
    /// Unit vectors of the components, in canonical world lengths.
    pub vectors: [[f64; 3]; 3],
    /// Length that half of each difference is taken over, in the unit of the spacing.
    pub lengths: [f64; 3],
    /// Along-ray parts of the feet of the perpendiculars from the side rays, 0 to 1 (method 10).
    pub feet: [f64; 2],
    /// Whether the factors of the components differ from depth to depth: in perspective.
    pub varies: bool,
}

impl Basis {
    /// The frame of an estimator for a geometry and voxel `spacing` (x, y, z).
    pub fn new(geometry: &Geometry, spacing: [f64; 3], method: GradientMethod) -> Basis {
        let s = geometry.axes.permute(spacing);
        let [du, dv] = geometry.real_slopes();
        let ray = [s[0] * du, s[1] * dv, s[2]];
        let square: f64 = ray.iter().map(|x| x * x).sum();
        let feet = [(s[0] * ray[0] / square).min(1.0), (s[1] * ray[1] / square).min(1.0)];
        let (vectors, lengths) = match method {
            GradientMethod::Ten | GradientMethod::TenNormalised => {
                let side = |axis: usize| {
                    let mut vector = ray.map(|x| -feet[axis] * x);
                    vector[axis] += s[axis];
                    vector
                };
                let vectors = [side(0), side(1), ray];
                let lengths = vectors.map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt());
                ([0, 1, 2].map(|i| vectors[i].map(|x| x / lengths[i])), lengths)
            }
            _ => ([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], s),
        };
        Basis { vectors, lengths, feet, varies: geometry.perspective.is_some() }
    }

    /// Factors that the components are multiplied with, the largest 1; and the length that the
    /// differences are then relative to.
    pub fn scale(&self, method: GradientMethod) -> ([f64; 3], f64) {
        let shortest = self.lengths.iter().copied().fold(f64::INFINITY, f64::min);
        if method == GradientMethod::Ten {
            return ([1.0; 3], shortest);
        }
        (self.lengths.map(|length| shortest / length), shortest)
    }

    /// A world vector in the frame's components.
    pub fn components(&self, axes: &Axes, world: glam::DVec3) -> [f64; 3] {
        let canonical = axes.to_canonical(world);
        self.vectors.map(|v| v[0] * canonical[0] + v[1] * canonical[1] + v[2] * canonical[2])
    }

    /// A gradient in the frame's components as a world vector.
    pub fn world(&self, axes: &Axes, components: [f64; 3]) -> glam::DVec3 {
        let canonical = [0, 1, 2].map(|i| (0..3).map(|j| components[j] * self.vectors[j][i]).sum());
        axes.to_world(canonical)
    }
}

fn gradient_registers(machine: &MachineSpec, geometry: &Geometry, basis: &Basis, plan: bool) -> GradientRegisters {
    let method = machine.abc.gradient;
    let weights = match method {
        GradientMethod::Ten | GradientMethod::TenNormalised => basis.feet,
        _ => geometry.real_slopes(),
    };
    GradientRegisters {
        method,
        weights: weights.map(|weight| quantise_fraction(weight, machine.words.weight_bits)),
        scale: Some(gradient_scale(machine, basis)).filter(|scale| basis.varies || !is_unity(scale) || !plan),
        border: 0,
    }
}

/// The factors of a frame, in perspective where rays are a voxel apart; where all are 1 at every depth, nothing is kept below
/// the gradient's word.
pub(crate) fn gradient_scale(machine: &MachineSpec, basis: &Basis) -> GradientScale {
    let method = machine.abc.gradient;
    let (factors, _) = basis.scale(method);
    let factors = factors.map(|factor| quantise_fraction(factor, GradientScale::FACTOR_BITS));
    let scale = GradientScale { factors, kept_bits: 0 };
    let kept_bits = GradientScale::FACTOR_BITS.min(GradientScale::room(method, &machine.words));
    if is_unity(&scale) && !basis.varies { scale } else { GradientScale { kept_bits, ..scale } }
}

fn is_unity(scale: &GradientScale) -> bool {
    scale.factors.iter().all(|&factor| factor == 1 << GradientScale::FACTOR_BITS)
}

/// A function `normal · p + constant` of the voxel position, over rays and depths, or over places in perspective.
pub(crate) fn linear(geometry: &Geometry, normal: [f64; 3], constant: f64, fraction_bits: u32) -> Linear {
    let one = (1_u64 << fraction_bits) as f64;
    let quantise = |x: f64, most: i64| (x * one).clamp(-(most as f64), most as f64).round() as i64;
    if geometry.perspective.is_some() {
        let [u, v, k] = normal.map(|x| quantise(x, Linear::STEEPEST_BY_PLACE));
        return Linear { u, v, k, constant: quantise(constant, Linear::FARTHEST) };
    }
    let [du, dv] = geometry.real_slopes();
    let along = normal[0] * du + normal[1] * dv + normal[2];
    Linear {
        u: quantise(normal[0], Linear::STEEPEST),
        v: quantise(normal[1], Linear::STEEPEST),
        k: quantise(along, Linear::STEEPEST),
        constant: quantise(constant + geometry.real_offset() * along, Linear::FARTHEST),
    }
}

/// `normal · (p − through)` of voxel positions x, y, z, in canonical coordinates: normal and constant.
fn canonical_plane(geometry: &Geometry, normal: [f64; 3], through: [f64; 3]) -> ([f64; 3], f64) {
    let mut constant = 0.0;
    let normal = [0, 1, 2].map(|i| {
        let axis = geometry.axes.axis[i];
        let last = (geometry.size[i] - 1) as f64;
        if geometry.axes.reversed[i] {
            constant += normal[axis] * (last - through[axis]);
            -normal[axis]
        } else {
            constant -= normal[axis] * through[axis];
            normal[axis]
        }
    });
    (normal, constant)
}

/// How far beside a face, in voxels, a sample counts as on it: more than the registers round by.
const ON_FACE: f64 = 1.0 / 65536.0;

/// The half-spaces of cuts and crop box.
///
/// Where samples stand for whole steps and are added up, a sample on a face through which the ray enters is kept, and one on a face through
/// which it leaves is not: its step lies behind. So between two faces there are as many samples at every offset.
fn clips(scene: &Scene, machine: &MachineSpec, geometry: &Geometry) -> Vec<HalfSpace> {
    let whole_steps = scene.mode.adds_up() && !ends::has_ends(scene, machine);
    let half_space = |outward: [f64; 3], through: [f64; 3]| {
        let (normal, constant) = canonical_plane(geometry, outward.map(|x| -x), through);
        let along = match &geometry.perspective {
            None => linear(geometry, normal, 0.0, HalfSpace::FRACTION_BITS).k,
            // A face across the rays alone is entered or left by all of them.
            Some(_) if normal[0] == 0.0 && normal[1] == 0.0 => normal[2].signum() as i64,
            Some(_) => 0,
        };
        let kept = if whole_steps { along.signum() as f64 * ON_FACE } else { 0.0 };
        HalfSpace { distance: linear(geometry, normal, constant + kept, HalfSpace::FRACTION_BITS) }
    };
    let mut clips = Vec::new();
    for cut in &scene.cuts {
        let largest = cut.normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        clips.push(half_space(cut.normal.map(|x| x / largest), cut.through_voxel));
    }
    if let Some(crop) = &scene.crop {
        for axis in 0..3 {
            let mut outward = [0.0; 3];
            outward[axis] = -1.0;
            clips.push(half_space(outward, crop.min_voxel));
            outward[axis] = 1.0;
            clips.push(half_space(outward, crop.max_voxel));
        }
    }
    clips
}

/// A factor of 1 everywhere.
fn neutral_cue() -> LinearFactor {
    LinearFactor { factor: Linear { u: 0, v: 0, k: 0, constant: 1 << LinearFactor::FRACTION_BITS } }
}

/// The cue along the view, from the nearest corner voxel, which is canonical (0, 0, 0) in a parallel view, to the farthest.
fn depth_cue(scene: &Scene, geometry: &Geometry, volume: &VolumeInfo, view: &ViewFrame) -> Option<LinearFactor> {
    let cue = scene.depth_cue.as_ref()?;
    let direction = geometry.axes.to_canonical(view.direction);
    let spacing = geometry.axes.permute(volume.spacing);
    let steps = [0, 1, 2].map(|i| direction[i] * spacing[i]);
    let reach = [0, 1, 2].map(|i| steps[i] * (geometry.size[i] - 1) as f64);
    let nearest: f64 = reach.iter().map(|x| x.min(0.0)).sum();
    let depth = reach.iter().map(|x| x.max(0.0)).sum::<f64>() - nearest;
    let rate = if depth > 0.0 { (cue.back - cue.front) / depth } else { 0.0 };
    let normal = steps.map(|step| step * rate);
    let at_origin = cue.front - nearest * rate;
    Some(LinearFactor { factor: linear(geometry, normal, at_origin, LinearFactor::FRACTION_BITS) })
}

/// Length of a ray's step in units of the smallest voxel spacing: what opacity is corrected to.
pub fn step_length(geometry: &Geometry, spacing: [f64; 3]) -> f64 {
    let s = geometry.axes.permute(spacing);
    let [du, dv] = geometry.real_slopes();
    let smallest = spacing.iter().copied().fold(f64::INFINITY, f64::min);
    let square = (s[0] * du).powi(2) + (s[1] * dv).powi(2) + s[2].powi(2);
    square.sqrt() / smallest
}

#[cfg(test)]
mod tests {
    use super::*;
    use cube3_machine::Bus;

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
            let steps = StepLengths::new(&scene, &geometry, spacing);
            let pass = geometry.perspective.as_ref().unwrap();
            let smallest = spacing.into_iter().fold(f64::INFINITY, f64::min);
            let squares: Vec<(f64, usize)> = (0..pass.u.count() * pass.v.count())
                .map(|i| {
                    let (column, row) = (i % pass.u.count(), i / pass.u.count());
                    let [u, v] = [pass.u.slopes[column], pass.v.slopes[row]].map(real_slope);
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
