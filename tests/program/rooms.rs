//! The rooms of host-sim stand in order: none imports from one below it in the table of `host-sim/src/lib.rs`.

use std::fs;
use std::path::{Path, PathBuf};

const SOURCES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src");

/// Every source of a folder or a file that is part of the program, without unit tests.
fn sources(path: &Path) -> Vec<PathBuf> {
    if !path.is_dir() {
        let is_source = path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs");
        return is_source.then(|| path.to_owned()).into_iter().collect();
    }
    let entries = fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path());
    entries.filter(|entry| !entry.ends_with("tests")).flat_map(|entry| sources(&entry)).collect()
}

#[test]
fn no_room_of_host_sim_imports_from_one_below_it() {
    let library = fs::read_to_string(Path::new(SOURCES).join("lib.rs")).unwrap();
    let rooms: Vec<&str> =
        library.lines().filter_map(|line| Some(line.strip_prefix("//! | [`")?.split_once("`]")?.0)).collect();
    let declared = library.lines().filter(|line| line.starts_with("pub mod ") && line.ends_with(';')).count();
    assert_eq!(rooms.len(), declared, "{rooms:?}");
    let mut wrong = Vec::new();
    for (place, room) in rooms.iter().enumerate() {
        let files = [Path::new(SOURCES).join(room), Path::new(SOURCES).join(format!("{room}.rs"))];
        for file in files.iter().flat_map(|path| sources(path)) {
            let text = fs::read_to_string(&file).unwrap();
            let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap();
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
            let below = |line: &&str| rooms[place + 1..].iter().any(|below| line.contains(&format!("crate::{below}")));
            wrong.extend(code.filter(below).map(|line| format!("{}: {line}", file.display())));
        }
    }
    assert!(wrong.is_empty(), "rooms above import from rooms below:\n{}", wrong.join("\n"));
}
