//! The report's lines, for a certified, a refused, and a rotor-bound configuration.

use super::*;
use scenario::PAPER;

const STUDY: &str = include_str!("../../../vehicles/study-paper-law.toml");

fn report(text: &str) -> (String, bool) {
    certify(&Scenario::parse(text, "f").unwrap()).unwrap()
}

fn line<'a>(text: &'a str, start: &str) -> &'a str {
    text.lines().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("no {start:?} in\n{text}"))
}

#[test]
fn table_one_is_certified_sharply_and_refused_as_printed_beside_the_published_figures() {
    let (text, certified) = report(PAPER);
    assert!(certified && text.starts_with("paper: CERTIFIED\n"), "{text}");
    assert_eq!(line(&text, "as printed: fails"), "as printed: fails in T2 yaw torque");
    assert_eq!(line(&text, "sharp: every"), "sharp: every inequality holds");
    let printed = line(&text, "as printed: |omega_d|").split_once("torques ").unwrap().1.trim_end_matches(" N m");
    for (torque, lemma_1) in printed.split(", ").zip([0.379, 0.446, 0.664]) {
        assert!((torque.parse::<f64>().unwrap() - lemma_1).abs() < 1e-3, "{printed}");
    }
    assert_eq!(line(&text, "published"), PUBLISHED);
    let yaw: Vec<&str> = line(&text, "T2 yaw torque").split_whitespace().collect();
    assert!(yaw.contains(&"FAILS") && yaw.last() == Some(&"holds"), "{yaw:?}");
    assert!(!text.contains("rotor 1"));
}

#[test]
fn a_refusal_says_which_inequality_fails() {
    let (text, certified) = report(&PAPER.replace("thrust_max = 7.0", "thrust_max = 5.0"));
    assert!(
        !certified && text.starts_with("paper: NOT certified: certificate, T1 greatest thrust: requires 5.68"),
        "{text}"
    );
    assert!(line(&text, "sharp: fails").contains("T1 greatest thrust"), "{text}");
    assert!(line(&text, "tightest").contains("margin -"), "{text}");
    assert!(!text.contains("published"), "the published figures are about the paper's own limits");
}

#[test]
fn the_loops_are_reported_for_all_six_axes_with_their_timing() {
    let (text, _) = report(PAPER);
    for axis in ["roll ", "pitch ", "yaw ", "lateral x ", "lateral y ", "vertical "] {
        assert!(line(&text, axis).ends_with(" stable"), "{text}");
    }
    assert!(text.contains("at 100 Hz, rotor lag 0 ms, delay 0 ms"));
    let late = |delay: &str| report(&STUDY.replace("delay = 0.010", &format!("delay = {delay}")));
    let (text, certified) = late("0.200");
    assert!(
        !certified && text.starts_with("study-paper-law: NOT certified: sampled loop roll: unstable, spectral"),
        "{text}"
    );
    assert!(line(&text, "roll ").ends_with(" UNSTABLE") && text.contains("delay 200 ms"), "{text}");
    let (text, certified) = late("0.027");
    assert!(
        !certified && text.contains("small motions (an analysis): stable about hover, but with too LITTLE"),
        "{text}"
    );
    assert!(line(&text, "lateral x ").ends_with(" TOO LITTLE MARGIN"), "{text}");
}

#[test]
fn rotors_have_two_lines_each_and_the_worst_is_explained() {
    let (text, certified) = report(STUDY);
    assert!(certified, "{text}");
    for rotor in 1..=4 {
        assert!(line(&text, &format!("R rotor {rotor} least")).ends_with("holds"));
        assert!(line(&text, &format!("R rotor {rotor} greatest")).ends_with("holds"));
    }
    assert!(text.lines().any(|line| line.starts_with("rotor ") && line.contains("the weak axis is yaw")), "{text}");
    // A faster idle takes the room below hovering away.
    let (text, certified) = report(&STUDY.replace("speed = [100.0,", "speed = [420.0,"));
    assert!(!certified && line(&text, "R rotor 1 least").ends_with("FAILS"), "{text}");
    assert!(text.contains("too much by"), "{text}");
}

#[test]
fn a_thrust_floor_is_stated() {
    let (text, _) = report(&PAPER.replace("rate = 100.0", "thrust_floor = 1.0\nrate = 100.0"));
    assert!(text.contains("thrust projection on, floor 1 N\n"), "{text}");
}
