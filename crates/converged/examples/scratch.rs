use cube3_converged::*;
use cube3_reference::*;
use cube3_scene::*;
fn main() {
    let tol: f64 = std::env::args().nth(1).unwrap().parse().unwrap();
    let step: f64 = std::env::args().nth(2).unwrap().parse().unwrap();
    let n: usize = std::env::args().nth(3).unwrap().parse().unwrap();
    let every: usize = std::env::args().nth(4).unwrap().parse().unwrap();
    let volume = cube3_volume::Phantom::Head.generate(n, &Default::default()).unwrap();
    let mut scene = Scene::default();
    scene.image.width_px = 300;
    scene.image.height_px = 300;
    let t = std::time::Instant::now();
    if let Ok(at) = std::env::var("PIXEL") {
        let v: Vec<f64> = at.split(",").map(|x| x.parse().unwrap()).collect();
        let _ = v;
    }
    let c =
        converged(&volume, &scene, &ConvergedOptions { tolerance: tol, every, ..Default::default() }, None).unwrap();
    let tc = t.elapsed();
    let bad: Vec<(usize, f64)> = c.bounds.iter().copied().enumerate().filter(|(_, b)| *b > tol).collect();
    println!(
        "{} px, {} evaluations, {tc:?}, over: {} worst {:?}",
        c.bounds.len(),
        c.evaluations,
        bad.len(),
        bad.iter().map(|b| b.1).fold(0.0, f64::max)
    );
    for b in bad.iter().take(10) {
        println!("{:?} {:?}", c.picture.place(b.0), b.1);
    }
    if step > 0.0 {
        let r =
            image_order(&volume, &scene, &ImageOrderOptions { step_voxel: step, every, ..Default::default() }, None)
                .unwrap();
        let mut worst = (0.0, 0, 0.0);
        for i in 0..c.bounds.len() {
            let d = (0..3).map(|k| (c.picture.pixels[i][k] - r.picture.pixels[i][k]).abs()).fold(0.0, f64::max);
            if d > worst.0 {
                worst = (d, i, c.bounds[i]);
            }
        }
        println!("worst against image order {worst:?} {:?}", c.picture.place(worst.1));
    }
}
