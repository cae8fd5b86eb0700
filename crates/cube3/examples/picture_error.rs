//! A picture with its error and its time, by every method that can show the scene: `cargo run --release -p cube3 --example picture_error`.

use cube3::{Choice, METHODS, Machine, Scene, compare, load};
use cube3_scene::{View, VolumeSource};
use std::error::Error;

/// Prints error over the object and seconds of each method, against image order in steps of a quarter of a voxel.
pub fn main() -> Result<(), Box<dyn Error>> {
    let scene = Scene {
        volume: VolumeSource::from_phantom("head", 40),
        view: View { yaw_deg: 20.0, tilt_deg: 7.0, ..View::default() },
        ..Scene::default()
    };
    let machine = Machine { lanes: 40, ..Machine::default() };
    let volume = load(&scene, &machine)?;
    let able = METHODS.iter().filter(|method| method.check(&scene).is_ok());
    let choices: Vec<Choice> = able.map(|method| Choice::of(method)).collect();
    let reference: Choice = "image-order:0.25".parse()?;
    println!("{:<14} {:>8} {:>8} {:>9}   against {reference}", "method", "mean", "largest", "time");
    for compared in compare(&choices, &reference, &scene, &machine, &volume, &|_, _, _| {})? {
        let error = compared.error.footprint.ok_or("the scene shows nothing")?;
        println!(
            "{:<14} {:>6.2} % {:>8.3} {:>7.1} ms",
            compared.choice.to_string(),
            100.0 * error.mean_relative,
            error.max,
            1000.0 * compared.rendering.seconds()
        );
    }
    Ok(())
}
