//! A made-up report with something in every field, for the tests and the example.

use std::collections::BTreeMap;

use cube3_machine::OperatorCounts;
use cube3_metrics::{ImageComparison, ImageError};
use cube3_report::*;
use serde_json::json;

const CYCLES: u64 = 18_207;

pub fn report() -> RunReport {
    RunReport {
        schema: SCHEMA,
        program: Program { name: "cube3".into(), version: "0.1.0".into() },
        command: ["cube3", "run", "--scene", "my head.toml", "--machine", "cube3-128"].map(String::from).to_vec(),
        sources: SourcesReport {
            scene_file: Some("my head.toml".into()),
            machine_file: None,
            machine_preset: Some("cube3-128".into()),
        },
        fidelity: "timing + function".into(),
        seed: 3,
        scene: json!({
            "name": "Head phantom, bone and skin",
            "view": {"yaw_deg": 30.0, "tilt_deg": 7.0},
            "mode": "composite",
            "opacity": [[0, 0.0], [900, 0.0], [1200, 0.6]],
        }),
        machine: json!({"name": "cube3-128", "lanes": 128, "clock_hz": 8e6, "abc": {"gradient": "12"}}),
        volume: VolumeReport {
            source: "phantom head".into(),
            dims: [128, 128, 128],
            spacing: [1.0, 1.0, 1.0],
            conversion: "window 0 to 1 -> 16-bit words, 65535 words per unit, rounded to nearest".into(),
            window: [0.0, 1.0],
            word_bits: 16,
            scale: Some(65_535.0),
            clipped_below: 0,
            clipped_above: 17,
            masked: 0,
            axes: None,
        },
        view: ViewReport {
            sides: None,
            major_axis: "z".into(),
            flips: [false, true, false],
            slopes: [0.577_350_269_189_625_8, 0.141_775],
            offset: 0.5,
            template_rule: "plane floor".into(),
            base_plane_size: [202, 146],
            perspective: None,
        },
        plan: PlanReport {
            enabled: true,
            left_out: vec![
                LeftOut {
                    rule: "half-spaces".into(),
                    what: "cut planes".into(),
                    why: "the scene has none".into(),
                    saves: "6 comparators in each of 128 lanes".into(),
                    savings: SavingsReport {
                        operators_per_lane: OperatorCounts::new(0, 0, 6),
                        ..SavingsReport::default()
                    },
                },
                LeftOut {
                    what: "1,204 beams".into(),
                    why: "every voxel in them has opacity 0 under the transfer function".into(),
                    saves: "7.3 % of the fetches".into(),
                    ..LeftOut::default()
                },
            ],
        },
        timing: Some(
            TimingCounts {
                frames: 1,
                cycles: CYCLES,
                clock_hz: 8e6,
                beams: 16_384,
                samples: 2_064_384,
                ray_slots: 16_384,
                fill_cycles: 214,
                frame_interval_cycles: 16_396,
            }
            .into(),
        ),
        limits: Some(LimitsReport {
            critical: "memory".into(),
            fps: 439.4,
            fps_without: Some(520.5),
            next: Some("bus".into()),
            sentence: "memory: 439.4 frames/s; without it 520.5, then the bus limits".into(),
            without: vec![
                LimitWithout { resource: "memory".into(), replaced_by: "a word in every cycle".into(), fps: 520.5 },
                LimitWithout { resource: "bus".into(), replaced_by: "a channel for each lane".into(), fps: 439.4 },
            ],
        }),
        resources: Some(resources()),
        traffic: Some(TrafficReport {
            memory: Some(MemoryTraffic {
                words: 2_097_152,
                reads: 524_288,
                row_hits: 507_904,
                row_misses: 128,
                row_conflicts: 16_256,
                refreshes: 1_024,
            }),
            reorder: Some(ReorderTraffic { words: 139_264, peak_words: 133_120, rows: 16_384, mini_blocks: 262_144 }),
            bus_words: 2_097_152,
            bus_slots: 2_330_496,
            link_words: 65_536,
            link_peak_words: 31,
            ray_words: [16_384, 8_192, 4_096],
            links: [("forwards", 50_176), ("backwards", 44_032)]
                .map(|(direction, words)| LinkReport {
                    link: 1,
                    direction: direction.into(),
                    words,
                    slots: Some(65_536),
                    peak_words: 97,
                })
                .to_vec(),
            host_pixels: 29_346,
            host_bytes: 234_768,
        }),
        units: vec![
            unit("cfb", 16_384, 0, 1_003, &[("memory", 700), ("refresh", 120)]),
            unit("bus", 16_384, 1_823, 0, &[]),
            unit("dsb.write", 16_384, 1_523, 300, &[]),
            unit("dsb.read", 16_384, 1_823, 0, &[]),
            unit("trilin", 16_384, 1_823, 0, &[]),
            unit("abc", 15_180, 3_027, 0, &[]),
            unit("cone", 4_100, 14_107, 0, &[]),
        ],
        channels: vec![
            channel("beams", ["cfb", "bus"], 4, 2, 16_384, 3.4),
            channel("aligned", ["bus", "dsb.write"], 4, 2, 16_384, 1.1),
            channel("rays", ["dsb.read", "trilin"], 8, 3, 16_384, 2.7),
        ],
        words: WordsReport {
            overflows: [("abc.colour".into(), 12), ("cone.opacity".into(), 0)].into(),
            opacity: Some(opacity()),
        },
        error: Some(ErrorReport {
            gradient_mean_deg: Some(3.1),
            ..ErrorReport::new("image-order, step 1", &comparison(), 5.0)
        }),
        digest: DigestReport { base_plane: Some(sha256_hex(b"base plane")), image: Some(sha256_hex(b"image")) },
        sequence: None,
        wall: WallReport {
            volume_s: Some(0.4),
            timing_s: Some(0.0031),
            function_s: Some(0.021),
            cycle_s: None,
            reference_s: Some(1.94),
            total_s: Some(2.6),
            samples_per_s: Some(9.8e7),
            threads: Some(2),
        },
    }
}

fn unit(name: &str, busy: u64, starved: u64, blocked: u64, waiting: &[(&str, u64)]) -> UnitReport {
    let waiting: BTreeMap<String, u64> = waiting.iter().map(|&(reason, cycles)| (reason.to_string(), cycles)).collect();
    UnitReport { name: name.into(), busy, starved, blocked, waiting }
}

fn channel(
    name: &str,
    joins: [&str; 2],
    capacity: u64,
    latency: u64,
    pushes: u64,
    mean_occupancy: f64,
) -> ChannelReport {
    let [from, to] = joins.map(String::from);
    ChannelReport {
        name: name.into(),
        from,
        to,
        capacity,
        latency,
        pushes,
        pops: pushes,
        occupancy: 0,
        max_occupancy: capacity,
        mean_occupancy,
    }
}

fn comparison() -> ImageComparison {
    let error = |scale: f64| ImageError {
        mean_relative: 0.0041 * scale,
        rms: 0.013_7 * scale,
        max: 0.172_549_019_607_843_14,
        psnr_db: Some(-20.0 * (0.013_7 * scale).log10()),
        fraction_off: 0.23 * scale,
        percentile_99: 0.041 * scale,
        bias: -0.001_2 * scale,
    };
    ImageComparison { whole: error(1.0), footprint: Some(error(2.2)), footprint_pixels: 9_412 }
}

fn opacity() -> OpacityReport {
    OpacityReport {
        entry_width: 0.0623,
        smallest_opacity: 1.0 / 4095.0,
        shown_fraction: 0.31,
        lost_fraction: 0.004,
        off_fraction: 0.021,
        rounding: OpacityChange { fraction: 0.02, ray_less: 0.003, ray_more: 0.001 },
        entries: OpacityChange { fraction: 0.001, ray_less: 0.0002, ray_more: 0.0 },
    }
}

fn resources() -> ResourcesReport {
    let each = OperatorCounts { multipliers: 3, adders: 9, comparators: 1, dividers: 0 };
    ResourcesReport {
        operators: vec![OperatorsReport { part: "trilin".into(), count: 128, each }],
        total: each.times(128),
        memory: vec![MemoryBits {
            what: "frame buffer".into(),
            counted: "2097152 voxels of 16 bits".into(),
            bits: 33_554_432,
        }],
        lines: vec![LinesReport { what: "bus lines".into(), counted: "128 channels of 16 bits".into(), lines: 2048 }],
        interfaces: vec![InterfaceReport {
            name: "memory to bus".into(),
            peak_bytes_per_s: Some(2.048e9),
            mean_bytes_per_s: 1.84e9,
        }],
        fps_per_memory_gb_per_s: 214.5,
        samples_per_s_per_multiplier: 2.1e6,
    }
}
