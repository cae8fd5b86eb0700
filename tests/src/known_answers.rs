//! Pictures with a closed form, and every way to make a picture: each answer is held against each method.
//!
//! All volumes are cubes of [`SIDE`] voxels of unit spacing, white over black, not lit. An answer is asked of the pixels whose rays enter
//! through the front face and leave through the back one, two voxels from the others, so that rays of the base plane beside them do so too.

use cube3_inputs::{LoadedVolume, to_words};
use cube3_machine::{MachineSpec, RayEnds, Rays, TemplateRule};
use cube3_method::{Choice, Method, RenderError, Subject};
use cube3_rendering::MethodError;
use cube3_scene::{ColourPoint, Cut, Image, ImagePlane, Mode, Perspective, Scene, View};
use cube3_volume::{Samples, Volume};
use cube3_word::Words;
use glam::DVec3;

/// Voxels along each axis.
pub const SIDE: usize = 25;
/// Steps from the front face to the back one.
const EXTENT: f64 = (SIDE - 1) as f64;
const MIDDLE: f64 = EXTENT / 2.0;
/// The data value of the largest word; opacities of [`thin`] scenes are values over this.
const TOP: f64 = 255.0;

/// A scene and a volume.
pub struct Question {
    /// The scene.
    pub scene: Scene,
    /// Voxel words of 16 bits, x fastest; data values are 0 to 255.
    pub words: Vec<u16>,
}

/// What a pixel is, 0 to 1.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// The closed form.
    pub value: f64,
    /// How far a method may be from it that steps in reals.
    pub steps: f64,
    /// How much farther one may be that has words.
    pub words: f64,
}

/// A ray from the front face to the back one, in voxels.
#[derive(Clone, Copy, Debug)]
pub struct Chord {
    /// Where it enters.
    pub enter: DVec3,
    /// Where it leaves.
    pub leave: DVec3,
    /// The eye's distance from the front face, infinite in a parallel view.
    pub eye: f64,
}

impl Chord {
    fn length(&self) -> f64 {
        (self.leave - self.enter).length()
    }

    /// From a plane of voxels to the next.
    fn step(&self) -> f64 {
        self.length() / EXTENT
    }

    /// How near it comes to the middle of the volume.
    fn miss(&self) -> f64 {
        (DVec3::splat(MIDDLE) - self.enter).cross((self.leave - self.enter) / self.length()).length()
    }
}

/// A picture with a closed form.
pub struct KnownAnswer {
    /// Its name.
    pub name: &'static str,
    /// The value of a voxel, 0 to 255.
    pub value: fn(DVec3) -> f64,
    /// The scene, but for its view.
    pub scene: fn() -> Scene,
    /// The views; the axis nearest to each is y, and it looks towards higher numbers.
    pub views: fn() -> Vec<View>,
    /// The closed form of a pixel; none where it is not that of its ray alone.
    pub answer: fn(&Chord) -> Option<Answer>,
}

/// Every picture with a closed form.
pub const ANSWERS: [KnownAnswer; 11] = [
    KnownAnswer { name: "fog", value: |_| TOP, scene: || fog(FOG), views: angles, answer: fog_answer },
    KnownAnswer { name: "fog from an eye", value: |_| TOP, scene: || fog(FOG), views: eyes, answer: fog_answer },
    KnownAnswer {
        name: "mean of fog",
        value: |_| TOP,
        scene: || thin(Mode::WeightedSum),
        views: all_views,
        answer: |_| mean(1.0, 0.0),
    },
    KnownAnswer {
        name: "slab across",
        value: slab_across,
        scene: || thin(Mode::WeightedSum),
        views: all_views,
        answer: slab_across_answer,
    },
    KnownAnswer {
        name: "slab along",
        value: slab_along,
        scene: || thin(Mode::WeightedSum),
        views: steep,
        answer: slab_along_answer,
    },
    KnownAnswer { name: "ramp", value: ramp, scene: || fog(FOG), views: angles, answer: ramp_answer },
    KnownAnswer {
        name: "mean of a field",
        value: linear,
        scene: || thin(Mode::WeightedSum),
        views: all_views,
        answer: mean_of_field,
    },
    KnownAnswer {
        name: "sphere",
        value: sphere,
        scene: || thin(Mode::WeightedSum),
        views: angles,
        answer: |chord| sphere_answer(chord, 1.0),
    },
    KnownAnswer {
        name: "half a sphere",
        value: sphere,
        scene: half,
        views: straight,
        answer: |chord| sphere_answer(chord, 0.5),
    },
    KnownAnswer {
        name: "maximum",
        value: linear,
        scene: || thin(Mode::Maximum),
        views: all_views,
        answer: |chord| extreme(chord, f64::max),
    },
    KnownAnswer {
        name: "minimum",
        value: linear,
        scene: || thin(Mode::Minimum),
        views: all_views,
        answer: |chord| extreme(chord, f64::min),
    },
];

/// Opacity of a voxel of fog.
const FOG: f64 = 0.04;
/// Half a word of opacity.
const WORD: f64 = 0.5 / 65535.0;
/// The ends of rays on the machine stand for whole parts of 1/32 of a step, each 1/64 off at most.
const ENDS: f64 = 2.0 / 64.0;

fn white(opacity: Vec<[f64; 2]>) -> Scene {
    let mut scene = Scene { background: [0.0; 3], ..Scene::default() };
    scene.material.shaded = false;
    scene.transfer.opacity = opacity;
    scene.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
    scene
}

/// Opacity in proportion to the value, `opacity` a voxel where that is the largest.
fn fog(opacity: f64) -> Scene {
    white(vec![[0.0, 0.0], [TOP, opacity]])
}

/// Opacity that is the value, from 0 to 1.
fn thin(mode: Mode) -> Scene {
    Scene { mode, ..fog(1.0) }
}

/// What is before the middle along y alone.
fn half() -> Scene {
    let cut = Cut { normal: [0.0, 1.0, 0.0], through_voxel: [MIDDLE; 3] };
    Scene { cuts: vec![cut], ..thin(Mode::WeightedSum) }
}

fn straight() -> Vec<View> {
    vec![View::from_angles(0.0, 0.0)]
}

/// Parallel views at several angles.
fn angles() -> Vec<View> {
    [[0.0, 0.0], [12.0, 0.0], [20.0, 5.0], [30.0, 17.0], [0.0, 25.0]]
        .map(|[yaw, tilt]| View::from_angles(yaw, tilt))
        .into()
}

fn steep() -> Vec<View> {
    [[20.0, 0.0], [30.0, 4.0]].map(|[yaw, tilt]| View::from_angles(yaw, tilt)).into()
}

/// From an eye in front of the volume.
fn eyes() -> Vec<View> {
    let eye = |place: [f64; 3], field| View {
        perspective: Some(Perspective { eye_voxel: Some(place), ..Perspective::new(field) }),
        ..View::from_angles(0.0, 0.0)
    };
    vec![eye([MIDDLE, -50.0, MIDDLE], 16.0), eye([MIDDLE + 3.0, -40.0, MIDDLE - 2.0], 14.0)]
}

fn all_views() -> Vec<View> {
    [angles(), eyes()].concat()
}

/// 1 − exp(−τ·L), τ = −ln(1 − α). In reals the samples of a ray stand for its length exactly; between rays of an eye, of which the length
/// is L = extent·√(1 + x²/D²), the warp is off by an eighth of the second derivative along each axis. A word of opacity is half a bit off for
/// each step. From an eye the squared length of a step is 1/30 of its range off, which is that of tan² over the field.
fn fog_answer(chord: &Chord) -> Option<Answer> {
    let density = -(-FOG).ln_1p();
    let left = (-density * chord.length()).exp();
    let bent = 2.0 / 8.0 * density * chord.length() / (chord.eye * chord.eye) * 4.0;
    let range = 2.0 * (MIDDLE / chord.eye).powi(2);
    let class = density * EXTENT * range / 30.0;
    Some(Answer {
        value: 1.0 - left,
        steps: left * bent + 1e-9,
        words: EXTENT * WORD + left * (density * chord.step() * ENDS + class),
    })
}

/// A weighted sum whose weights are parts of the extent: the mean along the ray. A word of opacity is an eighth of its range, as an end may
/// weigh four steps, and half of a bit off; of the largest value an end has all of its part.
fn mean(value: f64, steps: f64) -> Option<Answer> {
    Some(Answer { value, steps: steps + 1e-9, words: 8.0 * WORD + ENDS / EXTENT })
}

/// Five planes of voxels across the rays, 8 to 12.
fn slab_across(place: DVec3) -> f64 {
    if (8.0..=12.0).contains(&place.y) { TOP } else { 0.0 }
}

/// Between planes a slab is linear, so it is as thick as it has planes: 5 of the extent, at any angle. Samples a step apart add up to that
/// exactly; of half of that or less each of the four bends costs an eighth of the step squared.
fn slab_across_answer(_: &Chord) -> Option<Answer> {
    mean(5.0 / EXTENT, 4.0 * 0.25 / 8.0 / EXTENT)
}

/// Three planes of voxels along x, 11 to 13, which rays cross aslant.
fn slab_along(place: DVec3) -> f64 {
    if (11.0..=13.0).contains(&place.x) { TOP } else { 0.0 }
}

/// A ray that moves by s along x from plane to plane is in the slab for 3/s of the extent, if it crosses all of it; at each of the four
/// bends of slope s an eighth of the step squared is lost, and between rays as much again. The sheared cell is a parallelogram, along
/// which a bend is moved by up to half a voxel on either side: it keeps the sum over a whole slab.
fn slab_along_answer(chord: &Chord) -> Option<Answer> {
    let slope = (chord.leave.x - chord.enter.x).abs() / EXTENT;
    let (first, last) = (chord.enter.x.min(chord.leave.x), chord.enter.x.max(chord.leave.x));
    mean(3.0 / slope / EXTENT, slope / EXTENT).filter(|_| first < 8.0 && last > 16.0)
}

/// Linear along y, 0 to the largest.
fn ramp(place: DVec3) -> f64 {
    TOP * place.y / EXTENT
}

/// With τ(x) = −ln(1 − x·α), x from 0 to 1 along the ray, ∫τ = ((1 − α)·ln(1 − α) + α)/α, and the opacity is 1 − exp(−L·∫τ). The trapezoid rule
/// is off by a twelfth of the change of τ's slope, and the middles of steps by half of that; a voxel is a word.
fn ramp_answer(chord: &Chord) -> Option<Answer> {
    let through = 1.0 - FOG;
    let mean = (through * through.ln() + FOG) / FOG;
    let left = (-mean * chord.length()).exp();
    let slope = FOG / through / EXTENT;
    Some(Answer {
        value: 1.0 - left,
        steps: left * chord.step() * (slope * FOG / through / 12.0 + EXTENT * FOG * WORD),
        words: EXTENT * WORD + left * chord.step() * (ENDS * FOG / through),
    })
}

const RADIUS: f64 = 10.0;

/// 1 − r²/R² in a ball about the middle.
fn sphere(place: DVec3) -> f64 {
    TOP * (1.0 - (place - DVec3::splat(MIDDLE)).length_squared() / (RADIUS * RADIUS)).max(0.0)
}

/// Over a chord of half length c = √(R² − b²) the integral of 1 − r²/R² is 4/3·c³/R². Between voxels a function is an eighth of its second
/// derivative off along each edge of a cell, of which a sheared one has the squares 1, 1 and 3: 5/4 of 1/R² in all. Within √3 of the
/// surface there is a bend of slope 2/R as well, of which a quarter for each axis is lost. Between rays another 1/R along each axis is.
fn sphere_answer(chord: &Chord, part: f64) -> Option<Answer> {
    let half_chord = |radius: f64| (radius * radius - chord.miss() * chord.miss()).max(0.0).sqrt();
    let (inside, extent) = (half_chord(RADIUS), chord.length());
    let integral = part * 4.0 / 3.0 * inside.powi(3) / (RADIUS * RADIUS);
    let skin = 2.0 * (half_chord(RADIUS + 3_f64.sqrt()) - half_chord(RADIUS - 3_f64.sqrt()));
    let off = 2.0 * inside * 1.25 / (RADIUS * RADIUS) + skin * 3_f64.sqrt() / 2.0 / RADIUS + 1.0 / RADIUS;
    mean(integral / extent, off / extent)
}

/// Linear along all axes.
fn linear(place: DVec3) -> f64 {
    TOP / EXTENT * place.dot(DVec3::new(0.25, 0.5, 0.2))
}

/// A linear field has its extremes at the ends of a ray, and every cell gives it exactly, but for half a bit of a
/// voxel's word; a weight is 2^−9 off along each of two axes, and the table half an entry.
fn extreme(chord: &Chord, most: fn(f64, f64) -> f64) -> Option<Answer> {
    let value = most(linear(chord.enter), linear(chord.leave)) / TOP;
    Some(Answer { value, steps: WORD + 1e-9, words: 2.0 / 512.0 / EXTENT + 2.0 * WORD })
}

/// The mean of a linear field is that of its ends, whatever the steps, as each stands for a stretch about its sample; a word of a voxel is half a bit
/// off, and a weight 2^−9 along each of two axes.
fn mean_of_field(chord: &Chord) -> Option<Answer> {
    let value = f64::midpoint(linear(chord.enter), linear(chord.leave)) / TOP;
    let answer = mean(value, WORD)?;
    Some(Answer { words: answer.words + 2.0 / 512.0 / EXTENT, ..answer })
}

impl KnownAnswer {
    /// The question in each of its views.
    pub fn questions(&self) -> Vec<Question> {
        let place = |i: usize| DVec3::new((i % SIDE) as f64, (i / SIDE % SIDE) as f64, (i / SIDE / SIDE) as f64);
        let word = |i: usize| ((self.value)(place(i)) / TOP * 65535.0).round() as u16;
        let words: Vec<u16> = (0..SIDE.pow(3)).map(word).collect();
        let image = |view: &View| Image {
            width_px: 19,
            height_px: 15,
            pixel_size_voxel: view.perspective.is_none().then_some(1.0),
        };
        let scene = |view: View| Scene { image: image(&view), view, ..(self.scene)() };
        (self.views)().into_iter().map(|view| Question { scene: scene(view), words: words.clone() }).collect()
    }
}

impl Question {
    /// The volume: its words as data, which become the same words.
    fn volume(&self) -> LoadedVolume {
        let values = self.words.iter().map(|&word| f64::from(word) / 65535.0 * TOP).collect();
        let data = Volume::new([SIDE; 3], [1.0; 3], Samples::F64(values)).unwrap_or_else(|error| panic!("{error}"));
        let volume = to_words("a closed form".into(), data, Some([0.0, TOP]), &spec(), false);
        volume.unwrap_or_else(|error| panic!("{error}"))
    }

    /// The red of its picture by a method, row-major from the top left; none where the method cannot show it.
    pub fn picture(&self, method: &'static Method) -> Option<Vec<f64>> {
        let (volume, machine) = (self.volume(), spec());
        assert_eq!(volume.words.words, self.words);
        let mut choice = Choice::of(method);
        // A mode that does not add up takes every sample as it is.
        if method.about.options.iter().any(|option| option.name == "ends") && !self.scene.mode.adds_up() {
            let published = format!("{}:published", method.about.name);
            choice = published.parse().unwrap_or_else(|error| panic!("{error}"));
        }
        match choice.render(&Subject::new(&self.scene, &machine, &volume), &|_, _, _| {}) {
            Ok(rendering) => Some(rendering.picture.pixels.into_iter().map(|[red, _, _]| red).collect()),
            Err(RenderError::Method(MethodError::Lacks { .. })) => None,
            Err(error) => panic!("{}: {error}", method.about.name),
        }
    }

    /// The chord of each pixel of the picture, where its ray is two voxels from the other faces all the way.
    pub fn chords(&self) -> Vec<Option<Chord>> {
        let view = self.scene.view.frame().unwrap_or_else(|error| panic!("{error}"));
        let plane = ImagePlane::new(&self.scene, &view, [SIDE; 3], [1.0; 3]);
        let pixels = (0..plane.height).flat_map(|row| (0..plane.width).map(move |column| [column, row]));
        let chord = |[column, row]: [usize; 2]| {
            let (origin, along) = plane.ray(column as f64, row as f64);
            let at = |y: f64| origin + along * ((y - origin.y) / along.y);
            let chord = Chord { enter: at(0.0), leave: at(EXTENT), eye: plane.eye.map_or(f64::INFINITY, |eye| -eye.y) };
            let inside = |place: DVec3| [place.x, place.z].iter().all(|x| (2.0..=EXTENT - 2.0).contains(x));
            (inside(chord.enter) && inside(chord.leave)).then_some(chord)
        };
        pixels.map(chord).collect()
    }
}

/// A machine of words in which opacity's does not show, ends of their own length, and samples in the middle of steps.
fn spec() -> MachineSpec {
    let words = Words { opacity_bits: 16, table_bits: 16, ..Words::default() };
    let rays = Rays { template: TemplateRule::PlaneFloor, ends: RayEnds::Exact, ..Rays::default() };
    MachineSpec { lanes: 5, words, rays, ..MachineSpec::default() }
}
