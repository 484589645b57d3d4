//! The report's lines, for a certified, a refused, and a rotor-bound configuration.

use super::*;
use controller_core::extended::parameters::ExtendedParameters;
use scenario::PAPER;

const STUDY: &str = include_str!("../../../../vehicles/study-paper-law.toml");

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
    assert_eq!(line(&text, "published"), PUBLISHED_BOUNDS);
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

const EXTENDED_FILES: [&str; 3] = [
    include_str!("../../../../vehicles/hummingbird.toml"),
    include_str!("../../../../vehicles/study.toml"),
    include_str!("../../../../scenarios/paper-extended.toml"),
];

#[test]
fn every_inequality_of_the_extended_law_is_explained() {
    for text in EXTENDED_FILES {
        let scenario = Scenario::parse(text, "f").unwrap();
        let certificate = Certificate::new(&scenario.configuration).unwrap();
        for inequality in certificate.inequalities() {
            let advice = advice::of_inequality(inequality.name);
            assert!(["ower ", "aise "].iter().any(|word| advice.contains(word)), "{}: {advice:?}", inequality.name);
            let names = advice.split_whitespace().filter_map(|word| word.split_once('.'));
            for (section, key) in
                names.filter(|(section, key)| ["gains", "estimates"].contains(section) && !key.is_empty())
            {
                let key = key.trim_end_matches([',', '.', ';', ':', '(']);
                let known = ExtendedParameters::TABLE.iter().any(|c| (c.section, c.key) == (section, key));
                assert!(known, "{}: {section}.{key}", inequality.name);
            }
        }
    }
}

#[test]
fn what_limits_a_certified_vehicle_is_its_tightest_inequality_and_what_a_refused_one_fails_in_is_all_of_them() {
    for text in EXTENDED_FILES {
        let (report, certified) = report(text);
        let tightest =
            line(&report, "tightest: ").split_once("tightest: ").unwrap().1.split_once(", margin").unwrap().0;
        assert!(certified && line(&report, "What limits it: ").ends_with(advice::of_inequality(tightest)), "{report}");
        assert_eq!(report.matches("What ").count(), 1, "{report}");
    }
    let refused = |text: &str, start: &str, what: &str| {
        let (text, certified) = report(text);
        assert!(!certified && line(&text, start).contains(what), "{text}");
        text
    };
    let slow = EXTENDED_FILES[0].replace("yaw_acceleration = 6.0 ", "yaw_acceleration = 3.0 ");
    let text = refused(&slow, "What it fails in: ", "how quickly the heading begins to turn");
    assert_eq!(text.matches("What ").count(), 1, "{text}");
    let too_quick_for_its_lag = EXTENDED_FILES[0].replace("[gains] ", "[gains]\nk_omega_t = 1.5\n# ");
    refused(&too_quick_for_its_lag, "What it fails in: the sampled loop roll", "lower gains.k_omega_t");
}

#[test]
fn pull_and_turning_take_what_the_torque_rows_require() {
    for (text, row) in EXTENDED_FILES[..2].iter().zip(["T2 roll and pitch torque", "R rotors' range"]) {
        let (report, _) = report(text);
        let shares = line(&report, "of ");
        let whole: f64 = shares.split_whitespace().nth(1).unwrap().parse().unwrap();
        let parts = shares.split(['%', ',']).filter_map(|part| part.split_whitespace().last()?.parse::<f64>().ok());
        let taken = whole * parts.take(2).sum::<f64>() / 100.0;
        let required = line(&report, row).split_whitespace().rev().nth(3).unwrap().parse::<f64>().unwrap();
        assert!((taken - required).abs() < 2e-3 * required, "{shares}: {taken}, {required}");
    }
}

#[test]
fn shown_constants_stand_for_what_the_file_says_and_leaves_out() {
    for text in EXTENDED_FILES.into_iter().chain([PAPER, STUDY]) {
        let scenario = Scenario::parse(text, "f").unwrap();
        let mut document: toml_edit::DocumentMut = text.parse().unwrap();
        for section in ["gains", "estimates", "reference_bounds"] {
            document.remove(section);
        }
        let pasted = format!("{document}\n{}", constants::constants(&scenario));
        let read = Scenario::parse(&pasted, "f").unwrap_or_else(|error| panic!("{error}\n{pasted}"));
        assert!(read.flies_like(&scenario), "{pasted}");
    }
}
