//! Scene files as their users write them, and the messages they get.

use cube3_cases::cases;
use cube3_scene::{
    ColourPoint, Crop, Cut, DepthCue, FARTHEST_EYE_VOXEL, FileAxes, Layer, Light, Mode, Perspective, Scene, Threshold,
    Transfer, View, VolumeSource,
};
use proptest::prelude::*;

fn message(text: &str) -> String {
    Scene::from_toml(text, "scene.toml").expect_err(text).to_string()
}

#[test]
fn the_commented_default_is_the_default() {
    let scene = Scene::from_toml(Scene::COMMENTED_DEFAULT, "default").unwrap();
    assert_eq!(scene, Scene::default());
}

#[test]
fn an_empty_file_is_the_default() {
    assert_eq!(Scene::from_toml("", "empty").unwrap(), Scene::default());
}

/// The commented default without its comments on prose, its options switched on, and the lines dropped
/// for which `drop` holds.
fn options_on(drop: impl Fn(&str) -> bool) -> String {
    let lines = Scene::COMMENTED_DEFAULT.lines().filter(|line| !line.starts_with("# "));
    let lines = lines.map(|line| line.strip_prefix('#').unwrap_or(line)).filter(|line| !drop(line));
    lines.map(|line| format!("{line}\n")).collect()
}

#[test]
fn every_option_in_the_commented_default_exists() {
    let alternatives = [
        "file =",
        "files =",
        "time =",
        "labels =",
        "yaw_deg",
        "tilt_deg",
        "roll_deg",
        "opacity = [[80.0, 0.0], [100.0",
        "eye_voxel",
        "pixel_size",
    ];
    let path = ["[path]", "turntable_deg", "interpolation", "[[path.key]]", "frame ="];
    let alternatives = [alternatives.as_slice(), &path].concat();
    let mut opacities = 0;
    let text = options_on(|line| alternatives.iter().any(|start| line.starts_with(start)));
    // The ramp went from [transfer] and from the last layer: give it back to the layer.
    let text: String = text
        .lines()
        .map(|line| {
            opacities += usize::from(line.starts_with("gradient = 20"));
            let ramp = if line.starts_with("gradient = 20") { "\nopacity = [[80.0, 0.0]]" } else { "" };
            format!("{line}{ramp}\n")
        })
        .collect();
    assert_eq!(opacities, 1);
    let scene = Scene::from_toml(&text, "options").unwrap();
    assert!(scene.volume.window.is_some() && scene.image.pixel_size_voxel.is_none());
    let perspective = Perspective { distance_voxel: Some(300.0), ..Perspective::new(40.0) };
    assert_eq!(scene.view.perspective, Some(perspective));
    assert!(scene.view.direction.is_some() && scene.view.up.is_some());
    assert!(scene.transfer.is_two_dimensional() && scene.transfer.opacity.is_empty());
    assert!(scene.lights[0].direction.is_some() && scene.depth_cue == Some(DepthCue::default()));
    assert!(scene.cuts.len() == 1 && scene.crop.is_some() && scene.threshold.is_some());

    let only = |table: &str, start: &str| {
        let text = options_on(|line| !line.starts_with(start) && line != table);
        Scene::from_toml(&text, "one option").unwrap()
    };
    assert!(scene.volume.phase.is_some() && scene.volume.phase_per_frame.is_some());
    assert_eq!(only("[volume]", "file =").volume, VolumeSource::from_file("volume.nrrd"));
    assert_eq!(only("[volume]", "files =").volume.files.len(), 2);
    let series = Scene::from_toml("[volume]\nfile = \"a\"\ntime = 3\naxes = \"stored\"\n", "series").unwrap();
    assert_eq!((series.volume.time, series.volume.axes), (Some(3), FileAxes::Stored));
    assert_eq!(Scene::from_toml("schema = 1\n", "old").unwrap().schema, 1);
    assert!(only("[volume]", "labels =").volume.labels);
    assert_eq!(only("[image]", "pixel_size").image.pixel_size_voxel, Some(1.0));
    let text =
        options_on(|line| !["[view.p", "field_of_view", "eye_voxel"].iter().any(|start| line.starts_with(start)));
    let scene = Scene::from_toml(&text, "eye").unwrap();
    assert_eq!(scene.view.perspective.unwrap().eye_voxel, Some([63.5, -150.0, 63.5]));

    let on = |line: &str| path.iter().chain(&["yaw_deg", "tilt_deg", "roll_deg"]).any(|start| line.starts_with(start));
    let after_view = |text: String| text[text.find("[path]").unwrap()..].to_owned();
    let keys = after_view(options_on(|line| !on(line) || line.starts_with("turntable_deg")));
    let key = Scene::from_toml(&keys, "keys").unwrap().path.unwrap().keys[0];
    assert!(key.yaw_deg.is_some() && key.tilt_deg.is_some() && key.roll_deg.is_some());
    let turntable = options_on(|line| line != "[path]" && !line.starts_with("turntable_deg"));
    assert!(Scene::from_toml(&turntable, "turntable").unwrap().path.unwrap().turntable_deg.is_some());
}

#[test]
fn a_part_of_a_file_leaves_the_other_keys_at_their_defaults() {
    let text = "mode = \"maximum\"\n[view]\nyaw_deg = 45\n[volume]\nfile = \"ct.nrrd\"\n";
    let scene = Scene::from_toml(text, "part").unwrap();
    let expected = Scene {
        mode: Mode::Maximum,
        view: View::from_angles(45.0, 7.0),
        volume: VolumeSource::from_file("ct.nrrd"),
        ..Scene::default()
    };
    assert_eq!(scene, expected);
    let scene = Scene::from_toml("[volume]\nsize_voxels = 3\n", "part").unwrap();
    assert_eq!(scene.volume, VolumeSource::from_phantom("head", 3));
}

#[test]
fn no_lights_and_one_default_light_are_different() {
    let dark = Scene::from_toml("light = []\n", "dark").unwrap();
    assert!(dark.lights.is_empty());
    assert_eq!(Scene::from_toml(&dark.to_toml().unwrap(), "dark").unwrap(), dark);
}

#[test]
fn each_message_has_the_place_the_reason_and_what_is_right() {
    for (text, expected) in [
        (
            "[view]\ntilt = 3\n",
            "scene.toml:2: view.tilt: there is no key `tilt`; did you mean `tilt_deg`? \
             The keys here are yaw_deg, tilt_deg, roll_deg, direction, up, perspective",
        ),
        (
            "\nmode = \"maximal\"\n",
            "scene.toml:2: mode: `maximal` is not known; did you mean `maximum`? The choices are \
             composite, first-opaque, last-opaque, maximum, minimum, weighted-sum",
        ),
        ("[view]\n\nyaw_deg = \"left\"\n", "scene.toml:3: view.yaw_deg: invalid type: string \"left\"; give a number"),
        (
            "[transfer]\nopacity = [\n  [80, 0],\n  [90, 1.5],\n]\n",
            "scene.toml:4: transfer.opacity[1][1]: 1.5 is outside 0 to 1; the nearest legal value is 1.0",
        ),
        (
            "[view]\nyaw_deg = 3\ndirection = [1, 0, 0]\n",
            "scene.toml:1: view: a direction and angles are both given; give `direction` (and `up`), \
             or `yaw_deg`, `tilt_deg` and `roll_deg`, not both",
        ),
        (
            "[[cut]]\nnormal = [1, 0, 0]\n",
            "scene.toml:1: cut[0]: the key `through_voxel` is missing; give `through_voxel`",
        ),
        ("schema = 3\nnew_key = 1\n", "scene.toml:1: schema: the scene has format 3; give a scene of format 1 to 2"),
        (
            "[volume]\nfile = \"a\"\nphantom = \"head\"\n",
            "scene.toml:3: volume.phantom: a file and a phantom are both given; \
             give only one of `file`, `files` and `phantom`",
        ),
        (
            "[view.perspective]\nfield_of_view = 3\n",
            "scene.toml:2: view.perspective.field_of_view: there is no key `field_of_view`; \
             did you mean `field_of_view_deg`? The keys here are field_of_view_deg, eye_voxel, distance_voxel",
        ),
        (
            "[view.perspective]\neye_voxel = [1, 2, 3]\n",
            "scene.toml:1: view.perspective: the key `field_of_view_deg` is missing; give `field_of_view_deg`",
        ),
        (
            "[image]\npixel_size_voxel = 2\n[view.perspective]\nfield_of_view_deg = 40\n",
            "scene.toml:2: image.pixel_size_voxel: a pixel has no one size in a perspective view; leave it out: \
             `view.perspective.field_of_view_deg` sets what the picture shows",
        ),
        ("background = [0, 0]\n", "scene.toml:1: background: invalid length 2; give a list of 3 numbers"),
    ] {
        assert_eq!(message(text), expected);
    }
}

#[test]
fn text_that_is_not_toml_names_its_line() {
    for (text, line) in [
        ("mode = \"composite\"\n[view\nyaw_deg = 3\n", 2),
        ("mode =\n", 1),
        ("schema = 1\n\nmode = composite\n", 3),
        ("a = 1\na = 2\n", 2),
        ("\u{0}", 1),
    ] {
        let message = message(text);
        assert!(message.starts_with(&format!("scene.toml:{line}: ")), "{message}");
        assert!(!message.contains('\n') && message.contains("; "), "{message}");
    }
}

#[test]
fn every_fault_is_found_at_its_key() {
    for (text, key) in [
        ("schema = -1", "schema"),
        ("background = [0, 0, 1.01]", "background[2]"),
        ("[volume]\nsize_voxels = 0", "volume.size_voxels"),
        ("[volume]\nsize_voxels = 5000", "volume.size_voxels"),
        ("[volume]\nfile = \"a\"\nsize_voxels = 5", "volume.size_voxels"),
        ("[volume]\nfile = \"\"", "volume.file"),
        ("[volume]\nphantom = \"\"", "volume.phantom"),
        ("[volume]\nwindow = [3, 3]", "volume.window"),
        ("[volume]\nwindow = [3, inf]", "volume.window[1]"),
        ("[volume]\nwindow = [0, 3]\nlabels = true", "volume.window"),
        ("[view]\nyaw_deg = nan", "view.yaw_deg"),
        ("[view]\nroll_deg = inf", "view.roll_deg"),
        ("[view]\ndirection = [0, 0, 0]", "view.direction"),
        ("[view]\ndirection = [0, 0, 1]\nup = [0, 0, 1]", "view.up"),
        ("[view]\nup = [0, 0, 1]", "view.up"),
        ("[view.perspective]\nfield_of_view_deg = 0", "view.perspective.field_of_view_deg"),
        ("[view.perspective]\nfield_of_view_deg = 0.0009", "view.perspective.field_of_view_deg"),
        ("[view.perspective]\nfield_of_view_deg = 179.1", "view.perspective.field_of_view_deg"),
        ("[view.perspective]\nfield_of_view_deg = nan", "view.perspective.field_of_view_deg"),
        ("[view]\nperspective = { field_of_view_deg = 9, eye_voxel = [0, nan, 0] }", "view.perspective.eye_voxel[1]"),
        ("[view]\nperspective = { field_of_view_deg = 9, eye_voxel = [0, 0, -2e12] }", "view.perspective.eye_voxel[2]"),
        ("[view]\nperspective = { field_of_view_deg = 9, distance_voxel = -1 }", "view.perspective.distance_voxel"),
        ("[view]\nperspective = { field_of_view_deg = 9, distance_voxel = 2e12 }", "view.perspective.distance_voxel"),
        (
            "[view]\nperspective = { field_of_view_deg = 9, distance_voxel = 1, eye_voxel = [0, 0, 0] }",
            "view.perspective.distance_voxel",
        ),
        ("[image]\nwidth_px = 0", "image.width_px"),
        ("[image]\nheight_px = 16385", "image.height_px"),
        ("[image]\nwidth_px = -1", "image.width_px"),
        ("[image]\npixel_size_voxel = 0", "image.pixel_size_voxel"),
        ("[image]\npixel_size_voxel = inf", "image.pixel_size_voxel"),
        ("[transfer]\nopaque_alpha = 1.1", "transfer.opaque_alpha"),
        ("[transfer]\nopacity = []", "transfer.opacity"),
        ("[[transfer.layer]]\ngradient = 0\nopacity = []", "transfer.layer[0].opacity"),
        ("[material]\nambient = -0.1", "material.ambient"),
        ("[material]\ndiffuse = nan", "material.diffuse"),
        ("[material]\nspecular = 2", "material.specular"),
        ("[material]\nshininess = 0", "material.shininess"),
        ("[material]\nshininess = 1001", "material.shininess"),
        ("[[light]]\ndirection = [0, 0, 0]", "light[0].direction"),
        ("[[light]]\n[[light]]\ncolour = [0, 0, 2]", "light[1].colour[2]"),
        ("[depth_cue]\nback = 1.5", "depth_cue.back"),
        ("[depth_cue]\nfront = -1", "depth_cue.front"),
        ("[[cut]]\nnormal = [0, 0, 0]\nthrough_voxel = [0, 0, 0]", "cut[0].normal"),
        ("[[cut]]\nnormal = [1, 0, 0]\nthrough_voxel = [0, inf, 0]", "cut[0].through_voxel[1]"),
        ("[crop]\nmin_voxel = [0, 0, 1]\nmax_voxel = [0, 0, 0]", "crop.max_voxel[2]"),
        ("[crop]\nmin_voxel = [nan, 0, 1]\nmax_voxel = [0, 0, 0]", "crop.min_voxel[0]"),
        ("[threshold]\nlow = 2\nhigh = 1", "threshold.high"),
        ("[threshold]\nlow = nan", "threshold.low"),
    ] {
        let error = Scene::from_toml(text, "scene.toml").expect_err(text);
        assert_eq!(error.key(), key, "{error}");
        assert!(error.to_string().starts_with("scene.toml:"), "{error}");
        let right = error.to_string();
        assert!(right.contains("; "), "{right}");
    }
}

#[test]
fn the_limits_on_lists_are_tight() {
    let cut = Cut { normal: [1.0; 3], through_voxel: [0.0; 3] };
    let cuts = |n| Scene { cuts: vec![cut.clone(); n], ..Scene::default() };
    assert!(cuts(6).validate().is_ok());
    assert_eq!(cuts(7).validate().unwrap_err().key(), "cut[6]");
    let lights = |n| Scene { lights: vec![Light::default(); n], ..Scene::default() };
    assert!(lights(8).validate().is_ok());
    assert_eq!(lights(9).validate().unwrap_err().key(), "light[8]");
}

#[test]
fn a_scene_file_is_read_and_a_missing_one_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my scene.toml");
    std::fs::write(&path, "mode = \"minimum\"\n").unwrap();
    assert_eq!(Scene::read(&path).unwrap().mode, Mode::Minimum);
    std::fs::write(&path, "mode = 3\n").unwrap();
    assert!(Scene::read(&path).unwrap_err().to_string().contains("my scene.toml:1: mode"));
    std::fs::write(&path, [0xFF, 0xFE]).unwrap();
    assert!(Scene::read(&path).unwrap_err().to_string().contains("my scene.toml"));
    let missing = Scene::read(folder.path().join("absent.toml")).unwrap_err().to_string();
    assert!(missing.contains("absent.toml") && !missing.contains('\n'), "{missing}");
}

#[cfg(unix)]
#[test]
fn a_path_that_is_not_unicode_is_an_error_and_not_a_panic() {
    use std::os::unix::ffi::OsStringExt;
    let path = std::ffi::OsString::from_vec(vec![b'a', 0xFF]);
    let scene = Scene { volume: VolumeSource::from_file(path), ..Scene::default() };
    assert_eq!(scene.validate().unwrap_err().key(), "volume.file");
    assert!(scene.to_toml().is_err());
}

fn unit() -> impl Strategy<Value = f64> {
    prop_oneof![0.0..=1.0_f64, Just(0.0), Just(1.0), Just(f64::MIN_POSITIVE)]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3..1e3_f64, Just(f64::MAX), Just(f64::from_bits(1)), Just(-0.0)]
}

fn vector() -> impl Strategy<Value = [f64; 3]> {
    prop::array::uniform3(number()).prop_filter("has a direction", |v| v != &[0.0; 3])
}

fn opacity() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec((number(), unit()), 1..4).prop_map(|mut points| {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points.into_iter().map(|(value, opacity)| [value, opacity]).collect()
    })
}

prop_compose! {
    fn transfer()(
        two_dimensional in any::<bool>(), opacity in opacity(), layer in opacity(),
        gradient in 0.0..1e3_f64, rgb in prop::array::uniform3(unit()), value in number(),
        opacity_correction in any::<bool>(), opaque_alpha in 0.01..=1.0_f64,
    ) -> Transfer {
        let layers = vec![Layer { gradient, opacity: layer }];
        Transfer {
            opacity_correction,
            opaque_alpha,
            opacity: if two_dimensional { vec![] } else { opacity },
            colour: vec![ColourPoint { value, rgb }],
            layers: if two_dimensional { layers } else { vec![] },
        }
    }
}

fn perspective() -> impl Strategy<Value = Perspective> {
    let at = || prop_oneof![-1e3..1e3_f64, Just(FARTHEST_EYE_VOXEL), Just(-FARTHEST_EYE_VOXEL), Just(-0.0)];
    let eye = prop_oneof![
        Just((None, None)),
        prop::array::uniform3(at()).prop_map(|eye| (Some(eye), None)),
        at().prop_map(|distance| (None, Some(distance.abs()))),
    ];
    (prop_oneof![0.001..=179.0_f64, Just(0.001), Just(179.0)], eye).prop_map(
        |(field_of_view_deg, (eye_voxel, distance_voxel))| Perspective { field_of_view_deg, eye_voxel, distance_voxel },
    )
}

prop_compose! {
    fn scene()(
        mode in prop::sample::select(Mode::ALL.to_vec()),
        background in prop::array::uniform3(unit()),
        angles in prop::array::uniform2(-1e4..1e4_f64), roll_deg in -1e4..1e4_f64,
        direction in prop::option::of(vector()), perspective in prop::option::of(perspective()),
        file in prop::option::of("[a-z \"\\\\é]{1,9}"),
        (window, labels) in prop::sample::select(vec![(None, false), (None, true), (Some([-5.0, 7.5]), false)]),
        pixel_size_voxel in prop::option::of(1e-9..1e9_f64),
        transfer in transfer(),
        lights in prop::collection::vec((prop::option::of(vector()), unit()), 0..3),
        depth_cue in prop::option::of((unit(), unit())),
        cuts in prop::collection::vec((vector(), prop::array::uniform3(number())), 0..3),
        corner in prop::option::of(prop::array::uniform3(number())),
        threshold in prop::option::of((prop::option::of(-9.0..0.0_f64), prop::option::of(0.0..9.0))),
    ) -> Scene {
        let mut scene = Scene {
            mode, background, transfer,
            view: match direction {
                Some(direction) => View::from_direction(direction, None),
                None => View { roll_deg, ..View::from_angles(angles[0], angles[1]) },
            },
            volume: VolumeSource { window, labels, ..file.map_or_else(VolumeSource::default, |file| VolumeSource {
                axes: FileAxes::Stored, time: Some(file.len()), ..VolumeSource::from_file(file)
            }) },
            lights: lights.into_iter()
                .map(|(direction, grey)| Light { direction, colour: [grey; 3] }).collect(),
            depth_cue: depth_cue.map(|(front, back)| DepthCue { front, back }),
            cuts: cuts.into_iter()
                .map(|(normal, through_voxel)| Cut { normal, through_voxel }).collect(),
            crop: corner.map(|corner| Crop { min_voxel: corner, max_voxel: corner }),
            threshold: threshold.map(|(low, high)| Threshold { low, high }),
            ..Scene::default()
        };
        scene.view.perspective = perspective;
        scene.image.pixel_size_voxel = if perspective.is_some() { None } else { pixel_size_voxel };
        scene
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..cases(256) })]

    #[test]
    fn a_written_scene_is_read_back_the_same(scene in scene()) {
        prop_assert!(scene.validate().is_ok(), "{:?}", scene.validate());
        let text = scene.to_toml().unwrap();
        prop_assert_eq!(&Scene::from_toml(&text, "written").unwrap(), &scene);
        let json = serde_json::to_string(&scene).unwrap();
        prop_assert_eq!(&serde_json::from_str::<Scene>(&json).unwrap(), &scene);
    }

    #[test]
    fn no_text_makes_it_panic(text in "(?s).{0,60}", at in 0..4000_usize, by in any::<char>()) {
        let _ = Scene::from_toml(&text, "noise");
        let mut damaged: Vec<char> = Scene::COMMENTED_DEFAULT.chars().collect();
        let at = at % damaged.len();
        damaged[at] = by;
        if let Err(error) = Scene::from_toml(&damaged.into_iter().collect::<String>(), "damaged") {
            prop_assert!(error.to_string().starts_with("damaged"));
        }
    }
}
