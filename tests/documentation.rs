//! The documentation speaks of what exists: the tests that the map of the paper names, the files that the
//! Markdown pages link to, and the scenario examples.

use scenario::Scenario;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(path)).unwrap()
}

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
    let mut files = Vec::new();
    for folder in
        ["controller-core/src", "controller-core/tests", "host-sim/src", "scenario/src", "firmware/src", "tests"]
    {
        sources(&Path::new(ROOT).join(folder), &mut files);
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
    let map = read("docs/map.md");
    let known = tests();
    let mut named = 0;
    // What stands in backquotes, plain and with the length of a sentence, is a test.
    for word in map.lines().flat_map(|line| line.split('`').skip(1).step_by(2)) {
        let plain = word.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_');
        if plain && word.matches('_').count() >= 3 {
            assert!(known.contains(word), "{word}: no such test");
            named += 1;
        }
    }
    assert!(named > 60, "{named}: the map has lost its tests");
}

#[test]
fn every_link_between_pages_leads_to_a_file() {
    let mut pages = vec!["README.md".to_owned(), "CHANGELOG.md".to_owned()];
    for entry in fs::read_dir(Path::new(ROOT).join("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        pages.extend(name.ends_with(".md").then(|| format!("docs/{name}")));
    }
    let mut followed = 0;
    for page in pages {
        let text = read(&page);
        let folder = Path::new(ROOT).join(&page).parent().unwrap().to_owned();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target) {
            let file = target.split('#').next().unwrap();
            if file.is_empty() || file.contains("://") {
                continue;
            }
            assert!(folder.join(file).exists(), "{page}: no such file: {target}");
            followed += 1;
        }
    }
    assert!(followed > 20, "{followed}: the pages have lost their links");
}

#[test]
fn every_example_of_a_scenario_section_can_be_used() {
    let text = read("docs/scenario-file.md");
    let blocks: Vec<&str> =
        text.split("```toml\n").skip(1).filter_map(|rest| rest.split_once("```")).map(|(block, _)| block).collect();
    let (references, sections): (Vec<&str>, Vec<&str>) = blocks.into_iter().partition(|b| b.starts_with("[reference]"));
    assert_eq!((references.len(), sections.len()), (3, 15));
    for reference in references {
        let harmonic = reference.contains("\"harmonic\"");
        // The bounds stand beside the harmonic reference there.
        let kept = sections.iter().filter(|section| harmonic || !section.starts_with("[reference_bounds]"));
        let file =
            kept.fold("name = \"example\"\nduration = 1\n".to_owned() + reference, |file, section| file + section);
        Scenario::parse(&file, "docs/scenario-file.md").unwrap_or_else(|error| panic!("{error}\n{file}"));
    }
}
