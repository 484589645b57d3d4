use super::*;
use scenario::{STUDY, Scenario};

fn study() -> Scenario {
    Scenario::parse(STUDY, "study").unwrap()
}

/// What an accelerometer shows whose body was turned about an axis by an angle, and that angle.
fn tilted(axis: Vector3<f32>, angle: f32) -> (Vector3<f32>, Vector3<f32>) {
    let turn = nalgebra::Rotation3::from_scaled_axis(axis * angle);
    (turn.inverse() * Vector3::new(0.0, 0.0, 9.81), axis * angle)
}

#[test]
fn a_tilt_is_shown_by_force_and_rate_together_and_by_no_other_tilt() {
    // Nose up is a turn about left by a negative angle; left side up one about forward.
    let (nose, left) = (tilted(Vector3::y(), -0.5), tilted(Vector3::x(), 0.5));
    assert!(Hold::NoseUp.is_shown(&nose.0, &nose.1) && !Hold::LeftUp.is_shown(&nose.0, &nose.1));
    assert!(Hold::LeftUp.is_shown(&left.0, &left.1) && !Hold::NoseUp.is_shown(&left.0, &left.1));
    for (force, turned) in [tilted(Vector3::y(), 0.5), tilted(Vector3::x(), -0.5)] {
        assert!(!Hold::NoseUp.is_shown(&force, &turned) && !Hold::LeftUp.is_shown(&force, &turned));
    }
    // A gyro whose sign, or axis, is not the accelerometer's.
    assert!(!Hold::NoseUp.is_shown(&nose.0, &-nose.1) && !Hold::LeftUp.is_shown(&left.0, &-left.1));
    assert!(!Hold::NoseUp.is_shown(&nose.0, &left.1));
    // Not far enough.
    let (force, turned) = tilted(Vector3::y(), -0.2);
    assert!(!Hold::NoseUp.is_shown(&force, &turned));
    // On a slope between both axes it is neither.
    let (force, turned) = tilted(Vector3::new(0.707, -0.707, 0.0), 0.5);
    assert!(!Hold::NoseUp.is_shown(&force, &turned) && !Hold::LeftUp.is_shown(&force, &turned));
}

#[test]
fn flat_and_turned_are_shown_by_gravity_and_by_a_turn_to_the_left() {
    let flat = Vector3::new(0.3, -0.3, 9.75);
    assert!(Hold::Flat.is_shown(&flat, &Vector3::zeros()));
    assert!(!Hold::Flat.is_shown(&-flat, &Vector3::zeros()) && !Hold::Flat.is_shown(&(flat * 1.2), &Vector3::zeros()));
    assert!(Hold::TurnedLeft.is_shown(&flat, &Vector3::new(0.0, 0.0, 1.0)));
    assert!(!Hold::TurnedLeft.is_shown(&flat, &Vector3::new(0.0, 0.0, -1.0)));
}

#[test]
fn shares_are_right_for_the_files_rotors_and_a_swapped_pair_is_found() {
    let scenario = study();
    let rotors = scenario.configuration.rotors().unwrap();
    // Front left, front right, rear right, rear left; clockwise, counter-clockwise and so on.
    assert_eq!(rotors.iter().map(place).collect::<Vec<_>>(), ["front left", "front right", "rear right", "rear left"]);
    assert_eq!(rotors.iter().map(direction).collect::<Vec<_>>(), ["cw", "ccw", "cw", "ccw"]);
    for (hold, shares) in [
        (Hold::NoseUp, [0.9, 0.9, 1.1, 1.1]),
        (Hold::LeftUp, [0.9, 1.1, 1.1, 0.9]),
        (Hold::TurnedLeft, [0.99, 1.01, 0.99, 1.01]),
    ] {
        assert_eq!(wrong_share(hold, rotors, &shares), None, "{hold:?}");
        let mut swapped = shares;
        swapped.rotate_left(2);
        let is_the_same = swapped == shares;
        assert_eq!(wrong_share(hold, rotors, &swapped).is_none(), is_the_same, "{hold:?}");
        assert_eq!(wrong_share(hold, rotors, &[1.0; 4]), Some(1));
        let mut reversed = shares.map(|share| 2.0 - share);
        assert_eq!(wrong_share(hold, rotors, &reversed), Some(1), "{hold:?}");
        reversed[0] = shares[0];
        assert_eq!(wrong_share(hold, rotors, &reversed), Some(2), "{hold:?}");
    }
    assert_eq!(wrong_share(Hold::Flat, rotors, &[1.0; 4]), None);
}

/// A report's texts as the firmware words them, of a configuration's certificate.
fn texts(verdict: &Result<Certified, Refused>) -> Vec<String> {
    let certificate = verdict.as_ref().unwrap().certificate();
    let mut texts = vec!["Started by Power on a desk".to_owned(), "Scenario study".to_owned()];
    texts.extend(
        certificate.inequalities().map(|row| format!("{:.28}: {:.4} of {:.4}", row.name, row.required, row.available)),
    );
    texts.extend(["Certified".to_owned(), "Calibration: gyro yes, accel no, level no".to_owned()]);
    texts.extend(["Refused: no ground station for 2.5 s".to_owned(), "Report ends".to_owned()]);
    texts
}

#[test]
fn a_boards_certificate_is_the_files_to_the_last_printed_digit_or_is_not() {
    let verdict = Certified::new(study().configuration);
    let report = BootReport::read(&texts(&verdict));
    assert!(report.has_ended && report.is_certified);
    assert_eq!(report.started.as_deref(), Some("Power on a desk"));
    assert_eq!(report.scenario.as_deref(), Some("study"));
    assert_eq!(report.refusal.as_deref(), Some("Refused: no ground station for 2.5 s"));
    assert_eq!(report.difference(&verdict), None);
    let mut other = report.clone();
    other.rows[3].2 += 0.001;
    assert!(other.difference(&verdict).is_some_and(|words| words.contains(&other.rows[3].0)));
    let mut shorter = report.clone();
    shorter.rows.pop();
    assert!(shorter.difference(&verdict).is_some());
    let refused = BootReport { is_certified: false, ..report.clone() };
    assert_eq!(refused.difference(&verdict).as_deref(), Some("the verdicts differ"));
    let heavier = Scenario::parse(&STUDY.replace("mass = ", "mass = 0.1 # "), "study");
    if let Ok(heavier) = heavier {
        assert!(report.difference(&Certified::new(heavier.configuration)).is_some());
    }
}

#[test]
fn only_the_last_report_counts_and_other_words_between_its_lines_do_not() {
    let verdict = Certified::new(study().configuration);
    let mut twice = texts(&verdict);
    twice.extend(texts(&verdict));
    twice.insert(5, "Battery low: 9.8 V".to_owned());
    assert_eq!(BootReport::read(&twice).difference(&verdict), None);
}
