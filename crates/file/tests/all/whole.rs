//! Files appear whole, or what was there stays.

use cube3_file::{WholeFile, write_whole};
use std::fs;
use std::io::Write;
use std::path::Path;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_file_takes_the_place_of_the_one_before() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.json");
    for text in ["first", "second, longer", ""] {
        write_whole(&path, text.as_bytes()).unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), text);
        assert_eq!(names(folder.path()), ["a.json"]);
    }
}

#[test]
fn what_is_not_kept_leaves_the_old_file_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hex");
    write_whole(&path, b"old").unwrap();
    let mut file = WholeFile::new(&path).unwrap();
    file.write_all(b"half of").unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"old");
    drop(file);
    assert_eq!(names(folder.path()), ["a.hex"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
}

#[test]
fn a_place_that_is_a_folder_is_refused_and_nothing_stays() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("taken");
    fs::create_dir(&path).unwrap();
    fs::write(path.join("in it"), "").unwrap();
    assert!(write_whole(&path, b"new").is_err());
    assert_eq!(names(folder.path()), ["taken"]);
    assert!(write_whole(&folder.path().join("no such folder/a"), b"new").is_err());
    assert!(write_whole(Path::new(".."), b"new").is_err());
}

#[test]
fn parts_come_one_behind_another() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("lines");
    let (mut head, mut body) = (WholeFile::new(&path).unwrap(), WholeFile::new(&path).unwrap());
    body.write_all(b"body").unwrap();
    head.write_all(b"head, ").unwrap();
    head.append(body).unwrap();
    head.write_all(b", end").unwrap();
    head.keep().unwrap();
    assert_eq!(fs::read(&path).unwrap(), b"head, body, end");
    assert_eq!(names(folder.path()), ["lines"]);
}

#[cfg(unix)]
#[test]
fn a_new_file_may_be_read_by_whom_any_new_file_may() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let [ours, any] = ["ours", "any"].map(|name| folder.path().join(name));
    write_whole(&ours, b"").unwrap();
    fs::write(&any, b"").unwrap();
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
    assert_eq!(mode(&ours), mode(&any));
}
