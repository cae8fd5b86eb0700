//! A pipe of N stages with 8-entry channels: v → 3v + 1, and a sink that XORs.
//!
//! The time is for 10⁶ tokens and five stages; throughput is unit-ticks (stages only) a second. The result and
//! the cycles of the full 10⁷ are checked once before.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use cube3_channel::{Channel, Pipe};
use std::hint::black_box;

const STAGES: usize = 5;

fn run(tokens: u32) -> (u32, u64) {
    let mut channels: Vec<Channel<u32>> = (0..=STAGES).map(|_| Channel::new("pipe", 8, 1).unwrap()).collect();
    let mut stages: Vec<_> = (0..STAGES).map(|_| Pipe::new(|v: u32| v.wrapping_mul(3).wrapping_add(1))).collect();
    let (mut sent, mut received, mut sum, mut cycles) = (0, 0, 0, 0);
    while received < tokens {
        if sent < tokens && channels[0].push(sent).is_ok() {
            sent += 1;
        }
        for (i, stage) in stages.iter_mut().enumerate() {
            let (before, after) = channels.split_at_mut(i + 1);
            stage.tick(&mut before[i], &mut after[0]);
        }
        if let Some(v) = channels[STAGES].pop() {
            sum ^= v;
            received += 1;
        }
        channels.iter_mut().for_each(Channel::commit);
        cycles += 1;
    }
    let busy: u64 = stages.iter().map(|stage| stage.account().busy).sum();
    assert_eq!(busy, u64::from(tokens) * STAGES as u64);
    (sum, cycles)
}

fn pipe(c: &mut Criterion) {
    let (sum, cycles) = run(10_000_000);
    assert_eq!(sum, 0xa9c5_3d00);
    assert!(cycles == 10_000_005 || cycles == 10_000_006, "{cycles}");
    let mut group = c.benchmark_group("channel");
    group.throughput(Throughput::Elements(1_000_006 * STAGES as u64));
    group.bench_function("pipe of five stages", |b| b.iter(|| run(black_box(1_000_000))));
    group.finish();
}

criterion_group!(benches, pipe);
criterion_main!(benches);
