//! Which samples of a ray are drawn, and the part of a step that each stands for.

use crate::grains::Grains;
use crate::interval::Interval;
use cube3_frame::{EndRegisters, Geometry};
use cube3_scene::Scene;

/// Whether a sample is drawn; where words and reals may differ, both.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drawn {
    /// In words and in reals.
    Yes,
    /// In one of the two, or in both.
    Maybe,
    /// In neither.
    No,
}

/// A plane; what is on the side of its normal is not drawn.
#[derive(Clone, Copy, Debug)]
struct Plane {
    /// Canonical, the largest component 1.
    normal: [f64; 3],
    /// A place on it, canonical, in voxels.
    through: [f64; 3],
}

impl Plane {
    /// Of a normal and a place along x, y, z.
    fn new(geometry: &Geometry, normal: [f64; 3], through: [f64; 3]) -> Plane {
        let largest = normal.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let axes = geometry.axes;
        let turned = [0, 1, 2].map(|i| {
            let along = normal[axes.axis[i]] / largest;
            if axes.reversed[i] { -along } else { along }
        });
        Plane { normal: turned, through: axes.canonical_position(geometry.size, through) }
    }

    /// How far before it a place is.
    fn before(&self, place: [f64; 3]) -> f64 {
        (0..3).map(|i| self.normal[i] * (self.through[i] - place[i])).sum()
    }

    /// By how much a step comes nearer to it.
    fn nearer(&self, step: [f64; 3]) -> f64 {
        (0..3).map(|i| self.normal[i] * step[i]).sum()
    }
}

/// What is drawn of a frame.
pub struct Region<'a> {
    geometry: &'a Geometry,
    grains: &'a Grains,
    clips: Vec<Plane>,
    faces: Vec<Plane>,
    /// Every sample stands for a whole step, and is added up.
    steps: bool,
    /// Ends have parts.
    exact: bool,
}

/// Reals are followed so closely, in voxels.
const REALS: f64 = 1e-8;
/// A ray that comes nearer to a plane by less than this a step runs along it: a bit of a distance decides whether it meets it.
const ALONG: f64 = 1e-9;
/// In reals it does so by less than this.
const PARALLEL: f64 = 1e-12;

impl<'a> Region<'a> {
    /// That of a scene; with `exact` ends the box of voxel centres bounds it too.
    pub fn new(scene: &Scene, geometry: &'a Geometry, grains: &'a Grains, exact: bool) -> Region<'a> {
        let mut clips: Vec<Plane> =
            scene.cuts.iter().map(|cut| Plane::new(geometry, cut.normal, cut.through_voxel)).collect();
        let box_of = |low: [f64; 3], high: [f64; 3]| {
            [(-1.0, low), (1.0, high)].into_iter().flat_map(move |(side, through)| {
                (0..3).map(move |axis| {
                    let mut normal = [0.0; 3];
                    normal[axis] = side;
                    Plane::new(geometry, normal, through)
                })
            })
        };
        if let Some(crop) = &scene.crop {
            clips.extend(box_of(crop.min_voxel, crop.max_voxel));
        }
        let last = geometry.dims().map(|n| (n - 1) as f64);
        let faces = if exact { box_of([0.0; 3], last).collect() } else { Vec::new() };
        Region { geometry, grains, clips, faces, steps: !exact && scene.mode.adds_up(), exact }
    }

    /// Whether a sample that the machine has is drawn, of a ray that moves by `step`.
    fn drawn(&self, place: [f64; 3], step: [f64; 3]) -> Drawn {
        let slack = self.slack(place) + REALS;
        let clipped = self.clips.iter().map(|clip| {
            let before = clip.before(place);
            let across = clip.normal[0] == 0.0 && clip.normal[1] == 0.0;
            let along = if self.geometry.perspective.is_none() || across { -clip.nearer(step) } else { 0.0 };
            let on_face = self.steps && along.abs() > REALS;
            match before {
                // On a face that rays enter by a sample is kept; on one that they leave by it is not.
                _ if on_face && before.abs() <= slack => {
                    if along > 0.0 {
                        Drawn::Yes
                    } else {
                        Drawn::No
                    }
                }
                _ if before.abs() <= slack + if self.steps { self.grains.clip[1] } else { 0.0 } => Drawn::Maybe,
                _ if before > 0.0 => Drawn::Yes,
                _ => Drawn::No,
            }
        });
        // A rounded weight may let a sample out of the box.
        let boxed = self.faces.iter().map(|face| if face.before(place) < -REALS { Drawn::Maybe } else { Drawn::Yes });
        clipped.chain(boxed).fold(Drawn::Yes, |all, one| match (all, one) {
            (Drawn::No, _) | (_, Drawn::No) => Drawn::No,
            (Drawn::Maybe, _) | (_, Drawn::Maybe) => Drawn::Maybe,
            _ => Drawn::Yes,
        })
    }

    /// How far the word of a distance is from it, at a place.
    fn slack(&self, place: [f64; 3]) -> f64 {
        self.grains.clip[0] * (4.0 + place.iter().map(|x| x.abs()).sum::<f64>()) + 3.0 * self.grains.place
    }

    /// The depths at which a ray through a place enters and leaves. A ray along a plane may meet it anywhere, in words, if it is on it.
    fn span(&self, place: [f64; 3], step: [f64; 3]) -> [Interval; 2] {
        let [mut enter, mut leave] = [f64::NEG_INFINITY, f64::INFINITY].map(Interval::point);
        if let Some(pass) = self.geometry.perspective.as_ref().filter(|pass| pass.first_depth > 0) {
            enter = Interval::point(pass.first_depth as f64 - pass.spacing[0] as f64 / pass.spacing[1] as f64);
        }
        let slack = self.slack(place);
        for plane in self.clips.iter().chain(&self.faces) {
            let (before, nearer) = (plane.before(place), plane.nearer(step));
            let along = nearer.abs() < if slack > 0.0 { ALONG } else { PARALLEL };
            if along && (slack == 0.0 || before.abs() > slack) {
                continue;
            }
            let [meets, off] = if along { [0.0, f64::INFINITY] } else { [before, slack].map(|by| by / nearer.abs()) };
            let reach = Interval::around(meets, off);
            if nearer > 0.0 || along {
                leave = leave.least(reach + Interval::point(place[2]));
            }
            if nearer < 0.0 || along {
                enter = enter.most(Interval::point(place[2]) - reach);
            }
        }
        [enter, leave]
    }

    /// Of the samples of a ray at these places, those that are drawn, and the steps that each stands for: from it towards the eye and away
    /// from it to halfway to the next one, or, at an end, as far as the ray goes.
    pub fn parts(&self, places: &[Option<[f64; 3]>], step: [f64; 3]) -> Vec<(Drawn, Interval)> {
        let drawn: Vec<Drawn> =
            places.iter().map(|place| place.map_or(Drawn::No, |place| self.drawn(place, step))).collect();
        let part = |k: usize| {
            let Some(place) = places[k].filter(|_| drawn[k] != Drawn::No && self.exact) else {
                return Interval::point(1.0);
            };
            let [enter, leave] = self.span(place, step);
            let here = Interval::point(place[2]);
            let before = self.reach(here - enter, &drawn[..k]);
            let behind = self.reach(leave - here, &drawn[k + 1..]);
            (before + behind).rising(|part| part.max(0.0))
        };
        (0..places.len()).map(|k| (drawn[k], part(k))).collect()
    }

    /// How far a sample reaches to a side on which these others are.
    fn reach(&self, end: Interval, others: &[Drawn]) -> Interval {
        let half = Interval::point(0.5);
        let rounding = self.grains.end[0];
        let most = if rounding > 0.0 { f64::from(EndRegisters::MOST_REACH) } else { f64::INFINITY };
        let end = end.wider(rounding).rising(|reach| reach.max(0.0).min(most));
        match (others.contains(&Drawn::Yes), others.contains(&Drawn::Maybe)) {
            (true, _) => half,
            (false, true) => half.or(end),
            (false, false) => end,
        }
    }
}
