//! Every parameter of a scene: a row for each key of its files that holds a value.

use crate::{
    ColourPoint, Crop, Cut, DepthCue, FARTHEST_EYE_VOXEL, FIELD_OF_VIEW_DEG, FileAxes, Interpolation, LARGEST_IMAGE_PX,
    LARGEST_PHANTOM_VOXELS, Layer, Light, Mode, Path, PathKey, Perspective, SCHEMA, Scene, Threshold,
};
use cube3_parameter::{
    Choice, Field, Legal, Parameter, Unfit, Value, ValueKind, assign, assign_each, each, kind, kind_of_each, legal,
    optional, parameter,
};

impl Choice for Mode {}
impl Choice for FileAxes {}
impl Choice for Interpolation {}

/// The default field of view of a perspective that is set by its parameters, in degrees.
const FIELD_OF_VIEW: f64 = 40.0;
/// The largest exponent of the highlight.
const LARGEST_SHININESS: f64 = 1000.0;
/// The last frame that a key can be at, and the largest angle, in degrees.
const FARTHEST_KEY: f64 = 1e9;

/// A part of 1.
const PART: Legal = Legal::real(0.0, 1.0);
const FIGURE_14: &str = "Pfister et al. 1995, section 6, figure 14";
const OURS: &str = "ours";

/// A row of a field; see [`parameter!`].
macro_rules! row {
    ($($key:ident).+, $unit:expr $(, $legal:expr)?; $about:literal; $source:expr $(; because $because:literal)?) => {
        Parameter {
            $(legal: |_| $legal,)?
            $(because: $because,)?
            ..parameter!(Scene, $($key).+, $unit, $about, $source)
        }
    };
}

/// What is legal for a field: a range, or whatever its type can be.
macro_rules! range {
    ($type:ty, $field:ident) => {
        |_| legal(|of: &$type| &of.$field)
    };
    ($type:ty, $field:ident, $legal:expr) => {
        |_| $legal
    };
}

/// A row of a field of a table that may be absent. Set, it makes the table.
macro_rules! inside {
    (
        $key:literal, $($table:ident).+: $type:ty = $new:expr, $field:ident, $unit:expr $(, $legal:expr)?;
        $about:literal; $source:expr
    ) => {
        Parameter {
            key: $key,
            kind: kind(|of: &$type| &of.$field),
            unit: $unit,
            about: $about,
            source: $source,
            optional: true,
            example: "",
            because: "",
            legal: range!($type, $field $(, $legal)?),
            get: |scene| scene.$($table).+.as_ref().map_or(Value::Absent, |table| table.$field.value()),
            set: |scene, value| match (value, &scene.$($table).+) {
                (Value::Absent, None) => Ok(()),
                _ => assign(&mut scene.$($table).+.get_or_insert_with(|| $new).$field, value),
            },
        }
    };
}

/// A row of a field of every element of a list.
macro_rules! of_each {
    (
        $key:literal, $($list:ident).+: $type:ty, $field:ident, $unit:expr $(, $legal:expr)?; $about:literal; $source:expr
    ) => {
        Parameter {
            key: $key,
            kind: kind_of_each(|of: &$type| &of.$field),
            unit: $unit,
            about: $about,
            source: $source,
            optional: optional(|of: &$type| &of.$field),
            example: "",
            because: "",
            legal: range!($type, $field $(, $legal)?),
            get: |scene| each(&scene.$($list).+, |of| &of.$field),
            set: |scene, value| assign_each(&mut scene.$($list).+, |of| &mut of.$field, value),
        }
    };
}

/// A row of an angle of every key of the path.
macro_rules! angle {
    ($key:literal, $field:ident) => {
        Parameter {
            key: $key,
            kind: kind_of_each(|of: &PathKey| &of.$field),
            optional: true,
            legal: |_| Legal::real(-FARTHEST_KEY, FARTHEST_KEY),
            get: |scene| each(keys(scene), |of| &of.$field),
            set: |scene, value| assign_each(keys_mut(scene), |of| &mut of.$field, value),
            ..parameter!(Scene, view.$field, "degrees", "as in the view, whose it is without it", OURS)
        }
    };
}

/// The rows of value and opacity of the points of a transfer function by value alone.
macro_rules! of_points {
    ($key:literal, $i:literal, $legal:expr; $about:literal) => {
        Parameter {
            key: $key,
            kind: ValueKind::List(&ValueKind::Real),
            legal: |_| $legal,
            get: |scene| each(&scene.transfer.opacity, |point| &point[$i]),
            set: |scene, value| assign_each(&mut scene.transfer.opacity, |point| &mut point[$i], value),
            ..parameter!(Scene, transfer.opaque_alpha, "", $about, FIGURE_14)
        }
    };
}

/// The same of the points of every layer.
macro_rules! of_layers {
    ($key:literal, $i:literal, $legal:expr; $about:literal) => {
        Parameter {
            key: $key,
            kind: ValueKind::List(&ValueKind::List(&ValueKind::Real)),
            legal: |_| $legal,
            get: |scene| {
                let layer = |layer: &Layer| each(&layer.opacity, |point| &point[$i]);
                Value::List(scene.transfer.layers.iter().map(layer).collect())
            },
            set: |scene, value| set_layers(&mut scene.transfer.layers, |point| &mut point[$i], value),
            ..parameter!(Scene, transfer.opaque_alpha, "", $about, "Pfister et al. 1995, section 4")
        }
    };
}

fn set_layers(layers: &mut [Layer], of: fn(&mut [f64; 2]) -> &mut f64, value: &Value) -> Result<(), Unfit> {
    match value {
        Value::List(values) if values.len() == layers.len() => {
            layers.iter_mut().zip(values).try_for_each(|(layer, value)| assign_each(&mut layer.opacity, of, value))
        }
        _ => Err(Unfit {
            value: value.clone(),
            kind: ValueKind::List(&ValueKind::List(&ValueKind::Real)),
            optional: false,
        }),
    }
}

fn keys(scene: &Scene) -> &[PathKey] {
    scene.path.as_ref().map_or(&[], |path| &path.keys)
}

fn keys_mut(scene: &mut Scene) -> &mut [PathKey] {
    scene.path.as_mut().map_or(&mut [], |path| &mut path.keys)
}

fn perspective() -> Perspective {
    Perspective::new(FIELD_OF_VIEW)
}

/// A box of one voxel's centre.
fn crop() -> Crop {
    Crop { min_voxel: [0.0; 3], max_voxel: [0.0; 3] }
}

/// A row for each key of a scene file that holds a value. `[]` stands for every element of a list.
pub const SCENE_PARAMETERS: &[Parameter<Scene>] = &[
    row!(schema, "", Legal::whole(1, SCHEMA as i128); "number of this file's form"; OURS),
    row!(mode, ""; "how the samples along a ray become a pixel"; "Pfister et al. 1995, section 4; ours"),
    row!(background, "", PART; "what is seen where the volume is clear: red, green and blue"; OURS),
    row!(volume.file, ""; "volume file; a relative path starts at the current directory"; OURS),
    row!(volume.files, ""; "volume files of one grid, in the order of time"; OURS),
    row!(volume.phantom, ""; "name of a phantom that is computed"; OURS),
    row!(volume.size_voxels, "voxels", Legal::whole(1, LARGEST_PHANTOM_VOXELS as i128); "each side of the phantom"; OURS),
    row!(volume.window, "", Legal::finite(); "stored values that become the lowest and the highest voxel value"; OURS),
    row!(volume.axes, ""; "how the axes of a file become x, y and z"; OURS),
    row!(volume.time, "", Legal::whole(0, i64::MAX as i128); "which volume of a file that holds a series"; OURS),
    row!(volume.labels, ""; "whether values are labels: each sample is then its nearest voxel"; OURS),
    row!(volume.phase, "periods", Legal::finite(); "of a phantom that moves, the phase of the first volume"; OURS),
    row!(volume.phase_per_frame, "periods", Legal::finite();
        "of a phantom that moves, how far each volume is behind the one before"; OURS),
    row!(view.yaw_deg, "degrees", Legal::finite(); "turn of the eye about +z"; OURS),
    row!(view.tilt_deg, "degrees", Legal::finite(); "height of the eye over the horizon"; FIGURE_14),
    row!(view.roll_deg, "degrees", Legal::finite(); "turn of the picture's content, clockwise"; OURS),
    row!(view.direction, "", Legal::finite(); "from the eye into the scene, of any length, instead of the angles"; OURS),
    row!(view.up, "", Legal::finite(); "what is up in the picture, with a direction alone"; OURS),
    inside!("view.perspective.field_of_view_deg", view.perspective: Perspective = perspective(), field_of_view_deg, "degrees",
        Legal::real(FIELD_OF_VIEW_DEG[0], FIELD_OF_VIEW_DEG[1]);
        "angle between the picture's lower and upper edge; rays are parallel without it"; OURS),
    inside!("view.perspective.eye_voxel", view.perspective: Perspective = perspective(), eye_voxel, "voxels",
        Legal::real(-FARTHEST_EYE_VOXEL, FARTHEST_EYE_VOXEL); "the eye, in voxel coordinates"; OURS),
    inside!("view.perspective.distance_voxel", view.perspective: Perspective = perspective(), distance_voxel, "voxels",
        Legal::real(0.0, FARTHEST_EYE_VOXEL); "or how far before the volume's centre the eye is"; OURS),
    inside!("path.turntable_deg", path: Path = Path::default(), turntable_deg, "degrees", Legal::finite();
        "turn of the eye over all frames"; OURS),
    inside!("path.interpolation", path: Path = Path::default(), interpolation, "";
        "how angles go from key to key"; OURS),
    Parameter {
        key: "path.key[].frame",
        kind: kind_of_each(|key: &PathKey| &key.frame),
        legal: |_| Legal::real(0.0, FARTHEST_KEY),
        get: |scene| each(keys(scene), |key| &key.frame),
        set: |scene, value| assign_each(keys_mut(scene), |key| &mut key.frame, value),
        ..parameter!(Scene, view.yaw_deg, "frames", "frame of a view on the way, ascending", OURS)
    },
    angle!("path.key[].yaw_deg", yaw_deg),
    angle!("path.key[].tilt_deg", tilt_deg),
    angle!("path.key[].roll_deg", roll_deg),
    row!(image.width_px, "pixels", Legal::whole(1, LARGEST_IMAGE_PX as i128); "columns"; OURS),
    row!(image.height_px, "pixels", Legal::whole(1, LARGEST_IMAGE_PX as i128); "rows"; OURS),
    row!(image.pixel_size_voxel, "voxels", Legal::above(0.0, f64::MAX);
        "distance between pixels, of parallel views; the volume fits without it"; OURS),
    row!(transfer.opacity_correction, ""; "whether opacity is corrected to the length of a ray's steps"; OURS),
    row!(transfer.opaque_alpha, "", Legal::above(0.0, 1.0); "opacity from which a sample is opaque, for the modes that look for one"; OURS),
    of_points!("transfer.opacity[][0]", 0, Legal::finite(); "value of a point of the opacity, ascending"),
    of_points!("transfer.opacity[][1]", 1, PART; "opacity of a voxel's length there; linear between"),
    of_each!("transfer.colour[].value", transfer.colour: ColourPoint, value, "", Legal::finite();
        "value of a point of the colour, ascending"; OURS),
    of_each!("transfer.colour[].rgb", transfer.colour: ColourPoint, rgb, "", PART;
        "red, green and blue there; linear between"; OURS),
    of_each!("transfer.layer[].gradient", transfer.layers: Layer, gradient, "", Legal::real(0.0, f64::MAX);
        "gradient's magnitude of a layer of opacity, values a voxel, ascending"; "Pfister et al. 1995, section 4"),
    of_layers!("transfer.layer[].opacity[][0]", 0, Legal::finite(); "as in transfer.opacity"),
    of_layers!("transfer.layer[].opacity[][1]", 1, PART; "as in transfer.opacity"),
    row!(material.shaded, ""; "whether samples are lit at all"; OURS),
    row!(material.ambient, "", PART; "part of the colour that needs no light"; "Phong 1975"),
    row!(material.diffuse, "", PART; "part that is scattered evenly"; "Phong 1975"),
    row!(material.specular, "", PART; "part of the light that is mirrored"; "Phong 1975"),
    row!(material.shininess, "", Legal::above(0.0, LARGEST_SHININESS);
        "exponent of the highlight: narrower as it grows"; "Phong 1975"),
    row!(material.two_sided, ""; "whether the back of a surface is lit as its front is"; OURS),
    of_each!("light[].direction", lights: Light, direction, "", Legal::finite();
        "towards the light, in world coordinates, of any length; at the eye without it"; OURS),
    of_each!("light[].colour", lights: Light, colour, "", PART; "red, green and blue"; OURS),
    inside!("depth_cue.front", depth_cue: DepthCue = DepthCue::default(), front, "", PART;
        "factor on the colour at the volume's nearest corner"; OURS),
    inside!("depth_cue.back", depth_cue: DepthCue = DepthCue::default(), back, "", PART;
        "factor at the farthest corner"; OURS),
    of_each!("cut[].normal", cuts: Cut, normal, "", Legal::finite(); "points at what a plane removes"; OURS),
    of_each!("cut[].through_voxel", cuts: Cut, through_voxel, "voxels", Legal::finite(); "a point on the plane"; OURS),
    inside!("crop.min_voxel", crop: Crop = crop(), min_voxel, "voxels", Legal::finite();
        "corner of the smallest coordinates of the box that is shown"; OURS),
    inside!("crop.max_voxel", crop: Crop = crop(), max_voxel, "voxels", Legal::finite();
        "corner of the largest, nowhere below min_voxel"; OURS),
    inside!("threshold.low", threshold: Threshold = Threshold::default(), low, "", Legal::finite();
        "smallest value that is shown"; OURS),
    inside!("threshold.high", threshold: Threshold = Threshold::default(), high, "", Legal::finite();
        "largest value that is shown, not below low"; OURS),
];
