//! Every cycle and every token is accounted for.

use crate::sample;
use cube3_cases::cases;
use cube3_report::{ReportError, TimingCounts, TimingReport};
use proptest::prelude::*;

#[test]
fn a_sound_report_passes() {
    sample::report().check().unwrap();
}

#[test]
fn a_lost_cycle_is_found_whatever_its_kind() {
    for kind in 0..4 {
        let mut report = sample::report();
        let unit = &mut report.units[0];
        match kind {
            0 => unit.busy -= 1,
            1 => unit.starved += 1,
            2 => unit.blocked -= 1,
            _ => *unit.waiting.get_mut("refresh").unwrap() += 1,
        }
        let error = report.check().unwrap_err();
        assert!(matches!(error, ReportError::UnitCycles { cycles: 18_207, .. }), "{error}");
        assert!(error.to_string().contains("cfb"), "{error}");
    }
}

#[test]
fn a_reorder_buffer_holds_no_more_than_it_can_and_all_that_was_read() {
    fn buffer(report: &mut cube3_report::RunReport) -> &mut cube3_report::ReorderTraffic {
        report.traffic.as_mut().unwrap().reorder.as_mut().unwrap()
    }
    let mut full = sample::report();
    buffer(&mut full).peak_words = buffer(&mut full).words + 1;
    assert!(full.check().unwrap_err().to_string().contains("traffic.reorder.peak_words"));
    let mut lost = sample::report();
    buffer(&mut lost).mini_blocks -= 1;
    assert!(lost.check().unwrap_err().to_string().contains("traffic.memory.words"));
}

#[test]
fn counters_at_their_limit_do_not_wrap_round_to_a_sound_sum() {
    let mut report = sample::report();
    let unit = &mut report.units[1];
    (unit.busy, unit.starved, unit.blocked) = (u64::MAX, 18_208, 0);
    assert!(matches!(report.check(), Err(ReportError::UnitCycles { .. })));
    let channel = &mut report.channels[0];
    (channel.pushes, channel.pops, channel.occupancy) = (0, u64::MAX, 1);
    report.units.clear();
    assert!(matches!(report.check(), Err(ReportError::ChannelTokens { .. })));
}

#[test]
fn a_lost_token_is_found() {
    let mut report = sample::report();
    report.channels[1].pops -= 1;
    let error = report.check().unwrap_err();
    assert!(error.to_string().contains("channel aligned took 16384 tokens"), "{error}");
    report.channels[1].occupancy += 1;
    report.check().unwrap();
}

#[test]
fn a_channel_cannot_hold_more_than_its_capacity() {
    let mut report = sample::report();
    report.channels[2].max_occupancy = 9;
    assert!(matches!(report.check(), Err(ReportError::ChannelOccupancy { .. })));
}

#[test]
fn a_mean_above_the_largest_is_found() {
    let mut report = sample::report();
    report.channels[2].mean_occupancy = 8.1;
    assert!(matches!(report.check(), Err(ReportError::ChannelOccupancy { .. })));
}

#[test]
fn a_rate_that_does_not_follow_from_the_cycles_is_found() {
    let mut report = sample::report();
    report.timing.as_mut().unwrap().fps *= 1.001;
    let error = report.check().unwrap_err();
    assert!(matches!(error, ReportError::Inconsistent { key: "timing.fps", .. }), "{error}");
}

#[test]
fn counters_without_a_clock_are_found() {
    let mut report = sample::report();
    report.timing = None;
    assert!(matches!(report.check(), Err(ReportError::UnitsWithoutTiming { units: 7 })));
}

#[test]
fn a_stopped_clock_is_found() {
    let mut report = sample::report();
    let counts = report.timing.unwrap().counts();
    report.timing = Some(TimingCounts { clock_hz: 0.0, ..counts }.into());
    assert!(matches!(report.check(), Err(ReportError::NotFinite { .. })));
}

#[test]
fn cube_3_at_125_ns_gives_its_thirty_frames() {
    let timing: TimingReport = TimingCounts {
        frames: 1,
        cycles: 512 * 512,
        clock_hz: 8e6,
        beams: 512 * 512,
        samples: 512 * 512 * 512,
        ray_slots: 512 * 512,
        fill_cycles: 0,
        frame_interval_cycles: 512 * 512,
    }
    .into();
    assert_eq!(timing.fps, 30.517_578_125);
    assert_eq!(timing.fps_sustained, timing.fps);
    assert_eq!(timing.samples_per_s, 4.096e9);
}

proptest! {
    #![proptest_config(cases(256))]

    #[test]
    fn derived_times_always_pass_the_check(
        cycles in 0_u64..u64::MAX, clock_hz in 1e-3_f64..1e12, samples: u64, fill_cycles: u64,
        frame_interval_cycles: u64,
    ) {
        let mut report = sample::report();
        report.units.clear();
        let counts =
            TimingCounts { frames: 1, cycles, clock_hz, beams: 1, samples, ray_slots: 1, fill_cycles, frame_interval_cycles };
        report.timing = Some(counts.into());
        prop_assert!(report.check().is_ok());
    }
}

#[test]
fn a_mean_beyond_the_largest_and_a_bias_beyond_the_mean_are_found() {
    type Break = fn(&mut cube3_metrics::ImageError);
    let breaks: [(Break, &str); 3] = [
        (|error| error.mean_relative = 1.01 * error.max, "error.mean_relative"),
        (|error| error.percentile_99 = 1.01 * error.max, "error.percentile_99"),
        (|error| error.bias = -1.01 * error.mean_relative, "error.bias"),
    ];
    for (damage, place) in breaks {
        let mut report = sample::report();
        damage(report.error.as_mut().unwrap().footprint.error.as_mut().unwrap());
        let error = report.check().unwrap_err();
        assert!(matches!(error, ReportError::Inconsistent { key, .. } if key == place), "{error}");
    }
}
