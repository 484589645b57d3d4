//! The table in controller-core's documentation, from the paper to the tests, names tests and files that exist.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const CORE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../controller-core/src/lib.rs");

/// Every Rust file below `directory`.
fn sources(directory: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The names of all tests in the repository.
fn tests() -> BTreeSet<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in ["controller-core/src", "controller-core/tests", "host-sim/src", "host-sim/tests", "tests"] {
        sources(&root.join(folder), &mut files);
    }
    let name =
        |text: &str| text.split_once("fn ").and_then(|(_, rest)| rest.split_once('(')).map(|(n, _)| n.to_owned());
    let marked = |file: &PathBuf| {
        let text = fs::read_to_string(file).unwrap();
        text.split("#[test]\n").skip(1).filter_map(name).collect::<Vec<_>>()
    };
    files.iter().flat_map(marked).collect()
}

#[test]
fn every_test_the_map_names_exists() {
    let map = fs::read_to_string(CORE).unwrap();
    let known = tests();
    let mut named = 0;
    // What stands in backquotes, plain and with the length of a sentence, is a test.
    for word in map.lines().filter(|line| line.starts_with("//!")).flat_map(|line| line.split('`').skip(1).step_by(2)) {
        let plain = word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        if plain && word.matches('_').count() >= 3 {
            assert!(known.contains(word), "{word}: no such test");
            named += 1;
        }
    }
    assert!(named > 60, "{named}: the map has lost its tests");
}
