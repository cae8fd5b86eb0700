//! The table of methods: each row is the code behind it, and a method that is added needs nothing else.

use cube3_frame::{BasePlane, FrameSetup, Geometry};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{PictureFrames, picture_setup, warp_passes};
use cube3_inputs::{LoadedVolume, load_volume};
use cube3_machine::MachineSpec;
use cube3_method::{
    CONVERGED, Choice, FUNCTION, IMAGE_ORDER, METHODS, Method, RenderError, SHEARED, Subject, TRUE, names, own_error,
};
use cube3_picture::{Phase, Picture, Rendering, Watch};
use cube3_pipeline::Machine;
use cube3_reference::{ImageOrderOptions, image_order};
use cube3_rendering::{About, Feature, MethodError, MethodOption, OptionKind, SceneMethod, SceneSubject, Settings};
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, Image, Layer, Light, Mode, Perspective, Scene, Threshold, View, VolumeSource,
};
use cube3_twin::{BaseRendering, DiscreteOptions, SampleCell, discrete};
use cube3_volume::ReadOptions;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};

const SIDE: usize = 14;

fn scene() -> Scene {
    let image = Image { width_px: 32, height_px: 28, pixel_size_voxel: Some(0.5) };
    let view = View { yaw_deg: 25.0, tilt_deg: 8.0, ..View::default() };
    Scene { volume: VolumeSource::from_phantom("head", SIDE), image, view, ..Scene::default() }
}

fn machine() -> MachineSpec {
    MachineSpec { lanes: SIDE, ..MachineSpec::default() }
}

fn load(scene: &Scene) -> LoadedVolume {
    load_volume(scene, &machine(), &ReadOptions::default(), false).unwrap()
}

fn of_text(text: &str, scene: &Scene) -> Rendering {
    let choice: Choice = text.parse().unwrap();
    choice.render(&Subject::new(scene, &machine(), &load(scene)), &|_, _, _| {}).unwrap()
}

fn warped(frames: &PictureFrames, bases: &[BasePlane], background: [f64; 3]) -> Vec<[f64; 3]> {
    let geometries = frames.setups.iter().map(|setup| &setup.geometry);
    let passes: Vec<(&BasePlane, &Geometry)> = bases.iter().zip(geometries).collect();
    warp_passes(&passes, &frames.plane, [1.0; 3], background)
}

/// Rows of the machine and of its twin, and image order: each picture is that of the code behind it, to the bit.
#[test]
fn each_row_is_the_code_behind_it() {
    let scene = scene();
    let (machine, volume) = (machine(), load(&scene));
    let words = &volume.words;
    let frames = picture_setup(&scene, &machine, &volume.info(), true).unwrap();
    let geometry = &frames.setups[0].geometry;

    let base = |turned: &CanonicalVolume<'_>| render(&frames.setups[0], turned, true, &|_, _| {}).base;
    let function = base(&CanonicalVolume::new(&geometry.axes, words.dims, &words.words));
    let mut clocked = Machine::cycle(&machine, frames.setups.clone(), words.dims, &words.words).unwrap();
    clocked.run(&|_, _| {}).unwrap();
    for (name, bases) in [("function", vec![function]), ("cycle", clocked.into_base_planes())] {
        let rendering = of_text(name, &scene);
        assert_eq!(rendering.picture.pixels, warped(&frames, &bases, scene.background), "{name}");
        assert_eq!(rendering.samples, geometry.sample_count());
    }

    let border = words.window[0];
    for (name, interpolation, whole_steps) in [
        ("sheared", SampleCell::Sheared, false),
        ("true", SampleCell::Exact, false),
        ("true:published", SampleCell::Exact, true),
    ] {
        let options = DiscreteOptions { gradient: machine.abc.gradient, border, whole_steps };
        let base = discrete(&volume.data, &scene, geometry, interpolation, &options, None).unwrap();
        let expected = base.warp(geometry, &frames.plane, volume.data.spacing, scene.background);
        let rendering = of_text(name, &scene);
        assert_eq!((rendering.picture.pixels, rendering.samples), (expected, base.samples), "{name}");
    }

    for (name, step_voxel) in [("image-order", 0.5), ("image-order:0.25", 0.25)] {
        let options = ImageOrderOptions { step_voxel, border, ..ImageOrderOptions::default() };
        let expected = image_order(&volume.data, &scene, &options, None).unwrap();
        let rendering = of_text(name, &scene);
        assert_eq!((rendering.picture, rendering.samples), (expected.picture, expected.samples), "{name}");
        assert_eq!(rendering.bytes, volume.data.bytes());
    }
}

/// Phases have names and times, and each is watched to its end.
#[test]
fn phases_are_timed_and_watched() {
    let parallel = scene();
    let eye = Perspective { eye_voxel: Some([-9.0, -10.0, 7.0]), ..Perspective::new(100.0) };
    let view = View { perspective: Some(eye), ..View::from_angles(-40.0, 10.0) };
    let from_eye =
        Scene { view, image: Image { pixel_size_voxel: None, ..parallel.image.clone() }, ..parallel.clone() };
    for (scene, &method) in [&parallel, &from_eye].into_iter().flat_map(|scene| METHODS.iter().map(move |m| (scene, m)))
    {
        let (machine, volume) = (machine(), load(scene));
        let seen = Mutex::new(Vec::new());
        let watch: Watch<'_> = &|what, done, all| seen.lock().unwrap().push((what, done, all));
        let rendering = Choice::of(method).render(&Subject::new(scene, &machine, &volume), watch).unwrap();
        let name = method.about.name;
        assert!(rendering.phases.iter().all(|phase| phase.seconds >= 0.0 && !phase.name.is_empty()), "{name}");
        let sum: f64 = rendering.phases.iter().map(|phase| phase.seconds).sum();
        assert_eq!(rendering.seconds(), sum);
        let seen = seen.into_inner().unwrap();
        let ends = |&&(what, done, all): &&(&str, u64, u64)| {
            done == all && rendering.phases.iter().any(|phase| phase.name == what)
        };
        assert!(seen.iter().any(|call| ends(&call)), "{name}: {seen:?}");
        assert!(rendering.bytes >= SIDE.pow(3) as u64, "{name}");
    }
}

#[test]
fn a_choice_is_a_name_and_what_stands_behind_colons() {
    for text in
        ["function", "cycle", "sheared", "true", "image-order", "image-order:0.25", "image-order:1", "true:published"]
    {
        assert_eq!(text.parse::<Choice>().unwrap().to_string(), text);
    }
    // What is as without it is not said.
    assert_eq!("image-order:0.5".parse::<Choice>().unwrap().to_string(), "image-order");
    assert_eq!("sheared:exact".parse::<Choice>().unwrap(), Choice::of(&SHEARED));
    let refused = |text: &str| text.parse::<Choice>().unwrap_err().to_string();
    assert_eq!(
        refused("image"),
        "there is no method image: did you mean image-order?; known are function, cycle, sheared, true, image-order, converged"
    );
    assert_eq!(refused("?"), "there is no method ?; known are function, cycle, sheared, true, image-order, converged");
    for step in ["0", "", "inf", "nan", "1000", "-1", "published"] {
        assert_eq!(
            refused(&format!("image-order:{step}")),
            format!("'{step}' is no option of the method image-order; give step: 0.002 to 8 voxels, 0.5 without it")
        );
    }
    assert_eq!(
        refused("true:0.5"),
        "'0.5' is no option of the method true; give ends: exact or published, exact without it"
    );
    assert_eq!(refused("function:1"), "'1' is no option of the method function; it has none");
}

/// What each feature is asked for by; a plain scene asks for a mode alone.
fn asking(feature: Feature) -> Scene {
    let mut plain = Scene { lights: Vec::new(), ..Scene::default() };
    plain.material.shaded = false;
    plain.transfer.colour = vec![ColourPoint { value: 0.0, rgb: [1.0; 3] }];
    let view = View { perspective: Some(Perspective::new(40.0)), ..View::default() };
    match feature {
        Feature::Perspective => plain.view = view,
        Feature::Mode(mode) => plain.mode = mode,
        Feature::Shading => plain.material.shaded = true,
        Feature::Lights => {
            plain.material.shaded = true;
            plain.lights = vec![Light { direction: Some([0.0, 0.0, 1.0]), colour: [1.0; 3] }];
        }
        Feature::Colour => plain.transfer.colour.push(ColourPoint { value: 9.0, rgb: [1.0, 0.0, 0.0] }),
        Feature::GradientOpacity => {
            let layer = |gradient| Layer { gradient, opacity: vec![[0.0, 0.0], [255.0, 0.5]] };
            plain.transfer.layers = vec![layer(0.0), layer(20.0)];
        }
        Feature::Labels => plain.volume.labels = true,
        Feature::Crop => plain.crop = Some(Crop { min_voxel: [0.0; 3], max_voxel: [3.0; 3] }),
        Feature::Cuts => plain.cuts = vec![Cut { normal: [1.0, 0.0, 0.0], through_voxel: [3.0; 3] }],
        Feature::Threshold => plain.threshold = Some(Threshold { low: Some(1.0), high: None }),
        Feature::DepthCue => plain.depth_cue = Some(DepthCue { front: 1.0, back: 0.5 }),
    }
    plain
}

#[test]
fn every_feature_is_asked_for_by_its_scene_and_no_other() {
    for feature in Feature::ALL {
        let scene = asking(feature);
        let needed: Vec<Feature> = Feature::needed_by(&scene).collect();
        let mut expected: Vec<Feature> = vec![Feature::Mode(scene.mode), feature];
        if feature == Feature::Lights {
            expected.push(Feature::Shading);
        }
        let set = |features: &[Feature]| features.iter().map(|feature| feature.name()).collect::<BTreeSet<_>>();
        assert_eq!(set(&needed), set(&expected), "{}", feature.name());
    }
    assert_eq!(Feature::ALL.map(Feature::name).into_iter().collect::<BTreeSet<_>>().len(), Feature::ALL.len());
}

#[test]
fn a_scene_that_a_method_cannot_show_is_refused_with_what_it_lacks_and_who_can() {
    let scene = asking(Feature::Mode(Mode::Maximum));
    for (method, able) in [(&CONVERGED, false), (&SHEARED, true), (&FUNCTION, true), (&IMAGE_ORDER, true)] {
        assert_eq!(method.check(&scene).is_ok(), able, "{}", method.about.name);
    }
    let volume = load(&Scene { volume: VolumeSource::from_phantom("sphere", 8), ..Scene::default() });
    let refused = Choice::of(&CONVERGED).render(&Subject::new(&scene, &machine(), &volume), &|_, _, _| {}).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "the method converged cannot show what the scene asks for: maximum; take function or cycle or sheared or true or image-order"
    );
    // An integral adds up what lies along a ray; the others show every mode.
    for mode in Mode::ALL {
        let able = |method: &&&Method| method.check(&asking(Feature::Mode(mode))).is_ok();
        let names: Vec<&str> = METHODS.iter().filter(|method| !able(method)).map(|method| method.about.name).collect();
        assert_eq!(names, if mode.adds_up() { vec![] } else { vec!["converged"] }, "{mode}");
    }
}

/// From an eye the twins cast each pass of the picture, with the estimator that the pass has, and warp all of them.
#[test]
fn from_an_eye_each_row_is_the_code_behind_it() {
    for (eye_voxel, one_pass) in [([6.0, -20.0, 9.0], true), ([-9.0, -10.0, 7.0], false), ([6.0, 7.5, 5.0], false)] {
        let perspective = Perspective { eye_voxel: Some(eye_voxel), ..Perspective::new(100.0) };
        let mut scene = scene();
        scene.image.pixel_size_voxel = None;
        scene.view = View { yaw_deg: -40.0, tilt_deg: 10.0, perspective: Some(perspective), ..scene.view };
        if one_pass {
            (scene.view.yaw_deg, scene.view.tilt_deg) = (0.0, 0.0);
        }
        let (machine, volume) = (machine(), load(&scene));
        let frames = picture_setup(&scene, &machine, &volume.info(), true).unwrap();
        assert_eq!(frames.setups.len() == 1, one_pass, "{eye_voxel:?}");
        for (name, interpolation, whole_steps) in [
            ("sheared", SampleCell::Sheared, false),
            ("true", SampleCell::Exact, false),
            ("sheared:published", SampleCell::Sheared, true),
        ] {
            let cast = |setup: &Arc<FrameSetup>| {
                let gradient = setup.gradient.as_ref().unwrap().method;
                let options = DiscreteOptions { gradient, border: volume.words.window[0], whole_steps };
                discrete(&volume.data, &scene, &setup.geometry, interpolation, &options, None).unwrap()
            };
            let bases: Vec<BaseRendering> = frames.setups.iter().map(cast).collect();
            let passes: Vec<(&BaseRendering, &Geometry)> =
                bases.iter().zip(frames.setups.iter().map(|setup| &setup.geometry)).collect();
            let expected = cube3_twin::warp_passes(&passes, &frames.plane, volume.data.spacing, scene.background);
            let rendering = of_text(name, &scene);
            assert!(rendering.picture.pixels.iter().any(|pixel| *pixel != scene.background));
            assert_eq!(rendering.picture.pixels, expected, "{name} from {eye_voxel:?}");
            assert_eq!(rendering.samples, frames.setups.iter().map(|setup| setup.geometry.sample_count()).sum::<u64>());
        }
    }
}

/// An eye that looks away from the volume: no frame, and so no rays of a machine; the others show the background.
#[test]
fn without_a_frame_there_are_no_rays_of_it() {
    let perspective = Perspective { eye_voxel: Some([7.0, -20.0, 7.0]), ..Perspective::new(40.0) };
    let mut scene = scene();
    scene.image.pixel_size_voxel = None;
    scene.view = View { perspective: Some(perspective), ..View::from_angles(180.0, 0.0) };
    for method in [&SHEARED, &TRUE] {
        let volume = load(&scene);
        let refused = Choice::of(method).render(&Subject::new(&scene, &machine(), &volume), &|_, _, _| {});
        assert!(matches!(refused, Err(RenderError::NoFrame)));
    }
    assert!(of_text("function", &scene).picture.pixels.iter().all(|pixel| *pixel == scene.background));
}

/// A method as another crate would have it: one brightness everywhere, and no cuts.
const FLAT: SceneMethod = SceneMethod {
    about: About {
        name: "flat",
        what: "one brightness",
        source: "this test",
        supports: &[Feature::Mode(Mode::Composite), Feature::Shading, Feature::Colour],
        options: &[MethodOption {
            name: "brightness",
            about: "of every pixel",
            kind: OptionKind::Number { range: [0.0, 1.0], default: 0.5, unit: "" },
        }],
        in_words: false,
        reach_voxel: 0.0,
    },
    render: flat,
    sparse: None,
    kept: None,
    finer: None,
};

fn flat(subject: &SceneSubject<'_>, settings: &Settings, _: Watch<'_>) -> Result<Rendering, MethodError> {
    let image = &subject.scene.image;
    let fill = || Picture::filled(image.width_px as usize, image.height_px as usize, [settings.value(0); 3]);
    let (picture, phase) = Phase::of("fill", fill);
    let picture = picture?;
    let bound = Some(vec![0.0; picture.pixels.len()]);
    Ok(Rendering { picture, phases: vec![phase], samples: 0, bytes: 0, bound })
}

/// The table with one line more.
static WITH_FLAT: &[&Method] = &[&FUNCTION, &IMAGE_ORDER, &Method::of_scene(&FLAT)];

#[test]
fn a_method_that_is_added_is_one_line_of_the_table() {
    let scene = scene();
    let (machine, volume) = (machine(), load(&scene));
    let subject = Subject::new(&scene, &machine, &volume);
    let choice = Choice::parse(WITH_FLAT, "flat:0.25").unwrap();
    let rendering = choice.render(&subject, &|_, _, _| {}).unwrap();
    assert_eq!(rendering.picture.pixels, vec![[0.25; 3]; 32 * 28]);
    assert!(rendering.bound.is_some() && choice.method.needs_no_machine());
    assert_eq!(own_error(&choice, &subject, &rendering.picture).unwrap(), None);
    assert_eq!(names(WITH_FLAT), ["function", "image-order", "flat"]);
    assert_eq!(
        Choice::parse(WITH_FLAT, "flt").unwrap_err().to_string(),
        "there is no method flt: did you mean flat?; known are function, image-order, flat"
    );
    let cut = Scene { cuts: vec![Cut { normal: [1.0, 0.0, 0.0], through_voxel: [3.0; 3] }], ..scene.clone() };
    let refused = choice.render(&Subject::new(&cut, &machine, &volume), &|_, _, _| {}).unwrap_err().to_string();
    assert!(
        refused.starts_with("the method flat cannot show what the scene asks for: cuts; take function"),
        "{refused}"
    );
}

/// Image order is held against the integral that it comes to, on a sixteenth of the pixels; where a mode chooses a sample, against half its
/// step.
#[test]
fn a_method_with_a_finer_one_says_how_far_it_is_from_itself() {
    let scene = scene();
    let (machine, volume) = (machine(), load(&scene));
    let subject = Subject::new(&scene, &machine, &volume);
    let own = |text: &str| {
        let choice: Choice = text.parse().unwrap();
        let picture = choice.render(&subject, &|_, _, _| {}).unwrap().picture;
        own_error(&choice, &subject, &picture).unwrap()
    };
    let coarse = own("image-order:2").unwrap();
    assert_eq!([coarse.of.to_string(), coarse.against.to_string()], ["image-order:2", "converged:1e-5"]);
    assert!(coarse.bound.is_some_and(|bound| bound > 0.0 && bound <= 1e-5));
    let fine = own("image-order:0.25").unwrap();
    assert!(fine.error.mean_relative < coarse.error.mean_relative / 4.0, "{fine:?} {coarse:?}");
    assert!(coarse.pixels > 4 && coarse.pixels <= 8 * 7, "{}", coarse.pixels);
    assert_eq!((own("sheared"), own("converged")), (None, None));
    let brightest = Scene { mode: Mode::Maximum, ..scene.clone() };
    let subject = Subject::new(&brightest, &machine, &volume);
    let choice: Choice = "image-order:1".parse().unwrap();
    let picture = choice.render(&subject, &|_, _, _| {}).unwrap().picture;
    let own = own_error(&choice, &subject, &picture).unwrap().unwrap();
    assert_eq!((own.against.to_string().as_str(), own.bound), ("image-order", None));
}
