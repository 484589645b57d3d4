//! The verdict on what ships, and on files that must not fly.

use super::*;
use crate::PAPER;
use crate::sampled_loop::Axis;
use crate::stability::Shortfall;
use std::path::{Path, PathBuf};

const HUMMINGBIRD: &str = include_str!("../../../vehicles/hummingbird-paper-law.toml");

fn refusal(text: &str) -> Option<Refusal> {
    Verdict::judge(&Scenario::parse(text, "f").unwrap()).unwrap().refusal()
}

/// Every scenario file of the repository.
fn shipped() -> Vec<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let files = |folder: &str| std::fs::read_dir(top.join(folder)).unwrap().map(|entry| entry.unwrap().path());
    let all = files("scenarios").chain(files("vehicles"));
    all.filter(|path| path.extension().is_some_and(|extension| extension == "toml")).collect()
}

#[test]
fn every_shipped_file_may_fly() {
    let files = shipped();
    assert!(files.len() >= 9, "{files:?}");
    for file in files {
        let verdict = Verdict::judge(&Scenario::load(&file).unwrap()).unwrap();
        assert_eq!(verdict.refusal(), None, "{}", file.display());
    }
}

#[test]
fn rotors_that_follow_a_second_late_are_certified_and_refused_for_the_loop() {
    let late = HUMMINGBIRD.replace("lag = 0.005", "lag = 1.0");
    let verdict = Verdict::judge(&Scenario::parse(&late, "f").unwrap()).unwrap();
    assert!(verdict.certificate().holds() && verdict.certified().is_some());
    assert_eq!(verdict.loops().iter().filter(|report| report.margins.is_none()).count(), 5);
    let Some(Refusal::Loop(lack)) = verdict.refusal() else { panic!("{:?}", verdict.refusal()) };
    assert!(lack.axis == Axis::Roll && matches!(lack.what, Shortfall::Unstable { .. }), "{lack:?}");
    assert!(lack.to_string().starts_with("sampled loop roll: unstable, spectral radius 1."), "{lack}");
}

#[test]
fn a_loop_that_is_stable_with_too_little_margin_is_refused_too() {
    // Table I survives 8.5 ms of lag; with 6 ms a millisecond and a half of delay is left.
    let rotors = &HUMMINGBIRD[HUMMINGBIRD.find("[rotors]").unwrap()..HUMMINGBIRD.find("[initial]").unwrap()];
    let with_lag = |lag: &str| format!("{PAPER}\n{}", rotors.replace("lag = 0.005", &format!("lag = {lag}")));
    let scenario = Scenario::parse(&with_lag("0.006"), "f").unwrap();
    let verdict = Verdict::judge(&scenario).unwrap();
    assert!(verdict.loops().iter().all(|report| report.spectral_radius < 1.0));
    let lack = verdict.lacking().unwrap();
    assert!(matches!(lack.what, Shortfall::Delay { found, .. } if found < 2e-3), "{lack}");
    let scenario = Scenario::parse(&with_lag("0.003"), "f").unwrap();
    assert_eq!(Verdict::judge(&scenario).unwrap().lacking(), None);
}

#[test]
fn an_inequality_that_fails_is_named_with_its_numbers() {
    let Some(refusal) = refusal(&PAPER.replace("thrust_max = 7.0", "thrust_max = 5.0")) else { panic!() };
    let text = refusal.to_string();
    assert!(text.starts_with("certificate, ") && text.contains("available 5.0000 N"), "{text}");
    assert_eq!(text.lines().count(), 1);
}
