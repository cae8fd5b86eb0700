//! Draws the house and lists its rooms: `cargo run --release -p cube3-tests --bin house -- house.svg [METADATA.json]`.
//!
//! Without metadata of another tree, what `cargo metadata --no-deps --format-version 1` says, it is that of this workspace.

use cube3_tests::house::House;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut words = std::env::args().skip(1);
    let drawing = words.next().ok_or("give a file for the drawing")?;
    let house = match words.next() {
        Some(metadata) => House::of_metadata(&std::fs::read_to_string(metadata)?)?,
        None => House::of_workspace()?,
    };
    std::fs::write(&drawing, house.drawing("the rooms, and which they use"))?;
    println!("| room | uses | lines | public items |\n| --- | --- | --- | --- |");
    let sizes = house.sizes()?;
    for (room, uses) in &house.uses {
        let uses: Vec<&str> = uses.iter().map(String::as_str).collect();
        let size = sizes.get(room.as_str()).copied().unwrap_or_default();
        println!("| `{room}` | {} | {} | {} |", uses.join(", "), size.lines, size.public);
    }
    Ok(())
}
