//! Reading large files beside what their decompressor alone takes.
//!
//! The volume is a head with the noise of a scanner, u16; its side is 256, or `CUBE3_BENCH_SIDE`.

use std::fs::File;
use std::hint::black_box;
use std::io::{BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use cube3_volume::{Phantom, PhantomParams, RawLayout, ReadOptions, SampleType, read};
use flate2::Compression;
use flate2::bufread::MultiGzDecoder;
use flate2::write::GzEncoder;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

fn numbers(side: usize) -> Vec<u8> {
    let head = Phantom::Head.generate(side, &PhantomParams::default()).expect("a phantom");
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let noisy = head
        .to_f64()
        .into_iter()
        .flat_map(|value| (value as u16 * 16 + (random.next_u32() >> 28) as u16).to_le_bytes());
    noisy.collect()
}

fn packed(bytes: &[&[u8]]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    for bytes in bytes {
        packed.write_all(bytes).expect("memory");
    }
    packed.finish().expect("memory")
}

/// Unpacks a file from `skip` on into a buffer that is used again and again.
fn decompressor(path: &Path, skip: usize, buffer: &mut [u8]) -> usize {
    let mut file = BufReader::with_capacity(1 << 18, File::open(path).expect("the file"));
    std::io::copy(&mut (&mut file).take(skip as u64), &mut std::io::sink()).expect("the header");
    let (mut stream, mut all) = (MultiGzDecoder::new(file), 0);
    loop {
        match stream.read(buffer).expect("a good stream") {
            0 => return all,
            some => all += black_box(some),
        }
    }
}

/// The time that something takes, without that of giving its memory back.
fn timed<T>(times: u64, work: impl Fn() -> T) -> Duration {
    let mut taken = Duration::ZERO;
    for _ in 0..times {
        let start = Instant::now();
        let made = black_box(work());
        taken += start.elapsed();
        drop(made);
    }
    taken
}

fn benches(criterion: &mut Criterion) {
    let side: usize = std::env::var("CUBE3_BENCH_SIDE").ok().and_then(|side| side.parse().ok()).unwrap_or(256);
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let numbers = numbers(side);
    let nrrd = |directions: &str| {
        format!(
            "NRRD0004\ntype: ushort\ndimension: 3\nspace: RAS\nsizes: {side} {side} {side}\n\
             space directions: {directions}\nendian: little\nencoding: gzip\n\n"
        )
    };
    let mut nifti = vec![0u8; 352];
    for (at, bytes) in
        [(0, 348u16), (40, 3), (42, side as u16), (44, side as u16), (46, side as u16), (70, 512), (72, 16)]
    {
        nifti[at..at + 2].copy_from_slice(&bytes.to_le_bytes());
    }
    for at in [76, 80, 84, 88] {
        nifti[at..at + 4].copy_from_slice(&1f32.to_le_bytes());
    }
    nifti[344..348].copy_from_slice(b"n+1\0");
    let write = |name: &str, bytes: &[u8]| std::fs::write(at(name), bytes).expect("a written file");
    let gz = packed(&[&numbers]);
    let turns = [
        ("straight", "(1,0,0) (0,1,0) (0,0,1)"),
        ("LPS", "(-1,0,0) (0,-1,0) (0,0,1)"),
        ("PIR", "(0,-1,0) (0,0,-1) (1,0,0)"),
    ];
    for (name, directions) in turns {
        write(&format!("{name}.nrrd"), &[nrrd(directions).as_bytes(), &gz].concat());
    }
    write("t.nii.gz", &packed(&[&nifti, &numbers]));
    write("t.raw", &numbers);
    let raw = Some(RawLayout::new([side; 3], SampleType::U16));
    let options = ReadOptions { raw, ..ReadOptions::default() };

    let mut group = criterion.benchmark_group("reading");
    group.sample_size(10).throughput(Throughput::Bytes(numbers.len() as u64));
    drop(numbers);
    let mut buffer = vec![0; 1 << 20];
    let header = nrrd(turns[0].1).len();
    group.bench_function("decompressor alone", |b| {
        b.iter(|| decompressor(&at("straight.nrrd"), header, &mut buffer));
    });
    let mut reading = |name: &str, path: PathBuf| {
        group
            .bench_function(name, |b| b.iter_custom(|times| timed(times, || read(&path, &options).expect("a volume"))));
    };
    reading("NRRD gzip", at("straight.nrrd"));
    reading("NRRD gzip, two axes turned round", at("LPS.nrrd"));
    reading("NRRD gzip, slices become columns", at("PIR.nrrd"));
    reading("NIfTI gzip", at("t.nii.gz"));
    reading("raw", at("t.raw"));
    group.bench_function("a file into memory", |b| {
        b.iter_custom(|times| timed(times, || std::fs::read(at("t.raw")).expect("the file")))
    });
}

criterion_group!(reading, benches);
criterion_main!(reading);
