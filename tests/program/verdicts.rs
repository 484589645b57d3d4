//! Verdicts: a loop that cannot hold still, a flight that does not arrive.

use crate::support::binary;
use crate::support::binary::{PAPER, files, host_sim, status, stderr, stdout, with};
use std::path::{Path, PathBuf};

const HUMMINGBIRD: &str = include_str!("../../vehicles/hummingbird-paper-law.toml");

/// A directory of this suite.
fn directory(test: &str) -> PathBuf {
    binary::directory("cli_verdicts", test)
}

/// Flies a scenario with this `text` in `directory`, into `out`: the exit status and what it printed.
fn flown(directory: &Path, text: &str) -> (i32, String) {
    std::fs::write(directory.join("scenario.toml"), text).unwrap();
    let output = host_sim(directory, &["fly", "scenario.toml", "--out", "out"]);
    (status(&output), stdout(&output))
}

/// The Hummingbird with rotors that follow a second late: every command within its limits, five of six loops unstable.
fn sluggish() -> String {
    with(HUMMINGBIRD, "lag", "lag = 1.0")
}

/// The same with a lag that leaves its roll loop 1.3 ms of delay: stable, and certified as far as commands go.
fn weak() -> String {
    with(HUMMINGBIRD, "lag", "lag = 0.045")
}

#[test]
fn certify_refuses_an_unstable_loop_and_names_it() {
    let directory = directory("certify");
    std::fs::write(directory.join("sluggish.toml"), sluggish()).unwrap();
    let output = host_sim(&directory, &["certify", "sluggish.toml"]);
    let text = stdout(&output);
    assert_eq!((status(&output), stderr(&output)), (1, String::new()), "{text}");
    let refusal = "hummingbird-paper-law: NOT certified: sampled loop roll: unstable, spectral radius 1.";
    assert!(text.starts_with(refusal), "{text}");
    // The proof holds all the same, and the verdict says what it is a proof of.
    for words in ["commands (a proof): within every limit", "small motions (an analysis): NOT stable", "UNSTABLE"] {
        assert!(text.contains(words), "{words}: {text}");
    }
}

#[test]
fn certify_refuses_a_loop_without_margin_and_says_which_margin() {
    let directory = directory("margin");
    std::fs::write(directory.join("weak.toml"), weak()).unwrap();
    let output = host_sim(&directory, &["certify", "weak.toml"]);
    let text = stdout(&output);
    assert_eq!(status(&output), 1, "{text}");
    let refusal =
        "hummingbird-paper-law: NOT certified: sampled loop roll: unstable with 1.3 ms more delay, must bear 2.0 ms ";
    assert!(text.replace('\n', " ").starts_with(refusal) && !text.contains("UNSTABLE"), "{text}");
}

#[test]
fn fly_flies_an_unstable_loop_reports_it_and_fails() {
    let directory = directory("fly");
    let (status, text) = flown(&directory, &sluggish());
    assert_eq!(status, 1, "{text}");
    let failing: Vec<&str> = text.lines().filter(|line| line.ends_with("FAILS")).collect();
    assert!(failing.iter().any(|line| line.starts_with("sampled loops") && line.contains("roll: unstable")), "{text}");
    assert!(failing.iter().any(|line| line.starts_with("within 0.2 m") && line.contains("never")), "{text}");
    assert!(text.contains("NOT every claim holds") && text.contains("not certified: sampled loop roll"), "{text}");
    assert_eq!(files(&directory.join("out")).len(), 7);
    assert!(std::fs::read_to_string(directory.join("out/report.md")).unwrap().contains("Not every claim holds."));
}

#[test]
fn a_loop_without_margin_fails_a_flight_that_arrives() {
    let (status, text) = flown(&directory("arrives"), &weak());
    let failing: Vec<&str> = text.lines().filter(|line| line.ends_with("FAILS")).collect();
    let [only] = failing[..] else { panic!("{text}") };
    assert!(status == 1 && only.starts_with("sampled loops") && only.contains("must bear 2.0 ms"), "{text}");
}

#[test]
fn a_flight_that_does_not_reach_its_reference_in_time_fails_with_the_numbers() {
    // Table I needs nineteen seconds from the paper's start.
    let (status, text) = flown(&directory("late"), &with(PAPER, "duration", "duration = 5.0"));
    assert_eq!(status, 1, "{text}");
    let row = text.lines().find(|line| line.starts_with("within 0.2 m of the reference for good")).unwrap();
    let words: Vec<&str> = row.split("  ").map(str::trim).filter(|word| !word.is_empty()).collect();
    assert_eq!(words[1..], ["<= 4.5 s", "never", "FAILS"], "{row}");
    let row = text.lines().find(|line| line.starts_with("within 0.05 of its attitude for good")).unwrap();
    assert!(row.ends_with("holds"), "{row}");
}

#[test]
fn a_flight_of_less_than_four_ticks_is_steady_in_its_last() {
    let directory = directory("ticks");
    for duration in ["0.01", "0.03"] {
        let (_, text) = flown(&directory, &with(PAPER, "duration", &format!("duration = {duration}")));
        for row in ["position error, steady state", "MRP error, steady state"] {
            let row = text.lines().find(|line| line.starts_with(row)).unwrap();
            assert!(!row.contains("  0 m ") && !row.contains("  0  "), "{row}");
        }
    }
}

#[test]
fn a_vehicle_that_never_leaves_the_ground_has_not_reached_its_reference() {
    let directory = directory("ground");
    let (head, _) = include_str!("../../vehicles/hummingbird.toml").split_once("[initial]").unwrap();
    let head = with(head, "duration =", "duration = 20.0");
    let fly = |height: &str, sections: &str| {
        let reference = format!("[reference]\nkind = \"hover\"\nposition = [0.0, 0.0, {height}]\n");
        let text =
            format!("{head}\n[ground]\nheight = 0.0\n[initial]\nposition = [0.0, 0.0, 0.0]\n{reference}{sections}");
        std::fs::write(directory.join("ground.toml"), text).unwrap();
        let output = host_sim(&directory, &["fly", "ground.toml", "--out", "out"]);
        let text = stdout(&output);
        let row = text.lines().find(|line| line.starts_with("within 0.2 m of the reference for good"));
        (status(&output), row.unwrap_or_else(|| panic!("{text}{}", stderr(&output))).to_owned())
    };
    for sections in ["[truth]\nmass = 5.0\n", "[truth]\nthrust_scale = 0.01\n"] {
        let (status, row) = fly("0.15", sections);
        assert!(status == 1 && row.contains("never") && row.ends_with("FAILS"), "{sections}: {row}");
    }
    // One that takes off reaches it.
    let (status, row) = fly("0.15", "");
    assert!(status == 0 && !row.contains("never") && row.ends_with("holds"), "{row}");
    let (status, row) = fly("2.0", "");
    assert!(status == 0 && row.ends_with("holds"), "{row}");
}

#[test]
fn tune_does_not_ask_for_less_than_certify_does() {
    let directory = directory("tune");
    std::fs::write(directory.join("start.toml"), PAPER).unwrap();
    for (name, value, words) in
        [("--gain-margin", "1.4", "at least 1.5, which certify asks for"), ("--delay-margin", "1.9", "at least 2 ms")]
    {
        let output = host_sim(&directory, &["tune", "start.toml", name, value]);
        let message = stderr(&output);
        assert_eq!((status(&output), message.lines().count()), (2, 1), "{name} {value}: {message}");
        assert!(message.contains(name) && message.contains(words), "{message}");
    }
    assert_eq!(files(&directory), ["start.toml"]);
}

#[test]
fn a_flight_that_is_not_certified_fails_and_its_last_line_names_the_claim() {
    let weak = with(PAPER, "torque_max", "torque_max = [0.5, 0.5, 0.3]");
    let (status, text) = flown(&directory("uncertified"), &weak);
    let last = text.lines().last().unwrap();
    assert_eq!(status, 1, "{text}");
    assert!(
        last.starts_with("NOT every claim holds (commands, certificate); log, figures and report in out"),
        "{last}"
    );
}

/// The paper's vehicle through gates, one leg much longer than the others; `height` is added to all.
fn gates(height: f64, path: &str) -> String {
    let points = [(0.0, 0.0, 1.0), (4.0, 4.0, 2.0), (16.0, 5.0, 2.0), (20.0, 0.0, 2.5), (24.0, 0.0, 1.0)]
        .map(|(t, x, z)| format!("{{ t = {t:?}, position = [{x:?}, 0.0, {:?}] }}", z + height));
    let (head, _) = PAPER.split_once("[initial]").unwrap();
    format!("{head}[reference]\nkind = \"waypoints\"\npath = \"{path}\"\npoints = [{}]\n", points.join(", "))
}

#[test]
fn a_path_that_swings_out_is_said_and_below_ground_refused() {
    let directory = directory("swing");
    for (name, text) in
        [("high", gates(10.0, "smooth")), ("low", gates(0.0, "smooth")), ("inside", gates(0.0, "inside"))]
    {
        std::fs::write(directory.join(format!("{name}.toml")), text).unwrap();
    }
    for command in ["certify", "fly"] {
        let run = |file: &str| host_sim(&directory, &[command, file]);
        let [high, inside] = ["high.toml", "inside.toml"].map(|file| stdout(&run(file)).replace('\n', " "));
        let swing = "the path leaves the box of its waypoints by ";
        let (_, place) = high.split_once(swing).unwrap_or_else(|| panic!("{command}: {high}"));
        assert!(place.contains(" m at ") && place.contains("path = \"inside\""), "{command}: {high}");
        assert!(!inside.contains(swing), "{command}: {inside}");
        let low = run("low.toml");
        let message = stderr(&low);
        assert_eq!((status(&low), message.lines().count()), (2, 1), "{command}: {message}");
        assert!(message.contains("reference.points: the path must stay above the ground at 0 m, found ("), "{message}");
    }
}

#[test]
fn a_key_without_an_end_is_refused_at_once() {
    let directory = directory("key");
    std::fs::write(directory.join("key.toml"), format!("{} = 1", "k".repeat(4_000_000))).unwrap();
    let output = host_sim(&directory, &["certify", "key.toml"]);
    let message = stderr(&output);
    assert_eq!((status(&output), message.lines().count()), (2, 1));
    assert!(message.len() < 3000 && message.contains("kk: unknown key (allowed: name, duration"), "{message}");
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_refused_and_neither_waited_for_nor_read_to_exhaustion() {
    let directory = directory("endless");
    // No process writes to it.
    assert!(std::process::Command::new("mkfifo").arg(directory.join("pipe")).status().unwrap().success());
    for source in ["/dev/zero", "pipe"] {
        let alone =
            ["certify", "fly", "tune", "campaign", "compare", "law", "identify"].map(|command| vec![command, source]);
        let besides = [
            vec!["identify", "log.csv", "--scenario", source],
            vec!["sitl", "--parameters", source],
            vec!["sitl", "--signing-key", source],
        ];
        for arguments in alone.into_iter().chain(besides) {
            let output = host_sim(&directory, &arguments);
            let message = stderr(&output);
            assert_eq!((status(&output), message.lines().count()), (2, 1), "{arguments:?}: {message}");
            let words = format!("{source}: cannot be read: is no regular file");
            assert!(message.contains(&words), "{arguments:?}: {message}");
        }
    }
}
