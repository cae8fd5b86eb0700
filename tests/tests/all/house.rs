//! The rooms of the workspace and the arrows between them.

use cube3_tests::house::House;

#[test]
fn a_room_uses_rooms_below_it_alone() {
    let faults = House::of_workspace().unwrap().faults();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn arrows_upwards_and_through_walls_are_found() {
    let mut house = House::of_workspace().unwrap();
    for (room, used) in [("cfb", "host"), ("word", "scene"), ("scene", "machine"), ("cone", "vectors")] {
        house.uses.get_mut(room).unwrap().insert(used.into());
    }
    house.uses.remove("report");
    let faults = house.faults();
    let names = |words: &str| faults.iter().any(|fault| fault.starts_with(words));
    assert!(names("cfb uses host: "), "{faults:?}");
    assert!(names("word uses scene, which is not below it"));
    assert!(names("scene uses machine, which is not below it"));
    assert!(names("cone uses vectors, which is not below it"));
    assert!(names("report is not there"));
}

#[test]
fn the_drawing_in_the_book_is_this_house() {
    let house = House::of_workspace().unwrap();
    let book = include_str!("../../../docs/src/images/house.svg");
    assert_eq!(
        house.drawing("the rooms, and which they use"),
        book,
        "cargo run --release -p cube3-tests --bin house -- docs/src/images/house.svg"
    );
}
