//! Whatever the documentation names exists: the tests and theorems that the map of the paper names, the files and
//! headings that the Markdown pages link to, the diagram of the flight modes, the constants of the extended law, the
//! columns of log.csv, the scenario examples and refusals, the names of the newcomer's walk. The front page stays
//! short.

use controller_core::extended::parameters::ExtendedParameters;
use flight::rules::TABLE;
use host_sim::reports::log;
use scenario::Scenario;
use scenario::verdict::Verdict;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");

fn read(path: &str) -> String {
    fs::read_to_string(Path::new(ROOT).join(path)).unwrap()
}

/// The names of the tests in a file.
fn tests_of(path: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(Path::new(ROOT).join(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
    let name =
        |text: &str| text.split_once("fn ").and_then(|(_, rest)| rest.split_once('(')).map(|(n, _)| n.to_owned());
    text.split("#[test]\n").skip(1).filter_map(name).collect()
}

/// The names of the theorems in a file of Coq's.
fn theorems_of(path: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(Path::new(ROOT).join(path)).unwrap_or_else(|error| panic!("{path}: {error}"));
    let name = |line: &str| line.strip_prefix("Theorem ")?.split([' ', ':']).next().map(str::to_owned);
    text.lines().filter_map(name).collect()
}

/// The path, from the top of the repository, of a file as the map names it.
fn path_of(file: &str) -> String {
    if file.ends_with(".v") {
        return format!("proofs/{file}");
    }
    match file.split('/').next() {
        Some("core") => format!("controller-{file}"),
        Some("tests" | "estimation" | "flight" | "host-sim" | "scenario" | "firmware") => file.to_owned(),
        _ => format!("controller-core/src/{file}"),
    }
}

#[test]
fn every_test_and_theorem_the_map_names_is_where_it_says() {
    let map = read("docs/map.md");
    let (mut named, mut theorems) = (0, BTreeSet::new());
    // Under each entry, what checks it: an item for each file or some, with its tests.
    let entries = map.split("\n- **").skip(1);
    for checks in entries.map(|entry| entry.split("\n\n").next().unwrap_or_default().split("\n  - ").skip(1)) {
        let checks = checks.map(|check| check.split_whitespace().collect::<Vec<_>>().join(" "));
        for (files, tests) in
            checks.filter_map(|check| check.rsplit_once(": ").map(|(a, b)| (a.to_owned(), b.to_owned())))
        {
            let is_file = |word: &&str| word.ends_with(".rs") || word.ends_with(".v");
            let files: Vec<&str> = files.split([' ', ',']).filter(is_file).collect();
            for test in tests.split('`').skip(1).step_by(2) {
                assert!(!files.is_empty(), "{test}: no file is named");
                for file in &files {
                    let path = path_of(file);
                    let of_coq = file.ends_with(".v");
                    let there = if of_coq { theorems_of(&path) } else { tests_of(&path) };
                    assert!(there.contains(test), "{file} has no test or theorem {test}");
                    theorems.extend(of_coq.then(|| format!("{path}: {test}")));
                }
                named += 1;
            }
        }
    }
    assert!(named > 60, "{named}: the map has lost its tests");

    // No theorem is without its row.
    let files = fs::read_dir(Path::new(ROOT).join("proofs")).unwrap();
    let files = files.map(|entry| format!("proofs/{}", entry.unwrap().file_name().into_string().unwrap()));
    let proven = files.filter(|file| file.ends_with(".v"));
    let proven = proven.flat_map(|file| theorems_of(&file).into_iter().map(move |name| format!("{file}: {name}")));
    assert_eq!(theorems, proven.collect());
}

/// What a heading is called in a link.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept.chars().filter(|&c| c.is_alphanumeric() || c == ' ' || c == '-' || c == '_');
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

#[test]
fn every_link_between_pages_leads_to_a_file() {
    let pages = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "vehicles/README.md"];
    let mut pages = pages.map(str::to_owned).to_vec();
    for entry in fs::read_dir(Path::new(ROOT).join("docs")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        pages.extend(name.ends_with(".md").then(|| format!("docs/{name}")));
    }
    let mut followed = 0;
    for page in pages {
        let text = read(&page);
        let folder = Path::new(ROOT).join(&page).parent().unwrap().to_owned();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target) {
            if target.contains("://") {
                continue;
            }
            let (file, place) = target.split_once('#').unwrap_or((target, ""));
            let file = if file.is_empty() { Path::new(ROOT).join(&page) } else { folder.join(file) };
            assert!(file.exists(), "{page}: no such file: {target}");
            if !place.is_empty() {
                let there = fs::read_to_string(file).unwrap();
                let headings = there.lines().filter_map(|line| line.trim_start_matches('#').strip_prefix(' '));
                assert!(headings.map(anchor).any(|heading| heading == place), "{page}: no such heading: {target}");
            }
            followed += 1;
        }
    }
    assert!(followed > 20, "{followed}: the pages have lost their links");
}

#[test]
fn the_walk_answers_fifteen_questions_with_names_that_are_in_their_files() {
    assert!(read("README.md").contains("(docs/README.md#newcomers-walk)"), "more than two hops");
    let page = read("docs/README.md");
    let (_, walk) = page.split_once("\n## Newcomer's walk\n").unwrap();
    let (questions, additions) = walk.split_once("\n### How do I add\n").unwrap();
    assert_eq!(questions.matches("\n- **").count(), 15);
    let mut found = 0;
    for answer in questions.split("\n- **").skip(1).chain(additions.split("\n- **").skip(1)) {
        let links = answer.split("](").skip(1);
        for (before, target) in answer.split("](").zip(links.filter_map(|rest| rest.split_once(')'))) {
            let (said, _) = before.rsplit_once('[').unwrap();
            let said = said.rsplit_once(')').map_or(said, |(_, said)| said);
            let file = target.0.split('#').next().unwrap();
            let text = read(&format!("docs/{file}"));
            // What stands before the link since the last is in its file: identifiers, that is, not other programs'
            // names.
            for name in said.split('`').skip(1).step_by(2).filter(|name| !name.contains("::") && !name.ends_with('/')) {
                assert!(text.contains(name), "{file} has no `{name}`: {answer}");
                found += 1;
            }
        }
    }
    assert!(found > 20, "{found}: the walk has lost its names");
}

/// The modes for which `InTheAir` stands.
const IN_THE_AIR: [&str; 5] = ["TakingOff", "Flying", "Holding", "Landing", "Descending"];

#[test]
fn the_diagrams_of_the_flight_modes_have_the_arrows_of_the_rules() {
    let page = read("docs/firmware.md");
    let diagrams = page.split("```mermaid\n").skip(1).filter_map(|rest| rest.split_once("```")).map(|(drawn, _)| drawn);
    let arrows = diagrams.flat_map(str::lines).filter_map(|line| line.split_once(':'));
    let arrows = arrows.filter_map(|(arrow, _)| arrow.split_once("-->")).map(|(from, to)| (from.trim(), to.trim()));
    let (entering, arrows): (Vec<_>, Vec<_>) = arrows.partition(|&(_, to)| to == "InTheAir");
    let leaving = |from| if from == "InTheAir" { IN_THE_AIR.to_vec() } else { vec![from] };
    let drawn: BTreeSet<(String, String)> = arrows
        .into_iter()
        .flat_map(|(from, to)| leaving(from).into_iter().map(move |from| (from.to_owned(), to.to_owned())))
        .collect();
    let rules = TABLE.iter().filter(|row| row.from != row.to);
    let ruled = rules.map(|row| (format!("{:?}", row.from), format!("{:?}", row.to))).collect();
    assert_eq!(drawn, ruled);

    // Where the air is entered from: drawn once for all of it, and once for each mode.
    let entered: BTreeSet<&str> = entering.into_iter().map(|(from, _)| from).collect();
    let outside =
        ruled.iter().filter(|(from, to)| IN_THE_AIR.contains(&to.as_str()) && !IN_THE_AIR.contains(&from.as_str()));
    assert_eq!(entered, outside.map(|(from, _)| from.as_str()).collect());
}

#[test]
fn the_front_page_has_at_most_900_words() {
    let words = read("README.md").split_whitespace().count();
    assert!(words <= 900, "{words}");
}

#[test]
fn the_columns_of_the_log_are_listed_in_their_order() {
    let page = read("docs/log.md");
    // Below stand topics of another format.
    let page = page.split("\n## The firmware's ULog").next().unwrap_or_default();
    let rows = page.lines().filter(|line| line.starts_with("| `"));
    let names = rows.filter_map(|line| line.split('|').nth(1));
    let listed: Vec<&str> = names.flat_map(|names| names.split('`').skip(1).step_by(2)).collect();

    // One rotor stands for all. Sensors and an estimator exclude each other.
    let file = read("vehicles/hummingbird.toml") + "[wind]\nsteady = [1, 0, 0]\n";
    let file = file + "[battery]\nfull_voltage = 12\nempty_voltage = 11\nresistance = 0.01\ncapacity = 1\n";
    let mut written: Vec<String> = Vec::new();
    for section in ["[sensors]\n", "[estimator]\n"] {
        let scenario = Scenario::parse(&format!("{file}{section}"), "f").unwrap();
        let header = log::header(1, true) + &log::reality_header(&scenario.reality);
        for column in header.split(',').map(str::to_owned) {
            if !written.contains(&column) {
                written.push(column);
            }
        }
    }
    assert_eq!(listed, written);
}

/// A number as short as it can be read.
fn short(value: f32) -> String {
    format!("{value:?}").trim_end_matches(".0").to_owned()
}

#[test]
fn the_constants_of_the_extended_law_are_listed_as_declared_each_with_its_default() {
    let page = read("docs/scenario-file.md");
    let listed = page.lines().filter(|line| line.starts_with("| `gains.") || line.starts_with("| `estimates."));
    // All but the last column, which says in words what the formula is.
    let listed = listed.map(|line| line.trim_end_matches(" |").rsplit_once(" | ").unwrap());
    let (listed, defaults): (Vec<&str>, Vec<&str>) = listed.unzip();
    let declared = ExtendedParameters::TABLE.iter().map(|constant| {
        let (about, range) = (constant.about.trim().trim_end_matches('.'), constant.range);
        format!("| `{}` | {about} | {} to {}", constant.path, short(range.min), short(range.max))
    });
    assert_eq!(listed, declared.collect::<Vec<_>>());
    assert!(defaults.iter().all(|default| !default.is_empty()));
}

#[test]
fn the_front_pages_scenario_is_enough_to_fly() {
    let page = read("README.md");
    let (_, file) = page.split_once("```toml\n").unwrap();
    let (file, _) = file.split_once("```").unwrap();
    assert!(file.lines().count() <= 12);
    let scenario = Scenario::parse(file, "README.md").unwrap();
    assert!(Verdict::judge(&scenario).unwrap().refusal().is_none());
}

#[test]
fn every_example_of_a_scenario_section_can_be_used() {
    let text = read("docs/scenario-file.md");
    let blocks: Vec<&str> =
        text.split("```toml\n").skip(1).filter_map(|rest| rest.split_once("```")).map(|(block, _)| block).collect();
    let (references, sections): (Vec<&str>, Vec<&str>) = blocks.into_iter().partition(|b| b.starts_with("[reference]"));
    assert_eq!((references.len(), sections.len()), (4, 17));
    for reference in references {
        let harmonic = reference.contains("\"harmonic\"");
        // The bounds stand beside the harmonic reference there. A file has one of the two.
        let other = if harmonic { "[sensors]" } else { "[estimator]" };
        let kept = sections.iter().filter(|section| !section.starts_with(other));
        let kept = kept.filter(|section| harmonic || !section.starts_with("[reference_bounds]"));
        let file =
            kept.fold("name = \"example\"\nduration = 1\n".to_owned() + reference, |file, section| file + section);
        Scenario::parse(&file, "docs/scenario-file.md").unwrap_or_else(|error| panic!("{error}\n{file}"));
    }
}

/// Each refusal of docs/scenario-file.md: what of the paper's file, with the page's rotors, to replace by what.
const REFUSALS: [(&str, &str); 13] = [
    ("mass = 0.460", "mas = 0.460"),
    ("inertia = [2.24e-3, 2.9e-3, 5.3e-3]", "inertia = [0.0347563, 0.0458929, 0.0977]"),
    ("inertia = [2.24e-3, 2.9e-3, 5.3e-3]", "inertia = [[2e-3, 1e-4, 0.0], [1e-4, 3e-3, 0.0], [0.0, 0.0, 5e-3]]"),
    ("thrust_max = 7.0", "thrust_max = 4.5"),
    ("m_p = 2.0", "m_p = 9.7"),
    ("rate = 100.0", "rate = 300.0"),
    ("rate = 100.0", "rate = 400.0"),
    ("position = [5.0, 5.0, 10.0]", "position = [5.0, 5.0]"),
    ("speed = [0.0, 1500.0]", "speed = [100.0, 400.0]"),
    ("speed = [0.0, 1500.0]", "speed = [0.0, 1500.0]\nthrust_max = 7.0"),
    ("spin = [\"cw\", \"ccw\", \"cw\", \"ccw\"]", "spin = [\"cw\", \"ccw\"]"),
    ("[reference]", "[reference_bounds]\nhorizontal_acceleration = 0.1\n\n[reference]"),
    ("mass = 0.460", "mass = heavy"),
];

#[test]
fn files_are_refused_as_the_page_shows() {
    let page = read("docs/scenario-file.md");
    let rotors = page.split("```").find(|block| block.starts_with("toml\n[rotors]")).unwrap();
    let whole = read("scenarios/paper.toml") + rotors.trim_start_matches("toml");
    let (_, shown) = page.split_once("```\nerror: ").unwrap();
    let (shown, _) = shown.split_once("\n```").unwrap();
    let shown: Vec<&str> = shown.split("\nerror: ").collect();
    assert_eq!(shown.len(), REFUSALS.len());
    for (shown, (right, wrong)) in shown.into_iter().zip(REFUSALS) {
        assert!(whole.contains(right), "{right}");
        let said = Scenario::parse(&whole.replacen(right, wrong, 1), "mine.toml").err().unwrap().to_string();
        let same = shown.strip_suffix('…').map_or(said == shown, |start| said.starts_with(start));
        assert!(same, "{said}\nis shown as\n{shown}");
    }
}
