//! A sequence of frames: how each went, and what it saw of volumes that came in.

use cube3_metrics::ImageError;
use serde::{Deserialize, Serialize};

use crate::DigestReport;
use crate::fact::Fact;
use crate::measures;
use crate::quantity::{count, number, percentage, prefixed};

/// A sequence of frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SequenceReport {
    /// Frames per second from the end of the first frame to the end of the last: what the viewer sees; for one frame,
    /// from its start. Absent when no clock ran.
    pub fps_sustained: Option<f64>,
    /// Time of all frames at the machine's clock, in seconds. Absent when no clock ran.
    pub time_s: Option<f64>,
    /// Frames per second at which the animation plays. Absent when there are no pictures.
    pub playback_fps: Option<f64>,
    /// What came in through the acquisition port. Absent when the volume stands still or no clock ran.
    pub acquisition: Option<AcquisitionReport>,
    /// The animation's file beside the report. Absent when there are no pictures, or the library was called.
    #[serde(default)]
    pub animation: Option<String>,
    /// Each frame, in order.
    pub frames: Vec<FrameReport>,
}

/// What came in through the acquisition port while the frames were read.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AcquisitionReport {
    /// `dual-port`, `cycle-stealing` or `double-buffer`.
    pub mode: String,
    /// Words that come in with a cycle: those of the machine file, or as many as the modules take.
    pub words_per_cycle: f64,
    /// Words written.
    pub words_written: u64,
    /// Volumes written whole.
    pub volumes_written: u64,
    /// Sustained update rate: words written over the words of a volume and the time of all frames, in volumes per second.
    pub updates_per_s: f64,
    /// The update rate of a port that never waits: clock_hz · words_per_cycle / voxels.
    pub updates_per_s_limit: f64,
    /// Cycles in which a write kept a beam from being read.
    pub stolen_cycles: u64,
    /// Volumes that the frame buffer has room for.
    pub buffers: u32,
    /// Frames that show more than one volume.
    pub torn_frames: usize,
}

/// One frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FrameReport {
    /// Yaw, tilt and roll in degrees. Absent for a view by its direction.
    pub angles_deg: Option<[f64; 3]>,
    /// Cycles since the end of the frame before. Absent when no clock ran.
    pub cycles: Option<u64>,
    /// Cycles from the first fetch of the first frame to the last pixel of this one.
    pub end_cycle: Option<u64>,
    /// The oldest volume that the frame shows, from 0: the one that the reference shows.
    pub volume: u64,
    /// The newest volume that the frame shows.
    pub newest_volume: u64,
    /// Share of the voxels that are of newer volumes than the oldest, 0 to 1.
    pub newer_fraction: f64,
    /// Whether the frame shows more than one volume.
    pub torn: bool,
    /// Beams with voxels of two volumes.
    pub mixed_beams: u64,
    /// The first plane of rays, in the order in which they are read, by whose end voxels of two volumes had been read.
    pub first_torn_plane: Option<u32>,
    /// The picture against the reference of the oldest volume. Absent when not measured.
    pub error: Option<ImageError>,
    /// The same over the object alone.
    #[serde(default)]
    pub footprint: Option<ImageError>,
    /// Why there is no error, where there were two pictures and nothing to measure.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub remark: Option<String>,
    /// The raw pixels. Absent without pictures.
    pub digest: DigestReport,
}

impl SequenceReport {
    /// Every number that must be finite, with its key.
    pub(crate) fn numbers(&self) -> Vec<(&'static str, f64)> {
        let mut numbers = vec![
            ("sequence.fps_sustained", self.fps_sustained.unwrap_or_default()),
            ("sequence.time_s", self.time_s.unwrap_or_default()),
            ("sequence.playback_fps", self.playback_fps.unwrap_or_default()),
        ];
        if let Some(acquisition) = &self.acquisition {
            numbers.push(("sequence.acquisition.words_per_cycle", acquisition.words_per_cycle));
            numbers.push(("sequence.acquisition.updates_per_s", acquisition.updates_per_s));
            numbers.push(("sequence.acquisition.updates_per_s_limit", acquisition.updates_per_s_limit));
        }
        for frame in &self.frames {
            numbers.extend(frame.angles_deg.unwrap_or_default().map(|angle| ("sequence.frames[].angles_deg", angle)));
            numbers.push(("sequence.frames[].newer_fraction", frame.newer_fraction));
            for (key, error) in
                [("sequence.frames[].error", &frame.error), ("sequence.frames[].footprint", &frame.footprint)]
            {
                numbers.extend(error.iter().flat_map(measures::finite).map(|(_, measure)| (key, measure)));
            }
        }
        numbers
    }

    /// The sequence in words.
    pub(crate) fn facts(&self) -> Vec<Fact> {
        let mut facts = vec![("Frames", count(self.frames.len() as u64))];
        if let (Some(fps), Some(time)) = (self.fps_sustained, self.time_s) {
            facts.push(("Frames per second", format!("{}, all in {}", number(fps), prefixed(time, "s"))));
        }
        if let Some(acquisition) = &self.acquisition {
            let AcquisitionReport { updates_per_s, updates_per_s_limit, stolen_cycles, .. } = acquisition;
            let words = number(acquisition.words_per_cycle);
            facts.push(("Acquisition", format!("{}, {words} words a cycle", acquisition.mode)));
            let rate = format!("{}, at most {}", number(*updates_per_s), number(*updates_per_s_limit));
            facts.push(("Volumes per second", rate));
            facts.push(("Cycles taken from reads", count(*stolen_cycles)));
            let newer = self.frames.iter().map(|frame| frame.newer_fraction).fold(0.0, f64::max);
            let torn = match acquisition.torn_frames {
                0 => "none".into(),
                torn => format!("{}, up to {} of newer voxels", count(torn as u64), percentage(newer)),
            };
            facts.push(("Torn frames", torn));
        }
        let worst = self.worst().map(|(frame, error)| format!("{}, frame {frame}", percentage(error.mean_relative)));
        let remark = self.frames.iter().find_map(|frame| frame.remark.clone());
        if let Some(worst) = worst.or(remark) {
            facts.push(("Largest mean error over the object", worst));
        }
        facts
    }

    /// The frame whose object is furthest from its reference on the average, the earliest of equals, and its error over the object.
    pub(crate) fn worst(&self) -> Option<(usize, &ImageError)> {
        let errors =
            self.frames.iter().enumerate().filter_map(|(index, frame)| Some((index, frame.footprint.as_ref()?)));
        errors.reduce(|worst, next| if next.1.mean_relative > worst.1.mean_relative { next } else { worst })
    }
}

impl FrameReport {
    /// The mean error over the object, or why there is none.
    pub(crate) fn error_in_words(&self) -> String {
        let measured = self.footprint.as_ref().map(|error| percentage(error.mean_relative));
        measured.or_else(|| self.remark.clone()).unwrap_or_default()
    }
}
