//! How much memory a command takes, told before it takes any.
//!
//! An estimate is a bound from above, made from the sizes that the inputs name: at most twice what is taken and 64 MB more. What does
//! not fit is refused in a line, before anything is read.

use crate::options::Runs;
use cube3_cfb::golden::{Placement, Skew};
use cube3_inputs::InputError;
use cube3_machine::{MachineSpec, RayEnds};
use cube3_scene::{Scene, VolumeSource};
use cube3_trace::{CycleWindow, TraceFormat};
use cube3_vectors::{ExpressionError, Unit, UnitFormat};
use cube3_volume::{
    FileInfo, Memory, MemoryBound, Phantom, PhantomParams, ReadOptions, Resampling, SampleType, VolumeError, inspect,
    memory_bounds, resample_bytes,
};
use std::path::Path;

/// The program, its tables and buffers.
const PROGRAM_BYTES: u64 = 36 << 20;
/// Address space that a thread reserves: its stack, and where it takes memory from.
const THREAD_BYTES: u64 = (2 << 20) + (64 << 20);
/// From this on the estimate is printed.
const TOLD_BYTES: u64 = 1_000_000_000;

/// Memory that a command is about to take.
#[derive(Clone, Debug)]
pub struct Need {
    what: String,
    parts: Vec<(&'static str, u64)>,
    threads: usize,
    remedy: &'static str,
}

impl Need {
    /// What needs it, on how many threads, and what helps where it does not fit.
    pub fn new(what: impl Into<String>, threads: usize, remedy: &'static str) -> Need {
        Need { what: what.into(), parts: vec![("program", PROGRAM_BYTES)], threads, remedy }
    }

    /// With a part more.
    #[must_use]
    pub fn with(mut self, part: &'static str, bytes: u64) -> Need {
        self.parts.push((part, bytes));
        self
    }

    /// Bytes in all.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().fold(0, |sum, (_, bytes)| sum.saturating_add(*bytes))
    }

    /// Refuses what does not fit.
    ///
    /// # Errors
    /// More than can be taken under one of the bounds.
    pub fn check(&self) -> Result<(), MemoryError> {
        let bytes = self.bytes();
        // Threads reserve more addresses than memory: those of the pool, and two beside it.
        let reserved = |bound: MemoryBound| match bound {
            MemoryBound::AddressSpace => THREAD_BYTES * (self.threads as u64 + 2),
            _ => 0,
        };
        let left = |memory: &Memory| i128::from(memory.bytes) - i128::from(reserved(memory.bound));
        let tightest = memory_bounds().into_iter().min_by_key(left);
        if let Some(memory) = tightest.filter(|memory| left(memory) < i128::from(bytes)) {
            let (part, most) = self.parts.iter().max_by_key(|(_, bytes)| *bytes).copied().unwrap_or_default();
            return Err(MemoryError {
                what: self.what.clone(),
                bytes,
                part,
                part_bytes: most,
                reserved_bytes: reserved(memory.bound),
                bound_bytes: memory.bytes,
                bound: memory.bound.to_string(),
                remedy: self.remedy,
            });
        }
        Ok(())
    }

    /// What to say of a need that is large.
    pub fn note(&self) -> Option<String> {
        let bytes = self.bytes();
        (bytes > TOLD_BYTES).then(|| format!("memory: about {}", amount(bytes)))
    }
}

/// More memory than there is.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what}: about {} of memory are needed ({part} {}{}), and {} are {bound}: {remedy}",
    amount(bytes.saturating_add(*reserved_bytes)), amount(*part_bytes), for_threads(*reserved_bytes), amount(*bound_bytes)
)]
pub struct MemoryError {
    /// What needs it.
    pub what: String,
    /// Bytes that are needed.
    pub bytes: u64,
    /// The largest part.
    pub part: &'static str,
    /// Its bytes.
    pub part_bytes: u64,
    /// Addresses that threads reserve, where these are bounded.
    pub reserved_bytes: u64,
    /// Bytes that can be taken.
    pub bound_bytes: u64,
    /// What bounds them, in words.
    pub bound: String,
    /// What helps.
    pub remedy: &'static str,
}

fn for_threads(bytes: u64) -> String {
    if bytes > 0 { format!(", {} for threads", amount(bytes)) } else { String::new() }
}

/// Bytes as a person reads them.
fn amount(bytes: u64) -> String {
    if bytes < TOLD_BYTES {
        format!("{} MB", bytes.div_ceil(1_000_000))
    } else {
        format!("{:.1} GB", bytes as f64 / 1e9)
    }
}

/// Threads that a command works on: as many as were asked for, else all cores.
pub fn threads(asked: Option<usize>) -> usize {
    let set = || std::env::var("RAYON_NUM_THREADS").ok()?.parse().ok().filter(|&threads| threads > 0);
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    asked.or_else(set).unwrap_or_else(cores)
}

/// The grid of a volume in memory, known before its voxels are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// Type of a sample.
    pub sample_type: SampleType,
}

impl Grid {
    /// The grid of a scene's volume; of a series that of the first.
    ///
    /// # Errors
    /// A header that cannot be read, a phantom that is not known.
    pub fn of_scene(source: &VolumeSource, options: &ReadOptions) -> Result<Grid, InputError> {
        if let Some(file) = source.file.as_deref().or(source.files.first().map(|file| file.as_path())) {
            return Grid::of_file(file, options);
        }
        let default = Scene::default().volume;
        let name = source.phantom.clone().or(default.phantom).unwrap_or_default();
        Grid::of_phantom(&name, source.size_voxels.or(default.size_voxels).unwrap_or(128))
    }

    /// The grid of a volume file, from its header.
    ///
    /// # Errors
    /// A header that cannot be read.
    pub fn of_file(path: &Path, options: &ReadOptions) -> Result<Grid, InputError> {
        Ok(Grid::of(&inspect(path, options)?))
    }

    /// The grid of a file that has been looked at.
    pub fn of(about: &FileInfo) -> Grid {
        Grid { dims: about.dims, sample_type: about.sample_type }
    }

    /// The grid of a phantom.
    ///
    /// # Errors
    /// A phantom that is not known.
    pub fn of_phantom(name: &str, size: usize) -> Result<Grid, InputError> {
        let one = name.parse::<Phantom>()?.generate(1, &PhantomParams::default())?;
        Ok(Grid { dims: [size; 3], sample_type: one.sample_type() })
    }

    fn voxels(&self) -> u64 {
        self.dims.iter().fold(1, |product, &n| product.saturating_mul(n as u64))
    }

    /// The samples.
    pub fn bytes(&self) -> u64 {
        self.voxels().saturating_mul(self.sample_type.bytes() as u64)
    }

    /// Two where an axis has one voxel: the machine has it twice.
    fn thickened(&self) -> Grid {
        Grid { dims: self.dims.map(|n| if n == 1 { 2 } else { n }), ..*self }
    }

    /// The square of the longest side: voxels of a face.
    fn face(&self) -> u64 {
        let side = self.dims.iter().map(|&n| n as u64).max().unwrap_or(0);
        side.saturating_mul(side)
    }
}

/// A run whose memory is asked for.
#[derive(Clone, Copy, Debug)]
pub struct Case<'a> {
    /// What is shown.
    pub scene: &'a Scene,
    /// The machine.
    pub machine: &'a MachineSpec,
    /// The volume as it comes in.
    pub grid: Grid,
    /// Which runs are made.
    pub runs: Runs,
    /// Whether the picture is measured against a reference.
    pub reference: bool,
    /// Whether voxels that are not finite may be there.
    pub mask: bool,
    /// Threads.
    pub threads: usize,
}

const RUN_REMEDY: &str =
    "lower image.width_px and image.height_px, take a smaller volume or fewer threads, or free memory";

impl Case<'_> {
    /// One frame.
    pub fn frame(&self) -> Need {
        let pixels = u64::from(self.scene.image.width_px) * u64::from(self.scene.image.height_px);
        // Reals of the picture, of another one for a note, of reference and difference; each as bytes, compressed, and in the page.
        let of_pixel = if self.reference { 128 } else { 80 };
        let pictures = if self.runs == Runs::Timing { 0 } else { of_pixel * pixels };
        self.machine_run(Need::new("the run", self.threads, RUN_REMEDY)).with("pictures", pictures)
    }

    /// Volume, machine and tables.
    fn machine_run(&self, need: Need) -> Need {
        let grid = self.grid.thickened();
        let (voxels, face) = (grid.voxels(), grid.face());
        let masked = if self.mask && grid.sample_type.is_float() { voxels.saturating_mul(8) } else { 0 };
        let thick = if grid == self.grid { 0 } else { self.grid.bytes() };
        let words = voxels.saturating_mul(2);
        let volume = grid.bytes().saturating_add(words).saturating_add(masked).saturating_add(thick);
        let turned = if matches!(self.runs, Runs::Function | Runs::Both) { words } else { 0 };
        let modules = if self.runs == Runs::Cycle { modules(self.machine, grid.dims) } else { 0 };
        // Overlap buffers are pairs of rays, with their lerps, and rows of samples: two of each for every plane.
        let overlap = if self.machine.rays.section.is_some() { 48 } else { 0 };
        let buffers =
            2 * (2 * (self.machine.dsb.planes as u64 + 1) + 24 + overlap) * u64::from(self.runs == Runs::Cycle);
        let bases = 250 * self.passes() + if self.reference { 300 } else { 0 };
        need.with("volume", volume)
            .with("turned volume", turned)
            .with("memory modules", modules)
            .with("buffers and base planes", face.saturating_mul(320 + buffers + bases))
            .with("planes of samples", (self.threads as u64).saturating_mul(self.planes().saturating_mul(face)))
            .with("tables", self.tables())
    }

    /// Frames of the machine for a picture at most: an eye in the volume sees to all sides.
    fn passes(&self) -> u64 {
        match &self.scene.view.perspective {
            None => 1,
            Some(perspective) if perspective.eye_voxel.is_none() && perspective.distance_voxel.is_none() => 3,
            Some(_) => 6,
        }
    }

    /// Bytes of a thread's planes for a voxel of a face: rows are up to twice a side, and near an eye neighbours up to the reach away. A
    /// reference on the machine's rays has reals, and the part of each sample of a plane.
    fn planes(&self) -> u64 {
        let passes = self.passes();
        let reach = if passes > 3 { u64::from(self.machine.abc.reach) } else { 1 };
        let of_run = match (self.runs, passes) {
            (Runs::Timing | Runs::Cycle, _) => 0,
            (_, ..=3) => 64,
            _ => 8 * (2 * reach + 3),
        };
        let of_reference = if self.reference && passes > 1 { 16 * (2 * reach + 1) + 32 } else { 0 };
        of_run.max(of_reference)
    }

    /// Tables of the registers of one picture, each up to four times: as set up, of the runs, and of the report.
    fn tables(&self) -> u64 {
        let words = &self.machine.words;
        let rows = if self.scene.transfer.is_two_dimensional() { words.table_gradient_bits } else { 0 };
        let perspective = self.scene.view.perspective.is_some();
        let classes = if perspective || self.machine.rays.ends == RayEnds::Exact { 16 } else { 1 };
        let entries = 1_u64 << (words.table_bits + rows);
        let reflectance = (6 * 24) << (2 * self.machine.abc.reflectance_bits);
        4 * (self.passes() * (4 * entries * classes + 16 * entries + reflectance) + (4 << self.machine.abc.root_bits))
    }

    /// A sequence of `frames`; `moves` where volumes come in, of which `kept` are kept.
    pub fn sequence(&self, frames: usize, moves: bool, kept: usize) -> Need {
        let frames = (frames as u64).saturating_mul(self.passes());
        let grid = self.grid.thickened();
        // Templates and other registers are less than 64 KiB.
        let registers = self.tables() / 4 + (1 << 16);
        let seen = if moves { 8 * grid.face() } else { 0 };
        let bases = if self.runs == Runs::Cycle { 64 * grid.face() + registers } else { 0 };
        let one = grid.bytes().saturating_add(grid.voxels().saturating_mul(2));
        let volumes = if moves { one.saturating_mul(kept as u64 + 1) } else { 0 };
        let second = if moves && self.runs == Runs::Cycle { modules(self.machine, grid.dims) } else { 0 };
        let mut need = self.frame().with("frames", frames.saturating_mul(registers + seen + bases));
        need = need.with("volumes kept", volumes).with("second buffer", second);
        Need { what: "the sequence".into(), remedy: "give fewer frames or a smaller volume, or free memory", ..need }
    }

    /// The study of word lengths: designs are measured on all threads at once.
    pub fn words_study(&self) -> Need {
        let pixels = u64::from(self.scene.image.width_px) * u64::from(self.scene.image.height_px);
        let designs = (self.threads as u64).saturating_mul(128 * pixels + 400 * self.grid.face());
        let ideals = 16 * 24 * pixels;
        let remedy = "take a smaller volume, a smaller picture or fewer threads, or free memory";
        self.machine_run(Need::new("the study of word lengths", self.threads, remedy))
            .with("words of a design", self.grid.voxels().saturating_mul(4))
            .with("pictures of designs", designs)
            .with("ideal pictures", ideals)
    }

    /// A trace of a window of cycles: the recording and the file's bytes.
    pub fn trace(&self, need: Need, format: TraceFormat, window: CycleWindow) -> Need {
        let cycles = window.to.saturating_sub(window.from);
        need.with("trace", cycles.saturating_mul(format.bytes_per_cycle() + 96))
    }

    /// A checkpoint of the run as it is made, and the bytes of one that it goes on from.
    pub fn checkpoint(&self, need: Need, made: bool, resumed: u64) -> Need {
        let modules = if self.runs == Runs::Cycle { modules(self.machine, self.grid.thickened().dims) } else { 0 };
        // A word is up to three bytes; the state is put together, and grows as it is.
        let state = modules.saturating_mul(5).saturating_add(self.grid.face().saturating_mul(512));
        need.with("checkpoint", if made { state } else { 0 }).with("checkpoint that is resumed", resumed)
    }

    /// A frame for the RTL pipeline: its texts, and the cycle run that gives its pixels.
    pub fn rtl_frame(&self) -> Need {
        let need = Need::new("the frame", self.threads, "take a smaller volume, or free memory");
        self.machine_run(need).with("texts", self.grid.voxels().saturating_mul(12))
    }

    /// The traffic of a unit in a run.
    pub fn recording(&self) -> Need {
        let need = Need::new("the recording", self.threads, "take a smaller volume, or free memory");
        self.machine_run(need).with("lines", BLOCK_BYTES)
    }
}

/// Words of the memory modules, with what is lost where sides are no multiples of the lanes.
fn modules(machine: &MachineSpec, dims: [usize; 3]) -> u64 {
    // So large a side is refused for its volume.
    if dims.iter().any(|&n| n > 1 << 20) {
        return u64::MAX;
    }
    let skew = Skew { coefficients: machine.cfb.skew, lanes: machine.lanes };
    let words = Placement { skew, layout: machine.cfb.layout, dims }.words() as u64;
    words.saturating_mul(2 * machine.lanes as u64)
}

/// A few lines of the widest unit, and what is found in them.
const BLOCK_BYTES: u64 = 40 << 20;

/// Vectors of a unit in a format; with its `lanes` beside the definition.
///
/// # Errors
/// An expression of the sheet without a value.
pub fn set(unit: &dyn Unit, format: &UnitFormat, lanes: bool) -> Result<Need, ExpressionError> {
    let sheet = unit.sheet();
    let mut entries = 0_u64;
    for table in &sheet.tables {
        entries = entries.saturating_add(u64::try_from(format.evaluate(table.entries)?).unwrap_or(u64::MAX));
    }
    let n = u64::from(format.lanes);
    let memory = match sheet.name {
        // Two planes of 8·LANES rays and depths; all modules.
        "dsb" if lanes => 4 * (8 * n) * (8 * n),
        "cfb" if lanes => {
            let skew = Skew { coefficients: format.skew, lanes: format.lanes as usize };
            let words = Placement { skew, layout: format.layout, dims: format.dims.map(|n| n as usize) }.words() as u64;
            // More is refused by the frame buffer itself.
            Some(words.saturating_mul(2 * n))
                .filter(|&bytes| u128::from(bytes) <= cube3_cfb::FrameBuffer::LIMIT_BYTES)
                .unwrap_or(0)
        }
        _ => 0,
    };
    let what = format!("the unit {}", sheet.name);
    Ok(Need::new(what, threads(None), "give shorter words, smaller tables or fewer lanes, or free memory")
        .with("lines", BLOCK_BYTES)
        .with("tables", entries.saturating_mul(40))
        .with("the unit's memory", memory))
}

/// The measurements of `cube3 bench`: bytes that are copied, voxels a side of the function and of the timing run.
pub fn bench(copied: u64, size: usize, timing_size: usize, threads: usize) -> Need {
    let [function, timing] = [size, timing_size].map(|n| n as u64);
    let cube = |n: u64| n.saturating_mul(n).saturating_mul(n);
    let function = cube(function)
        .saturating_mul(6)
        .saturating_add((512 + 64 * threads as u64) * function.saturating_mul(function));
    // Beams of a whole frame, each a cycle and its record, and the planes between the units.
    let beams = cube(timing) / 512 + 2 * timing.saturating_mul(timing);
    let timing = beams.saturating_mul(96).saturating_add(timing.saturating_mul(timing).saturating_mul(256));
    let remedy = "lower --size and --timing-size, or free memory";
    // One after another.
    let parts = [("copies", 2 * copied), ("function run", function), ("timing run", timing)];
    let (part, bytes) = parts.into_iter().max_by_key(|(_, bytes)| *bytes).unwrap_or_default();
    Need::new("the measurements", threads, remedy).with(part, bytes)
}

/// A volume that is read and brought to another grid.
///
/// # Errors
/// Distances and sizes that make no grid.
pub fn resampling(what: &str, about: &FileInfo, how: &Resampling) -> Result<Need, VolumeError> {
    let new = resample_bytes(about, how)?;
    Ok(volume(what, &Grid::of(about), false).with("the new grid", new))
}

/// A volume that is read or made, and with `words` turned into words.
pub fn volume(what: &str, grid: &Grid, words: bool) -> Need {
    let remedy = "take a smaller volume, or free memory";
    let need = Need::new(what, threads(None), remedy).with("volume", grid.bytes());
    need.with("words", if words { grid.voxels().saturating_mul(2) } else { 0 })
}
