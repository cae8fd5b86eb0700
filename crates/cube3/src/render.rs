//! Pictures by any method, and how far they are from one of them.

use crate::Outcome;
use cube3_inputs::LoadedVolume;
use cube3_machine::MachineSpec;
use cube3_method::{Choice, Subject};
use cube3_metrics::{ImageComparison, compare as compare_pictures, footprint};
use cube3_picture::{Rendering, Watch};
use cube3_scene::Scene;

/// One picture of a scene by a method; `machine` is what the methods of the machine run, and along whose rays its twin is.
///
/// # Errors
/// A scene that the method cannot show, and what the method refuses.
///
/// ```
/// use cube3::{Choice, Error, Machine, Scene, load, render};
/// use cube3_scene::{Mode, VolumeSource};
///
/// let volume = VolumeSource::from_phantom("sphere", 16);
/// let scene = Scene { volume, mode: Mode::Maximum, ..Scene::default() };
/// let machine = Machine::default();
/// let volume = load(&scene, &machine)?;
/// let choice: Choice = "image-order:0.25".parse()?;
/// let rendering = render(&choice, &scene, &machine, &volume)?;
/// println!("{} samples in {:.3} s", rendering.samples, rendering.seconds());
/// # assert!(rendering.samples > 0 && rendering.picture.pixels.iter().flatten().any(|&channel| channel > 0.5));
/// # Ok::<(), Error>(())
/// ```
pub fn render(choice: &Choice, scene: &Scene, machine: &MachineSpec, volume: &LoadedVolume) -> Outcome<Rendering> {
    let scene = scene.thickened(volume.single);
    Ok(choice.render(&Subject::new(&scene, machine, volume), &|_, _, _| {})?)
}

/// A method's picture beside a reference's.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// The method.
    pub choice: Choice,
    /// Its picture, and what it took.
    pub rendering: Rendering,
    /// How far it is from the reference, over the picture and over the object.
    pub error: ImageComparison,
}

/// Pictures of one scene by several methods, each measured against that of a `reference`; `watch` is told how far each is.
///
/// # Errors
/// A scene that one of the methods cannot show, and what a method refuses.
///
/// ```
/// use cube3::{Choice, Error, Machine, Scene, compare, load};
/// use cube3_scene::VolumeSource;
///
/// let scene = Scene { volume: VolumeSource::from_phantom("sphere", 16), ..Scene::default() };
/// let machine = Machine { lanes: 16, ..Machine::default() };
/// let volume = load(&scene, &machine)?;
/// let choices: Vec<Choice> = ["function", "sheared", "image-order:1"].map(|text| text.parse()).into_iter().collect::<Result<_, _>>()?;
/// let reference: Choice = "image-order:0.25".parse()?;
/// for compared in compare(&choices, &reference, &scene, &machine, &volume, &|_, _, _| {})? {
///     let error = compared.error.footprint.expect("the sphere is seen").mean_relative;
///     println!("{:<14} {:.3} s  {:.2} %", compared.choice.to_string(), compared.rendering.seconds(), 100.0 * error);
///     # assert!(error > 0.0 && error < 0.1);
/// }
/// # Ok::<(), Error>(())
/// ```
pub fn compare(
    choices: &[Choice],
    reference: &Choice,
    scene: &Scene,
    machine: &MachineSpec,
    volume: &LoadedVolume,
    watch: Watch<'_>,
) -> Outcome<Vec<Compared>> {
    let scene = scene.thickened(volume.single);
    let subject = Subject::new(&scene, machine, volume);
    for choice in choices.iter().chain([reference]) {
        choice.method.check(&scene)?;
    }
    let expected = reference.render(&subject, watch)?.picture;
    let measured = |choice: &Choice| {
        let rendering = choice.render(&subject, watch)?;
        let object = footprint(&rendering.picture, &expected, scene.background)?;
        let error = compare_pictures(&rendering.picture, &expected, Some(&object))?;
        Ok(Compared { choice: choice.clone(), rendering, error })
    };
    choices.iter().map(measured).collect()
}
