//! Kept pictures: found by what they were made of, and by nothing else.

use cube3_inputs::{LoadedVolume, load_volume};
use cube3_machine::MachineSpec;
use cube3_method::{Cache, Choice, Kept, Subject};
use cube3_picture::Rendering;
use cube3_scene::{Image, Scene, VolumeSource};
use cube3_volume::{ReadOptions, Samples};
use std::fs::{read, read_dir, write};

fn scene() -> Scene {
    let image = Image { width_px: 12, height_px: 9, pixel_size_voxel: None };
    Scene { volume: VolumeSource::from_phantom("sphere", 10), image, ..Scene::default() }
}

fn load(scene: &Scene) -> LoadedVolume {
    load_volume(scene, &MachineSpec::default(), &ReadOptions::default(), false).unwrap()
}

fn kept(cache: &Cache, text: &str, scene: &Scene, volume: &LoadedVolume) -> Kept {
    let (choice, machine): (Choice, _) = (text.parse().unwrap(), MachineSpec::default());
    cache.render(&choice, &Subject::new(scene, &machine, volume), &|_, _, _| {}).unwrap()
}

/// But for its times.
fn same(a: &Rendering, b: &Rendering) -> bool {
    (&a.picture, &a.bound, a.samples, a.bytes) == (&b.picture, &b.bound, b.samples, b.bytes)
}

#[test]
fn a_picture_is_made_once_and_found_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::at(folder.path().join("made"));
    let (scene, volume) = (scene(), load(&scene()));
    let files = || read_dir(folder.path().join("made")).map_or(0, Iterator::count);
    let first = kept(&cache, "converged:1e-4", &scene, &volume);
    assert_eq!((first.made_s, files()), (None, 1));
    let again = kept(&cache, "converged:1e-4", &scene, &volume);
    assert!(same(&first.rendering, &again.rendering) && again.made_s == Some(first.rendering.seconds()));
    // Where the volume is from changes no pixel.
    let renamed = Scene { volume: VolumeSource::from_phantom("sphere", 11), ..scene.clone() };
    assert!(kept(&cache, "converged:1e-4", &renamed, &volume).made_s.is_some());
    assert_eq!(files(), 1);

    let turned = Scene { background: [0.5; 3], ..scene.clone() };
    let mut other = load(&scene);
    let Samples::U16(samples) = &mut other.data.samples else { panic!("{:?}", other.data.sample_type()) };
    samples[0] += 1;
    let mut wider = load(&scene);
    wider.data.spacing[1] *= 2.0;
    let mut edged = load(&scene);
    edged.words.window[0] -= 1.0;
    for (text, scene, volume) in [
        ("converged:1e-5", &scene, &volume),
        ("converged:1e-4", &turned, &volume),
        ("converged:1e-4", &scene, &other),
        ("converged:1e-4", &scene, &wider),
        ("converged:1e-4", &scene, &edged),
    ] {
        let before = files();
        assert_eq!(kept(&cache, text, scene, volume).made_s, None);
        assert_eq!(files(), before + 1);
    }
    assert_eq!((kept(&cache, "image-order", &scene, &volume).made_s, files()), (None, 6));
}

#[test]
fn a_damaged_file_is_made_anew_and_a_folder_that_cannot_be_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let cache = Cache::at(folder.path());
    let (scene, volume) = (scene(), load(&scene()));
    let first = kept(&cache, "converged:1e-3", &scene, &volume).rendering;
    let path = read_dir(folder.path()).unwrap().next().unwrap().unwrap().path();
    let whole = read(&path).unwrap();
    let mut wrong = whole.clone();
    wrong[whole.len() / 2] ^= 1;
    for damaged in [vec![], whole[..20].to_vec(), whole[..whole.len() - 1].to_vec(), wrong] {
        write(&path, damaged).unwrap();
        let made = kept(&cache, "converged:1e-3", &scene, &volume);
        assert!(made.made_s.is_none() && same(&made.rendering, &first));
        assert_eq!(read(&path).unwrap().len(), whole.len());
    }
    let taken = folder.path().join("file");
    write(&taken, "no folder").unwrap();
    let told = kept(&Cache::at(&taken), "converged:1e-3", &scene, &volume);
    assert!(same(&told.rendering, &first) && told.unkept.is_some_and(|why| why.contains("file")));
}
