//! The two fast ways to run a machine: *timing* of a 512³ frame, and *function* of the head with everything visible.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use cube3_function::{CanonicalVolume, render};
use cube3_host::{VolumeInfo, frame_setup};
use cube3_inputs as inputs;
use cube3_machine::MachineSpec;
use cube3_pipeline::Machine;
use cube3_scene::{Scene, VolumeSource};
use cube3_volume::ReadOptions;
use std::hint::black_box;

fn timing(c: &mut Criterion) {
    let machine = inputs::machine("cube3-512").unwrap();
    let volume = VolumeInfo { dims: [512; 3], spacing: [1.0; 3], window: [0.0, 255.0] };
    let setup = frame_setup(&Scene::default(), &machine, &volume, true).unwrap().setup;
    let mut group = c.benchmark_group("timing");
    group.throughput(Throughput::Elements(512 * 512));
    group.bench_function("a frame of 512 cubed, slots", |b| {
        b.iter(|| {
            let mut run = Machine::timing(&machine, vec![black_box(&setup).clone()]).unwrap();
            run.run(&|_, _| {}).unwrap();
            run.counters().cycles
        });
    });
    group.finish();
}

fn function(c: &mut Criterion) {
    let size = 128;
    let machine = MachineSpec::default();
    let mut scene = Scene { volume: VolumeSource::from_phantom("head", size), ..Scene::default() };
    let mut group = c.benchmark_group("function");
    for (name, visible) in [("head, samples", false), ("every sample visible, samples", true)] {
        if visible {
            scene.transfer.opacity = vec![[0.0, 0.05], [255.0, 0.05]];
        }
        let volume = inputs::load_volume(&scene, &machine, &ReadOptions::default(), false).unwrap();
        let setup = frame_setup(&scene, &machine, &volume.info(), true).unwrap().setup;
        let turned = CanonicalVolume::new(&setup.geometry.axes, volume.words.dims, &volume.words.words);
        group.throughput(Throughput::Elements(setup.geometry.sample_count()));
        group.bench_function(name, |b| b.iter(|| render(black_box(&setup), &turned, true, &|_, _| {})));
    }
    group.finish();
}

criterion_group!(benches, timing, function);
criterion_main!(benches);
