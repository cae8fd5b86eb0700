//! Frames of a sequence follow each other without a gap, and what is torn shows two volumes.

use crate::sample;
use cube3_report::{
    AcquisitionReport, DigestReport, FrameReport, ReportError, RunReport, SequenceReport, TimingCounts, from_json,
    html, table, to_json,
};

fn frame(cycles: u64, end_cycle: u64, volumes: [u64; 2], newer_fraction: f64) -> FrameReport {
    FrameReport {
        angles_deg: Some([30.0, 7.0, 0.0]),
        cycles: Some(cycles),
        end_cycle: Some(end_cycle),
        volume: volumes[0],
        newest_volume: volumes[1],
        newer_fraction,
        torn: volumes[0] < volumes[1],
        mixed_beams: 5,
        first_torn_plane: None,
        error: None,
        footprint: None,
        remark: None,
        digest: DigestReport::default(),
    }
}

/// Two frames, the second of them torn.
fn report() -> RunReport {
    let mut report = sample::report();
    let counts = TimingCounts { frames: 2, ..report.timing.unwrap().counts() };
    report.timing = Some(counts.into());
    let first = counts.cycles / 3;
    report.sequence = Some(SequenceReport {
        fps_sustained: Some(488.0),
        time_s: Some(0.0041),
        playback_fps: Some(30.0),
        acquisition: Some(AcquisitionReport {
            mode: "dual-port".into(),
            words_per_cycle: 128.0,
            words_written: 4_000_000,
            volumes_written: 1,
            updates_per_s: 480.0,
            updates_per_s_limit: 488.0,
            stolen_cycles: 0,
            buffers: 1,
            torn_frames: 1,
        }),
        animation: Some("animation.png".into()),
        frames: vec![frame(first, first, [0, 0], 0.0), frame(counts.cycles - first, counts.cycles, [0, 1], 0.25)],
    });
    report
}

#[test]
fn a_sequence_is_checked_written_read_and_told() {
    let report = report();
    report.check().unwrap();
    let text = to_json(&report).unwrap();
    assert_eq!(from_json(&text).unwrap(), report);
    let plain = to_json(&sample::report()).unwrap();
    assert!(!plain.contains("\"sequence\"") && !plain.contains("\"frames\""), "a single run has neither key");
    assert_eq!(from_json(&plain).unwrap().timing.unwrap().frames, 1);
    let table = table(&report);
    assert!(table.contains("1, up to 25 % of newer voxels") && table.contains("480, at most 488"), "{table}");
    let page = html(&report, &[]);
    assert!(page.contains("0 to 1") && page.contains("25 %"));
}

#[test]
fn means_are_over_the_frames() {
    let (one, two) = (sample::report().timing.unwrap(), report().timing.unwrap());
    assert_eq!(two.fps, 2.0 * one.fps);
    assert_eq!(two.fps_sustained, one.fps_sustained, "the interval is measured");
    assert_eq!(two.frame_time_s, one.frame_time_s / 2.0);
    assert_eq!(two.samples_per_s, one.samples_per_s);
}

#[test]
fn a_gap_between_frames_and_a_tear_that_is_none_are_found() {
    type Break = fn(&mut SequenceReport);
    let breaks: [(Break, &str); 6] = [
        (|s| s.frames[0].cycles = Some(1), "sequence.frames[].end_cycle"),
        (|s| s.frames.truncate(1), "timing.frames"),
        (|s| s.frames[1].torn = false, "sequence.frames[].torn"),
        (|s| s.frames[0].newer_fraction = 0.5, "sequence.frames[].newer_fraction"),
        (|s| s.acquisition = None, "sequence.acquisition.torn_frames"),
        (|s| s.time_s = Some(f64::NAN), "sequence.time_s"),
    ];
    for (damage, place) in breaks {
        let mut report = report();
        report.sequence.as_mut().map(damage).unwrap();
        let error = report.check().unwrap_err();
        assert!(matches!(error, ReportError::Inconsistent { .. } | ReportError::NotFinite { .. }), "{error}");
        assert!(error.to_string().contains(place), "{place}: {error}");
    }
}
